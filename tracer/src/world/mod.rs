//! Many scenes at many places, and surfaces of the user's own.

mod builder;
mod find;
mod primitives;
mod transform;

#[cfg(test)]
mod tests;

pub use builder::WorldBuilder;
pub use primitives::Primitives;

use crate::bvh::WideBvh;
use crate::geometry::{Aabb, Hit, Ray, RayBatch};
use crate::method::BitVec;
use crate::scene::one_for_each;
use crate::{Error, Scene};
use find::Accept;
use primitives::Items;
use simd::Level;
use std::sync::Arc;
use transform::Transform;

/// Where a ray meets a [`World`] first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorldHit {
    /// The hit, as the instance has it: `t` is the same in the world.
    pub hit: Hit,
    /// Number of the instance, in the order they were added.
    pub instance: u32,
}

impl WorldHit {
    /// Nothing hit.
    pub const MISS: Self = Self { hit: Hit::MISS, instance: u32::MAX };

    /// True when nothing was hit.
    #[must_use]
    pub const fn is_miss(&self) -> bool {
        self.hit.is_miss()
    }

    /// Whether it is before another on the ray; of equal distances the lower instance, then the lower primitive is first.
    #[inline(always)]
    fn is_before(&self, other: &Self) -> bool {
        (self.hit.t, self.instance, self.hit.primitive) < (other.hit.t, other.instance, other.hit.primitive)
    }
}

/// Scenes, each as often and wherever wanted (instances, one level of them), and surfaces of one's own ([`Primitives`]), asked as a
/// [`Scene`] is.
///
/// ```
/// use std::sync::Arc;
/// use tracer::{Scene, World, geometry::Ray};
///
/// # fn main() -> Result<(), tracer::Error> {
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let scene = Arc::new(Scene::builder().triangles(corners, vec![[0, 1, 2]]).build()?);
/// // Twice as large, and moved along x.
/// let moved = [[2.0, 0.0, 0.0, 10.0], [0.0, 2.0, 0.0, 0.0], [0.0, 0.0, 2.0, 0.0]];
/// let world = World::builder().instance(scene.clone(), World::IDENTITY).instance(scene, moved).build()?;
/// let found = world.closest(&Ray::new([11.0, 0.5, 3.0], [0.0, 0.0, -1.0])).expect("the second");
/// assert_eq!((found.instance, found.hit.t, found.hit.u, found.hit.v), (1, 3.0, 0.5, 0.25));
/// # Ok(())
/// # }
/// ```
///
/// The result of a ray is the first of what [`Scene::closest`] says of each instance for [`World::object_ray`], bit for bit, at every level
/// and on any number of threads; at equal `t` that of the lower instance, then of the lower primitive. ([Watertight](crate::SceneBuilder::watertight)
/// scenes are asked by the usual triangle test here.)
#[derive(Debug, Clone)]
pub struct World {
    instances: Vec<Instance>,
    /// Over the boxes of the instances: its ids are their numbers.
    tree: WideBvh<8>,
    /// See [`Transform::growth`]: the largest.
    growth: f32,
    bounds: Aabb,
    /// Entries that the stack of a search may need.
    room: usize,
    level: Level,
}

#[derive(Debug, Clone)]
struct Instance {
    content: Content,
    transform: Transform,
    mask: u32,
}

#[derive(Debug, Clone)]
enum Content {
    Scene(Arc<Scene>),
    Items(Items),
}

impl Content {
    fn tree(&self) -> &WideBvh<8> {
        match self {
            Self::Scene(scene) => scene.bvh(),
            Self::Items(items) => &items.tree,
        }
    }

    /// The box that the tree of it has; empty without anything in it.
    fn bounds(&self) -> Aabb {
        match self {
            Self::Scene(scene) => scene.bvh().bounds(),
            Self::Items(items) => items.bounds,
        }
    }
}

impl World {
    /// The matrix that leaves everything where it is.
    pub const IDENTITY: [[f32; 4]; 3] = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

    /// Starts a world.
    pub fn builder() -> WorldBuilder {
        WorldBuilder::default()
    }

    /// The first hit of a ray. (What an unusual ray does: see [`Ray`].)
    #[must_use]
    pub fn closest(&self, ray: &Ray) -> Option<WorldHit> {
        self.closest_of(ray, None, None)
    }

