//! Triangles ready to be asked.

mod choose;
mod file;
mod nearest;
#[cfg(test)]
pub(crate) mod random;

pub(crate) use choose::one_for_each;

use crate::Error;
use crate::bvh::{BuildConfig, Bvh, CollapseConfig, WideBvh};
use crate::geometry::{Aabb, Hit, HitBatch, Ray, RayBatch};
use crate::method::{Auto, BitVec, Context, Method, Single};
use crate::model::Mesh;
use crate::progress::{Progress, Silent};
use simd::Level;

/// Triangles ready to be asked which of them a ray meets: the whole library behind a few calls.
///
/// ```
/// use tracer::{Scene, geometry::Ray};
///
/// # fn main() -> Result<(), tracer::Error> {
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
/// let scene = Scene::builder().triangles(corners, vec![[0, 1, 2]]).build()?;
/// let ray = Ray::new([0.25, 0.25, 2.0], [0.0, 0.0, -1.0]);
/// let hit = scene.closest(&ray).expect("the triangle is there");
/// assert_eq!((hit.t, hit.u, hit.v, hit.primitive), (2.0, 0.25, 0.25, 0));
/// assert!(scene.occluded(&ray));
/// # Ok(())
/// # }
/// ```
///
/// Many rays are found much faster as a batch, in whatever order: see [`Scene::closest_batch`].
///
/// # What composes with what
///
/// | query                        | one            | batch, any length and order | filter       | mask for each | filter and mask         |
/// |------------------------------|----------------|-----------------------------|--------------|---------------|-------------------------|
/// | [`Scene`]: first hit         | `closest`      | `closest_batch`             | `.._where`   | `.._masked`   | `is_visible` in `.._where` |
/// | [`Scene`]: any hit           | `occluded`     | `occluded_batch`            | `.._where`   | `.._masked`   | `is_visible` in `.._where` |
/// | [`Scene`]: nearest point     | `nearest`      | `nearest_batch`             | `.._where`   | `is_visible` in `.._where` | `is_visible` in `.._where` |
/// | [`World`]: first hit         | `closest`      | `closest_batch`             | `.._where`   | `.._masked`   | `is_visible` in `.._where` |
/// | [`World`]: any hit           | `occluded`     | `occluded_batch`            | `.._where`   | `.._masked`   | `is_visible` in `.._where` |
/// | [`World`]: nearest point     | no             | no                          | no           | no            | no                      |
///
/// A [`World`] is made of instances of scenes and of sets of [`Primitives`] in any mixture; all of its queries see both. One level: no
/// world in a world. The nearest point of a scene is not that of its instance, as affine maps change distances: ask the scenes.
/// `.._masked` is for batches of a [`Scene`]; for one ray it is `is_visible` in `closest_where`.
///
/// [`World`]: crate::World
/// [`Primitives`]: crate::Primitives
#[derive(Debug, Clone)]
pub struct Scene {
    bvh: WideBvh<8>,
    level: Level,
    bounds: Aabb,
    /// Number of the first triangle of each mesh.
    first: Vec<u32>,
    /// Who sees each mesh: [`SceneBuilder::mask`].
    masks: Vec<u32>,
}

impl Scene {
    /// Starts a scene.
    pub fn builder<'a>() -> SceneBuilder<'a> {
        SceneBuilder {
            meshes: Vec::new(),
            masks: Vec::new(),
            level: Level::best(),
            config: BuildConfig::default(),
            progress: &Silent,
        }
    }

    /// The first hit of a ray. (What an unusual ray does: see [`Ray`].)
    #[must_use]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        let hit = Single::new(&self.bvh, self.level).closest_of(ray);
        (!hit.is_miss()).then_some(hit)
    }

    /// Whether a ray hits anything between its ends.
    #[must_use]
    pub fn occluded(&self, ray: &Ray) -> bool {
        Single::new(&self.bvh, self.level).any_of(ray)
    }

    /// The first hit of every ray, in their order, on all threads of the current rayon pool. `hits` keeps its memory from one call to
    /// the next.
    ///
    /// ```
    /// use tracer::geometry::{HitBatch, Ray, RayBatch};
    ///
    /// # fn main() -> Result<(), tracer::Error> {
    /// # let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// # let scene = tracer::Scene::builder().triangles(corners, vec![[0, 1, 2]]).build()?;
    /// let rays: RayBatch = (0..1000).map(|i| Ray::new([0.25, 0.001 * i as f32, 2.0], [0.0, 0.0, -1.0])).collect();
    /// let mut hits = HitBatch::new();
    /// scene.closest_batch(&rays, &mut hits);
    /// assert!(!hits.get(0).is_miss() && hits.get(900).is_miss());
    /// # Ok(())
    /// # }
    /// ```
    pub fn closest_batch(&self, rays: &RayBatch, hits: &mut HitBatch) {
        // Without a flag to raise nothing can cancel it.
        let _ = self.method().closest(rays, hits, &mut Context::default());
    }

    /// Whether each ray hits anything, as [`Scene::closest_batch`].
    pub fn occluded_batch(&self, rays: &RayBatch, occluded: &mut BitVec) {
        let _ = self.method().any(rays, occluded, &mut Context::default());
    }

    /// The method behind the batches, for its counters and for a flag that cancels.
    #[must_use]
    pub fn method(&self) -> Auto<'_> {
        Auto::new(&self.bvh, self.level)
    }

    /// Which mesh, in the order they were added, and which of its triangles a hit's primitive is.
    #[must_use]
    pub fn locate(&self, primitive: u32) -> (usize, u32) {
        let mesh = self.first.partition_point(|&first| first <= primitive).saturating_sub(1);
        (mesh, primitive - self.first.get(mesh).copied().unwrap_or_default())
    }

    /// The box around all vertices.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The tree.
    #[must_use]
    pub fn bvh(&self) -> &WideBvh<8> {
        &self.bvh
    }
}

