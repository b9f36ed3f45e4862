//! One ray on its way through a wide tree, against all children of a node at once, nearest first.

use super::query::Query;
use super::ready::Ready;
use crate::bvh::{Child, WideBvh, WideNode};
use crate::geometry::cull::{Boxes, Cull};
use crate::geometry::moller_trumbore;
use crate::geometry::slab::Near;
use crate::geometry::{Hit, Packet as Rays, Vec3};
use crate::stats::Count;
use simd::{Float, Kernel, Level, Mask, Simd};

/// How many children nodes have.
#[derive(Debug)]
pub struct Arity<const N: usize>;

/// What a number of children means for vectors.
pub trait Wide {
    /// A lane for each child.
    type Lanes<S: Simd>: Float;
}
impl Wide for Arity<4> {
    type Lanes<S: Simd> = S::Float4;
}
impl Wide for Arity<8> {
    type Lanes<S: Simd> = S::Float8;
}
impl Wide for Arity<16> {
    type Lanes<S: Simd> = S::Float16;
}

/// A ray on its way.
pub(super) struct Walk<'a, const N: usize> {
    bvh: &'a WideBvh<N>,
    rays: &'a Ready,
    lane: usize,
    /// [`Near::upper`] of its octant.
    upper: [usize; 3],
}

struct Odd<'a, Q: Query, C, const N: usize> {
    walk: &'a Walk<'a, N>,
    stack: &'a mut [u64],
    found: &'a mut Q::Block,
    count: &'a mut C,
}

impl<Q: Query, C: Count, const N: usize> Kernel for Odd<'_, Q, C, N>
where
    Arity<N>: Wide,
{
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self) {
        let Self { walk, stack, found, count } = self;
        let boxes = walk.rays.ray(walk.lane).splat::<<Arity<N> as Wide>::Lanes<S>>();
        walk.visit::<_, _, S, Q, C>(boxes, Child::node(0), stack, found, count);
    }
}

/// A child with the distance where the ray enters its box above it: entries compare as distances do, for none is negative.
#[inline(always)]
pub(super) fn entry(t_near: f32, child: Child) -> u64 {
    u64::from(t_near.to_bits()) << 32 | u64::from(child.bits())
}

impl<'a, const N: usize> Walk<'a, N> {
    #[inline(always)]
    pub(super) fn new(bvh: &'a WideBvh<N>, rays: &'a Ready, lane: usize) -> Self {
        Self { bvh, rays, lane, upper: Near::of_octant(rays.octant(lane)).upper() }
    }

    /// From `child` down; `found` has what was found before. Returns how far along the ray a hit still matters.
    #[inline(always)]
    pub(super) fn run<W: Wide, S: Simd, Q: Query, C: Count>(
        &self,
        child: Child,
        stack: &mut [u64],
        found: &mut Q::Block,
        count: &mut C,
    ) -> f32 {
        let boxes = Cull::<W::Lanes<S>>::splat(&self.rays.cull, self.lane);
        self.visit::<_, _, S, Q, C>(boxes, child, stack, found, count)
    }

    /// [`Walk::run`] from the root for a ray that [`Cull`] is not for: rare, so it is not worth code at every level.
    #[cold]
    #[inline(never)]
    pub(super) fn run_odd<Q: Query, C: Count>(&self, stack: &mut [u64], found: &mut Q::Block, count: &mut C)
    where
        Arity<N>: Wide,
    {
        Level::run_native(Odd::<Q, C, N> { walk: self, stack, found, count });
    }

    /// [`Walk::run`] of a leaf.
    #[inline(always)]
    pub(super) fn leaf_only<S: Simd, Q: Query, C: Count>(
        &self,
        leaf: Child,
        found: &mut Q::Block,
        count: &mut C,
    ) -> f32 {
        let ray = self.rays.ray(self.lane);
        let mut best = Q::best(found, self.lane, ray.t_max);
        self.leaf(leaf, &ray.splat::<S::Float4>(), &mut best, count);
        if best.is_miss() {
            return best.t;
        }
        Q::store(found, self.lane, &best);
        if Q::CLOSEST { best.t } else { f32::NEG_INFINITY }
    }

