//! Surfaces of the user's own.

use crate::Error;
use crate::bvh::WideBvh;
use crate::geometry::{Aabb, Hit, Packet, Ray};
use std::fmt;
use std::sync::Arc;

/// A set of surfaces of one's own, each in a box: spheres, curves, patches. Part of a [`World`](super::World) by
/// [`WorldBuilder::primitives`](super::WorldBuilder::primitives), in whose documentation there is an example.
pub trait Primitives: Send + Sync {
    /// How many there are, from 0 on; the same whenever it is asked.
    fn count(&self) -> usize;

    /// The box around number `i`.
    fn bounds(&self, i: usize) -> Aabb;

    /// The first hit of number `i` from `ray.t_min` to `ray.t_max`, both included.
    ///
    /// The answer must depend on nothing but `i` and the ray, whose direction need not have length 1. Of the hit `t`, `u` and `v` are
    /// used. A hit counts if the ray meets the box; where `t` is before the ray enters the box or behind where it leaves, by rounding or
    /// because the box is too small, it is moved there. That makes hits independent of the order in which boxes are visited. A box a little larger than needed leaves `t` as it is.
    fn closest(&self, i: usize, ray: &Ray) -> Option<Hit>;

    /// Whether number `i` is hit from `ray.t_min` to `ray.t_max`: must be what [`Primitives::closest`] says, but may be faster.
    fn occluded(&self, i: usize, ray: &Ray) -> bool {
        self.closest(i, ray).is_some()
    }
}

/// A tree over primitives.
#[derive(Clone)]
pub(super) struct Items {
    primitives: Arc<dyn Primitives>,
    pub(super) tree: Arc<WideBvh<8>>,
    boxes: Arc<[Aabb]>,
    pub(super) bounds: Aabb,
}

impl Items {
    /// # Errors
    /// [`Error::Geometry`] with the primitive at fault.
    pub(super) fn new(primitives: Arc<dyn Primitives>) -> Result<Self, Error> {
        let boxes: Arc<[Aabb]> = (0..primitives.count()).map(|i| primitives.bounds(i)).collect();
        for (i, Aabb { min, max }) in boxes.iter().enumerate() {
            if !(0..3).all(|k| min[k].is_finite() && max[k].is_finite() && min[k] <= max[k]) {
                return Err(Error::Geometry(format!(
                    "primitive {i} has the box from {min:?} to {max:?}: both must be finite, and the first not above the second"
                )));
            }
        }
        let bounds = boxes.iter().fold(Aabb::EMPTY, |all, b| all.union(b));
        Ok(Self { primitives, tree: Arc::new(WideBvh::of_boxes(&boxes)?), boxes, bounds })
    }

    #[cfg(test)]
    pub(super) fn len(&self) -> usize {
        self.boxes.len()
    }

    /// Whether these are of the same primitives.
    pub(super) fn are_of(&self, primitives: &Arc<dyn Primitives>) -> bool {
        Arc::as_ptr(&self.primitives).cast::<()>() == Arc::as_ptr(primitives).cast::<()>()
    }

    /// The hit of primitive `i`, as [`Primitives::closest`] says that it counts. `packet` is the ray again.
    #[inline(always)]
    pub(super) fn closest(&self, i: u32, ray: &Ray, packet: &Packet<f32>) -> Option<Hit> {
        let (near, far) = interval(self.boxes.get(i as usize)?, packet);
        let meets = near.max(packet.t_min) <= far.min(packet.t_max);
        if !meets {
            return None;
        }
        let hit = self.primitives.closest(i as usize, ray)?;
        // Written so that NaN is no hit. Adding 0 turns -0 into 0.
        let counts = packet.t_min <= hit.t && hit.t <= packet.t_max;
        counts.then(|| Hit { t: hit.t.max(near).min(far) + 0.0, primitive: i, ..hit })
    }

    /// Whether primitive `i` is hit; its box is met already.
    #[inline(always)]
    pub(super) fn occluded(&self, i: u32, ray: &Ray) -> bool {
        self.primitives.occluded(i as usize, ray)
    }
}

impl fmt::Debug for Items {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Items").field("count", &self.boxes.len()).field("bounds", &self.bounds).finish_non_exhaustive()
    }
}

/// As [`slab`](crate::geometry::slab) computes it for boxes on the way: those of [`BoxRay`](crate::method::search::BoxRay).
#[inline(always)]
fn interval(b: &Aabb, ray: &Packet<f32>) -> (f32, f32) {
    let (org, inv, inv_far) = (ray.org, ray.inv_dir, ray.inv_dir_far);
    let x = slab(b, 0, org.x, inv.x, inv_far.x);
    let y = slab(b, 1, org.y, inv.y, inv_far.y);
    let z = slab(b, 2, org.z, inv.z, inv_far.z);
    (x.0.max(y.0).max(z.0), x.1.min(y.1).min(z.1))
}

#[inline(always)]
fn slab(b: &Aabb, axis: usize, org: f32, inv: f32, inv_far: f32) -> (f32, f32) {
    let (enter, leave) = if inv < 0.0 { (b.max[axis], b.min[axis]) } else { (b.min[axis], b.max[axis]) };
    ((enter - org) * inv, (leave - org) * inv_far)
}
