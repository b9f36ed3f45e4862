//! AVX-512, sixteen lanes and mask registers. Four and eight lanes are [`sse`](super::sse)'s and [`avx2`](super::avx2)'s.

use super::avx2::{self, Avx2};
use super::sse::{self, StreamFence};
use super::{check_bounds, intrinsics, list_lanes, mask_basics, operators, vector_basics};
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

/// x86-64-v4.
#[derive(Debug, Clone, Copy)]
pub struct Avx512;

impl Sealed for Avx512 {}
impl Simd for Avx512 {
    const LEVEL: Level = Level::of_backend(Isa::Avx512);
    type Float4 = sse::Float4<Avx2>;
    type Int4 = sse::Int4<Avx2>;
    type Uint4 = sse::Uint4<Avx2>;
    type Bool4 = sse::Bool4<Avx2>;
    type Float8 = avx2::Float8;
    type Int8 = avx2::Int8;
    type Uint8 = avx2::Uint8;
    type Bool8 = avx2::Bool8;
    type Float16 = Float16;
    type Int16 = Int16;
    type Uint16 = Uint16;
    type Bool16 = Bool16;
    type Float = Float16;
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
            fn of_ps($x: __m512) -> Self {
                Self::new($of)
            }
            #[inline(always)]
            fn ps(self) -> __m512 {
                let $x = self.0;
                $to
            }
        }
    )*};
}
register! {
    /// Sixteen `f32`.
    Float16(__m512), x: from_ps x, to_ps x;
    /// Sixteen `i32`.
    Int16(__m512i), x: from_ps intrinsics!(_mm512_castps_si512(x)), to_ps intrinsics!(_mm512_castsi512_ps(x));
    /// Sixteen `u32`.
    Uint16(__m512i), x: from_ps intrinsics!(_mm512_castps_si512(x)), to_ps intrinsics!(_mm512_castsi512_ps(x));
}
vector_basics!([] Float16, [] Int16, [] Uint16);

// ---- Masks ----

/// A mask register: one bit per lane.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct Bool16(__mmask16);

mask_basics!([] Bool16);

/// Operators of masks: those of their bits.
macro_rules! mask_operators {
    ($($Op:ident $op:ident $OpAssign:ident $op_assign:ident;)*) => {$(
        impl $Op for Bool16 {
            type Output = Self;
            #[inline(always)]
            fn $op(self, other: Self) -> Self {
                Self(self.0.$op(other.0))
            }
        }
        impl $OpAssign for Bool16 {
            #[inline(always)]
            fn $op_assign(&mut self, other: Self) {
                self.0.$op_assign(other.0);
            }
        }
    )*};
}
mask_operators! {
    BitAnd bitand BitAndAssign bitand_assign;
    BitOr bitor BitOrAssign bitor_assign;
    BitXor bitxor BitXorAssign bitxor_assign;
}

impl Not for Bool16 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl Mask for Bool16 {
    const LANES: usize = 16;

    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self(if value { u16::MAX } else { 0 })
    }
    #[inline(always)]
    fn from_bitmask(bits: u32) -> Self {
        Self(bits as u16)
    }
    #[inline(always)]
    fn bitmask(self) -> u32 {
        self.0.into()
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.0 != 0
    }
    #[inline(always)]
    fn all(self) -> bool {
        self.0 == u16::MAX
    }
}

// ---- What all lanes share ----

/// Columns to rows, and back, in each quarter by itself.
#[inline(always)]
fn transpose([a, b, c, d]: [__m512; 4]) -> [__m512; 4] {
    intrinsics! {
        let (ab_lo, ab_hi) = (_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b));
        let (cd_lo, cd_hi) = (_mm512_unpacklo_ps(c, d), _mm512_unpackhi_ps(c, d));
        [
            _mm512_shuffle_ps::<0b01_00_01_00>(ab_lo, cd_lo),
            _mm512_shuffle_ps::<0b11_10_11_10>(ab_lo, cd_lo),
            _mm512_shuffle_ps::<0b01_00_01_00>(ab_hi, cd_hi),
            _mm512_shuffle_ps::<0b11_10_11_10>(ab_hi, cd_hi),
        ]
    }
}

/// A register from its quarters.
#[inline(always)]
fn join(a: __m128, b: __m128, c: __m128, d: __m128) -> __m512 {
    intrinsics! {
        let low = _mm512_castps256_ps512(_mm256_set_m128(b, a));
        _mm512_insertf32x8::<1>(low, _mm256_set_m128(d, c))
    }
}

