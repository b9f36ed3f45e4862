//! x86, four lanes: SSE2, SSE4.2, and the four-lane types of AVX2 and AVX-512, told apart by a marker.

use super::tables::COMPRESS4;
use super::{check_bounds, intrinsics, list_lanes, mask_basics, operators, vector_basics};
use crate::pair::Pair;
use crate::vector::integer::shift_in_steps;
use crate::vector::sealed::{List, Sealed};
use crate::{Block, Float, Int, Integer, Isa, Level, Mask, Simd, Uint, Vector};
#[cfg(target_arch = "x86")]
use std::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;
use std::fmt;
use std::marker::PhantomData;
use std::ops::*;

// ---- The set ----

/// What a four-lane x86 level has beyond SSE2.
pub trait Sse: Copy + Send + Sync + 'static {
    /// SSE4.1.
    const SSE41: bool;
    /// AVX2 and FMA3.
    const AVX2: bool;
}

/// SSE and SSE2.
#[derive(Debug, Clone, Copy)]
pub struct Sse2;
impl Sse for Sse2 {
    const SSE41: bool = false;
    const AVX2: bool = false;
}

/// x86-64-v2.
#[derive(Debug, Clone, Copy)]
pub struct Sse42;
impl Sse for Sse42 {
    const SSE41: bool = true;
    const AVX2: bool = false;
}

macro_rules! four_lanes_native {
    ($($Level:ident),*) => {$(
        impl Sealed for $Level {}
        impl Simd for $Level {
            const LEVEL: Level = Level::of_backend(Isa::$Level);
            type Float4 = Float4<Self>;
            type Int4 = Int4<Self>;
            type Uint4 = Uint4<Self>;
            type Bool4 = Bool4<Self>;
            type Float8 = Pair<Self::Float4>;
            type Int8 = Pair<Self::Int4>;
            type Uint8 = Pair<Self::Uint4>;
            type Bool8 = Pair<Self::Bool4>;
            type Float16 = Pair<Self::Float8>;
            type Int16 = Pair<Self::Int8>;
            type Uint16 = Pair<Self::Uint8>;
            type Bool16 = Pair<Self::Bool8>;
            type Float = Self::Float4;
        }
    )*};
}
four_lanes_native!(Sse2, Sse42);

/// A vector type over its register, and its way to and from the register that memory operations work with.
macro_rules! register {
    ($($(#[$doc:meta])* $V:ident($reg:ty), $x:ident: from_ps $of:expr, to_ps $to:expr;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy)]
        #[repr(transparent)]
        pub struct $V<I>($reg, PhantomData<I>);

        impl<I> $V<I> {
            #[inline(always)]
            pub(super) fn new(x: $reg) -> Self {
                Self(x, PhantomData)
            }
            #[inline(always)]
            pub(super) fn of_ps($x: __m128) -> Self {
                Self::new($of)
            }
            #[inline(always)]
            pub(super) fn ps(self) -> __m128 {
                let $x = self.0;
                $to
            }
        }
    )*};
}
register! {
    /// Four `f32`.
    Float4(__m128), x: from_ps x, to_ps x;
    /// Four `i32`.
    Int4(__m128i), x: from_ps intrinsics!(_mm_castps_si128(x)), to_ps intrinsics!(_mm_castsi128_ps(x));
    /// Four `u32`.
    Uint4(__m128i), x: from_ps intrinsics!(_mm_castps_si128(x)), to_ps intrinsics!(_mm_castsi128_ps(x));
}
vector_basics!([I: Sse] Float4<I>, [I: Sse] Int4<I>, [I: Sse] Uint4<I>);

// ---- Masks ----

/// All bits of a true lane are ones, all of a false lane zeros.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct Bool4<I>(__m128, PhantomData<I>);

mask_basics!([I: Sse] Bool4<I>);

operators!([I: Sse] Bool4<I>:
    BitAnd bitand BitAndAssign bitand_assign = _mm_and_ps;
    BitOr bitor BitOrAssign bitor_assign = _mm_or_ps;
    BitXor bitxor BitXorAssign bitxor_assign = _mm_xor_ps;
);

impl<I: Sse> Not for Bool4<I> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        self ^ Self::splat(true)
    }
}

impl<I> Bool4<I> {
    #[inline(always)]
    fn new(x: __m128) -> Self {
        Self(x, PhantomData)
    }
    #[inline(always)]
    fn of_si(x: __m128i) -> Self {
        Self::new(intrinsics!(_mm_castsi128_ps(x)))
    }
}

impl<I: Sse> Mask for Bool4<I> {
    const LANES: usize = 4;

    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self::of_si(intrinsics!(_mm_set1_epi32(-i32::from(value))))
    }
    #[inline(always)]
    fn from_bitmask(bits: u32) -> Self {
        intrinsics! {
            let bit = _mm_setr_epi32(1, 2, 4, 8);
            Self::of_si(_mm_cmpeq_epi32(_mm_and_si128(_mm_set1_epi32(bits as i32), bit), bit))
        }
    }
    #[inline(always)]
    fn bitmask(self) -> u32 {
        intrinsics!(_mm_movemask_ps(self.0)) as u32
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.bitmask() != 0
    }
    #[inline(always)]
    fn all(self) -> bool {
        self.bitmask() == 0b1111
    }
}

