//! AVX2 and FMA, eight lanes. Four lanes are [`sse`](super::sse)'s.

use super::sse::{self, Sse, StreamFence};
use super::tables::COMPRESS8;
use super::{check_bounds, intrinsics, list_lanes, mask_basics, operators, vector_basics};
use crate::pair::Pair;
use crate::vector::check_masked;
use crate::vector::sealed::{List, Sealed};
use crate::{Block, Float, Halves, Int, Integer, Isa, Level, Mask, Simd, Uint, Vector};
#[cfg(target_arch = "x86")]
use std::arch::x86::*;
#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;
use std::fmt;
use std::ops::*;

// ---- The set ----

/// x86-64-v3.
#[derive(Debug, Clone, Copy)]
pub struct Avx2;
impl Sse for Avx2 {
    const SSE41: bool = true;
    const AVX2: bool = true;
}

impl Sealed for Avx2 {}
impl Simd for Avx2 {
    const LEVEL: Level = Level::of_backend(Isa::Avx2);
    type Float4 = sse::Float4<Self>;
    type Int4 = sse::Int4<Self>;
    type Uint4 = sse::Uint4<Self>;
    type Bool4 = sse::Bool4<Self>;
    type Float8 = Float8;
    type Int8 = Int8;
    type Uint8 = Uint8;
    type Bool8 = Bool8;
    type Float16 = Pair<Float8>;
    type Int16 = Pair<Int8>;
    type Uint16 = Pair<Uint8>;
    type Bool16 = Pair<Bool8>;
    type Float = Float8;
}

/// A vector type over its register, and its way to and from the register that memory operations work with.
macro_rules! register {
    ($($(#[$doc:meta])* $V:ident($reg:ty), $x:ident: from_ps $of:expr, to_ps $to:expr;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy)]
        #[repr(transparent)]
        pub struct $V($reg);

        impl $V {
            #[inline(always)]
            fn new(x: $reg) -> Self {
                Self(x)
            }
            #[inline(always)]
            pub(super) fn of_ps($x: __m256) -> Self {
                Self::new($of)
            }
            #[inline(always)]
            pub(super) fn ps(self) -> __m256 {
                let $x = self.0;
                $to
            }
        }
    )*};
}
register! {
    /// Eight `f32`.
    Float8(__m256), x: from_ps x, to_ps x;
    /// Eight `i32`.
    Int8(__m256i), x: from_ps intrinsics!(_mm256_castps_si256(x)), to_ps intrinsics!(_mm256_castsi256_ps(x));
    /// Eight `u32`.
    Uint8(__m256i), x: from_ps intrinsics!(_mm256_castps_si256(x)), to_ps intrinsics!(_mm256_castsi256_ps(x));
}
vector_basics!([] Float8, [] Int8, [] Uint8);

// ---- Masks ----

/// All bits of a true lane are ones, all of a false lane zeros.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct Bool8(__m256);

mask_basics!([] Bool8);

operators!([] Bool8:
    BitAnd bitand BitAndAssign bitand_assign = _mm256_and_ps;
    BitOr bitor BitOrAssign bitor_assign = _mm256_or_ps;
    BitXor bitxor BitXorAssign bitxor_assign = _mm256_xor_ps;
);

impl Not for Bool8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        self ^ Self::splat(true)
    }
}

impl Bool8 {
    #[inline(always)]
    fn new(x: __m256) -> Self {
        Self(x)
    }
    #[inline(always)]
    fn of_si(x: __m256i) -> Self {
        Self::new(intrinsics!(_mm256_castsi256_ps(x)))
    }
    #[inline(always)]
    fn si(self) -> __m256i {
        intrinsics!(_mm256_castps_si256(self.0))
    }
}

impl Mask for Bool8 {
    const LANES: usize = 8;

    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self::of_si(intrinsics!(_mm256_set1_epi32(-i32::from(value))))
    }
    #[inline(always)]
    fn from_bitmask(bits: u32) -> Self {
        intrinsics! {
            let bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
            Self::of_si(_mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32(bits as i32), bit), bit))
        }
    }
    #[inline(always)]
    fn bitmask(self) -> u32 {
        intrinsics!(_mm256_movemask_ps(self.0)) as u32
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.bitmask() != 0
    }
    #[inline(always)]
    fn all(self) -> bool {
        self.bitmask() == 0xff
    }
}

// ---- What all lanes share ----

