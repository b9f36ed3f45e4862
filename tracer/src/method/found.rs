//! What a query knows so far of the rays of a packet, in registers.

use crate::geometry::moller_trumbore::Candidate;
use crate::geometry::{Hit, HitBlock, Packet as Rays};
use simd::{Float, Mask, Vector};

/// What a query knows of each lane so far: see [`Query`](super::query::Query).
pub(crate) trait Found<F: Float> {
    type Block;
    fn new(ray: &Rays<F>) -> Self;
    /// How far along its ray a hit still matters.
    fn reach(&self) -> F;
    fn accept(&mut self, primitive: u32, hit: Candidate<F>);
    /// True when no further hit matters.
    fn complete(&self) -> bool;
    fn store(self, block: &mut Self::Block, chunk: usize);
}

/// The nearest hits.
pub(crate) struct ClosestHit<F: Float> {
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

/// Whether there are hits.
pub(crate) struct Occluded<F: Float> {
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
