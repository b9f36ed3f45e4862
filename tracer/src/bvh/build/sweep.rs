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
