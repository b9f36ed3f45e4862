//! Functions computed from strict operations alone, and therefore the same bits on every level and at every width.
//!
//! | function | largest error found | among |
//! |---|---|---|
//! | [`exp2`] | 1.19 ulp | every `f32` |
//! | [`log2`] | 0.501 ulp | every positive `f32` |
//! | [`pow`] | 1.31 ulp | 4 * 10^8 random pairs, many of them with `x` near 1, results over the whole range |
//!
//! One ulp is one unit in the last place of the exact result, 2^-149 where that is denormal.
//!
//! ```
//! use simd::math::{log2, pow};
//! assert_eq!(pow(2.0_f32, 10.0), 1024.0);
//! assert_eq!(log2(1024.0_f32), 10.0);
//! ```

use crate::{Float, Int, Vector};

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
    let (n, fraction) = nearest_integer(saturate(x));
    exp2_of_parts(n, fraction)
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
    let (zero, infinity) = (F::splat(0.0), F::splat(f32::INFINITY));
    let special = F::select(x.eq(infinity), infinity, F::splat(f32::NAN));
    let special = F::select(x.eq(zero), -infinity, special);
    F::select(x.gt(zero) & x.lt(infinity), log2_of_finite(x).hi, special)
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
    let saturated = saturate(exponent.hi);
    let (n, fraction) = nearest_integer(saturated);
    let rest = F::select(saturated.eq(exponent.hi), exponent.lo, zero);
    let power = exp2_of_parts(n, fraction + rest);

    let grows = x.eq(zero) ^ y.gt(zero);
    let of_zero_or_infinity = F::select(grows, infinity, zero);
    let power = F::select(x.eq(zero) | x.eq(infinity), of_zero_or_infinity, power);
    let power = F::select(x.ge(zero) & y.eq(y), power, F::splat(f32::NAN));
    F::select(x.eq(one) | y.eq(zero), one, power)
}

/// `x` where 2^x is finite and not 0, else the nearest number for which it is not. NaN stays.
#[inline(always)]
fn saturate<F: Float>(x: F) -> F {
    // `min` and `max` return their second operand when one is NaN.
    F::splat(129.0).min(F::splat(-151.0).max(x))
}

/// The integer nearest to `x`, and `x` less that, exactly: for |x| < 2^22.
#[inline(always)]
fn nearest_integer<F: Float>(x: F) -> (F::Int, F) {
    // 1.5 * 2^23: the sum has no bits for a fraction, so the addition rounds, and its lowest bits are the integer.
    let magic = F::splat(12_582_912.0);
    let sum = x + magic;
    let n = F::Int::from_uint(sum.to_bits() - magic.to_bits());
    (n, x - (sum - magic))
}

/// 2^(n + fraction), for |fraction| <= 1/2 and n between -151 and 129.
#[inline(always)]
fn exp2_of_parts<F: Float>(n: F::Int, fraction: F) -> F {
    // (2^x - 1) / x: minimax, absolute error of x times it below 2^-28.
    let q = polynomial(
        fraction,
        [std::f32::consts::LN_2, 0.240_226_5, 0.055_503_394, 0.009_618_012, 0.001_339_691_3, 0.000_154_744_1],
    );
    let power = F::splat(1.0) + fraction * q;
    // In two steps, both of them normal numbers: the first product is exact, the second rounds if the result is denormal.
    let half = n >> 1;
    power * power_of_two(half) * power_of_two(n - half)
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

    // log2 m = (2 / ln 2) atanh s, s = (m - 1) / (m + 1); the division's remainder gives the lower half of s.
    let numerator = m - F::splat(1.0);
    let denominator = Double::sum(F::splat(2.0), numerator);
    let s = numerator / denominator.hi;
    let back = Double::product(s, denominator.hi);
    let remainder = (numerator - back.hi) - back.lo - s * denominator.lo;
    let s = Double { hi: s, lo: remainder / denominator.hi };

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

/// `c[0] + c[1] x + c[2] x^2 + ...` (Horner).
#[inline(always)]
fn polynomial<F: Float, const N: usize>(x: F, c: [f32; N]) -> F {
    let mut sum = F::splat(c[N - 1]);
    let mut i = N - 1;
    while i > 0 {
        i -= 1;
        sum = sum * x + F::splat(c[i]);
    }
    sum
}

/// A number as the sum of two floats, the second no larger than the rounding error of the first: about 48 bits
/// (T. J. Dekker, "A floating-point technique for extending the available precision", 1971).
#[derive(Clone, Copy)]
struct Double<F> {
    hi: F,
    lo: F,
}

impl<F: Float> Double<F> {
    /// `a + b` exactly, for |a| >= |b| or a = 0.
    #[inline(always)]
    fn sum(a: F, b: F) -> Self {
        let hi = a + b;
        Self { hi, lo: b - (hi - a) }
    }

    /// `a * b` exactly, where nothing over- or underflows.
    #[inline(always)]
    fn product(a: F, b: F) -> Self {
        // 12 bits above and 12 below: the products of such halves are exact.
        let upper = F::Index::splat(0xffff_f000);
        let (a1, b1) = (F::from_bits(a.to_bits() & upper), F::from_bits(b.to_bits() & upper));
        let (a2, b2) = (a - a1, b - b1);
        let hi = a * b;
        Self { hi, lo: a2 * b2 + (a2 * b1 + (a1 * b2 + (a1 * b1 - hi))) }
    }

    /// `self * other`, within a few units of the last place of `lo`.
    #[inline(always)]
    fn times(self, other: Self) -> Self {
        let product = Self::product(self.hi, other.hi);
        let cross = self.hi * other.lo + self.lo * other.hi;
        Self::sum(product.hi, product.lo + cross)
    }

    /// `self + x` for an `x` of the size of `lo`.
    #[inline(always)]
    fn plus_small(self, x: F) -> Self {
        Self { hi: self.hi, lo: self.lo + x }
    }
}
