//! Where the time goes.

use std::ops::Add;
use std::time::Duration;

/// Time that [`BreadthFirst`](super::BreadthFirst) took for each of its stages, of all threads together (figure 13 of Garanzha & Loop 2010).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Stages {
    /// Hashing and sorting rays, taking packets apart, and putting the results back into the order of the rays.
    pub sort: Duration,
    /// Frusta around packets.
    pub frusta: Duration,
    /// Frusta through the tree.
    pub traversal: Duration,
    /// Rays against the leaves of their frusta.
    pub intersection: Duration,
}

impl Add for Stages {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self {
            sort: self.sort + o.sort,
            frusta: self.frusta + o.frusta,
            traversal: self.traversal + o.traversal,
            intersection: self.intersection + o.intersection,
        }
    }
}
