//! The exact surface area heuristic for a few primitives: cheaper there than bins, and better.

use super::primitive::{Box4, Primitive};
use super::sah::{Best, Split};

/// Most primitives swept; more are binned.
pub(super) const MAX: usize = 8;

/// The cheapest of all splits between neighbours in the order of the centers along an axis.
pub(super) fn best(primitives: &[Primitive]) -> Option<Split> {
    let mut best = Best::new();
    for axis in 0..3 {
        let mut row = [Box4::EMPTY; MAX];
        for (p, rank) in primitives.iter().zip(ranks(primitives, axis)) {
            row[rank % MAX] = p.0;
        }
        best.consider(axis, &row, &[1; MAX], primitives.len());
    }
    best.split()
}

/// Place of each primitive in the order of the centers along an axis.
pub(super) fn ranks(primitives: &[Primitive], axis: usize) -> [usize; MAX] {
    let n = primitives.len().min(MAX);
    let mut keys = [0.0; MAX];
    for (key, p) in keys.iter_mut().zip(primitives) {
        *key = p.center(axis);
    }
    let mut ranks = [0; MAX];
    for i in 1..n {
        let mut rank = 0;
        for j in 0..i {
            let after = usize::from(keys[j] <= keys[i]);
            rank += after;
            ranks[j] += 1 - after;
        }
        ranks[i] = rank;
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;

    /// Some boxes with small whole numbers, so that many centers are equal and no cost rounds.
    fn boxes(n: usize, mut state: u32) -> Vec<Primitive> {
        let mut digit = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 29) as f32
        };
        let mut aabb = || Aabb::of_points([[digit(), digit(), digit()], [digit(), digit(), digit()]]);
        (0..n as u32).map(|id| Primitive::new(&aabb(), id)).collect()
    }

    #[test]
    fn ranks_sort_and_keep_the_order_of_equals() {
        for seed in 0..200 {
            let primitives = boxes(1 + seed as usize % MAX, seed);
            for axis in 0..3 {
                let mut sorted: Vec<usize> = (0..primitives.len()).collect();
                sorted.sort_by(|&a, &b| primitives[a].center(axis).total_cmp(&primitives[b].center(axis)));
                let ranks = ranks(&primitives, axis);
                assert!(sorted.iter().enumerate().all(|(rank, &i)| ranks[i] == rank), "seed {seed}");
            }
        }
    }

    #[test]
    fn no_split_is_cheaper() {
        for seed in 0..500 {
            let primitives = boxes(2 + seed as usize % (MAX - 1), seed);
            let mut costs = Vec::new();
            for axis in 0..3 {
                let mut sorted = primitives.clone();
                sorted.sort_by(|a, b| a.center(axis).total_cmp(&b.center(axis)));
                for k in 1..sorted.len() {
                    let area = |side: &[Primitive]| super::super::primitive::union(side).aabb().half_area();
                    let (below, above) = sorted.split_at(k);
                    let cost = area(below) * below.len() as f32 + area(above) * above.len() as f32;
                    costs.push((cost, axis, k));
                }
            }
            let least = costs.iter().fold(costs[0], |a, &b| if b.0 < a.0 { b } else { a });
            let found = best(&primitives).unwrap();
            assert_eq!((found.cost, found.axis, found.below), least, "seed {seed}");
        }
    }
}
