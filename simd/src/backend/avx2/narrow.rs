//! AVX2: 16- and 8-bit integers.

use super::super::{mul_high_by_widening, narrow_basics};
use super::*;
use crate::{Char, Narrow, Short, UChar, UShort};

// ---- Registers and masks ----

/// A type over its register, and operators on all bits.
macro_rules! register {
    ($($(#[$doc:meta])* $V:ident;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy)]
        #[repr(transparent)]
        pub struct $V(__m256i);
        impl $V {
            #[inline(always)]
            fn new(x: __m256i) -> Self {
                Self(x)
            }
        }
        operators!([] $V:
            BitAnd bitand BitAndAssign bitand_assign = _mm256_and_si256;
            BitOr bitor BitOrAssign bitor_assign = _mm256_or_si256;
            BitXor bitxor BitXorAssign bitxor_assign = _mm256_xor_si256;
        );
        impl Not for $V {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self::new(intrinsics!(_mm256_xor_si256(self.0, _mm256_set1_epi32(-1))))
            }
        }
    )*};
}
register! {
    /// Sixteen `i16`.
    Short16;
    /// Sixteen `u16`.
    UShort16;
    /// Thirty-two `i8`.
    Char32;
    /// Thirty-two `u8`.
    UChar32;
    /// All bits of a true lane are ones, all of a false lane zeros.
    ShortBool16;
    /// All bits of a true lane are ones, all of a false lane zeros.
    CharBool32;
}
narrow_basics!([] Short16, [] UShort16, [] Char32, [] UChar32);
mask_basics!([] ShortBool16);
mask_basics!([] CharBool32);

/// [`Mask`] from its conversions.
macro_rules! mask {
    ($M:ident, $n:literal, $bits:ident: from $from:expr, $x:ident: to $to:expr) => {
        impl Mask for $M {
            const LANES: usize = $n;

            #[inline(always)]
            fn splat(value: bool) -> Self {
                Self::new(intrinsics!(_mm256_set1_epi32(-i32::from(value))))
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
                intrinsics!(_mm256_movemask_epi8(self.0)) != 0
            }
            #[inline(always)]
            fn all(self) -> bool {
                intrinsics!(_mm256_movemask_epi8(self.0)) == -1
            }
        }
    };
}
mask! { ShortBool16, 16,
    bits: from {
        let bit = _mm256_setr_epi16(1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, i16::MIN);
        _mm256_cmpeq_epi16(_mm256_and_si256(_mm256_set1_epi16(bits as i16), bit), bit)
    },
    x: to _mm_movemask_epi8(_mm_packs_epi16(_mm256_castsi256_si128(x), _mm256_extracti128_si256::<1>(x))) as u32
}
mask! { CharBool32, 32,
    bits: from {
        // Each byte eight times.
        let number = _mm256_setr_epi64x(0, 0x0101_0101_0101_0101, 0x0202_0202_0202_0202, 0x0303_0303_0303_0303);
        let bytes = _mm256_shuffle_epi8(_mm256_set1_epi32(bits as i32), number);
        let bit = _mm256_set1_epi64x(0x8040_2010_0804_0201_u64 as i64);
        _mm256_cmpeq_epi8(_mm256_and_si256(bytes, bit), bit)
    },
    x: to _mm256_movemask_epi8(x) as u32
}

// ---- Vectors ----

/// The lower half, the upper half.
#[inline(always)]
fn halves(x: __m256i) -> (__m128i, __m128i) {
    intrinsics!((_mm256_castsi256_si128(x), _mm256_extracti128_si256::<1>(x)))
}

