//! The finished picture.

use crate::hash::fnv1a;

/// Linear RGB pixels, row by row from the top left.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// `width * height` pixels.
    pub pixels: Vec<[f32; 3]>,
}

impl Image {
    /// Eight bits per channel, sRGB encoded (IEC 61966-2-1): `3 * width * height` bytes, the same on every machine.
    #[must_use]
    pub fn to_srgb8(&self) -> Vec<u8> {
        self.pixels.iter().flatten().map(|&c| srgb8(c)).collect()
    }

    /// A hash of all bits of all pixels.
    #[must_use]
    pub fn hash(&self) -> u64 {
        fnv1a(self.pixels.iter().flatten().map(|c| c.to_bits()))
    }
}

/// Linear to sRGB; out of range is clamped, NaN is black.
fn srgb8(linear: f32) -> u8 {
    let c = if linear > 0.0 { linear.min(1.0) } else { 0.0 };
    let encoded = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * simd::math::pow(c, 1.0 / 2.4) - 0.055 };
    (encoded * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::srgb8;

    #[test]
    fn srgb_of_known_values() {
        // 0.214 is the middle grey that displays as 0x80 (IEC 61966-2-1).
        let known = [(0.0, 0), (1.0, 255), (0.214_04, 127), (0.003, 10), (2.0, 255), (-1.0, 0), (f32::NAN, 0)];
        for (linear, expected) in known {
            assert!(srgb8(linear).abs_diff(expected) <= 1, "{linear}: {}", srgb8(linear));
        }
    }
}
