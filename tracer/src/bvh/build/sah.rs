//! The surface area heuristic over a row of boxes: bins, or primitives in the order of their centers.

use super::primitive::Box8;
use simd::{Halves, Simd, Vector};

/// Most boxes in a row.
pub(super) const MAX_ROW: usize = 16;

/// A plane between two boxes of a row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Split {
    pub(super) axis: usize,
    /// Number of boxes below the plane.
    pub(super) below: usize,
    /// Sum over both sides of half the area times the number of primitives.
    pub(super) cost: f32,
}

/// The cheapest split so far of each eighth plane.
pub(super) struct Best<S: Simd> {
    costs: S::Float8,
    /// Axis times [`MAX_ROW`] plus the number of boxes below.
    at: S::Uint8,
}

impl<S: Simd> Best<S> {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { costs: S::Float8::splat(f32::INFINITY), at: S::Uint8::splat(0) }
    }

    /// Considers the planes between the first `n` boxes of a row, each around `counts` primitives. A side without primitives costs
    /// inf * 0 = NaN, which is never cheaper.
    #[inline(always)]
    pub(super) fn consider<const N: usize>(&mut self, axis: usize, boxes: &[Box8; N], counts: &[u32; N], n: usize) {
        const { assert!(N <= MAX_ROW && N.is_multiple_of(8)) }
        let n = n.min(N);
        // Of plane `k`, between boxes `k` and `k + 1`; those that are none have sides of infinite cost.
        let mut below = Sides { extents: [[f32::INFINITY; 4]; N], counts: [0.0; N] };
        let mut above = Sides { extents: [[f32::INFINITY; 4]; N], counts: [0.0; N] };
        let (mut all, mut count) = (Box8::EMPTY.load::<S>(), 0);
        for k in 0..n - 1 {
            all = all.min(boxes[k].load::<S>());
            count += counts[k];
            below.set::<S>(k, all, count);
        }
        (all, count) = (Box8::EMPTY.load::<S>(), 0);
        for k in (0..n - 1).rev() {
            all = all.min(boxes[k + 1].load::<S>());
            count += counts[k + 1];
            above.set::<S>(k, all, count);
        }
        for first in (0..n - 1).step_by(8) {
            let costs = below.costs::<S>(first) + above.costs::<S>(first);
            let at = S::Uint8::load(&[1, 2, 3, 4, 5, 6, 7, 8]) + S::Uint8::splat((axis * MAX_ROW + first) as u32);
            let is_cheaper = costs.lt(self.costs);
            self.costs = S::Float8::select(is_cheaper, costs, self.costs);
            self.at = S::Uint8::select(is_cheaper, at, self.at);
        }
    }

    /// The first of the cheapest splits; none when no plane has primitives on both sides (or all costs overflow).
    #[inline(always)]
    pub(super) fn split(&self) -> Option<Split> {
        let cost = self.costs.reduce_min();
        let cheapest = self.costs.eq(S::Float8::splat(cost));
        let at = S::Uint8::select(cheapest, self.at, S::Uint8::splat(u32::MAX)).reduce_min() as usize;
        (cost < f32::INFINITY).then_some(Split { axis: at / MAX_ROW, below: at % MAX_ROW, cost })
    }
}

/// What lies on one side of each plane.
#[repr(C, align(64))]
struct Sides<const N: usize> {
    /// Negative lengths of the boxes.
    extents: [[f32; 4]; N],
    counts: [f32; N],
}

impl<const N: usize> Sides<N> {
    #[inline(always)]
    fn set<S: Simd>(&mut self, k: usize, all: S::Float8, count: u32) {
        (all.low() + all.high()).store(&mut self.extents[k]);
        self.counts[k] = count as f32;
    }

    /// Half the area times the number of primitives, for eight planes.
    #[inline(always)]
    fn costs<S: Simd>(&self, first: usize) -> S::Float8 {
        let [x, y, z, _] = S::Float8::load_rows4(&self.extents[first..first + 8]);
        (x * y + y * z + z * x) * S::Float8::load(&self.counts[first..first + 8])
    }
}
