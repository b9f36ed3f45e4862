//! Triangles ready to be asked.

mod choose;
mod file;
mod nearest;
#[cfg(test)]
pub(crate) mod random;

pub(crate) use choose::one_for_each;

use crate::Error;
use crate::bvh::{BuildConfig, CollapseConfig, WideBvh};
use crate::geometry::{Aabb, Hit, HitBatch, Ray, RayBatch, Triangle};
use crate::method::{Auto, BitVec, Context, Method, Single, Vertices, Watertight};
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
/// A [watertight](SceneBuilder::watertight) scene is that for `closest`, `occluded` and their batches; filters, masks and a [`World`] go through
/// the usual triangle test, whose hits differ by rounding. It can neither be saved nor refitted.
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
    /// Of a scene that is [watertight](SceneBuilder::watertight).
    vertices: Option<Vertices>,
}

impl Scene {
    /// Starts a scene.
    pub fn builder<'a>() -> SceneBuilder<'a> {
        SceneBuilder {
            meshes: Vec::new(),
            level: Level::best(),
            config: BuildConfig::default(),
            budget: u64::MAX,
            masks: Vec::new(),
            watertight: false,
            progress: &Silent,
        }
    }

    /// The first hit of a ray. (What an unusual ray does: see [`Ray`].)
    #[must_use]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        let hit = match self.watertight() {
            Some(method) => method.closest_of(ray),
            None => Single::new(&self.bvh, self.level).closest_of(ray),
        };
        (!hit.is_miss()).then_some(hit)
    }

    /// Whether a ray hits anything between its ends.
    #[must_use]
    pub fn occluded(&self, ray: &Ray) -> bool {
        match self.watertight() {
            Some(method) => method.any_of(ray),
            None => Single::new(&self.bvh, self.level).any_of(ray),
        }
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
        let cx = &mut Context::default();
        let _ = match self.watertight() {
            Some(method) => method.closest(rays, hits, cx),
            None => self.method().closest(rays, hits, cx),
        };
    }

    /// Whether each ray hits anything, as [`Scene::closest_batch`].
    pub fn occluded_batch(&self, rays: &RayBatch, occluded: &mut BitVec) {
        let cx = &mut Context::default();
        let _ = match self.watertight() {
            Some(method) => method.any(rays, occluded, cx),
            None => self.method().any(rays, occluded, cx),
        };
    }

    /// The method behind the batches, for its counters and for a flag that cancels. (A watertight scene's is [`Scene::watertight`]; this one
    /// finds there what the usual triangle test finds.)
    #[must_use]
    pub fn method(&self) -> Auto<'_> {
        Auto::new(&self.bvh, self.level)
    }

    /// The method behind the queries of a scene that is [watertight](SceneBuilder::watertight), but for those with filters and masks.
    #[must_use]
    pub fn watertight(&self) -> Option<Watertight<'_>> {
        self.vertices.as_ref().map(|vertices| Watertight::new(&self.bvh, vertices, self.level))
    }

    /// Which mesh, in the order they were added, and which of its triangles a hit's primitive is.
    #[must_use]
    pub fn locate(&self, primitive: u32) -> (usize, u32) {
        locate(&self.first, primitive)
    }

    /// Takes meshes whose vertices moved in the place of those that the scene was built of, in the same order: much faster than
    /// building, with the hits of a scene that is built anew, bit for bit. Rays find them the slower the further vertices moved against each
    /// other. A triangle that has become [degenerate](crate::geometry::Triangle::is_degenerate) is not hit any more, and comes back
    /// when it is none in a later call.
    ///
    /// ```
    /// use tracer::{Scene, geometry::Ray, model::Mesh};
    ///
    /// # fn main() -> Result<(), tracer::Error> {
    /// let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let mut mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
    /// let mut scene = Scene::builder().mesh(mesh.clone()).build()?;
    /// mesh.positions.iter_mut().for_each(|p| p[2] += 0.5);
    /// scene.refit(&[mesh])?;
    /// let hit = scene.closest(&Ray::new([0.25, 0.25, 2.0], [0.0, 0.0, -1.0]));
    /// assert_eq!(hit.map(|hit| hit.t), Some(1.5));
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`Error::Geometry`], and the scene stays as it was: when a mesh is not acceptable; when there are other meshes, or other numbers of triangles in
    /// them, than the scene was built of; when a triangle was degenerate then and is not any more. Build the scene again then.
    /// [`Error::Usage`] for a [watertight](SceneBuilder::watertight) scene.
    pub fn refit(&mut self, meshes: &[Mesh]) -> Result<(), Error> {
        if self.vertices.is_some() {
            return Err(Error::Usage("a watertight scene is not refitted: build it again".into()));
        }
        validate(meshes)?;
        let mut number = 0;
        let same = meshes.len() == self.first.len()
            && meshes.iter().zip(&self.first).all(|(mesh, &first)| {
                let starts_there = number == first as usize;
                number += mesh.triangles.len();
                starts_there
            });
        if !same {
            return Err(Error::Geometry(
                "other meshes, or other numbers of triangles, than the scene was built of: build it again".into(),
            ));
        }
        let first = &self.first;
        self.bvh.refit_to(number, |id| {
            let (mesh, local) = locate(first, id);
            Triangle::new(meshes[mesh].triangle(local as usize), id, 0)
        })?;
        self.bounds = meshes.iter().fold(Aabb::EMPTY, |b, mesh| b.union(&mesh.bounds()));
        Ok(())
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
    budget: u64,
    watertight: bool,
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

    /// With another builder of trees than the default: [`BuildConfig::fast`], [`BuildConfig::medium`] (the default),
    /// [`BuildConfig::high`]. The hits are the same.
    pub fn build_config(self, config: BuildConfig) -> Self {
        Self { config, ..self }
    }

    /// Refuses to build when that would take more than this many bytes of memory at once, beside the meshes, as
    /// [`BuildConfig::peak_bytes`] has it.
    pub fn memory_budget(self, bytes: u64) -> Self {
        Self { budget: bytes, ..self }
    }

    /// Whether no ray may slip through between triangles that share an edge or a vertex: their indices, or the bits of their coordinates,
    /// must be the same. The usual test loses about one in ten of the rays that are aimed exactly at an edge or a vertex.
    ///
    /// Rays go one by one then, which takes about twice the time of [`method::Single`](crate::method::Single), and triangles take
    /// 160 bytes more for each four. Hits differ from the usual ones by rounding, and are the same bits on every level and by every tree. Holds
    /// for origins at any distance; triangles seen exactly from their edge are not hit, but their neighbours are. Such a scene cannot be
    /// saved.
    ///
    /// Woop, Benthin and Wald 2013, \"Watertight Ray/Triangle Intersection\", Journal of Computer Graphics Techniques 2(1).
    ///
    /// ```
    /// use tracer::{Scene, geometry::Ray};
    ///
    /// # fn main() -> Result<(), tracer::Error> {
    /// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.1], [1.0, 1.0, 0.2], [0.0, 1.0, 0.3]];
    /// let scene = Scene::builder().triangles(corners, vec![[0, 1, 2], [0, 2, 3]]).watertight(true).build()?;
    /// let along_the_edge = (1..100).map(|i| i as f32 * 0.01).map(|x| Ray::new([x, x, 2.0], [0.0, 0.0, -1.0]));
    /// assert!(along_the_edge.into_iter().all(|ray| scene.occluded(&ray)));
    /// # Ok(())
    /// # }
    /// ```
    pub fn watertight(self, watertight: bool) -> Self {
        Self { watertight, ..self }
    }

    /// Tells of the progress of [`SceneBuilder::build`], and can cancel it.
    pub fn progress(self, progress: &'a dyn Progress) -> Self {
        Self { progress, ..self }
    }

    /// Builds the tree, on the threads of the current rayon pool.
    ///
    /// # Errors
    /// [`Error::Geometry`] with the mesh and its vertex or triangle at fault; [`Error::Usage`] when the memory budget does not suffice, before
    /// memory is asked for; [`Error::Cancelled`].
    pub fn build(self) -> Result<Scene, Error> {
        validate(&self.meshes)?;
        self.check_budget()?;
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
        let build = if self.watertight { WideBvh::build_watertight } else { WideBvh::build };
        let bvh = build(&all, &self.config, &CollapseConfig::default(), self.progress)?;
        let vertices = self.watertight.then(|| Vertices::new(&bvh, &all));
        Ok(Scene { bvh, level: self.level, bounds: all.bounds(), first, masks: self.masks, vertices })
    }
}

