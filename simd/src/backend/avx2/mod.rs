//! AVX2 and FMA, eight lanes. Four lanes are [`sse`](super::sse)'s.

use super::quad::Double4;
use super::sse::{self, Sse, StreamFence};
use super::tables::{COMPRESS8, Lanes8};
use super::{check_bounds, intrinsics, list_lanes, mask_basics, narrow_types, operators, vector_basics};
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

mod double;
mod float;
mod integer;
mod lanes;
mod narrow;

pub(super) use double::Doubles;
pub(super) use narrow::{Char32, Short16, UChar32, UShort16};

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
    type Double2 = Pair<f64>;
    type Double4 = Double4<double::Doubles>;
    type Double8 = Pair<Self::Double4>;
    type Float = Float8;
    narrow_types!(sse::Short8<Self>, sse::UShort8<Self>, sse::Char16<Self>, sse::UChar16<Self>;
        Short16, UShort16, Char32, UChar32);
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
