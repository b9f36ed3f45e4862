//! Light sources.

/// A point light without falloff, as the SPD scenes have them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Where it stands.
    pub position: [f32; 3],
    /// Linear RGB intensity.
    pub intensity: [f32; 3],
}
