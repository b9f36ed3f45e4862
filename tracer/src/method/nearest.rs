//! The point of a surface nearest to a point, through a wide tree, nearest box first.

use super::search::{Goal, search, stack_for};
use crate::bvh::{WideBvh, WideNode};
use crate::geometry::nearest::{on_triangle, to_box};
use crate::geometry::{Hit, Nearest, TriangleGroup, Vec3};
use crate::parallel::portions;
use simd::{Kernel, Level, Mask, Simd, Vector};

/// A point of the surface that is refused, for the point with a number, does not count, nor does the rest of its triangle.
pub(crate) type Accept<'a> = dyn Fn(usize, &Nearest) -> bool + Sync + 'a;

/// Points that a thread takes at once.
const POINTS: usize = 1024;

/// The nearest points of many, on the threads of the current rayon pool.
pub(crate) fn batch(
    bvh: &WideBvh<8>,
    level: Level,
    points: &[[f32; 3]],
    max_distance: f32,
    nearest: &mut [Option<Nearest>],
    accept: &Accept,
) {
    let portion = |first, points: &[[f32; 3]], nearest: &mut [Option<Nearest>]| {
        level.run(Find { bvh, points, first, max_distance, nearest, accept: &accept });
        Ok(())
    };
    // Nothing cancels it.
    let _ = portions(POINTS, points, nearest, portion, || (), |(), ()| ());
}

/// The nearest point of one.
pub(crate) fn one(
    bvh: &WideBvh<8>,
    level: Level,
    point: [f32; 3],
    max_distance: f32,
    accept: &dyn Fn(&Nearest) -> bool,
) -> Option<Nearest> {
    let mut nearest = [None];
    let accept = |_, found: &Nearest| accept(found);
    level.run(Find { bvh, points: &[point], first: 0, max_distance, nearest: &mut nearest, accept: &accept });
    nearest[0]
}

struct Find<'a> {
    bvh: &'a WideBvh<8>,
    points: &'a [[f32; 3]],
    first: usize,
    max_distance: f32,
    nearest: &'a mut [Option<Nearest>],
    accept: &'a dyn Fn(usize, &Nearest) -> bool,
}

impl Kernel for Find<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self) {
        let mut stack = stack_for(self.bvh);
        for (i, (&point, nearest)) in self.points.iter().zip(self.nearest).enumerate() {
            *nearest = None;
            let [x, y, z] = point;
            if !(x.is_finite() && y.is_finite() && z.is_finite()) {
                continue;
            }
            let accept = |found: &Nearest| (self.accept)(self.first + i, found);
            let mut goal = NearestPoint::<S> {
                to_boxes: Vec3::splat(point),
                to_triangles: Vec3::splat(point),
                reach: self.max_distance,
                primitive: Hit::NO_PRIMITIVE,
                best: None,
                accept: &accept,
            };
            search(self.bvh, &mut goal, &mut stack);
            *nearest = goal.best;
        }
    }
}

struct NearestPoint<'a, S: Simd> {
    /// The point, for as many boxes and triangles as are looked at at once.
    to_boxes: Vec3<S::Float8>,
    to_triangles: Vec3<S::Float4>,
    /// How far away a point matters.
    reach: f32,
    /// Of the nearest so far.
    primitive: u32,
    best: Option<Nearest>,
    accept: &'a dyn Fn(&Nearest) -> bool,
}

impl<S: Simd> Goal<S> for NearestPoint<'_, S> {
    #[inline(always)]
    fn children(&self, node: &WideNode<8>) -> (S::Float8, u32) {
        let p = &node.planes;
        let low = Vec3 { x: S::Float8::load(&p[0]), y: S::Float8::load(&p[1]), z: S::Float8::load(&p[2]) };
        let high = Vec3 { x: S::Float8::load(&p[3]), y: S::Float8::load(&p[4]), z: S::Float8::load(&p[5]) };
        let distance = to_box(self.to_boxes, low, high);
        // Where there is no child, the box is inside out.
        let mask = distance.le(S::Float8::splat(self.reach)) & low.x.le(high.x);
        (distance, mask.bitmask())
    }

    #[inline(always)]
    fn group(&mut self, group: &TriangleGroup<{ WideBvh::<8>::GROUP }>, _: &mut Vec<u64>) {
        let foot = on_triangle(self.to_triangles, group.corner_and_edges::<S::Float4>());
        let mut bits = foot.distance.le(S::Float4::splat(self.reach)).bitmask();
        if bits == 0 {
            return;
        }
        let (distance, u, v) = (foot.distance.to_block(), foot.u.to_block(), foot.v.to_block());
        let (x, y, z) = (foot.point.x.to_block(), foot.point.y.to_block(), foot.point.z.to_block());
        while bits != 0 {
            let i = bits.trailing_zeros() as usize % group.id.len();
            bits &= bits - 1;
            let primitive = group.id[i];
            let distance = distance.0[i];
            let is_nearer = distance < self.reach || (distance == self.reach && primitive < self.primitive);
            if primitive == Hit::NO_PRIMITIVE || !is_nearer {
                continue;
            }
            let found = Nearest { distance, point: [x.0[i], y.0[i], z.0[i]], primitive, u: u.0[i], v: v.0[i] };
            if (self.accept)(&found) {
                self.best = Some(found);
                (self.reach, self.primitive) = (distance, primitive);
            }
        }
    }

    #[inline(always)]
    fn reach(&self) -> f32 {
        self.reach
    }
}
