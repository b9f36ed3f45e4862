//! AVX-512: floats.

use super::lanes::*;
use super::*;

vector! { Float16, avx2::Float8, sse::Float4<Avx2>, f32, x: splat _mm512_set1_ps(x), {
    #[inline(always)]
    fn eq(self, other: Self) -> Bool16 {
        Bool16(intrinsics!(_mm512_cmp_ps_mask::<_CMP_EQ_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Bool16 {
        Bool16(intrinsics!(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Bool16 {
        Bool16(intrinsics!(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn ne(self, other: Self) -> Bool16 {
        Bool16(intrinsics!(_mm512_cmp_ps_mask::<_CMP_NEQ_UQ>(self.0, other.0)))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm512_min_ps(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm512_max_ps(self.0, other.0)))
    }
} }

operators!([] Float16:
    Add add AddAssign add_assign = _mm512_add_ps;
    Sub sub SubAssign sub_assign = _mm512_sub_ps;
    Mul mul MulAssign mul_assign = _mm512_mul_ps;
    Div div DivAssign div_assign = _mm512_div_ps;
);

impl Neg for Float16 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(intrinsics!(_mm512_xor_ps(self.0, _mm512_set1_ps(-0.0))))
    }
}

impl Float for Float16 {
    type Int = Int16;

    #[inline(always)]
    fn abs(self) -> Self {
        Self::new(intrinsics!(_mm512_andnot_ps(_mm512_set1_ps(-0.0), self.0)))
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Self::new(intrinsics! {
            let bit = _mm512_set1_ps(-0.0);
            _mm512_or_ps(_mm512_andnot_ps(bit, self.0), _mm512_and_ps(bit, sign.0))
        })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::new(intrinsics!(_mm512_sqrt_ps(self.0)))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self::new(intrinsics!(_mm512_roundscale_ps::<{ _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC }>(self.0)))
    }
    #[inline(always)]
    fn ceil(self) -> Self {
        Self::new(intrinsics!(_mm512_roundscale_ps::<{ _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC }>(self.0)))
    }
    #[inline(always)]
    fn trunc(self) -> Self {
        Self::new(intrinsics!(_mm512_roundscale_ps::<{ _MM_FROUND_TO_ZERO | _MM_FROUND_NO_EXC }>(self.0)))
    }
    #[inline(always)]
    fn round(self) -> Self {
        Self::new(intrinsics!(_mm512_roundscale_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(self.0)))
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self::new(intrinsics!(_mm512_fmadd_ps(self.0, b.0, c.0)))
    }
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        Self::new(intrinsics!(_mm512_fmsub_ps(self.0, b.0, c.0)))
    }
    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        Self::new(intrinsics!(_mm512_fnmadd_ps(self.0, b.0, c.0)))
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
        Self::new(intrinsics!(_mm512_fnmsub_ps(self.0, b.0, c.0)))
    }
    #[inline(always)]
    fn rcp_approx(self) -> Self {
        Self::new(intrinsics!(_mm512_rcp14_ps(self.0)))
    }
    #[inline(always)]
    fn rsqrt_approx(self) -> Self {
        Self::new(intrinsics!(_mm512_rsqrt14_ps(self.0)))
    }
    #[inline(always)]
    fn load_f16(src: &[u16]) -> Self {
        let src: *const u16 = src[..16].as_ptr();
        // SAFETY: sixteen elements are there to read.
        Self::new(unsafe { _mm512_cvtph_ps(_mm256_loadu_si256(src.cast())) })
    }
    #[inline(always)]
    fn store_f16(self, dst: &mut [u16]) {
        let dst: *mut u16 = dst[..16].as_mut_ptr();
        // SAFETY: sixteen elements are there to write.
        unsafe { _mm256_storeu_si256(dst.cast(), _mm512_cvtps_ph::<_MM_FROUND_TO_NEAREST_INT>(self.0)) }
    }

    #[inline(always)]
    fn to_int(self) -> Int16 {
        // Out of range gives i32::MIN, also above: there it is replaced. NaN is zeroed by its mask.
        Int16::new(intrinsics! {
            let over = _mm512_cmp_ps_mask::<_CMP_GE_OQ>(self.0, _mm512_set1_ps(2_147_483_648.0));
            let number = _mm512_cmp_ps_mask::<_CMP_ORD_Q>(self.0, self.0);
            _mm512_mask_mov_epi32(_mm512_maskz_cvttps_epi32(number, self.0), over, _mm512_set1_epi32(i32::MAX))
        })
    }
    #[inline(always)]
    fn to_uint(self) -> Uint16 {
        // Above the range the instruction gives u32::MAX; NaN and negative numbers are made 0 first.
        Uint16::new(intrinsics!(_mm512_cvttps_epu32(_mm512_max_ps(self.0, _mm512_setzero_ps()))))
    }
    #[inline(always)]
    fn from_int(x: Int16) -> Self {
        Self::new(intrinsics!(_mm512_cvtepi32_ps(x.0)))
    }
    #[inline(always)]
    fn from_uint(x: Uint16) -> Self {
        Self::new(intrinsics!(_mm512_cvtepu32_ps(x.0)))
    }
    #[inline(always)]
    fn to_bits(self) -> Uint16 {
        Uint16::of_ps(self.0)
    }
    #[inline(always)]
    fn from_bits(x: Uint16) -> Self {
        Self::new(x.ps())
    }
    #[inline(always)]
    fn reduce_add(self) -> f32 {
        let (low, high) = self.halves();
        (low + high).reduce_add()
    }
}
