//! Bins along the three axes, and the cheapest plane between two of them.

use super::primitive::{Box4, Primitive};

pub(super) const BINS: usize = 16;

/// Maps centers to bins.
pub(super) struct Grid {
    origin: [f32; 4],
    scale: [f32; 4],
}

impl Grid {
    /// Equal bins over the box of all centers.
    pub(super) fn new(centers: &Box4) -> Self {
        // A little less than BINS, so that the upper border falls into the last bin.
        let scale = std::array::from_fn(|i| {
            let s = (BINS as f32 - 1.0 / 64.0) / (centers.max[i] - centers.min[i]);
            if s.is_finite() { s } else { 0.0 }
        });
        Self { origin: centers.min, scale }
    }

    /// The bin of a center along each axis (the fourth lane means nothing).
    #[inline(always)]
    pub(super) fn bins(&self, center: [f32; 4]) -> [usize; 4] {
        // In a float near 2^15 the lowest 8 bits are the fraction: a conversion to an integer that vectorizes on every target.
        center_to(center, self).map(|x| ((x + 32768.0).to_bits() >> 8) as usize % BINS)
    }
}

#[inline(always)]
fn center_to(center: [f32; 4], grid: &Grid) -> [f32; 4] {
    std::array::from_fn(|i| (center[i] - grid.origin[i]) * grid.scale[i])
}

/// Number and box of the primitives in each bin of each axis.
#[derive(Clone)]
pub(super) struct Bins {
    boxes: [[Box4; BINS]; 3],
    counts: [[u32; BINS]; 3],
}

/// A plane between two bins.
pub(super) struct Split {
    pub(super) axis: usize,
    /// The first bin above the plane.
    pub(super) bin: usize,
    /// Sum over both sides of half the area times the number of primitives.
    pub(super) cost: f32,
}

impl Bins {
    pub(super) const EMPTY: Self = Self { boxes: [[Box4::EMPTY; BINS]; 3], counts: [[0; BINS]; 3] };

    #[inline(always)]
    pub(super) fn add(&mut self, primitives: &[Primitive], grid: &Grid) {
        for p in primitives {
            let bins = grid.bins(p.center());
            for axis in 0..3 {
                let bin = bins[axis];
                self.boxes[axis][bin] = self.boxes[axis][bin].union(&p.0);
                self.counts[axis][bin] += 1;
            }
        }
    }

    pub(super) fn merge(&mut self, other: &Self) {
        for axis in 0..3 {
            for bin in 0..BINS {
                self.boxes[axis][bin] = self.boxes[axis][bin].union(&other.boxes[axis][bin]);
                self.counts[axis][bin] += other.counts[axis][bin];
            }
        }
    }

    /// The split of least cost, if any plane has primitives on both sides.
    pub(super) fn best(&self) -> Option<Split> {
        // Without branches, which would be mispredicted: an empty side costs inf * 0 = NaN, and the bits of NaN are larger than those of all numbers here.
        let mut above = [[0.0; BINS]; 3];
        let (mut boxes, mut counts) = ([Box4::EMPTY; 3], [0; 3]);
        for bin in (1..BINS).rev() {
            for axis in 0..3 {
                boxes[axis] = boxes[axis].union(&self.boxes[axis][bin]);
                counts[axis] += self.counts[axis][bin];
                above[axis][bin] = boxes[axis].half_area() * counts[axis] as f32;
            }
        }
        let (mut boxes, mut counts) = ([Box4::EMPTY; 3], [0; 3]);
        let mut best = u64::from(f32::INFINITY.to_bits()) << 32;
        for bin in 1..BINS {
            for axis in 0..3 {
                boxes[axis] = boxes[axis].union(&self.boxes[axis][bin - 1]);
                counts[axis] += self.counts[axis][bin - 1];
                let cost = boxes[axis].half_area() * counts[axis] as f32 + above[axis][bin];
                best = best.min(u64::from(cost.to_bits()) << 32 | (axis * BINS + bin) as u64);
            }
        }
        let (cost, at) = (f32::from_bits((best >> 32) as u32), best as u32 as usize);
        (at > 0).then_some(Split { axis: at / BINS, bin: at % BINS, cost })
    }

    /// Number and box of the primitives below and above the plane.
    pub(super) fn sides(&self, split: &Split) -> [(usize, Box4); 2] {
        let (boxes, counts) = (&self.boxes[split.axis], &self.counts[split.axis]);
        [0..split.bin, split.bin..BINS].map(|side| {
            let count = counts[side.clone()].iter().sum::<u32>();
            (count as usize, boxes[side].iter().fold(Box4::EMPTY, |a, b| a.union(b)))
        })
    }
}
