//! x86, sixteen bytes: 16- and 8-bit integers.

use super::super::{mul_high_by_widening, narrow_basics};
use super::*;
use crate::vector::narrow::lanes;
use crate::{Char, Narrow, Short, UChar, UShort};

// ---- Registers and masks ----

/// A type over its register, and operators on all bits.
macro_rules! register {
    ($($(#[$doc:meta])* $V:ident;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy)]
        #[repr(transparent)]
        pub struct $V<I>(__m128i, PhantomData<I>);
        impl<I> $V<I> {
            #[inline(always)]
            fn new(x: __m128i) -> Self {
                Self(x, PhantomData)
            }
        }
        operators!([I: Sse] $V<I>:
            BitAnd bitand BitAndAssign bitand_assign = _mm_and_si128;
            BitOr bitor BitOrAssign bitor_assign = _mm_or_si128;
            BitXor bitxor BitXorAssign bitxor_assign = _mm_xor_si128;
        );
        impl<I: Sse> Not for $V<I> {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self::new(intrinsics!(_mm_xor_si128(self.0, _mm_set1_epi32(-1))))
            }
        }
    )*};
}
register! {
    /// Eight `i16`.
    Short8;
    /// Eight `u16`.
    UShort8;
    /// Sixteen `i8`.
    Char16;
    /// Sixteen `u8`.
    UChar16;
    /// All bits of a true lane are ones, all of a false lane zeros.
    ShortBool8;
    /// All bits of a true lane are ones, all of a false lane zeros.
    CharBool16;
}
narrow_basics!([I: Sse] Short8<I>, [I: Sse] UShort8<I>, [I: Sse] Char16<I>, [I: Sse] UChar16<I>);
mask_basics!([I: Sse] ShortBool8<I>);
mask_basics!([I: Sse] CharBool16<I>);

/// [`Mask`] from its conversions.
macro_rules! mask {
    ($M:ident, $n:literal, $bits:ident: from $from:expr, $x:ident: to $to:expr) => {
        impl<I: Sse> Mask for $M<I> {
            const LANES: usize = $n;

            #[inline(always)]
            fn splat(value: bool) -> Self {
                Self::new(intrinsics!(_mm_set1_epi32(-i32::from(value))))
            }
            #[inline(always)]
            fn from_bitmask($bits: u32) -> Self {
                Self::new(intrinsics!($from))
            }
            #[inline(always)]
            fn bitmask(self) -> u32 {
                let $x = self.0;
                intrinsics!($to)
            }
            #[inline(always)]
            fn any(self) -> bool {
                intrinsics!(_mm_movemask_epi8(self.0)) != 0
            }
            #[inline(always)]
            fn all(self) -> bool {
                intrinsics!(_mm_movemask_epi8(self.0)) == 0xffff
            }
        }
    };
}
mask! { ShortBool8, 8,
    bits: from {
        let bit = _mm_setr_epi16(1, 2, 4, 8, 16, 32, 64, 128);
        _mm_cmpeq_epi16(_mm_and_si128(_mm_set1_epi16(bits as i16), bit), bit)
    },
    x: to _mm_movemask_epi8(_mm_packs_epi16(x, _mm_setzero_si128())) as u32
}
mask! { CharBool16, 16,
    bits: from {
        // The first byte eight times, the second byte eight times.
        let twice = _mm_unpacklo_epi8(_mm_cvtsi32_si128(bits as i32), _mm_cvtsi32_si128(bits as i32));
        let four_times = _mm_unpacklo_epi16(twice, twice);
        let bytes = _mm_unpacklo_epi32(four_times, four_times);
        let bit = _mm_set1_epi64x(0x8040_2010_0804_0201_u64 as i64);
        _mm_cmpeq_epi8(_mm_and_si128(bytes, bit), bit)
    },
    x: to _mm_movemask_epi8(x) as u32
}

// ---- Vectors ----

