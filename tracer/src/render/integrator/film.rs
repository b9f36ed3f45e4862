//! The sums that a picture is made of.

use super::{Config, Crop, Rendering, Times};
use crate::render::Image;
use crate::render::material::luminance_of;

/// What is known of a picture so far: sums over the samples of each pixel, in their order. A picture that goes on with it has the same bits as one
/// made at once: [`resume`](super::resume).
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    pub(super) crop: Crop,
    /// Pixels times samples, in the order of rays: whole samples, then maybe the first pixels of one more.
    pub(super) done: u64,
    pub(super) sums: Vec<[f32; 3]>,
    /// Of the luminance: the mean, and the sum of squared deviations from it.
    pub(super) luminance: Vec<[f64; 2]>,
    /// Rays of each pixel; empty where they are not counted.
    pub(super) rays: Vec<u32>,
}

impl Film {
    /// Without any sample yet, for a picture that is sound ([`Config::validate`]).
    #[must_use]
    pub fn new(config: &Config) -> Self {
        let crop = config.part();
        let n = crop.width * crop.height;
        let rays = if config.count_rays { vec![0; n] } else { Vec::new() };
        Self { crop, done: 0, sums: vec![[0.0; 3]; n], luminance: vec![[0.0; 2]; n], rays }
    }

    /// Samples that all pixels have.
    #[must_use]
    pub fn samples(&self) -> u32 {
        (self.done / self.pixels()) as u32
    }

    /// Pixels times samples that are done: whole samples, and a part of the next one.
    #[must_use]
    pub fn done(&self) -> u64 {
        self.done
    }

    pub(super) fn pixels(&self) -> u64 {
        self.sums.len() as u64
    }

    /// Pixels that have one sample more than the others.
    pub(super) fn ahead(&self) -> usize {
        (self.done % self.pixels()) as usize
    }

    /// One more sample of these pixels, which are the next: the light, and the number of rays if they are counted.
    pub(super) fn add(&mut self, pixels: &[u32], radiance: &[[f32; 3]], rays: &[u32]) {
        let n = f64::from(self.samples()) + 1.0;
        for (i, (&pixel, rgb)) in pixels.iter().zip(radiance).enumerate() {
            let at = self.crop.place(pixel);
            let sum = &mut self.sums[at];
            *sum = [sum[0] + rgb[0], sum[1] + rgb[1], sum[2] + rgb[2]];
            // Without the difference of two large numbers (Welford 1962, "Note on a Method for Calculating Corrected Sums of Squares and Products").
            let luminance = f64::from(luminance_of(*rgb));
            let [mean, squares] = &mut self.luminance[at];
            let off = luminance - *mean;
            *mean += off / n;
            *squares += off * (luminance - *mean);
            if let Some(sum) = self.rays.get_mut(at) {
                *sum = sum.saturating_add(rays[i]);
            }
        }
        self.done += pixels.len() as u64;
    }

    /// The picture of the whole samples; there must be one, and no part of another.
    pub(super) fn rendering(&self, times: Times) -> Rendering {
        debug_assert!(self.samples() > 0 && self.ahead() == 0);
        let samples = self.samples();
        let n = samples as f32;
        let pixels = self.sums.iter().map(|sum| sum.map(|c| c / n)).collect();
        let scale = f64::from(samples) * (f64::from(samples) - 1.0).max(1.0);
        let variance = self.luminance.iter().map(|[_, squares]| (squares / scale) as f32).collect();
        let image = Image { width: self.crop.width, height: self.crop.height, pixels };
        Rendering { image, samples, variance, rays: self.rays.clone(), times }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Noise far below the light itself, where the mean of squares less the square of the mean has no digit left.
    #[test]
    fn variance_of_faint_noise() {
        let mut film = Film::new(&Config::new(2, 1));
        let mut expected = 0.0;
        let ulp = f64::from(f32::EPSILON) * 512.0;
        for i in 0..100 {
            // Steps of the last bit of 1000, to both sides.
            let step = [0.0, 2.0, -2.0, 1.0, -1.0][i % 5];
            let light = 1000.0 + (step * ulp) as f32;
            let luminance = luminance_of([light; 3]);
            expected += (f64::from(luminance) - f64::from(luminance_of([1000.0; 3]))).powi(2);
            film.add(&[0, 1], &[[light; 3], [1000.0; 3]], &[]);
        }
        let variance = film.rendering(Times::default()).variance;
        let expected = (expected / (100.0 * 99.0)) as f32;
        assert!(expected > 0.0 && (variance[0] / expected - 1.0).abs() < 0.05, "{variance:?}, not {expected}");
        assert_eq!(variance[1], 0.0);
    }
}
