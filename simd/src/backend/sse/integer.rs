//! x86, four lanes: integers.

use super::lanes::*;
use super::*;

/// A shift count modulo 32, in the register that shifts take it from.
#[inline(always)]
pub(in crate::backend) fn shift_count(n: usize) -> __m128i {
    intrinsics!(_mm_cvtsi32_si128(n as i32 & 31))
}

/// Operators that `i32` and `u32` share, the shift to the right given.
macro_rules! integer {
    ($V:ident, $Lane:ty, $shift_right:ident, $shift_lanes_right:ident) => {
        operators!([I: Sse] $V<I>:
            Add add AddAssign add_assign = _mm_add_epi32;
            Sub sub SubAssign sub_assign = _mm_sub_epi32;
            BitAnd bitand BitAndAssign bitand_assign = _mm_and_si128;
            BitOr bitor BitOrAssign bitor_assign = _mm_or_si128;
            BitXor bitxor BitXorAssign bitxor_assign = _mm_xor_si128;
        );
        impl<I: Sse> Mul for $V<I> {
            type Output = Self;
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                Self::new(intrinsics! {
                    if const { I::SSE41 } {
                        _mm_mullo_epi32(self.0, other.0)
                    } else {
                        let even = _mm_mul_epu32(self.0, other.0);
                        let odd = _mm_mul_epu32(_mm_srli_epi64::<32>(self.0), _mm_srli_epi64::<32>(other.0));
                        _mm_unpacklo_epi32(_mm_shuffle_epi32::<0b1000>(even), _mm_shuffle_epi32::<0b1000>(odd))
                    }
                })
            }
        }
        impl<I: Sse> MulAssign for $V<I> {
            #[inline(always)]
            fn mul_assign(&mut self, other: Self) {
                *self = *self * other;
            }
        }
        impl<I: Sse> Not for $V<I> {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self::new(intrinsics!(_mm_xor_si128(self.0, _mm_set1_epi32(-1))))
            }
        }
        impl<I: Sse> Shl<usize> for $V<I> {
            type Output = Self;
            #[inline(always)]
            fn shl(self, n: usize) -> Self {
                Self::new(intrinsics!(_mm_sll_epi32(self.0, shift_count(n))))
            }
        }
        impl<I: Sse> Shr<usize> for $V<I> {
            type Output = Self;
            #[inline(always)]
            fn shr(self, n: usize) -> Self {
                Self::new(intrinsics!($shift_right(self.0, shift_count(n))))
            }
        }
        impl<I: Sse> Integer for $V<I> {
            #[inline(always)]
            fn shl_lanes(self, n: Uint4<I>) -> Self {
                if const { I::AVX2 } {
                    Self::new(intrinsics!(_mm_sllv_epi32(self.0, _mm_and_si128(n.0, _mm_set1_epi32(31)))))
                } else {
                    shift_in_steps(self, n, |x, n| x << n)
                }
            }
            #[inline(always)]
            fn shr_lanes(self, n: Uint4<I>) -> Self {
                if const { I::AVX2 } {
                    Self::new(intrinsics!($shift_lanes_right(self.0, _mm_and_si128(n.0, _mm_set1_epi32(31)))))
                } else {
                    shift_in_steps(self, n, |x, n| x >> n)
                }
            }
        }
        impl<I: Sse> $V<I> {
            #[inline(always)]
            fn first(self) -> $Lane {
                intrinsics!(_mm_cvtsi128_si32(self.0)) as $Lane
            }
        }
    };
}
integer!(Int4, i32, _mm_sra_epi32, _mm_srav_epi32);
integer!(Uint4, u32, _mm_srl_epi32, _mm_srlv_epi32);

vector! { Int4, i32, x: splat _mm_set1_epi32(x), {
    #[inline(always)]
    fn eq(self, other: Self) -> Bool4<I> {
        Bool4::of_si(intrinsics!(_mm_cmpeq_epi32(self.0, other.0)))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Bool4<I> {
        Bool4::of_si(intrinsics!(_mm_cmplt_epi32(self.0, other.0)))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Bool4<I> {
        !other.lt(self)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if const { I::SSE41 } {
            Self::new(intrinsics!(_mm_min_epi32(self.0, other.0)))
        } else {
            Self::select(self.lt(other), self, other)
        }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if const { I::SSE41 } {
            Self::new(intrinsics!(_mm_max_epi32(self.0, other.0)))
        } else {
            Self::select(other.lt(self), self, other)
        }
    }
} }

impl<I: Sse> Neg for Int4<I> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::splat(0) - self
    }
}

impl<I: Sse> Int for Int4<I> {
    #[inline(always)]
    fn abs(self) -> Self {
        let sign = self >> 31;
        (self ^ sign) - sign
    }
    #[inline(always)]
    fn to_uint(self) -> Uint4<I> {
        Uint4::new(self.0)
    }
    #[inline(always)]
    fn from_uint(x: Uint4<I>) -> Self {
        Self::new(x.0)
    }
}

vector! { Uint4, u32, x: splat _mm_set1_epi32(x as i32), {
    #[inline(always)]
    fn eq(self, other: Self) -> Bool4<I> {
        Bool4::of_si(intrinsics!(_mm_cmpeq_epi32(self.0, other.0)))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Bool4<I> {
        // Signed order after moving zero to i32::MIN.
        let offset = Self::splat(1 << 31);
        Int4::from_uint(self ^ offset).lt(Int4::from_uint(other ^ offset))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Bool4<I> {
        !other.lt(self)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if const { I::SSE41 } {
            Self::new(intrinsics!(_mm_min_epu32(self.0, other.0)))
        } else {
            Self::select(self.lt(other), self, other)
        }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if const { I::SSE41 } {
            Self::new(intrinsics!(_mm_max_epu32(self.0, other.0)))
        } else {
            Self::select(other.lt(self), self, other)
        }
    }
} }

impl<I: Sse> Uint for Uint4<I> {
    #[inline(always)]
    fn mul_high(self, other: Self) -> Self {
        Self::new(intrinsics! {
            let even = _mm_mul_epu32(self.0, other.0);
            let odd = _mm_mul_epu32(_mm_srli_epi64::<32>(self.0), _mm_srli_epi64::<32>(other.0));
            _mm_or_si128(_mm_srli_epi64::<32>(even), _mm_and_si128(odd, _mm_setr_epi32(0, -1, 0, -1)))
        })
    }
}
