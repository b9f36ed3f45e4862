//! Triangles of meshes.

use super::Notes;
use super::accessor::Values;
use super::buffers::Buffers;
use super::graph::Affine;
use crate::model::Mesh;
use gltf::accessor::Dimensions;
use gltf::mesh::{Mode, Primitive, Semantic};
use std::collections::HashMap;

/// Warns of what is passed over.
pub(super) fn look(primitive: &Primitive<'_>, what: &str, notes: &mut Notes<'_>) {
    if matches!(primitive.mode(), Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) {
        notes.warn(&format!("{what}: points and lines are not supported, passed over"));
    }
    if primitive.morph_targets().len() > 0 {
        notes.warn(&format!("{what}: morph targets are not supported, it is shown without"));
    }
    if primitive.get(&Semantic::Colors(0)).is_some() {
        notes.warn(&format!("{what}: colours of vertices are not supported, its material's colour is used"));
    }
}

/// Triangles of one material, before they are placed.
pub(super) struct Shape<'a> {
    what: String,
    mode: Mode,
    positions: Values<'a>,
    normals: Option<Values<'a>>,
    indices: Option<Values<'a>>,
    /// None for the default one.
    material: Option<usize>,
}

impl<'a> Shape<'a> {
    /// None for points and lines.
    pub(super) fn new(primitive: &Primitive<'_>, buffers: &'a Buffers, what: String) -> Result<Option<Self>, String> {
        let mode = primitive.mode();
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            return Ok(None);
        }
        let fail = |e: String| format!("{what}: {e}");
        let vectors = |semantic| {
            let accessor = primitive.get(&semantic);
            accessor.map(|a| Values::new(buffers, &a, Dimensions::Vec3)).transpose().map_err(fail)
        };
        let Some(positions) = vectors(Semantic::Positions)? else {
            return Err(fail("it has no positions".into()));
        };
        let normals = vectors(Semantic::Normals)?;
        if normals.as_ref().is_some_and(|n| n.len() != positions.len()) {
            return Err(fail(format!("it has other numbers of positions ({}) and normals", positions.len())));
        }
        let indices =
            primitive.indices().map(|a| Values::new(buffers, &a, Dimensions::Scalar)).transpose().map_err(fail)?;
        if indices.as_ref().is_some_and(|i| !i.are_indices()) {
            return Err(fail("its indices are no whole numbers without sign".into()));
        }
        let material = primitive.material().index();
        let shape = Self { mode, positions, normals, indices, material, what: String::new() };
        let corners = shape.corners();
        if mode == Mode::Triangles && !corners.is_multiple_of(3) {
            return Err(fail(format!("its {corners} corners are no multiple of 3")));
        }
        Ok(Some(Self { what, ..shape }))
    }

    fn corners(&self) -> usize {
        self.indices.as_ref().map_or(self.positions.len(), Values::len)
    }

    pub(super) fn triangles(&self) -> usize {
        match self.mode {
            Mode::Triangles => self.corners() / 3,
            _ => self.corners().saturating_sub(2),
        }
    }

    /// The corners of a triangle (glTF 2.0 specification, section 3.7.2.1).
    fn triangle(&self, i: usize) -> [usize; 3] {
        match self.mode {
            Mode::TriangleStrip => [i, i + 1 + i % 2, i + 2 - i % 2],
            Mode::TriangleFan => [i + 1, i + 2, 0],
            _ => [3 * i, 3 * i + 1, 3 * i + 2],
        }
    }

    /// The vertex of a corner.
    fn vertex(&self, corner: usize) -> Result<usize, String> {
        let Some(indices) = &self.indices else {
            return Ok(corner);
        };
        let (index, n) = (indices.index(corner) as usize, self.positions.len());
        if index < n {
            Ok(index)
        } else {
            Err(format!("{}: corner {corner} uses vertex {index}, but there are {n} (counted from 0)", self.what))
        }
    }

    /// Appends its triangles, placed. `default` is the number of the default material.
    pub(super) fn add_to(&self, mesh: &mut Mesh, place: &Affine, default: usize) -> Result<(), String> {
        let (of_normals, mirrors) = place.normals();
        let mut numbers: HashMap<usize, u32> = HashMap::new();
        for i in 0..self.triangles() {
            let mut triangle = [0; 3];
            let mut normals = Mesh::FLAT;
            for (k, corner) in self.triangle(i).into_iter().enumerate() {
                let vertex = self.vertex(corner)?;
                let number = match numbers.get(&vertex) {
                    Some(&number) => number,
                    None => {
                        let number = self.add_vertex(mesh, place, &of_normals, vertex)?;
                        numbers.insert(vertex, number);
                        number
                    }
                };
                triangle[k] = number;
                if self.normals.is_some() {
                    normals[k] = number - (mesh.positions.len() - mesh.normals.len()) as u32;
                }
            }
            // What is mirrored shows its front all the same.
            if mirrors {
                triangle.swap(1, 2);
                normals.swap(1, 2);
            }
            mesh.triangles.push(triangle);
            mesh.normal_indices.push(normals);
            mesh.materials.push(self.material.unwrap_or(default) as u32);
        }
        Ok(())
    }

    fn add_vertex(&self, mesh: &mut Mesh, place: &Affine, of_normals: &Affine, vertex: usize) -> Result<u32, String> {
        let position = self.positions.get::<3>(vertex);
        let placed = place.point(position.map(f64::from)).map(|c| c as f32);
        if !placed.iter().all(|c| c.is_finite()) {
            let ([x, y, z], [px, py, pz], what) = (position, placed, &self.what);
            return Err(format!(
                "{what}: vertex {vertex} is ({x}, {y}, {z}), at its place ({px}, {py}, {pz}): it must be finite"
            ));
        }
        let Ok(number) = u32::try_from(mesh.positions.len()) else {
            return Err(format!("{}: there are more than {} vertices: split the scene", self.what, u32::MAX));
        };
        mesh.positions.push(placed);
        if let Some(normals) = &self.normals {
            let normal = of_normals.vector(normals.get::<3>(vertex).map(f64::from));
            mesh.normals.push(direction(normal));
        }
        Ok(number)
    }
}

/// A vector of about unit length; zero for one that has no direction.
fn direction(v: [f64; 3]) -> [f32; 3] {
    let largest = v.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
    let unit = v.map(|c| (c / largest) as f32);
    if unit.iter().all(|c| c.is_finite()) { unit } else { [0.0; 3] }
}
