//! Matt surfaces.

use super::{INV_PI, Model, Parameters, Sample, cosine_direction};
use crate::geometry::Vec3;
use simd::Float;

/// Lambert 1760: as bright from everywhere. Directions are chosen by their cosine.
pub(crate) struct Lambertian;

impl Model for Lambertian {
    const LIT: bool = true;

    #[inline(always)]
    fn value<F: Float>(parameters: &Parameters<F>, _: Vec3<F>, _: Vec3<F>) -> Vec3<F> {
        parameters.diffuse.scale(F::splat(INV_PI))
    }

    #[inline(always)]
    fn density<F: Float>(_: &Parameters<F>, _: Vec3<F>, to_light: Vec3<F>) -> F {
        to_light.z.max(F::splat(0.0)) * F::splat(INV_PI)
    }

    #[inline(always)]
    fn sample<F: Float>(parameters: &Parameters<F>, to_eye: Vec3<F>, point: [F; 2], _: F) -> Sample<F> {
        let to_light = cosine_direction(point);
        Sample { to_light, weight: parameters.diffuse, density: Self::density(parameters, to_eye, to_light) }
    }
}
