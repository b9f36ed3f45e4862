//! Rays, one at a time, through the tree of a world, and in it through those of the instances.

use super::primitives::Items;
use super::transform::{is_ordinary, largest};
use super::{Content, World, WorldHit};
use crate::bvh::{WideBvh, WideNode};
use crate::geometry::{Hit, Packet, Ray, RayBatch, RayBlock, TriangleGroup};
use crate::method::search::{BoxRay, FirstHit, Goal, search};
use crate::parallel::{PORTION, portions};
use simd::{Kernel, Mask, Simd, Vector};

/// A hit that is refused, of the ray with a number, is passed through.
pub(super) type Accept<'a> = dyn Fn(usize, &WorldHit) -> bool + Sync + 'a;

/// The same within a thread.
type Filter<'a> = &'a dyn Fn(usize, &WorldHit) -> bool;

/// Results of sixteen rays.
pub(super) trait Results: Send {
    const CLOSEST: bool;
    const NOTHING: Self;
    fn set(&mut self, lane: usize, hit: &WorldHit);
}

impl Results for [WorldHit; 16] {
    const CLOSEST: bool = true;
    const NOTHING: Self = [WorldHit::MISS; 16];
    #[inline(always)]
    fn set(&mut self, lane: usize, hit: &WorldHit) {
        self[lane] = *hit;
    }
}

/// Whether each hits anything.
impl Results for u16 {
    const CLOSEST: bool = false;
    const NOTHING: Self = 0;
    #[inline(always)]
    fn set(&mut self, lane: usize, _: &WorldHit) {
        *self |= 1 << lane;
    }
}

/// The results of many rays, on the threads of the current rayon pool.
pub(super) fn batch<R: Results>(
    world: &World,
    rays: &RayBatch,
    masks: Option<&[u32]>,
    results: &mut [R],
    accept: Option<&Accept>,
) {
    let portion = |first, blocks: &[RayBlock], results: &mut [R]| {
        let accept = accept.map(|accept| accept as Filter);
        world.level.run(Find { world, rays: blocks, masks, numbers: 16 * first..rays.len(), results, accept });
        Ok(())
    };
    // Nothing cancels it.
    let _ = portions(PORTION, rays.blocks(), results, portion, || (), |(), ()| ());
}

/// The result of one ray, the first of those returned.
pub(super) fn one<R: Results>(
    world: &World,
    ray: &Ray,
    mask: Option<u32>,
    accept: Option<&dyn Fn(&WorldHit) -> bool>,
) -> R {
    let mut rays = [RayBlock::NONE];
    rays[0].set(0, ray);
    let mut results = [R::NOTHING];
    let mask = mask.map(|mask| [mask]);
    let numbered = accept.map(|accept| move |_, hit: &WorldHit| accept(hit));
    world.level.run(Find {
        world,
        rays: &rays,
        masks: mask.as_ref().map(|mask| &mask[..]),
        numbers: 0..1,
        results: &mut results,
        accept: numbered.as_ref().map(|accept| accept as Filter),
    });
    let [result] = results;
    result
}

struct Find<'a, R> {
    world: &'a World,
    rays: &'a [RayBlock],
    /// By the numbers of rays.
    masks: Option<&'a [u32]>,
    /// Of the first of these rays, and of the one behind the last of all.
    numbers: std::ops::Range<usize>,
    results: &'a mut [R],
    accept: Option<Filter<'a>>,
}

impl<R: Results> Kernel for Find<'_, R> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self) {
        let mut stack = Vec::with_capacity(self.world.room);
        let mut first = self.numbers.start;
        for (block, results) in self.rays.iter().zip(self.results) {
            *results = R::NOTHING;
            for lane in 0..(self.numbers.end - first).min(16) {
                let number = first + lane;
                let packet = Packet::<f32>::load(block, lane);
                if !packet.valid {
                    continue;
                }
                let ray = block.get(lane);
                let accept = |hit: &WorldHit| self.accept.is_none_or(|accept| accept(number, hit));
                let mut goal = FirstInWorld::<S> {
                    world: self.world,
                    boxes: BoxRay::new(&packet, self.world.growth * largest(&ray.org)),
                    is_ordinary: is_ordinary(&ray),
                    ray,
                    mask: self.masks.map(|masks| masks[number]),
                    is_closest: R::CLOSEST,
                    is_filtered: self.accept.is_some(),
                    accept: &accept,
                    reach: packet.t_max,
                    best: WorldHit::MISS,
                };
                search(&self.world.tree, &mut goal, &mut stack);
                if !goal.best.is_miss() {
                    results.set(lane, &goal.best);
                }
            }
            first = self.numbers.end.min(first + 16);
        }
    }
}

