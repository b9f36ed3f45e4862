//! A matt ground under a glossy coat.

use super::{
    Frame, INV_PI, Model, Parameters, Sample, TWO_PI, cosine_direction, fifth_power_below_one, luminance, reflected,
};
use crate::geometry::Vec3;
use simd::Float;

/// The coupled model of Shirley, Smits, Hu and Lafortune 1997 ("A Practitioners' Assessment of Light Reflection Models", section 4): the ground
/// gets what the coat lets through, by Schlick's approximation. The coat is a Phong lobe that conserves energy (Lafortune and Willems
/// 1994), its Fresnel term taken at the half vector, so that both directions may be exchanged.
pub(crate) struct Glossy;

impl Model for Glossy {
    const LIT: bool = true;

    #[inline(always)]
    fn value<F: Float>(parameters: &Parameters<F>, to_eye: Vec3<F>, to_light: Vec3<F>) -> Vec3<F> {
        let lobe = lobe(parameters, to_eye, to_light);
        ground(parameters, to_eye, to_light) + coat(parameters, to_eye, to_light, lobe)
    }

    #[inline(always)]
    fn density<F: Float>(parameters: &Parameters<F>, to_eye: Vec3<F>, to_light: Vec3<F>) -> F {
        let share = share_of_coat(parameters, to_eye);
        density(parameters, share, to_light, lobe(parameters, to_eye, to_light))
    }

    #[inline(always)]
    fn sample<F: Float>(parameters: &Parameters<F>, to_eye: Vec3<F>, point: [F; 2], choice: F) -> Sample<F> {
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        // Around the mirrored direction, as dense as the lobe.
        let cos = simd::math::pow(point[0], one / (parameters.shininess + one));
        let sin = (one - cos * cos).max(zero).sqrt();
        let (s, c) = simd::math::sin_cos(point[1] * F::splat(TWO_PI));
        let in_lobe = Frame::around(reflected(to_eye)).world(Vec3 { x: sin * c, y: sin * s, z: cos });
        let share = share_of_coat(parameters, to_eye);
        let in_coat = choice.lt(share);
        let to_light = Vec3::select(in_coat, in_lobe, cosine_direction(point));

        let lobe = lobe(parameters, to_eye, to_light);
        let mut value = coat(parameters, to_eye, to_light, lobe);
        if !parameters.options.coat_alone {
            value = ground(parameters, to_eye, to_light) + value;
        }
        let density = density(parameters, share, to_light, lobe);
        let possible = zero.lt(to_light.z) & zero.lt(density);
        let weight = value.scale(to_light.z / density);
        Sample { to_light, weight: Vec3::select(possible, weight, Vec3::splat([0.0; 3])), density }
    }
}

/// How often the coat's lobe is chosen: by what the coat and the ground reflect of what comes from the eye, about.
#[inline(always)]
fn share_of_coat<F: Float>(parameters: &Parameters<F>, to_eye: Vec3<F>) -> F {
    let one = F::splat(1.0);
    if parameters.options.coat_alone {
        return one;
    }
    let through = Vec3::splat([1.0; 3]) - fresnel(parameters, to_eye.z);
    let coat = one - luminance(through);
    let ground = luminance(parameters.diffuse * through);
    // Neither is ever left out: a tenth of the directions at least.
    let share = coat / (coat + ground).max(F::splat(1e-6));
    share.max(F::splat(0.1)).min(F::splat(0.9))
}

/// (n + 1) / (2 pi) times the lobe, and the cosine over pi, by their shares.
#[inline(always)]
fn density<F: Float>(parameters: &Parameters<F>, share: F, to_light: Vec3<F>, lobe: F) -> F {
    let one = F::splat(1.0);
    let coat = (parameters.shininess + one) * F::splat(1.0 / TWO_PI) * lobe;
    let ground = to_light.z.max(F::splat(0.0)) * F::splat(INV_PI);
    share * coat + (one - share) * ground
}

/// (n + 2) / (2 pi) times the lobe, by the Fresnel term.
#[inline(always)]
fn coat<F: Float>(parameters: &Parameters<F>, to_eye: Vec3<F>, to_light: Vec3<F>, lobe: F) -> Vec3<F> {
    let half = (to_eye + to_light).normalize();
    let scale = (parameters.shininess + F::splat(2.0)) * F::splat(1.0 / TWO_PI);
    fresnel(parameters, half.dot(to_eye)).scale(scale * lobe)
}

/// What the coat lets through on the way in and out, scaled to reflect all of it: 21 / (20 pi (1 - r)) (1 - F)(1 - F').
#[inline(always)]
fn ground<F: Float>(parameters: &Parameters<F>, to_eye: Vec3<F>, to_light: Vec3<F>) -> Vec3<F> {
    let one = F::splat(1.0);
    let both = (one - fifth_power_below_one(to_eye.z)) * (one - fifth_power_below_one(to_light.z));
    let through = Vec3::splat([1.0; 3]) - parameters.specular;
    (parameters.diffuse * through).scale(both * F::splat(21.0 / 20.0 * INV_PI))
}

/// The cosine to the mirrored direction to the power of the shininess.
#[inline(always)]
fn lobe<F: Float>(parameters: &Parameters<F>, to_eye: Vec3<F>, to_light: Vec3<F>) -> F {
    let (zero, one) = (F::splat(0.0), F::splat(1.0));
    let cos = reflected(to_eye).dot(to_light);
    let power = simd::math::pow(cos.max(zero).min(one), parameters.shininess);
    // Zero to the power of zero is one.
    F::select(zero.lt(cos), power, zero)
}

/// Schlick 1994.
#[inline(always)]
fn fresnel<F: Float>(parameters: &Parameters<F>, cos: F) -> Vec3<F> {
    let r = parameters.specular;
    r + (Vec3::splat([1.0; 3]) - r).scale(fifth_power_below_one(cos))
}
