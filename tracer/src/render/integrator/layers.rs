//! What is seen through the middle of each pixel: what a denoiser or a compositor wants to know.

use super::place::Place;
use super::{Config, camera};
use crate::Error;
use crate::geometry::{HitBatch, Vec3};
use crate::method::{Context, Method};
use crate::model::Camera;
use crate::render::Scenery;

/// Of each pixel of the part that is wanted, row by row from its top left.
#[derive(Debug, Clone, Default)]
pub struct Layers {
    /// Distance from the eye, in units of the scene; infinite where nothing is hit.
    pub depth: Vec<f32>,
    /// Unit normal to shade with, on the side of the eye; zero where nothing is hit.
    pub normal: Vec<[f32; 3]>,
    /// Diffuse and specular colour together, at most 1; white for glass; zero where nothing is hit.
    pub albedo: Vec<[f32; 3]>,
    /// Triangle; [`Hit::NO_PRIMITIVE`](crate::geometry::Hit::NO_PRIMITIVE) where nothing is hit.
    pub primitive: Vec<u32>,
    /// Material; `u32::MAX` where nothing is hit.
    pub material: Vec<u32>,
}

impl Layers {
    /// Of a picture of this size and part.
    ///
    /// # Errors
    /// [`Error::Usage`] when the part or the size makes no sense; [`Error::Cancelled`].
    pub fn new(
        scenery: &Scenery,
        camera: &Camera,
        config: &Config,
        method: &dyn Method,
        cx: &mut Context<'_>,
    ) -> Result<Self, Error> {
        config.validate()?;
        let crop = config.part();
        let pixels = camera::pixels(&crop);
        let rays = camera::rays(&Config { samples: 1, ..*config }, camera, &pixels, 0);
        let mut hits = HitBatch::new();
        method.closest(&rays, &mut hits, cx)?;

        let n = pixels.len();
        let (depth, primitive) = (vec![f32::INFINITY; n], vec![u32::MAX; n]);
        let (normal, albedo, material) = (vec![[0.0; 3]; n], vec![[0.0; 3]; n], vec![u32::MAX; n]);
        let mut layers = Self { depth, normal, albedo, primitive, material };
        for (i, pixel) in pixels.iter().enumerate() {
            let hit = hits.get(i);
            if hit.is_miss() {
                continue;
            }
            let place = Place::<f32>::load(scenery, &rays.blocks()[i / 16], &hits.blocks()[i / 16], i % 16);
            let at = crop.place(*pixel);
            let material = place.material.0;
            let textures = &scenery.surfaces.textures;
            let tint = match textures.is_empty() {
                true => Vec3::splat([1.0; 3]),
                false => place.tint(textures, &hits.blocks()[i / 16], i % 16),
            };
            layers.depth[at] = place.distance;
            layers.normal[at] = [place.normal.x, place.normal.y, place.normal.z];
            layers.albedo[at] = scenery.albedo(material, tint);
            layers.primitive[at] = hit.primitive;
            layers.material[at] = material;
        }
        Ok(layers)
    }
}
