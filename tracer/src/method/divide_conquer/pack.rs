//! Triangles taken apart into boxes and complements, as many at a time as a vector has lanes.

use super::triangles::{Complement, NOTHING};
use crate::bvh::build::primitive::Box8;
use crate::geometry::{Triangle, Vec3};
use crate::lanes::Lanes;
use simd::{Block, Float, Mask, Vector};

/// The vertices of triangles by their place.
pub(super) type Vertices<'a> = &'a (dyn Fn(usize) -> [[f32; 3]; 3] + Sync);

/// Packs the triangles from `first` on.
pub(super) struct Pack<'a> {
    pub(super) vertices: Vertices<'a>,
    pub(super) first: usize,
    /// One for each triangle.
    pub(super) boxes: &'a mut [Box8],
    /// As many.
    pub(super) complements: &'a mut [Complement],
}

impl Lanes for Pack<'_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let Self { vertices, first, boxes, complements } = self;
        let mut at = 0;
        while at < boxes.len() {
            let n = F::LANES.min(boxes.len() - at);
            // By vertex and axis; those behind the last triangle are points.
            let mut columns = [[Block([0.0; 16]); 3]; 3];
            for lane in 0..n {
                for (columns, row) in columns.iter_mut().zip(&vertices(first + at + lane)) {
                    for (column, x) in columns.iter_mut().zip(row) {
                        column.0[lane] = *x;
                    }
                }
            }
            let v0 = Vec3::<F>::load(&columns[0], 0);
            let (e1, e2) = (Vec3::load(&columns[1], 0) - v0, Vec3::load(&columns[2], 0) - v0);
            let (mut box_rows, mut rest) = ([[0.0; 8]; 16], [[0.0; 4]; 16]);
            let doubtful = pack::<F>([v0, e1, e2], &mut box_rows, &mut rest);
            let edges = [v0, e1, e2].map(|v| [v.x.to_block(), v.y.to_block(), v.z.to_block()]);
            for lane in 0..n {
                let [x, y, z, code] = rest[lane];
                boxes[at + lane] = Box8(box_rows[lane]);
                complements[at + lane] = Complement { middle: [x, y, z], code: code.to_bits() };
                if doubtful >> lane & 1 != 0 && is_degenerate(&edges, lane) {
                    (boxes[at + lane], complements[at + lane]) = NOTHING;
                }
            }
            at += n;
        }
    }
}

#[cold]
#[inline(never)]
fn is_degenerate(edges: &[[Block<f32>; 3]; 3], lane: usize) -> bool {
    let [v0, e1, e2] = [0, 1, 2].map(|k| [0, 1, 2].map(|axis: usize| edges[k][axis].0[lane]));
    Triangle { v0, id: 0, e1, material: 0, e2, geometry: 0 }.is_degenerate()
}

/// Rows of boxes and complements; returns which triangles may be degenerate: few that are not.
#[inline(always)]
fn pack<F: Float>([v0, e1, e2]: [Vec3<F>; 3], boxes: &mut [[f32; 8]; 16], rest: &mut [[f32; 4]; 16]) -> u32 {
    let zero = F::splat(0.0);
    let (x, in_x) = axis(v0.x, e1.x, e2.x, 0);
    let (y, in_y) = axis(v0.y, e1.y, e2.y, 1);
    let (z, in_z) = axis(v0.z, e1.z, e2.z, 2);
    F::store_rows8([x[0], y[0], z[0], zero, -x[2], -y[2], -z[2], zero], &mut boxes[..]);
    F::store_rows4([x[1], y[1], z[1], F::from_bits(in_x | in_y | in_z)], &mut rest[..]);
    // As the cheap part of `Triangle::is_degenerate`. Zero times a number is zero unless that is infinite or none.
    let normal = e1.cross(e2);
    let (square, squares) = (normal.dot(normal), e1.dot(e1) * e2.dot(e2));
    let finite = (x[0] * zero + x[2] * zero) + (y[0] * zero + y[2] * zero) + (z[0] * zero + z[2] * zero);
    let sound = F::splat(1e-20).lt(square) & (F::splat(1e-6) * squares).lt(square) & finite.eq(zero);
    !sound.bitmask()
}

/// The smallest, the middle and the largest of a triangle's coordinates on an axis, and its part of the code: see [`Complement`].
#[inline(always)]
fn axis<F: Float>(v0: F, e1: F, e2: F, axis: usize) -> ([F; 3], F::Index) {
    let (v1, v2) = (v0 + e1, v0 + e2);
    let (p, q, r) = (place(v0), place(v1), place(v2));
    let order = bit::<F>(p.le(q), 0) | bit::<F>(p.le(r), 1) | bit::<F>(q.le(r), 2);
    let steps = low_bits(e1, v1 - v0) | low_bits(e2, v2 - v0) << 3;
    let (low, high) = (p.min(q).min(r), p.max(q).max(r));
    let middle = p ^ q ^ r ^ low ^ high;
    let code = order << (3 * axis) | steps << (9 + 6 * axis);
    ([unplace::<F>(low), unplace::<F>(middle), unplace::<F>(high)], code)
}

#[inline(always)]
fn bit<F: Float>(mask: F::Mask, k: usize) -> F::Index {
    F::Index::select(mask, F::Index::splat(1 << k), F::Index::splat(0))
}

/// The lowest three bits of how many numbers an edge is above a difference. (Modulo 8: lanes of plain integers must not overflow.)
#[inline(always)]
fn low_bits<F: Float>(edge: F, difference: F) -> F::Index {
    use simd::Int;
    let seven = F::Index::splat(7);
    let (a, b) = (place(edge).to_uint() & seven, place(difference).to_uint() & seven);
    (a + F::Index::splat(8) - b) & seven
}

/// Numbers in their order, bits and all: neighbours differ by one.
#[inline(always)]
fn place<F: Float>(x: F) -> F::Int {
    turn::<F>(x.to_bits())
}

#[inline(always)]
fn unplace<F: Float>(place: F::Int) -> F {
    use simd::Int;
    F::from_bits(turn::<F>(place.to_uint()).to_uint())
}

/// Turns the order of negative numbers round.
#[inline(always)]
fn turn<F: Float>(bits: F::Index) -> F::Int {
    use simd::Int;
    let bits = F::Int::from_uint(bits);
    bits ^ F::Int::from_uint((bits >> 31).to_uint() >> 1)
}
