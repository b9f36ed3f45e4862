//! VSX: floats.

use super::lanes::*;
use super::*;
use std::simd::cmp::{SimdPartialEq, SimdPartialOrd};
use std::simd::{Mask as PortableMask, f32x4};

/// The same in portable SIMD.
impl From<Float4> for f32x4 {
    #[inline(always)]
    fn from(x: Float4) -> Self {
        intrinsics!(transmute(x.0))
    }
}
impl From<f32x4> for Float4 {
    #[inline(always)]
    fn from(x: f32x4) -> Self {
        Self(intrinsics!(transmute(x)))
    }
}
impl From<PortableMask<i32, 4>> for Bool4 {
    #[inline(always)]
    fn from(x: PortableMask<i32, 4>) -> Self {
        Self(intrinsics!(transmute(x.to_simd())))
    }
}

vector! { Float4, f32, {
    // Not the comparisons of AltiVec: they take denormals for zeros in the mode that some systems start programs in.
    #[inline(always)]
    fn eq(self, other: Self) -> Bool4 {
        f32x4::from(self).simd_eq(other.into()).into()
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Bool4 {
        f32x4::from(self).simd_lt(other.into()).into()
    }
    #[inline(always)]
    fn le(self, other: Self) -> Bool4 {
        f32x4::from(self).simd_le(other.into()).into()
    }
    // Not the instructions of these names: they prefer the number to NaN, and order the zeros.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(other.lt(self), self, other)
    }
} }

operators!([] Float4:
    Add add AddAssign add_assign = vec_add;
    Sub sub SubAssign sub_assign = vec_sub;
    Mul mul MulAssign mul_assign = vec_mul;
);
impl Div for Float4 {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        (f32x4::from(self) / f32x4::from(other)).into()
    }
}
impl DivAssign for Float4 {
    #[inline(always)]
    fn div_assign(&mut self, other: Self) {
        *self = *self / other;
    }
}

impl Neg for Float4 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(intrinsics!(vec_neg(self.0)))
    }
}

impl Float for Float4 {
    type Int = Int4;

    #[inline(always)]
    fn abs(self) -> Self {
        Self(intrinsics!(vec_abs(self.0)))
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Self(intrinsics!(vec_sel(self.0, sign.0, Uint4::splat(1 << 31).0)))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // Portable SIMD has it in `std` alone.
        #[cfg(feature = "std")]
        return std::simd::StdFloat::sqrt(f32x4::from(self)).into();
        #[cfg(not(feature = "std"))]
        {
            let x = self.to_block();
            Self::from_fn(|i| crate::backend::soft::single::sqrt(x.0[i]))
        }
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self(intrinsics!(vec_floor(self.0)))
    }
    #[inline(always)]
    fn ceil(self) -> Self {
        Self(intrinsics!(vec_ceil(self.0)))
    }
    #[inline(always)]
    fn trunc(self) -> Self {
        // `core::arch` has no `vec_trunc`.
        self.abs().floor().copysign(self)
    }
    #[inline(always)]
    fn round(self) -> Self {
        Self(intrinsics!(vec_round(self.0)))
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self(intrinsics!(vec_madd(self.0, b.0, c.0)))
    }
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        self.mul_add(b, -c)
    }
    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        // Not `vec_nmsub`, which is `-(a * b - c)`: where that is zero it is the other zero.
        (-self).mul_add(b, c)
    }
    #[inline(always)]
    fn mul_add_exact(self, b: Self, c: Self) -> Self {
        self.mul_add(b, c)
    }

    // The conversions saturate and take NaN to 0 by themselves.
    #[inline(always)]
    fn to_int(self) -> Int4 {
        Int4(intrinsics!(vec_cts::<0>(self.0)))
    }
    #[inline(always)]
    fn to_uint(self) -> Uint4 {
        Uint4(intrinsics!(vec_ctu::<0>(self.0)))
    }
    #[inline(always)]
    fn from_int(x: Int4) -> Self {
        Self(intrinsics!(vec_ctf::<0, _>(x.0)))
    }
    #[inline(always)]
    fn from_uint(x: Uint4) -> Self {
        Self(intrinsics!(vec_ctf::<0, _>(x.0)))
    }
    #[inline(always)]
    fn to_bits(self) -> Uint4 {
        Uint4(intrinsics!(transmute(self.0)))
    }
    #[inline(always)]
    fn from_bits(x: Uint4) -> Self {
        Self(intrinsics!(transmute(x.0)))
    }
    #[inline(always)]
    fn reduce_add(self) -> f32 {
        self.reduce(Self::add)
    }
}
