//! Surfaces.

/// Coefficients of the Phong reflection model, linear RGB.
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
}

impl Material {
    /// What surfaces look like about which nothing is said: light grey, without highlight.
    #[must_use]
    pub fn grey(name: &str) -> Self {
        Self { name: name.into(), ambient: [0.0; 3], diffuse: [0.7; 3], specular: [0.0; 3], shininess: 10.0 }
    }
}
