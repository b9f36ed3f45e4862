//! WebAssembly: floats.

use super::lanes::*;
use super::*;

vector! {
    [I: MulAdd] Float4<I>, f32: splat f32x4_splat, first f32x4_extract_lane, eq f32x4_eq, lt f32x4_lt, le f32x4_le,
{
    // The pseudo-minimum of (a, b) is `if b < a { b } else { a }`. Not `f32x4_min`: it returns NaN when either is, and orders
    // the zeros. With relaxed SIMD, LLVM 22 makes a relaxed minimum of it, which may return either of NaN and a number, and of
    // the zeros (llvm/llvm-project#177814); not so of a selection by bits.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if cfg!(target_feature = "relaxed-simd") {
            Self::select(self.lt(other), self, other)
        } else {
            Self::new(f32x4_pmin(other.0, self.0))
        }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if cfg!(target_feature = "relaxed-simd") {
            Self::select(other.lt(self), self, other)
        } else {
            Self::new(f32x4_pmax(other.0, self.0))
        }
    }
} }

operators!([I: MulAdd] Float4<I>:
    Add add AddAssign add_assign = f32x4_add;
    Sub sub SubAssign sub_assign = f32x4_sub;
    Mul mul MulAssign mul_assign = f32x4_mul;
    Div div DivAssign div_assign = f32x4_div;
);

impl<I: MulAdd> Neg for Float4<I> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(f32x4_neg(self.0))
    }
}

impl<I: MulAdd> Float for Float4<I> {
    type Int = Int4;

    #[inline(always)]
    fn abs(self) -> Self {
        Self::new(f32x4_abs(self.0))
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Self::new(v128_bitselect(sign.0, self.0, u32x4_splat(1 << 31)))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::new(f32x4_sqrt(self.0))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self::new(f32x4_floor(self.0))
    }
    #[inline(always)]
    fn ceil(self) -> Self {
        Self::new(f32x4_ceil(self.0))
    }
    #[inline(always)]
    fn trunc(self) -> Self {
        Self::new(f32x4_trunc(self.0))
    }
    #[inline(always)]
    fn round(self) -> Self {
        Self::new(f32x4_nearest(self.0))
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self::new(I::mul_add(self.0, b.0, c.0))
    }
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        self.mul_add(b, -c)
    }
    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        Self::new(I::neg_mul_add(self.0, b.0, c.0))
    }

    // The conversions saturate and take NaN to 0 by themselves.
    #[inline(always)]
    fn to_int(self) -> Int4 {
        Int4(i32x4_trunc_sat_f32x4(self.0))
    }
    #[inline(always)]
    fn to_uint(self) -> Uint4 {
        Uint4(u32x4_trunc_sat_f32x4(self.0))
    }
    #[inline(always)]
    fn from_int(x: Int4) -> Self {
        Self::new(f32x4_convert_i32x4(x.0))
    }
    #[inline(always)]
    fn from_uint(x: Uint4) -> Self {
        Self::new(f32x4_convert_u32x4(x.0))
    }
    #[inline(always)]
    fn to_bits(self) -> Uint4 {
        Uint4(self.0)
    }
    #[inline(always)]
    fn from_bits(x: Uint4) -> Self {
        Self::new(x.0)
    }
    #[inline(always)]
    fn reduce_add(self) -> f32 {
        self.reduce(Self::add)
    }
}
