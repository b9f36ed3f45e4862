//! x86, four lanes: SSE2, SSE4.2, and the four-lane types of AVX2 and AVX-512, told apart by a marker.

use super::quad::Double4;
use super::tables::COMPRESS4;
use super::{check_bounds, intrinsics, list_lanes, mask_basics, narrow_types, operators, vector_basics};
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

mod double;
mod float;
mod integer;
mod lanes;
mod narrow;

pub(super) use integer::shift_count;
pub(super) use lanes::StreamFence;
pub(super) use narrow::{Char16, Short8, UChar16, UShort8};

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
            type Double2 = Pair<f64>;
            type Double4 = Double4<double::Doubles<Self>>;
            type Double8 = Pair<Self::Double4>;
            type Float = Self::Float4;
            narrow_types!(Short8<Self>, UShort8<Self>, Char16<Self>, UChar16<Self>);
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
    pub(super) fn new(x: __m128) -> Self {
        Self(x, PhantomData)
    }
    #[inline(always)]
    pub(super) fn ps(self) -> __m128 {
        self.0
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
