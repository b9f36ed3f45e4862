//! Functions computed from strict operations alone, and therefore the same bits on every level and at every width.
//!
//! | function | largest error found | among |
//! |---|---|---|
//! | [`exp`] | 0.78 ulp | every `f32` |
//! | [`exp2`] | 1.19 ulp | every `f32` |
//! | [`ln`] | 0.501 ulp | every positive `f32` |
//! | [`log2`] | 0.501 ulp | every positive `f32` |
//! | [`pow`] | 1.31 ulp | 4 * 10^8 random pairs, many of them with `x` near 1, results over the whole range |
//! | [`cbrt`] | 0.505 ulp | every positive `f32` |
//! | [`sin`], [`cos`], [`sin_cos`] | 0.92 ulp | every `f32` from 0 to 2^17, every 7th beyond |
//! | [`tan`] | 1.24 ulp | every `f32` from 0 to 2^17, every 7th beyond |
//! | [`asin`] | 0.72 ulp | every `f32` from 0 to 1 |
//! | [`acos`] | 0.69 ulp | every `f32` from -1 to 1 |
//! | [`atan`] | 0.85 ulp | every positive `f32` |
//! | [`atan2`] | 0.85 ulp | 4 * 10^8 random pairs, many of them with quotients near 1 |
//!
//! One ulp is one unit in the last place of the exact result, 2^-149 where that is denormal. Where only positive arguments of
//! odd and even functions have been tried, negative ones give the same bits, but for the sign.
//!
//! ```
//! use simd::math::{log2, pow, sin_cos};
//! assert_eq!(pow(2.0_f32, 10.0), 1024.0);
//! assert_eq!(log2(1024.0_f32), 10.0);
//! assert_eq!(sin_cos(0.0_f32), (0.0, 1.0));
//! ```

mod exponential;
mod trigonometric;

pub use exponential::{cbrt, exp, exp2, ln, log2, pow};
pub use trigonometric::{acos, asin, atan, atan2, cos, sin, sin_cos, tan};

use crate::{Float, Int, Vector};

/// The integer nearest to `x`, for |x| < 2^22.
#[inline(always)]
fn nearest_integer<F: Float>(x: F) -> (F::Int, F) {
    // 1.5 * 2^23: the sum has no bits for a fraction, so the addition rounds, and its lowest bits are the integer.
    let magic = F::splat(12_582_912.0);
    let sum = x + magic;
    (F::Int::from_uint(sum.to_bits() - magic.to_bits()), sum - magic)
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
    /// `a + b` exactly, for |a| >= |b|, or `a` a multiple of the last place of `b`: 0, for one.
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

    /// `self / other`, within a few units of the last place of `lo`, where no product of halves underflows.
    #[inline(always)]
    fn over(self, other: Self) -> Self {
        let hi = self.hi / other.hi;
        let back = Self::product(hi, other.hi);
        let remainder = (self.hi - back.hi) - back.lo + (self.lo - hi * other.lo);
        Self { hi, lo: remainder / other.hi }
    }

    /// Lane by lane.
    #[inline(always)]
    fn select(mask: F::Mask, on_true: Self, on_false: Self) -> Self {
        Self { hi: F::select(mask, on_true.hi, on_false.hi), lo: F::select(mask, on_true.lo, on_false.lo) }
    }

    /// `self + x` for an `x` of the size of `lo`.
    #[inline(always)]
    fn plus_small(self, x: F) -> Self {
        Self { hi: self.hi, lo: self.lo + x }
    }
}
