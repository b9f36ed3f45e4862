//! Glass and water.

use super::{Branch, Model, Parameters, Sample, reflected};
use crate::geometry::Vec3;
use simd::Float;

/// A smooth surface of something clear: reflects and refracts by Fresnel's equations for unpolarized light.
///
/// Radiance is not scaled by the square of the index of refraction: of light that has left again what it entered nothing is changed by it.
pub(crate) struct Dielectric;

impl Model for Dielectric {
    const LIT: bool = false;

    #[inline(always)]
    fn follows(_: Branch) -> bool {
        true
    }

    #[inline(always)]
    fn value<F: Float>(_: &Parameters<F>, _: Vec3<F>, _: Vec3<F>) -> Vec3<F> {
        Vec3::splat([0.0; 3])
    }

    #[inline(always)]
    fn density<F: Float>(_: &Parameters<F>, _: Vec3<F>, _: Vec3<F>) -> F {
        F::splat(0.0)
    }

    #[inline(always)]
    fn sample<F: Float>(parameters: &Parameters<F>, to_eye: Vec3<F>, _: [F; 2], lobe: F) -> Sample<F> {
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        // Index on this side over that on the other.
        let ratio = F::select(parameters.front, one / parameters.ior, parameters.ior);
        let cos = to_eye.z.min(one);
        let sin2 = ratio * ratio * (one - cos * cos);
        let cos_inside = (one - sin2).max(zero).sqrt();
        let reflectance = F::select(sin2.lt(one), fresnel(ratio, cos, cos_inside), one);

        let white = Vec3::splat([1.0; 3]);
        let refracted = Vec3 { x: -ratio * to_eye.x, y: -ratio * to_eye.y, z: -cos_inside };
        let through = parameters.transmission;
        let (to_light, weight) = match parameters.options.branch {
            Branch::Random => {
                let is_reflected = lobe.lt(reflectance);
                let to_light = Vec3::select(is_reflected, reflected(to_eye), refracted);
                (to_light, Vec3::select(is_reflected, white, through))
            }
            Branch::Reflected => (reflected(to_eye), white.scale(reflectance)),
            Branch::Refracted => (refracted, through.scale(one - reflectance)),
        };
        Sample { to_light, weight, density: F::splat(f32::INFINITY) }
    }
}

/// The part that is reflected; `ratio` is the index on the side of `cos` over that on the side of `cos_inside`.
#[inline(always)]
fn fresnel<F: Float>(ratio: F, cos: F, cos_inside: F) -> F {
    let parallel = (cos - ratio * cos_inside) / (cos + ratio * cos_inside);
    let perpendicular = (ratio * cos - cos_inside) / (ratio * cos + cos_inside);
    (parallel * parallel + perpendicular * perpendicular) * F::splat(0.5)
}