/// [`Narrow`] of one lane type and its operators: what has one instruction for each lane type, and what is given.
macro_rules! narrow {
    (
        $V:ident: $n:literal $Lane:ty, $Sum:ty, $M:ident $Signed:ident $Unsigned:ident $Wide:ident;
        $splat:ident $add:ident $sub:ident $adds:ident $subs:ident $eq:ident $low:ident $high:ident;
        $a:ident $b:ident $count:ident: mul $mul:expr, shl $shl:expr, shr $shr:expr, { $($given:tt)* }
    ) => {
        operators!([I: Sse] $V<I>:
            Add add AddAssign add_assign = $add;
            Sub sub SubAssign sub_assign = $sub;
        );
        impl<I: Sse> Mul for $V<I> {
            type Output = Self;
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                let ($a, $b) = (self.0, other.0);
                Self::new(intrinsics!($mul))
            }
        }
        impl<I: Sse> MulAssign for $V<I> {
            #[inline(always)]
            fn mul_assign(&mut self, other: Self) {
                *self = *self * other;
            }
        }
        impl<I: Sse> Shl<usize> for $V<I> {
            type Output = Self;
            #[inline(always)]
            fn shl(self, n: usize) -> Self {
                let ($a, $count) = (self.0, n as i32 & (<$Lane>::BITS as i32 - 1));
                Self::new(intrinsics!($shl))
            }
        }
        impl<I: Sse> Shr<usize> for $V<I> {
            type Output = Self;
            #[inline(always)]
            fn shr(self, n: usize) -> Self {
                let ($a, $count) = (self.0, n as i32 & (<$Lane>::BITS as i32 - 1));
                Self::new(intrinsics!($shr))
            }
        }
        impl<I: Sse> Narrow for $V<I> {
            type Lane = $Lane;
            type Mask = $M<I>;
            type Signed = $Signed<I>;
            type Unsigned = $Unsigned<I>;
            type Wide = $Wide<I>;
            type Sum = $Sum;
            const LANES: usize = $n;

            #[inline(always)]
            fn splat(x: $Lane) -> Self {
                Self::new(intrinsics!($splat(x as _)))
            }
            #[inline(always)]
            fn load(src: &[$Lane]) -> Self {
                let src: *const $Lane = src[..$n].as_ptr();
                // SAFETY: sixteen bytes are there to read.
                Self::new(unsafe { _mm_loadu_si128(src.cast()) })
            }
            #[inline(always)]
            fn store(self, dst: &mut [$Lane]) {
                let dst: *mut $Lane = dst[..$n].as_mut_ptr();
                // SAFETY: sixteen bytes are there to write.
                unsafe { _mm_storeu_si128(dst.cast(), self.0) }
            }
            #[inline(always)]
            fn select(mask: $M<I>, on_true: Self, on_false: Self) -> Self {
                Self::new(intrinsics! {
                    if const { I::SSE41 } {
                        _mm_blendv_epi8(on_false.0, on_true.0, mask.0)
                    } else {
                        _mm_or_si128(_mm_and_si128(mask.0, on_true.0), _mm_andnot_si128(mask.0, on_false.0))
                    }
                })
            }
            #[inline(always)]
            fn eq(self, other: Self) -> $M<I> {
                $M::new(intrinsics!($eq(self.0, other.0)))
            }
            #[inline(always)]
            fn saturating_add(self, other: Self) -> Self {
                Self::new(intrinsics!($adds(self.0, other.0)))
            }
            #[inline(always)]
            fn saturating_sub(self, other: Self) -> Self {
                Self::new(intrinsics!($subs(self.0, other.0)))
            }
            #[inline(always)]
            fn to_signed(self) -> $Signed<I> {
                $Signed::new(self.0)
            }
            #[inline(always)]
            fn to_unsigned(self) -> $Unsigned<I> {
                $Unsigned::new(self.0)
            }
            #[inline(always)]
            fn interleave(self, other: Self) -> (Self, Self) {
                let (low, high) = intrinsics!(($low(self.0, other.0), $high(self.0, other.0)));
                (Self::new(low), Self::new(high))
            }
            #[inline(always)]
            fn reduce_add(self) -> $Sum {
                let (low, high) = self.widen();
                (low + high).reduce_add()
            }
            $($given)*
        }
    };
}

