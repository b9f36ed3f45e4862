//! What each pixel took, in false colours: `tracer render --cost`.

use crate::picture;
use serde::Serialize;
use std::path::{Path, PathBuf};
use tracer::Error;
use tracer::render::integrator::Rendering;

/// What was written.
#[derive(Serialize)]
pub struct Cost {
    output: PathBuf,
    /// Of one pixel, all samples together.
    most_rays: u32,
}

impl Cost {
    /// Writes the number of rays of each pixel, from black for none to pale yellow for the most.
    pub fn write(rendering: &Rendering, path: &Path) -> Result<Self, Error> {
        let most_rays = rendering.rays.iter().copied().max().unwrap_or(0);
        let pixels: Vec<u8> = rendering.rays.iter().flat_map(|&rays| color(rays, most_rays)).collect();
        picture::write_rgb8(rendering.image.width, rendering.image.height, &pixels, path)?;
        Ok(Self { output: path.to_owned(), most_rays })
    }

    /// A line.
    pub fn text(&self) -> String {
        format!("cost      {}, up to {} rays for a pixel\n", self.output.display(), self.most_rays)
    }
}

/// Five colours of the scale "inferno", and what is between them, in whole numbers.
fn color(rays: u32, most: u32) -> [u8; 3] {
    const SCALE: [[u64; 3]; 5] = [[0, 0, 4], [87, 16, 110], [188, 55, 84], [249, 142, 9], [252, 255, 164]];
    let (rays, most) = (4 * u64::from(rays), u64::from(most.max(1)));
    let from = (rays / most).min(3);
    let rest = rays - from * most;
    let [a, b] = [SCALE[from as usize], SCALE[from as usize + 1]];
    [0, 1, 2].map(|k| ((a[k] * (most - rest) + b[k] * rest) / most) as u8)
}

#[cfg(test)]
mod tests {
    use super::color;

    #[test]
    fn from_black_to_yellow() {
        assert_eq!((color(0, 100), color(100, 100), color(50, 100)), ([0, 0, 4], [252, 255, 164], [188, 55, 84]));
        assert_eq!((color(0, 0), color(u32::MAX, u32::MAX)), ([0, 0, 4], [252, 255, 164]));
        let red = |rays| color(rays, 300)[0];
        assert!((0..300).all(|rays| red(rays) <= red(rays + 1)));
    }
}
