//! What is counted on the way, at no cost when nothing is.

use crate::bvh::Bvh;
use crate::stats::{Counters, Depth};

/// Where a traversal reports to.
pub(super) trait Tally {
    /// Whether it is worth finding out what it asks for.
    const ON: bool;
    fn packet(&mut self) {}
    /// Tests of a node's box, and the rays in them that met the one above.
    fn boxes(&mut self, _node: usize, _tests: u32, _rays: u32) {}
    /// A test of a group of rays against a triangle, and those of them that meet the leaf's box.
    fn triangle(&mut self, _rays: u32) {}
    fn triangle_hit(&mut self) {}
    /// An interval test of a packet, and the number of rays it decided about, if it did.
    fn intervals(&mut self, _node: usize, _benefit: Option<u32>) {}
    fn reordered(&mut self, _rays: u32) {}
    /// A node visited.
    fn visit(&mut self) {}
    /// A node visited by one group of rays, so many of which met the one above.
    #[inline(always)]
    fn step(&mut self, node: usize, rays: u32) {
        self.visit();
        self.boxes(node, 1, rays);
    }
    fn primitives(&mut self, _number: u32) {}
    fn total(&self) -> Counters {
        Counters::default()
    }
}

pub(super) struct Off;
impl Tally for Off {
    const ON: bool = false;
}

pub(super) struct On<'a> {
    pub(super) counters: Counters,
    /// Of each node.
    pub(super) depths: &'a [u8],
}

impl Tally for On<'_> {
    const ON: bool = true;

    fn packet(&mut self) {
        self.counters.packets += 1;
    }

    fn boxes(&mut self, node: usize, tests: u32, rays: u32) {
        self.counters.box_tests += u64::from(tests);
        let depth = &mut self.counters.reordering.by_depth[usize::from(self.depths[node])];
        depth.box_tests += u64::from(tests);
        depth.box_rays += u64::from(rays);
    }

    fn triangle(&mut self, rays: u32) {
        self.counters.triangle_tests += 1;
        self.counters.reordering.triangle_rays += u64::from(rays);
    }

    fn triangle_hit(&mut self) {
        self.counters.triangle_hits += 1;
    }

    fn intervals(&mut self, node: usize, benefit: Option<u32>) {
        self.counters.reordering.interval_tests += 1;
        let depth = &mut self.counters.reordering.by_depth[usize::from(self.depths[node])];
        depth.interval_benefit += benefit.map_or(-1, i64::from);
    }

    fn reordered(&mut self, rays: u32) {
        self.counters.reordering.reordered += u64::from(rays);
    }

    fn visit(&mut self) {
        self.counters.reordering.steps += 1;
    }

    fn primitives(&mut self, number: u32) {
        self.counters.reordering.primitives += u64::from(number);
    }

    fn total(&self) -> Counters {
        self.counters
    }
}

/// How deep each node lies, as [`Depth::LEVELS`] tells depths apart.
pub(super) fn depths(bvh: &Bvh) -> Vec<u8> {
    let mut depths = Vec::with_capacity(bvh.nodes.len());
    // Where the subtrees end that the node is in.
    let mut ends: Vec<u32> = Vec::new();
    for (i, node) in bvh.nodes.iter().enumerate() {
        while ends.last().is_some_and(|&end| end as usize <= i) {
            ends.pop();
        }
        depths.push(ends.len().min(Depth::LEVELS - 1) as u8);
        ends.push(node.skip());
    }
    depths
}
