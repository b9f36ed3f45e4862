//! The frustum around a packet of rays (Garanzha & Loop 2010, section 3.2; Overbeck et al. 2008): an interval along the axis that the rays
//! mostly follow, and a rectangle at either end of it that bounds all rays there. No box that a ray of the packet meets is culled.
//!
//! # Proof
//!
//! Let `u = 2^-24`, `P` the largest coordinate of all planes in magnitude, `S = P + max |origin|`, and `D` the dominant axis. The rays of a frustum are
//! [ordinary](ordinary) and [members](Members): `2^-60 < S, max |dir| < 2^60`, they have one sign on `D`, and no other component of their direction is
//! more than twice that on `D`. What divides by nearly nothing or overflows is left out by that, and what underflows is below `2^-60 u S`.
//!
//! *What the exact test takes.* A ray meets a box by [`slab`](super::slab) if some `t` between `t_min` and its reach is at least every computed near end
//! and at most every computed far end. Each of them is `(plane - origin) / dir` with a relative error of at most `3 u`, or `13 u` with the padding of the
//! far ends. So the point `origin + t dir` lies in the box grown by `g = 13 u S`. (The smallest normal number, where a component is zero, moves it by less than `2^-60 S`.)
//!
//! *What is computed here.* With `K = 2` for the slopes `dir / dir_D`:
//!
//! - the ends of a ray along `D` are off by `9 u S`, as long as they lie near the scene at all;
//! - where a ray comes through the plane of a rectangle: by `u S` for the distance along `D`, twice `2 u` for the slope, the product and the sum: `11 u S`;
//! - the lines from a rectangle to the other are evaluated `g` away from where the ray may be: with slopes of at most 2.4 (rectangles are not closer to
//!   each other than 128 u S) that is `31 u S`;
//! - slope, product, distance and sum of a line, and the widening itself: less than `36 u S`.
//!
//! With `g` for the box on the other axes that is less than `91 u S`. Rectangles and interval are widened by `128 u S`.

use super::{Aabb, Packet, RayBlock, Vec3};
use simd::{Float, Mask};

/// Where all boxes are that frusta are tested against.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Space {
    /// Around all boxes.
    pub(crate) bounds: Aabb,
    /// The largest coordinate in magnitude.
    pub(crate) largest: f32,
}

impl Space {
    pub(crate) fn new(bounds: Aabb) -> Self {
        let largest = bounds.min.iter().chain(&bounds.max).fold(0.0_f32, |most, x| x.abs().max(most));
        Self { bounds, largest }
    }
}

/// The rays of some blocks that a frustum is around.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Members {
    /// The dominant axis: no component of a direction is more than twice that one in magnitude.
    pub(crate) axis: usize,
    /// Whether directions are negative on it.
    pub(crate) negative: bool,
    /// All ordinary rays; otherwise those whose largest component is that of the axis (the first of equal ones), with this sign.
    pub(crate) all: bool,
    /// And of these in each block the rays in these lanes.
    pub(crate) lanes: u16,
}

impl Members {
    /// Lanes of valid rays that belong to the frustum, of a chunk of a block.
    #[inline(always)]
    pub(crate) fn of<F: Float>(&self, ray: &Packet<F>, chunk: usize, largest: f32) -> F::Mask {
        let valid = ordinary(ray, largest) & part_of::<F>(self.lanes, chunk);
        if self.all {
            return valid;
        }
        let (x, y, z) = (ray.dir.x.abs(), ray.dir.y.abs(), ray.dir.z.abs());
        let most = x.max(y).max(z);
        let (is_x, is_y) = (x.eq(most), y.eq(most));
        let (mine, d) = match self.axis {
            0 => (is_x, ray.dir.x),
            1 => (!is_x & is_y, ray.dir.y),
            _ => (!(is_x | is_y), ray.dir.z),
        };
        let negative = d.lt(F::splat(0.0));
        valid & mine & if self.negative { negative } else { !negative }
    }
}

/// The lanes of a chunk.
#[inline(always)]
fn part_of<F: Float>(lanes: u16, chunk: usize) -> F::Mask {
    F::Mask::from_bitmask(u32::from(lanes) >> (chunk * F::LANES) & ((1 << F::LANES) - 1))
}

/// Lanes of valid rays that frusta are for: see the [proof](self). Others are traced one by one.
#[inline(always)]
pub(crate) fn ordinary<F: Float>(ray: &Packet<F>, largest: f32) -> F::Mask {
    let (small, large) = (F::splat(2.0_f32.powi(-60)), F::splat(2.0_f32.powi(60)));
    let longest = ray.dir.x.abs().max(ray.dir.y.abs()).max(ray.dir.z.abs());
    let scale = scale(ray, largest);
    ray.valid & small.lt(longest) & longest.lt(large) & small.lt(scale) & scale.lt(large)
}

