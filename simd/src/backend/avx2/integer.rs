//! AVX2: integers.

use super::lanes::*;
use super::*;

/// Operators that `i32` and `u32` share, the shift to the right given.
macro_rules! integer {
    ($V:ident, $Lane:ty, $shift_right:ident, $shift_lanes_right:ident) => {
        operators!([] $V:
            Add add AddAssign add_assign = _mm256_add_epi32;
            Sub sub SubAssign sub_assign = _mm256_sub_epi32;
            BitAnd bitand BitAndAssign bitand_assign = _mm256_and_si256;
            BitOr bitor BitOrAssign bitor_assign = _mm256_or_si256;
            BitXor bitxor BitXorAssign bitxor_assign = _mm256_xor_si256;
        );
        impl Mul for $V {
            type Output = Self;
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                Self::new(intrinsics!(_mm256_mullo_epi32(self.0, other.0)))
            }
        }
        impl MulAssign for $V {
            #[inline(always)]
            fn mul_assign(&mut self, other: Self) {
                *self = *self * other;
            }
        }
        impl Not for $V {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self::new(intrinsics!(_mm256_xor_si256(self.0, _mm256_set1_epi32(-1))))
            }
        }
        impl Shl<usize> for $V {
            type Output = Self;
            #[inline(always)]
            fn shl(self, n: usize) -> Self {
                Self::new(intrinsics!(_mm256_sll_epi32(self.0, sse::shift_count(n))))
            }
        }
        impl Shr<usize> for $V {
            type Output = Self;
            #[inline(always)]
            fn shr(self, n: usize) -> Self {
                Self::new(intrinsics!($shift_right(self.0, sse::shift_count(n))))
            }
        }
        impl Integer for $V {
            #[inline(always)]
            fn shl_lanes(self, n: Uint8) -> Self {
                Self::new(intrinsics!(_mm256_sllv_epi32(self.0, _mm256_and_si256(n.0, _mm256_set1_epi32(31)))))
            }
            #[inline(always)]
            fn shr_lanes(self, n: Uint8) -> Self {
                Self::new(intrinsics!($shift_lanes_right(self.0, _mm256_and_si256(n.0, _mm256_set1_epi32(31)))))
            }
        }
    };
}
integer!(Int8, i32, _mm256_sra_epi32, _mm256_srav_epi32);
integer!(Uint8, u32, _mm256_srl_epi32, _mm256_srlv_epi32);

vector! { Int8, sse::Int4<Avx2>, i32, x: splat _mm256_set1_epi32(x), {
    #[inline(always)]
    fn eq(self, other: Self) -> Bool8 {
        Bool8::of_si(intrinsics!(_mm256_cmpeq_epi32(self.0, other.0)))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Bool8 {
        Bool8::of_si(intrinsics!(_mm256_cmpgt_epi32(other.0, self.0)))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Bool8 {
        !other.lt(self)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_min_epi32(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_max_epi32(self.0, other.0)))
    }
} }

impl Neg for Int8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::splat(0) - self
    }
}

impl Int for Int8 {
    #[inline(always)]
    fn abs(self) -> Self {
        let sign = self >> 31;
        (self ^ sign) - sign
    }
    #[inline(always)]
    fn to_uint(self) -> Uint8 {
        Uint8::new(self.0)
    }
    #[inline(always)]
    fn from_uint(x: Uint8) -> Self {
        Self::new(x.0)
    }
}

vector! { Uint8, sse::Uint4<Avx2>, u32, x: splat _mm256_set1_epi32(x as i32), {
    #[inline(always)]
    fn eq(self, other: Self) -> Bool8 {
        Bool8::of_si(intrinsics!(_mm256_cmpeq_epi32(self.0, other.0)))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Bool8 {
        // Signed order after moving zero to i32::MIN.
        let offset = Self::splat(1 << 31);
        Int8::from_uint(self ^ offset).lt(Int8::from_uint(other ^ offset))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Bool8 {
        !other.lt(self)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_min_epu32(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_max_epu32(self.0, other.0)))
    }
} }

impl Uint for Uint8 {
    #[inline(always)]
    fn mul_high(self, other: Self) -> Self {
        Self::new(intrinsics! {
            let even = _mm256_mul_epu32(self.0, other.0);
            let odd = _mm256_mul_epu32(_mm256_srli_epi64::<32>(self.0), _mm256_srli_epi64::<32>(other.0));
            _mm256_blend_epi32::<0b1010_1010>(_mm256_srli_epi64::<32>(even), odd)
        })
    }
}