/// [`Narrow`] of one lane type and its operators: what has one instruction for each lane type, and what is given.
macro_rules! narrow {
    (
        $V:ident: $n:literal $Lane:ty, $Sum:ty, $M:ident $Signed:ident $Unsigned:ident $Wide:ident;
        $splat:ident $add:ident $sub:ident $adds:ident $subs:ident $eq:ident $low:ident $high:ident;
        $a:ident $b:ident $count:ident: mul $mul:expr, shl $shl:expr, shr $shr:expr, { $($given:tt)* }
    ) => {
        operators!([] $V:
            Add add AddAssign add_assign = $add;
            Sub sub SubAssign sub_assign = $sub;
        );
        impl Mul for $V {
            type Output = Self;
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                let ($a, $b) = (self.0, other.0);
                Self::new(intrinsics!($mul))
            }
        }
        impl MulAssign for $V {
            #[inline(always)]
            fn mul_assign(&mut self, other: Self) {
                *self = *self * other;
            }
        }
        impl Shl<usize> for $V {
            type Output = Self;
            #[inline(always)]
            fn shl(self, n: usize) -> Self {
                let ($a, $count) = (self.0, n as i32 & (<$Lane>::BITS as i32 - 1));
                Self::new(intrinsics!($shl))
            }
        }
        impl Shr<usize> for $V {
            type Output = Self;
            #[inline(always)]
            fn shr(self, n: usize) -> Self {
                let ($a, $count) = (self.0, n as i32 & (<$Lane>::BITS as i32 - 1));
                Self::new(intrinsics!($shr))
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
                Self::new(intrinsics!($splat(x as _)))
            }
            #[inline(always)]
            fn load(src: &[$Lane]) -> Self {
                let src: *const $Lane = src[..$n].as_ptr();
                // SAFETY: thirty-two bytes are there to read.
                Self::new(unsafe { _mm256_loadu_si256(src.cast()) })
            }
            #[inline(always)]
            fn store(self, dst: &mut [$Lane]) {
                let dst: *mut $Lane = dst[..$n].as_mut_ptr();
                // SAFETY: thirty-two bytes are there to write.
                unsafe { _mm256_storeu_si256(dst.cast(), self.0) }
            }
            #[inline(always)]
            fn select(mask: $M, on_true: Self, on_false: Self) -> Self {
                Self::new(intrinsics!(_mm256_blendv_epi8(on_false.0, on_true.0, mask.0)))
            }
            #[inline(always)]
            fn eq(self, other: Self) -> $M {
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
            fn to_signed(self) -> $Signed {
                $Signed::new(self.0)
            }
            #[inline(always)]
            fn to_unsigned(self) -> $Unsigned {
                $Unsigned::new(self.0)
            }
            #[inline(always)]
            fn interleave(self, other: Self) -> (Self, Self) {
                let (low, high) = intrinsics! {
                    let (low, high) = ($low(self.0, other.0), $high(self.0, other.0));
                    (_mm256_permute2x128_si256::<0x20>(low, high), _mm256_permute2x128_si256::<0x31>(low, high))
                };
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

narrow! { Short16: 16 i16, i32, ShortBool16 Short16 UShort16 Int8;
    _mm256_set1_epi16 _mm256_add_epi16 _mm256_sub_epi16 _mm256_adds_epi16 _mm256_subs_epi16 _mm256_cmpeq_epi16
    _mm256_unpacklo_epi16 _mm256_unpackhi_epi16;
    a b n: mul _mm256_mullo_epi16(a, b),
    shl _mm256_sll_epi16(a, _mm_cvtsi32_si128(n)),
    shr _mm256_sra_epi16(a, _mm_cvtsi32_si128(n)),
{
    #[inline(always)]
    fn lt(self, other: Self) -> ShortBool16 {
        ShortBool16::new(intrinsics!(_mm256_cmpgt_epi16(other.0, self.0)))
    }
    #[inline(always)]
    fn le(self, other: Self) -> ShortBool16 {
        !other.lt(self)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_min_epi16(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_max_epi16(self.0, other.0)))
    }
    #[inline(always)]
    fn mul_high(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_mulhi_epi16(self.0, other.0)))
    }
    #[inline(always)]
    fn widen(self) -> (Int8, Int8) {
        let (low, high) = halves(self.0);
        let (low, high) = intrinsics!((_mm256_cvtepi16_epi32(low), _mm256_cvtepi16_epi32(high)));
        (Int8::new(low), Int8::new(high))
    }
    #[inline(always)]
    fn narrow(low: Int8, high: Int8) -> Self {
        Self::new(intrinsics!(_mm256_permute4x64_epi64::<0b11_01_10_00>(_mm256_packs_epi32(low.0, high.0))))
    }
} }
impl Short for Short16 {}

narrow! { UShort16: 16 u16, u32, ShortBool16 Short16 UShort16 Uint8;
    _mm256_set1_epi16 _mm256_add_epi16 _mm256_sub_epi16 _mm256_adds_epu16 _mm256_subs_epu16 _mm256_cmpeq_epi16
    _mm256_unpacklo_epi16 _mm256_unpackhi_epi16;
    a b n: mul _mm256_mullo_epi16(a, b),
    shl _mm256_sll_epi16(a, _mm_cvtsi32_si128(n)),
    shr _mm256_srl_epi16(a, _mm_cvtsi32_si128(n)),
{
    #[inline(always)]
    fn lt(self, other: Self) -> ShortBool16 {
        !other.le(self)
    }
    #[inline(always)]
    fn le(self, other: Self) -> ShortBool16 {
        self.saturating_sub(other).eq(Self::default())
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_min_epu16(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_max_epu16(self.0, other.0)))
    }
    #[inline(always)]
    fn mul_high(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_mulhi_epu16(self.0, other.0)))
    }
    #[inline(always)]
    fn average(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_avg_epu16(self.0, other.0)))
    }
    #[inline(always)]
    fn widen(self) -> (Uint8, Uint8) {
        let (low, high) = halves(self.0);
        let (low, high) = intrinsics!((_mm256_cvtepu16_epi32(low), _mm256_cvtepu16_epi32(high)));
        (Uint8::new(low), Uint8::new(high))
    }
    #[inline(always)]
    fn narrow(low: Uint8, high: Uint8) -> Self {
        let (low, high) = (low.min(Uint8::splat(0xffff)), high.min(Uint8::splat(0xffff)));
        Self::new(intrinsics!(_mm256_permute4x64_epi64::<0b11_01_10_00>(_mm256_packus_epi32(low.0, high.0))))
    }
} }
impl UShort for UShort16 {}

