//! The slab test (Kay & Kajiya 1986; Geimer & Müller 2003, section 3.3), with hits exact by construction.
//!
//! `(plane - origin) * inv` is monotone in the plane, rounding included. So the interval computed for a box lies inside the
//! interval computed for any box around it, and no box on the way to a triangle can reject a hit that lies in the interval of
//! the triangle's own box.

use super::{Packet, Vec3};
use simd::Float;

/// Which of a box's planes is the near one on each axis, for rays whose directions have the same signs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Near([usize; 3]);

impl Near {
    /// From the direction of one lane: a bit per axis, set for negative.
    #[inline(always)]
    pub(crate) fn of_octant(octant: usize) -> Self {
        Self([(octant & 1) << 2, 1 | (octant >> 1 & 1) << 2, 2 | (octant >> 2 & 1) << 2])
    }

    /// Whether the upper plane of an axis is the near one.
    #[inline(always)]
    pub(crate) fn is_upper(self, axis: usize) -> bool {
        self.0[axis] & 4 != 0
    }

    /// Per axis 3 where the upper plane is the near one, else 0: what separates lower and upper planes in a wide node.
    #[inline(always)]
    pub(crate) fn upper(self) -> [usize; 3] {
        // Not `map`: it is not always inlined.
        let upper = |axis| 3 * usize::from(self.is_upper(axis));
        [upper(0), upper(1), upper(2)]
    }

    /// Per axis `a` where directions are positive, else `b`.
    #[inline(always)]
    pub(crate) fn choose<F: Float>(self, a: Vec3<F>, b: Vec3<F>) -> Vec3<F> {
        Vec3 {
            x: if self.is_upper(0) { b.x } else { a.x },
            y: if self.is_upper(1) { b.y } else { a.y },
            z: if self.is_upper(2) { b.z } else { a.z },
        }
    }

    /// Near and far plane of an axis, from `min x y z _ max x y z _`.
    #[inline(always)]
    fn planes(self, planes: &[f32; 8], axis: usize) -> (f32, f32) {
        let near = self.0[axis];
        (planes[near & 7], planes[(near ^ 4) & 7])
    }
}

/// Where the rays of a packet start: what can be computed once for all of them when they share it (Geimer & Müller 2003,
/// section 3.3). Both ways compute the same bits.
pub(crate) trait Origin<F: Float>: Copy {
    /// `plane - origin` on an axis.
    fn to_plane(self, ray: &Packet<F>, plane: f32, axis: usize) -> F;

    /// The origin, seen from a vertex.
    fn seen_from(self, ray: &Packet<F>, vertex: [f32; 3]) -> Vec3<F>;
}

/// Each ray has its own origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PerRay;

impl<F: Float> Origin<F> for PerRay {
    #[inline(always)]
    fn to_plane(self, ray: &Packet<F>, plane: f32, axis: usize) -> F {
        F::splat(plane)
            - match axis {
                0 => ray.org.x,
                1 => ray.org.y,
                _ => ray.org.z,
            }
    }

    #[inline(always)]
    fn seen_from(self, ray: &Packet<F>, vertex: [f32; 3]) -> Vec3<F> {
        ray.org - Vec3::splat(vertex)
    }
}

/// All rays start at one point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shared(pub(crate) [f32; 3]);

impl<F: Float> Origin<F> for Shared {
    #[inline(always)]
    fn to_plane(self, _ray: &Packet<F>, plane: f32, axis: usize) -> F {
        F::splat(plane - self.0[axis])
    }

    #[inline(always)]
    fn seen_from(self, _ray: &Packet<F>, [x, y, z]: [f32; 3]) -> Vec3<F> {
        Vec3::splat([self.0[0] - x, self.0[1] - y, self.0[2] - z])
    }
}

/// The interval of each ray in a box, `t_near` and padded `t_far`; empty (`t_near > t_far`) when it is missed.
/// `from` and `to` cut it further.
#[inline(always)]
pub(crate) fn interval<F: Float, O: Origin<F>>(
    planes: &[f32; 8],
    ray: &Packet<F>,
    origin: O,
    near: Near,
    from: F,
    to: F,
) -> (F, F) {
    let (near_x, far_x) = near.planes(planes, 0);
    let (near_y, far_y) = near.planes(planes, 1);
    let (near_z, far_z) = near.planes(planes, 2);
    let to_near = Vec3 {
        x: origin.to_plane(ray, near_x, 0),
        y: origin.to_plane(ray, near_y, 1),
        z: origin.to_plane(ray, near_z, 2),
    };
    let to_far = Vec3 {
        x: origin.to_plane(ray, far_x, 0),
        y: origin.to_plane(ray, far_y, 1),
        z: origin.to_plane(ray, far_z, 2),
    };
    between(to_near, to_far, ray, from, to)
}

/// [`interval`] from what lies between origin and planes.
#[inline(always)]
pub(crate) fn between<F: Float>(to_near: Vec3<F>, to_far: Vec3<F>, ray: &Packet<F>, from: F, to: F) -> (F, F) {
    let (near, far) = (to_near * ray.inv_dir, to_far * ray.inv_dir_far);
    let t_near = near.x.max(near.y).max(near.z.max(from));
    let t_far = far.x.min(far.y).min(far.z.min(to));
    (t_near, t_far)
}

/// [`interval`] in box `i` of a wide node, for rays that point into different octants: `signs` are those of the packet.
#[inline(always)]
pub(crate) fn mixed<F: Float, const N: usize>(
    planes: &[[f32; N]; 6],
    i: usize,
    ray: &Packet<F>,
    signs: [F::Mask; 3],
    from: F,
    to: F,
) -> (F, F) {
    let low = Vec3::splat([planes[0][i], planes[1][i], planes[2][i]]);
    let high = Vec3::splat([planes[3][i], planes[4][i], planes[5][i]]);
    let (near, far) = (choose(signs, high, low), choose(signs, low, high));
    between(near - ray.org, far - ray.org, ray, from, to)
}

/// Per axis and lane `a` where the mask is on, else `b`.
#[inline(always)]
pub(crate) fn choose<F: Float>([x, y, z]: [F::Mask; 3], a: Vec3<F>, b: Vec3<F>) -> Vec3<F> {
    Vec3 { x: F::select(x, a.x, b.x), y: F::select(y, a.y, b.y), z: F::select(z, a.z, b.z) }
}
