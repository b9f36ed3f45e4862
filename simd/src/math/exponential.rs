//! Powers, logarithms and roots.

use super::{Double, nearest_integer, polynomial};
use crate::{Float, Int, Vector};
use core::f32::consts::{LN_2, LOG2_E};

/// e to the power `x`.
///
/// | `x` | result |
/// |---|---|
/// | ±0 | 1 |
/// | -∞, or at most -103.98 | 0 |
/// | between -103.97 and -87.34 | denormal, not flushed |
/// | ∞, or at least 88.73 | ∞ |
/// | NaN | NaN |
#[inline(always)]
pub fn exp<F: Float>(x: F) -> F {
    let x = saturate(x, -104.0, 89.0);
    let (n, rounded) = nearest_integer(x * F::splat(LOG2_E));
    // x - n ln 2. The first part of ln 2 has 15 bits: its product with n, and that difference, are exact.
    let r = Double::sum(x - rounded * F::splat(0.693_145_75), -(rounded * F::splat(1.428_606_8e-6)));
    // (e^r - 1 - r) / r^2: minimax, relative error of the result below 2^-28.
    let q = polynomial(r.hi, [0.499_999_94, 0.166_665_15, 0.041_668_087, 0.008_369_296, 0.001_383_822]);
    let sum = Double::sum(F::splat(1.0), r.hi);
    scaled(sum.hi + (sum.lo + (r.lo + r.hi * r.hi * q)), n)
}

/// 2 to the power `x`; exact when `x` is an integer.
///
/// | `x` | result |
/// |---|---|
/// | ±0 | 1 |
/// | -∞, or at most -150 | 0 |
/// | between -150 and -126 | denormal, not flushed |
/// | ∞, or at least 128 | ∞ |
/// | NaN | NaN |
#[inline(always)]
pub fn exp2<F: Float>(x: F) -> F {
    let x = saturate(x, -151.0, 129.0);
    let (n, rounded) = nearest_integer(x);
    exp2_of_parts(n, x - rounded)
}

/// Base-2 logarithm; exact when `x` is a power of two.
///
/// | `x` | result |
/// |---|---|
/// | ±0 | -∞ |
/// | denormal | as accurate as elsewhere |
/// | 1 | 0 |
/// | ∞ | ∞ |
/// | negative, NaN | NaN |
#[inline(always)]
pub fn log2<F: Float>(x: F) -> F {
    logarithm(x, log2_of_finite(x).hi)
}

/// Natural logarithm.
///
/// | `x` | result |
/// |---|---|
/// | ±0 | -∞ |
/// | denormal | as accurate as elsewhere |
/// | 1 | 0 |
/// | ∞ | ∞ |
/// | negative, NaN | NaN |
#[inline(always)]
pub fn ln<F: Float>(x: F) -> F {
    let ln_2 = Double { hi: F::splat(LN_2), lo: F::splat(-1.904_654_2e-9) };
    logarithm(x, log2_of_finite(x).times(ln_2).hi)
}

/// `of_finite` where `x` is positive and finite, else what any logarithm gives.
#[inline(always)]
fn logarithm<F: Float>(x: F, of_finite: F) -> F {
    let (zero, infinity) = (F::splat(0.0), F::splat(f32::INFINITY));
    let special = F::select(x.eq(infinity), infinity, F::splat(f32::NAN));
    let special = F::select(x.eq(zero), -infinity, special);
    F::select(x.gt(zero) & x.lt(infinity), of_finite, special)
}

/// `x` to the power `y`, for `x >= 0`. -0 counts as 0.
///
/// | `x` | `y` | result |
/// |---|---|---|
/// | any, NaN too | ±0 | 1 |
/// | 1 | any, NaN too | 1 |
/// | 0 | positive | 0 |
/// | 0 | negative | ∞ |
/// | ∞ | positive | ∞ |
/// | ∞ | negative | 0 |
/// | below 1 | ∞ (-∞) | 0 (∞) |
/// | above 1 | ∞ (-∞) | ∞ (0) |
/// | negative | not 0 | NaN, also for an integer `y` |
/// | NaN in either, elsewhere | | NaN |
#[inline(always)]
pub fn pow<F: Float>(x: F, y: F) -> F {
    let (zero, one, infinity) = (F::splat(0.0), F::splat(1.0), F::splat(f32::INFINITY));
    let log = log2_of_finite(x);
    // |log2 x| >= 2^-24 unless x = 1: with |y| = 2^32 every result has long been 0 or infinity, and nothing overflows here.
    let limit = F::splat(4_294_967_296.0);
    let bounded = limit.min((-limit).max(y));
    let product = Double::product(log.hi, bounded);
    let exponent = Double::sum(product.hi, product.lo + log.lo * bounded);
    let saturated = saturate(exponent.hi, -151.0, 129.0);
    let (n, rounded) = nearest_integer(saturated);
    let rest = F::select(saturated.eq(exponent.hi), exponent.lo, zero);
    let power = exp2_of_parts(n, saturated - rounded + rest);

    let grows = x.eq(zero) ^ y.gt(zero);
    let of_zero_or_infinity = F::select(grows, infinity, zero);
    let power = F::select(x.eq(zero) | x.eq(infinity), of_zero_or_infinity, power);
    let power = F::select(x.ge(zero) & y.eq(y), power, F::splat(f32::NAN));
    F::select(x.eq(one) | y.eq(zero), one, power)
}

