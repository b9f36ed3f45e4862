//! Tests of a whole packet at once, by interval arithmetic (Boulos, Wald and Benthin 2008, sections 4.1 and 4.4).
//!
//! A ray is `p + s d` for `s` from 0 to its length, where `p` is its origin or where it enters the box that it has come to. What is computed here is off by
//! a few roundings of the largest coordinates, of which a box test's growth ([`Cull`](crate::geometry::cull::Cull)) is sixteen: a box that is four times
//! as much larger holds whatever a ray's own test may find; where the rays are within the box itself, their own tests find it too.

use super::rays::{Planes, Sixteen};
use crate::geometry::Vec3;
use simd::Float;

/// Bounds of the rays of a packet, as they were when it was put together: of what was hit since they know nothing.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    /// Smallest and largest start, on each axis.
    start: [[f32; 2]; 3],
    dir: [[f32; 2]; 3],
    /// Of the reciprocals of the directions.
    inv: [[f32; 2]; 3],
    /// Largest lower end, smallest and largest upper end of the rays' intervals.
    from: f32,
    shortest: f32,
    longest: f32,
}

/// Smallest and largest of many vectors.
struct Range<F: Float>(F, F);

impl<F: Float> Range<F> {
    #[inline(always)]
    fn new() -> Self {
        Self(F::splat(f32::INFINITY), F::splat(f32::NEG_INFINITY))
    }

    #[inline(always)]
    fn add(&mut self, on: F::Mask, x: F) {
        self.0 = F::select(on, x.min(self.0), self.0);
        self.1 = F::select(on, x.max(self.1), self.1);
    }

    #[inline(always)]
    fn ends(&self) -> [f32; 2] {
        [self.0.reduce_min(), self.1.reduce_max()]
    }
}

struct Ranges<F: Float>(Range<F>, Range<F>, Range<F>);

impl<F: Float> Ranges<F> {
    #[inline(always)]
    fn new() -> Self {
        Self(Range::new(), Range::new(), Range::new())
    }

    #[inline(always)]
    fn add(&mut self, on: F::Mask, v: Vec3<F>) {
        self.0.add(on, v.x);
        self.1.add(on, v.y);
        self.2.add(on, v.z);
    }

    #[inline(always)]
    fn ends(&self) -> [[f32; 2]; 3] {
        [self.0.ends(), self.1.ends(), self.2.ends()]
    }
}

impl Bounds {
    /// [`Bounds::of`] rays that are many, if their directions tell anything: on one axis at least all have the same sign.
    #[inline(always)]
    pub(super) fn of_many<F: Float>(rays: &[Sixteen], into: Option<&Planes<F>>, are_many: bool) -> Option<Self> {
        if !are_many {
            return None;
        }
        let bounds = Self::of(rays, into);
        if bounds.sign(0).is_some() || bounds.sign(1).is_some() || bounds.sign(2).is_some() {
            Some(bounds)
        } else {
            None
        }
    }

    /// Of the rays that can still hit something; in the box that they have come to, if it is given: moved to where they enter it and cut where they
    /// leave it.
    #[inline(always)]
    fn of<F: Float>(rays: &[Sixteen], into: Option<&Planes<F>>) -> Self {
        let (mut start, mut dir, mut inv) = (Ranges::<F>::new(), Ranges::<F>::new(), Ranges::<F>::new());
        let (mut from, mut length) = (Range::<F>::new(), Range::<F>::new());
        let zero = F::splat(0.0);
        for sixteen in rays {
            for chunk in 0..16 / F::LANES {
                let (t_min, reach) = (F::load_block(&sixteen.t_min, chunk), F::load_block(&sixteen.reach, chunk));
                let mut on = t_min.le(reach);
                let d = sixteen.dir::<F>(chunk);
                let mut org = sixteen.org::<F>(chunk);
                if let Some(planes) = into {
                    let (t_near, t_far) = sixteen.interval(chunk, planes);
                    on &= t_near.le(t_far);
                    org = org + d.scale(t_near);
                    from.add(on, zero);
                    // The difference of two numbers that were rounded before.
                    let (most, least) = (t_far * F::splat(16.0 * f32::EPSILON), t_far - t_near);
                    length.0 = F::select(on, (least - most).min(length.0), length.0);
                    length.1 = F::select(on, (least + most).max(length.1), length.1);
                } else {
                    from.add(on, t_min);
                    length.add(on, reach);
                }
                start.add(on, org);
                dir.add(on, d);
                inv.add(on, sixteen.inv::<F>(chunk));
            }
        }
        let [shortest, longest] = length.ends();
        Self { start: start.ends(), dir: dir.ends(), inv: inv.ends(), from: from.ends()[1], shortest, longest }
    }

    /// Whether all directions are negative on an axis, if they have the same sign there.
    #[inline(always)]
    fn sign(&self, axis: usize) -> Option<bool> {
        let [low, high] = self.inv[axis];
        if low > 0.0 {
            Some(false)
        } else if high < 0.0 {
            Some(true)
        } else {
            None
        }
    }

    /// Whether every ray is inside of the box at one and the same length, before which it enters it.
    #[inline(always)]
    pub(super) fn all_hit(&self, planes: &[f32; 8]) -> bool {
        let mut at = self.from;
        for axis in 0..3 {
            let Some(is_negative) = self.sign(axis) else { continue };
            let ([low, high], [least, most]) = (self.start[axis], self.inv[axis]);
            // The way to the near plane from the start that is farthest from it, and none if that is behind it.
            let (way, slope) = if is_negative { (planes[4 + axis] - high, least) } else { (planes[axis] - low, most) };
            let way = if is_negative { way.min(0.0) } else { way.max(0.0) };
            at = at.max(way * slope);
        }
        if !(at <= self.shortest && at < f32::INFINITY) {
            return false;
        }
        let mut inside = true;
        for axis in 0..3 {
            let ([low, high], [least, most]) = (self.start[axis], self.dir[axis]);
            inside &= planes[axis] <= low + at * least && high + at * most <= planes[4 + axis];
        }
        inside
    }

    /// Whether no ray meets the box, whatever the roundings of its own test.
    #[inline(always)]
    pub(super) fn all_miss(&self, planes: &[f32; 8], growth: f32) -> bool {
        let growth = 4.0 * growth;
        let (mut enter, mut leave) = (0.0_f32, self.longest);
        for axis in 0..3 {
            let Some(is_negative) = self.sign(axis) else { continue };
            let ([low, high], [least, most]) = (self.start[axis], self.inv[axis]);
            let (below, above) = (planes[axis] - growth, planes[4 + axis] + growth);
            // From the start that is nearest to the near plane, to the far plane from the one that is farthest from it.
            let (near, far) = if is_negative { (above - low, below - high) } else { (below - high, above - low) };
            let (a, b) = (near * least, near * most);
            enter = enter.max(if a < b { a } else { b });
            let (a, b) = (far * least, far * most);
            leave = leave.min(if a > b { a } else { b });
        }
        enter > leave
    }
}
