//! A cheaper box test, for boxes on the way to triangles alone: one multiply-add for a plane. It may take a box that the exact test
//! ([`slab`](super::slab)) would not, never the other way round, so that it changes no hit.
//!
//! With `u = 2^-24`, the largest coordinate `P` of all planes and `S = P + max |origin|`, boxes grow by `d = 16 u S` on all sides: the near
//! end is `plane * inv + (-origin * inv - d |inv|)`, the far end `plane * inv + (-origin * inv + d |inv|)`. That widens the interval by
//! `16 u S |inv|` at both ends. What has to be covered, in units of `u S |inv|`: 3 for the roundings of the exact `(plane - origin) * inv`
//! and 4 for its padding; here 1 for the product (where it is not fused), 1 for the sum, 2 for the constant. That is 11.
//!
//! A direction nearly parallel to an axis would overflow: `|inv|` is cut to `2^24` times the smallest on the three axes, `m`. Where the exact
//! near end is above zero, the cut one is below it as the slope is smaller; elsewhere both are at most `t_min`. At the far end the
//! growth alone is then `10 u S 2^24 m = 10 S m` or more, and no box ends behind `S m` on the axis of `m`.
//!
//! This needs `S m` to be a number of ordinary size: other rays are told apart, and use the exact test.

use super::slab;
use super::{Packet, Vec3};
use simd::{Block, Float};

/// A way to test rays against boxes, whose near and far planes it is told.
pub(crate) trait Boxes<F: Float>: Copy {
    /// The interval in a box, cut by `from` and `to`; empty if `t_near > t_far`.
    fn interval(&self, near: Vec3<F>, far: Vec3<F>, from: F, to: F) -> (F, F);
}

/// The exact test.
impl<F: Float> Boxes<F> for Packet<F> {
    #[inline(always)]
    fn interval(&self, near: Vec3<F>, far: Vec3<F>, from: F, to: F) -> (F, F) {
        slab::between(near - self.org, far - self.org, self, from, to)
    }
}

/// What the cheap test needs of a ray.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cull<F: Float> {
    pub(crate) inv_dir: Vec3<F>,
    /// What is added for near and for far planes.
    near: Vec3<F>,
    far: Vec3<F>,
}

impl<F: Float> Cull<F> {
    /// For rays among planes of which none is farther from zero than `largest`; and the lanes for which it holds.
    #[inline(always)]
    pub(crate) fn new(ray: &Packet<F>, largest: f32) -> (Self, F::Mask) {
        let scale = F::splat(largest) + ray.org.x.abs().max(ray.org.y.abs()).max(ray.org.z.abs());
        let slopes = Vec3 { x: ray.inv_dir.x.abs(), y: ray.inv_dir.y.abs(), z: ray.inv_dir.z.abs() };
        let slope = slopes.x.min(slopes.y).min(slopes.z);
        let limit = slope * F::splat(16_777_216.0);
        let slopes = Vec3 { x: slopes.x.min(limit), y: slopes.y.min(limit), z: slopes.z.min(limit) };
        let inv_dir = Vec3 {
            x: slopes.x.copysign(ray.inv_dir.x),
            y: slopes.y.copysign(ray.inv_dir.y),
            z: slopes.z.copysign(ray.inv_dir.z),
        };
        let (origin, growth) = (ray.org * inv_dir, slopes.scale(scale * F::splat(8.0 * f32::EPSILON)));
        let minus = Vec3 { x: -origin.x, y: -origin.y, z: -origin.z };
        let (small, large) = (F::splat(2.0_f32.powi(-80)), F::splat(2.0_f32.powi(100)));
        let reach = scale * slope;
        (
            Self { inv_dir, near: minus - growth, far: growth - origin },
            small.lt(scale) & small.lt(reach) & reach.lt(large),
        )
    }

    /// What boxes grow by for a ray: more will do as well.
    #[inline(always)]
    pub(crate) fn growth(ray: &Packet<F>, largest: f32) -> F {
        let scale = F::splat(largest) + ray.org.x.abs().max(ray.org.y.abs()).max(ray.org.z.abs());
        scale * F::splat(8.0 * f32::EPSILON)
    }

    /// What is added to `plane * inv_dir` for planes that were moved by [`Cull::growth`]: that takes one of the roundings that the growth has left.
    #[inline(always)]
    pub(crate) fn offset(&self, ray: &Packet<F>) -> Vec3<F> {
        let origin = ray.org * self.inv_dir;
        Vec3 { x: -origin.x, y: -origin.y, z: -origin.z }
    }

    #[inline(always)]
    pub(crate) fn store(&self, to: &mut [[Block<f32>; 3]; 3], chunk: usize) {
        self.inv_dir.store(&mut to[0], chunk);
        self.near.store(&mut to[1], chunk);
        self.far.store(&mut to[2], chunk);
    }

    #[inline(always)]
    pub(crate) fn load([inv_dir, near, far]: &[[Block<f32>; 3]; 3], chunk: usize) -> Self {
        Self { inv_dir: Vec3::load(inv_dir, chunk), near: Vec3::load(near, chunk), far: Vec3::load(far, chunk) }
    }

