//! What rays are shaded with.

use super::lights::{Lights, corner_and_edges};
use super::{Environment, Surfaces};
use crate::geometry::Vec3;
use crate::model::{Camera, Light, Material, Model, Reflection};
use simd::{Mask, Vector};

/// A scene laid out for shading secondary rays: corners, normals and materials of its triangles to gather from, and its light sources.
///
/// Materials are made to conserve energy: colours of surfaces are cut to the range from 0 to 1, and of a mirror the diffuse and the specular
/// colour are scaled down where their sum is above 1.
#[derive(Debug, Clone)]
pub struct Scenery {
    pub(super) surfaces: Surfaces,
    /// Nine words for each triangle: a corner and the two edges from there.
    pub(super) corners: Vec<f32>,
    /// [`Scenery::MATERIAL`] words for each material.
    pub(super) materials: Vec<f32>,
    /// Of each material: 0 Lambertian, 1 glossy, 2 mirror, 3 dielectric.
    pub(super) models: Vec<u32>,
    /// Points, or a headlight where nothing shines.
    pub(super) points: Vec<Light>,
    /// All light sources.
    pub(super) lights: Lights,
    /// Those that are no points.
    pub(super) lamps: Lights,
    pub(super) ambient: f32,
    pub(super) environment: [f32; 3],
    /// In place of the environment's one colour.
    pub(super) map: Option<Environment>,
    /// Farther than the scene is wide.
    pub(super) reach: f32,
}

impl Scenery {
    /// Diffuse, specular, exponent, transmission, index of refraction, emission, ambient.
    pub(super) const MATERIAL: u32 = 17;

    /// Of a valid model ([`Model::validate`]). Where there are no lights and nothing shines, a light stands at the eye.
    #[must_use]
    pub fn new(model: &Model, camera: &Camera) -> Self {
        Self::with(model, Some(camera), None)
    }

    /// Of a valid model ([`Model::validate`]), with a map around it: a light source like others, in place of the model's background. Mirrors show it,
    /// but it does not light what is matt of them.
    #[must_use]
    pub fn in_environment(model: &Model, map: Environment) -> Self {
        Self::with(model, None, Some(map))
    }

    fn with(model: &Model, headlight: Option<&Camera>, map: Option<Environment>) -> Self {
        let mesh = &model.mesh;
        let corners = (0..mesh.triangles.len()).flat_map(|i| corner_and_edges(mesh.triangle(i)).into_iter().flatten());
        let bounds = mesh.bounds();
        let square = |axis: usize| f64::from(bounds.max[axis] - bounds.min[axis]).powi(2);
        let radius = 0.5 * (square(0) + square(1) + square(2)).sqrt();
        let lamps = Lights::new(&[], model, radius, 0.0);
        let points = match headlight {
            Some(camera) if lamps.is_empty() => model.lights_or_headlight(camera),
            _ => model.lights.clone(),
        };
        Self {
            surfaces: Surfaces::new(model),
            corners: corners.collect(),
            materials: model.materials.iter().flat_map(words).collect(),
            models: model.materials.iter().map(|m| number(m.reflection)).collect(),
            lights: Lights::new(&points, model, radius, map.as_ref().map_or(0.0, Environment::weight)),
            lamps,
            points,
            ambient: model.ambient,
            environment: model.background,
            map,
            reach: (4.0 * radius).clamp(1e-15, 1e15) as f32,
        }
    }

    /// Diffuse and specular colour of a material together under this tint, at most 1; white for glass.
    pub(super) fn albedo(&self, material: u32, tint: Vec3<f32>) -> [f32; 3] {
        if self.models[material as usize] == number(Reflection::Dielectric) {
            return [1.0; 3];
        }
        let words = &self.materials[(material * Self::MATERIAL) as usize..];
        let specular = Vec3 { x: words[3], y: words[4], z: words[5] };
        let specular = match self.surfaces.textures.is_empty() {
            true => specular,
            false => {
                let (material, on) = (<f32 as Vector>::Index::splat(material), <f32 as Vector>::Mask::splat(true));
                self.surfaces.textures.specular(specular, tint, material, on)
            }
        };
        [words[0] * tint.x + specular.x, words[1] * tint.y + specular.y, words[2] * tint.z + specular.z]
            .map(|c| c.min(1.0))
    }

    /// What rays see that hit nothing, in words that tell one environment from another.
    pub(super) fn environment_text(&self) -> String {
        let [r, g, b] = self.environment;
        self.map.as_ref().map_or_else(|| format!("{r},{g},{b}"), |map| map.text().to_owned())
    }

    /// With light of one colour from all directions in place of the model's background. Without effect where there is a map.
    #[must_use]
    pub fn with_environment(self, environment: [f32; 3]) -> Self {
        Self { environment, ..self }
    }
}

fn number(reflection: Reflection) -> u32 {
    match reflection {
        Reflection::Lambertian => 0,
        Reflection::Glossy => 1,
        Reflection::Mirror => 2,
        Reflection::Dielectric => 3,
    }
}

fn words(m: &Material) -> Vec<f32> {
    let cut = |c: [f32; 3]| c.map(|c| c.clamp(0.0, 1.0));
    let (mut diffuse, mut specular) = (cut(m.diffuse), cut(m.specular));
    if m.reflection == Reflection::Mirror {
        for (d, s) in diffuse.iter_mut().zip(&mut specular) {
            let sum = (*d + *s).max(1.0);
            *d /= sum;
            *s /= sum;
        }
    }
    let mut words: Vec<f32> = diffuse.into_iter().chain(specular).chain([m.shininess]).collect();
    words.extend(cut(m.transmission));
    words.push(m.ior);
    words.extend(m.emission.map(|c| c.max(0.0)));
    words.extend(m.ambient);
    words
}

/// How far from a triangle rays start that leave it, along its normal: by more than what rounding may move the start and the plane that a ray is tested
/// against. Both are sums of a few products of these numbers, each rounded to 2^-24 of the largest; 2^-18 of it is sixty-four of them.
pub(super) const OFFSET: f32 = 1.0 / 262_144.0;

pub(super) fn offset_of(v0: [f32; 3], e1: [f32; 3], e2: [f32; 3]) -> f32 {
    let largest = |v: [f32; 3]| v.into_iter().fold(0.0_f32, |most, c| most.max(c.abs()));
    (largest(v0) + largest(e1) + largest(e2)) * OFFSET
}
