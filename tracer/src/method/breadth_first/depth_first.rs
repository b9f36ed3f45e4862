//! The same frusta through the same tree, one after the other with a stack: what Garanzha & Loop 2010 compare with in section 5.5.

use super::children::{self, Children, LEAF};
use super::leaves::Leaves;
use crate::bvh::OctoBvh;
use crate::geometry::frustum::Frustum;
use crate::lanes::{self, Lanes};
use crate::stats;
use simd::{Float, Level};

/// More leaves than these are not waited for.
const MANY: usize = 1 << 22;

/// Takes all frusta from the root to the leaves. Where these have become many, `full` is told how many frusta are through with them, and may forget their
/// leaves.
pub(super) fn traverse(
    level: Level,
    tree: &OctoBvh,
    frusta: &[Frustum],
    leaves: &mut Leaves,
    mut count: Option<&mut stats::Frusta>,
    full: &mut dyn FnMut(&mut Leaves, usize),
) {
    leaves.clear(frusta.len());
    let mut first = 0;
    loop {
        let job = DepthFirst { tree, frusta, first, leaves, count: count.is_some() };
        let (done, counted) = lanes::run_eight(level, job);
        if let Some(count) = &mut count {
            count.steps += counted.steps;
            count.box_tests += counted.box_tests;
        }
        if done == frusta.len() {
            return;
        }
        full(leaves, done);
        first = done;
    }
}

struct DepthFirst<'a> {
    tree: &'a OctoBvh,
    frusta: &'a [Frustum],
    /// The first that is not done.
    first: usize,
    leaves: &'a mut Leaves,
    count: bool,
}

impl Lanes for DepthFirst<'_> {
    /// How many are done now, and what was counted.
    type Output = (usize, stats::Frusta);

    #[inline(always)]
    fn run<F: Float>(self) -> Self::Output {
        let rows = self.tree.rows();
        let mut counted = stats::Frusta::default();
        let mut stack = Vec::new();
        for (i, frustum) in self.frusta.iter().enumerate().skip(self.first) {
            let begin = self.leaves.nodes.len();
            stack.push(children::root(self.tree));
            while let Some(node) = stack.pop() {
                if self.count {
                    counted.steps += 1;
                    counted.box_tests += children::number(self.tree, &[node]);
                }
                if node & LEAF != 0 {
                    self.leaves.nodes.push(node & !LEAF);
                    continue;
                }
                let children = Children::of::<F>(rows, node, frustum);
                // The first on top.
                let mut k = children.number;
                while k > 0 {
                    k -= 1;
                    stack.push(children.get(k));
                }
            }
            self.leaves.ranges[i] = [begin as u32, self.leaves.nodes.len() as u32];
            if self.leaves.nodes.len() > begin.max(MANY) {
                return (i + 1, counted);
            }
        }
        (self.frusta.len(), counted)
    }
}
