//! AVX-512: integers.

use super::lanes::*;
use super::*;

/// Operators that `i32` and `u32` share, the shift to the right given.
macro_rules! integer {
    ($V:ident, $Lane:ty, $shift_right:ident, $shift_lanes_right:ident) => {
        operators!([] $V:
            Add add AddAssign add_assign = _mm512_add_epi32;
            Sub sub SubAssign sub_assign = _mm512_sub_epi32;
            BitAnd bitand BitAndAssign bitand_assign = _mm512_and_si512;
            BitOr bitor BitOrAssign bitor_assign = _mm512_or_si512;
            BitXor bitxor BitXorAssign bitxor_assign = _mm512_xor_si512;
        );
        impl Mul for $V {
            type Output = Self;
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                Self::new(intrinsics!(_mm512_mullo_epi32(self.0, other.0)))
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
                Self::new(intrinsics!(_mm512_xor_si512(self.0, _mm512_set1_epi32(-1))))
            }
        }
        impl Shl<usize> for $V {
            type Output = Self;
            #[inline(always)]
            fn shl(self, n: usize) -> Self {
                Self::new(intrinsics!(_mm512_sll_epi32(self.0, sse::shift_count(n))))
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
            fn shl_lanes(self, n: Uint16) -> Self {
                Self::new(intrinsics!(_mm512_sllv_epi32(self.0, _mm512_and_si512(n.0, _mm512_set1_epi32(31)))))
            }
            #[inline(always)]
            fn shr_lanes(self, n: Uint16) -> Self {
                Self::new(intrinsics!($shift_lanes_right(self.0, _mm512_and_si512(n.0, _mm512_set1_epi32(31)))))
            }
        }
    };
}
integer!(Int16, i32, _mm512_sra_epi32, _mm512_srav_epi32);
integer!(Uint16, u32, _mm512_srl_epi32, _mm512_srlv_epi32);

vector! { Int16, avx2::Int8, sse::Int4<Avx2>, i32, x: splat _mm512_set1_epi32(x), {
    #[inline(always)]
    fn eq(self, other: Self) -> Bool16 {
        Bool16(intrinsics!(_mm512_cmpeq_epi32_mask(self.0, other.0)))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Bool16 {
        Bool16(intrinsics!(_mm512_cmplt_epi32_mask(self.0, other.0)))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Bool16 {
        Bool16(intrinsics!(_mm512_cmple_epi32_mask(self.0, other.0)))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm512_min_epi32(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm512_max_epi32(self.0, other.0)))
    }
} }

impl Neg for Int16 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::splat(0) - self
    }
}

impl Int for Int16 {
    #[inline(always)]
    fn abs(self) -> Self {
        let sign = self >> 31;
        (self ^ sign) - sign
    }
    #[inline(always)]
    fn to_uint(self) -> Uint16 {
        Uint16::new(self.0)
    }
    #[inline(always)]
    fn from_uint(x: Uint16) -> Self {
        Self::new(x.0)
    }
}

vector! { Uint16, avx2::Uint8, sse::Uint4<Avx2>, u32, x: splat _mm512_set1_epi32(x as i32), {
    #[inline(always)]
    fn eq(self, other: Self) -> Bool16 {
        Bool16(intrinsics!(_mm512_cmpeq_epu32_mask(self.0, other.0)))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Bool16 {
        Bool16(intrinsics!(_mm512_cmplt_epu32_mask(self.0, other.0)))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Bool16 {
        Bool16(intrinsics!(_mm512_cmple_epu32_mask(self.0, other.0)))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm512_min_epu32(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm512_max_epu32(self.0, other.0)))
    }
} }

impl Uint for Uint16 {
    #[inline(always)]
    fn mul_high(self, other: Self) -> Self {
        Self::new(intrinsics! {
            let even = _mm512_mul_epu32(self.0, other.0);
            let odd = _mm512_mul_epu32(_mm512_srli_epi64::<32>(self.0), _mm512_srli_epi64::<32>(other.0));
            _mm512_mask_blend_epi32(0xaaaa, _mm512_srli_epi64::<32>(even), odd)
        })
    }
    #[inline(always)]
    fn leading_zeros(self) -> Self {
        Self::new(intrinsics!(_mm512_lzcnt_epi32(self.0)))
    }
}