/// The lower halves of the products of bytes: those in even places, and those in odd places, made in the upper halves.
macro_rules! mul_bytes {
    ($a:ident, $b:ident) => {{
        let even = _mm256_and_si256(_mm256_mullo_epi16($a, $b), _mm256_set1_epi16(0xff));
        let odd = _mm256_mullo_epi16(_mm256_srli_epi16::<8>($a), _mm256_andnot_si256(_mm256_set1_epi16(0xff), $b));
        _mm256_or_si256(even, odd)
    }};
}

narrow! { Char32: 32 i8, i32, CharBool32 Char32 UChar32 Short16;
    _mm256_set1_epi8 _mm256_add_epi8 _mm256_sub_epi8 _mm256_adds_epi8 _mm256_subs_epi8 _mm256_cmpeq_epi8
    _mm256_unpacklo_epi8 _mm256_unpackhi_epi8;
    a b n: mul mul_bytes!(a, b),
    shl _mm256_and_si256(_mm256_sll_epi16(a, _mm_cvtsi32_si128(n)), _mm256_set1_epi8((0xff << n) as i8)),
    shr {
        // Zeros come in at the top; the sign goes where it is now, and from there up.
        let x = _mm256_and_si256(_mm256_srl_epi16(a, _mm_cvtsi32_si128(n)), _mm256_set1_epi8((0xff >> n) as i8));
        let sign = _mm256_set1_epi8((0x80 >> n) as i8);
        _mm256_sub_epi8(_mm256_xor_si256(x, sign), sign)
    },
{
    #[inline(always)]
    fn lt(self, other: Self) -> CharBool32 {
        CharBool32::new(intrinsics!(_mm256_cmpgt_epi8(other.0, self.0)))
    }
    #[inline(always)]
    fn le(self, other: Self) -> CharBool32 {
        !other.lt(self)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_min_epi8(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_max_epi8(self.0, other.0)))
    }
    #[inline(always)]
    fn mul_high(self, other: Self) -> Self {
        mul_high_by_widening(self, other)
    }
    #[inline(always)]
    fn widen(self) -> (Short16, Short16) {
        let (low, high) = halves(self.0);
        let (low, high) = intrinsics!((_mm256_cvtepi8_epi16(low), _mm256_cvtepi8_epi16(high)));
        (Short16::new(low), Short16::new(high))
    }
    #[inline(always)]
    fn narrow(low: Short16, high: Short16) -> Self {
        Self::new(intrinsics!(_mm256_permute4x64_epi64::<0b11_01_10_00>(_mm256_packs_epi16(low.0, high.0))))
    }
} }
impl Char for Char32 {}

