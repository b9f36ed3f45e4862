//! x86, four `f64` in two registers of two.

use super::*;
use crate::backend::quad::{Quad, mul_add_each};
use crate::backend::soft;

/// The lower two lanes, the upper two.
#[derive(Clone, Copy)]
pub struct Doubles<I>(__m128d, __m128d, PhantomData<I>);

/// A method that does the same to both halves: one intrinsic.
macro_rules! both {
    ($($name:ident($($arg:ident),*) = $intrinsic:ident;)*) => {$(
        #[inline(always)]
        fn $name(self $(, $arg: Self)*) -> Self {
            intrinsics!(Self::new($intrinsic(self.0 $(, $arg.0)*), $intrinsic(self.1 $(, $arg.1)*)))
        }
    )*};
}

/// A comparison of both halves, as a mask of four lanes.
macro_rules! compare {
    ($($name:ident = $intrinsic:ident;)*) => {$(
        #[inline(always)]
        fn $name(self, other: Self) -> Bool4<I> {
            Bool4::new(intrinsics! {
                let (low, high) = ($intrinsic(self.0, other.0), $intrinsic(self.1, other.1));
                _mm_shuffle_ps::<0b10_00_10_00>(_mm_castpd_ps(low), _mm_castpd_ps(high))
            })
        }
    )*};
}

/// Rounding: an instruction of SSE4.1, else each lane by itself.
macro_rules! round {
    ($($name:ident = $mode:ident or $soft:ident;)*) => {$(
        #[inline(always)]
        fn $name(self) -> Self {
            if const { I::SSE41 } {
                const MODE: i32 = $mode | _MM_FROUND_NO_EXC;
                intrinsics!(Self::new(_mm_round_pd::<MODE>(self.0), _mm_round_pd::<MODE>(self.1)))
            } else {
                self.each(soft::double::$soft)
            }
        }
    )*};
}

impl<I: Sse> Doubles<I> {
    #[inline(always)]
    fn new(low: __m128d, high: __m128d) -> Self {
        Self(low, high, PhantomData)
    }
}

impl<I: Sse> Quad for Doubles<I> {
    type Mask = Bool4<I>;
    type Index = Uint4<I>;

    #[inline(always)]
    fn splat(x: f64) -> Self {
        intrinsics!(Self::new(_mm_set1_pd(x), _mm_set1_pd(x)))
    }
    #[inline(always)]
    fn load(src: &[f64; 4]) -> Self {
        let src: *const f64 = src.as_ptr();
        // SAFETY: four elements are there to read.
        unsafe { Self::new(_mm_loadu_pd(src), _mm_loadu_pd(src.add(2))) }
    }
    #[inline(always)]
    fn store(self, dst: &mut [f64; 4]) {
        let dst: *mut f64 = dst.as_mut_ptr();
        // SAFETY: four elements are there to write.
        unsafe {
            _mm_storeu_pd(dst, self.0);
            _mm_storeu_pd(dst.add(2), self.1);
        }
    }
    #[inline(always)]
    fn select(mask: Bool4<I>, on_true: Self, on_false: Self) -> Self {
        // Both halves of a lane of 64 bits are what the lane of 32 bits is.
        let (low, high) = intrinsics! {
            (_mm_castps_pd(_mm_unpacklo_ps(mask.0, mask.0)), _mm_castps_pd(_mm_unpackhi_ps(mask.0, mask.0)))
        };
        let half = |mask, t, f| {
            if const { I::SSE41 } {
                intrinsics!(_mm_blendv_pd(f, t, mask))
            } else {
                intrinsics!(_mm_or_pd(_mm_and_pd(mask, t), _mm_andnot_pd(mask, f)))
            }
        };
        Self::new(half(low, on_true.0, on_false.0), half(high, on_true.1, on_false.1))
    }
    compare! {
        eq = _mm_cmpeq_pd;
        lt = _mm_cmplt_pd;
        le = _mm_cmple_pd;
    }
    both! {
        min(other) = _mm_min_pd;
        max(other) = _mm_max_pd;
        add(other) = _mm_add_pd;
        sub(other) = _mm_sub_pd;
        mul(other) = _mm_mul_pd;
        div(other) = _mm_div_pd;
        xor(other) = _mm_xor_pd;
        and(other) = _mm_and_pd;
        sqrt() = _mm_sqrt_pd;
    }
    round! {
        floor = _MM_FROUND_TO_NEG_INF or floor;
        ceil = _MM_FROUND_TO_POS_INF or ceil;
        trunc = _MM_FROUND_TO_ZERO or trunc;
        round = _MM_FROUND_TO_NEAREST_INT or round_ties_even;
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self.mul(b).add(c)
    }
    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        c.sub(self.mul(b))
    }
    #[inline(always)]
    fn mul_add_exact(self, b: Self, c: Self) -> Self {
        mul_add_each(self, b, c)
    }
}
