//! x86, four lanes: floats.

use super::lanes::*;
use super::*;

vector! { Float4, f32, x: splat _mm_set1_ps(x), {
    #[inline(always)]
    fn eq(self, other: Self) -> Bool4<I> {
        Bool4::new(intrinsics!(_mm_cmpeq_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Bool4<I> {
        Bool4::new(intrinsics!(_mm_cmplt_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Bool4<I> {
        Bool4::new(intrinsics!(_mm_cmple_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn ne(self, other: Self) -> Bool4<I> {
        Bool4::new(intrinsics!(_mm_cmpneq_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm_min_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm_max_ps(self.0, other.0)))
    }
} }

operators!([I: Sse] Float4<I>:
    Add add AddAssign add_assign = _mm_add_ps;
    Sub sub SubAssign sub_assign = _mm_sub_ps;
    Mul mul MulAssign mul_assign = _mm_mul_ps;
    Div div DivAssign div_assign = _mm_div_ps;
);

impl<I: Sse> Neg for Float4<I> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(intrinsics!(_mm_xor_ps(self.0, _mm_set1_ps(-0.0))))
    }
}

impl<I: Sse> Float4<I> {
    #[inline(always)]
    fn first(self) -> f32 {
        intrinsics!(_mm_cvtss_f32(self.0))
    }

    /// Rounding without SSE4.1: `small` rounds numbers below 2^23 in magnitude, the others are integers already.
    #[inline(always)]
    fn round_sse2(self, small: impl FnOnce(Self) -> Self) -> Self {
        let rounded = small(self).copysign(self);
        Self::select(self.abs().lt(Self::splat(8_388_608.0)), rounded, self)
    }

    #[inline(always)]
    fn trunc_sse2(self) -> Self {
        Self::new(intrinsics!(_mm_cvtepi32_ps(_mm_cvttps_epi32(self.0))))
    }
}

impl<I: Sse> Float for Float4<I> {
    type Int = Int4<I>;

    #[inline(always)]
    fn abs(self) -> Self {
        Self::new(intrinsics!(_mm_andnot_ps(_mm_set1_ps(-0.0), self.0)))
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Self::new(intrinsics! {
            let bit = _mm_set1_ps(-0.0);
            _mm_or_ps(_mm_andnot_ps(bit, self.0), _mm_and_ps(bit, sign.0))
        })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::new(intrinsics!(_mm_sqrt_ps(self.0)))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        if const { I::SSE41 } {
            Self::new(intrinsics!(_mm_floor_ps(self.0)))
        } else {
            self.round_sse2(|x| {
                let t = x.trunc_sse2();
                t - Self::select(x.lt(t), Self::splat(1.0), Self::splat(0.0))
            })
        }
    }
    #[inline(always)]
    fn ceil(self) -> Self {
        if const { I::SSE41 } {
            Self::new(intrinsics!(_mm_ceil_ps(self.0)))
        } else {
            self.round_sse2(|x| {
                let t = x.trunc_sse2();
                t + Self::select(t.lt(x), Self::splat(1.0), Self::splat(0.0))
            })
        }
    }
    #[inline(always)]
    fn trunc(self) -> Self {
        if const { I::SSE41 } {
            Self::new(intrinsics!(_mm_round_ps::<{ _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC }>(self.0)))
        } else {
            self.round_sse2(Self::trunc_sse2)
        }
    }
    #[inline(always)]
    fn round(self) -> Self {
        if const { I::SSE41 } {
            Self::new(intrinsics!(_mm_round_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(self.0)))
        } else {
            // Adding 2^23 leaves no bit for a fraction: the addition itself rounds to even.
            let magic = Self::splat(8_388_608.0);
            self.round_sse2(|x| (x.abs() + magic) - magic)
        }
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        if const { I::AVX2 } { Self::new(intrinsics!(_mm_fmadd_ps(self.0, b.0, c.0))) } else { self * b + c }
    }
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        if const { I::AVX2 } { Self::new(intrinsics!(_mm_fmsub_ps(self.0, b.0, c.0))) } else { self * b - c }
    }
    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        if const { I::AVX2 } { Self::new(intrinsics!(_mm_fnmadd_ps(self.0, b.0, c.0))) } else { c - self * b }
    }

    #[inline(always)]
    fn mul_add_exact(self, b: Self, c: Self) -> Self {
        if const { I::AVX2 } {
            return self.mul_add(b, c);
        }
        let (a, b, c) = (self.to_block(), b.to_block(), c.to_block());
        Self::from_fn(|i| crate::backend::soft::mul_add(a.0[i], b.0[i], c.0[i]))
    }
    #[inline(always)]
    fn rcp_approx(self) -> Self {
        Self::new(intrinsics!(_mm_rcp_ps(self.0)))
    }
    #[inline(always)]
    fn rsqrt_approx(self) -> Self {
        Self::new(intrinsics!(_mm_rsqrt_ps(self.0)))
    }

    #[inline(always)]
    fn to_int(self) -> Int4<I> {
        // Out of range gives i32::MIN: all bits flipped that is i32::MAX. NaN is cleared.
        Int4::new(intrinsics! {
            let x = _mm_cvttps_epi32(self.0);
            let over = _mm_castps_si128(_mm_cmpge_ps(self.0, _mm_set1_ps(2_147_483_648.0)));
            let number = _mm_castps_si128(_mm_cmpord_ps(self.0, self.0));
            _mm_and_si128(_mm_xor_si128(x, over), number)
        })
    }
    #[inline(always)]
    fn to_uint(self) -> Uint4<I> {
        Uint4::new(intrinsics! {
            let x = _mm_max_ps(self.0, _mm_setzero_ps());
            let half = _mm_set1_ps(2_147_483_648.0);
            let upper = _mm_cmpge_ps(x, half);
            let low = _mm_cvttps_epi32(_mm_sub_ps(x, _mm_and_ps(upper, half)));
            let sign = _mm_and_si128(_mm_castps_si128(upper), _mm_set1_epi32(i32::MIN));
            let over = _mm_castps_si128(_mm_cmpge_ps(x, _mm_set1_ps(4_294_967_296.0)));
            _mm_or_si128(_mm_xor_si128(low, sign), over)
        })
    }
    #[inline(always)]
    fn from_int(x: Int4<I>) -> Self {
        Self::new(intrinsics!(_mm_cvtepi32_ps(x.0)))
    }
    #[inline(always)]
    fn from_uint(x: Uint4<I>) -> Self {
        // Two exact halves, one rounding.
        Self::new(intrinsics! {
            let high = _mm_cvtepi32_ps(_mm_srli_epi32::<16>(x.0));
            let low = _mm_cvtepi32_ps(_mm_and_si128(x.0, _mm_set1_epi32(0xffff)));
            _mm_add_ps(_mm_mul_ps(high, _mm_set1_ps(65_536.0)), low)
        })
    }
    #[inline(always)]
    fn to_bits(self) -> Uint4<I> {
        Uint4::of_ps(self.0)
    }
    #[inline(always)]
    fn from_bits(x: Uint4<I>) -> Self {
        Self::new(x.ps())
    }
    #[inline(always)]
    fn reduce_add(self) -> f32 {
        let two = self + Self::new(upper_half(self.0));
        (two + Self::new(lane1(two.0))).first()
    }
}