/// Columns to rows, and back, in each half by itself.
#[inline(always)]
fn transpose([a, b, c, d]: [__m256; 4]) -> [__m256; 4] {
    intrinsics! {
        let (ab_lo, ab_hi) = (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
        let (cd_lo, cd_hi) = (_mm256_unpacklo_ps(c, d), _mm256_unpackhi_ps(c, d));
        [
            _mm256_shuffle_ps::<0b01_00_01_00>(ab_lo, cd_lo),
            _mm256_shuffle_ps::<0b11_10_11_10>(ab_lo, cd_lo),
            _mm256_shuffle_ps::<0b01_00_01_00>(ab_hi, cd_hi),
            _mm256_shuffle_ps::<0b11_10_11_10>(ab_hi, cd_hi),
        ]
    }
}

/// A register from its halves.
#[inline(always)]
fn join(low: __m128, high: __m128) -> __m256 {
    intrinsics!(_mm256_set_m128(high, low))
}

/// [`Vector`] of one lane type: memory in common, comparisons given.
macro_rules! vector {
    ($V:ident, $Half:ty, $Lane:ty, $x:ident: splat $splat:expr, { $($given:tt)* }) => {
        impl $V {
            #[inline(always)]
            pub(super) fn halves(self) -> ($Half, $Half) {
                let x = self.ps();
                let (low, high) = intrinsics!((_mm256_castps256_ps128(x), _mm256_extractf128_ps::<1>(x)));
                (<$Half>::of_ps(low), <$Half>::of_ps(high))
            }
        }

        impl Halves for $V {
            type Half = $Half;

            #[inline(always)]
            fn from_halves(low: $Half, high: $Half) -> Self {
                Self::of_ps(join(low.ps(), high.ps()))
            }
            #[inline(always)]
            fn low(self) -> $Half {
                self.halves().0
            }
            #[inline(always)]
            fn high(self) -> $Half {
                self.halves().1
            }
        }

        impl Vector for $V {
            type Lane = $Lane;
            type Mask = Bool8;
            type Index = Uint8;
            const LANES: usize = 8;

            #[inline(always)]
            fn splat($x: $Lane) -> Self {
                Self::new(intrinsics!($splat))
            }
            #[inline(always)]
            fn load(src: &[$Lane]) -> Self {
                let src: *const $Lane = src[..8].as_ptr();
                // SAFETY: eight elements are there to read.
                Self::of_ps(unsafe { _mm256_loadu_ps(src.cast()) })
            }
            #[inline(always)]
            fn store(self, dst: &mut [$Lane]) {
                let dst: *mut $Lane = dst[..8].as_mut_ptr();
                // SAFETY: eight elements are there to write.
                unsafe { _mm256_storeu_ps(dst.cast(), self.ps()) }
            }
            #[inline(always)]
            fn load_block(block: &Block<$Lane>, chunk: usize) -> Self {
                let src: *const $Lane = block.0.as_chunks::<8>().0[chunk].as_ptr();
                // SAFETY: eight elements are there to read, 32 * chunk bytes into a block aligned to 64.
                Self::of_ps(unsafe { _mm256_load_ps(src.cast()) })
            }
            #[inline(always)]
            fn store_block(self, block: &mut Block<$Lane>, chunk: usize) {
                let dst: *mut $Lane = block.0.as_chunks_mut::<8>().0[chunk].as_mut_ptr();
                // SAFETY: eight elements are there to write, 32 * chunk bytes into a block aligned to 64.
                unsafe { _mm256_store_ps(dst.cast(), self.ps()) }
            }
            #[inline(always)]
            fn load_masked(src: &[$Lane], mask: Bool8, or: Self) -> Self {
                check_masked(src.len(), mask);
                // SAFETY: only lanes that are on are read, and the slice has those.
                let x = Self::of_ps(unsafe { _mm256_maskload_ps(src.as_ptr().cast(), mask.si()) });
                Self::select(mask, x, or)
            }
            #[inline(always)]
            fn store_masked(self, dst: &mut [$Lane], mask: Bool8) {
                check_masked(dst.len(), mask);
                // SAFETY: only lanes that are on are written, and the slice has those.
                unsafe { _mm256_maskstore_ps(dst.as_mut_ptr().cast(), mask.si(), self.ps()) }
            }
            #[inline(always)]
            fn load_partial(src: &[$Lane]) -> Self {
                let n = src.len().min(8);
                Self::load_masked(&src[..n], Bool8::first_n(n), Self::default())
            }
            #[inline(always)]
            fn store_partial(self, dst: &mut [$Lane]) {
                let n = dst.len().min(8);
                self.store_masked(&mut dst[..n], Bool8::first_n(n));
            }
            #[inline(always)]
            fn stream(dst: &mut [Block<$Lane>], mut f: impl FnMut(usize) -> Self) {
                let _fence = StreamFence;
                for (i, chunk) in crate::block::lanes_mut(dst).as_chunks_mut::<8>().0.iter_mut().enumerate() {
                    let x = f(i).ps();
                    // SAFETY: eight elements are there to write, at a multiple of 32 bytes into blocks aligned to 64; the fence
                    // comes before anybody else can look.
                    unsafe { _mm256_stream_ps(chunk.as_mut_ptr().cast(), x) }
                }
            }
            #[inline(always)]
            fn gather_masked(src: &[$Lane], index: Uint8, mask: Bool8, or: Self) -> Self {
                check_bounds::<Self>(src.len(), index, mask);
                if src.len() > i32::MAX as usize {
                    // The instruction takes indices as signed.
                    return Self::from_fn(|i| if mask.bitmask() >> i & 1 != 0 { src[index.lane(i) as usize] } else { or.lane(i) });
                }
                let base: *const f32 = src.as_ptr().cast();
                // SAFETY: the lanes that are on have indices below `src.len()`; the others are not read.
                Self::of_ps(unsafe { _mm256_mask_i32gather_ps::<4>(or.ps(), base, index.0, mask.0) })
            }
            #[inline(always)]
            fn load_rows4(rows: &[[$Lane; 4]]) -> [Self; 4] {
                let rows = &rows[..8];
                let [a, b, c, d] = transpose([
                    join(<$Half>::load(&rows[0]).ps(), <$Half>::load(&rows[4]).ps()),
                    join(<$Half>::load(&rows[1]).ps(), <$Half>::load(&rows[5]).ps()),
                    join(<$Half>::load(&rows[2]).ps(), <$Half>::load(&rows[6]).ps()),
                    join(<$Half>::load(&rows[3]).ps(), <$Half>::load(&rows[7]).ps()),
                ]);
                [Self::of_ps(a), Self::of_ps(b), Self::of_ps(c), Self::of_ps(d)]
            }
            #[inline(always)]
            fn store_rows4([a, b, c, d]: [Self; 4], rows: &mut [[$Lane; 4]]) {
                let rows = &mut rows[..8];
                let [a, b, c, d] = transpose([a.ps(), b.ps(), c.ps(), d.ps()]);
                for (i, row) in [a, b, c, d].into_iter().enumerate() {
                    let (low, high) = Self::of_ps(row).halves();
                    low.store(&mut rows[i]);
                    high.store(&mut rows[i + 4]);
                }
            }
            #[inline(always)]
            fn select(mask: Bool8, on_true: Self, on_false: Self) -> Self {
                let (t, f, m) = (on_true.ps(), on_false.ps(), mask.0);
                Self::of_ps(intrinsics!(_mm256_blendv_ps(f, t, m)))
            }
            #[inline(always)]
            fn lookup(self, index: Uint8) -> Self {
                let x = self.ps();
                Self::of_ps(intrinsics!(_mm256_permutevar8x32_ps(x, index.0)))
            }
            #[inline(always)]
            fn interleave(self, other: Self) -> (Self, Self) {
                let (a, b) = (self.ps(), other.ps());
                let (low, high) = intrinsics! {
                    let (even, odd) = (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
                    (_mm256_permute2f128_ps::<0x20>(even, odd), _mm256_permute2f128_ps::<0x31>(even, odd))
                };
                (Self::of_ps(low), Self::of_ps(high))
            }
            #[inline(always)]
            fn deinterleave(self, other: Self) -> (Self, Self) {
                let (a, b) = (self.ps(), other.ps());
                let (even, odd) = intrinsics! {
                    let (low, high) = (_mm256_permute2f128_ps::<0x20>(a, b), _mm256_permute2f128_ps::<0x31>(a, b));
                    (_mm256_shuffle_ps::<0b10_00_10_00>(low, high), _mm256_shuffle_ps::<0b11_01_11_01>(low, high))
                };
                (Self::of_ps(even), Self::of_ps(odd))
            }
            #[inline(always)]
            fn compress(self, mask: Bool8) -> Self {
                let lanes: *const [i8; 8] = &COMPRESS8[mask.bitmask() as usize % 256];
                // SAFETY: eight bytes are there to read.
                let lanes = Uint8(unsafe { _mm256_cvtepi8_epi32(_mm_loadl_epi64(lanes.cast())) });
                let packed = self.lookup(lanes).ps();
                Self::of_ps(intrinsics!(_mm256_blendv_ps(packed, _mm256_setzero_ps(), lanes.ps())))
            }
            #[inline(always)]
            fn reduce_min(self) -> $Lane {
                let (low, high) = self.halves();
                low.min(high).reduce_min()
            }
            #[inline(always)]
            fn reduce_max(self) -> $Lane {
                let (low, high) = self.halves();
                low.max(high).reduce_max()
            }
            $($given)*
        }
    };
}

// ---- Floats ----

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

// ---- Integers ----

/// Operators that `i32` and `u32` share, the shift to the right given.
macro_rules! integer {
    ($V:ident, $Lane:ty, $shift_right:ident, $shift_lanes_right:ident) => {
        operators!([] $V:
            Add add AddAssign add_assign = _mm256_add_epi32;
            Sub sub SubAssign sub_assign = _mm256_sub_epi32;
            BitAnd bitand BitAndAssign bitand_assign = _mm256_and_si256;
            BitOr bitor BitOrAssign bitor_assign = _mm256_or_si256;
            BitXor bitxor BitXorAssign bitxor_assign = _mm256_xor_si256;
        );
        impl Mul for $V {
            type Output = Self;
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                Self::new(intrinsics!(_mm256_mullo_epi32(self.0, other.0)))
            }
        }
        impl MulAssign for $V {
            #[inline(always)]
            fn mul_assign(&mut self, other: Self) {
                *self = *self * other;
            }
        }
        impl Not for $V {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self::new(intrinsics!(_mm256_xor_si256(self.0, _mm256_set1_epi32(-1))))
            }
        }
        impl Shl<usize> for $V {
            type Output = Self;
            #[inline(always)]
            fn shl(self, n: usize) -> Self {
                Self::new(intrinsics!(_mm256_sll_epi32(self.0, sse::shift_count(n))))
            }
        }
        impl Shr<usize> for $V {
            type Output = Self;
            #[inline(always)]
            fn shr(self, n: usize) -> Self {
                Self::new(intrinsics!($shift_right(self.0, sse::shift_count(n))))
            }
        }
        impl Integer for $V {
            #[inline(always)]
            fn shl_lanes(self, n: Uint8) -> Self {
                Self::new(intrinsics!(_mm256_sllv_epi32(self.0, _mm256_and_si256(n.0, _mm256_set1_epi32(31)))))
            }
            #[inline(always)]
            fn shr_lanes(self, n: Uint8) -> Self {
                Self::new(intrinsics!($shift_lanes_right(self.0, _mm256_and_si256(n.0, _mm256_set1_epi32(31)))))
            }
        }
    };
}
integer!(Int8, i32, _mm256_sra_epi32, _mm256_srav_epi32);
integer!(Uint8, u32, _mm256_srl_epi32, _mm256_srlv_epi32);

