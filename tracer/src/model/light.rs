//! Light sources.

/// A point light without falloff, as the SPD scenes have them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Where it stands.
    pub position: [f32; 3],
    /// Linear RGB: the radiance of a white matt surface that faces it (its irradiance over pi), the same at any distance.
    pub intensity: [f32; 3],
}
