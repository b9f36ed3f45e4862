//! How surfaces reflect light: one file per model, each with its value, its density and its way of choosing directions.
//!
//! All directions are unit vectors that lead away from the surface, in the frame of the surface whose z axis is the normal on the side
//! that is looked at: `to_eye.z > 0`. Strict operations only: the same bits on every level and at every width.

mod dielectric;
mod frame;
mod glossy;
mod lambertian;
mod mirror;
#[cfg(test)]
mod tests;

pub(crate) use dielectric::Dielectric;
pub(crate) use frame::Frame;
pub(crate) use glossy::Glossy;
pub(crate) use lambertian::Lambertian;
pub(crate) use mirror::Mirror;

use crate::geometry::Vec3;
use simd::Float;

/// What models read of a material and of the place.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Parameters<F: Float> {
    pub(crate) diffuse: Vec3<F>,
    pub(crate) specular: Vec3<F>,
    pub(crate) shininess: F,
    pub(crate) transmission: Vec3<F>,
    pub(crate) ior: F,
    /// Where the ray comes from the side on which the triangle's corners run counter-clockwise.
    pub(crate) front: F::Mask,
    pub(crate) options: Options,
}

/// How directions are chosen, the same everywhere in a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Options {
    /// Glossy surfaces send rays into the lobe of their coat alone.
    pub(crate) coat_alone: bool,
    /// Which of a dielectric's two rays.
    pub(crate) branch: Branch,
}

/// Which of a dielectric's two rays.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Branch {
    /// One of them, by chance: its weight is whole.
    Random,
    /// The reflected one, weighted.
    Reflected,
    /// The refracted one, weighted.
    Refracted,
}

/// A direction that was chosen.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sample<F: Float> {
    /// Towards where light may come from.
    pub(crate) to_light: Vec3<F>,
    /// The model's value times the cosine over the density: what of the light from there goes to the eye. Zero where there is no
    /// direction.
    pub(crate) weight: Vec3<F>,
    /// Density per solid angle; infinite where the direction is the only one; negative where it is, but lamps are not to be counted, as they are
    /// seen in another way.
    pub(crate) density: F,
}

/// A model.
pub(crate) trait Model {
    /// Whether lights are asked for: false where only one direction matters.
    const LIT: bool;

    /// Whether it sends a ray on in such a branch.
    #[inline(always)]
    fn follows(branch: Branch) -> bool {
        branch == Branch::Random
    }

    /// The bidirectional reflectance distribution, per steradian, for both directions above the surface.
    fn value<F: Float>(parameters: &Parameters<F>, to_eye: Vec3<F>, to_light: Vec3<F>) -> Vec3<F>;

    /// How densely [`Model::sample`] chooses `to_light`, per steradian.
    fn density<F: Float>(parameters: &Parameters<F>, to_eye: Vec3<F>, to_light: Vec3<F>) -> F;

    /// A direction from a point of the unit square, and a number in [0, 1) that decides between lobes.
    fn sample<F: Float>(parameters: &Parameters<F>, to_eye: Vec3<F>, point: [F; 2], lobe: F) -> Sample<F>;
}

pub(crate) const INV_PI: f32 = std::f32::consts::FRAC_1_PI;
pub(crate) const TWO_PI: f32 = std::f32::consts::TAU;

/// A direction of the upper half, as dense as its cosine over pi (Malley's method).
#[inline(always)]
pub(crate) fn cosine_direction<F: Float>([u, v]: [F; 2]) -> Vec3<F> {
    let radius = u.sqrt();
    let (sin, cos) = simd::math::sin_cos(v * F::splat(TWO_PI));
    Vec3 { x: radius * cos, y: radius * sin, z: (F::splat(1.0) - u).sqrt() }
}

/// Relative luminance (Rec. 709).
#[inline(always)]
pub(crate) fn luminance<F: Float>(c: Vec3<F>) -> F {
    c.x * F::splat(0.2126) + c.y * F::splat(0.7152) + c.z * F::splat(0.0722)
}

/// [`luminance`] of one colour.
pub(crate) fn luminance_of([x, y, z]: [f32; 3]) -> f32 {
    luminance::<f32>(Vec3 { x, y, z })
}

#[inline(always)]
pub(crate) fn negate<F: Float>(v: Vec3<F>) -> Vec3<F> {
    Vec3 { x: -v.x, y: -v.y, z: -v.z }
}

/// Reflected at the surface.
#[inline(always)]
pub(crate) fn reflected<F: Float>(v: Vec3<F>) -> Vec3<F> {
    Vec3 { x: -v.x, y: -v.y, z: v.z }
}

/// The fifth power of `1 - x`, for x from 0 to 1.
#[inline(always)]
fn fifth_power_below_one<F: Float>(x: F) -> F {
    let y = (F::splat(1.0) - x).max(F::splat(0.0));
    let square = y * y;
    square * square * y
}