narrow! { Short8: 8 i16, i32, ShortBool8 Short8 UShort8 Int4;
    _mm_set1_epi16 _mm_add_epi16 _mm_sub_epi16 _mm_adds_epi16 _mm_subs_epi16 _mm_cmpeq_epi16
    _mm_unpacklo_epi16 _mm_unpackhi_epi16;
    a b n: mul _mm_mullo_epi16(a, b),
    shl _mm_sll_epi16(a, _mm_cvtsi32_si128(n)),
    shr _mm_sra_epi16(a, _mm_cvtsi32_si128(n)),
{
    #[inline(always)]
    fn lt(self, other: Self) -> ShortBool8<I> {
        ShortBool8::new(intrinsics!(_mm_cmplt_epi16(self.0, other.0)))
    }
    #[inline(always)]
    fn le(self, other: Self) -> ShortBool8<I> {
        !other.lt(self)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm_min_epi16(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm_max_epi16(self.0, other.0)))
    }
    #[inline(always)]
    fn mul_high(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm_mulhi_epi16(self.0, other.0)))
    }
    #[inline(always)]
    fn widen(self) -> (Int4<I>, Int4<I>) {
        // In the upper half of the wide lanes, then shifted down with the sign.
        let (low, high) = intrinsics!((_mm_unpacklo_epi16(self.0, self.0), _mm_unpackhi_epi16(self.0, self.0)));
        (Int4::new(low) >> 16, Int4::new(high) >> 16)
    }
    #[inline(always)]
    fn narrow(low: Int4<I>, high: Int4<I>) -> Self {
        Self::new(intrinsics!(_mm_packs_epi32(low.0, high.0)))
    }
} }
impl<I: Sse> Short for Short8<I> {}

narrow! { UShort8: 8 u16, u32, ShortBool8 Short8 UShort8 Uint4;
    _mm_set1_epi16 _mm_add_epi16 _mm_sub_epi16 _mm_adds_epu16 _mm_subs_epu16 _mm_cmpeq_epi16
    _mm_unpacklo_epi16 _mm_unpackhi_epi16;
    a b n: mul _mm_mullo_epi16(a, b),
    shl _mm_sll_epi16(a, _mm_cvtsi32_si128(n)),
    shr _mm_srl_epi16(a, _mm_cvtsi32_si128(n)),
{
    #[inline(always)]
    fn lt(self, other: Self) -> ShortBool8<I> {
        !other.le(self)
    }
    #[inline(always)]
    fn le(self, other: Self) -> ShortBool8<I> {
        self.saturating_sub(other).eq(Self::default())
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if const { I::SSE41 } {
            Self::new(intrinsics!(_mm_min_epu16(self.0, other.0)))
        } else {
            self - self.saturating_sub(other)
        }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if const { I::SSE41 } {
            Self::new(intrinsics!(_mm_max_epu16(self.0, other.0)))
        } else {
            other + self.saturating_sub(other)
        }
    }
    #[inline(always)]
    fn mul_high(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm_mulhi_epu16(self.0, other.0)))
    }
    #[inline(always)]
    fn average(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm_avg_epu16(self.0, other.0)))
    }
    #[inline(always)]
    fn widen(self) -> (Uint4<I>, Uint4<I>) {
        let (low, high) = self.interleave(Self::default());
        (Uint4::new(low.0), Uint4::new(high.0))
    }
    #[inline(always)]
    fn narrow(low: Uint4<I>, high: Uint4<I>) -> Self {
        let (low, high) = (low.min(Uint4::splat(0xffff)), high.min(Uint4::splat(0xffff)));
        if const { I::SSE41 } {
            return Self::new(intrinsics!(_mm_packus_epi32(low.0, high.0)));
        }
        // The sixteen bits as signed numbers, which the signed instruction leaves as they are.
        let (low, high) = (Int4::from_uint(low << 16) >> 16, Int4::from_uint(high << 16) >> 16);
        Short8::narrow(low, high).to_unsigned()
    }
} }
impl<I: Sse> UShort for UShort8<I> {}

/// The lower halves of the products of bytes: those in even places, and those in odd places, made in the upper halves.
macro_rules! mul_bytes {
    ($a:ident, $b:ident) => {{
        let even = _mm_and_si128(_mm_mullo_epi16($a, $b), _mm_set1_epi16(0xff));
        let odd = _mm_mullo_epi16(_mm_srli_epi16::<8>($a), _mm_andnot_si128(_mm_set1_epi16(0xff), $b));
        _mm_or_si128(even, odd)
    }};
}