/// What a [`Scene`] is made of.
#[must_use]
pub struct SceneBuilder<'a> {
    meshes: Vec<Mesh>,
    masks: Vec<u32>,
    level: Level,
    config: BuildConfig,
    progress: &'a dyn Progress,
}

impl<'a> SceneBuilder<'a> {
    /// Adds a mesh.
    pub fn mesh(mut self, mesh: Mesh) -> Self {
        self.meshes.push(mesh);
        self.masks.push(u32::MAX);
        self
    }

    /// Who sees the mesh added last: rays with a mask that has a bit in common with this one ([`Scene::closest_batch_masked`]). A mesh
    /// without a mask has all bits.
    pub fn mask(mut self, mask: u32) -> Self {
        if let Some(last) = self.masks.last_mut() {
            *last = mask;
        }
        self
    }

    /// Adds a mesh: corners, and three of them for each triangle.
    pub fn triangles(self, positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>) -> Self {
        self.mesh(Mesh { positions, triangles, ..Mesh::default() })
    }

    /// At another level than the best. The hits are the same.
    pub fn level(self, level: Level) -> Self {
        Self { level, ..self }
    }

    /// With another builder of trees than the default.
    pub fn build_config(self, config: BuildConfig) -> Self {
        Self { config, ..self }
    }

    /// Tells of the progress of [`SceneBuilder::build`], and can cancel it.
    pub fn progress(self, progress: &'a dyn Progress) -> Self {
        Self { progress, ..self }
    }

    /// Builds the tree, on the threads of the current rayon pool.
    ///
    /// # Errors
    /// [`Error::Geometry`] with the mesh and its vertex or triangle at fault; [`Error::Cancelled`].
    pub fn build(self) -> Result<Scene, Error> {
        for (i, mesh) in self.meshes.iter().enumerate() {
            mesh.validate().map_err(|e| Error::Geometry(format!("mesh {i}: {e}")))?;
        }
        let mut first = Vec::with_capacity(self.meshes.len());
        let mut all = Mesh::default();
        for mesh in self.meshes {
            first.push(u32::try_from(all.triangles.len()).unwrap_or(u32::MAX));
            let base = u32::try_from(all.positions.len()).unwrap_or(u32::MAX);
            if u64::from(base) + mesh.positions.len() as u64 > u64::from(u32::MAX) {
                return Err(Error::Geometry(
                    "all meshes together have more than 2^32 vertices: make several scenes".into(),
                ));
            }
            all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + base)));
            all.positions.extend(mesh.positions);
        }
        let bvh = Bvh::build(&all, &self.config, self.progress)?;
        Ok(Scene {
            bvh: bvh.collapse(&CollapseConfig::default()),
            level: self.level,
            bounds: all.bounds(),
            first,
            masks: self.masks,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(z: f32) -> Mesh {
        Mesh {
            positions: vec![[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        }
    }

    #[test]
    fn meshes_are_told_apart() {
        let scene =
            Scene::builder().mesh(square(0.0)).mesh(square(1.0)).mesh(square(2.0)).build().expect("valid meshes");
        let down = Ray::new([0.25, 0.5, 1.5], [0.0, 0.0, -1.0]);
        let hit = scene.closest(&down).expect("the second square");
        assert_eq!((hit.t, scene.locate(hit.primitive)), (0.5, (1, 1)));
        let up = Ray { t_max: 0.25, ..Ray::new([0.25, 0.5, 1.5], [0.0, 0.0, 1.0]) };
        assert!(scene.closest(&up).is_none() && !scene.occluded(&up) && scene.occluded(&down));
        assert_eq!((scene.bounds().min, scene.bounds().max), ([0.0; 3], [1.0, 1.0, 2.0]));
    }

    #[test]
    fn one_ray_and_many_find_the_same() {
        let mesh = crate::model::builtin("balls:1").expect("a name").expect("a size").mesh;
        let Aabb { min, max } = mesh.bounds();
        let rays: RayBatch = (0..500)
            .map(|i| {
                let at = |k: usize, step: usize| min[k] + (max[k] - min[k]) * ((i * step % 97) as f32 / 96.0);
                Ray::new([at(0, 31), at(1, 17), max[2] + 1.0], [at(1, 7) - at(0, 3), at(0, 11) * 0.1, -1.0])
            })
            .collect();
        for level in Level::available() {
            let scene = Scene::builder().mesh(mesh.clone()).level(level).build().expect("a valid mesh");
            let (mut hits, mut occluded) = (HitBatch::new(), BitVec::new());
            scene.closest_batch(&rays, &mut hits);
            scene.occluded_batch(&rays, &mut occluded);
            assert!(occluded.count_ones() > 50);
            for (i, ray) in rays.iter().enumerate() {
                assert_eq!(scene.closest(&ray).unwrap_or(Hit::MISS), hits.get(i), "{level}, ray {i}");
                assert_eq!(scene.occluded(&ray), occluded.get(i), "{level}, ray {i}");
            }
        }
    }

    #[test]
    fn what_cannot_be_built_says_where() {
        let mut bad = square(0.0);
        bad.positions[3][1] = f32::NAN;
        let e = Scene::builder().mesh(square(0.0)).mesh(bad).build().expect_err("NaN");
        assert!(e.to_string().starts_with("mesh 1: vertex 3 is (0, NaN, 0)"), "{e}");
        assert!(Scene::builder().build().expect_err("nothing").to_string().contains("no triangles"));
        let flag = std::sync::atomic::AtomicBool::new(true);
        assert!(matches!(Scene::builder().mesh(square(0.0)).progress(&flag).build(), Err(Error::Cancelled)));
    }
}
