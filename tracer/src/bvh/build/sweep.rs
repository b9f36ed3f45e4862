//! The exact surface area heuristic for a few primitives: cheaper there than bins, and better.

use super::primitive::{Box8, Primitive};
use super::sah::{Best, Split};
use simd::{Level, Simd, Vector, kernel};

/// Most primitives swept; more are binned.
pub(super) const MAX: usize = 8;

/// A split between primitives in the order of their centers along its axis.
pub(super) struct Sweep {
    pub(super) split: Split,
    /// Place of each primitive in that order.
    pub(super) ranks: [u32; MAX],
}

/// The cheapest of all splits between neighbours in the order of the centers along an axis.
pub(super) fn best(level: Level, primitives: &[Primitive]) -> Option<Sweep> {
    kernel! {
        fn best<S>(primitives: &[Primitive]) -> Option<Sweep> {
            let n = primitives.len().min(MAX);
            // Behind all others, where there is none.
            let mut centers = [[f32::INFINITY; 4]; MAX];
            for i in 0..n {
                primitives[i].centers::<S>().store(&mut centers[i]);
            }
            let [x, y, z, _] = S::Float8::load_rows4(&centers);
            let ranks = [ranks::<S>(x, &centers, 0), ranks::<S>(y, &centers, 1), ranks::<S>(z, &centers, 2)];
            let mut best = Best::<S>::new();
            for (axis, ranks) in ranks.iter().enumerate() {
                let mut row = [Box8::EMPTY; MAX];
                for i in 0..n {
                    row[ranks[i] as usize % MAX] = primitives[i].0;
                }
                best.consider(axis, &row, &[1; MAX], n);
            }
            best.split().map(|split| Sweep { split, ranks: ranks[split.axis] })
        }
    }
    best(level, primitives)
}

/// Place of each center in their order along an axis; equal ones in the order they have.
#[inline(always)]
fn ranks<S: Simd>(centers: S::Float8, rows: &[[f32; 4]; MAX], axis: usize) -> [u32; MAX] {
    let lanes = S::Uint8::load(&[0, 1, 2, 3, 4, 5, 6, 7]);
    let mut ranks = S::Uint8::splat(0);
    for (j, row) in rows.iter().enumerate() {
        let other = S::Float8::splat(row[axis]);
        let before = other.lt(centers) | (other.eq(centers) & S::Uint8::splat(j as u32).lt(lanes));
        ranks += S::Uint8::select(before, S::Uint8::splat(1), S::Uint8::splat(0));
    }
    let mut places = [0; MAX];
    ranks.store(&mut places);
    places
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
        kernel! {
            fn ranks_of<S>(rows: &[[f32; 4]; MAX], axis: usize) -> [u32; MAX] {
                ranks::<S>(S::Float8::load_rows4(rows)[axis], rows, axis)
            }
        }
        for seed in 0..200 {
            let primitives = boxes(1 + seed as usize % MAX, seed);
            for axis in 0..3 {
                let mut rows = [[f32::INFINITY; 4]; MAX];
                primitives.iter().zip(&mut rows).for_each(|(p, row)| row[axis] = p.center(axis));
                let mut sorted: Vec<usize> = (0..primitives.len()).collect();
                sorted.sort_by(|&a, &b| primitives[a].center(axis).total_cmp(&primitives[b].center(axis)));
                for level in Level::available() {
                    let ranks = ranks_of(level, &rows, axis);
                    assert!(sorted.iter().enumerate().all(|(rank, &i)| ranks[i] as usize == rank), "seed {seed}");
                }
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
            for level in Level::available() {
                let Split { axis, below, cost } = best(level, &primitives).expect("finite costs").split;
                assert_eq!((cost, axis, below), least, "seed {seed}, {level}");
            }
        }
    }
}
