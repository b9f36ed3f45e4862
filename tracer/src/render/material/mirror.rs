//! Mirrors.

use super::{Branch, INV_PI, Model, Parameters, Sample, reflected};
use crate::geometry::Vec3;
use simd::Float;

/// "The pure specular material evaluates the Blinn-Phong model and traces a secondary ray in the direction of perfect reflection" (Boulos
/// 2008, section 5).
///
/// Light sources are thus seen as Blinn's highlights and everything else as in a mirror; what is matt of it is lit by light sources alone. The
/// highlight is scaled so that a surface seen straight on reflects [`Material::specular`](crate::model::Material::specular) of it.
pub(crate) struct Mirror;

impl Model for Mirror {
    const LIT: bool = true;

    #[inline(always)]
    fn follows(branch: Branch) -> bool {
        branch != Branch::Refracted
    }

    #[inline(always)]
    fn value<F: Float>(parameters: &Parameters<F>, to_eye: Vec3<F>, to_light: Vec3<F>) -> Vec3<F> {
        let half = (to_eye + to_light).normalize();
        let n = parameters.shininess;
        // (n + 2) (n + 4) / (8 pi (2^(-n/2) + n))
        let scale = (n + F::splat(2.0)) * (n + F::splat(4.0)) * F::splat(INV_PI / 8.0)
            / (simd::math::exp2(n * F::splat(-0.5)) + n);
        let cos = half.z.max(F::splat(0.0)).min(F::splat(1.0));
        let highlight = parameters.specular.scale(scale * simd::math::pow(cos, n));
        parameters.diffuse.scale(F::splat(INV_PI)) + highlight
    }

    #[inline(always)]
    fn density<F: Float>(_: &Parameters<F>, _: Vec3<F>, _: Vec3<F>) -> F {
        F::splat(0.0)
    }

    #[inline(always)]
    fn sample<F: Float>(parameters: &Parameters<F>, to_eye: Vec3<F>, _: [F; 2], _: F) -> Sample<F> {
        Sample { to_light: reflected(to_eye), weight: parameters.specular, density: F::splat(-1.0) }
    }
}
