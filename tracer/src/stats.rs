//! Counters of traversal work, at no cost when off.

use std::ops::Add;

/// What a traversal did, per packet of the width that was used.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counters {
    /// Packets traced.
    pub packets: u64,
    /// Packet-box tests: the steps of the traversal loop.
    pub box_tests: u64,
    /// Packet-triangle tests.
    pub triangle_tests: u64,
    /// Packet-triangle tests in which at least one ray hit.
    pub triangle_hits: u64,
}

impl Add for Counters {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self {
            packets: self.packets + o.packets,
            box_tests: self.box_tests + o.box_tests,
            triangle_tests: self.triangle_tests + o.triangle_tests,
            triangle_hits: self.triangle_hits + o.triangle_hits,
        }
    }
}

/// Where a kernel reports to.
pub(crate) trait Count: Send {
    fn packet(&mut self) {}
    fn box_test(&mut self) {}
    fn triangle_test(&mut self) {}
    fn triangle_hit(&mut self) {}
    fn total(&self) -> Counters {
        Counters::default()
    }
}

/// Counts nothing, at no cost.
pub(crate) struct NoCount;
impl Count for NoCount {}

impl Count for Counters {
    #[inline(always)]
    fn packet(&mut self) {
        self.packets += 1;
    }
    #[inline(always)]
    fn box_test(&mut self) {
        self.box_tests += 1;
    }
    #[inline(always)]
    fn triangle_test(&mut self) {
        self.triangle_tests += 1;
    }
    #[inline(always)]
    fn triangle_hit(&mut self) {
        self.triangle_hits += 1;
    }
    fn total(&self) -> Counters {
        *self
    }
}
