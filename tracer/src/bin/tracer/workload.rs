//! Scenes made ready to be traced.

use crate::args::BuildOptions;
use crate::console::Console;
use crate::machine;
use crate::method::{MethodChoice, Tree};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tracer::Error;
use tracer::bvh::Bvh;
use tracer::model::{Builtin, Mesh, Model};
use tracer::progress::Progress;
use tracer::render::Surfaces;

/// A scene to be seen.
pub struct Workload {
    pub scene: Model,
    pub surfaces: Surfaces,
    /// Whether it is none from a file.
    pub built_in: bool,
    pub load_ms: f64,
}

impl Workload {
    /// On the current rayon pool.
    pub fn open(spec: &str, console: &Console) -> Result<Self, Error> {
        let (scene, load_ms) = open(spec, console)?;
        scene.validate()?;
        let (surfaces, built_in) = (Surfaces::new(&scene), built_in(spec).is_some());
        Ok(Self { scene, surfaces, built_in, load_ms })
    }
}

/// The binary tree over a scene.
#[derive(Clone)]
pub struct Built {
    pub bvh: Arc<Bvh>,
    /// The builder's name.
    pub name: &'static str,
    pub ms: f64,
}

impl Built {
    /// On the current rayon pool.
    pub fn new(mesh: &Mesh, options: &BuildOptions, console: &Console) -> Result<Self, Error> {
        let config = options.config()?;
        let start = Instant::now();
        let bvh = Arc::new(Bvh::build(mesh, &config, console)?);
        let ms = ms(start.elapsed());
        console.clear();
        Ok(Self { bvh, name: options.name(), ms })
    }
}

/// What a method goes through, and what it took.
pub struct Structure {
    /// The method that it is for.
    pub choice: MethodChoice,
    pub tree: Tree,
    /// The builder's name; [`Structure::NONE`] where the method wants no tree.
    pub build: &'static str,
    /// Of the binary tree.
    pub nodes: usize,
    /// To build that and to make of it what the method wants.
    pub build_ms: f64,
}

impl Structure {
    /// In place of a builder's name.
    pub const NONE: &str = "none";

    /// For a method; the binary tree is asked for if it wants one.
    pub fn new(choice: MethodChoice, mesh: &Mesh, built: impl FnOnce() -> Result<Built, Error>) -> Result<Self, Error> {
        let (mut build, mut nodes, mut before, mut start) = (Self::NONE, 0, 0.0, Instant::now());
        let tree = choice.tree(mesh, || {
            let Built { bvh, name, ms } = built()?;
            (build, nodes, before, start) = (name, bvh.nodes.len(), ms, Instant::now());
            Ok(bvh)
        })?;
        Ok(Self { choice, tree, build, nodes, build_ms: before + ms(start.elapsed()) })
    }
}

/// The scene that the user names, and the milliseconds it took; passes warnings on.
pub fn open(spec: &str, console: &Console) -> Result<(Model, f64), Error> {
    if let Some((which, size)) = built_in(spec) {
        check_size(which, size.parse().unwrap_or_else(|_| which.default_size()))?;
        console.stage("generate", 0);
    }
    let start = Instant::now();
    let (scene, warnings) = Model::open(spec, console)?;
    warnings.iter().for_each(|w| console.warn(w));
    Ok((scene, ms(start.elapsed())))
}

/// Which built-in scene the user names, and the size as text.
fn built_in(spec: &str) -> Option<(Builtin, &str)> {
    let (name, size) = spec.split_once(':').unwrap_or((spec, ""));
    Builtin::ALL.into_iter().find(|b| b.name() == name).map(|which| (which, size))
}

/// Refuses a built-in scene that does not fit into memory.
pub fn check_size(which: Builtin, size: u32) -> Result<(), Error> {
    // Vertices, normals and indices; the tree and its triangles; what is needed to build it.
    const BYTES_PER_TRIANGLE: u64 = 300;
    let Some(triangles) = which.triangles(size) else { return Ok(()) };
    machine::check_memory(BYTES_PER_TRIANGLE * triangles as u64, &format!("{}:{size}", which.name()))
}

/// Milliseconds.
pub fn ms(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}

/// Millions of rays per second.
pub fn mrays_per_s(rays: usize, ms: f64) -> f64 {
    if ms > 0.0 { rays as f64 / ms / 1e3 } else { 0.0 }
}

/// The middle of a number of measurements; the mean of the middle two when their number is even.
pub fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    let n = times.len();
    if n == 0 { 0.0 } else { 0.5 * (times[(n - 1) / 2] + times[n / 2]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median(vec![]), 0.0);
        assert_eq!(median(vec![3.0, 1.0, 50.0]), 3.0);
        assert_eq!(median(vec![4.0, 1.0, 2.0, 9.0]), 3.0);
    }

    #[test]
    fn rays_per_second() {
        assert_eq!(mrays_per_s(3_000_000, 1500.0), 2.0);
        assert_eq!(mrays_per_s(0, 0.0), 0.0);
    }
}
