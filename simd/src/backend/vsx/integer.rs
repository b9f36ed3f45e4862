//! VSX: integers.

use super::lanes::*;
use super::*;
use std::simd::{num::SimdUint, u32x4};

/// A shift count modulo 32 in every lane.
#[inline(always)]
fn shift_count(n: usize) -> vector_unsigned_int {
    Uint4::splat((n % 32) as u32).0
}

/// What `i32` and `u32` share.
macro_rules! integer {
    ($V:ident, $Lane:ty: $shr:ident) => {
        operators!([] $V:
            Add add AddAssign add_assign = vec_add;
            Sub sub SubAssign sub_assign = vec_sub;
            Mul mul MulAssign mul_assign = vec_mul;
            BitAnd bitand BitAndAssign bitand_assign = vec_and;
            BitOr bitor BitOrAssign bitor_assign = vec_or;
            BitXor bitxor BitXorAssign bitxor_assign = vec_xor;
        );
        impl Not for $V {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self(intrinsics!(vec_nor(self.0, self.0)))
            }
        }
        impl Shl<usize> for $V {
            type Output = Self;
            #[inline(always)]
            fn shl(self, n: usize) -> Self {
                Self(intrinsics!(vec_sl(self.0, shift_count(n))))
            }
        }
        impl Shr<usize> for $V {
            type Output = Self;
            #[inline(always)]
            fn shr(self, n: usize) -> Self {
                Self(intrinsics!($shr(self.0, shift_count(n))))
            }
        }
        impl Integer for $V {
            #[inline(always)]
            fn shl_lanes(self, n: Uint4) -> Self {
                Self(intrinsics!(vec_sl(self.0, (n & Uint4::splat(31)).0)))
            }
            #[inline(always)]
            fn shr_lanes(self, n: Uint4) -> Self {
                Self(intrinsics!($shr(self.0, (n & Uint4::splat(31)).0)))
            }
        }
        vector! { $V, $Lane, {
            #[inline(always)]
            fn eq(self, other: Self) -> Bool4 {
                Bool4(intrinsics!(transmute(vec_cmpeq(self.0, other.0))))
            }
            #[inline(always)]
            fn lt(self, other: Self) -> Bool4 {
                Bool4(intrinsics!(transmute(vec_cmplt(self.0, other.0))))
            }
            #[inline(always)]
            fn le(self, other: Self) -> Bool4 {
                !other.lt(self)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                Self(intrinsics!(vec_min(self.0, other.0)))
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                Self(intrinsics!(vec_max(self.0, other.0)))
            }
        } }
    };
}
integer!(Int4, i32: vec_sra);
integer!(Uint4, u32: vec_sr);

impl Neg for Int4 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(intrinsics!(vec_neg(self.0)))
    }
}

impl Int for Int4 {
    #[inline(always)]
    fn abs(self) -> Self {
        Self(intrinsics!(vec_abs(self.0)))
    }
    #[inline(always)]
    fn to_uint(self) -> Uint4 {
        Uint4(intrinsics!(transmute(self.0)))
    }
    #[inline(always)]
    fn from_uint(x: Uint4) -> Self {
        Self(intrinsics!(transmute(x.0)))
    }
}

impl Uint for Uint4 {
    // The upper half of products stays that of the trait: `core::arch` has no products of twice the bits.
    #[inline(always)]
    fn count_ones(self) -> Self {
        let x: u32x4 = intrinsics!(transmute(self.0));
        Self(intrinsics!(transmute(x.count_ones())))
    }
    #[inline(always)]
    fn leading_zeros(self) -> Self {
        Self(intrinsics!(vec_cntlz(self.0)))
    }
}