vector! { Int8, sse::Int4<Avx2>, i32, x: splat _mm256_set1_epi32(x), {
    #[inline(always)]
    fn eq(self, other: Self) -> Bool8 {
        Bool8::of_si(intrinsics!(_mm256_cmpeq_epi32(self.0, other.0)))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Bool8 {
        Bool8::of_si(intrinsics!(_mm256_cmpgt_epi32(other.0, self.0)))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Bool8 {
        !other.lt(self)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_min_epi32(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_max_epi32(self.0, other.0)))
    }
} }

impl Neg for Int8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::splat(0) - self
    }
}

impl Int for Int8 {
    #[inline(always)]
    fn abs(self) -> Self {
        let sign = self >> 31;
        (self ^ sign) - sign
    }
    #[inline(always)]
    fn to_uint(self) -> Uint8 {
        Uint8::new(self.0)
    }
    #[inline(always)]
    fn from_uint(x: Uint8) -> Self {
        Self::new(x.0)
    }
}

vector! { Uint8, sse::Uint4<Avx2>, u32, x: splat _mm256_set1_epi32(x as i32), {
    #[inline(always)]
    fn eq(self, other: Self) -> Bool8 {
        Bool8::of_si(intrinsics!(_mm256_cmpeq_epi32(self.0, other.0)))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Bool8 {
        // Signed order after moving zero to i32::MIN.
        let offset = Self::splat(1 << 31);
        Int8::from_uint(self ^ offset).lt(Int8::from_uint(other ^ offset))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Bool8 {
        !other.lt(self)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_min_epu32(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm256_max_epu32(self.0, other.0)))
    }
} }

impl Uint for Uint8 {
    #[inline(always)]
    fn mul_high(self, other: Self) -> Self {
        Self::new(intrinsics! {
            let even = _mm256_mul_epu32(self.0, other.0);
            let odd = _mm256_mul_epu32(_mm256_srli_epi64::<32>(self.0), _mm256_srli_epi64::<32>(other.0));
            _mm256_blend_epi32::<0b1010_1010>(_mm256_srli_epi64::<32>(even), odd)
        })
    }
}