    #[inline(always)]
    fn visit<F: Float, B: Boxes<F>, S: Simd, Q: Query, C: Count>(
        &self,
        boxes: B,
        mut child: Child,
        stack: &mut [u64],
        found: &mut Q::Block,
        count: &mut C,
    ) -> f32 {
        let (ray, lane) = (self.rays.ray(self.lane), self.lane);
        let (from, triangle_ray) = (F::splat(ray.t_min), ray.splat::<S::Float4>());
        let mut best = Q::best(found, lane, ray.t_max);
        let mut free = 0;
        loop {
            if child.is_leaf() {
                self.leaf(child, &triangle_ray, &mut best, count);
                if !Q::CLOSEST && !best.is_miss() {
                    break;
                }
            } else {
                // Only an empty tree has no root.
                let Some(node) = self.bvh.nodes.get(child.index()) else { break };
                count.box_test();
                let (t_near, mask) = self.meet(node, boxes, from, best.t);
                if let Some(nearest) = self.descend::<F, Q>(node, t_near, mask.bitmask(), stack, &mut free) {
                    child = nearest;
                    continue;
                }
            }
            // What the ray enters behind its hit so far is passed over.
            child = loop {
                if free == 0 {
                    if !best.is_miss() {
                        Q::store(found, lane, &best);
                    }
                    return best.t;
                }
                free -= 1;
                if f32::from_bits((stack[free] >> 32) as u32) <= best.t {
                    break Child::from_bits(stack[free] as u32);
                }
            };
        }
        if !best.is_miss() {
            Q::store(found, lane, &best);
        }
        if Q::CLOSEST { best.t } else { f32::NEG_INFINITY }
    }

    /// The nearest of the children that the ray meets; the others go to the stack, the nearer above the farther.
    #[inline(always)]
    fn descend<F: Float, Q: Query>(
        &self,
        node: &WideNode<N>,
        t_near: F,
        mut bits: u32,
        stack: &mut [u64],
        free: &mut usize,
    ) -> Option<Child> {
        if bits == 0 {
            return None;
        }
        let t_near = t_near.to_block();
        let mut next = || {
            let i = bits.trailing_zeros() as usize % 16;
            bits &= bits - 1;
            let child = node.children[i % N];
            self.bvh.prefetch(child);
            (bits != 0, entry(t_near.0[i], child))
        };
        // Most often one child or two.
        let (more, first) = next();
        if !more {
            return Some(Child::from_bits(first as u32));
        }
        assert!(*free + N <= stack.len(), "the stack has room for the children of every node on the way");
        if !Q::CLOSEST {
            // Any hit will do: no order is worth its price.
            let (mut more, mut last) = (true, first);
            while more {
                stack[*free] = last;
                *free += 1;
                (more, last) = next();
            }
            return Some(Child::from_bits(last as u32));
        }
        let (mut more, second) = next();
        let bottom = *free;
        stack[*free] = first.max(second);
        let mut nearest = first.min(second);
        while more {
            let another;
            (more, another) = next();
            *free += 1;
            let farther = nearest.max(another);
            nearest = nearest.min(another);
            // Sorted: the others move up.
            let mut at = *free;
            while at > bottom && stack[at - 1] < farther {
                stack[at] = stack[at - 1];
                at -= 1;
            }
            stack[at] = farther;
        }
        *free += 1;
        Some(Child::from_bits(nearest as u32))
    }

    /// The closest hit among the triangles of a leaf, if it is closer than what there is.
    #[inline(always)]
    fn leaf<F: Float, C: Count>(&self, leaf: Child, ray: &Rays<F>, best: &mut Hit, count: &mut C) {
        let (first, end) = leaf.groups();
        for group in &self.bvh.groups[first..end] {
            count.triangle_test();
            let ray = Rays { t_max: F::splat(best.t), ..*ray };
            let Some(hit) = moller_trumbore::intersect_group(group, &ray) else { continue };
            let mut bits = hit.mask.bitmask();
            if bits == 0 {
                continue;
            }
            count.triangle_hit();
            let (t, u, v) = (hit.t.to_block(), hit.u.to_block(), hit.v.to_block());
            while bits != 0 {
                let i = bits.trailing_zeros() as usize % group.id.len();
                bits &= bits - 1;
                let primitive = group.id[i];
                // At equal distance the lower id wins, whatever order the leaves are visited in.
                if t.0[i] < best.t || (t.0[i] == best.t && primitive < best.primitive) {
                    *best = Hit { t: t.0[i], u: u.0[i], v: v.0[i], primitive };
                }
            }
        }
    }

    /// Which boxes the ray meets, and where it enters them.
    #[inline(always)]
    fn meet<F: Float, B: Boxes<F>>(&self, node: &WideNode<N>, boxes: B, from: F, reach: f32) -> (F, F::Mask) {
        let (p, [x, y, z]) = (&node.planes, self.upper);
        let near = Vec3 { x: F::load(&p[x]), y: F::load(&p[1 + y]), z: F::load(&p[2 + z]) };
        let far = Vec3 { x: F::load(&p[3 - x]), y: F::load(&p[4 - y]), z: F::load(&p[5 - z]) };
        let (t_near, t_far) = boxes.interval(near, far, from, F::splat(reach));
        (t_near, t_near.le(t_far))
    }
}