    /// Whether a ray hits anything between its ends.
    #[must_use]
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.occluded_of(ray, None, None)
    }

    /// The first hit of a ray that `accept` takes: see [`Scene::closest_where`].
    #[must_use]
    pub fn closest_where(&self, ray: &Ray, accept: impl Fn(&WorldHit) -> bool) -> Option<WorldHit> {
        self.closest_of(ray, None, Some(&accept))
    }

    /// Whether a ray hits anything that `accept` takes: see [`Scene::closest_where`].
    #[must_use]
    pub fn occluded_where(&self, ray: &Ray, accept: impl Fn(&WorldHit) -> bool) -> bool {
        self.occluded_of(ray, None, Some(&accept))
    }

    /// The first hit of a ray with a mask among what it sees: instances whose [mask](WorldBuilder::mask) has a bit in common with it, and in
    /// them the meshes whose mask has one.
    #[must_use]
    pub fn closest_masked(&self, ray: &Ray, mask: u32) -> Option<WorldHit> {
        self.closest_of(ray, Some(mask), None)
    }

    /// Whether a ray with a mask hits anything that it sees: see [`World::closest_masked`].
    #[must_use]
    pub fn occluded_masked(&self, ray: &Ray, mask: u32) -> bool {
        self.occluded_of(ray, Some(mask), None)
    }

    /// The first hit of every ray, [`WorldHit::MISS`] where there is none, in their order, on all threads of the current rayon pool. `hits`
    /// keeps its memory from one call to the next.
    pub fn closest_batch(&self, rays: &RayBatch, hits: &mut Vec<WorldHit>) {
        self.closest_of_batch(rays, None, hits, None);
    }

    /// Whether each ray hits anything, as [`World::closest_batch`].
    pub fn occluded_batch(&self, rays: &RayBatch, occluded: &mut BitVec) {
        self.occluded_of_batch(rays, None, occluded, None);
    }

    /// The first hit of every ray that `accept`, told the number of the ray, takes: see [`Scene::closest_batch_where`].
    pub fn closest_batch_where(
        &self,
        rays: &RayBatch,
        hits: &mut Vec<WorldHit>,
        accept: impl Fn(usize, &WorldHit) -> bool + Sync,
    ) {
        self.closest_of_batch(rays, None, hits, Some(&accept));
    }

    /// Whether each ray hits anything that `accept`, told the number of the ray, takes: see [`Scene::closest_batch_where`].
    pub fn occluded_batch_where(
        &self,
        rays: &RayBatch,
        occluded: &mut BitVec,
        accept: impl Fn(usize, &WorldHit) -> bool + Sync,
    ) {
        self.occluded_of_batch(rays, None, occluded, Some(&accept));
    }

    /// [`World::closest_masked`] of every ray, with a mask for each. To have a filter beside masks, ask [`World::is_visible`] in the filter.
    ///
    /// # Errors
    /// [`Error::Usage`] when there are not as many masks as rays.
    pub fn closest_batch_masked(&self, rays: &RayBatch, masks: &[u32], hits: &mut Vec<WorldHit>) -> Result<(), Error> {
        one_for_each(rays, masks)?;
        self.closest_of_batch(rays, Some(masks), hits, None);
        Ok(())
    }

    /// [`World::occluded_masked`] of every ray, with a mask for each.
    ///
    /// # Errors
    /// [`Error::Usage`] when there are not as many masks as rays.
    pub fn occluded_batch_masked(&self, rays: &RayBatch, masks: &[u32], occluded: &mut BitVec) -> Result<(), Error> {
        one_for_each(rays, masks)?;
        self.occluded_of_batch(rays, Some(masks), occluded, None);
        Ok(())
    }

    /// Whether a ray with this mask sees what was hit: the masks of the instance and, if it is a scene, of the mesh have a bit in common
    /// with it each.
    #[must_use]
    pub fn is_visible(&self, hit: &WorldHit, mask: u32) -> bool {
        self.instances.get(hit.instance as usize).is_some_and(|instance| {
            let of_mesh = match &instance.content {
                Content::Scene(scene) => scene.is_visible(hit.hit.primitive, mask),
                Content::Items(_) => true,
            };
            instance.mask & mask != 0 && of_mesh
        })
    }

    /// The ray as an instance is asked it: in its own coordinates, computed in `f64` and rounded once. The direction is not scaled, so that
    /// `t` means the same.
    ///
    /// # Panics
    /// If there is no such instance.
    #[must_use]
    pub fn object_ray(&self, instance: u32, ray: &Ray) -> Ray {
        self.instances[instance as usize].transform.ray(ray)
    }

    /// Number of instances.
    #[must_use]
    pub fn instances(&self) -> usize {
        self.instances.len()
    }

    /// A box around everything, a little larger than needed.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn closest_of(&self, ray: &Ray, mask: Option<u32>, accept: Option<&dyn Fn(&WorldHit) -> bool>) -> Option<WorldHit> {
        let [hit, ..] = find::one::<[WorldHit; 16]>(self, ray, mask, accept);
        (!hit.is_miss()).then_some(hit)
    }

    fn occluded_of(&self, ray: &Ray, mask: Option<u32>, accept: Option<&dyn Fn(&WorldHit) -> bool>) -> bool {
        find::one::<u16>(self, ray, mask, accept) != 0
    }

    fn closest_of_batch(
        &self,
        rays: &RayBatch,
        masks: Option<&[u32]>,
        hits: &mut Vec<WorldHit>,
        accept: Option<&Accept>,
    ) {
        hits.resize(16 * rays.blocks().len(), WorldHit::MISS);
        find::batch(self, rays, masks, hits.as_chunks_mut().0, accept);
        hits.truncate(rays.len());
    }

    fn occluded_of_batch(
        &self,
        rays: &RayBatch,
        masks: Option<&[u32]>,
        occluded: &mut BitVec,
        accept: Option<&Accept>,
    ) {
        find::batch(self, rays, masks, occluded.resize(rays.len()), accept);
    }
}