narrow! { UChar32: 32 u8, u32, CharBool32 Char32 UChar32 UShort16;
    _mm256_set1_epi8 _mm256_add_epi8 _mm256_sub_epi8 _mm256_adds_epu8 _mm256_subs_epu8 _mm256_cmpeq_epi8
    _mm256_unpacklo_epi8 _mm256_unpackhi_epi8;
    a b n: mul mul_bytes!(a, b),
    shl _mm256_and_si256(_mm256_sll_epi16(a, _mm_cvtsi32_si128(n)), _mm256_set1_epi8((0xff << n) as i8)),
    shr _mm256_and_si256(_mm256_srl_epi16(a, _mm_cvtsi32_si128(n)), _mm256_set1_epi8((0xff >> n) as i8)),
{
    #[inline(always)]
    fn lt(self, other: Self) -> CharBool32 {
        !other.le(self)
    }
    #[inline(always)]
    fn le(self, other: Self) -> CharBool32 {
        self.saturating_sub(other).eq(Self::default())
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_min_epu8(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_max_epu8(self.0, other.0)))
    }
    #[inline(always)]
    fn mul_high(self, other: Self) -> Self {
        mul_high_by_widening(self, other)
    }
    #[inline(always)]
    fn average(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_avg_epu8(self.0, other.0)))
    }
    #[inline(always)]
    fn widen(self) -> (UShort16, UShort16) {
        let (low, high) = halves(self.0);
        let (low, high) = intrinsics!((_mm256_cvtepu8_epi16(low), _mm256_cvtepu8_epi16(high)));
        (UShort16::new(low), UShort16::new(high))
    }
    #[inline(always)]
    fn narrow(low: UShort16, high: UShort16) -> Self {
        let most = UShort16::splat(0xff);
        Self::narrow_signed(low.min(most).to_signed(), high.min(most).to_signed())
    }
} }
impl UChar for UChar32 {
    #[inline(always)]
    fn narrow_signed(low: Short16, high: Short16) -> Self {
        Self::new(intrinsics!(_mm256_permute4x64_epi64::<0b11_01_10_00>(_mm256_packus_epi16(low.0, high.0))))
    }
    #[inline(always)]
    fn sum_abs_diff(self, other: Self) -> u32 {
        intrinsics! {
            let quarters = _mm256_sad_epu8(self.0, other.0);
            let halves = _mm_add_epi32(_mm256_castsi256_si128(quarters), _mm256_extracti128_si256::<1>(quarters));
            _mm_cvtsi128_si32(_mm_add_epi32(halves, _mm_unpackhi_epi64(halves, halves))) as u32
        }
    }
    #[inline(always)]
    fn lookup(self, index: Self) -> Self {
        let index = index & Self::splat(15);
        Self::new(intrinsics!(_mm256_shuffle_epi8(self.0, index.0)))
    }
}
