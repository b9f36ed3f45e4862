//! What is asked of rays, closest or any, and the best hits of sixteen rays in memory.

use super::found::{ClosestHit, Found, Occluded};
use crate::geometry::moller_trumbore::Candidate;
use crate::geometry::{Hit, HitBlock};
use simd::{Block, Float, Vector};

/// Closest or any.
pub(crate) trait Query {
    /// Results of a block of rays.
    type Block: Send + Clone;
    /// What is known of each lane so far, for methods that keep it in registers.
    type Found<F: Float>: Found<F, Block = Self::Block>;
    /// No ray hits anything.
    const NOTHING: Self::Block;
    const CLOSEST: bool;

    /// The hits of some lanes of a triangle that matter: in `block` and, how far along the ray a hit still matters, in `reach`.
    fn accept<F: Float>(
        block: &mut Self::Block,
        reach: &mut Block<f32>,
        chunk: usize,
        primitive: u32,
        hit: Candidate<F>,
    );

    /// Lanes for which something else may be found.
    fn open(block: &Self::Block) -> u16;

    /// The distance of an entry of the stack, if it matters whether something nearer was hit.
    #[inline(always)]
    fn distance(key: u64) -> f32 {
        if Self::CLOSEST { f32::from_bits((key >> 32) as u32) } else { 0.0 }
    }

    /// The hit found for a lane so far, or a miss at `reach`.
    fn best(block: &Self::Block, lane: usize, reach: f32) -> Hit;

    fn store(block: &mut Self::Block, lane: usize, hit: &Hit);

    /// The results of `F::LANES` rays from one place to another: a block and which of its groups of as many lanes.
    fn copy<F: Float>(from: (&Self::Block, usize), to: (&mut Self::Block, usize));
}

pub(crate) struct Closest;
impl Query for Closest {
    type Block = HitBlock;
    type Found<F: Float> = ClosestHit<F>;
    const NOTHING: HitBlock = HitBlock::MISS;
    const CLOSEST: bool = true;

    #[inline(always)]
    fn accept<F: Float>(block: &mut HitBlock, reach: &mut Block<f32>, chunk: usize, primitive: u32, hit: Candidate<F>) {
        let primitive = F::Index::splat(primitive);
        let (t, before) = (F::load_block(reach, chunk), F::Index::load_block(&block.primitive, chunk));
        // At equal distance the lower id wins, whatever order the leaves are visited in.
        let mask = hit.mask & (hit.t.lt(t) | (hit.t.eq(t) & primitive.lt(before)));
        F::select(mask, hit.t, t).store_block(reach, chunk);
        F::select(mask, hit.t, F::load_block(&block.t, chunk)).store_block(&mut block.t, chunk);
        F::select(mask, hit.u, F::load_block(&block.u, chunk)).store_block(&mut block.u, chunk);
        F::select(mask, hit.v, F::load_block(&block.v, chunk)).store_block(&mut block.v, chunk);
        F::Index::select(mask, primitive, before).store_block(&mut block.primitive, chunk);
    }

    #[inline(always)]
    fn open(_: &HitBlock) -> u16 {
        u16::MAX
    }

    #[inline(always)]
    fn best(block: &HitBlock, lane: usize, reach: f32) -> Hit {
        Hit { t: reach, u: block.u.0[lane], v: block.v.0[lane], primitive: block.primitive.0[lane] }
    }

    #[inline(always)]
    fn store(block: &mut HitBlock, lane: usize, hit: &Hit) {
        block.t.0[lane] = hit.t;
        block.u.0[lane] = hit.u;
        block.v.0[lane] = hit.v;
        block.primitive.0[lane] = hit.primitive;
    }

    #[inline(always)]
    fn copy<F: Float>((from, i): (&HitBlock, usize), (to, k): (&mut HitBlock, usize)) {
        F::load_block(&from.t, i).store_block(&mut to.t, k);
        F::load_block(&from.u, i).store_block(&mut to.u, k);
        F::load_block(&from.v, i).store_block(&mut to.v, k);
        F::Index::load_block(&from.primitive, i).store_block(&mut to.primitive, k);
    }
}

pub(crate) struct Any;
impl Query for Any {
    type Block = u16;
    type Found<F: Float> = Occluded<F>;
    const NOTHING: u16 = 0;
    const CLOSEST: bool = false;

    #[inline(always)]
    fn accept<F: Float>(block: &mut u16, reach: &mut Block<f32>, chunk: usize, _: u32, hit: Candidate<F>) {
        use simd::Mask;
        // What was hit meets no box any more.
        let t = F::load_block(reach, chunk);
        F::select(hit.mask, F::splat(f32::NEG_INFINITY), t).store_block(reach, chunk);
        *block |= (hit.mask.bitmask() as u16) << (chunk * F::LANES);
    }

    #[inline(always)]
    fn open(block: &u16) -> u16 {
        !block
    }

    #[inline(always)]
    fn best(_: &u16, _: usize, reach: f32) -> Hit {
        Hit { t: reach, ..Hit::MISS }
    }

    #[inline(always)]
    fn store(block: &mut u16, lane: usize, _: &Hit) {
        *block |= 1 << lane;
    }

    #[inline(always)]
    fn copy<F: Float>((from, i): (&u16, usize), (to, k): (&mut u16, usize)) {
        let ones = ((1 << F::LANES) - 1) as u16;
        *to |= (from >> (i * F::LANES) & ones) << (k * F::LANES);
    }
}
