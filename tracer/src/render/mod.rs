//! Pictures, in three passes over the whole image (Geimer & Müller 2003, section 3.1): eye rays, closest hits, shading.
//! With secondary rays: [`integrator`].

mod environment;
mod eye;
mod image;
pub mod integrator;
mod lights;
mod material;
mod sampler;
mod scenery;
mod shade;
mod textures;
mod tone;

pub use environment::{Environment, Up};
pub use eye::EyeRays;
pub use image::Image;
pub use sampler::Sampler;
pub use scenery::Scenery;
pub use shade::{Lighting, Surfaces};
pub use tone::Tone;

use crate::Error;
use crate::geometry::{HitBatch, RayBatch};
use crate::lanes::Width;
use crate::method::{BitVec, Context, Method};
use crate::model::{Camera, Light, Model};
use simd::Level;

/// What to render with.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// Image width in pixels.
    pub width: usize,
    /// Image height in pixels.
    pub height: usize,
    /// Level of the first and third pass, which use its registers whole; the second has its own, the method's.
    pub level: Level,
    /// [`Width::One`] to do these passes one pixel at a time, in plain `f32`.
    pub lanes: Width,
    /// Whether lights cast shadows.
    pub shadows: bool,
}

/// The state between the three passes of one picture. Call them in order, or [`render`] for all of them.
#[derive(Debug)]
pub struct Frame<'a> {
    settings: Settings,
    camera: Camera,
    lighting: Lighting,
    surfaces: &'a Surfaces,
    eye: EyeRays,
    hits: HitBatch,
    /// Per light, the points it does not reach.
    shadows: Vec<BitVec>,
}

impl<'a> Frame<'a> {
    /// Before the first pass. Lights default to a headlight at the eye.
    #[must_use]
    pub fn new(scene: &Model, surfaces: &'a Surfaces, camera: Camera, settings: Settings) -> Self {
        let lights: Vec<Light> = scene.lights_or_headlight(&camera);
        Self {
            settings,
            camera,
            lighting: Lighting { lights, ambient: scene.ambient, background: scene.background },
            surfaces,
            eye: EyeRays::default(),
            hits: HitBatch::new(),
            shadows: Vec::new(),
        }
    }

    /// First pass: a ray through the middle of each pixel.
    pub fn eye_rays(&mut self) {
        let Settings { width, height, level, lanes, .. } = self.settings;
        self.eye = EyeRays::new(&self.camera, width, height, level, lanes);
    }

    /// Second pass: what each of them meets; and for shadows, which lights reach that point.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub fn cast(&mut self, method: &dyn Method, cx: &mut Context<'_>) -> Result<(), Error> {
        method.closest(self.eye.rays(), &mut self.hits, cx)?;
        if self.settings.shadows {
            self.shadows.resize(self.lighting.lights.len(), BitVec::new());
            for (light, dark) in self.lighting.lights.iter().zip(&mut self.shadows) {
                let rays =
                    shade::shadow_rays(self.eye.rays(), &self.hits, light, self.settings.level, self.settings.lanes);
                method.any(&rays, dark, cx)?;
            }
        }
        Ok(())
    }

    /// Third pass: the picture.
    ///
    /// # Errors
    /// [`Error::Cancelled`].
    pub fn shade(&self, cx: &Context<'_>) -> Result<Image, Error> {
        let Settings { level, lanes, .. } = self.settings;
        let colors = shade::shade(&shade::Job {
            rays: self.eye.rays(),
            hits: &self.hits,
            lighting: &self.lighting,
            surfaces: self.surfaces,
            shadows: &self.shadows,
            level,
            lanes,
            cx,
        })?;
        Ok(self.eye.to_image(&colors))
    }

    /// The rays of the first pass.
    #[must_use]
    pub fn rays(&self) -> &RayBatch {
        self.eye.rays()
    }

    /// The hits of the second pass.
    #[must_use]
    pub fn hits(&self) -> &HitBatch {
        &self.hits
    }
}

/// All three passes.
///
/// # Errors
/// [`Error::Cancelled`].
pub fn render(
    scene: &Model,
    surfaces: &Surfaces,
    camera: Camera,
    settings: Settings,
    method: &dyn Method,
    cx: &mut Context<'_>,
) -> Result<Image, Error> {
    let mut frame = Frame::new(scene, surfaces, camera, settings);
    frame.eye_rays();
    frame.cast(method, cx)?;
    frame.shade(cx)
}