/// `S` of the proof.
#[inline(always)]
fn scale<F: Float>(ray: &Packet<F>, largest: f32) -> F {
    F::splat(largest) + ray.org.x.abs().max(ray.org.y.abs()).max(ray.org.z.abs())
}

/// A frustum.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frustum {
    pub(crate) members: Members,
    /// Signs of the average direction, a bit per axis, set for negative.
    pub(crate) signs: u32,
    /// The interval along the dominant axis; empty if `from > to`.
    from: f32,
    to: f32,
    /// Where the first rectangle lies.
    base: f32,
    /// On the next two axes: its lower and upper sides.
    sides: [[f32; 2]; 2],
    /// How much the sides move along the axis: the positive and the negative part, of which one is zero.
    slopes: [[[f32; 2]; 2]; 2],
    /// What it was widened by.
    slack: f32,
}

/// How much rectangles are widened, in units of `S`: `128 u`.
const SLACK: f32 = 64.0 * f32::EPSILON;

impl Frustum {
    /// Around some rays of these blocks, of which there is one at least. Their directions are on the whole negative on the axes that `signs` has a bit for.
    #[inline(always)]
    pub(crate) fn around<F: Float>(blocks: &[RayBlock], members: Members, signs: u32, space: &Space) -> Self {
        let mut extent = Extent::<F>::new();
        for block in blocks {
            for chunk in 0..16 / F::LANES {
                let ray = Packet::<F>::load(block, chunk);
                extent.add(&ray, members.of(&ray, chunk, space.largest), members.axis, space);
            }
        }
        let mut this = Self::between(&extent, members, signs, space);
        if this.from <= this.to {
            let mut rectangles = Rectangles::<F>::new([this.from, this.to]);
            for block in blocks {
                for chunk in 0..16 / F::LANES {
                    let ray = Packet::<F>::load(block, chunk);
                    rectangles.add(&ray, members.of(&ray, chunk, space.largest), members.axis);
                }
            }
            this.join(&rectangles);
        }
        this
    }

    /// Around the rays in the lanes of `on`, members of this frustum.
    #[inline(always)]
    pub(crate) fn part<F: Float>(&self, ray: &Packet<F>, on: F::Mask, space: &Space) -> Self {
        let axis = self.members.axis;
        let mut extent = Extent::<F>::new();
        extent.add(ray, on, axis, space);
        let mut this = Self::between(&extent, self.members, self.signs, space);
        let mut rectangles = Rectangles::<F>::new([this.from, this.to]);
        rectangles.add(ray, on, axis);
        this.join(&rectangles);
        this
    }

    /// The interval of a frustum that has no sides yet.
    #[inline(always)]
    fn between<F: Float>(extent: &Extent<F>, members: Members, signs: u32, space: &Space) -> Self {
        let slack = extent.scale.reduce_max() * SLACK;
        let from = (extent.low.reduce_min() - slack).max(space.bounds.min[members.axis] - slack);
        let mut to = (extent.high.reduce_max() + slack).min(space.bounds.max[members.axis] + slack);
        if from <= to && to - from < 2.0 * slack {
            to = from + 2.0 * slack;
        }
        let (sides, slopes) = ([[0.0; 2]; 2], [[[0.0; 2]; 2]; 2]);
        Self { members, signs, from, to, base: from, sides, slopes, slack }
    }

    /// Sides from one rectangle to the other.
    #[inline(always)]
    fn join<F: Float>(&mut self, rectangles: &Rectangles<F>) {
        let inverse = 1.0 / (self.to - self.from);
        for k in 0..2 {
            for side in 0..2 {
                let [first, last] = [rectangles.side(k, 0, side, self.slack), rectangles.side(k, 1, side, self.slack)];
                let slope = (last - first) * inverse;
                self.sides[k][side] = first;
                self.slopes[k][side] = [slope.max(0.0), slope.min(0.0)];
            }
        }
    }

    /// Leaves out what lies behind the reach of all rays in the lanes of `on`, for which it was made.
    #[inline(always)]
    pub(crate) fn shorten<F: Float>(&mut self, ray: &Packet<F>, on: F::Mask, reach: F) {
        let end = turn(ray.org, self.members.axis)[0] + turn(ray.dir, self.members.axis)[0] * reach;
        let infinity = F::splat(f32::INFINITY);
        if self.members.negative {
            let end = F::select(on, end, infinity).reduce_min() - self.slack;
            self.from = self.from.max(end);
        } else {
            let end = F::select(on, end, -infinity).reduce_max() + self.slack;
            self.to = self.to.min(end);
        }
    }

