//! Counters of traversal work, at no cost when off.

use std::ops::Add;

/// What a traversal did. A test of a whole SIMD group counts once.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counters {
    /// Packets traced.
    pub packets: u64,
    /// Tests of a group of rays against a box.
    pub box_tests: u64,
    /// Tests of a group of rays against a triangle.
    pub triangle_tests: u64,
    /// Tests of a group of rays against a triangle in which at least one ray hit.
    pub triangle_hits: u64,
    /// What [`Reordering`](crate::method::Reordering) counts beside.
    pub reordering: Reordering,
    /// What [`BreadthFirst`](crate::method::BreadthFirst) counts beside.
    pub frusta: Frusta,
}

impl Add for Counters {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self {
            packets: self.packets + o.packets,
            box_tests: self.box_tests + o.box_tests,
            triangle_tests: self.triangle_tests + o.triangle_tests,
            triangle_hits: self.triangle_hits + o.triangle_hits,
            reordering: self.reordering + o.reordering,
            frusta: self.frusta + o.frusta,
        }
    }
}

/// What Garanzha and Loop 2010 count (section 5.1 and table 1).
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Frusta {
    /// "FS": frusta.
    pub frusta: u64,
    /// "LS": leaves captured by all frusta together.
    pub leaves: u64,
    /// Elements of all queues together: nodes that frusta came to, leaves once for each level that they are carried down.
    pub steps: u64,
    /// Tests of a frustum against a box; [`Counters::box_tests`] are those of rays.
    pub box_tests: u64,
    /// Groups of rays, as many as a vector has lanes, that a frustum was taken apart into ("ray warps").
    pub groups: u64,
    /// Rays in all groups: divided by the groups, the average number of rays in one.
    pub rays: u64,
    /// Times that a queue was too short and the batch of frusta was split.
    pub splits: u64,
}

impl Add for Frusta {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self {
            frusta: self.frusta + o.frusta,
            leaves: self.leaves + o.leaves,
            steps: self.steps + o.steps,
            box_tests: self.box_tests + o.box_tests,
            groups: self.groups + o.groups,
            rays: self.rays + o.rays,
            splits: self.splits + o.splits,
        }
    }
}

/// What Boulos, Wald and Benthin 2008 count (section 5.4, table 4 and figures 6 to 8), beside box tests ("Box") and triangle tests ("Tri").
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Reordering {
    /// Rays in all triangle tests that meet the leaf's box: divided by the tests, how many rays each serves.
    pub triangle_rays: u64,
    /// "IA": tests of a whole packet by intervals, those for all hit and those for all missed alike.
    pub interval_tests: u64,
    /// "Reorder": rays that were moved into a new packet, once for each time.
    pub reordered: u64,
    /// "Trav": nodes visited, by however many rays at once.
    pub steps: u64,
    /// "Prim": triangles visited, by however many rays at once.
    pub primitives: u64,
    /// By the depth of the node, the root's being 0.
    pub by_depth: [Depth; Depth::LEVELS],
}

/// What was counted at nodes of one depth.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Depth {
    /// Tests of a group of rays against a box.
    pub box_tests: u64,
    /// Rays in these tests that met the box of the node above and still look for something there: those that a traversal ray by ray would test.
    /// Divided by the tests it is the speed-up by SIMD; by the width as well, the utilization.
    pub box_rays: u64,
    /// Benefit of interval tests (section 4.1): the number of rays for each that succeeds, less one for each that fails.
    pub interval_benefit: i64,
}

impl Depth {
    /// Depths told apart; what is deeper counts as the last.
    pub const LEVELS: usize = 48;
}

impl Reordering {
    /// Rays in all box tests: see [`Depth::box_rays`].
    #[must_use]
    pub fn box_rays(&self) -> u64 {
        self.by_depth.iter().map(|depth| depth.box_rays).sum()
    }
}

impl Default for Reordering {
    fn default() -> Self {
        let by_depth = [Depth::default(); Depth::LEVELS];
        Self { triangle_rays: 0, interval_tests: 0, reordered: 0, steps: 0, primitives: 0, by_depth }
    }
}

impl Add for Reordering {
    type Output = Self;
    fn add(mut self, o: Self) -> Self {
        for (depth, o) in self.by_depth.iter_mut().zip(o.by_depth) {
            depth.box_tests += o.box_tests;
            depth.box_rays += o.box_rays;
            depth.interval_benefit += o.interval_benefit;
        }
        Self {
            triangle_rays: self.triangle_rays + o.triangle_rays,
            interval_tests: self.interval_tests + o.interval_tests,
            reordered: self.reordered + o.reordered,
            steps: self.steps + o.steps,
            primitives: self.primitives + o.primitives,
            by_depth: self.by_depth,
        }
    }
}

/// Where a kernel reports to.
pub(crate) trait Count: Send {
    fn packet(&mut self) {}
    fn box_test(&mut self) {}
    fn triangle_test(&mut self) {}
    fn triangle_hit(&mut self) {}
    fn group(&mut self, _rays: usize) {}
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
    #[inline(always)]
    fn group(&mut self, rays: usize) {
        self.frusta.groups += 1;
        self.frusta.rays += rays as u64;
    }
    fn total(&self) -> Counters {
        *self
    }
}
