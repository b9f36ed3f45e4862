//! A group of as many rays as a vector has lanes, or one ray: both children of a node at once, the nearer first.

use super::order::Order;
use super::rays::{Found, Results, Sixteen};
use super::tally::Tally;
use crate::bvh::{Bvh, Node};
use crate::geometry::Vec3;
use simd::{Float, Mask};

/// What rays go through.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tree<'a> {
    pub(super) bvh: &'a Bvh,
    pub(super) order: &'a Order,
    /// What boxes grow by.
    pub(super) growth: f32,
}

/// Nodes that wait, and where each ray enters their boxes: no number for a ray that does not.
pub(super) struct Waiting<F> {
    nodes: Vec<u32>,
    near: Vec<F>,
}

impl<F: Float> Waiting<F> {
    pub(super) fn new() -> Self {
        Self { nodes: Vec::with_capacity(64), near: Vec::with_capacity(64) }
    }

    #[inline(always)]
    fn push(&mut self, node: usize, t_near: F, meets: F::Mask) {
        self.nodes.push(node as u32);
        self.near.push(F::select(meets, t_near, F::splat(f32::NAN)));
    }

    /// The next one that a ray enters before its hit, and which rays do.
    #[inline(always)]
    fn pop(&mut self, reach: F) -> Option<(usize, u32)> {
        loop {
            let (node, t_near) = (self.nodes.pop()?, self.near.pop()?);
            let bits = t_near.le(reach).bitmask();
            if bits != 0 {
                return Some((node as usize, bits));
            }
        }
    }
}

/// The rays as they meet boxes.
struct Boxes<F: Float> {
    inv: Vec3<F>,
    low: Vec3<F>,
    high: Vec3<F>,
    t_min: F,
}

impl<F: Float> Boxes<F> {
    #[inline(always)]
    fn new(rays: &Sixteen, chunk: usize, growth: f32) -> Self {
        let (inv, offset, growth) = (rays.inv::<F>(chunk), rays.offset::<F>(chunk), F::splat(growth));
        let widen = inv.scale(growth);
        Self { inv, low: offset - widen, high: offset + widen, t_min: F::load_block(&rays.t_min, chunk) }
    }

    #[inline(always)]
    fn meet(&self, node: &Node, reach: F) -> (F, F::Mask) {
        let p = node.planes();
        let (a, b) = (at(p[0], self.inv.x, self.low.x), at(p[4], self.inv.x, self.high.x));
        let (c, d) = (at(p[1], self.inv.y, self.low.y), at(p[5], self.inv.y, self.high.y));
        let (e, f) = (at(p[2], self.inv.z, self.low.z), at(p[6], self.inv.z, self.high.z));
        let t_near = a.min(b).max(c.min(d)).max(e.min(f).max(self.t_min));
        let t_far = a.max(b).min(c.max(d)).min(e.max(f).min(reach));
        (t_near, t_near.le(t_far))
    }
}

#[inline(always)]
fn at<F: Float>(plane: f32, inv: F, add: F) -> F {
    F::splat(plane).mul_add(inv, add)
}

/// From the root down; returns whether something was found.
#[inline(always)]
pub(super) fn from_root<F: Float, T: Tally>(
    tree: Tree,
    rays: &mut Sixteen,
    chunk: usize,
    waiting: &mut Waiting<F>,
    results: &mut Results,
    tally: &mut T,
) -> bool {
    let Some(root) = tree.bvh.nodes.first() else { return false };
    let boxes = Boxes::<F>::new(rays, chunk, tree.growth);
    let reach = F::load_block(&rays.reach, chunk);
    let on = boxes.t_min.le(reach).bitmask();
    if on == 0 {
        return false;
    }
    tally.packet();
    tally.step(0, on.count_ones());
    let bits = boxes.meet(root, reach).1.bitmask();
    bits != 0 && traverse(tree, rays, chunk, (0, bits), waiting, results, tally)
}

/// From a node that some of the rays meet, a bit each; returns whether something was found.
#[inline(always)]
pub(super) fn traverse<F: Float, T: Tally>(
    tree: Tree,
    rays: &mut Sixteen,
    chunk: usize,
    (mut at, mut bits): (usize, u32),
    waiting: &mut Waiting<F>,
    results: &mut Results,
    tally: &mut T,
) -> bool {
    let nodes = &tree.bvh.nodes[..];
    let (boxes, any) = (Boxes::<F>::new(rays, chunk, tree.growth), results.is_any());
    let packet = rays.packet::<F>(chunk);
    let mut found = Found::<F>::load(rays, chunk);
    let zero = F::splat(0.0);
    let negative = [boxes.inv.x.lt(zero).bitmask(), boxes.inv.y.lt(zero).bitmask(), boxes.inv.z.lt(zero).bitmask(), 0];
    loop {
        let node = &nodes[at];
        let (first, number) = node.triangles();
        if number > 0 {
            tally.primitives(number);
            let triangles = &tree.bvh.triangles[first as usize..(first + number) as usize];
            found.leaf(triangles, &packet, bits, any, tally);
            if any && found.is_complete() {
                waiting.nodes.clear();
                waiting.near.clear();
                break;
            }
        } else if let Some(children) = tree.order.of(at) {
            let is_negative = negative[children.axis] >> bits.trailing_zeros() & 1 != 0;
            let (near, far) = children.near_and_far(at, is_negative);
            if T::ON {
                tally.step(near, bits.count_ones());
                tally.step(far, bits.count_ones());
            }
            let (_, meets_near) = boxes.meet(&nodes[near], found.reach);
            let (t_far, meets_far) = boxes.meet(&nodes[far], found.reach);
            let (bits_near, bits_far) = (meets_near.bitmask(), meets_far.bitmask());
            if bits_far != 0 {
                if bits_near != 0 {
                    waiting.push(far, t_far, meets_far);
                    (at, bits) = (near, bits_near);
                } else {
                    (at, bits) = (far, bits_far);
                }
                continue;
            }
            if bits_near != 0 {
                (at, bits) = (near, bits_near);
                continue;
            }
        } else {
            // Where a builder made more children they come last stored first.
            let mut child = at + 1;
            while child < node.skip() as usize {
                tally.step(child, bits.count_ones());
                let (t_near, meets) = boxes.meet(&nodes[child], found.reach);
                waiting.push(child, t_near, meets);
                child = nodes[child].skip() as usize;
            }
        }
        let Some(next) = waiting.pop(found.reach) else { break };
        (at, bits) = next;
    }
    found.store(rays, chunk, results)
}
