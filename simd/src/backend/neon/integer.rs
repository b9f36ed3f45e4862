//! NEON: integers.

use super::lanes::*;
use super::*;

/// A shift count modulo 32 in every lane.
#[inline(always)]
fn shift_count(n: usize) -> int32x4_t {
    intrinsics!(vdupq_n_s32((n % 32) as i32))
}

/// Operators that `i32` and `u32` share.
macro_rules! integer {
    ($V:ident: $add:ident $sub:ident $mul:ident $and:ident $or:ident $xor:ident $not:ident $shift:ident) => {
        operators!([] $V:
            Add add AddAssign add_assign = $add;
            Sub sub SubAssign sub_assign = $sub;
            Mul mul MulAssign mul_assign = $mul;
            BitAnd bitand BitAndAssign bitand_assign = $and;
            BitOr bitor BitOrAssign bitor_assign = $or;
            BitXor bitxor BitXorAssign bitxor_assign = $xor;
        );
        impl Not for $V {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self(intrinsics!($not(self.0)))
            }
        }
        impl Shl<usize> for $V {
            type Output = Self;
            #[inline(always)]
            fn shl(self, n: usize) -> Self {
                Self(intrinsics!($shift(self.0, shift_count(n))))
            }
        }
        impl Shr<usize> for $V {
            type Output = Self;
            #[inline(always)]
            fn shr(self, n: usize) -> Self {
                // To the right is to the left by a negative count.
                Self(intrinsics!($shift(self.0, vnegq_s32(shift_count(n)))))
            }
        }
        impl Integer for $V {
            #[inline(always)]
            fn shl_lanes(self, n: Uint4) -> Self {
                let n = Int4::from_uint(n & Uint4::splat(31));
                Self(intrinsics!($shift(self.0, n.0)))
            }
            #[inline(always)]
            fn shr_lanes(self, n: Uint4) -> Self {
                let n = Int4::from_uint(n & Uint4::splat(31));
                Self(intrinsics!($shift(self.0, vnegq_s32(n.0))))
            }
        }
    };
}
integer!(Int4: vaddq_s32 vsubq_s32 vmulq_s32 vandq_s32 vorrq_s32 veorq_s32 vmvnq_s32 vshlq_s32);
integer!(Uint4: vaddq_u32 vsubq_u32 vmulq_u32 vandq_u32 vorrq_u32 veorq_u32 vmvnq_u32 vshlq_u32);

vector! {
    Int4, i32: splat vdupq_n_s32, load vld1q_s32 vld4q_s32, store vst1q_s32 vst4q_s32, four int32x4x4_t,
    select vbslq_s32, eq vceqq_s32, lt vcltq_s32, le vcleq_s32,
{
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(intrinsics!(vminq_s32(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(intrinsics!(vmaxq_s32(self.0, other.0)))
    }
    #[inline(always)]
    fn reduce_min(self) -> i32 {
        intrinsics!(vminvq_s32(self.0))
    }
    #[inline(always)]
    fn reduce_max(self) -> i32 {
        intrinsics!(vmaxvq_s32(self.0))
    }
} }

impl Neg for Int4 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(intrinsics!(vnegq_s32(self.0)))
    }
}

impl Int for Int4 {
    #[inline(always)]
    fn abs(self) -> Self {
        Self(intrinsics!(vabsq_s32(self.0)))
    }
    #[inline(always)]
    fn to_uint(self) -> Uint4 {
        Uint4(intrinsics!(vreinterpretq_u32_s32(self.0)))
    }
    #[inline(always)]
    fn from_uint(x: Uint4) -> Self {
        Self(intrinsics!(vreinterpretq_s32_u32(x.0)))
    }
}

vector! {
    Uint4, u32: splat vdupq_n_u32, load vld1q_u32 vld4q_u32, store vst1q_u32 vst4q_u32, four uint32x4x4_t,
    select vbslq_u32, eq vceqq_u32, lt vcltq_u32, le vcleq_u32,
{
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(intrinsics!(vminq_u32(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(intrinsics!(vmaxq_u32(self.0, other.0)))
    }
    #[inline(always)]
    fn reduce_min(self) -> u32 {
        intrinsics!(vminvq_u32(self.0))
    }
    #[inline(always)]
    fn reduce_max(self) -> u32 {
        intrinsics!(vmaxvq_u32(self.0))
    }
} }

impl Uint for Uint4 {
    #[inline(always)]
    fn mul_high(self, other: Self) -> Self {
        Self(intrinsics! {
            let low = vreinterpretq_u32_u64(vmull_u32(vget_low_u32(self.0), vget_low_u32(other.0)));
            let high = vreinterpretq_u32_u64(vmull_high_u32(self.0, other.0));
            vuzp2q_u32(low, high)
        })
    }
    #[inline(always)]
    fn count_ones(self) -> Self {
        Self(intrinsics!(vpaddlq_u16(vpaddlq_u8(vcntq_u8(vreinterpretq_u8_u32(self.0))))))
    }
    #[inline(always)]
    fn leading_zeros(self) -> Self {
        Self(intrinsics!(vclzq_u32(self.0)))
    }
}
