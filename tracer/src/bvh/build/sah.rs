//! The surface area heuristic over a row of boxes: bins, or primitives in the order of their centers.

use super::primitive::Box4;

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

/// The cheapest split so far.
pub(super) struct Best(u64);

impl Best {
    pub(super) fn new() -> Self {
        Self(u64::from(f32::INFINITY.to_bits()) << 32)
    }

    /// Considers the planes between the first `n` boxes of a row, each around `counts` primitives.
    ///
    /// No branch depends on data, for it would often be mispredicted. A side without primitives costs inf * 0 = NaN. The bits of NaN
    /// are above those of infinity, and those of costs below in the order of the numbers, so an integer minimum finds the cheapest.
    #[inline(always)]
    pub(super) fn consider<const N: usize>(&mut self, axis: usize, boxes: &[Box4; N], counts: &[u32; N], n: usize) {
        const { assert!(N <= MAX_ROW) }
        let n = n.min(N);
        let (mut below, mut above) = ([Box4::EMPTY; N], [Box4::EMPTY; N]);
        let mut b = Box4::EMPTY;
        for i in 0..n {
            b = b.union(&boxes[i]);
            below[i] = b;
        }
        b = Box4::EMPTY;
        for i in (0..n).rev() {
            b = b.union(&boxes[i]);
            above[i] = b;
        }
        let total: u32 = counts[..n].iter().sum();
        let mut count = 0;
        for k in 1..n {
            count += counts[k - 1];
            let cost = below[k - 1].half_area() * count as f32 + above[k].half_area() * (total - count) as f32;
            self.0 = self.0.min(u64::from(cost.to_bits()) << 32 | (axis * MAX_ROW + k) as u64);
        }
    }

    /// The first of the cheapest splits; none when no plane has primitives on both sides (or all costs overflow).
    pub(super) fn split(&self) -> Option<Split> {
        let (cost, at) = (f32::from_bits((self.0 >> 32) as u32), self.0 as u32 as usize);
        (at > 0).then_some(Split { axis: at / MAX_ROW, below: at % MAX_ROW, cost })
    }
}
