//! Surfaces.

use super::Texture;
use std::sync::Arc;

/// How a surface reflects light in pictures with secondary rays. ([`render`](crate::render::render), the picture of three passes, knows
/// Phong's model alone.)
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Reflection {
    /// Matt: [`Material::diffuse`] in all directions alike.
    #[default]
    Lambertian,
    /// A matt ground under a glossy coat: [`Material::specular`] is the coat's reflectance seen straight on, [`Material::shininess`] the
    /// exponent of its Phong lobe.
    Glossy,
    /// A mirror that reflects [`Material::specular`]; lights show on it as Blinn-Phong highlights, and on its [`Material::diffuse`].
    Mirror,
    /// Clear glass of [`Material::ior`]; what goes through is multiplied by [`Material::transmission`].
    Dielectric,
}

/// A surface, linear RGB.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// MTL name, for messages.
    pub name: String,
    /// Ka: of the ambient light ([`Model::ambient`](super::Model::ambient)).
    pub ambient: [f32; 3],
    /// Kd.
    pub diffuse: [f32; 3],
    /// Ks of the highlight.
    pub specular: [f32; 3],
    /// Ns, the highlight's exponent.
    pub shininess: f32,
    /// Ke: the radiance that it sends out to both sides, in all directions alike.
    pub emission: [f32; 3],
    /// Ni, the index of refraction on the side where its triangles' corners run clockwise.
    pub ior: f32,
    /// Tf: the part of the light that passes through a dielectric's surface, once it is not reflected.
    pub transmission: [f32; 3],
    /// illum: which of these take part in secondary rays, and how.
    pub reflection: Reflection,
    /// map_Kd: multiplies [`Material::diffuse`] and [`Material::ambient`] where triangles have texture coordinates ([`Mesh::uv_indices`](super::Mesh::uv_indices)).
    pub texture: Option<Arc<Texture>>,
    /// Whether it multiplies [`Material::specular`] too, as on metals.
    pub texture_on_specular: bool,
}

impl Material {
    /// What surfaces look like about which nothing is said: light grey, without highlight.
    #[must_use]
    pub fn grey(name: &str) -> Self {
        Self::matt(name, [0.7; 3])
    }

    /// A matt surface.
    ///
    /// ```
    /// use tracer::model::{Material, Reflection};
    ///
    /// let lamp = Material { emission: [10.0; 3], ..Material::matt("lamp", [0.0; 3]) };
    /// assert_eq!(lamp.reflection, Reflection::Lambertian);
    /// ```
    #[must_use]
    pub fn matt(name: &str, diffuse: [f32; 3]) -> Self {
        Self {
            name: name.into(),
            ambient: [0.0; 3],
            diffuse,
            specular: [0.0; 3],
            shininess: 10.0,
            emission: [0.0; 3],
            ior: 1.5,
            transmission: [1.0; 3],
            reflection: Reflection::Lambertian,
            texture: None,
            texture_on_specular: false,
        }
    }
}