impl SceneBuilder<'_> {
    fn check_budget(&self) -> Result<(), Error> {
        let triangles = self.meshes.iter().map(|mesh| mesh.triangles.len()).sum();
        let needed = self.config.peak_bytes(triangles);
        if needed <= self.budget {
            return Ok(());
        }
        let least = BuildConfig::medium().peak_bytes(triangles);
        let advice =
            if least <= self.budget { "take BuildConfig::medium()" } else { "raise it or take fewer triangles" };
        Err(Error::Usage(format!(
            "to build a tree over {triangles} triangles takes up to {needed} bytes of memory, the budget is {}: {advice}",
            self.budget
        )))
    }
}

fn validate(meshes: &[Mesh]) -> Result<(), Error> {
    let named = |(i, mesh): (usize, &Mesh)| mesh.validate().map_err(|e| Error::Geometry(format!("mesh {i}: {e}")));
    meshes.iter().enumerate().try_for_each(named)
}

/// Which mesh, and which of its triangles, when these are the first ones of the meshes.
fn locate(first: &[u32], primitive: u32) -> (usize, u32) {
    let mesh = first.partition_point(|&first| first <= primitive).saturating_sub(1);
    (mesh, primitive - first.get(mesh).copied().unwrap_or_default())
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
    fn moved_meshes_are_as_if_built_anew() {
        let balls = crate::model::builtin("balls:1").expect("a name").expect("a size").mesh;
        let mut meshes = [square(0.0), balls, square(2.0)];
        let build = |meshes: &[Mesh]| {
            let builder = meshes.iter().fold(Scene::builder(), |builder, mesh| builder.mesh(mesh.clone()));
            builder.build().expect("valid meshes")
        };
        let mut scene = build(&meshes);
        meshes.iter_mut().zip([0.1, 0.2, 0.3]).for_each(|(mesh, by)| {
            mesh.positions.iter_mut().for_each(|p| *p = [p[0] + by * p[1], p[1] - 0.1 * p[0] * p[2], p[2] + by]);
        });
        scene.refit(&meshes).expect("the same meshes");
        let new = build(&meshes);
        let rays: RayBatch = (0..900)
            .map(|i| Ray::new([(i % 30) as f32 * 0.1 - 1.5, (i / 30) as f32 * 0.1 - 1.5, 5.0], [0.01, 0.02, -1.0]))
            .collect();
        let hash = |scene: &Scene| {
            let mut hits = HitBatch::new();
            scene.closest_batch(&rays, &mut hits);
            hits.hash()
        };
        assert_eq!((hash(&scene), scene.bounds()), (hash(&new), new.bounds()));
        scene.bvh.validate().expect("a tree that is well-formed");

        meshes.swap(0, 1);
        let e = scene.refit(&meshes).expect_err("other numbers of triangles");
        assert!(e.to_string().contains("build it again"), "{e}");
        assert!(scene.refit(&meshes[..2]).is_err());
        meshes.swap(0, 1);
        meshes[2].triangles.pop();
        assert!(scene.refit(&meshes).expect_err("fewer").to_string().contains("build the tree again"));
        meshes[1].positions[7][2] = f32::NAN;
        assert!(scene.refit(&meshes).expect_err("NaN").to_string().starts_with("mesh 1: vertex 7"));
        assert_eq!(hash(&scene), hash(&new));
    }

    #[test]
    fn a_budget_is_kept() {
        let build = |budget: u64, config| {
            Scene::builder().mesh(square(0.0)).mesh(square(1.0)).memory_budget(budget).build_config(config).build()
        };
        let needed = BuildConfig::insertion(0).peak_bytes(4);
        build(needed, BuildConfig::insertion(0)).expect("enough");
        let e = build(needed - 1, BuildConfig::insertion(0)).expect_err("too little").to_string();
        assert!(e.contains(&format!("up to {needed} bytes")) && e.contains("take BuildConfig::medium()"), "{e}");
        let e = build(100, BuildConfig::fast()).expect_err("far too little");
        assert!(matches!(&e, Error::Usage(message) if message.contains("raise it")), "{e}");
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