/// Cube root, of negative numbers too.
///
/// | `x` | result |
/// |---|---|
/// | ±0, ±∞, NaN | `x` |
/// | denormal | as accurate as elsewhere |
/// | negative | minus the root of `-x` |
#[inline(always)]
pub fn cbrt<F: Float>(x: F) -> F {
    // Away from the ends of the range, where cubes overflow and their rounding errors underflow: by 2^±72.
    let magnitude = x.abs();
    let small = magnitude.lt(F::splat(1.0));
    let a = magnitude * F::select(small, F::splat(4.722_366_5e21), F::splat(2.117_582_4e-22));
    let unscale = F::select(small, F::splat(1.0 / 16_777_216.0), F::splat(16_777_216.0));

    // A third of the bit pattern is about a third of the logarithm: 5 bits. Halley's step triples them.
    let third = (F::from_int(F::Int::from_uint(a.to_bits())) * F::splat(1.0 / 3.0)).to_int();
    let y = F::from_bits(third.to_uint() + F::Index::splat(709_958_130));
    let cube = y * y * y;
    let y = y * ((cube + a + a) / (cube + cube + a));
    // Newton's step doubles them; only the difference needs all bits of the cube.
    let square = Double::product(y, y);
    let cube = Double::product(square.hi, y);
    let difference = (a - cube.hi) - cube.lo - square.lo * y;
    let root = y + difference / (F::splat(3.0) * square.hi);

    let regular = magnitude.gt(F::splat(0.0)) & magnitude.lt(F::splat(f32::INFINITY));
    F::select(regular, (root * unscale).copysign(x), x)
}

/// `x` between two bounds. NaN stays.
#[inline(always)]
fn saturate<F: Float>(x: F, low: f32, high: f32) -> F {
    // `min` and `max` return their second operand when one is NaN.
    F::splat(high).min(F::splat(low).max(x))
}

/// 2^(n + fraction), for |fraction| <= 1/2 and n between -151 and 129.
#[inline(always)]
fn exp2_of_parts<F: Float>(n: F::Int, fraction: F) -> F {
    // (2^x - 1) / x: minimax, absolute error of x times it below 2^-28.
    let q = polynomial(fraction, [LN_2, 0.240_226_5, 0.055_503_394, 0.009_618_012, 0.001_339_691_3, 0.000_154_744_1]);
    scaled(F::splat(1.0) + fraction * q, n)
}

/// `x * 2^n`, for `x` between 1/2 and 2 and n between -151 and 129.
#[inline(always)]
fn scaled<F: Float>(x: F, n: F::Int) -> F {
    // In two steps, both of them normal numbers: the first product is exact, the second rounds if the result is denormal.
    let half = n >> 1;
    x * power_of_two(half) * power_of_two(n - half)
}

/// 2^n, for n between -126 and 127.
#[inline(always)]
fn power_of_two<F: Float>(n: F::Int) -> F {
    F::from_bits(((n + F::Int::splat(127)) << 23).to_uint())
}

/// Base-2 logarithm to about 35 bits. Meaningless for zero, negative, infinite or NaN `x`.
#[inline(always)]
fn log2_of_finite<F: Float>(x: F) -> Double<F> {
    /// Bit pattern of sqrt(1/2), rounded up.
    const SQRT_HALF: u32 = 0x3f35_04f3;

    // x = m * 2^exponent, m from sqrt(1/2) to sqrt(2): near x = 1 the exponent is 0, nothing cancels.
    let denormal = x.lt(F::splat(f32::MIN_POSITIVE));
    let x = F::select(denormal, x * F::splat(16_777_216.0), x);
    let bits = x.to_bits() + F::Index::splat(1.0_f32.to_bits() - SQRT_HALF);
    let bias = F::select(denormal, F::splat(127.0 + 24.0), F::splat(127.0));
    let exponent = F::from_int(F::Int::from_uint(bits >> 23)) - bias;
    let m = F::from_bits((bits & F::Index::splat(0x7f_ffff)) + F::Index::splat(SQRT_HALF));

    // log2 m = (2 / ln 2) atanh s, s = (m - 1) / (m + 1).
    let numerator = m - F::splat(1.0);
    let denominator = Double::sum(F::splat(2.0), numerator);
    let s = Double { hi: numerator, lo: F::splat(0.0) }.over(denominator);

    // s (c1 + z (c3 + z q(z))), z = s^2: the series' first two coefficients in two floats each, q minimax.
    let z = s.times(s);
    let q = polynomial(z.hi, [0.577_079_83, 0.411_881_42, 0.337_151_1]);
    let inner = Double::sum(F::splat(0.961_796_7), z.hi * q).plus_small(F::splat(-7.028_462e-9));
    let outer = z.times(inner);
    let outer = Double::sum(F::splat(2.885_39), outer.hi).plus_small(outer.lo + F::splat(3.851_926e-8));
    let log = s.times(outer);
    let sum = Double::sum(exponent, log.hi);
    Double::sum(sum.hi, sum.lo + log.lo)
}
