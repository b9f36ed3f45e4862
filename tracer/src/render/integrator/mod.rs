//! Pictures by many rays for each pixel, in waves: all rays of a bounce are traced together, then all hits are shaded together, then those
//! paths that go on move up.

mod ao;
mod camera;
mod checkpoint;
mod columns;
mod film;
mod groups;
mod layers;
mod lists;
mod place;
mod shade;
mod sky;
mod times;
mod wave;

pub use camera::Crop;
pub use checkpoint::Identity;
pub use film::Film;
pub use layers::Layers;
pub use times::{Bounce, Means, Observer, Query, Times};

use super::{Frame, Image, Scenery, Settings};
use crate::Error;
use crate::lanes::Width;
use crate::model::{Camera, Model};
use simd::Level;
use std::time::Duration;

/// How light is followed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Integrator {
    /// The picture of three passes, one ray for each pixel: [`render`](crate::render::render).
    Eye {
        /// Whether lights cast shadows.
        shadows: bool,
    },
    /// Mirrors and glass, every point light, one place on lamps (Whitted 1980, "An Improved Illumination Model for Shaded Display").
    Whitted {
        /// Reflections and refractions at most.
        bounces: u32,
    },
    /// How much of the sky each point sees, as grey; what hits nothing is white.
    AmbientOcclusion {
        /// How far rays go, in units of the scene; infinite for any distance.
        distance: f32,
    },
    /// Path tracing, with one light source chosen at each hit (Kajiya 1986, "The Rendering Equation").
    Path(Path),
}

/// Options of path tracing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Path {
    /// Reflections at most: with 2, "we shoot one level of primary rays, two reflection rays, and three sets of shadow rays" (Boulos 2008,
    /// section 5).
    pub bounces: u32,
    /// Whether paths end by chance from the third reflection on, the rest weighing more. The mean is that of all `bounces`.
    pub roulette: bool,
    /// Whether light is also found by chance, both ways weighted (multiple importance sampling, Veach 1997): less noise where surfaces are
    /// glossy and lamps are large.
    pub mis: bool,
    /// Whether glossy surfaces send rays into the lobe of their coat alone, as in the paper (Boulos 2008, section 5): what their ground reflects
    /// of other surfaces is missing then.
    pub coat_alone: bool,
}

impl Default for Path {
    fn default() -> Self {
        Self { bounces: 2, roulette: false, mis: false, coat_alone: false }
    }
}

/// A picture to be made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Config {
    /// How light is followed.
    pub integrator: Integrator,
    /// Width of the whole picture in pixels, at most 65,535.
    pub width: usize,
    /// Height of the whole picture in pixels, at most 65,535.
    pub height: usize,
    /// The part of it that is wanted. Its pixels are those of the whole picture, bit for bit.
    pub crop: Option<Crop>,
    /// Paths for each pixel; a single one goes through the middle.
    pub samples: u32,
    /// No sample is begun after this time; the first is always taken. The picture is that of as many samples, bit for bit. (WebAssembly in a browser has
    /// no clock: there is no limit there.)
    pub time_limit: Option<Duration>,
    /// Of the random numbers.
    pub seed: u64,
    /// Of what is not done by the method: the same picture by all.
    pub level: Level,
    /// [`Width::One`] to do that one ray at a time, in plain `f32`.
    pub lanes: Width,
    /// Whether hits are shaded together by the model of their material (Boulos 2008, section 4.6): the same picture, another speed.
    pub group_shading: bool,
    /// Whether the rays of each pixel are counted: [`Rendering::rays`].
    pub count_rays: bool,
    /// Paths at once; each takes some 300 bytes.
    pub batch: usize,
}

