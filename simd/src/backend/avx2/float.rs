//! AVX2: floats.

use super::lanes::*;
use super::*;

vector! { Float8, sse::Float4<Avx2>, f32, x: splat _mm256_set1_ps(x), {
    #[inline(always)]
    fn eq(self, other: Self) -> Bool8 {
        Bool8::new(intrinsics!(_mm256_cmp_ps::<_CMP_EQ_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Bool8 {
        Bool8::new(intrinsics!(_mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Bool8 {
        Bool8::new(intrinsics!(_mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn ne(self, other: Self) -> Bool8 {
        Bool8::new(intrinsics!(_mm256_cmp_ps::<_CMP_NEQ_UQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_min_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_max_ps(self.0, other.0)))
    }
} }

operators!([] Float8:
    Add add AddAssign add_assign = _mm256_add_ps;
    Sub sub SubAssign sub_assign = _mm256_sub_ps;
    Mul mul MulAssign mul_assign = _mm256_mul_ps;
    Div div DivAssign div_assign = _mm256_div_ps;
);

impl Neg for Float8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(intrinsics!(_mm256_xor_ps(self.0, _mm256_set1_ps(-0.0))))
    }
}

impl Float for Float8 {
    type Int = Int8;

    #[inline(always)]
    fn abs(self) -> Self {
        Self::new(intrinsics!(_mm256_andnot_ps(_mm256_set1_ps(-0.0), self.0)))
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Self::new(intrinsics! {
            let bit = _mm256_set1_ps(-0.0);
            _mm256_or_ps(_mm256_andnot_ps(bit, self.0), _mm256_and_ps(bit, sign.0))
        })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::new(intrinsics!(_mm256_sqrt_ps(self.0)))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self::new(intrinsics!(_mm256_floor_ps(self.0)))
    }
    #[inline(always)]
    fn ceil(self) -> Self {
        Self::new(intrinsics!(_mm256_ceil_ps(self.0)))
    }
    #[inline(always)]
    fn trunc(self) -> Self {
        Self::new(intrinsics!(_mm256_round_ps::<{ _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC }>(self.0)))
    }
    #[inline(always)]
    fn round(self) -> Self {
        Self::new(intrinsics!(_mm256_round_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(self.0)))
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self::new(intrinsics!(_mm256_fmadd_ps(self.0, b.0, c.0)))
    }
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        Self::new(intrinsics!(_mm256_fmsub_ps(self.0, b.0, c.0)))
    }
    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        Self::new(intrinsics!(_mm256_fnmadd_ps(self.0, b.0, c.0)))
    }

    #[inline(always)]
    fn mul_add_exact(self, b: Self, c: Self) -> Self {
        self.mul_add(b, c)
    }
    #[inline(always)]
    fn product_error(self, b: Self, product: Self) -> Self {
        self.mul_sub(b, product)
    }
    #[inline(always)]
    fn neg_mul_sub(self, b: Self, c: Self) -> Self {
        Self::new(intrinsics!(_mm256_fnmsub_ps(self.0, b.0, c.0)))
    }
    #[inline(always)]
    fn rcp_approx(self) -> Self {
        Self::new(intrinsics!(_mm256_rcp_ps(self.0)))
    }
    #[inline(always)]
    fn rsqrt_approx(self) -> Self {
        Self::new(intrinsics!(_mm256_rsqrt_ps(self.0)))
    }
    #[inline(always)]
    fn load_f16(src: &[u16]) -> Self {
        let src: *const u16 = src[..8].as_ptr();
        // SAFETY: eight elements are there to read.
        Self::new(unsafe { _mm256_cvtph_ps(_mm_loadu_si128(src.cast())) })
    }
    #[inline(always)]
    fn store_f16(self, dst: &mut [u16]) {
        let dst: *mut u16 = dst[..8].as_mut_ptr();
        // SAFETY: eight elements are there to write.
        unsafe { _mm_storeu_si128(dst.cast(), _mm256_cvtps_ph::<_MM_FROUND_TO_NEAREST_INT>(self.0)) }
    }

    #[inline(always)]
    fn to_int(self) -> Int8 {
        // Out of range gives i32::MIN: all bits flipped that is i32::MAX. NaN is cleared.
        Int8::new(intrinsics! {
            let x = _mm256_cvttps_epi32(self.0);
            let over = _mm256_castps_si256(_mm256_cmp_ps::<_CMP_GE_OQ>(self.0, _mm256_set1_ps(2_147_483_648.0)));
            let number = _mm256_castps_si256(_mm256_cmp_ps::<_CMP_ORD_Q>(self.0, self.0));
            _mm256_and_si256(_mm256_xor_si256(x, over), number)
        })
    }
    #[inline(always)]
    fn to_uint(self) -> Uint8 {
        Uint8::new(intrinsics! {
            let x = _mm256_max_ps(self.0, _mm256_setzero_ps());
            let half = _mm256_set1_ps(2_147_483_648.0);
            let upper = _mm256_cmp_ps::<_CMP_GE_OQ>(x, half);
            let low = _mm256_cvttps_epi32(_mm256_sub_ps(x, _mm256_and_ps(upper, half)));
            let sign = _mm256_and_si256(_mm256_castps_si256(upper), _mm256_set1_epi32(i32::MIN));
            let over = _mm256_castps_si256(_mm256_cmp_ps::<_CMP_GE_OQ>(x, _mm256_set1_ps(4_294_967_296.0)));
            _mm256_or_si256(_mm256_xor_si256(low, sign), over)
        })
    }
    #[inline(always)]
    fn from_int(x: Int8) -> Self {
        Self::new(intrinsics!(_mm256_cvtepi32_ps(x.0)))
    }
    #[inline(always)]
    fn from_uint(x: Uint8) -> Self {
        // Two exact halves, one rounding.
        Self::new(intrinsics! {
            let high = _mm256_cvtepi32_ps(_mm256_srli_epi32::<16>(x.0));
            let low = _mm256_cvtepi32_ps(_mm256_and_si256(x.0, _mm256_set1_epi32(0xffff)));
            _mm256_add_ps(_mm256_mul_ps(high, _mm256_set1_ps(65_536.0)), low)
        })
    }
    #[inline(always)]
    fn to_bits(self) -> Uint8 {
        Uint8::of_ps(self.0)
    }
    #[inline(always)]
    fn from_bits(x: Uint8) -> Self {
        Self::new(x.ps())
    }
    #[inline(always)]
    fn reduce_add(self) -> f32 {
        let (low, high) = self.halves();
        (low + high).reduce_add()
    }
}