    /// The ray of one lane in every lane.
    #[inline(always)]
    pub(crate) fn splat([inv_dir, near, far]: &[[Block<f32>; 3]; 3], lane: usize) -> Self {
        Self { inv_dir: splat(inv_dir, lane), near: splat(near, lane), far: splat(far, lane) }
    }

    /// For rays that point anywhere.
    #[inline(always)]
    pub(crate) fn mixed(self) -> Mixed<F> {
        let zero = F::splat(0.0);
        let signs = [self.inv_dir.x.lt(zero), self.inv_dir.y.lt(zero), self.inv_dir.z.lt(zero)];
        Mixed {
            inv_dir: self.inv_dir,
            low: slab::choose(signs, self.far, self.near),
            high: slab::choose(signs, self.near, self.far),
        }
    }
}

impl<F: Float> Boxes<F> for Cull<F> {
    #[inline(always)]
    fn interval(&self, near: Vec3<F>, far: Vec3<F>, from: F, to: F) -> (F, F) {
        cut(at(near, self.inv_dir, self.near), at(far, self.inv_dir, self.far), from, to)
    }
}

/// [`Cull`] for rays that point anywhere: what is added for lower and for upper planes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Mixed<F: Float> {
    inv_dir: Vec3<F>,
    low: Vec3<F>,
    high: Vec3<F>,
}

impl<F: Float> Mixed<F> {
    /// As [`Boxes::interval`], of lower and upper planes. Not for the box that nothing meets.
    #[inline(always)]
    pub(crate) fn interval(&self, low: Vec3<F>, high: Vec3<F>, from: F, to: F) -> (F, F) {
        let (a, b) = (at(low, self.inv_dir, self.low), at(high, self.inv_dir, self.high));
        cut(a.min(b), a.max(b), from, to)
    }
}

#[inline(always)]
fn splat<F: Float>(v: &[Block<f32>; 3], lane: usize) -> Vec3<F> {
    Vec3::splat([v[0].0[lane], v[1].0[lane], v[2].0[lane]])
}

#[inline(always)]
fn at<F: Float>(plane: Vec3<F>, inv_dir: Vec3<F>, add: Vec3<F>) -> Vec3<F> {
    Vec3 {
        x: plane.x.mul_add(inv_dir.x, add.x),
        y: plane.y.mul_add(inv_dir.y, add.y),
        z: plane.z.mul_add(inv_dir.z, add.z),
    }
}

#[inline(always)]
fn cut<F: Float>(near: Vec3<F>, far: Vec3<F>, from: F, to: F) -> (F, F) {
    (near.x.max(near.y).max(near.z.max(from)), far.x.min(far.y).min(far.z.min(to)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Ray, RayBlock};

    /// Numbers from -1 to 1; zero, one of a few sizes, and now and then one that was there before.
    struct Numbers {
        state: u32,
        last: f32,
    }

    impl Numbers {
        fn bits(&mut self) -> u32 {
            self.state = self.state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            self.state >> 8
        }

        fn next(&mut self, scale: f32) -> f32 {
            let x = (self.bits() as f32 / 8_388_608.0 - 1.0) * scale;
            let x = match self.bits() % 8 {
                0 => 0.0,
                1 => x * 1e-6,
                2 => x * 1e-20,
                3 => self.last,
                _ => x,
            };
            self.last = x;
            x
        }
    }

    #[test]
    fn what_the_exact_test_takes_is_taken() {
        let mut numbers = Numbers { state: 1, last: 0.0 };
        let (mut met, mut odd) = (0, 0);
        for case in 0..400_000 {
            let scale = [1.0, 1e3, 1e-8, 1e12][case % 4];
            let mut three = |scale: f32| [numbers.next(scale), numbers.next(scale), numbers.next(scale)];
            let (a, b, org, dir) = (three(scale), three(scale), three(2.0 * scale), three(1.0));
            let mut block = RayBlock::NONE;
            block.set(0, &Ray::new(org, dir));
            let ray = Packet::<f32>::load(&block, 0);
            let largest = a.iter().chain(&b).fold(0.0_f32, |m, x| m.max(x.abs()));
            let (cull, ordinary) = Cull::new(&ray, largest);
            if !ray.valid {
                continue;
            }
            if !ordinary {
                odd += 1;
                continue;
            }
            let pick = |axis: usize, low: bool| if (a[axis] < b[axis]) == low { a[axis] } else { b[axis] };
            let corner = |low| Vec3::<f32>::splat([pick(0, low), pick(1, low), pick(2, low)]);
            let (low, high) = (corner(true), corner(false));
            let signs = ray.signs();
            let (near, far) = (slab::choose::<f32>(signs, high, low), slab::choose::<f32>(signs, low, high));
            let exact = Boxes::interval(&ray, near, far, 0.0, f32::INFINITY);
            if exact.0 > exact.1 {
                continue;
            }
            met += 1;
            for cheap in
                [cull.interval(near, far, 0.0, f32::INFINITY), cull.mixed().interval(low, high, 0.0, f32::INFINITY)]
            {
                assert!(
                    cheap.0 <= exact.0 && cheap.1 >= exact.1,
                    "{cheap:?} does not hold {exact:?}: {a:?} {b:?} {org:?} {dir:?}"
                );
            }
        }
        assert!(met > 10_000 && odd < 40_000, "{met} boxes were met, {odd} rays were odd");
    }
}
