//! Triangles as files hold them.

use crate::Error;
use crate::bvh::Node;
use crate::geometry::Aabb;

/// An indexed triangle mesh. Primitive ids are places in [`Mesh::triangles`].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Vertex positions.
    pub positions: Vec<[f32; 3]>,
    /// Three positions each.
    pub triangles: Vec<[u32; 3]>,
    /// Unit vertex normals; may be empty.
    pub normals: Vec<[f32; 3]>,
    /// Three normals for each triangle, or [`Mesh::FLAT`] for a flat one; empty when no triangle has any.
    pub normal_indices: Vec<[u32; 3]>,
    /// Texture coordinates: (0, 0) is the lower left of an image, (1, 1) its upper right. Empty where nothing has a texture.
    pub uvs: Vec<[f32; 2]>,
    /// Three texture coordinates for each triangle, or [`Mesh::FLAT`] for one without; empty when no triangle has any.
    pub uv_indices: Vec<[u32; 3]>,
    /// Material of each triangle; empty when all use material 0.
    pub materials: Vec<u32>,
}

impl Mesh {
    /// The entry of [`Mesh::normal_indices`] for a triangle without vertex normals, and of [`Mesh::uv_indices`] for one without texture
    /// coordinates.
    pub const FLAT: [u32; 3] = [u32::MAX; 3];

    /// The three corners of a triangle.
    ///
    /// # Panics
    /// When there is no triangle `i`, or it names a vertex that is not there (see [`Mesh::validate`]).
    #[inline]
    #[must_use]
    pub fn triangle(&self, i: usize) -> [[f32; 3]; 3] {
        let [a, b, c] = self.triangles[i];
        [self.positions[a as usize], self.positions[b as usize], self.positions[c as usize]]
    }

    /// Material index of a triangle.
    ///
    /// # Panics
    /// When materials are listed, but not for triangle `i`.
    #[inline]
    #[must_use]
    pub fn material(&self, i: usize) -> u32 {
        if self.materials.is_empty() { 0 } else { self.materials[i] }
    }

    /// The smallest box around all vertices, used by a triangle or not; [`Aabb::EMPTY`] when there are none.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        Aabb::of_points(self.positions.iter().copied())
    }

    /// Checks all that a tree, a method or a renderer relies on: at least one and at most [`Node::MAX_TRIANGLES`]
    /// triangles, finite positions and normals, indices that name what exists, and lists of matching length. (Whether the
    /// materials exist only the scene can tell: [`Model::validate`](super::Model::validate).)
    ///
    /// # Errors
    /// [`Error::Geometry`] with the number of the first vertex or triangle at fault (from 0) and what to do.
    pub fn validate(&self) -> Result<(), Error> {
        let n = self.triangles.len();
        if n == 0 {
            return geometry("the mesh has no triangles: give it at least one".into());
        }
        if n > Node::MAX_TRIANGLES {
            let most = Node::MAX_TRIANGLES;
            return geometry(format!("the mesh has {n} triangles, {most} is the most: split it"));
        }
        for (what, list) in [("vertex", &self.positions), ("normal", &self.normals)] {
            if let Some(i) = list.iter().position(|p| !p.iter().all(|c| c.is_finite())) {
                let [x, y, z] = list[i];
                return geometry(format!(
                    "{what} {i} is ({x}, {y}, {z}): every coordinate must be a finite number, correct or remove it"
                ));
            }
        }
        if let Some(i) = self.uvs.iter().position(|p| !p.iter().all(|c| c.is_finite())) {
            let [u, v] = self.uvs[i];
            return geometry(format!(
                "texture coordinate {i} is ({u}, {v}): both must be finite numbers, correct or remove it"
            ));
        }
        let normals = ("normal indices", self.normal_indices.len());
        let uvs = ("texture coordinate indices", self.uv_indices.len());
        for (what, len) in [normals, uvs, ("materials", self.materials.len())] {
            if len != 0 && len != n {
                return geometry(format!(
                    "there are {len} {what} for {n} triangles: give one for each triangle, or none at all"
                ));
            }
        }
        in_range("vertex", &self.triangles, self.positions.len(), None)?;
        in_range("normal", &self.normal_indices, self.normals.len(), Some(Self::FLAT))?;
        in_range("texture coordinate", &self.uv_indices, self.uvs.len(), Some(Self::FLAT))
    }

    /// Makes normals unit vectors, and triangles flat that have one of length zero; without normals where all are flat.
    pub(super) fn unit_normals(&mut self) {
        let zero: Vec<bool> = self.normals.iter_mut().map(|n| !make_unit(n)).collect();
        for triple in self.normal_indices.iter_mut().filter(|t| **t != Self::FLAT) {
            if triple.iter().any(|&n| zero[n as usize]) {
                *triple = Self::FLAT;
            }
        }
        if self.normal_indices.iter().all(|t| *t == Self::FLAT) {
            (self.normals, self.normal_indices) = (Vec::new(), Vec::new());
        }
    }
}