// ---- What all lanes share ----

/// Columns to rows, and back.
#[inline(always)]
fn transpose([a, b, c, d]: [__m128; 4]) -> [__m128; 4] {
    intrinsics! {
        let (ab_lo, ab_hi) = (_mm_unpacklo_ps(a, b), _mm_unpackhi_ps(a, b));
        let (cd_lo, cd_hi) = (_mm_unpacklo_ps(c, d), _mm_unpackhi_ps(c, d));
        [
            _mm_movelh_ps(ab_lo, cd_lo),
            _mm_movehl_ps(cd_lo, ab_lo),
            _mm_movelh_ps(ab_hi, cd_hi),
            _mm_movehl_ps(cd_hi, ab_hi),
        ]
    }
}

/// Lanes 2, 3, 2, 3.
#[inline(always)]
fn upper_half(x: __m128) -> __m128 {
    intrinsics!(_mm_movehl_ps(x, x))
}

/// Lane 1 in lane 0.
#[inline(always)]
fn lane1(x: __m128) -> __m128 {
    intrinsics!(_mm_shuffle_ps::<0b01>(x, x))
}

/// Orders streaming stores before whatever comes after them, also when what is stored panics.
pub(super) struct StreamFence;
impl Drop for StreamFence {
    #[inline(always)]
    fn drop(&mut self) {
        intrinsics!(_mm_sfence());
    }
}

