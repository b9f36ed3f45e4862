//! Vectors of `f32`.

use super::lanes::{reduce, scan, up_by_one};
use super::{Int, Vector};
use std::ops::*;

/// Vectors of `f32`. `f32` itself is one, of a single lane.
pub trait Float:
    Vector<Lane = f32>
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
    /// The `i32` vector of this width.
    type Int: Int<Mask = Self::Mask, Index = Self::Index>;

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
    #[doc(alias("round_ties_even", "nearbyint", "rint"))]
    fn round(self) -> Self;

    /// `self * b + c`, *relaxed*: fused (one rounding) where the level has it, else two roundings. Its bits differ between levels.
    #[doc(alias("fma", "madd", "vec_madd"))]
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// `self * b - c`, relaxed as [`Float::mul_add`].
    #[doc(alias("msub", "fmsub"))]
    fn mul_sub(self, b: Self, c: Self) -> Self;
    /// `c - self * b`, relaxed as [`Float::mul_add`]: AltiVec's `vec_nmsub`, the seed's `nmsub`.
    #[doc(alias("nmsub", "vec_nmsub", "fnmadd"))]
    fn neg_mul_add(self, b: Self, c: Self) -> Self;

    /// `-(self * b) - c`, relaxed as [`Float::mul_add`].
    #[doc(alias("fnmsub"))]
    #[inline(always)]
    fn neg_mul_sub(self, b: Self, c: Self) -> Self {
        (-self).mul_sub(b, c)
    }
    /// `self * b + c` with one rounding, on every level: slow where the hardware does not have it.
    #[doc(alias("fma"))]
    #[inline(always)]
    fn mul_add_exact(self, b: Self, c: Self) -> Self {
        let (x, b, c) = (self.to_block(), b.to_block(), c.to_block());
        Self::from_fn(|i| crate::backend::soft::mul_add(x.0[i], b.0[i], c.0[i]))
    }

    /// `self * b - product`, where `product` is `self * b`, rounded: what rounding lost. Exact, and with the same bits on every
    /// level, where nothing over- or underflows, for magnitudes between 2^-50 and 2^60, say; elsewhere levels differ.
    #[doc(alias("two_product"))]
    #[inline(always)]
    fn product_error(self, b: Self, product: Self) -> Self {
        // 12 bits above and 12 below: the products of such halves are exact (T. J. Dekker 1971).
        let upper = Self::Index::splat(0xffff_f000);
        let (a1, b1) = (Self::from_bits(self.to_bits() & upper), Self::from_bits(b.to_bits() & upper));
        let (a2, b2) = (self - a1, b - b1);
        a2 * b2 + (a2 * b1 + (a1 * b2 + (a1 * b1 - product)))
    }

    /// An estimate of `1 / self`, *relaxed*: its bits differ between levels and between makers of CPUs. For `self`
    /// between 2^-64 and 2^64 in magnitude the relative error is at most 2^-8 (NEON; elsewhere 2^-11); nothing is said of others.
    /// Levels without the instruction divide.
    #[inline(always)]
    fn rcp_approx(self) -> Self {
        Self::splat(1.0) / self
    }
    /// An estimate of `1 / sqrt(self)`, relaxed as [`Float::rcp_approx`], for positive `self`.
    #[inline(always)]
    fn rsqrt_approx(self) -> Self {
        Self::splat(1.0) / self.sqrt()
    }
    /// `1 / self` to within 2 ulp, from the estimate; *relaxed*: `splat(1.0) / self` has the same bits everywhere.
    ///
    /// Denormals are numbers like others. Zero gives infinity of its sign, infinity gives zero of its sign, NaN gives NaN.
    #[doc(alias("recip", "reciprocal"))]
    #[inline(always)]
    fn rcp(self) -> Self {
        let (zero, one, infinity) = (Self::splat(0.0), Self::splat(1.0), Self::splat(f32::INFINITY));
        let (small, large) = (Self::splat(5.421_011e-20), Self::splat(1.844_674_4e19));
        let size = self.abs();
        // Away from the ends of the range, where estimates are flushed to zero: by 2^64 or 2^-64, which is exact.
        let scale = Self::select(size.lt(small), large, Self::select(size.gt(large), small, one));
        let special = size.eq(zero) | size.eq(infinity);
        let x = Self::select(special, one, self * scale);
        // Two steps of Newton's: e' = e + e (1 - x e).
        let mut e = x.rcp_approx();
        for _ in 0..2 {
            e += e * e.neg_mul_add(x, one);
        }
        let limit = Self::select(size.eq(zero), infinity, zero);
        Self::select(special, limit.copysign(self), e * scale)
    }
    /// `1 / sqrt(self)` to within 2 ulp, from the estimate; *relaxed*: `splat(1.0) / self.sqrt()` has the same bits everywhere.
    ///
    /// Denormals are numbers like others. Zero gives infinity of its sign, infinity gives 0, what is below zero and NaN give NaN.
    #[inline(always)]
    fn rsqrt(self) -> Self {
        let (zero, one, infinity) = (Self::splat(0.0), Self::splat(1.0), Self::splat(f32::INFINITY));
        let is_small = self.lt(Self::splat(5.421_011e-20));
        let special = self.eq(zero) | self.eq(infinity);
        let x = Self::select(is_small, self * Self::splat(1.844_674_4e19), self);
        let x = Self::select(special, one, x);
        let mut e = x.rsqrt_approx();
        for _ in 0..2 {
            // e' = e + e/2 (1 - x e e)
            e += e * Self::splat(0.5) * (x * e).neg_mul_add(e, one);
        }
        let e = Self::select(is_small, e * Self::splat(4_294_967_296.0), e);
        let limit = Self::select(self.eq(zero), infinity, zero);
        Self::select(special, limit.copysign(self), Self::select(self.lt(zero), Self::splat(f32::NAN), e))
    }
    /// What is left of [`Float::floor`]: at least 0 and at most 1 (of tiny negative numbers); NaN of infinity.
    #[inline(always)]
    fn fract(self) -> Self {
        self - self.floor()
    }

    /// Towards zero, as `as i32` does: saturating, NaN becomes 0.
    fn to_int(self) -> Self::Int;
    /// Towards zero, as `as u32` does: saturating, NaN and negative numbers become 0.
    fn to_uint(self) -> Self::Index;
    /// Nearest `f32`, ties to even.
    fn from_int(x: Self::Int) -> Self;
    /// Nearest `f32`, ties to even.
    fn from_uint(x: Self::Index) -> Self;
    /// The bit pattern.
    fn to_bits(self) -> Self::Index;
    /// From a bit pattern.
    fn from_bits(x: Self::Index) -> Self;

    /// Sum of the lanes, added in the order of [`Vector::reduce_min`].
    fn reduce_add(self) -> f32;

    /// Product of the lanes, multiplied in the order of [`Vector::reduce_min`].
    #[inline(always)]
    fn reduce_mul(self) -> f32 {
        reduce(self, |a, b| a * b)
    }
    /// Lane `i` becomes the sum of lanes `0..=i`. The order of additions is that of Kogge & Stone: with `n` = 1, 2, 4, ...
    /// lane `i - n` is added to every lane `i >= n`. It depends on the number of lanes, not on the level.
    #[doc(alias("cumsum", "scan"))]
    #[inline(always)]
    fn prefix_sum(self) -> Self {
        scan(self, |a, b| a + b)
    }
    /// [`Float::prefix_sum`] moved up by one lane: the sum of the lanes below; 0 in the first.
    #[inline(always)]
    fn prefix_sum_exclusive(self) -> Self {
        up_by_one(self.prefix_sum())
    }

    /// From half precision (IEEE 754 binary16), exact; of NaN some NaN.
    ///
    /// # Panics
    /// If `src` has fewer than [`Vector::LANES`] elements.
    #[inline(always)]
    fn load_f16(src: &[u16]) -> Self {
        let src = &src[..Self::LANES];
        let half = Self::Index::from_fn(|i| u32::from(src[i]));
        let splat = Self::Index::splat;
        // Exponent and fraction in place; the exponent's bias is put right by a product, which is exact, denormals too.
        let size = Self::from_bits((half & splat(0x7fff)) << 13) * Self::splat(5.192_297e33);
        let not_finite = (half & splat(0x7c00)).eq(splat(0x7c00));
        let bits = Self::Index::select(not_finite, size.to_bits() | splat(0x7f80_0000), size.to_bits());
        Self::from_bits(bits | ((half & splat(0x8000)) << 16))
    }

    /// To half precision, to nearest, ties to even: infinity from 65520 on, denormals kept, NaN stays some NaN.
    ///
    /// # Panics
    /// If `dst` has fewer than [`Vector::LANES`] elements.
    #[inline(always)]
    fn store_f16(self, dst: &mut [u16]) {
        let splat = Self::Index::splat;
        let bits = self.to_bits();
        let size = bits & splat(0x7fff_ffff);
        // Normal: rebias, round to even by adding half a place less the bit above it.
        let odd = (size >> 13) & splat(1);
        let normal = (size - splat(112 << 23) + splat(0xfff) + odd) >> 13;
        // Denormal: adding 0.5 leaves just the bits there are, rounded.
        let denormal = (self.abs() + Self::splat(0.5)).to_bits() - splat(0x3f00_0000);
        let special = Self::Index::select(size.gt(splat(0x7f80_0000)), splat(0x7e00), splat(0x7c00));
        let half = Self::Index::select(size.lt(splat(113 << 23)), denormal, normal);
        let half = Self::Index::select(size.ge(splat(143 << 23)), special, half) | ((bits >> 16) & splat(0x8000));
        for (to, from) in dst[..Self::LANES].iter_mut().zip(half.to_block().0) {
            *to = from as u16;
        }
    }

    /// `self`, negated where `sign` has its sign bit set.
    #[inline(always)]
    fn mul_sign(self, sign: Self) -> Self {
        Self::from_bits(self.to_bits() ^ (sign.to_bits() & Self::Index::splat(1 << 31)))
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
}
