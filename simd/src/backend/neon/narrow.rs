//! NEON, sixteen bytes: 16- and 8-bit integers.

use super::super::narrow_basics;
use super::*;
use crate::{Char, Narrow, Short, UChar, UShort};

// ---- Masks ----

/// A mask type over its register, with its conversions.
macro_rules! mask {
    (
        $M:ident($reg:ty), $n:literal: $and:ident $or:ident $xor:ident $not:ident $dup:ident $min:ident $max:ident,
        $bits:ident: from $from:expr, $x:ident: to $to:expr
    ) => {
        /// All bits of a true lane are ones, all of a false lane zeros.
        #[derive(Clone, Copy)]
        #[repr(transparent)]
        pub struct $M($reg);
        impl $M {
            #[inline(always)]
            fn new(x: $reg) -> Self {
                Self(x)
            }
        }
        mask_basics!([] $M);
        operators!([] $M:
            BitAnd bitand BitAndAssign bitand_assign = $and;
            BitOr bitor BitOrAssign bitor_assign = $or;
            BitXor bitxor BitXorAssign bitxor_assign = $xor;
        );
        impl Not for $M {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self(intrinsics!($not(self.0)))
            }
        }
        impl Mask for $M {
            const LANES: usize = $n;

            #[inline(always)]
            fn splat(value: bool) -> Self {
                Self(intrinsics!($dup(if value { !0 } else { 0 })))
            }
            #[inline(always)]
            fn from_bitmask($bits: u32) -> Self {
                Self(intrinsics!($from))
            }
            #[inline(always)]
            fn bitmask(self) -> u32 {
                let $x = self.0;
                intrinsics!($to)
            }
            #[inline(always)]
            fn any(self) -> bool {
                intrinsics!($max(self.0)) != 0
            }
            #[inline(always)]
            fn all(self) -> bool {
                intrinsics!($min(self.0)) != 0
            }
        }
    };
}
mask! { ShortBool8(uint16x8_t), 8: vandq_u16 vorrq_u16 veorq_u16 vmvnq_u16 vdupq_n_u16 vminvq_u16 vmaxvq_u16,
    bits: from vtstq_u16(vdupq_n_u16(bits as u16), UShort8::load(&[1, 2, 4, 8, 16, 32, 64, 128]).0),
    x: to vaddvq_u16(vandq_u16(x, UShort8::load(&[1, 2, 4, 8, 16, 32, 64, 128]).0)).into()
}
mask! { CharBool16(uint8x16_t), 16: vandq_u8 vorrq_u8 veorq_u8 vmvnq_u8 vdupq_n_u8 vminvq_u8 vmaxvq_u8,
    bits: from vtstq_u8(vcombine_u8(vdup_n_u8(bits as u8), vdup_n_u8((bits >> 8) as u8)), byte_bits()),
    x: to {
        let bits = vandq_u8(x, byte_bits());
        u32::from(vaddv_u8(vget_low_u8(bits))) | u32::from(vaddv_u8(vget_high_u8(bits))) << 8
    }
}

/// The bit of each lane in its byte of a bit mask.
#[inline(always)]
fn byte_bits() -> uint8x16_t {
    intrinsics!(vreinterpretq_u8_u64(vdupq_n_u64(0x8040_2010_0804_0201)))
}

// ---- Vectors ----