/// [`Vector`] of one lane type: memory in common, comparisons given.
macro_rules! vector {
    ($V:ident, $Lane:ty, $x:ident: splat $splat:expr, { $($given:tt)* }) => {
        impl<I: Sse> Vector for $V<I> {
            type Lane = $Lane;
            type Mask = Bool4<I>;
            type Index = Uint4<I>;
            const LANES: usize = 4;

            #[inline(always)]
            fn splat($x: $Lane) -> Self {
                Self::new(intrinsics!($splat))
            }
            #[inline(always)]
            fn load(src: &[$Lane]) -> Self {
                let src: *const $Lane = src[..4].as_ptr();
                // SAFETY: four elements are there to read.
                Self::of_ps(unsafe { _mm_loadu_ps(src.cast()) })
            }
            #[inline(always)]
            fn store(self, dst: &mut [$Lane]) {
                let dst: *mut $Lane = dst[..4].as_mut_ptr();
                // SAFETY: four elements are there to write.
                unsafe { _mm_storeu_ps(dst.cast(), self.ps()) }
            }
            #[inline(always)]
            fn load_block(block: &Block<$Lane>, chunk: usize) -> Self {
                let src: *const $Lane = block.0.as_chunks::<4>().0[chunk].as_ptr();
                // SAFETY: four elements are there to read, 16 * chunk bytes into a block aligned to 64.
                Self::of_ps(unsafe { _mm_load_ps(src.cast()) })
            }
            #[inline(always)]
            fn store_block(self, block: &mut Block<$Lane>, chunk: usize) {
                let dst: *mut $Lane = block.0.as_chunks_mut::<4>().0[chunk].as_mut_ptr();
                // SAFETY: four elements are there to write, 16 * chunk bytes into a block aligned to 64.
                unsafe { _mm_store_ps(dst.cast(), self.ps()) }
            }
            #[inline(always)]
            fn stream(dst: &mut [Block<$Lane>], mut f: impl FnMut(usize) -> Self) {
                let _fence = StreamFence;
                for (i, chunk) in crate::block::lanes_mut(dst).as_chunks_mut::<4>().0.iter_mut().enumerate() {
                    let x = f(i).ps();
                    // SAFETY: four elements are there to write, at a multiple of 16 bytes into blocks aligned to 64; the fence
                    // comes before anybody else can look.
                    unsafe { _mm_stream_ps(chunk.as_mut_ptr().cast(), x) }
                }
            }
            #[inline(always)]
            fn gather_masked(src: &[$Lane], index: Uint4<I>, mask: Bool4<I>, or: Self) -> Self {
                check_bounds::<Self>(src.len(), index, mask);
                let (index, mut lanes) = (index.to_block(), or.to_block());
                let mask = mask.bitmask();
                for i in 0..4 {
                    if mask >> i & 1 != 0 {
                        // SAFETY: the index of a lane that is on was found in bounds.
                        lanes.0[i] = unsafe { *src.get_unchecked(index.0[i] as usize) };
                    }
                }
                Self::load_block(&lanes, 0)
            }
            #[inline(always)]
            fn load_rows4(rows: &[[$Lane; 4]]) -> [Self; 4] {
                let rows = &rows[..4];
                let [a, b, c, d] = transpose([
                    Self::load(&rows[0]).ps(),
                    Self::load(&rows[1]).ps(),
                    Self::load(&rows[2]).ps(),
                    Self::load(&rows[3]).ps(),
                ]);
                [Self::of_ps(a), Self::of_ps(b), Self::of_ps(c), Self::of_ps(d)]
            }
            #[inline(always)]
            fn store_rows4([a, b, c, d]: [Self; 4], rows: &mut [[$Lane; 4]]) {
                let [a, b, c, d] = transpose([a.ps(), b.ps(), c.ps(), d.ps()]);
                let rows = &mut rows[..4];
                Self::of_ps(a).store(&mut rows[0]);
                Self::of_ps(b).store(&mut rows[1]);
                Self::of_ps(c).store(&mut rows[2]);
                Self::of_ps(d).store(&mut rows[3]);
            }
            #[inline(always)]
            fn select(mask: Bool4<I>, on_true: Self, on_false: Self) -> Self {
                let (t, f, m) = (on_true.ps(), on_false.ps(), mask.0);
                Self::of_ps(intrinsics! {
                    if const { I::SSE41 } {
                        _mm_blendv_ps(f, t, m)
                    } else {
                        _mm_or_ps(_mm_and_ps(m, t), _mm_andnot_ps(m, f))
                    }
                })
            }
            #[inline(always)]
            fn lookup(self, index: Uint4<I>) -> Self {
                let x = self.ps();
                if const { I::AVX2 } {
                    return Self::of_ps(intrinsics!(_mm_permutevar_ps(x, index.0)));
                }
                if const { I::SSE41 } {
                    return Self::of_ps(intrinsics! {
                        // Numbers of bytes: four times the index, in four bytes, plus 0, 1, 2, 3.
                        let low_byte = _mm_setr_epi8(0, 0, 0, 0, 4, 4, 4, 4, 8, 8, 8, 8, 12, 12, 12, 12);
                        let lane = _mm_and_si128(_mm_shuffle_epi8(index.0, low_byte), _mm_set1_epi8(3));
                        let byte = _mm_add_epi8(_mm_slli_epi32::<2>(lane), _mm_set1_epi32(0x0302_0100));
                        _mm_castsi128_ps(_mm_shuffle_epi8(_mm_castps_si128(x), byte))
                    });
                }
                let (table, index) = (self.to_block(), index.to_block());
                Self::from_fn(|i| table.0[(index.0[i] % 4) as usize])
            }
            #[inline(always)]
            fn interleave(self, other: Self) -> (Self, Self) {
                let (a, b) = (self.ps(), other.ps());
                let (low, high) = intrinsics!((_mm_unpacklo_ps(a, b), _mm_unpackhi_ps(a, b)));
                (Self::of_ps(low), Self::of_ps(high))
            }
            #[inline(always)]
            fn deinterleave(self, other: Self) -> (Self, Self) {
                let (a, b) = (self.ps(), other.ps());
                let (even, odd) = intrinsics! {
                    (_mm_shuffle_ps::<0b10_00_10_00>(a, b), _mm_shuffle_ps::<0b11_01_11_01>(a, b))
                };
                (Self::of_ps(even), Self::of_ps(odd))
            }
            #[inline(always)]
            fn compress(self, mask: Bool4<I>) -> Self {
                let bits = mask.bitmask() as usize % 16;
                if const { I::SSE41 } {
                    let bytes: *const [u8; 16] = &COMPRESS4[bits];
                    // SAFETY: sixteen bytes are there to read.
                    let bytes = unsafe { _mm_loadu_si128(bytes.cast()) };
                    let x = self.ps();
                    return Self::of_ps(intrinsics!(_mm_castsi128_ps(_mm_shuffle_epi8(_mm_castps_si128(x), bytes))));
                }
                let (lanes, mut block, mut n) = (self.to_block(), Block::default(), 0);
                for i in 0..4 {
                    // Written always, moved on from where the mask is true: no branch.
                    block.0[n % 8] = lanes.0[i];
                    n += bits >> i & 1;
                }
                block.0[n % 8] = Default::default();
                Self::load_block(&block, 0)
            }
            #[inline(always)]
            fn reduce_min(self) -> $Lane {
                let two = self.min(Self::of_ps(upper_half(self.ps())));
                two.min(Self::of_ps(lane1(two.ps()))).first()
            }
            #[inline(always)]
            fn reduce_max(self) -> $Lane {
                let two = self.max(Self::of_ps(upper_half(self.ps())));
                two.max(Self::of_ps(lane1(two.ps()))).first()
            }
            $($given)*
        }
    };
}

// ---- Floats ----

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
        Self::from_fn(|i| crate::soft::mul_add(a.0[i], b.0[i], c.0[i]))
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

// ---- Integers ----

/// A shift count modulo 32, in the register that shifts take it from.
#[inline(always)]
pub(super) fn shift_count(n: usize) -> __m128i {
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
