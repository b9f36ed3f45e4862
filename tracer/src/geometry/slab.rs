//! The slab test (Kay & Kajiya 1986; Geimer & Müller 2003, section 3.3), with hits exact by construction.
//!
//! `(plane - origin) * inv` is monotone in the plane, rounding included. So the interval computed for a box lies inside the
//! interval computed for any box around it, and no box on the way to a triangle can reject a hit that lies in the interval of
//! the triangle's own box.

use super::{Packet, Vec3};
use simd::Float;

/// Which of a box's planes is the near one on each axis, for rays whose directions have the same signs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Near(pub(crate) [usize; 3]);

impl Near {
    /// From the direction of one lane: a bit per axis, set for negative.
    #[inline(always)]
    pub(crate) fn of_octant(octant: usize) -> Self {
        Self([(octant & 1) << 2, 1 | (octant >> 1 & 1) << 2, 2 | (octant >> 2 & 1) << 2])
    }

    /// Near and far plane of an axis, from `min x y z _ max x y z _`.
    #[inline(always)]
    fn planes<F: Float>(self, planes: &[f32; 8], axis: usize) -> (F, F) {
        let near = self.0[axis];
        (F::splat(planes[near & 7]), F::splat(planes[(near ^ 4) & 7]))
    }
}

/// The interval of each ray in a box, `t_near` and padded `t_far`; empty (`t_near > t_far`) when it is missed.
/// `from` and `to` cut it further.
#[inline(always)]
pub(crate) fn interval<F: Float>(planes: &[f32; 8], ray: &Packet<F>, near: Near, from: F, to: F) -> (F, F) {
    let Vec3 { x: ox, y: oy, z: oz } = ray.org;
    let (nx, fx) = near.planes::<F>(planes, 0);
    let (ny, fy) = near.planes::<F>(planes, 1);
    let (nz, fz) = near.planes::<F>(planes, 2);
    let t_near = ((nx - ox) * ray.inv_dir.x).max((ny - oy) * ray.inv_dir.y).max(((nz - oz) * ray.inv_dir.z).max(from));
    let t_far =
        ((fx - ox) * ray.inv_dir_far.x).min((fy - oy) * ray.inv_dir_far.y).min(((fz - oz) * ray.inv_dir_far.z).min(to));
    (t_near, t_far)
}