    /// Which boxes may be met by a ray of the packet.
    #[inline(always)]
    pub(crate) fn meets<F: Float>(&self, low: Vec3<F>, high: Vec3<F>) -> F::Mask {
        let ([low, low_b, low_c], [high, high_b, high_c]) =
            (turn(low, self.members.axis), turn(high, self.members.axis));
        let base = F::splat(self.base);
        let (near, far) = (low.max(F::splat(self.from)), high.min(F::splat(self.to)));
        let (p, q) = (near - base, far - base);
        near.le(far) & self.overlaps(0, [low_b, high_b], [p, q]) & self.overlaps(1, [low_c, high_c], [p, q])
    }

    /// Whether boxes reach into the frustum on one of the two other axes, between two distances from the first rectangle.
    #[inline(always)]
    fn overlaps<F: Float>(&self, k: usize, [low, high]: [F; 2], [p, q]: [F; 2]) -> F::Mask {
        let ([[up, down], [upper_up, upper_down]], [lower, upper]) = (self.slopes[k], self.sides[k]);
        let lowest = F::splat(lower) + (F::splat(up) * p + F::splat(down) * q);
        let highest = F::splat(upper) + (F::splat(upper_up) * q + F::splat(upper_down) * p);
        lowest.le(high) & low.le(highest)
    }
}

/// How far rays reach along an axis, and `S` of the [proof](self).
struct Extent<F: Float> {
    low: F,
    high: F,
    scale: F,
}

impl<F: Float> Extent<F> {
    #[inline(always)]
    fn new() -> Self {
        Self { low: F::splat(f32::INFINITY), high: F::splat(f32::NEG_INFINITY), scale: F::splat(0.0) }
    }

    #[inline(always)]
    fn add(&mut self, ray: &Packet<F>, on: F::Mask, axis: usize, space: &Space) {
        let (org, dir) = (turn(ray.org, axis)[0], turn(ray.dir, axis)[0]);
        let (start, end) = (org + dir * ray.t_min, org + dir * ray.t_max);
        self.low = F::select(on, start.min(end).min(self.low), self.low);
        self.high = F::select(on, start.max(end).max(self.high), self.high);
        self.scale = F::select(on, scale(ray, space.largest).max(self.scale), self.scale);
    }
}

/// Bounds of rays on the two other axes, at two places on an axis.
struct Rectangles<F: Float> {
    places: [f32; 2],
    /// By axis, place and side.
    ranges: [[[F; 2]; 2]; 2],
}

impl<F: Float> Rectangles<F> {
    #[inline(always)]
    fn new(places: [f32; 2]) -> Self {
        let infinity = F::splat(f32::INFINITY);
        Self { places, ranges: [[[infinity, -infinity]; 2]; 2] }
    }

    #[inline(always)]
    fn add(&mut self, ray: &Packet<F>, on: F::Mask, axis: usize) {
        let ([org, org_b, org_c], [dir, dir_b, dir_c]) = (turn(ray.org, axis), turn(ray.dir, axis));
        let inv = F::splat(1.0) / dir;
        let (orgs, slopes) = ([org_b, org_c], [dir_b * inv, dir_c * inv]);
        for end in 0..2 {
            let way = F::splat(self.places[end]) - org;
            for k in 0..2 {
                let at = orgs[k] + way * slopes[k];
                let [low, high] = self.ranges[k][end];
                self.ranges[k][end] = [F::select(on, at.min(low), low), F::select(on, at.max(high), high)];
            }
        }
    }

    /// A lower (0) or upper (1) side, moved outwards.
    #[inline(always)]
    fn side(&self, k: usize, end: usize, side: usize, slack: f32) -> f32 {
        if side == 0 {
            self.ranges[k][end][0].reduce_min() - slack
        } else {
            self.ranges[k][end][1].reduce_max() + slack
        }
    }
}

/// The coordinates from an axis on.
#[inline(always)]
fn turn<F: Float>(v: Vec3<F>, axis: usize) -> [F; 3] {
    match axis {
        0 => [v.x, v.y, v.z],
        1 => [v.y, v.z, v.x],
        _ => [v.z, v.x, v.y],
    }
}

/// What the rays of a packet have in common, and the frusta that are needed for them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Survey {
    /// Whether there are ordinary rays.
    pub(crate) any: bool,
    /// Smallest and largest component of their directions.
    low: [f32; 3],
    high: [f32; 3],
    lanes: u16,
}

