//! Sixteen rays made ready for traversal, in memory: as packets, or one of them.

use crate::geometry::cull::Cull;
use crate::geometry::{Packet, RayBlock, Vec3};
use simd::{Block, Float, Mask};

/// See [`Packet`].
#[derive(Debug, Clone)]
pub(super) struct Ready {
    org: [Block<f32>; 3],
    dir: [Block<f32>; 3],
    inv_dir: [Block<f32>; 3],
    inv_dir_far: [Block<f32>; 3],
    /// See [`Cull`].
    pub(super) cull: [[Block<f32>; 3]; 3],
    pub(super) t_min: Block<f32>,
    /// How far along each ray a hit matters.
    pub(super) reach: Block<f32>,
    /// Which rays can hit something, a bit each.
    pub(super) valid: u16,
    /// Which of these [`Cull`] is not for.
    pub(super) odd: u16,
}

impl Ready {
    /// No rays.
    pub(super) const NONE: Self = {
        let zero = [Block([0.0; 16]); 3];
        Self {
            org: zero,
            dir: zero,
            inv_dir: zero,
            inv_dir_far: zero,
            cull: [zero; 3],
            t_min: zero[0],
            reach: zero[0],
            valid: 0,
            odd: 0,
        }
    };

    #[inline(always)]
    pub(super) fn new<F: Float>(block: &RayBlock, largest: f32) -> Self {
        let mut ready = Self::NONE;
        ready.set::<F>(block, largest);
        ready
    }

    /// These rays instead; `largest` is that of [`Cull::new`].
    #[inline(always)]
    pub(super) fn set<F: Float>(&mut self, block: &RayBlock, largest: f32) {
        (self.valid, self.odd) = (0, 0);
        for chunk in 0..16 / F::LANES {
            let rays = Packet::<F>::load(block, chunk);
            rays.org.store(&mut self.org, chunk);
            rays.dir.store(&mut self.dir, chunk);
            rays.inv_dir.store(&mut self.inv_dir, chunk);
            rays.inv_dir_far.store(&mut self.inv_dir_far, chunk);
            rays.t_min.store_block(&mut self.t_min, chunk);
            rays.t_max.store_block(&mut self.reach, chunk);
            let (cull, ordinary) = Cull::new(&rays, largest);
            cull.store(&mut self.cull, chunk);
            self.valid |= (rays.valid.bitmask() << (chunk * F::LANES)) as u16;
            self.odd |= ((rays.valid & !ordinary).bitmask() << (chunk * F::LANES)) as u16;
        }
    }

    /// All sixteen, with the reach for their end; those with `from` infinite hit nothing.
    #[inline(always)]
    pub(super) fn packet<F: Float>(&self, from: &Block<f32>) -> Packet<F> {
        const { assert!(F::LANES == 16, "a lane for each ray") }
        Packet {
            org: Vec3::load(&self.org, 0),
            dir: Vec3::load(&self.dir, 0),
            inv_dir: Vec3::load(&self.inv_dir, 0),
            inv_dir_far: Vec3::load(&self.inv_dir_far, 0),
            t_min: F::load_block(from, 0),
            t_max: F::load_block(&self.reach, 0),
            valid: F::Mask::splat(true),
        }
    }

    /// One ray.
    #[inline(always)]
    pub(super) fn ray(&self, lane: usize) -> Packet<f32> {
        let at = |v: &[Block<f32>; 3]| Vec3 { x: v[0].0[lane], y: v[1].0[lane], z: v[2].0[lane] };
        Packet {
            org: at(&self.org),
            dir: at(&self.dir),
            inv_dir: at(&self.inv_dir),
            inv_dir_far: at(&self.inv_dir_far),
            t_min: self.t_min.0[lane],
            t_max: self.reach.0[lane],
            valid: true,
        }
    }

    /// The octant that a ray points into: a bit per axis, set for negative.
    #[inline(always)]
    pub(super) fn octant(&self, lane: usize) -> usize {
        let negative = |axis: usize| usize::from(self.inv_dir[axis].0[lane] < 0.0);
        negative(0) | negative(1) << 1 | negative(2) << 2
    }

