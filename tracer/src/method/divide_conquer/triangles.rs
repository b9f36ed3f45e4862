//! Triangles as boxes and what boxes leave out (section 3.3): 48 bytes each, from which [`Triangle`]s come back bit for bit.

use super::partition::Range;
use crate::Error;
use crate::bvh::build::primitive::{Box8, centers_of};
use crate::geometry::Triangle;
use crate::model::Mesh;
use rayon::prelude::*;

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

/// The middle coordinate on each axis, and the code: from bit 3 `a` on, which [`ORDERS`] the axis has; from bit 9 on, three bits for
/// each coordinate of `e1` and `e2`, see [`steps`].
#[derive(Debug, Clone, Copy)]
#[repr(C, align(16))]
struct Complement {
    middle: [f32; 3],
    code: u32,
}

/// Places of the three vertices' coordinates among smallest, middle and largest.
const ORDERS: [[u8; 3]; 8] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0], [0, 1, 2], [0, 1, 2]];

/// In place of a degenerate triangle.
const NOTHING: (Box8, Complement) = (Box8::EMPTY, Complement { middle: [0.0; 3], code: 0 });

/// Which of [`ORDERS`] it is, by whether the first vertex comes before the second, before the third, and the second before the third.
/// (The third before the first, that before the second, and this before the third: cannot be.)
const ORDER_OF: [u32; 8] = [5, 3, 0, 1, 4, 0, 2, 0];

impl TriangleBoxes {
    /// Bytes for each triangle.
    pub(super) const BYTES: usize = size_of::<Box8>() + size_of::<Complement>();

    /// Takes the boxes; divides nothing yet.
    ///
    /// # Errors
    /// [`Error::Geometry`] as [`Mesh::validate`].
    pub fn new(mesh: &Mesh) -> Result<Self, Error> {
        mesh.validate()?;
        let n = mesh.triangles.len();
        let (mut boxes, mut complements) = (simd::vec_in_huge_pages(n), simd::vec_in_huge_pages(n));
        let packed = (0..n).into_par_iter().with_min_len(4096).map(|i| {
            let triangle = Triangle::new(mesh.triangle(i), i as u32, mesh.material(i));
            if triangle.is_degenerate() { NOTHING } else { pack(&triangle) }
        });
        packed.unzip_into_vecs(&mut boxes, &mut complements);
        Ok(Self::of_packed(boxes, complements))
    }

    /// Of triangles in any order, by their ids; degenerate ones are passed over.
    #[must_use]
    pub fn of_triangles(triangles: &[Triangle]) -> Self {
        let n = triangles.iter().map(|t| t.id as usize + 1).max().unwrap_or(0);
        let mut packed = vec![NOTHING; n];
        for triangle in triangles.iter().filter(|t| !t.is_degenerate()) {
            packed[triangle.id as usize] = pack(triangle);
        }
        let (boxes, complements) = packed.into_iter().unzip();
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

fn pack(triangle: &Triangle) -> (Box8, Complement) {
    let mut b = Box8([0.0; 8]);
    let (mut middle, mut code) = ([0.0; 3], 0);
    for (axis, middle) in middle.iter_mut().enumerate() {
        let v0 = triangle.v0[axis];
        let numbers = [v0, v0 + triangle.e1[axis], v0 + triangle.e2[axis]];
        // Bits and all: of zeros the negative one is the smaller here.
        let [p, q, r] = [place(numbers[0]), place(numbers[1]), place(numbers[2])];
        let order = ORDER_OF[usize::from(p <= q) | usize::from(p <= r) << 1 | usize::from(q <= r) << 2];
        let mut sorted = [0.0; 4];
        for (k, x) in numbers.into_iter().enumerate() {
            sorted[(ORDERS[order as usize & 7][k] & 3) as usize] = x;
        }
        (b.0[axis], *middle, b.0[4 + axis]) = (sorted[0], sorted[1], -sorted[2]);
        code |= order << (3 * axis);
        for (k, edge) in [triangle.e1[axis], triangle.e2[axis]].into_iter().enumerate() {
            let steps = place(edge) - place(numbers[k + 1] - v0);
            debug_assert!((-4..4).contains(&steps), "{triangle:?}");
            code |= (steps as u32 & 7) << (9 + 3 * (2 * axis + k));
        }
    }
    (b, Complement { middle, code })
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

    fn check(vertices: [[f32; 3]; 3]) -> bool {
        let t = Triangle::new(vertices, 0, 0);
        if t.is_degenerate() {
            return false;
        }
        let (b, complement) = pack(&t);
        assert_eq!(b.aabb(), t.bounds(), "{vertices:?}");
        let all = Range { first: 0, end: 1, bounds: b, centers: b };
        let back = TriangleBoxes { boxes: vec![b], complements: vec![complement], ids: vec![0], all }.get(0);
        assert_eq!(bits(&back), bits(&t), "{vertices:?}");
        complement.code >> 9 != 0
    }

    #[test]
    fn forty_eight_bytes() {
        assert_eq!(TriangleBoxes::BYTES, 48);
    }

    #[test]
    fn triangles_come_back_bit_for_bit() {
        let mut random = Random(5);
        let mut corrected = 0;
        for i in 0..1_000_000_u32 {
            let mut corner = || {
                let mut p = random.point(1.0);
                for x in &mut p {
                    *x *= [1.0, 1e-3, 1e-7, 1e6, 0.0, -0.0, 1e-42, 1e30]
                        [random.bits() as usize % [1, 2, 4, 8][i as usize % 4]];
                }
                p
            };
            corrected += u32::from(check([corner(), corner(), corner()]));
        }
        println!("{corrected} with an edge that is no difference");
        assert!(corrected > 1000, "{corrected}");
    }
}