impl Survey {
    /// Of the ordinary rays in some lanes of these blocks; `odd` is told the valid rays that are not ordinary, by block (from `first` on) and lane.
    #[inline(always)]
    pub(crate) fn new<F: Float>(
        blocks: &[RayBlock],
        lanes: u16,
        space: &Space,
        odd: &mut Vec<(u32, u16)>,
        first: u32,
    ) -> Self {
        let infinity = F::splat(f32::INFINITY);
        let (mut low, mut high) = (Vec3 { x: infinity, y: infinity, z: infinity }, Vec3::splat([f32::NEG_INFINITY; 3]));
        for (i, block) in blocks.iter().enumerate() {
            let mut others_here = 0;
            for chunk in 0..16 / F::LANES {
                let ray = Packet::<F>::load(block, chunk);
                let (here, on) = (part_of::<F>(lanes, chunk), ordinary(&ray, space.largest));
                let (on, others) = (on & here, ray.valid & !on & here);
                low = Vec3::select(on, low.min(ray.dir), low);
                high = Vec3::select(on, high.max(ray.dir), high);
                others_here |= (others.bitmask() as u16) << (chunk * F::LANES);
            }
            if others_here != 0 {
                odd.push((first + i as u32, others_here));
            }
        }
        let low = [low.x.reduce_min(), low.y.reduce_min(), low.z.reduce_min()];
        let high = [high.x.reduce_max(), high.y.reduce_max(), high.z.reduce_max()];
        Self { any: low[0] <= high[0], low, high, lanes }
    }

    /// The axis that the rays follow on the whole, if they all do.
    #[inline(always)]
    fn together<F: Float>(&self, blocks: &[RayBlock], space: &Space) -> Option<Members> {
        let middle = [self.low[0] + self.high[0], self.low[1] + self.high[1], self.low[2] + self.high[2]];
        let largest = |a: usize, b: usize| if middle[a].abs() >= middle[b].abs() { a } else { b };
        let axis = largest(largest(0, 1), 2);
        let negative = middle[axis] < 0.0;
        if self.low[axis] * self.high[axis] <= 0.0 {
            return None;
        }
        // Twice the smallest component on the axis, and the largest on the others.
        let most = |k: usize| self.high[k].max(-self.low[k]);
        let limit = 2.0 * if negative { -self.high[axis] } else { self.low[axis] };
        let mut same = most((axis + 1) % 3) <= limit && most((axis + 2) % 3) <= limit;
        if !same {
            same = slopes_are_small::<F>(blocks, self.lanes, space, axis);
        }
        if same { Some(Members { axis, negative, all: true, lanes: self.lanes }) } else { None }
    }

    /// Appends the frusta around all ordinary rays: one, or if they part one for each of the six directions along an axis.
    #[inline(always)]
    pub(crate) fn frusta<F: Float>(&self, blocks: &[RayBlock], space: &Space, to: &mut Vec<Frustum>) {
        if !self.any {
            return;
        }
        let mut signs = 0;
        for axis in 0..3 {
            signs |= u32::from(self.low[axis] + self.high[axis] < 0.0) << axis;
        }
        if let Some(members) = self.together::<F>(blocks, space) {
            to.push(Frustum::around::<F>(blocks, members, signs, space));
            return;
        }
        for way in 0..6 {
            let members = Members { axis: way / 2, negative: way % 2 != 0, all: false, lanes: self.lanes };
            let mut any = false;
            for block in blocks {
                for chunk in 0..16 / F::LANES {
                    any |= members.of(&Packet::<F>::load(block, chunk), chunk, space.largest).any();
                }
            }
            if any {
                let signs = signs & !(1 << members.axis) | u32::from(members.negative) << members.axis;
                to.push(Frustum::around::<F>(blocks, members, signs, space));
            }
        }
    }
}

/// Whether no component of an ordinary ray is more than twice that on the axis.
#[inline(always)]
fn slopes_are_small<F: Float>(blocks: &[RayBlock], lanes: u16, space: &Space, axis: usize) -> bool {
    let mut outside = false;
    for block in blocks {
        for chunk in 0..16 / F::LANES {
            let ray = Packet::<F>::load(block, chunk);
            let on = ordinary(&ray, space.largest) & part_of::<F>(lanes, chunk);
            let [a, b, c] = turn(ray.dir, axis);
            let limit = a.abs() + a.abs();
            outside |= (on & (limit.lt(b.abs()) | limit.lt(c.abs()))).any();
        }
    }
    !outside
}

#[cfg(test)]
mod tests;