narrow! { Char16: 16 i8, i32, CharBool16 Char16 UChar16 Short8;
    _mm_set1_epi8 _mm_add_epi8 _mm_sub_epi8 _mm_adds_epi8 _mm_subs_epi8 _mm_cmpeq_epi8
    _mm_unpacklo_epi8 _mm_unpackhi_epi8;
    a b n: mul mul_bytes!(a, b),
    shl _mm_and_si128(_mm_sll_epi16(a, _mm_cvtsi32_si128(n)), _mm_set1_epi8((0xff << n) as i8)),
    shr {
        // Zeros come in at the top; the sign goes where it is now, and from there up.
        let x = _mm_and_si128(_mm_srl_epi16(a, _mm_cvtsi32_si128(n)), _mm_set1_epi8((0xff >> n) as i8));
        let sign = _mm_set1_epi8((0x80 >> n) as i8);
        _mm_sub_epi8(_mm_xor_si128(x, sign), sign)
    },
{
    #[inline(always)]
    fn lt(self, other: Self) -> CharBool16<I> {
        CharBool16::new(intrinsics!(_mm_cmplt_epi8(self.0, other.0)))
    }
    #[inline(always)]
    fn le(self, other: Self) -> CharBool16<I> {
        !other.lt(self)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if const { I::SSE41 } {
            Self::new(intrinsics!(_mm_min_epi8(self.0, other.0)))
        } else {
            Self::select(self.lt(other), self, other)
        }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if const { I::SSE41 } {
            Self::new(intrinsics!(_mm_max_epi8(self.0, other.0)))
        } else {
            Self::select(other.lt(self), self, other)
        }
    }
    #[inline(always)]
    fn mul_high(self, other: Self) -> Self {
        mul_high_by_widening(self, other)
    }
    #[inline(always)]
    fn widen(self) -> (Short8<I>, Short8<I>) {
        let (low, high) = self.interleave(self);
        (Short8::new(low.0) >> 8, Short8::new(high.0) >> 8)
    }
    #[inline(always)]
    fn narrow(low: Short8<I>, high: Short8<I>) -> Self {
        Self::new(intrinsics!(_mm_packs_epi16(low.0, high.0)))
    }
} }
impl<I: Sse> Char for Char16<I> {}

narrow! { UChar16: 16 u8, u32, CharBool16 Char16 UChar16 UShort8;
    _mm_set1_epi8 _mm_add_epi8 _mm_sub_epi8 _mm_adds_epu8 _mm_subs_epu8 _mm_cmpeq_epi8
    _mm_unpacklo_epi8 _mm_unpackhi_epi8;
    a b n: mul mul_bytes!(a, b),
    shl _mm_and_si128(_mm_sll_epi16(a, _mm_cvtsi32_si128(n)), _mm_set1_epi8((0xff << n) as i8)),
    shr _mm_and_si128(_mm_srl_epi16(a, _mm_cvtsi32_si128(n)), _mm_set1_epi8((0xff >> n) as i8)),
{
    #[inline(always)]
    fn lt(self, other: Self) -> CharBool16<I> {
        !other.le(self)
    }
    #[inline(always)]
    fn le(self, other: Self) -> CharBool16<I> {
        self.saturating_sub(other).eq(Self::default())
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm_min_epu8(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm_max_epu8(self.0, other.0)))
    }
    #[inline(always)]
    fn mul_high(self, other: Self) -> Self {
        mul_high_by_widening(self, other)
    }
    #[inline(always)]
    fn average(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm_avg_epu8(self.0, other.0)))
    }
    #[inline(always)]
    fn widen(self) -> (UShort8<I>, UShort8<I>) {
        let (low, high) = self.interleave(Self::default());
        (UShort8::new(low.0), UShort8::new(high.0))
    }
    #[inline(always)]
    fn narrow(low: UShort8<I>, high: UShort8<I>) -> Self {
        let most = UShort8::splat(0xff);
        Self::narrow_signed(low.min(most).to_signed(), high.min(most).to_signed())
    }
} }
impl<I: Sse> UChar for UChar16<I> {
    #[inline(always)]
    fn narrow_signed(low: Short8<I>, high: Short8<I>) -> Self {
        Self::new(intrinsics!(_mm_packus_epi16(low.0, high.0)))
    }
    #[inline(always)]
    fn sum_abs_diff(self, other: Self) -> u32 {
        intrinsics! {
            let halves = _mm_sad_epu8(self.0, other.0);
            _mm_cvtsi128_si32(_mm_add_epi32(halves, _mm_unpackhi_epi64(halves, halves))) as u32
        }
    }
    #[inline(always)]
    fn lookup(self, index: Self) -> Self {
        let index = index & Self::splat(15);
        if const { I::SSE41 } {
            return Self::new(intrinsics!(_mm_shuffle_epi8(self.0, index.0)));
        }
        let (table, index) = (lanes(self), lanes(index));
        Self::from_fn(|i| table[usize::from(index[i] % 16)])
    }
}