/// A vector type over its register: [`Narrow`] and the operators from the intrinsics of its lane type.
macro_rules! narrow {
    (
        $(#[$doc:meta])* $V:ident($reg:ty): $n:literal $Lane:ty, $Sum:ty, $M:ident $Signed:ident $Unsigned:ident $Wide:ident;
        $dup:ident $ld1:ident $st1:ident $add:ident $sub:ident $mul:ident $and:ident $or:ident $xor:ident $not:ident;
        $shift:ident $dup_count:ident $min:ident $max:ident $qadd:ident $qsub:ident $average:ident;
        $eq:ident $lt:ident $le:ident $select:ident $zip1:ident $zip2:ident $sum:ident;
        $get_low:ident $mull:ident $mull_high:ident $halves:ident $odd:ident $movl:ident $movl_high:ident;
        $qmovn:ident $qmovn_high:ident, $a:ident $b:ident: signed $signed:expr, unsigned $unsigned:expr, difference $difference:expr
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy)]
        #[repr(transparent)]
        pub struct $V($reg);
        impl $V {
            #[inline(always)]
            fn new(x: $reg) -> Self {
                Self(x)
            }
        }
        narrow_basics!([] $V);
        operators!([] $V:
            Add add AddAssign add_assign = $add;
            Sub sub SubAssign sub_assign = $sub;
            Mul mul MulAssign mul_assign = $mul;
            BitAnd bitand BitAndAssign bitand_assign = $and;
            BitOr bitor BitOrAssign bitor_assign = $or;
            BitXor bitxor BitXorAssign bitxor_assign = $xor;
        );
        impl Not for $V {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self(intrinsics!($not(self.0)))
            }
        }
        impl Shl<usize> for $V {
            type Output = Self;
            #[inline(always)]
            fn shl(self, n: usize) -> Self {
                let n = n % <$Lane>::BITS as usize;
                Self(intrinsics!($shift(self.0, $dup_count(n as _))))
            }
        }
        impl Shr<usize> for $V {
            type Output = Self;
            #[inline(always)]
            fn shr(self, n: usize) -> Self {
                // To the right is to the left by a negative count.
                let n = n % <$Lane>::BITS as usize;
                Self(intrinsics!($shift(self.0, $dup_count(-(n as i32) as _))))
            }
        }
        impl Narrow for $V {
            type Lane = $Lane;
            type Mask = $M;
            type Signed = $Signed;
            type Unsigned = $Unsigned;
            type Wide = $Wide;
            type Sum = $Sum;
            const LANES: usize = $n;

            #[inline(always)]
            fn splat(x: $Lane) -> Self {
                Self(intrinsics!($dup(x)))
            }
            #[inline(always)]
            fn load(src: &[$Lane]) -> Self {
                let src: *const $Lane = src[..$n].as_ptr();
                // SAFETY: sixteen bytes are there to read.
                Self(unsafe { $ld1(src) })
            }
            #[inline(always)]
            fn store(self, dst: &mut [$Lane]) {
                let dst: *mut $Lane = dst[..$n].as_mut_ptr();
                // SAFETY: sixteen bytes are there to write.
                unsafe { $st1(dst, self.0) }
            }
            #[inline(always)]
            fn select(mask: $M, on_true: Self, on_false: Self) -> Self {
                Self(intrinsics!($select(mask.0, on_true.0, on_false.0)))
            }
            #[inline(always)]
            fn eq(self, other: Self) -> $M {
                $M(intrinsics!($eq(self.0, other.0)))
            }
            #[inline(always)]
            fn lt(self, other: Self) -> $M {
                $M(intrinsics!($lt(self.0, other.0)))
            }
            #[inline(always)]
            fn le(self, other: Self) -> $M {
                $M(intrinsics!($le(self.0, other.0)))
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                Self(intrinsics!($min(self.0, other.0)))
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                Self(intrinsics!($max(self.0, other.0)))
            }
            #[inline(always)]
            fn saturating_add(self, other: Self) -> Self {
                Self(intrinsics!($qadd(self.0, other.0)))
            }
            #[inline(always)]
            fn saturating_sub(self, other: Self) -> Self {
                Self(intrinsics!($qsub(self.0, other.0)))
            }
            #[inline(always)]
            fn mul_high(self, other: Self) -> Self {
                // The products' upper halves are in the odd places.
                Self(intrinsics! {
                    let low = $halves($mull($get_low(self.0), $get_low(other.0)));
                    $odd(low, $halves($mull_high(self.0, other.0)))
                })
            }
            #[inline(always)]
            fn abs_diff(self, other: Self) -> $Unsigned {
                let ($a, $b) = (self.0, other.0);
                $Unsigned(intrinsics!($difference))
            }
            #[inline(always)]
            fn average(self, other: Self) -> Self {
                Self(intrinsics!($average(self.0, other.0)))
            }
            #[inline(always)]
            fn to_signed(self) -> $Signed {
                let $a = self.0;
                $Signed($signed)
            }
            #[inline(always)]
            fn to_unsigned(self) -> $Unsigned {
                let $a = self.0;
                $Unsigned($unsigned)
            }
            #[inline(always)]
            fn widen(self) -> ($Wide, $Wide) {
                let (low, high) = intrinsics!(($movl($get_low(self.0)), $movl_high(self.0)));
                ($Wide::new(low), $Wide::new(high))
            }
            #[inline(always)]
            fn narrow(low: $Wide, high: $Wide) -> Self {
                Self(intrinsics!($qmovn_high($qmovn(low.0), high.0)))
            }
            #[inline(always)]
            fn interleave(self, other: Self) -> (Self, Self) {
                let (low, high) = intrinsics!(($zip1(self.0, other.0), $zip2(self.0, other.0)));
                (Self(low), Self(high))
            }
            #[inline(always)]
            fn reduce_add(self) -> $Sum {
                intrinsics!($sum(self.0)).into()
            }
        }
    };
}

