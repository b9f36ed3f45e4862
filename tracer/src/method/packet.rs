//! Packets of rays through the skip-pointer tree: Geimer & Müller 2003, section 3.3.

use super::{BitVec, Context, Method, PORTION, in_portions};
use crate::Error;
use crate::bvh::Bvh;
use crate::geometry::moller_trumbore::{self, Candidate};
use crate::geometry::slab::{self, Near, Origin, PerRay, Shared};
use crate::geometry::{Hit, HitBatch, HitBlock, Packet as Rays, RayBatch, RayBlock};
use crate::lanes::{self, Lanes, Width};
use crate::stats::{Count, Counters, NoCount};
use simd::{Float, Isa, Level, Mask, Vector};

/// How a packet's box test becomes one answer. Both find the same hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SlabForm {
    /// A packet goes on if any of its rays meets the box.
    #[default]
    Exact,
    /// A packet goes on unless all rays miss the slabs or all leave them before their start: two simpler tests that let a few
    /// packets through which no ray needs. (With strict comparisons; the paper's print loses flat boxes.)
    Conservative,
}

/// Whether packets make use of it that all rays of a batch start at one point. Both ways find the same hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SharedOrigin {
    /// Where it is known of the batch ([`RayBatch::origin`]) and was measured to pay: for packets wider than the level's
    /// registers, and in emulation.
    #[default]
    Auto,
    /// Wherever it is known of the batch.
    Always,
    /// Never: each ray brings its own origin.
    Never,
}

/// Packet traversal of a [`Bvh`].
#[derive(Debug, Clone, Copy)]
pub struct Packet<'a> {
    bvh: &'a Bvh,
    level: Level,
    width: usize,
    form: SlabForm,
    shared_origin: SharedOrigin,
}

impl<'a> Packet<'a> {
    /// Over a tree, at a level, `width` rays at a time.
    #[must_use]
    pub fn new(bvh: &'a Bvh, level: Level, width: Width) -> Self {
        Self {
            bvh,
            level,
            width: width.lanes(level),
            form: SlabForm::default(),
            shared_origin: SharedOrigin::default(),
        }
    }

    /// With this form of the slab test.
    #[must_use]
    pub fn with_form(self, form: SlabForm) -> Self {
        Self { form, ..self }
    }

    /// With this use of shared origins.
    #[must_use]
    pub fn with_shared_origin(self, shared_origin: SharedOrigin) -> Self {
        Self { shared_origin, ..self }
    }

    /// The origin that packets of the batch shall share, if any.
    fn origin(&self, rays: &RayBatch) -> Option<[f32; 3]> {
        let isa = self.level.isa();
        let use_it = match self.shared_origin {
            SharedOrigin::Auto => matches!(isa, Isa::Scalar | Isa::Serial) || self.width > isa.lanes(),
            SharedOrigin::Always => true,
            SharedOrigin::Never => false,
        };
        rays.origin().filter(|o| use_it && o.iter().all(|x| x.is_finite()))
    }

    fn find<Q: Query>(&self, rays: &RayBatch, results: &mut [Q::Block], cx: &mut Context<'_>) -> Result<(), Error> {
        let origin = self.origin(rays);
        in_portions(PORTION, rays, results, cx, |count, rays, results| {
            let Self { bvh, level, width, form, .. } = *self;
            if count {
                // The work is the same at every level.
                let count = Counters::default();
                lanes::run_scalar(width, Trace::<Q, _> { bvh, form, origin, rays, results, count })
            } else {
                lanes::run(level, width, Trace::<Q, _> { bvh, form, origin, rays, results, count: NoCount })
            }
        })
    }
}

impl Method for Packet<'_> {
    fn name(&self) -> &'static str {
        "packet"
    }

    fn source(&self) -> &'static str {
        "Geimer & Müller 2003, section 3.3"
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
struct Trace<'a, Q: Query, C> {
    bvh: &'a Bvh,
    form: SlabForm,
    /// Where all rays start, to be made use of.
    origin: Option<[f32; 3]>,
    rays: &'a [RayBlock],
    results: &'a mut [Q::Block],
    count: C,
}

impl<Q: Query, C: Count> Lanes for Trace<'_, Q, C> {
    type Output = Counters;

    #[inline(always)]
    fn run<F: Float>(self) -> Counters {
        match self.origin {
            Some(origin) => self.trace::<F, _>(Shared(origin)),
            None => self.trace::<F, _>(PerRay),
        }
    }
}

impl<Q: Query, C: Count> Trace<'_, Q, C> {
    #[inline(always)]
    fn trace<F: Float, O: Origin<F>>(mut self, origin: O) -> Counters {
        for (block, chunk) in lanes::chunks::<F>(self.rays.len()) {
            let ray = Rays::<F>::load(&self.rays[block], chunk);
            let mut found = Q::Found::new(&ray);
            self.count.packet();
            let [x, y, z] = ray.signs();
            // One pass for each octant that directions point into: nearly always one in all.
            let mut rest = ray.valid;
            while let Some(lane) = rest.first() {
                let sign = |mask: F::Mask| (mask.bitmask() >> lane & 1) as usize;
                let octant = sign(x) | sign(y) << 1 | sign(z) << 2;
                let splat = |bit: usize| F::Mask::splat(octant >> bit & 1 != 0);
                let same = rest & !((x ^ splat(0)) | (y ^ splat(1)) | (z ^ splat(2)));
                let near = Near::of_octant(octant);
                traverse(self.bvh, self.form, &ray.only(same), origin, near, &mut found, &mut self.count);
                rest &= !same;
            }
            found.store(&mut self.results[block], chunk);
        }
        self.count.total()
    }
}

