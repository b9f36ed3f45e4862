//! Light from an environment map: where rays leave the scene, and where it is chosen as a light source. Scenes without a map take none of
//! these steps.

use super::lists::DENSITY;
use super::shade::{AROUND, LIGHT_DENSITY, Portion, RADIANCE, TO_LIGHT, power_heuristic};
use crate::geometry::{Hit, Vec3};
use crate::lanes::Lanes;
use crate::render::Environment;
use simd::{Float, Mask, Vector};

/// Before the first step of shading: what comes from the map along rays that hit nothing.
pub(super) struct Around<'a, 'b>(pub(super) &'a mut Portion<'b>, pub(super) &'a Environment);

impl Lanes for Around<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let Self(portion, map) = self;
        let rules = portion.wave.rules;
        let chance = if rules.whitted { 1.0 } else { portion.wave.scenery.lights.environment() };
        let mut first = 0;
        while first < portion.len {
            let (block, chunk) = (first / 16, first % 16 / F::LANES);
            let hit =
                F::Index::load_block(&portion.hits[block].primitive, chunk).ne(F::Index::splat(Hit::NO_PRIMITIVE));
            let missed = F::Mask::first_n(portion.len - first) & !hit;
            if missed.any() {
                let direction = Vec3::<F>::load(&portion.rays[block].dir, chunk);
                let (radiance, of_map) = map.seen(direction, missed);
                // As lamps, but mirrors show it.
                let density = F::load_partial(&portion.path_list(DENSITY)[first..]);
                let (zero, infinity) = (F::splat(0.0), F::splat(f32::INFINITY));
                let alone = density.lt(zero) | infinity.le(density);
                let ratio = F::select(alone, zero, of_map * F::splat(chance) / density);
                let share = power_heuristic(ratio, F::select(alone, infinity, density));
                portion.scratch.next.store3(AROUND, first, radiance.scale(share));
            }
            first += F::LANES;
        }
    }
}

/// After a light source was chosen for each place: a direction of the map in its stead, with this chance. Mirrors show the map as it is, and are not lit
/// by it.
pub(super) struct SkySpots<'a, 'b>(pub(super) &'a mut Portion<'b>, pub(super) &'a Environment, pub(super) f32);

impl Lanes for SkySpots<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let Self(portion, map, chance) = self;
        let wave = portion.wave;
        let scratch = &mut *portion.scratch;
        let mut first = 0;
        while first < portion.len {
            let pixel = F::Index::load(&scratch.pixels[first..]);
            let [choice, _] = wave.sampler.pair::<F>(pixel, wave.sample, 1 + 4 * wave.depth);
            let chosen = choice.lt(F::splat(chance));
            if chosen.any() {
                let lit = chosen & F::Index::load(&scratch.models[first..]).lt(F::Index::splat(2));
                let spot = wave.sampler.pair::<F>(pixel, wave.sample, 2 + 4 * wave.depth);
                let (direction, density) = map.sample(spot, lit);
                let (radiance, _) = map.seen(direction, lit);
                let density = density * F::splat(chance);
                let radiance = radiance.scale(F::splat(1.0) / density);
                let radiance = Vec3::select(lit, radiance, Vec3::splat([0.0; 3]));
                // A ray to where the scene has ended.
                let to_light = direction.scale(F::splat(wave.scenery.reach));
                let columns = &mut scratch.light;
                let (before, others) = (columns.load3(TO_LIGHT, first), columns.load3(RADIANCE, first));
                columns.store3(TO_LIGHT, first, Vec3::select(chosen, to_light, before));
                columns.store3(RADIANCE, first, Vec3::select(chosen, radiance, others));
                let others = columns.load(LIGHT_DENSITY, first);
                columns.store(LIGHT_DENSITY, first, F::select(chosen, density, others));
            }
            first += F::LANES;
        }
    }
}