/// [`Vector`] of one lane type: memory in common, comparisons given.
macro_rules! vector {
    ($V:ident, $Half:ty, $Quarter:ty, $Lane:ty, $x:ident: splat $splat:expr, { $($given:tt)* }) => {
        impl $V {
            #[inline(always)]
            pub(super) fn halves(self) -> ($Half, $Half) {
                let x = self.ps();
                let (low, high) = intrinsics!((_mm512_castps512_ps256(x), _mm512_extractf32x8_ps::<1>(x)));
                (<$Half>::of_ps(low), <$Half>::of_ps(high))
            }
        }

        impl Halves for $V {
            type Half = $Half;

            #[inline(always)]
            fn from_halves(low: $Half, high: $Half) -> Self {
                let (low, high) = (low.ps(), high.ps());
                Self::of_ps(intrinsics!(_mm512_insertf32x8::<1>(_mm512_castps256_ps512(low), high)))
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
            type Mask = Bool16;
            type Index = Uint16;
            const LANES: usize = 16;

            #[inline(always)]
            fn splat($x: $Lane) -> Self {
                Self::new(intrinsics!($splat))
            }
            #[inline(always)]
            fn load(src: &[$Lane]) -> Self {
                let src: *const $Lane = src[..16].as_ptr();
                // SAFETY: sixteen elements are there to read.
                Self::of_ps(unsafe { _mm512_loadu_ps(src.cast()) })
            }
            #[inline(always)]
            fn store(self, dst: &mut [$Lane]) {
                let dst: *mut $Lane = dst[..16].as_mut_ptr();
                // SAFETY: sixteen elements are there to write.
                unsafe { _mm512_storeu_ps(dst.cast(), self.ps()) }
            }
            #[inline(always)]
            fn load_block(block: &Block<$Lane>, chunk: usize) -> Self {
                let src: *const $Lane = block.0.as_chunks::<16>().0[chunk].as_ptr();
                // SAFETY: sixteen elements are there to read, 64 * chunk bytes into a block aligned to 64.
                Self::of_ps(unsafe { _mm512_load_ps(src.cast()) })
            }
            #[inline(always)]
            fn store_block(self, block: &mut Block<$Lane>, chunk: usize) {
                let dst: *mut $Lane = block.0.as_chunks_mut::<16>().0[chunk].as_mut_ptr();
                // SAFETY: sixteen elements are there to write, 64 * chunk bytes into a block aligned to 64.
                unsafe { _mm512_store_ps(dst.cast(), self.ps()) }
            }
            #[inline(always)]
            fn load_masked(src: &[$Lane], mask: Bool16, or: Self) -> Self {
                check_masked(src.len(), mask);
                // SAFETY: only lanes that are on are read, and the slice has those.
                Self::of_ps(unsafe { _mm512_mask_loadu_ps(or.ps(), mask.0, src.as_ptr().cast()) })
            }
            #[inline(always)]
            fn store_masked(self, dst: &mut [$Lane], mask: Bool16) {
                check_masked(dst.len(), mask);
                // SAFETY: only lanes that are on are written, and the slice has those.
                unsafe { _mm512_mask_storeu_ps(dst.as_mut_ptr().cast(), mask.0, self.ps()) }
            }
            #[inline(always)]
            fn load_partial(src: &[$Lane]) -> Self {
                let n = src.len().min(16);
                Self::load_masked(&src[..n], Bool16::first_n(n), Self::default())
            }
            #[inline(always)]
            fn store_partial(self, dst: &mut [$Lane]) {
                let n = dst.len().min(16);
                self.store_masked(&mut dst[..n], Bool16::first_n(n));
            }
            #[inline(always)]
            fn stream(dst: &mut [Block<$Lane>], mut f: impl FnMut(usize) -> Self) {
                let _fence = StreamFence;
                for (i, block) in dst.iter_mut().enumerate() {
                    let x = f(i).ps();
                    // SAFETY: sixteen elements are there to write, aligned to 64 bytes; the fence comes before anybody else can look.
                    unsafe { _mm512_stream_ps(block.0.as_mut_ptr().cast(), x) }
                }
            }
            #[inline(always)]
            fn scatter_masked(self, dst: &mut [$Lane], index: Uint16, mask: Bool16) {
                check_bounds::<Self>(dst.len(), index, mask);
                if dst.len() > i32::MAX as usize {
                    // The instruction takes indices as signed.
                    return mask.set_lanes().for_each(|i| dst[index.lane(i) as usize] = self.lane(i));
                }
                let base: *mut f32 = dst.as_mut_ptr().cast();
                // SAFETY: the lanes that are on have indices below `dst.len()`; the others are not written.
                unsafe { _mm512_mask_i32scatter_ps::<4>(base.cast(), mask.0, index.0, self.ps()) }
            }
            #[inline(always)]
            fn gather_masked(src: &[$Lane], index: Uint16, mask: Bool16, or: Self) -> Self {
                check_bounds::<Self>(src.len(), index, mask);
                if src.len() > i32::MAX as usize {
                    // The instruction takes indices as signed.
                    return Self::from_fn(|i| if mask.bitmask() >> i & 1 != 0 { src[index.lane(i) as usize] } else { or.lane(i) });
                }
                let base: *const f32 = src.as_ptr().cast();
                // SAFETY: the lanes that are on have indices below `src.len()`; the others are not read.
                Self::of_ps(unsafe { _mm512_mask_i32gather_ps::<4>(or.ps(), mask.0, index.0, base) })
            }
            #[inline(always)]
            fn load_rows4(rows: &[[$Lane; 4]]) -> [Self; 4] {
                let rows = &rows[..16];
                let [a, b, c, d] = transpose([
                    join(<$Quarter>::load(&rows[0]).ps(), <$Quarter>::load(&rows[4]).ps(), <$Quarter>::load(&rows[8]).ps(), <$Quarter>::load(&rows[12]).ps()),
                    join(<$Quarter>::load(&rows[1]).ps(), <$Quarter>::load(&rows[5]).ps(), <$Quarter>::load(&rows[9]).ps(), <$Quarter>::load(&rows[13]).ps()),
                    join(<$Quarter>::load(&rows[2]).ps(), <$Quarter>::load(&rows[6]).ps(), <$Quarter>::load(&rows[10]).ps(), <$Quarter>::load(&rows[14]).ps()),
                    join(<$Quarter>::load(&rows[3]).ps(), <$Quarter>::load(&rows[7]).ps(), <$Quarter>::load(&rows[11]).ps(), <$Quarter>::load(&rows[15]).ps()),
                ]);
                [Self::of_ps(a), Self::of_ps(b), Self::of_ps(c), Self::of_ps(d)]
            }
            #[inline(always)]
            fn store_rows4([a, b, c, d]: [Self; 4], rows: &mut [[$Lane; 4]]) {
                let rows = &mut rows[..16];
                let [a, b, c, d] = transpose([a.ps(), b.ps(), c.ps(), d.ps()]);
                for (i, row) in [a, b, c, d].into_iter().enumerate() {
                    let (low, high) = Self::of_ps(row).halves();
                    let ((a, b), (c, d)) = (low.halves(), high.halves());
                    a.store(&mut rows[i]);
                    b.store(&mut rows[i + 4]);
                    c.store(&mut rows[i + 8]);
                    d.store(&mut rows[i + 12]);
                }
            }
            #[inline(always)]
            fn select(mask: Bool16, on_true: Self, on_false: Self) -> Self {
                Self::of_ps(intrinsics!(_mm512_mask_blend_ps(mask.0, on_false.ps(), on_true.ps())))
            }
            #[inline(always)]
            fn lookup(self, index: Uint16) -> Self {
                let x = self.ps();
                Self::of_ps(intrinsics!(_mm512_permutexvar_ps(index.0, x)))
            }
            #[inline(always)]
            fn interleave(self, other: Self) -> (Self, Self) {
                let (a, b) = (self.ps(), other.ps());
                let lane = |at: usize| Uint16::from_fn(|i| (at + i / 2 + 16 * (i % 2)) as u32).0;
                let (low, high) = (lane(0), lane(8));
                let (low, high) = intrinsics!((_mm512_permutex2var_ps(a, low, b), _mm512_permutex2var_ps(a, high, b)));
                (Self::of_ps(low), Self::of_ps(high))
            }
            #[inline(always)]
            fn deinterleave(self, other: Self) -> (Self, Self) {
                let (a, b) = (self.ps(), other.ps());
                let (even, odd) = (Uint16::from_fn(|i| 2 * i as u32).0, Uint16::from_fn(|i| 2 * i as u32 + 1).0);
                let (even, odd) = intrinsics!((_mm512_permutex2var_ps(a, even, b), _mm512_permutex2var_ps(a, odd, b)));
                (Self::of_ps(even), Self::of_ps(odd))
            }
            #[inline(always)]
            fn compress(self, mask: Bool16) -> Self {
                let x = self.ps();
                Self::of_ps(intrinsics!(_mm512_maskz_compress_ps(mask.0, x)))
            }
            #[inline(always)]
            fn expand(self, mask: Bool16) -> Self {
                let x = self.ps();
                Self::of_ps(intrinsics!(_mm512_maskz_expand_ps(mask.0, x)))
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

// ---- Integers ----

/// Operators that `i32` and `u32` share, the shift to the right given.
macro_rules! integer {
    ($V:ident, $Lane:ty, $shift_right:ident, $shift_lanes_right:ident) => {
        operators!([] $V:
            Add add AddAssign add_assign = _mm512_add_epi32;
            Sub sub SubAssign sub_assign = _mm512_sub_epi32;
            BitAnd bitand BitAndAssign bitand_assign = _mm512_and_si512;
            BitOr bitor BitOrAssign bitor_assign = _mm512_or_si512;
            BitXor bitxor BitXorAssign bitxor_assign = _mm512_xor_si512;
        );
        impl Mul for $V {
            type Output = Self;
            #[inline(always)]
            fn mul(self, other: Self) -> Self {
                Self::new(intrinsics!(_mm512_mullo_epi32(self.0, other.0)))
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
                Self::new(intrinsics!(_mm512_xor_si512(self.0, _mm512_set1_epi32(-1))))
            }
        }
        impl Shl<usize> for $V {
            type Output = Self;
            #[inline(always)]
            fn shl(self, n: usize) -> Self {
                Self::new(intrinsics!(_mm512_sll_epi32(self.0, sse::shift_count(n))))
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
            fn shl_lanes(self, n: Uint16) -> Self {
                Self::new(intrinsics!(_mm512_sllv_epi32(self.0, _mm512_and_si512(n.0, _mm512_set1_epi32(31)))))
            }
            #[inline(always)]
            fn shr_lanes(self, n: Uint16) -> Self {
                Self::new(intrinsics!($shift_lanes_right(self.0, _mm512_and_si512(n.0, _mm512_set1_epi32(31)))))
            }
        }
    };
}
integer!(Int16, i32, _mm512_sra_epi32, _mm512_srav_epi32);
integer!(Uint16, u32, _mm512_srl_epi32, _mm512_srlv_epi32);

vector! { Int16, avx2::Int8, sse::Int4<Avx2>, i32, x: splat _mm512_set1_epi32(x), {
    #[inline(always)]
    fn eq(self, other: Self) -> Bool16 {
        Bool16(intrinsics!(_mm512_cmpeq_epi32_mask(self.0, other.0)))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Bool16 {
        Bool16(intrinsics!(_mm512_cmplt_epi32_mask(self.0, other.0)))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Bool16 {
        Bool16(intrinsics!(_mm512_cmple_epi32_mask(self.0, other.0)))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm512_min_epi32(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm512_max_epi32(self.0, other.0)))
    }
} }

impl Neg for Int16 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::splat(0) - self
    }
}

impl Int for Int16 {
    #[inline(always)]
    fn abs(self) -> Self {
        let sign = self >> 31;
        (self ^ sign) - sign
    }
    #[inline(always)]
    fn to_uint(self) -> Uint16 {
        Uint16::new(self.0)
    }
    #[inline(always)]
    fn from_uint(x: Uint16) -> Self {
        Self::new(x.0)
    }
}

vector! { Uint16, avx2::Uint8, sse::Uint4<Avx2>, u32, x: splat _mm512_set1_epi32(x as i32), {
    #[inline(always)]
    fn eq(self, other: Self) -> Bool16 {
        Bool16(intrinsics!(_mm512_cmpeq_epu32_mask(self.0, other.0)))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Bool16 {
        Bool16(intrinsics!(_mm512_cmplt_epu32_mask(self.0, other.0)))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Bool16 {
        Bool16(intrinsics!(_mm512_cmple_epu32_mask(self.0, other.0)))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm512_min_epu32(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::new(intrinsics!(_mm512_max_epu32(self.0, other.0)))
    }
} }

impl Uint for Uint16 {
    #[inline(always)]
    fn mul_high(self, other: Self) -> Self {
        Self::new(intrinsics! {
            let even = _mm512_mul_epu32(self.0, other.0);
            let odd = _mm512_mul_epu32(_mm512_srli_epi64::<32>(self.0), _mm512_srli_epi64::<32>(other.0));
            _mm512_mask_blend_epi32(0xaaaa, _mm512_srli_epi64::<32>(even), odd)
        })
    }
    #[inline(always)]
    fn leading_zeros(self) -> Self {
        Self::new(intrinsics!(_mm512_lzcnt_epi32(self.0)))
    }
}
