//! Rays, one at a time, whose hits the caller may refuse.

use super::PORTION;
use super::query::Query;
use super::search::{FirstHit, search, stack_for};
use crate::bvh::WideBvh;
use crate::geometry::{Hit, Packet, Ray, RayBatch, RayBlock};
use crate::parallel::portions;
use simd::{Kernel, Level, Simd};

/// A hit that is refused, of the ray with a number, is passed through.
pub(crate) type Accept<'a> = dyn Fn(usize, &Hit) -> bool + Sync + 'a;

/// The results of many rays, on the threads of the current rayon pool.
pub(crate) fn batch<Q: Query>(
    bvh: &WideBvh<8>,
    level: Level,
    rays: &RayBatch,
    results: &mut [Q::Block],
    accept: &Accept,
) {
    let portion = |first, blocks: &[RayBlock], results: &mut [Q::Block]| {
        level.run(Trace::<Q> { bvh, rays: blocks, numbers: 16 * first..rays.len(), results, accept: &accept });
        Ok(())
    };
    // Nothing cancels it.
    let _ = portions(PORTION, rays.blocks(), results, portion, || (), |(), ()| ());
}

/// The result of one ray.
pub(crate) fn one<Q: Query>(bvh: &WideBvh<8>, level: Level, ray: &Ray, accept: &dyn Fn(&Hit) -> bool) -> Q::Block {
    let mut rays = [RayBlock::NONE];
    rays[0].set(0, ray);
    let mut results = [Q::NOTHING];
    let accept = |_, hit: &Hit| accept(hit);
    level.run(Trace::<Q> { bvh, rays: &rays, numbers: 0..1, results: &mut results, accept: &accept });
    let [result] = results;
    result
}

struct Trace<'a, Q: Query> {
    bvh: &'a WideBvh<8>,
    rays: &'a [RayBlock],
    /// Of the first of these rays, and of the one behind the last of all.
    numbers: std::ops::Range<usize>,
    results: &'a mut [Q::Block],
    accept: &'a dyn Fn(usize, &Hit) -> bool,
}

impl<Q: Query> Kernel for Trace<'_, Q> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self) {
        let mut stack = stack_for(self.bvh);
        let mut first = self.numbers.start;
        for (block, results) in self.rays.iter().zip(self.results) {
            *results = Q::NOTHING;
            for lane in 0..(self.numbers.end - first).min(16) {
                let number = first + lane;
                let ray = Packet::<f32>::load(block, lane);
                if !ray.valid {
                    continue;
                }
                let accept = |hit: &Hit| (self.accept)(number, hit);
                let mut goal = FirstHit::<S>::new(&ray, Q::CLOSEST, &accept);
                search(self.bvh, &mut goal, &mut stack);
                if !goal.best.is_miss() {
                    Q::store(results, lane, &goal.best);
                }
            }
            first = self.numbers.end.min(first + 16);
        }
    }
}
