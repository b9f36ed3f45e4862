//! Surfaces.

/// Coefficients of the Phong reflection model, linear RGB.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// MTL name, for messages.
    pub name: String,
    /// Ka: of the ambient light (white, intensity 1).
    pub ambient: [f32; 3],
    /// Kd.
    pub diffuse: [f32; 3],
    /// Ks of the highlight.
    pub specular: [f32; 3],
    /// Ns, the highlight's exponent.
    pub shininess: f32,
}
