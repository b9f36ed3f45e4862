//! AVX2 and FMA: four `f64`. AVX-512 takes them too.

use super::*;
use crate::backend::quad::Quad;

/// Four `f64` in a register.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct Doubles(__m256d);

/// A method that is one intrinsic.
macro_rules! one {
    ($($name:ident($($arg:ident),*) = $intrinsic:ident $(::<$mode:ident>)?;)*) => {$(
        #[inline(always)]
        fn $name(self $(, $arg: Self)*) -> Self {
            Self(intrinsics!($intrinsic $(::<{ $mode | _MM_FROUND_NO_EXC }>)? (self.0 $(, $arg.0)*)))
        }
    )*};
}

/// A comparison, as a mask of lanes of 32 bits.
macro_rules! compare {
    ($($name:ident = $predicate:ident;)*) => {$(
        #[inline(always)]
        fn $name(self, other: Self) -> sse::Bool4<Avx2> {
            sse::Bool4::new(intrinsics! {
                let mask = _mm256_castpd_ps(_mm256_cmp_pd::<$predicate>(self.0, other.0));
                _mm_shuffle_ps::<0b10_00_10_00>(_mm256_castps256_ps128(mask), _mm256_extractf128_ps::<1>(mask))
            })
        }
    )*};
}

impl Quad for Doubles {
    type Mask = sse::Bool4<Avx2>;
    type Index = sse::Uint4<Avx2>;

    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self(intrinsics!(_mm256_set1_pd(x)))
    }
    #[inline(always)]
    fn load(src: &[f64; 4]) -> Self {
        let src: *const f64 = src.as_ptr();
        // SAFETY: four elements are there to read.
        Self(unsafe { _mm256_loadu_pd(src) })
    }
    #[inline(always)]
    fn store(self, dst: &mut [f64; 4]) {
        let dst: *mut f64 = dst.as_mut_ptr();
        // SAFETY: four elements are there to write.
        unsafe { _mm256_storeu_pd(dst, self.0) }
    }
    #[inline(always)]
    fn select(mask: sse::Bool4<Avx2>, on_true: Self, on_false: Self) -> Self {
        let mask = mask.ps();
        Self(intrinsics! {
            let mask = _mm256_castsi256_pd(_mm256_cvtepi32_epi64(_mm_castps_si128(mask)));
            _mm256_blendv_pd(on_false.0, on_true.0, mask)
        })
    }
    compare! {
        eq = _CMP_EQ_OQ;
        lt = _CMP_LT_OQ;
        le = _CMP_LE_OQ;
    }
    one! {
        min(other) = _mm256_min_pd;
        max(other) = _mm256_max_pd;
        add(other) = _mm256_add_pd;
        sub(other) = _mm256_sub_pd;
        mul(other) = _mm256_mul_pd;
        div(other) = _mm256_div_pd;
        xor(other) = _mm256_xor_pd;
        and(other) = _mm256_and_pd;
        sqrt() = _mm256_sqrt_pd;
        floor() = _mm256_round_pd::<_MM_FROUND_TO_NEG_INF>;
        ceil() = _mm256_round_pd::<_MM_FROUND_TO_POS_INF>;
        trunc() = _mm256_round_pd::<_MM_FROUND_TO_ZERO>;
        round() = _mm256_round_pd::<_MM_FROUND_TO_NEAREST_INT>;
        mul_add(b, c) = _mm256_fmadd_pd;
        neg_mul_add(b, c) = _mm256_fnmadd_pd;
        mul_add_exact(b, c) = _mm256_fmadd_pd;
    }
}
