//! From light to what a screen can show.

use super::Image;
use super::material::luminance_of;
use std::str::FromStr;

/// How bright light is brought into the range of a screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tone {
    /// What is above 1 is cut.
    #[default]
    None,
    /// Luminance `l` becomes `l / (1 + l)` (Reinhard and others 2002, "Photographic Tone Reproduction for Digital Images", equation 3).
    Reinhard,
    /// A curve like that of the Academy Color Encoding System, for each channel (Narkowicz 2015, "ACES Filmic Tone Mapping Curve").
    Aces,
}

impl Tone {
    /// The picture multiplied by 2 to the power of `exposure` (stops) and mapped. Hashes and differences of pictures are those of the
    /// picture before.
    ///
    /// ```
    /// use tracer::render::{Image, Tone};
    /// let image = Image { width: 1, height: 1, pixels: vec![[1.0, 1.0, 1.0]] };
    /// assert!((Tone::Reinhard.map(&image, 1.0).pixels[0][0] - 2.0 / 3.0).abs() < 1e-6);
    /// ```
    #[must_use]
    pub fn map(self, image: &Image, exposure: f32) -> Image {
        let scale = simd::math::exp2(exposure);
        let pixels = image.pixels.iter().map(|rgb| self.of(rgb.map(|c| c * scale))).collect();
        Image { pixels, ..*image }
    }

    fn of(self, rgb: [f32; 3]) -> [f32; 3] {
        match self {
            Self::None => rgb,
            Self::Reinhard => {
                let luminance = luminance_of(rgb);
                rgb.map(|c| c / (1.0 + luminance))
            }
            Self::Aces => rgb.map(|c| (c * (2.51 * c + 0.03)) / (c * (2.43 * c + 0.59) + 0.14)),
        }
    }
}

impl FromStr for Tone {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "none" => Ok(Self::None),
            "reinhard" => Ok(Self::Reinhard),
            "aces" => Ok(Self::Aces),
            _ => Err(format!("unknown tone mapping '{name}'; known: none, reinhard, aces")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Brighter stays brighter, and what is mapped stays in the range of a screen.
    #[test]
    fn curves_rise() {
        for tone in [Tone::Reinhard, Tone::Aces] {
            let mut before = tone.of([0.0; 3])[0];
            assert_eq!(before, 0.0);
            for i in 1..100 {
                let [r, g, b] = tone.of([0.1 * i as f32; 3]);
                assert!(r > before && r == g && g == b && (tone == Tone::Aces || r < 1.0), "{tone:?}: {r}");
                before = r;
            }
            assert!(before > 0.9 && before < 1.04);
        }
        assert_eq!(Tone::None.of([0.5, 2.0, 9.0]), [0.5, 2.0, 9.0]);
        assert!("filmic".parse::<Tone>().is_err());
    }
}
