//! Packets of rays through the skip-pointer tree: Geimer & Müller 2003, section 3.3.

mod ordered;

use super::found::Found;
use super::query::{Any, Closest, Query};
use super::{BitVec, Context, Method, PORTION, in_portions};
use crate::Error;
use crate::bvh::Bvh;
use crate::geometry::moller_trumbore;
use crate::geometry::slab::{self, Near, Origin, PerRay, Shared};
use crate::geometry::{Hit, HitBatch, HitBlock, Packet as Rays, Ray, RayBatch, RayBlock};
use crate::lanes::{self, Lanes, Width};
use crate::stats::{Count, Counters, NoCount};
use simd::{Float, Isa, Level, Mask};

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

/// Which child of a node comes first. Both find the same hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Order {
    /// The one that is stored first: the paper's loop, without a stack.
    #[default]
    Stored,
    /// The one whose box the packet enters first; the other waits on a stack, and is passed over if a hit lies before it.
    NearFirst,
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
    order: Order,
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
            order: Order::default(),
            shared_origin: SharedOrigin::default(),
        }
    }

    /// With children in this order.
    #[must_use]
    pub fn with_order(self, order: Order) -> Self {
        Self { order, ..self }
    }

    /// With this form of the slab test. ([`Order::NearFirst`] has one alone, and shares no origin.)
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
            let Self { bvh, level, width, form, order, .. } = *self;
            if count {
                // The work is the same at every level.
                let count = Counters::default();
                lanes::run_once(width, Trace::<Q, _> { bvh, form, order, origin, rays, results, count })
            } else {
                let count = NoCount;
                lanes::run(level, width, Trace::<Q, _> { bvh, form, order, origin, rays, results, count })
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
    order: Order,
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
        match (self.order, self.origin) {
            (Order::Stored, Some(origin)) => self.trace::<F, _, false>(Shared(origin)),
            (Order::Stored, None) => self.trace::<F, _, false>(PerRay),
            (Order::NearFirst, _) => self.trace::<F, _, true>(PerRay),
        }
    }
}

impl<Q: Query, C: Count> Trace<'_, Q, C> {
    #[inline(always)]
    fn trace<F: Float, O: Origin<F>, const NEAR_FIRST: bool>(mut self, origin: O) -> Counters {
        let mut stack = Vec::new();
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
                let only = ray.only(same);
                if NEAR_FIRST {
                    ordered::traverse(self.bvh, &only, origin, near, &mut found, &mut stack, &mut self.count);
                } else {
                    traverse(self.bvh, self.form, &only, origin, near, &mut found, &mut self.count);
                }
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
        leaf(bvh, (first, number), ray, origin, near, found, count);
        if found.complete() {
            break;
        }
    }
}

/// The first hit of one ray, in plain `f32`.
pub(super) fn closest(bvh: &Bvh, ray: &Ray) -> Hit {
    let ray = Rays::<f32>::of(ray);
    let [x, y, z] = ray.signs();
    let near = Near::of_octant(usize::from(x) | usize::from(y) << 1 | usize::from(z) << 2);
    let mut found = <Closest as Query>::Found::new(&ray);
    if ray.valid {
        traverse(bvh, SlabForm::Exact, &ray, PerRay, near, &mut found, &mut NoCount);
    }
    let mut block = HitBlock::MISS;
    found.store(&mut block, 0);
    block.get(0)
}

/// The triangles of a leaf: the first, and how many.
#[inline(always)]
fn leaf<F: Float, O: Origin<F>, T: Found<F>, C: Count>(
    bvh: &Bvh,
    (first, number): (u32, u32),
    ray: &Rays<F>,
    origin: O,
    near: Near,
    found: &mut T,
    count: &mut C,
) {
    let first = first as usize;
    for triangle in &bvh.triangles[first..first + number as usize] {
        count.triangle_test();
        if let Some(hit) = moller_trumbore::intersect(triangle, ray, origin, near) {
            count.triangle_hit();
            found.accept(triangle.id, hit);
        }
    }
}
