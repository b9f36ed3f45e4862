//! One search at a time through a wide tree, nearest box first, for what [`Walk`](super::walk) does not answer: hits that the caller
//! may refuse, nearest points, instances.

use super::walk::entry;
use crate::bvh::{Child, WideBvh, WideNode};
use crate::geometry::moller_trumbore::intersect_group;
use crate::geometry::slab::between;
use crate::geometry::{Hit, Packet, TriangleGroup, Vec3};
use simd::{Float, Mask, Simd, Vector};

/// What is searched for.
pub(crate) trait Goal<S: Simd> {
    /// How far away each child of a node is at least (never negative), and which of them matter, a bit each.
    fn children(&self, node: &WideNode<8>) -> (S::Float8, u32);

    /// Looks at what is in a leaf. Another search may run on the same stack.
    fn group(&mut self, group: &TriangleGroup<{ WideBvh::<8>::GROUP }>, stack: &mut Vec<u64>);

    /// Nothing farther away matters any more.
    fn reach(&self) -> f32;
}

/// Room on the stack for a search through a tree.
pub(crate) fn stack_for(bvh: &WideBvh<8>) -> Vec<u64> {
    Vec::with_capacity(bvh.depth * 8 + 1)
}

/// Visits all leaves that matter, the nearest first; leaves the stack as it was.
#[inline(always)]
pub(crate) fn search<S: Simd, G: Goal<S>>(bvh: &WideBvh<8>, goal: &mut G, stack: &mut Vec<u64>) {
    let bottom = stack.len();
    stack.push(entry(0.0, Child::node(0)));
    while stack.len() > bottom {
        let Some(top) = stack.pop() else { break };
        let is_near = f32::from_bits((top >> 32) as u32) <= goal.reach();
        if !is_near {
            continue;
        }
        let child = Child::from_bits(top as u32);
        if child.is_leaf() {
            let (first, end) = child.groups();
            for group in &bvh.groups[first..end] {
                goal.group(group, stack);
            }
        } else if let Some(node) = bvh.nodes.get(child.index()) {
            // Only an empty tree has no root.
            let (distance, bits) = goal.children(node);
            push(bvh, node, distance, bits, stack);
        }
    }
}

/// The children that matter go to the stack, the nearer above the farther.
#[inline(always)]
fn push<F: Float>(bvh: &WideBvh<8>, node: &WideNode<8>, distance: F, mut bits: u32, stack: &mut Vec<u64>) {
    let (distance, bottom) = (distance.to_block(), stack.len());
    while bits != 0 {
        let i = bits.trailing_zeros() as usize % 8;
        bits &= bits - 1;
        let this = entry(distance.0[i], node.children[i]);
        bvh.prefetch(node.children[i]);
        let mut at = stack.len();
        stack.push(this);
        while at > bottom && stack[at - 1] < this {
            stack[at] = stack[at - 1];
            at -= 1;
        }
        stack[at] = this;
    }
}

/// A ray as it meets the boxes of a node.
pub(crate) struct BoxRay<F: Float> {
    ray: Packet<F>,
    /// What is taken from near planes and from far planes: the origin, but for a ray that boxes grow for.
    origins: [Vec3<F>; 2],
    /// Per axis 3 where the upper plane is the near one, else 0.
    upper: [usize; 3],
}

impl<F: Float> BoxRay<F> {
    /// For boxes that grow by `growth` on all sides before they are tested.
    #[inline(always)]
    pub(crate) fn new(ray: &Packet<f32>, growth: f32) -> Self {
        let (org, inv) = (ray.org, ray.inv_dir);
        // Not `map`: it is not always inlined.
        let g = Vec3 { x: growth.copysign(inv.x), y: growth.copysign(inv.y), z: growth.copysign(inv.z) };
        let origins = [
            Vec3::splat([org.x + g.x, org.y + g.y, org.z + g.z]),
            Vec3::splat([org.x - g.x, org.y - g.y, org.z - g.z]),
        ];
        Self { ray: ray.splat(), origins, upper: [upper(inv.x), upper(inv.y), upper(inv.z)] }
    }

    /// Where the ray enters the boxes, and which it meets up to `reach`, a bit each.
    #[inline(always)]
    pub(crate) fn meet(&self, node: &WideNode<8>, reach: f32) -> (F, u32) {
        let (p, [x, y, z]) = (&node.planes, self.upper);
        let near = Vec3 { x: F::load(&p[x]), y: F::load(&p[1 + y]), z: F::load(&p[2 + z]) };
        let far = Vec3 { x: F::load(&p[3 - x]), y: F::load(&p[4 - y]), z: F::load(&p[5 - z]) };
        let [from_near, from_far] = self.origins;
        let (t_near, t_far) = between(near - from_near, far - from_far, &self.ray, self.ray.t_min, F::splat(reach));
        (t_near, t_near.le(t_far).bitmask())
    }
}

#[inline(always)]
fn upper(inv: f32) -> usize {
    3 * usize::from(inv < 0.0)
}

/// The first hit of a ray, or any, among those that the caller does not refuse.
pub(crate) struct FirstHit<'a, S: Simd> {
    boxes: BoxRay<S::Float8>,
    ray: Packet<S::Float4>,
    is_closest: bool,
    accept: &'a dyn Fn(&Hit) -> bool,
    /// How far along the ray a hit matters.
    pub(crate) reach: f32,
    pub(crate) best: Hit,
}

impl<'a, S: Simd> FirstHit<'a, S> {
    #[inline(always)]
    pub(crate) fn new(ray: &Packet<f32>, is_closest: bool, accept: &'a dyn Fn(&Hit) -> bool) -> Self {
        let (boxes, reach) = (BoxRay::new(ray, 0.0), ray.t_max);
        Self { boxes, ray: ray.splat(), is_closest, accept, reach, best: Hit::MISS }
    }
}

impl<S: Simd> Goal<S> for FirstHit<'_, S> {
    #[inline(always)]
    fn children(&self, node: &WideNode<8>) -> (S::Float8, u32) {
        self.boxes.meet(node, self.reach)
    }

    #[inline(always)]
    fn group(&mut self, group: &TriangleGroup<{ WideBvh::<8>::GROUP }>, _: &mut Vec<u64>) {
        let ray = Packet { t_max: S::Float4::splat(self.reach), ..self.ray };
        let Some(found) = intersect_group(group, &ray) else { return };
        let mut bits = found.mask.bitmask();
        if bits == 0 {
            return;
        }
        let (t, u, v) = (found.t.to_block(), found.u.to_block(), found.v.to_block());
        while bits != 0 {
            let i = bits.trailing_zeros() as usize % group.id.len();
            bits &= bits - 1;
            let hit = Hit { t: t.0[i], u: u.0[i], v: v.0[i], primitive: group.id[i] };
            // At equal distance the lower id wins, whatever order the leaves are visited in.
            let is_better = hit.t < self.reach || (hit.t == self.reach && hit.primitive < self.best.primitive);
            if is_better && (self.accept)(&hit) {
                self.best = hit;
                self.reach = if self.is_closest { hit.t } else { f32::NEG_INFINITY };
            }
        }
    }

    #[inline(always)]
    fn reach(&self) -> f32 {
        self.reach
    }
}
