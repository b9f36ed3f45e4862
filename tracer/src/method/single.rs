//! One ray at a time through a wide tree, against all children of a node at once, nearest first (Wald, Benthin and Boulos 2008).

use super::query::{Any, Closest, Query};
use super::ready::Ready;
use super::walk::{Arity, Walk, Wide};
use super::{BitVec, Context, Method, PORTION, in_portions};
use crate::Error;
use crate::bvh::{Child, WideBvh};
use crate::geometry::{Hit, HitBatch, Ray, RayBatch, RayBlock};
use crate::stats::{Count, Counters, NoCount};
use simd::{Kernel, Level, Simd};

/// Single rays through a [`WideBvh`].
#[derive(Debug, Clone, Copy)]
pub struct Single<'a, const N: usize> {
    bvh: &'a WideBvh<N>,
    level: Level,
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

    /// The first hit of one ray; [`Hit::MISS`] if there is none.
    #[must_use]
    pub fn closest_of(&self, ray: &Ray) -> Hit {
        let hits = self.one::<Closest>(ray);
        Hit { t: hits.t.0[0], u: hits.u.0[0], v: hits.v.0[0], primitive: hits.primitive.0[0] }
    }

    /// Whether one ray hits anything.
    #[must_use]
    pub fn any_of(&self, ray: &Ray) -> bool {
        self.one::<Any>(ray) != 0
    }

    fn one<Q: Query>(&self, ray: &Ray) -> Q::Block {
        let mut rays = [RayBlock::NONE];
        rays[0].set(0, ray);
        let mut results = [Q::NOTHING];
        self.level.run(Trace::<Q, _, N> { bvh: self.bvh, rays: &rays, results: &mut results, count: NoCount });
        let [result] = results;
        result
    }

    fn find<Q: Query>(&self, rays: &RayBatch, results: &mut [Q::Block], cx: &mut Context<'_>) -> Result<(), Error> {
        in_portions(PORTION, rays, results, cx, |count, rays, results| {
            let bvh = self.bvh;
            if count {
                // The work is the same at every level.
                Level::run_native(Trace::<Q, _, N> { bvh, rays, results, count: Counters::default() })
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
        let largest = self.bvh.largest_coordinate();
        for (block, results) in self.rays.iter().zip(self.results) {
            let ready = Ready::new::<S::Float>(block, largest);
            let mut found = Q::NOTHING;
            let mut rest = ready.valid;
            while rest != 0 {
                let lane = rest.trailing_zeros() as usize % 16;
                rest &= rest - 1;
                self.count.packet();
                let walk = Walk::new(self.bvh, &ready, lane);
                if ready.odd >> lane & 1 == 0 {
                    walk.run::<Arity<N>, S, Q, C>(Child::node(0), &mut stack, &mut found, &mut self.count);
                } else {
                    walk.run_odd::<Q, C>(&mut stack, &mut found, &mut self.count);
                }
            }
            *results = found;
        }
        self.count.total()
    }
}