narrow! {
    /// Eight `i16`.
    Short8(int16x8_t): 8 i16, i32, ShortBool8 Short8 UShort8 Int4;
    vdupq_n_s16 vld1q_s16 vst1q_s16 vaddq_s16 vsubq_s16 vmulq_s16 vandq_s16 vorrq_s16 veorq_s16 vmvnq_s16;
    vshlq_s16 vdupq_n_s16 vminq_s16 vmaxq_s16 vqaddq_s16 vqsubq_s16 vrhaddq_s16;
    vceqq_s16 vcltq_s16 vcleq_s16 vbslq_s16 vzip1q_s16 vzip2q_s16 vaddlvq_s16;
    vget_low_s16 vmull_s16 vmull_high_s16 vreinterpretq_s16_s32 vuzp2q_s16 vmovl_s16 vmovl_high_s16;
    vqmovn_s32 vqmovn_high_s32, a b: signed a, unsigned intrinsics!(vreinterpretq_u16_s16(a)),
    difference vreinterpretq_u16_s16(vabdq_s16(a, b))
}
impl Short for Short8 {}

narrow! {
    /// Eight `u16`.
    UShort8(uint16x8_t): 8 u16, u32, ShortBool8 Short8 UShort8 Uint4;
    vdupq_n_u16 vld1q_u16 vst1q_u16 vaddq_u16 vsubq_u16 vmulq_u16 vandq_u16 vorrq_u16 veorq_u16 vmvnq_u16;
    vshlq_u16 vdupq_n_s16 vminq_u16 vmaxq_u16 vqaddq_u16 vqsubq_u16 vrhaddq_u16;
    vceqq_u16 vcltq_u16 vcleq_u16 vbslq_u16 vzip1q_u16 vzip2q_u16 vaddlvq_u16;
    vget_low_u16 vmull_u16 vmull_high_u16 vreinterpretq_u16_u32 vuzp2q_u16 vmovl_u16 vmovl_high_u16;
    vqmovn_u32 vqmovn_high_u32, a b: signed intrinsics!(vreinterpretq_s16_u16(a)), unsigned a,
    difference vabdq_u16(a, b)
}
impl UShort for UShort8 {}

narrow! {
    /// Sixteen `i8`.
    Char16(int8x16_t): 16 i8, i32, CharBool16 Char16 UChar16 Short8;
    vdupq_n_s8 vld1q_s8 vst1q_s8 vaddq_s8 vsubq_s8 vmulq_s8 vandq_s8 vorrq_s8 veorq_s8 vmvnq_s8;
    vshlq_s8 vdupq_n_s8 vminq_s8 vmaxq_s8 vqaddq_s8 vqsubq_s8 vrhaddq_s8;
    vceqq_s8 vcltq_s8 vcleq_s8 vbslq_s8 vzip1q_s8 vzip2q_s8 vaddlvq_s8;
    vget_low_s8 vmull_s8 vmull_high_s8 vreinterpretq_s8_s16 vuzp2q_s8 vmovl_s8 vmovl_high_s8;
    vqmovn_s16 vqmovn_high_s16, a b: signed a, unsigned intrinsics!(vreinterpretq_u8_s8(a)),
    difference vreinterpretq_u8_s8(vabdq_s8(a, b))
}
impl Char for Char16 {}

narrow! {
    /// Sixteen `u8`.
    UChar16(uint8x16_t): 16 u8, u32, CharBool16 Char16 UChar16 UShort8;
    vdupq_n_u8 vld1q_u8 vst1q_u8 vaddq_u8 vsubq_u8 vmulq_u8 vandq_u8 vorrq_u8 veorq_u8 vmvnq_u8;
    vshlq_u8 vdupq_n_s8 vminq_u8 vmaxq_u8 vqaddq_u8 vqsubq_u8 vrhaddq_u8;
    vceqq_u8 vcltq_u8 vcleq_u8 vbslq_u8 vzip1q_u8 vzip2q_u8 vaddlvq_u8;
    vget_low_u8 vmull_u8 vmull_high_u8 vreinterpretq_u8_u16 vuzp2q_u8 vmovl_u8 vmovl_high_u8;
    vqmovn_u16 vqmovn_high_u16, a b: signed intrinsics!(vreinterpretq_s8_u8(a)), unsigned a,
    difference vabdq_u8(a, b)
}
impl UChar for UChar16 {
    #[inline(always)]
    fn narrow_signed(low: Short8, high: Short8) -> Self {
        Self(intrinsics!(vqmovun_high_s16(vqmovun_s16(low.0), high.0)))
    }
    #[inline(always)]
    fn sum_abs_diff(self, other: Self) -> u32 {
        self.abs_diff(other).reduce_add()
    }
    #[inline(always)]
    fn lookup(self, index: Self) -> Self {
        Self(intrinsics!(vqtbl1q_u8(self.0, vandq_u8(index.0, vdupq_n_u8(15)))))
    }
}
