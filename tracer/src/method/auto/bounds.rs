//! What many rays have in common: the interval arithmetic that lets one test stand for all of them (Boulos, Wald and Benthin
//! 2008, section 3).

use crate::geometry::slab::Near;
use crate::geometry::{Packet, Vec3};
use crate::method::ready::Ready;
use simd::{Block, Float};

/// Ranges of rays that point into one octant, a lane for each of sixteen blocks of them.
#[derive(Debug, Clone)]
pub(super) struct Bounds {
    /// Smallest and largest origins.
    org: [[Block<f32>; 3]; 2],
    /// Smallest and largest reciprocals of directions.
    inv_dir: [[Block<f32>; 3]; 2],
    t_min: Block<f32>,
    /// How far a hit still matters to any of them; negative infinity where there are no rays.
    pub(super) reach: Block<f32>,
}

impl Bounds {
    pub(super) const NONE: Self = Self {
        org: [[Block([0.0; 16]); 3]; 2],
        inv_dir: [[Block([1.0; 16]); 3]; 2],
        t_min: Block([0.0; 16]),
        reach: Block([f32::NEG_INFINITY; 16]),
    };

    /// The ranges of blocks of rays.
    #[inline(always)]
    pub(super) fn set_all<F: Float>(&mut self, rays: &[Ready; 16], blocks: u16) {
        self.reach = Self::NONE.reach;
        let mut rest = blocks;
        while rest != 0 {
            let block = rest.trailing_zeros() as usize % 16;
            rest &= rest - 1;
            self.set::<F>(block, &rays[block]);
        }
    }

    /// The ranges of the rays of a block.
    #[inline(always)]
    pub(super) fn set<F: Float>(&mut self, lane: usize, rays: &Ready) {
        let mask = rays.valid;
        let (origins, inverses) = (rays.origins::<F>(mask), rays.inverses::<F>(mask));
        for axis in 0..3 {
            for end in 0..2 {
                self.org[end][axis].0[lane] = origins[axis][end];
                self.inv_dir[end][axis].0[lane] = inverses[axis][end];
            }
        }
        self.t_min.0[lane] = rays.earliest::<F>(mask);
        self.reach.0[lane] = rays.farthest::<F>(mask);
    }

    /// The ranges as vectors, a lane for each block.
    #[inline(always)]
    pub(super) fn per_block<F: Float>(&self, near: Near) -> Interval<F> {
        const { assert!(F::LANES == 16, "a lane for each block") }
        let org = [Vec3::load(&self.org[0], 0), Vec3::load(&self.org[1], 0)];
        let inv_dir = [Vec3::load(&self.inv_dir[0], 0), Vec3::load(&self.inv_dir[1], 0)];
        Interval::new(org, inv_dir, F::load_block(&self.t_min, 0), near)
    }

    /// The ranges of one block in every lane.
    #[inline(always)]
    pub(super) fn of_block<F: Float>(&self, block: usize, near: Near) -> Interval<F> {
        let org = [lane(&self.org[0], block), lane(&self.org[1], block)];
        let inv_dir = [lane(&self.inv_dir[0], block), lane(&self.inv_dir[1], block)];
        Interval::new(org, inv_dir, F::splat(self.t_min.0[block]), near)
    }

    /// The ranges of the blocks of a mask (one at least) together in every lane.
    #[inline(always)]
    pub(super) fn of_all<F: Float>(&self, blocks: u16, near: Near) -> Interval<F> {
        let org = [extreme(&self.org[0], 0, blocks), extreme(&self.org[1], 1, blocks)];
        let inv_dir = [extreme(&self.inv_dir[0], 0, blocks), extreme(&self.inv_dir[1], 1, blocks)];
        Interval::new(org, inv_dir, F::splat(over(&self.t_min, blocks)[0]), near)
    }
}

#[inline(always)]
fn lane<F: Float>(v: &[Block<f32>; 3], i: usize) -> Vec3<F> {
    Vec3::splat([v[0].0[i], v[1].0[i], v[2].0[i]])
}

/// The smallest (`end` 0) or largest (1) of some lanes.
#[inline(always)]
fn extreme<F: Float>(v: &[Block<f32>; 3], end: usize, lanes: u16) -> Vec3<F> {
    Vec3::splat([over(&v[0], lanes)[end], over(&v[1], lanes)[end], over(&v[2], lanes)[end]])
}

/// Smallest and largest of some lanes.
#[inline(always)]
fn over(v: &Block<f32>, lanes: u16) -> [f32; 2] {
    let (mut range, mut rest) = ([f32::INFINITY, f32::NEG_INFINITY], lanes);
    while rest != 0 {
        let x = v.0[rest.trailing_zeros() as usize % 16];
        range = [if x < range[0] { x } else { range[0] }, if x > range[1] { x } else { range[1] }];
        rest &= rest - 1;
    }
    range
}

/// Rays as ranges, in the order that their octant wants.
#[derive(Debug, Clone, Copy)]
pub(super) struct Interval<F: Float> {
    /// The origins nearest to the near planes, and to the far ones.
    near_org: Vec3<F>,
    far_org: Vec3<F>,
    inv_dir: [Vec3<F>; 2],
    inv_dir_far: [Vec3<F>; 2],
    t_min: F,
}

impl<F: Float> Interval<F> {
    /// From smallest and largest origins and reciprocals.
    #[inline(always)]
    fn new([low, high]: [Vec3<F>; 2], inv_dir: [Vec3<F>; 2], t_min: F, near: Near) -> Self {
        // `plane - origin` times a positive reciprocal is smallest for the largest origin, times a negative one for the smallest.
        let pad = F::splat(Packet::<F>::PAD);
        Self {
            near_org: near.choose(high, low),
            far_org: near.choose(low, high),
            inv_dir,
            inv_dir_far: [inv_dir[0].scale(pad), inv_dir[1].scale(pad)],
            t_min,
        }
    }

    /// Bounds of the intervals that all rays have in a box, given its near and far planes: no `t_near` is below the first, no
    /// `t_far` above the second. Rounding is monotone as the operations are, so nothing need be widened.
    #[inline(always)]
    pub(super) fn between(&self, near: Vec3<F>, far: Vec3<F>, reach: F) -> (F, F) {
        let (a, b) = (near - self.near_org, far - self.far_org);
        let near = (a * self.inv_dir[0]).min(a * self.inv_dir[1]);
        let far = (b * self.inv_dir_far[0]).max(b * self.inv_dir_far[1]);
        let t_far = far.x.min(far.y).min(far.z.min(reach));
        (near.x.max(near.y).max(near.z.max(self.t_min)), t_far)
    }
}
