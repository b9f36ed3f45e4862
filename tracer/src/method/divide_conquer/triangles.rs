//! Triangles as boxes and what boxes leave out (section 3.3): 48 bytes each, from which [`Triangle`]s come back bit for bit.

use super::pack::{Pack, Vertices};
use super::partition::Range;
use crate::Error;
use crate::bvh::build::primitive::{Box8, centers_of};
use crate::geometry::Triangle;
use crate::lanes::{self, Width};
use crate::model::Mesh;
use rayon::prelude::*;
use simd::Level;

/// The triangles of a mesh as [`DivideConquer`](super::DivideConquer) wants them: in no order but the mesh's.
///
/// The box holds six of the nine coordinates of a triangle's vertices, the smallest and the largest on each axis. The complement has the
/// three others, and a code of which is whose.
#[derive(Debug, Clone)]
pub struct TriangleBoxes {
    pub(super) boxes: Vec<Box8>,
    complements: Vec<Complement>,
    /// Of those that something can hit.
    pub(super) ids: Vec<u32>,
    pub(super) all: Range,
}

/// The middle coordinate on each axis, and the code: from bit 3 `a` on, which of [`ORDERS`] axis `a` has; from bit 9 on, three bits for
/// each of `e1` and `e2` on each axis, see [`correct`].
#[derive(Debug, Clone, Copy)]
#[repr(C, align(16))]
pub(super) struct Complement {
    pub(super) middle: [f32; 3],
    pub(super) code: u32,
}

/// In place of a degenerate triangle.
pub(super) const NOTHING: (Box8, Complement) = (Box8::EMPTY, Complement { middle: [0.0; 3], code: 0 });

/// Places of the three vertices' coordinates among smallest, middle and largest, by whether the first is at most the second (bit 0), at most the third (bit 1),
/// and the second at most the third (bit 2). Of these, 2 and 5 cannot be.
const ORDERS: [[u8; 3]; 8] = [[2, 1, 0], [1, 2, 0], [0, 1, 2], [0, 2, 1], [2, 0, 1], [0, 1, 2], [1, 0, 2], [0, 1, 2]];

/// Triangles that one thread packs at a time.
const PORTION: usize = 1 << 12;

impl TriangleBoxes {
    /// Bytes for each triangle.
    pub(super) const BYTES: usize = size_of::<Box8>() + size_of::<Complement>();

    /// Takes the boxes; divides nothing yet.
    ///
    /// # Errors
    /// [`Error::Geometry`] as [`Mesh::validate`].
    pub fn new(mesh: &Mesh) -> Result<Self, Error> {
        mesh.validate()?;
        Ok(Self::pack(mesh.triangles.len(), &|i| mesh.triangle(i)))
    }

    fn pack(n: usize, vertices: Vertices<'_>) -> Self {
        let (mut boxes, mut complements) = (simd::vec_in_huge_pages(n), simd::vec_in_huge_pages(n));
        boxes.resize(n, NOTHING.0);
        complements.resize(n, NOTHING.1);
        let portions = boxes.par_chunks_mut(PORTION).zip(complements.par_chunks_mut(PORTION)).enumerate();
        portions.for_each(|(i, (boxes, complements))| {
            let job = Pack { vertices, first: PORTION * i, boxes, complements };
            lanes::run_long(Level::best(), Width::Auto, job);
        });
        Self::of_packed(boxes, complements)
    }

    fn of_packed(boxes: Vec<Box8>, complements: Vec<Complement>) -> Self {
        let mut ids = simd::vec_in_huge_pages(boxes.len());
        let (mut bounds, mut centers) = (Box8::EMPTY, Box8::EMPTY);
        for (id, b) in boxes.iter().enumerate().filter(|(_, b)| !b.is_empty()) {
            ids.push(id as u32);
            (bounds, centers) = (bounds.union(b), centers.union(&centers_of(b)));
        }
        let all = Range { first: 0, end: ids.len(), bounds, centers };
        Self { boxes, complements, ids, all }
    }

    /// Bytes held.
    #[must_use]
    pub fn memory(&self) -> usize {
        Self::BYTES * self.boxes.len() + size_of::<u32>() * self.ids.len()
    }

