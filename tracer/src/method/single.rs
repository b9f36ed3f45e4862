//! One ray at a time through a wide tree, against all children of a node at once, nearest first (Wald, Benthin and Boulos 2008).

use super::{BitVec, Context, Method, in_portions};
use crate::Error;
use crate::bvh::{Child, WideBvh, WideNode};
use crate::geometry::moller_trumbore;
use crate::geometry::slab::{self, Near};
use crate::geometry::{Hit, HitBatch, HitBlock, Packet as Rays, RayBatch, RayBlock, Vec3};
use crate::stats::{Count, Counters, NoCount};
use simd::{Block, Float, Kernel, Level, Mask, Simd};

/// Single rays through a [`WideBvh`].
#[derive(Debug, Clone, Copy)]
pub struct Single<'a, const N: usize> {
    bvh: &'a WideBvh<N>,
    level: Level,
}

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

impl<'a, const N: usize> Single<'a, N>
where
    Arity<N>: Wide,
{
    /// Over a tree, at a level.
    #[must_use]
    pub fn new(bvh: &'a WideBvh<N>, level: Level) -> Self {
        Self { bvh, level }
    }

    fn find<Q: Query>(&self, rays: &RayBatch, results: &mut [Q::Block], cx: &mut Context<'_>) -> Result<(), Error> {
        in_portions(rays, results, cx, |count, rays, results| {
            let bvh = self.bvh;
            if count {
                // The work is the same at every level.
                Level::run_scalar(Trace::<Q, _, N> { bvh, rays, results, count: Counters::default() })
            } else {
                self.level.run(Trace::<Q, _, N> { bvh, rays, results, count: NoCount })
            }
        })
    }
}

impl<const N: usize> Method for Single<'_, N>
where
    Arity<N>: Wide,
{
    fn name(&self) -> &'static str {
        "single"
    }

    fn source(&self) -> &'static str {
        "Wald, Benthin and Boulos 2008"
    }

    fn memory(&self) -> usize {
        0
    }

    fn closest(&self, rays: &RayBatch, hits: &mut HitBatch, cx: &mut Context<'_>) -> Result<(), Error> {
        self.find::<Closest>(rays, hits.resize(rays.len()), cx)
    }

    fn any(&self, rays: &RayBatch, occluded: &mut BitVec, cx: &mut Context<'_>) -> Result<(), Error> {
        self.find::<Any>(rays, occluded.resize(rays.len()), cx)
    }
}

/// A portion of rays through the tree.
struct Trace<'a, Q: Query, C, const N: usize> {
    bvh: &'a WideBvh<N>,
    rays: &'a [RayBlock],
    results: &'a mut [Q::Block],
    count: C,
}

impl<Q: Query, C: Count, const N: usize> Kernel for Trace<'_, Q, C, N>
where
    Arity<N>: Wide,
{
    type Output = Counters;

    #[inline(always)]
    fn run<S: Simd>(mut self) -> Counters {
        // Each node on the way leaves all but one of its children.
        let mut stack = vec![0; self.bvh.depth * N];
        for (block, results) in self.rays.iter().zip(self.results) {
            let ready = Ready::new::<S::Float>(block);
            let mut found = Q::NOTHING;
            let mut rest = ready.valid;
            while rest != 0 {
                let lane = rest.trailing_zeros() as usize % 16;
                rest &= rest - 1;
                self.count.packet();
                let near = ready.near(lane);
                let walk = Walk { bvh: self.bvh, ray: ready.ray(lane), near, upper: near.upper() };
                walk.run::<Arity<N>, S, Q, C>(&mut stack, lane, &mut found, &mut self.count);
            }
            *results = found;
        }
        self.count.total()
    }
}

/// Sixteen rays made ready for traversal.
struct Ready {
    org: [Block<f32>; 3],
    dir: [Block<f32>; 3],
    inv_dir: [Block<f32>; 3],
    inv_dir_far: [Block<f32>; 3],
    t_min: Block<f32>,
    t_max: Block<f32>,
    valid: u32,
}

impl Ready {
    #[inline(always)]
    fn new<F: Float>(block: &RayBlock) -> Self {
        let zero = [Block([0.0; 16]); 3];
        let mut ready =
            Self { org: zero, dir: zero, inv_dir: zero, inv_dir_far: zero, t_min: zero[0], t_max: zero[0], valid: 0 };
        for chunk in 0..16 / F::LANES {
            let rays = Rays::<F>::load(block, chunk);
            rays.org.store(&mut ready.org, chunk);
            rays.dir.store(&mut ready.dir, chunk);
            rays.inv_dir.store(&mut ready.inv_dir, chunk);
            rays.inv_dir_far.store(&mut ready.inv_dir_far, chunk);
            rays.t_min.store_block(&mut ready.t_min, chunk);
            rays.t_max.store_block(&mut ready.t_max, chunk);
            ready.valid |= rays.valid.bitmask() << (chunk * F::LANES);
        }
        ready
    }

