//! NEON: floats.

use super::lanes::*;
use super::*;

vector! {
    Float4, f32: splat vdupq_n_f32, load vld1q_f32 vld4q_f32, store vst1q_f32 vst4q_f32, four float32x4x4_t,
    select vbslq_f32, eq vceqq_f32, lt vcltq_f32, le vcleq_f32,
{
    // Not the instructions of these names: they return NaN when either is, and order the zeros.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(other.lt(self), self, other)
    }
    #[inline(always)]
    fn reduce_min(self) -> f32 {
        self.reduce(Self::min)
    }
    #[inline(always)]
    fn reduce_max(self) -> f32 {
        self.reduce(Self::max)
    }
} }

operators!([] Float4:
    Add add AddAssign add_assign = vaddq_f32;
    Sub sub SubAssign sub_assign = vsubq_f32;
    Mul mul MulAssign mul_assign = vmulq_f32;
    Div div DivAssign div_assign = vdivq_f32;
);

impl Neg for Float4 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(intrinsics!(vnegq_f32(self.0)))
    }
}

impl Float4 {
    /// The halves with each other, then lane 0 with lane 1.
    #[inline(always)]
    fn reduce(self, op: impl Fn(Self, Self) -> Self) -> f32 {
        let two = op(self, Self(intrinsics!(vextq_f32::<2>(self.0, self.0))));
        let one = op(two, Self(intrinsics!(vdupq_laneq_f32::<1>(two.0))));
        intrinsics!(vgetq_lane_f32::<0>(one.0))
    }
}

impl Float for Float4 {
    type Int = Int4;

    #[inline(always)]
    fn abs(self) -> Self {
        Self(intrinsics!(vabsq_f32(self.0)))
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Self(intrinsics!(vbslq_f32(vdupq_n_u32(1 << 31), sign.0, self.0)))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(intrinsics!(vsqrtq_f32(self.0)))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self(intrinsics!(vrndmq_f32(self.0)))
    }
    #[inline(always)]
    fn ceil(self) -> Self {
        Self(intrinsics!(vrndpq_f32(self.0)))
    }
    #[inline(always)]
    fn trunc(self) -> Self {
        Self(intrinsics!(vrndq_f32(self.0)))
    }
    #[inline(always)]
    fn round(self) -> Self {
        Self(intrinsics!(vrndnq_f32(self.0)))
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self(intrinsics!(vfmaq_f32(c.0, self.0, b.0)))
    }
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        self.mul_add(b, -c)
    }
    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        Self(intrinsics!(vfmsq_f32(c.0, self.0, b.0)))
    }

    // The conversions saturate and take NaN to 0 by themselves.
    #[inline(always)]
    fn mul_add_exact(self, b: Self, c: Self) -> Self {
        Self(intrinsics!(vfmaq_f32(c.0, self.0, b.0)))
    }
    #[inline(always)]
    fn rcp_approx(self) -> Self {
        Self(intrinsics!(vrecpeq_f32(self.0)))
    }
    #[inline(always)]
    fn rsqrt_approx(self) -> Self {
        Self(intrinsics!(vrsqrteq_f32(self.0)))
    }
    #[inline(always)]
    fn to_int(self) -> Int4 {
        Int4(intrinsics!(vcvtq_s32_f32(self.0)))
    }
    #[inline(always)]
    fn to_uint(self) -> Uint4 {
        Uint4(intrinsics!(vcvtq_u32_f32(self.0)))
    }
    #[inline(always)]
    fn from_int(x: Int4) -> Self {
        Self(intrinsics!(vcvtq_f32_s32(x.0)))
    }
    #[inline(always)]
    fn from_uint(x: Uint4) -> Self {
        Self(intrinsics!(vcvtq_f32_u32(x.0)))
    }
    #[inline(always)]
    fn to_bits(self) -> Uint4 {
        Uint4(intrinsics!(vreinterpretq_u32_f32(self.0)))
    }
    #[inline(always)]
    fn from_bits(x: Uint4) -> Self {
        Self(intrinsics!(vreinterpretq_f32_u32(x.0)))
    }
    #[inline(always)]
    fn reduce_add(self) -> f32 {
        // Not the addition across lanes: its order is another.
        self.reduce(Self::add)
    }
}