    /// Triangle `id`, which is not degenerate.
    #[inline(always)]
    pub(super) fn get(&self, id: u32) -> Triangle {
        let (b, c) = (&self.boxes[id as usize].0, &self.complements[id as usize]);
        let mut triangle = Triangle { v0: [0.0; 3], id, e1: [0.0; 3], material: 0, e2: [0.0; 3], geometry: 0 };
        for axis in 0..3 {
            let numbers = [b[axis], c.middle[axis], -b[4 + axis], 0.0];
            let order = ORDERS[(c.code >> (3 * axis) & 7) as usize];
            let at = |k: usize| numbers[(order[k] & 3) as usize];
            let v0 = at(0);
            (triangle.v0[axis], triangle.e1[axis], triangle.e2[axis]) = (v0, at(1) - v0, at(2) - v0);
        }
        if c.code >> 9 != 0 {
            correct(&mut triangle, c.code);
        }
        triangle
    }
}

/// Edges are not always the differences of the vertices `v0`, `v0 + e1` and `v0 + e2` as rounded: if the second is more than twice as large as
/// `v0`, its last bit can be worth two or four of the edge's. Then the code says how many numbers up or down the edge is. (Where it is at most
/// twice as large, either the difference or the sum is exact; Sterbenz 1974.) Negative zero is one below zero.
#[cold]
fn correct(triangle: &mut Triangle, code: u32) {
    for axis in 0..3 {
        for (k, edge) in [&mut triangle.e1[axis], &mut triangle.e2[axis]].into_iter().enumerate() {
            // Three bits with a sign.
            let steps = (code << (20 - 3 * (2 * axis + k))) as i32 >> 29;
            let p = place(*edge) + steps;
            *edge = f32::from_bits((p ^ ((p >> 31) as u32 >> 1) as i32) as u32);
        }
    }
}

/// Numbers in their order: neighbours differ by one.
fn place(x: f32) -> i32 {
    let bits = x.to_bits() as i32;
    bits ^ ((bits >> 31) as u32 >> 1) as i32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::random::Random;

    fn bits(t: &Triangle) -> [[u32; 3]; 3] {
        [t.v0, t.e1, t.e2].map(|v| v.map(f32::to_bits))
    }

    /// Packs triangles at all levels, and takes them back; returns how many have an edge that is no difference.
    fn check(vertices: &[[[f32; 3]; 3]]) -> usize {
        let triangles: Vec<Triangle> = (0..).zip(vertices).map(|(id, v)| Triangle::new(*v, id, 0)).collect();
        let packed = TriangleBoxes::pack(vertices.len(), &|i| vertices[i]);
        for level in Level::available() {
            let (mut boxes, mut complements) = (vec![NOTHING.0; vertices.len()], vec![NOTHING.1; vertices.len()]);
            let job = Pack { vertices: &|i| vertices[i], first: 0, boxes: &mut boxes, complements: &mut complements };
            lanes::run_long(level, Width::Auto, job);
            let same = boxes.iter().zip(&packed.boxes).all(|(a, b)| a.0.map(f32::to_bits) == b.0.map(f32::to_bits));
            let codes =
                complements.iter().zip(&packed.complements).all(|(a, b)| a.code == b.code && a.middle == b.middle);
            assert!(same && codes, "{level}");
        }
        let mut corrected = 0;
        for (id, triangle) in (0..).zip(&triangles) {
            assert_eq!(packed.boxes[id as usize].is_empty(), triangle.is_degenerate(), "{triangle:?}");
            if !triangle.is_degenerate() {
                assert_eq!(packed.boxes[id as usize].aabb(), triangle.bounds(), "{triangle:?}");
                assert_eq!(bits(&packed.get(id)), bits(triangle), "{triangle:?}");
                corrected += usize::from(packed.complements[id as usize].code >> 9 != 0);
            }
        }
        assert!(packed.ids.iter().all(|&id| !triangles[id as usize].is_degenerate()));
        corrected
    }

    #[test]
    fn forty_eight_bytes() {
        assert_eq!(TriangleBoxes::BYTES, 48);
    }

    #[test]
    fn triangles_come_back_bit_for_bit() {
        let mut random = Random(5);
        let mut corrected = 0;
        for i in 0..50 {
            let mut corner = || {
                let mut p = random.point(1.0);
                for x in &mut p {
                    let kinds = [1, 2, 4, 8, 10][i % 5];
                    let scales = [1.0, 1e-3, 1e-7, 1e6, 0.0, -0.0, 1e-42, 1e30, f32::MAX, 1e-20];
                    *x *= scales[random.bits() as usize % kinds];
                }
                p
            };
            let vertices: Vec<[[f32; 3]; 3]> = (0..10_007).map(|_| [corner(), corner(), corner()]).collect();
            corrected += check(&vertices);
        }
        println!("{corrected} with an edge that is no difference");
        assert!(corrected > 1000, "{corrected}");
    }
}