impl Config {
    /// Path tracing with one sample, at the best level.
    #[must_use]
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            integrator: Integrator::Path(Path::default()),
            width,
            height,
            crop: None,
            samples: 1,
            time_limit: None,
            seed: 0,
            level: Level::best(),
            lanes: Width::Auto,
            group_shading: true,
            count_rays: false,
            batch: 1 << 20,
        }
    }

    /// The part that is wanted, or the whole.
    pub(super) fn part(&self) -> Crop {
        self.crop.unwrap_or(Crop { x: 0, y: 0, width: self.width, height: self.height })
    }

    /// # Errors
    /// [`Error::Usage`] for what makes no sense.
    pub fn validate(&self) -> Result<(), Error> {
        let usage = |message: String| Err(Error::Usage(message));
        let most = usize::from(u16::MAX);
        if !(1..=most).contains(&self.width) || !(1..=most).contains(&self.height) {
            return usage(format!("a picture of {}x{} pixels: give 1 to {most} each way", self.width, self.height));
        }
        if self.samples == 0 || self.batch == 0 {
            return usage("a picture needs at least one sample for each pixel, and one path at once".into());
        }
        if let Some(Crop { x, y, width, height }) = self.crop {
            let inside = |at: usize, size: usize, all| size > 0 && at.checked_add(size).is_some_and(|end| end <= all);
            if !inside(x, width, self.width) || !inside(y, height, self.height) {
                let (w, h) = (self.width, self.height);
                return usage(format!(
                    "the part {x},{y},{width},{height} is not inside of a picture of {w}x{h} pixels"
                ));
            }
        }
        match self.integrator {
            Integrator::Eye { .. } if self.samples > 1 || self.crop.is_some() => usage(
                "the picture of three passes has one sample for each pixel and no crop: choose another integrator"
                    .into(),
            ),
            Integrator::Path(Path { mis: true, coat_alone: true, .. }) => usage(
                "multiple importance sampling needs the whole of glossy surfaces, not their coat alone: choose one"
                    .into(),
            ),
            Integrator::AmbientOcclusion { distance } if distance.is_nan() || distance <= 0.0 => {
                usage(format!("ambient occlusion up to a distance of {distance}: give a number above 0"))
            }
            _ => Ok(()),
        }
    }
}

/// A finished picture.
#[derive(Debug, Clone)]
pub struct Rendering {
    /// The mean of the samples.
    pub image: Image,
    /// Their number: less than was asked for where a time limit ended it.
    pub samples: u32,
    /// Of each pixel, how far the mean may be off: the variance of the mean's luminance, estimated from the samples; zero for a single one.
    pub variance: Vec<f32>,
    /// Of each pixel, the rays that were traced for all its samples; empty unless [`Config::count_rays`] asks for it.
    pub rays: Vec<u32>,
    /// What it took, from where it was resumed.
    pub times: Times,
}

/// Makes a picture: the same bits by every method, at every level, and on any number of threads of the current rayon pool.
///
/// ```
/// use tracer::bvh::{BuildConfig, Bvh};
/// use tracer::method::{Context, Packet, Width};
/// use tracer::model::Model;
/// use tracer::progress::Silent;
/// use tracer::render::{Scenery, integrator::{self, Config, Integrator, Means, Path}};
///
/// # fn main() -> Result<(), tracer::Error> {
/// let (model, _) = Model::open("balls:1", &Silent)?;
/// let camera = model.camera_or_default();
/// let scenery = Scenery::new(&model, &camera);
/// let bvh = Bvh::build(&model.mesh, &BuildConfig::default(), &Silent)?;
/// let config = Config { samples: 4, ..Config::new(32, 32) };
/// let method = Packet::new(&bvh, config.level, Width::Auto);
/// let means = Means { method: &method, cx: &mut Context::default(), observer: None, progress: &Silent };
/// let rendering = integrator::render(&model, &scenery, camera, &config, means)?;
/// assert_eq!(rendering.image.pixels.len(), 32 * 32);
/// assert_eq!(rendering.times.bounces[0].closest, 4 * 32 * 32);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// [`Error::Usage`] for what makes no sense; [`Error::Cancelled`].
pub fn render(
    model: &Model,
    scenery: &Scenery,
    camera: Camera,
    config: &Config,
    means: Means<'_, '_>,
) -> Result<Rendering, Error> {
    config.validate()?;
    camera.validate()?;
    let Integrator::Eye { shadows } = config.integrator else {
        return resume(scenery, camera, config, means, &mut Film::new(config), &mut |_| Ok(()));
    };
    let Config { width, height, level, lanes, .. } = *config;
    let settings = Settings { width, height, level, lanes, shadows };
    let mut times = Times::default();
    let mut frame = Frame::new(model, &scenery.surfaces, camera, settings);
    times::timed(&mut times.generation, || frame.eye_rays());
    if let Some(observer) = means.observer {
        observer(0, Query::Closest, frame.rays());
    }
    times::timed(&mut times.traversal, || frame.cast(means.method, means.cx))?;
    let image = times::timed(&mut times.shading, || frame.shade(means.cx))?;
    let hits = frame.hits().iter().filter(|hit| !hit.is_miss()).count();
    let any = if shadows { hits * model.lights_or_headlight(&camera).len() } else { 0 };
    *times.bounce(0) = Bounce { closest: (width * height) as u64, any: any as u64 };
    Ok(Rendering { variance: vec![0.0; image.pixels.len()], rays: Vec::new(), image, samples: 1, times })
}