    /// The octant that all valid rays point into, if it is one.
    #[inline(always)]
    pub(super) fn common_octant<F: Float>(&self) -> Option<usize> {
        const { assert!(F::LANES == 16, "a lane for each ray") }
        let zero = F::splat(0.0);
        let mut octant = 0;
        for axis in 0..3 {
            let negative = F::load_block(&self.inv_dir[axis], 0).lt(zero).bitmask() as u16 & self.valid;
            if negative != 0 {
                if negative != self.valid {
                    return None;
                }
                octant |= 1 << axis;
            }
        }
        Some(octant)
    }

    /// Smallest and largest origin of the lanes of `mask`, which has one at least.
    #[inline(always)]
    pub(super) fn origins<F: Float>(&self, mask: u16) -> [[f32; 2]; 3] {
        ranges::<F>(&self.org, mask)
    }

    /// Sum of the sides of the box around the origins.
    #[inline(always)]
    pub(super) fn scatter<F: Float>(&self) -> f32 {
        let [x, y, z] = self.origins::<F>(self.valid);
        (x[1] - x[0]) + (y[1] - y[0]) + (z[1] - z[0])
    }

    /// A box outside of which no valid ray meets anything: around their origins and ends.
    ///
    /// A ray that comes to a plane at `t <= end` as computed, each operation rounded, comes there at `t <= (1 + 2^-21) end`; that and the roundings of
    /// the ends themselves are less than what is added here.
    #[inline(always)]
    pub(super) fn extent<F: Float>(&self) -> [[f32; 2]; 3] {
        const { assert!(F::LANES == 16, "a lane for each ray") }
        let on = F::Mask::from_bitmask(u32::from(self.valid));
        let (reach, least) = (F::load_block(&self.reach, 0), F::splat(f32::MIN_POSITIVE));
        let mut extent = [[0.0; 2]; 3];
        for (axis, extent) in extent.iter_mut().enumerate() {
            let (org, dir) = (F::load_block(&self.org[axis], 0), F::load_block(&self.dir[axis], 0));
            let way = dir.abs().max(least).copysign(dir) * reach;
            let (end, slack) = (org + way, (org.abs() + way.abs()) * F::splat(8.0 * f32::EPSILON));
            let (low, high) = (org.min(end) - slack, org.max(end) + slack);
            *extent = [
                F::select(on, low, F::splat(f32::INFINITY)).reduce_min(),
                F::select(on, high, F::splat(f32::NEG_INFINITY)).reduce_max(),
            ];
        }
        extent
    }

    /// Smallest and largest reciprocal of the direction of the lanes of `mask`, which has one at least.
    #[inline(always)]
    pub(super) fn inverses<F: Float>(&self, mask: u16) -> [[f32; 2]; 3] {
        ranges::<F>(&self.inv_dir, mask)
    }

    /// The largest reach of the lanes of `mask`, negative infinity without one.
    #[inline(always)]
    pub(super) fn farthest<F: Float>(&self, mask: u16) -> f32 {
        range::<F>(&self.reach, mask)[1]
    }

    /// The smallest start of the intervals of the lanes of `mask`.
    #[inline(always)]
    pub(super) fn earliest<F: Float>(&self, mask: u16) -> f32 {
        range::<F>(&self.t_min, mask)[0]
    }

    /// Cosine of the angle between two rays.
    #[inline(always)]
    pub(super) fn cosine_to(&self, lane: usize, other: &Self, other_lane: usize) -> f32 {
        let (a, b) = (self.ray(lane).dir, other.ray(other_lane).dir);
        a.dot(b) / (a.dot(a) * b.dot(b)).sqrt()
    }

