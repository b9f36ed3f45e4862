//! Triangles of meshes.

use super::Notes;
use super::accessor::Values;
use super::buffers::Buffers;
use super::graph::Affine;
use super::materials::base_texture;
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
    /// With the map of texture coordinates.
    uvs: Option<(Values<'a>, UvMap)>,
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
        let uvs = uvs(primitive, buffers).map_err(fail)?;
        if uvs.as_ref().is_some_and(|(uvs, _)| uvs.len() != positions.len()) {
            return Err(fail(format!(
                "it has other numbers of positions ({}) and texture coordinates",
                positions.len()
            )));
        }
        let indices =
            primitive.indices().map(|a| Values::new(buffers, &a, Dimensions::Scalar)).transpose().map_err(fail)?;
        if indices.as_ref().is_some_and(|i| !i.are_indices()) {
            return Err(fail("its indices are no whole numbers without sign".into()));
        }
        let material = primitive.material().index();
        let shape = Self { mode, positions, normals, uvs, indices, material, what: String::new() };
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
            let (mut normals, mut uvs) = (Mesh::FLAT, Mesh::FLAT);
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
                if self.uvs.is_some() {
                    uvs[k] = number - (mesh.positions.len() - mesh.uvs.len()) as u32;
                }
            }
            // What is mirrored shows its front all the same.
            if mirrors {
                triangle.swap(1, 2);
                normals.swap(1, 2);
                uvs.swap(1, 2);
            }
            mesh.triangles.push(triangle);
            mesh.normal_indices.push(normals);
            mesh.uv_indices.push(uvs);
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
        if let Some((uvs, map)) = &self.uvs {
            let [u, v] = map.apply(uvs.get::<2>(vertex));
            if !(u.is_finite() && v.is_finite()) {
                return Err(format!("{}: texture coordinate {vertex} is ({u}, {v}), both must be finite", self.what));
            }
            mesh.uvs.push([u, v]);
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

/// The texture coordinates that the material's texture asks for.
fn uvs<'a>(primitive: &Primitive<'_>, buffers: &'a Buffers) -> Result<Option<(Values<'a>, UvMap)>, String> {
    let Some(info) = base_texture(&primitive.material()) else {
        return Ok(None);
    };
    let transform = info.texture_transform();
    let set = transform.as_ref().and_then(|t| t.tex_coord()).unwrap_or(info.tex_coord());
    let Some(accessor) = primitive.get(&Semantic::TexCoords(set)) else {
        return Ok(None);
    };
    let values = Values::new(buffers, &accessor, Dimensions::Vec2)?;
    Ok(Some((values, transform.map_or(UvMap::IDENTITY, |t| UvMap::new(t.offset(), t.rotation(), t.scale())))))
}

/// An affine map of texture coordinates: two columns, and where the origin goes.
struct UvMap([[f64; 2]; 3]);

impl UvMap {
    const IDENTITY: Self = Self([[1.0, 0.0], [0.0, 1.0], [0.0; 2]]);

    /// Scale, then rotation, then offset (KHR_texture_transform).
    fn new(offset: [f32; 2], rotation: f32, [s, t]: [f32; 2]) -> Self {
        let (sin, cos) = libm::sincos(rotation.into());
        let [s, t] = [f64::from(s), f64::from(t)];
        Self([[s * cos, -s * sin], [t * sin, t * cos], offset.map(f64::from)])
    }

    /// From glTF, whose images begin at the top, to the mesh's coordinates, where they end there.
    fn apply(&self, [u, v]: [f32; 2]) -> [f32; 2] {
        let [a, b, origin] = self.0;
        let [u, v] = [f64::from(u), f64::from(v)];
        [(a[0] * u + b[0] * v + origin[0]) as f32, (1.0 - (a[1] * u + b[1] * v + origin[1])) as f32]
    }
}
