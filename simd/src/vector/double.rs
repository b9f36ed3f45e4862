//! Vectors of `f64`.

use super::{Float, Int, Vector};
use std::ops::*;

/// Vectors of `f64`. `f64` itself is one, of a single lane.
///
/// On x86 and ARM four of them and eight are registers of the level (at AVX-512 those of AVX2); two of them, and all on other
/// processors, are made of lanes, which LLVM packs where it sees how. Masks and indices of four and eight are those of as many 32-bit
/// lanes. What costs more than `f32` needs no more accuracy in most kernels: see [`Float`] first.
pub trait Double:
    Vector<Lane = f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
{
    /// Clears the sign bit.
    fn abs(self) -> Self;
    /// Magnitude of `self`, sign bit of `sign`.
    fn copysign(self, sign: Self) -> Self;
    /// Square root, correctly rounded; NaN below zero, -0 of -0.
    fn sqrt(self) -> Self;
    /// Largest integer not above; keeps -0.
    fn floor(self) -> Self;
    /// Smallest integer not below; -0 above -1 and below 0.
    fn ceil(self) -> Self;
    /// Integer part; keeps the sign of zero.
    fn trunc(self) -> Self;
    /// Nearest integer, ties to even; keeps the sign of zero.
    fn round(self) -> Self;
    /// `self * b + c`, relaxed: rounded once where the level has the instruction (AVX2, AVX-512, NEON) for four lanes and eight, else
    /// twice; two lanes and one are rounded twice at every level.
    #[doc(alias("fma", "madd"))]
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// `self * b - c`, relaxed as [`Double::mul_add`].
    #[doc(alias("msub"))]
    fn mul_sub(self, b: Self, c: Self) -> Self;
    /// `c - self * b`, relaxed as [`Double::mul_add`].
    #[doc(alias("nmsub"))]
    fn neg_mul_add(self, b: Self, c: Self) -> Self;
    /// `-(self * b) - c`, relaxed as [`Double::mul_add`].
    #[inline(always)]
    fn neg_mul_sub(self, b: Self, c: Self) -> Self {
        (-self).mul_sub(b, c)
    }
    /// `self * b + c`, rounded once at every level; slow where the level lacks the instruction, and for two lanes.
    #[doc(alias("fma"))]
    fn mul_add_exact(self, b: Self, c: Self) -> Self;
    /// Sum of the lanes, added in the order of [`Vector::reduce_min`].
    fn reduce_add(self) -> f64;
    /// Product of the lanes, multiplied in the order of [`Vector::reduce_min`].
    fn reduce_mul(self) -> f64;

    /// From `f32`, exact.
    ///
    /// ```
    /// use simd::{Double, Vector};
    /// let sum = simd::dispatch!(simd::Level::best(), |S| -> f64 {
    ///     S::Double4::from_float(S::Float4::from_fn(|i| i as f32)).reduce_add()
    /// });
    /// assert_eq!(sum, 6.0);
    /// ```
    #[inline(always)]
    fn from_float<F: Float>(x: F) -> Self {
        const { assert!(F::LANES == Self::LANES, "vectors of as many lanes") }
        let x = x.to_block();
        Self::from_fn(|i| f64::from(x.0[i]))
    }
    /// Nearest `f32`, ties to even.
    #[inline(always)]
    fn to_float<F: Float>(self) -> F {
        const { assert!(F::LANES == Self::LANES, "vectors of as many lanes") }
        let x = self.to_block();
        F::from_fn(|i| x.0[i] as f32)
    }
    /// From `i32`, exact.
    #[inline(always)]
    fn from_int<I: Int>(x: I) -> Self {
        const { assert!(I::LANES == Self::LANES, "vectors of as many lanes") }
        let x = x.to_block();
        Self::from_fn(|i| f64::from(x.0[i]))
    }
    /// Towards zero, as `as i32` does: saturating, NaN becomes 0.
    #[inline(always)]
    fn to_int<I: Int>(self) -> I {
        const { assert!(I::LANES == Self::LANES, "vectors of as many lanes") }
        let x = self.to_block();
        I::from_fn(|i| x.0[i] as i32)
    }
    /// The smaller; the other one when one is NaN.
    #[inline(always)]
    fn min_num(self, other: Self) -> Self {
        Self::select(other.eq(other), self.min(other), self)
    }
    /// The larger; the other one when one is NaN.
    #[inline(always)]
    fn max_num(self, other: Self) -> Self {
        Self::select(other.eq(other), self.max(other), self)
    }
    /// `self.max(lo).min(hi)`: `lo` for NaN.
    #[inline(always)]
    fn clamp(self, lo: Self, hi: Self) -> Self {
        self.max(lo).min(hi)
    }
    /// What is left of [`Double::floor`]: at least 0 and at most 1 (of tiny negative numbers); NaN of infinity.
    #[inline(always)]
    fn fract(self) -> Self {
        self - self.floor()
    }
}
