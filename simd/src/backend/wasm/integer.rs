//! WebAssembly: integers.

use super::lanes::*;
use super::*;

/// Operators that `i32` and `u32` share.
macro_rules! integer {
    ($V:ident: $shr:ident) => {
        operators!([] $V:
            Add add AddAssign add_assign = i32x4_add;
            Sub sub SubAssign sub_assign = i32x4_sub;
            Mul mul MulAssign mul_assign = i32x4_mul;
            BitAnd bitand BitAndAssign bitand_assign = v128_and;
            BitOr bitor BitOrAssign bitor_assign = v128_or;
            BitXor bitxor BitXorAssign bitxor_assign = v128_xor;
        );
        impl Not for $V {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self(v128_not(self.0))
            }
        }
        // The instructions take the count modulo 32 by themselves.
        impl Shl<usize> for $V {
            type Output = Self;
            #[inline(always)]
            fn shl(self, n: usize) -> Self {
                Self(i32x4_shl(self.0, n as u32))
            }
        }
        impl Shr<usize> for $V {
            type Output = Self;
            #[inline(always)]
            fn shr(self, n: usize) -> Self {
                Self($shr(self.0, n as u32))
            }
        }
        impl Integer for $V {}
    };
}
integer!(Int4: i32x4_shr);
integer!(Uint4: u32x4_shr);

vector! {
    [] Int4, i32: splat i32x4_splat, first i32x4_extract_lane, eq i32x4_eq, lt i32x4_lt, le i32x4_le,
{
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(i32x4_min(self.0, other.0))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(i32x4_max(self.0, other.0))
    }
} }

impl Neg for Int4 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(i32x4_neg(self.0))
    }
}

impl Int for Int4 {
    #[inline(always)]
    fn abs(self) -> Self {
        Self(i32x4_abs(self.0))
    }
    #[inline(always)]
    fn to_uint(self) -> Uint4 {
        Uint4(self.0)
    }
    #[inline(always)]
    fn from_uint(x: Uint4) -> Self {
        Self(x.0)
    }
}

vector! {
    [] Uint4, u32: splat u32x4_splat, first u32x4_extract_lane, eq u32x4_eq, lt u32x4_lt, le u32x4_le,
{
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(u32x4_min(self.0, other.0))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(u32x4_max(self.0, other.0))
    }
} }

impl Uint for Uint4 {
    #[inline(always)]
    fn mul_high(self, other: Self) -> Self {
        let low = u64x2_extmul_low_u32x4(self.0, other.0);
        let high = u64x2_extmul_high_u32x4(self.0, other.0);
        Self::new(u32x4_shuffle::<1, 3, 5, 7>(low, high))
    }
    #[inline(always)]
    fn count_ones(self) -> Self {
        let bytes = u8x16_popcnt(self.0);
        Self::new(u32x4_extadd_pairwise_u16x8(u16x8_extadd_pairwise_u8x16(bytes)))
    }
}
