//! The exact surface area heuristic for a few primitives: cheaper there than bins, and better.

use super::primitive::{Box4, Primitive};

/// Most primitives swept; more are binned.
pub(super) const MAX: usize = 8;

/// The cheapest of all splits between neighbours along an axis.
pub(super) struct Split {
    /// Place of each primitive in the order along the axis.
    pub(super) ranks: [usize; MAX],
    /// Number of primitives on the lower side.
    pub(super) lower: usize,
    /// Sum over both sides of half the area times the number of primitives.
    pub(super) cost: f32,
    pub(super) sides: [Box4; 2],
}

pub(super) fn best(primitives: &[Primitive]) -> Split {
    let n = primitives.len().min(MAX);
    let primitives = &primitives[..n];
    let mut best = Split { ranks: std::array::from_fn(|i| i), lower: n / 2, cost: f32::INFINITY, sides: [Box4::EMPTY; 2] };
    let mut keys = [[0.0; 4]; MAX];
    for (key, p) in keys.iter_mut().zip(primitives) {
        *key = p.center();
    }
    for axis in 0..3 {
        let mut ranks = [0; MAX];
        for i in 1..n {
            for j in 0..i {
                let after = usize::from(keys[j][axis] <= keys[i][axis]);
                ranks[i] += after;
                ranks[j] += 1 - after;
            }
        }
        let mut lower = [Box4::EMPTY; MAX];
        for (p, rank) in primitives.iter().zip(ranks) {
            lower[rank % MAX] = p.0;
        }
        let mut upper = lower;
        for i in 1..n {
            lower[i] = lower[i].union(&lower[i - 1]);
        }
        for i in (0..n - 1).rev() {
            upper[i] = upper[i].union(&upper[i + 1]);
        }
        for k in 1..n {
            let cost = lower[k - 1].half_area() * k as f32 + upper[k].half_area() * (n - k) as f32;
            if cost < best.cost {
                best = Split { ranks, lower: k, cost, sides: [lower[k - 1], upper[k]] };
            }
        }
    }
    best
}
