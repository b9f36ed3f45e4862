//! The same array of nodes, near child first: the first child is the next node, its skip pointer leads to the second.

use super::leaf;
use crate::bvh::Bvh;
use crate::geometry::Packet as Rays;
use crate::geometry::slab::{self, Near, Origin};
use crate::method::found::Found;
use crate::stats::Count;
use simd::{Float, Mask};

/// A node that waits, and where the first ray of the packet enters its box.
#[derive(Debug, Clone, Copy)]
pub(super) struct Waiting {
    t_near: f32,
    node: u32,
}

/// Nearest first by where the first ray of the packet enters a box. `stack` keeps its memory from one packet to the next.
#[inline(always)]
pub(super) fn traverse<F: Float, O: Origin<F>, T: Found<F>, C: Count>(
    bvh: &Bvh,
    ray: &Rays<F>,
    origin: O,
    near: Near,
    found: &mut T,
    stack: &mut Vec<Waiting>,
    count: &mut C,
) {
    stack.clear();
    let Some(root) = bvh.nodes.first() else { return };
    count.box_test();
    let (t_near, t_far) = slab::interval(root.planes(), ray, origin, near, ray.t_min, found.reach());
    if t_near.le(t_far).any() {
        stack.push(Waiting { t_near: f32::NEG_INFINITY, node: 0 });
    }
    while let Some(Waiting { t_near, node }) = stack.pop() {
        // Entered behind all that matters.
        if !F::splat(t_near).le(found.reach()).any() {
            continue;
        }
        let at = node as usize;
        let triangles = bvh.nodes[at].triangles();
        if triangles.1 > 0 {
            leaf(bvh, triangles, ray, origin, near, found, count);
            if found.complete() {
                return;
            }
            continue;
        }
        // Two children, or more where a builder made more.
        let (bottom, end) = (stack.len(), bvh.nodes[at].skip());
        let mut child = node + 1;
        while child < end {
            let node = &bvh.nodes[child as usize];
            count.box_test();
            let (t_near, t_far) = slab::interval(node.planes(), ray, origin, near, ray.t_min, found.reach());
            let meets = t_near.le(t_far);
            if meets.any() {
                let t_near = F::select(meets, t_near, F::splat(f32::INFINITY)).reduce_min();
                let place = stack[bottom..].partition_point(|other| other.t_near > t_near);
                stack.insert(bottom + place, Waiting { t_near, node: child });
            }
            child = node.skip();
        }
    }
}