/// Told how far a picture has come, after each batch of paths; an error ends the work.
pub type After<'a> = dyn FnMut(&Film) -> Result<(), Error> + 'a;

/// [`render`] with secondary rays, going on from a film: one of this picture ([`Film::new`], [`Film::load`]) that has no more samples than are asked
/// for. Whatever ends the work, the film can be gone on with, and the finished picture has the bits of one made at once.
///
/// ```
/// use tracer::bvh::{BuildConfig, Bvh};
/// use tracer::method::{Context, Packet, Width};
/// use tracer::model::Model;
/// use tracer::progress::Silent;
/// use tracer::render::{Scenery, integrator::{self, Config, Film, Identity, Means}};
///
/// # fn main() -> Result<(), tracer::Error> {
/// # let (model, _) = Model::open("balls:1", &Silent)?;
/// # let camera = model.camera_or_default();
/// # let scenery = Scenery::new(&model, &camera);
/// # let bvh = Bvh::build(&model.mesh, &BuildConfig::default(), &Silent)?;
/// # let path = std::env::temp_dir().join(format!("checkpoint-{}", std::process::id()));
/// let config = Config { samples: 4, ..Config::new(32, 32) };
/// let identity = Identity::new(&model, &scenery, &camera, &config);
/// let mut film = if path.exists() { Film::load(&path, &identity, &config)? } else { Film::new(&config) };
/// # let method = Packet::new(&bvh, config.level, Width::Auto);
/// let means = Means { method: &method, cx: &mut Context::default(), observer: None, progress: &Silent };
/// let mut keep = |film: &Film| film.save(&path, &identity);
/// let rendering = integrator::resume(&scenery, camera, &config, means, &mut film, &mut keep)?;
/// assert_eq!(rendering.samples, 4);
/// # std::fs::remove_file(&path).expect("it is there");
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// [`Error::Usage`] for what makes no sense, the picture of three passes and the film of another picture among it; [`Error::Cancelled`]; what `after`
/// returns.
pub fn resume(
    scenery: &Scenery,
    camera: Camera,
    config: &Config,
    means: Means<'_, '_>,
    film: &mut Film,
    after: &mut After<'_>,
) -> Result<Rendering, Error> {
    config.validate()?;
    camera.validate()?;
    if let Integrator::Eye { .. } = config.integrator {
        return Err(Error::Usage("the picture of three passes is made at once: choose another integrator".into()));
    }
    if film.crop != config.part() || film.done > film.pixels() * u64::from(config.samples) {
        return Err(Error::Usage("the film is of another picture, or has more samples: begin with a new one".into()));
    }
    if config.count_rays && film.rays.is_empty() {
        return Err(Error::Usage("the film does not count rays: begin with a new one".into()));
    }
    // Once counted, counted on.
    let config = Config { count_rays: !film.rays.is_empty(), ..*config };
    wave::render(scenery, &camera, &config, means, film, after)
}
