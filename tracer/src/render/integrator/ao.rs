//! Ambient occlusion: how much of the sky each point sees.

use super::columns::ROWS;
use super::lists::{Lists, Shadows, ten};
use super::place::Place;
use crate::geometry::{HitBlock, RayBlock, Vec3};
use crate::lanes::{self, Lanes};
use crate::render::Sampler;
use crate::render::material::{Frame, cosine_direction};
use crate::render::scenery::Scenery;
use simd::{Float, Integer, Mask, Vector};

/// Rays `first..first + len` of a wave, whose slots have the same numbers.
pub(super) struct Portion<'a> {
    pub(super) scenery: &'a Scenery,
    pub(super) sampler: Sampler,
    pub(super) sample: u32,
    pub(super) distance: f32,
    /// Of these rays.
    pub(super) pixels: &'a [u32],
    pub(super) first: usize,
    pub(super) rays: &'a [RayBlock],
    pub(super) hits: &'a [HitBlock],
}

impl Lanes for Portion<'_> {
    type Output = (Lists<3>, Shadows);

    /// The light of what hits nothing, and a ray for each hit, as dense as the cosine (Zhukov, Iones and Kronin 1998).
    #[inline(always)]
    fn run<F: Float>(self) -> (Lists<3>, Shadows) {
        let (mut light, mut shadows) = (Lists::new(), Lists::new());
        let len = self.pixels.len();
        debug_assert!(len <= ROWS);
        light.reserve(len);
        shadows.reserve(len);
        let white = Vec3::<F>::splat([1.0; 3]);
        let mut first = 0;
        while first < len {
            let (block, chunk) = (first / 16, first % 16 / F::LANES);
            let place = Place::<F>::load(self.scenery, &self.rays[block], &self.hits[block], chunk);
            let there = F::Mask::first_n(len - first);
            let row = F::Index::splat(1).prefix_sum_exclusive() + F::Index::splat((self.first + first) as u32);
            light.push(there & !place.hit, [white.x, white.y, white.z], row);

            let pixel = F::Index::load_partial(&self.pixels[first..]);
            let point = self.sampler.pair::<F>(pixel, self.sample, 1);
            let direction = Frame::around(place.normal).world(cosine_direction(point)).normalize();
            // What lies below the triangle is dark.
            let above = F::splat(0.0).lt(direction.dot(place.face));
            let ray = ten(place.start(), direction, white, F::splat(self.distance));
            shadows.push(there & place.hit & above, ray, row);
            first += F::LANES;
        }
        (light, shadows)
    }
}

/// Shades a portion.
pub(super) fn shade(level: simd::Level, width: lanes::Width, portion: Portion<'_>) -> (Lists<3>, Shadows) {
    lanes::run_long(level, width, portion)
}