    #[inline(always)]
    fn ray(&self, lane: usize) -> Rays<f32> {
        let at = |v: &[Block<f32>; 3]| Vec3 { x: v[0].0[lane], y: v[1].0[lane], z: v[2].0[lane] };
        Rays {
            org: at(&self.org),
            dir: at(&self.dir),
            inv_dir: at(&self.inv_dir),
            inv_dir_far: at(&self.inv_dir_far),
            t_min: self.t_min.0[lane],
            t_max: self.t_max.0[lane],
            valid: true,
        }
    }

    #[inline(always)]
    fn near(&self, lane: usize) -> Near {
        let negative = |axis: usize| usize::from(self.inv_dir[axis].0[lane] < 0.0);
        Near::of_octant(negative(0) | negative(1) << 1 | negative(2) << 2)
    }
}

/// A ray on its way.
struct Walk<'a, const N: usize> {
    bvh: &'a WideBvh<N>,
    ray: Rays<f32>,
    near: Near,
    /// [`Near::upper`] of it.
    upper: [usize; 3],
}

/// A child with the distance where the ray enters its box above it: entries compare as distances do, for none is negative.
#[inline(always)]
fn entry(t_near: f32, child: Child) -> u64 {
    u64::from(t_near.to_bits()) << 32 | u64::from(child.bits())
}

impl<const N: usize> Walk<'_, N> {
    #[inline(always)]
    fn run<W: Wide, S: Simd, Q: Query, C: Count>(
        &self,
        stack: &mut [u64],
        lane: usize,
        found: &mut Q::Block,
        count: &mut C,
    ) {
        let (ray, triangle_ray) = (self.ray.splat::<W::Lanes<S>>(), self.ray.splat::<S::Float4>());
        let mut best = Hit { t: self.ray.t_max, ..Hit::MISS };
        let mut free = 0;
        let mut child = Child::node(0);
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
                if let Some(nearest) = self.descend(node, &ray, best.t, stack, &mut free) {
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
                    return;
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
    }

    /// The nearest of the children that the ray meets; the others go to the stack, the nearer above the farther.
    #[inline(always)]
    fn descend<F: Float>(
        &self,
        node: &WideNode<N>,
        ray: &Rays<F>,
        reach: f32,
        stack: &mut [u64],
        free: &mut usize,
    ) -> Option<Child> {
        let (t_near, mask) = meet(node, self.upper, ray, reach);
        let mut bits = mask.bitmask();
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
            let Some(hit) = moller_trumbore::intersect_group(group, &ray, self.near) else { continue };
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
}

/// Which boxes the ray meets, and where it enters them.
#[inline(always)]
fn meet<F: Float, const N: usize>(node: &WideNode<N>, near: [usize; 3], ray: &Rays<F>, reach: f32) -> (F, F::Mask) {
    let plane = |i: usize| F::load(&node.planes[i]);
    let [x, y, z] = near;
    let near = Vec3 { x: plane(x), y: plane(1 + y), z: plane(2 + z) };
    let far = Vec3 { x: plane(3 - x), y: plane(4 - y), z: plane(5 - z) };
    let (t_near, t_far) = slab::between(near - ray.org, far - ray.org, ray, ray.t_min, F::splat(reach));
    (t_near, t_near.le(t_far))
}

/// Closest or any.
trait Query {
    /// Results of a block of rays.
    type Block: Send;
    /// No ray hits anything.
    const NOTHING: Self::Block;
    const CLOSEST: bool;
    fn store(block: &mut Self::Block, lane: usize, hit: &Hit);
}

struct Closest;
impl Query for Closest {
    type Block = HitBlock;
    const NOTHING: HitBlock = HitBlock::MISS;
    const CLOSEST: bool = true;

    #[inline(always)]
    fn store(block: &mut HitBlock, lane: usize, hit: &Hit) {
        block.t.0[lane] = hit.t;
        block.u.0[lane] = hit.u;
        block.v.0[lane] = hit.v;
        block.primitive.0[lane] = hit.primitive;
    }
}

struct Any;
impl Query for Any {
    type Block = u16;
    const NOTHING: u16 = 0;
    const CLOSEST: bool = false;

    #[inline(always)]
    fn store(block: &mut u16, lane: usize, _: &Hit) {
        *block |= 1 << lane;
    }
}
