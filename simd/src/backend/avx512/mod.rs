//! AVX-512, sixteen lanes and mask registers. Four and eight lanes are [`sse`](super::sse)'s and [`avx2`](super::avx2)'s.

use super::avx2::{self, Avx2};
use super::quad::Double4;
use super::sse::{self, StreamFence};
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

mod float;
mod integer;
mod lanes;

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
    type Double2 = Pair<f64>;
    // Eight in one register would want masks in mask registers, as only sixteen 32-bit lanes have here.
    type Double4 = Double4<avx2::Doubles>;
    type Double8 = Pair<Self::Double4>;
    type Float = Float16;
    narrow_types!(sse::Short8<Avx2>, sse::UShort8<Avx2>, sse::Char16<Avx2>, sse::UChar16<Avx2>;
        avx2::Short16, avx2::UShort16, avx2::Char32, avx2::UChar32);
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