    /// Whether the cosines of the angles between the first valid ray and the others are at least `least`, which is positive.
    #[inline(always)]
    pub(super) fn are_within<F: Float>(&self, least: f32) -> bool {
        const { assert!(F::LANES == 16, "a lane for each ray") }
        let first = self.ray(self.valid.trailing_zeros() as usize % 16).dir;
        let (a, b) = (Vec3::<F>::load(&self.dir, 0), Vec3::splat([first.x, first.y, first.z]));
        // Squared: a root and a division take longer than all else here.
        let (cosine, limit) = (a.dot(b), F::splat(least * least * first.dot(first)));
        let within = F::splat(0.0).lt(cosine) & (limit * a.dot(a)).le(cosine * cosine);
        within.bitmask() as u16 & self.valid == self.valid
    }
}

#[inline(always)]
fn ranges<F: Float>(v: &[Block<f32>; 3], mask: u16) -> [[f32; 2]; 3] {
    [range::<F>(&v[0], mask), range::<F>(&v[1], mask), range::<F>(&v[2], mask)]
}

/// Smallest and largest of some lanes.
#[inline(always)]
fn range<F: Float>(v: &Block<f32>, mask: u16) -> [f32; 2] {
    const { assert!(F::LANES == 16, "a lane for each ray") }
    let (on, x) = (F::Mask::from_bitmask(u32::from(mask)), F::load_block(v, 0));
    let low = F::select(on, x, F::splat(f32::INFINITY)).reduce_min();
    let high = F::select(on, x, F::splat(f32::NEG_INFINITY)).reduce_max();
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Ray, slab};
    use simd::{Level, kernel};

    kernel! {
        fn extent_of<S>(rays: &Ready) -> [[f32; 2]; 3] {
            rays.extent::<S::Float16>()
        }
    }

    #[test]
    fn no_box_beyond_the_extent_is_met() {
        let mut state = 1_u32;
        let mut number = |scale: f32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let x = ((state >> 8) as f32 / 8_388_608.0 - 1.0) * scale;
            if state >> 4 & 7 == 0 { 0.0 } else { x }
        };
        let (mut met, mut passed) = (0, 0);
        for round in 0..2000 {
            let scale = [1.0, 1e-6, 1e5, 1e18][round % 4];
            let mut block = RayBlock::NONE;
            for lane in 0..16 {
                let (org, dir) = ([0; 3].map(|_| number(scale)), [0; 3].map(|_| number(1.0)));
                let t_max = if lane == round % 40 { f32::INFINITY } else { number(scale).abs() };
                block.set(lane, &Ray { org, t_min: 0.0, dir, t_max });
            }
            let mut rays = Ready::new::<f32>(&block, scale);
            rays.valid &= u16::MAX >> (round % 16);
            if rays.valid == 0 {
                continue;
            }
            let extent = extent_of(Level::best(), &rays);
            assert!(Level::available().all(|level| extent_of(level, &rays) == extent));
            for lane in (0..16).filter(|lane| rays.valid >> lane & 1 != 0) {
                let ray = rays.ray(lane);
                // Flat boxes about the end: as near to not being met as can be.
                for steps in -3..4 {
                    let end =
                        [(ray.org.x, ray.dir.x), (ray.org.y, ray.dir.y), (ray.org.z, ray.dir.z)].map(|(org, dir)| {
                            let end = org + dir * ray.t_max.min(1e20);
                            end + steps as f32 * f32::EPSILON * end.abs()
                        });
                    let plane = Vec3::<f32>::splat(end);
                    let (from, to) = slab::between(plane - ray.org, plane - ray.org, &ray, ray.t_min, ray.t_max);
                    let touches = (0..3).all(|axis| extent[axis][0] <= end[axis] && end[axis] <= extent[axis][1]);
                    assert!(from > to || touches, "{ray:?} {end:?} {extent:?}");
                    met += u32::from(from <= to);
                }
                let beyond = (0..3).any(|axis| extent[axis][1] < scale * 3.0);
                passed += u32::from(beyond);
            }
        }
        assert!(met > 1000 && passed > 1000, "{met} {passed}");
    }
}