/// The loop of section 3.3: `node + 1` after a hit, `skip` after a miss.
#[inline(always)]
fn traverse<F: Float, O: Origin<F>, T: Found<F>, C: Count>(
    bvh: &Bvh,
    form: SlabForm,
    ray: &Rays<F>,
    origin: O,
    near: Near,
    found: &mut T,
    count: &mut C,
) {
    let mut i = 0;
    while let Some(node) = bvh.nodes.get(i) {
        count.box_test();
        let (t_near, t_far) = slab::interval(node.planes(), ray, origin, near, ray.t_min, found.reach());
        let meets = match form {
            SlabForm::Exact => t_near.le(t_far).any(),
            SlabForm::Conservative => !(t_far.lt(t_near).all() || t_far.lt(ray.t_min).all()),
        };
        if !meets {
            i = node.skip() as usize;
            continue;
        }
        // Where the walk comes after this subtree.
        simd::prefetch(&bvh.nodes, node.skip() as usize);
        i += 1;
        let (first, number) = node.triangles();
        if number == 0 {
            continue;
        }
        let first = first as usize;
        for triangle in &bvh.triangles[first..first + number as usize] {
            count.triangle_test();
            if let Some(hit) = moller_trumbore::intersect(triangle, ray, origin, near) {
                count.triangle_hit();
                found.accept(triangle.id, hit);
            }
        }
        if found.complete() {
            break;
        }
    }
}

/// Closest or any.
trait Query {
    /// Results of a block of rays.
    type Block: Send;
    type Found<F: Float>: Found<F, Block = Self::Block>;
}

/// What a query knows of each lane so far.
trait Found<F: Float> {
    type Block;
    fn new(ray: &Rays<F>) -> Self;
    /// How far along its ray a hit still matters.
    fn reach(&self) -> F;
    fn accept(&mut self, primitive: u32, hit: Candidate<F>);
    /// True when no further hit matters.
    fn complete(&self) -> bool;
    fn store(self, block: &mut Self::Block, chunk: usize);
}

struct Closest;
impl Query for Closest {
    type Block = HitBlock;
    type Found<F: Float> = ClosestHit<F>;
}

struct ClosestHit<F: Float> {
    t: F,
    u: F,
    v: F,
    primitive: F::Index,
}

impl<F: Float> Found<F> for ClosestHit<F> {
    type Block = HitBlock;

    #[inline(always)]
    fn new(ray: &Rays<F>) -> Self {
        let zero = F::splat(0.0);
        Self { t: ray.t_max, u: zero, v: zero, primitive: F::Index::splat(Hit::NO_PRIMITIVE) }
    }

    #[inline(always)]
    fn reach(&self) -> F {
        self.t
    }

    #[inline(always)]
    fn accept(&mut self, primitive: u32, hit: Candidate<F>) {
        let primitive = F::Index::splat(primitive);
        // At equal distance the lower id wins, whatever order the leaves are visited in.
        let closer = hit.t.lt(self.t) | (hit.t.eq(self.t) & primitive.lt(self.primitive));
        let mask = hit.mask & closer;
        self.t = F::select(mask, hit.t, self.t);
        self.u = F::select(mask, hit.u, self.u);
        self.v = F::select(mask, hit.v, self.v);
        self.primitive = F::Index::select(mask, primitive, self.primitive);
    }

    #[inline(always)]
    fn complete(&self) -> bool {
        false
    }

    #[inline(always)]
    fn store(self, block: &mut HitBlock, chunk: usize) {
        let miss = self.primitive.eq(F::Index::splat(Hit::NO_PRIMITIVE));
        F::select(miss, F::splat(Hit::MISS.t), self.t).store_block(&mut block.t, chunk);
        self.u.store_block(&mut block.u, chunk);
        self.v.store_block(&mut block.v, chunk);
        self.primitive.store_block(&mut block.primitive, chunk);
    }
}

struct Any;
impl Query for Any {
    type Block = u16;
    type Found<F: Float> = Occluded<F>;
}

struct Occluded<F: Float> {
    /// Minus infinity where something was hit: such a lane meets no box any more.
    reach: F,
    hit: F::Mask,
}

impl<F: Float> Found<F> for Occluded<F> {
    type Block = u16;

    #[inline(always)]
    fn new(ray: &Rays<F>) -> Self {
        Self { reach: ray.t_max, hit: F::Mask::splat(false) }
    }

    #[inline(always)]
    fn reach(&self) -> F {
        self.reach
    }

    #[inline(always)]
    fn accept(&mut self, _primitive: u32, hit: Candidate<F>) {
        self.reach = F::select(hit.mask, F::splat(f32::NEG_INFINITY), self.reach);
        self.hit |= hit.mask;
    }

    #[inline(always)]
    fn complete(&self) -> bool {
        self.reach.eq(F::splat(f32::NEG_INFINITY)).all()
    }

    #[inline(always)]
    fn store(self, block: &mut u16, chunk: usize) {
        if chunk == 0 {
            *block = 0;
        }
        *block |= (self.hit.bitmask() as u16) << (chunk * F::LANES);
    }
}
