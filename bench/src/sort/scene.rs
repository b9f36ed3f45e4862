//! Rays to be sorted.

use super::keys::Keys;
use crate::console::Console;
use simd::Level;
use tracer::Error;
use tracer::bvh::{BuildConfig, Bvh, CollapseConfig, WideBvh};
use tracer::geometry::{Aabb, HitBatch, Ray, RayBatch};
use tracer::method::{Auto, Context, Method, Width};
use tracer::model::{Camera, Material, Model};
use tracer::progress::{Progress, Silent};
use tracer::render::integrator::{self, Config, Integrator, Means, Path, Query};
use tracer::render::{EyeRays, Scenery};
use tracer::sort::{RayHash, Reorder};

/// A scene all of whose surfaces are matt.
pub struct Scene {
    pub name: String,
    pub wide: WideBvh<8>,
    pub bounds: Aabb,
    model: Model,
    camera: Camera,
}

impl Scene {
    /// A built-in scene or a file.
    pub fn open(name: &str, console: &Console) -> Result<Self, Error> {
        console.stage(&format!("{name}: reading"), 0);
        let (mut model, _warnings) = Model::open(name, console)?;
        model.materials = vec![Material::matt("surface", [0.7; 3])];
        model.mesh.materials = vec![0; model.mesh.triangles.len()];
        model.validate()?;
        let wide = Bvh::build(&model.mesh, &BuildConfig::default(), console)?.collapse(&CollapseConfig::default());
        console.clear();
        let (bounds, camera) = (model.mesh.bounds(), model.camera_or_default());
        Ok(Self { name: name.into(), wide, bounds, model, camera })
    }

    /// Hashes of shadow rays, by origin alone as the paper has them: so many from each point that is seen.
    pub fn shadow_keys(&self, width: usize, height: usize, samples: usize) -> Result<Keys, Error> {
        let level = Level::best();
        let eye = EyeRays::new(&self.camera, width, height, level, Width::Auto);
        let mut hits = HitBatch::new();
        Auto::new(&self.wide, level).closest(eye.rays(), &mut hits, &mut Context::default())?;
        let seen = eye.rays().iter().zip(hits.iter()).filter(|(_, hit)| !hit.is_miss());
        let origin = |(ray, hit): (Ray, tracer::geometry::Hit)| [0, 1, 2].map(|i| ray.org[i] + hit.t * ray.dir[i]);
        let rays: RayBatch = seen.map(origin).map(|org| Ray::new(org, [0.0, 0.0, 1.0])).collect();
        let mut hashes = Vec::new();
        RayHash::new(&self.bounds, Reorder::Origin).hash(level, &rays, &mut hashes);
        let keys = hashes.into_iter().flat_map(|hash| std::iter::repeat_n(hash, samples)).collect();
        let name = format!("{}, {samples} shadow rays a point", self.name);
        Ok(Keys { name, keys })
    }

    /// Rays after so many diffuse reflections, of one sample of a square picture, in the order that the integrator has them.
    pub fn diffuse_rays(&self, size: usize, reflections: u32) -> Result<RayBatch, Error> {
        let path = Path { bounces: reflections, ..Path::default() };
        let config = Config { integrator: Integrator::Path(path), ..Config::new(size, size) };
        let method = Auto::new(&self.wide, config.level);
        let mut found = RayBatch::new();
        let mut observer = |depth: usize, query: Query, rays: &RayBatch| {
            if depth == reflections as usize && query == Query::Closest {
                found.extend(rays.iter());
            }
        };
        let mut cx = Context::default();
        let means = Means { method: &method, cx: &mut cx, observer: Some(&mut observer), progress: &Silent };
        let scenery = Scenery::new(&self.model, &self.camera);
        integrator::render(&self.model, &scenery, self.camera, &config, means)?;
        Ok(found)
    }
}
