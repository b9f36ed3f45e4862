//! The paper's scenes, or what is nearest to them, all of them matt, and the rays of their pictures.

use super::race::Task;
use crate::console::Console;
use crate::report::scenes::{self, View};
use clap::ValueEnum;
use serde::Serialize;
use std::fmt;
use tracer::Error;
use tracer::bvh::{BuildConfig, Bvh, CollapseConfig, WideBvh};
use tracer::geometry::RayBatch;
use tracer::method::{Auto, Context, TriangleBoxes};
use tracer::model::{Camera, Material, Model};
use tracer::progress::{Progress, Silent};
use tracer::render::Scenery;
use tracer::render::integrator::{self, Config, Integrator, Means, Path, Query};

/// A scene of the paper, in the order of its table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
pub enum Name {
    /// The conference room
    Conference,
    /// A stand-in: the built-in tree on its field
    Fairy,
    /// A stand-in: the built-in hairball
    Hairball,
}

impl Name {
    /// In the order of the paper, those of a list or all.
    pub fn chosen(names: &[Self]) -> Vec<Self> {
        let all = [Self::Conference, Self::Fairy, Self::Hairball];
        all.into_iter().filter(|name| names.is_empty() || names.contains(name)).collect()
    }

    /// As files are called.
    pub fn file(self) -> &'static str {
        match self {
            Self::Conference => "conference",
            Self::Fairy => "fairy",
            Self::Hairball => "hairball",
        }
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Conference => "Conference",
            Self::Fairy => "Fairy (stand-in)",
            Self::Hairball => "Hairball (stand-in)",
        })
    }
}

/// A scene ready to be traced by all methods.
pub struct Scene {
    pub name: Name,
    /// What it is, for the report.
    pub what: String,
    pub model: Model,
    camera: Camera,
    scenery: Scenery,
    pub boxes: TriangleBoxes,
    pub four: WideBvh<4>,
    pub eight: WideBvh<8>,
    pub sixteen: WideBvh<16>,
}

impl Scene {
    /// Reads or makes it and builds its trees; none when its file is missing, which is said on standard output. A small one if it is to
    /// be quick.
    pub fn open(name: Name, quick: bool, console: &Console) -> Result<Option<Self>, Error> {
        console.stage(&format!("{name}: reading"), 0);
        let view = match name {
            Name::Conference => scenes::conference(console)?,
            Name::Fairy => scenes::fairy()?,
            Name::Hairball => scenes::hairball(quick)?,
        };
        let Some(view) = view else { return Ok(None) };
        let what = view.describe();
        let View { mut model, camera, .. } = view;
        // Grey, so that no path ends because nothing is left of its light.
        model.materials = vec![Material::matt("surface", [0.7; 3])];
        model.mesh.materials.clear();
        model.lights.clear();
        model.validate()?;
        let bvh = Bvh::build(&model.mesh, &BuildConfig::medium(), console)?;
        let collapse = CollapseConfig::default();
        let scene = Self {
            name,
            what,
            scenery: Scenery::new(&model, &camera),
            boxes: TriangleBoxes::new(&model.mesh)?,
            four: bvh.collapse(&collapse),
            eight: bvh.collapse(&collapse),
            sixteen: bvh.collapse(&collapse),
            model,
            camera,
        };
        console.clear();
        Ok(Some(scene))
    }

    /// The rays of a picture of `width` x `height` paths with so many bounces at most: a batch for each bounce, and that of the eye
    /// rays before them. Shadow rays are left out.
    pub fn rays(&self, [width, height]: [usize; 2], bounces: u32, task: &Task<'_>) -> Result<Vec<RayBatch>, Error> {
        let integrator = Integrator::Path(Path { bounces, ..Path::default() });
        let config = Config { integrator, batch: width * height, ..Config::new(width, height) };
        task.console.stage(&format!("{}: making rays", self.name), 0);
        let method = Auto::new(&self.eight, config.level);
        let mut batches = vec![RayBatch::new(); bounces as usize + 1];
        let mut observer = |depth: usize, query: Query, rays: &RayBatch| {
            if query == Query::Closest {
                batches[depth] = rays.clone();
            }
        };
        let mut cx = Context { counters: None, cancel: Some(task.console.cancel()) };
        let means = Means { method: &method, cx: &mut cx, observer: Some(&mut observer), progress: &Silent };
        integrator::render(&self.model, &self.scenery, self.camera, &config, means)?;
        task.console.clear();
        Ok(batches)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_in_order() {
        assert_eq!(Name::chosen(&[Name::Hairball, Name::Conference]), [Name::Conference, Name::Hairball]);
        assert_eq!(Name::chosen(&[]).len(), 3);
        for (i, name) in Name::chosen(&[]).into_iter().enumerate() {
            assert_eq!(name as usize, i);
        }
    }

    /// A batch for each bounce; paths get fewer, and there is one for each pixel in the beginning.
    #[test]
    fn rays_of_a_picture() {
        let console = Console::default();
        let task = Task::new([16, 12], 1, true, &console).expect("threads");
        let scene = Scene::open(Name::Hairball, true, &console).expect("made").expect("built in");
        let rays = scene.rays(task.size, 3, &task).expect("traced");
        let counts: Vec<usize> = rays.iter().map(RayBatch::len).collect();
        assert_eq!((counts.len(), counts[0]), (4, 16 * 12));
        assert!(counts.is_sorted_by(|a, b| a >= b) && counts[1] > 0, "{counts:?}");
    }
}