/// The first hit of a ray, or any, among the instances.
struct FirstInWorld<'a, S: Simd> {
    world: &'a World,
    ray: Ray,
    boxes: BoxRay<S::Float8>,
    is_ordinary: bool,
    mask: Option<u32>,
    is_closest: bool,
    is_filtered: bool,
    accept: &'a dyn Fn(&WorldHit) -> bool,
    /// How far along the ray a hit matters.
    reach: f32,
    best: WorldHit,
}

impl<S: Simd> FirstInWorld<'_, S> {
    /// What the ray hits in an instance.
    #[inline(always)]
    fn visit(&mut self, number: u32, stack: &mut Vec<u64>) {
        let Some(instance) = self.world.instances.get(number as usize) else { return };
        if self.mask.is_some_and(|mask| mask & instance.mask == 0) {
            return;
        }
        let ray = instance.transform.ray(&self.ray);
        let packet = Packet::of(&ray);
        if !packet.valid {
            return;
        }
        let hit = match &instance.content {
            Content::Scene(scene) => {
                let accept = |hit: &Hit| {
                    self.mask.is_none_or(|mask| scene.is_visible(hit.primitive, mask))
                        && (self.accept)(&WorldHit { hit: *hit, instance: number })
                };
                let mut goal = FirstHit::<S>::new(&packet, self.is_closest, &accept);
                goal.reach = goal.reach.min(self.reach);
                search(scene.bvh(), &mut goal, stack);
                goal.best
            }
            Content::Items(items) => {
                let accept = |hit: &Hit| (self.accept)(&WorldHit { hit: *hit, instance: number });
                let mut goal = FirstItem::<S> {
                    items,
                    boxes: BoxRay::new(&packet, 0.0),
                    ray,
                    packet,
                    is_closest: self.is_closest,
                    is_filtered: self.is_filtered,
                    accept: &accept,
                    reach: packet.t_max.min(self.reach),
                    best: Hit::MISS,
                };
                search(&items.tree, &mut goal, stack);
                goal.best
            }
        };
        let found = WorldHit { hit, instance: number };
        // Not beyond the reach, but at the same distance a lower instance may have been there before.
        if !found.is_miss() && (self.best.is_miss() || found.is_before(&self.best)) {
            self.best = found;
            self.reach = if self.is_closest { hit.t } else { f32::NEG_INFINITY };
        }
    }
}

impl<S: Simd> Goal<S> for FirstInWorld<'_, S> {
    #[inline(always)]
    fn children(&self, node: &WideNode<8>) -> (S::Float8, u32) {
        if !self.is_ordinary {
            // What boxes allow for is not enough: all children. Where there is none, the box is inside out.
            let [low, high] = [S::Float8::load(&node.planes[0]), S::Float8::load(&node.planes[3])];
            return (S::Float8::splat(0.0), low.le(high).bitmask());
        }
        self.boxes.meet(node, self.reach)
    }

    #[inline(always)]
    fn group(&mut self, group: &TriangleGroup<{ WideBvh::<8>::GROUP }>, stack: &mut Vec<u64>) {
        for number in group.id {
            if number != Hit::NO_PRIMITIVE {
                self.visit(number, stack);
            }
        }
    }

    #[inline(always)]
    fn reach(&self) -> f32 {
        self.reach
    }
}

/// The first hit of a ray, or any, among the user's primitives of an instance.
struct FirstItem<'a, S: Simd> {
    items: &'a Items,
    boxes: BoxRay<S::Float8>,
    ray: Ray,
    packet: Packet<f32>,
    is_closest: bool,
    is_filtered: bool,
    accept: &'a dyn Fn(&Hit) -> bool,
    /// How far along the ray a hit matters.
    reach: f32,
    best: Hit,
}

impl<S: Simd> Goal<S> for FirstItem<'_, S> {
    #[inline(always)]
    fn children(&self, node: &WideNode<8>) -> (S::Float8, u32) {
        self.boxes.meet(node, self.reach)
    }

    #[inline(always)]
    fn group(&mut self, group: &TriangleGroup<{ WideBvh::<8>::GROUP }>, _: &mut Vec<u64>) {
        for i in group.id {
            if i == Hit::NO_PRIMITIVE || self.reach == f32::NEG_INFINITY {
                continue;
            }
            let hit = if self.is_closest || self.is_filtered {
                self.items.closest(i, &self.ray, &self.packet)
            } else {
                // Only that there is one matters.
                let hit = Hit { t: self.packet.t_min, u: 0.0, v: 0.0, primitive: i };
                self.items.occluded(i, &self.ray).then_some(hit)
            };
            let Some(hit) = hit else { continue };
            let is_better = hit.t < self.reach || (hit.t == self.reach && i < self.best.primitive);
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
