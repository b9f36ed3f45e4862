//! The same frusta through the same tree, one after the other with a stack: what Garanzha & Loop 2010 compare with in section 5.5.

use super::children::{self, Children, LEAF};
use super::leaves::Leaves;
use crate::bvh::OctoBvh;
use crate::geometry::frustum::Frustum;
use crate::lanes::{self, Lanes};
use crate::stats;
use simd::{Float, Level};

/// Takes all frusta from the root to the leaves.
pub(super) fn traverse(
    level: Level,
    tree: &OctoBvh,
    frusta: &[Frustum],
    leaves: &mut Leaves,
    count: Option<&mut stats::Frusta>,
) {
    leaves.clear(frusta.len());
    let counted = lanes::run_eight(level, DepthFirst { tree, frusta, leaves, count: count.is_some() });
    if let Some(count) = count {
        count.steps += counted.steps;
        count.box_tests += counted.box_tests;
    }
}

struct DepthFirst<'a> {
    tree: &'a OctoBvh,
    frusta: &'a [Frustum],
    leaves: &'a mut Leaves,
    count: bool,
}

impl Lanes for DepthFirst<'_> {
    type Output = stats::Frusta;

    #[inline(always)]
    fn run<F: Float>(self) -> stats::Frusta {
        let rows = self.tree.rows();
        let mut counted = stats::Frusta::default();
        let mut stack = Vec::new();
        for (i, frustum) in self.frusta.iter().enumerate() {
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
        }
        counted
    }
}