/// False when the vector is zero. One that is of unit length but for rounding keeps its bits.
fn make_unit(normal: &mut [f32; 3]) -> bool {
    let square: f64 = normal.iter().map(|&x| f64::from(x) * f64::from(x)).sum();
    if (square - 1.0).abs() > 4.0 * f64::from(f32::EPSILON) && square > 0.0 {
        let length = square.sqrt();
        *normal = normal.map(|x| (f64::from(x) / length) as f32);
    }
    square > 0.0
}

/// Every index is below `len`, unless the whole triple is `except`.
fn in_range(what: &str, triples: &[[u32; 3]], len: usize, except: Option<[u32; 3]>) -> Result<(), Error> {
    let bad = |t: &[u32; 3]| t.iter().any(|&v| v as usize >= len) && Some(*t) != except;
    let Some(i) = triples.iter().position(bad) else {
        return Ok(());
    };
    let index = triples[i].into_iter().find(|&v| v as usize >= len).unwrap_or_default();
    geometry(format!(
        "triangle {i} uses {what} {index}, but there are {len} (counted from 0): correct the index or remove the triangle"
    ))
}

fn geometry(message: String) -> Result<(), Error> {
    Err(Error::Geometry(message))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Mesh {
        Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 2.0, 0.0], [0.0, 2.0, -1.0]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            normals: vec![[0.0, 0.0, 1.0]],
            normal_indices: vec![[0; 3], Mesh::FLAT],
            uvs: vec![[0.5, 2.0]],
            uv_indices: vec![[0; 3], Mesh::FLAT],
            materials: vec![0, 1],
        }
    }

    #[test]
    fn reads_back_triangles_and_bounds() {
        let m = square();
        assert_eq!(m.triangle(1), [[0.0; 3], [1.0, 2.0, 0.0], [0.0, 2.0, -1.0]]);
        assert_eq!(m.bounds(), Aabb { min: [0.0, 0.0, -1.0], max: [1.0, 2.0, 0.0] });
        assert_eq!((m.material(1), Mesh { materials: vec![], ..m }.material(1)), (1, 0));
    }

    /// Each kind of damage is refused with a message that names the place.
    #[test]
    fn validate_names_the_fault() {
        square().validate().expect("a sound mesh");
        Mesh { materials: vec![], uv_indices: vec![], normals: vec![], normal_indices: vec![], ..square() }
            .validate()
            .expect("bare");
        type Damage = fn(&mut Mesh);
        let cases: [(Damage, &str); 12] = [
            (|m| m.positions[2][1] = f32::NAN, "vertex 2 is (1, NaN, 0)"),
            (|m| m.positions[3][0] = f32::INFINITY, "vertex 3 is (inf"),
            (|m| m.normals[0][0] = f32::NEG_INFINITY, "normal 0 is (-inf"),
            (|m| m.triangles[1][2] = 4, "triangle 1 uses vertex 4, but there are 4"),
            (|m| m.triangles[0] = Mesh::FLAT, "triangle 0 uses vertex 4294967295"),
            (|m| m.normal_indices[0][1] = 1, "triangle 0 uses normal 1, but there are 1"),
            (|m| m.normal_indices[1][0] = 0, "triangle 1 uses normal 4294967295"),
            (|m| m.uvs[0][1] = f32::NAN, "texture coordinate 0 is (0.5, NaN)"),
            (|m| m.uv_indices[1][2] = 1, "triangle 1 uses texture coordinate 4294967295"),
            (|m| m.uv_indices.push([0; 3]), "3 texture coordinate indices for 2 triangles"),
            (|m| m.triangles.clear(), "no triangles"),
            (|m| m.materials.push(0), "3 materials for 2 triangles"),
        ];
        for (damage, expected) in cases {
            let mut m = square();
            damage(&mut m);
            let message = m.validate().expect_err(expected).to_string();
            assert!(message.contains(expected), "{message:?} should contain {expected:?}");
        }
    }
}
