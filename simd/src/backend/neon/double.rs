//! NEON: four `f64` in two registers of two.

use super::*;
use crate::backend::quad::Quad;

/// The lower two lanes, the upper two.
#[derive(Clone, Copy)]
pub struct Doubles(float64x2_t, float64x2_t);

/// A method that does the same to both halves: one intrinsic.
macro_rules! both {
    ($($name:ident($($arg:ident),*) = $intrinsic:ident;)*) => {$(
        #[inline(always)]
        fn $name(self $(, $arg: Self)*) -> Self {
            intrinsics!(Self($intrinsic(self.0 $(, $arg.0)*), $intrinsic(self.1 $(, $arg.1)*)))
        }
    )*};
}

/// A comparison of both halves, as a mask of four lanes.
macro_rules! compare {
    ($($name:ident = $intrinsic:ident;)*) => {$(
        #[inline(always)]
        fn $name(self, other: Self) -> Bool4 {
            Bool4(intrinsics! {
                let (low, high) = ($intrinsic(self.0, other.0), $intrinsic(self.1, other.1));
                vuzp1q_u32(vreinterpretq_u32_u64(low), vreinterpretq_u32_u64(high))
            })
        }
    )*};
}

impl Quad for Doubles {
    type Mask = Bool4;
    type Index = Uint4;

    #[inline(always)]
    fn splat(x: f64) -> Self {
        intrinsics!(Self(vdupq_n_f64(x), vdupq_n_f64(x)))
    }
    #[inline(always)]
    fn load(src: &[f64; 4]) -> Self {
        let src: *const f64 = src.as_ptr();
        // SAFETY: four elements are there to read.
        unsafe { Self(vld1q_f64(src), vld1q_f64(src.add(2))) }
    }
    #[inline(always)]
    fn store(self, dst: &mut [f64; 4]) {
        let dst: *mut f64 = dst.as_mut_ptr();
        // SAFETY: four elements are there to write.
        unsafe {
            vst1q_f64(dst, self.0);
            vst1q_f64(dst.add(2), self.1);
        }
    }
    #[inline(always)]
    fn select(mask: Bool4, on_true: Self, on_false: Self) -> Self {
        // Both halves of a lane of 64 bits are what the lane of 32 bits is.
        intrinsics! {
            let (low, high) = (vzip1q_u32(mask.0, mask.0), vzip2q_u32(mask.0, mask.0));
            let (low, high) = (vreinterpretq_u64_u32(low), vreinterpretq_u64_u32(high));
            Self(vbslq_f64(low, on_true.0, on_false.0), vbslq_f64(high, on_true.1, on_false.1))
        }
    }
    compare! {
        eq = vceqq_f64;
        lt = vcltq_f64;
        le = vcleq_f64;
    }
    // Not the instructions of these names: they return NaN when either is, and order the zeros.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        intrinsics! {
            let (low, high) = (vcltq_f64(self.0, other.0), vcltq_f64(self.1, other.1));
            Self(vbslq_f64(low, self.0, other.0), vbslq_f64(high, self.1, other.1))
        }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        intrinsics! {
            let (low, high) = (vcgtq_f64(self.0, other.0), vcgtq_f64(self.1, other.1));
            Self(vbslq_f64(low, self.0, other.0), vbslq_f64(high, self.1, other.1))
        }
    }
    both! {
        add(other) = vaddq_f64;
        sub(other) = vsubq_f64;
        mul(other) = vmulq_f64;
        div(other) = vdivq_f64;
        sqrt() = vsqrtq_f64;
        floor() = vrndmq_f64;
        ceil() = vrndpq_f64;
        trunc() = vrndq_f64;
        round() = vrndnq_f64;
    }
    #[inline(always)]
    fn xor(self, other: Self) -> Self {
        let xor =
            |a, b| intrinsics!(vreinterpretq_f64_u64(veorq_u64(vreinterpretq_u64_f64(a), vreinterpretq_u64_f64(b))));
        Self(xor(self.0, other.0), xor(self.1, other.1))
    }
    #[inline(always)]
    fn and(self, other: Self) -> Self {
        let and =
            |a, b| intrinsics!(vreinterpretq_f64_u64(vandq_u64(vreinterpretq_u64_f64(a), vreinterpretq_u64_f64(b))));
        Self(and(self.0, other.0), and(self.1, other.1))
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        intrinsics!(Self(vfmaq_f64(c.0, self.0, b.0), vfmaq_f64(c.1, self.1, b.1)))
    }
    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        intrinsics!(Self(vfmsq_f64(c.0, self.0, b.0), vfmsq_f64(c.1, self.1, b.1)))
    }
    #[inline(always)]
    fn mul_add_exact(self, b: Self, c: Self) -> Self {
        self.mul_add(b, c)
    }
}
