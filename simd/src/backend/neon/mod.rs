//! aarch64, four lanes: Advanced SIMD.

use super::quad::Double4;
use super::tables::COMPRESS4;
use super::{check_bounds, intrinsics, list_lanes, mask_basics, narrow_types, operators, vector_basics};
use crate::pair::Pair;
use crate::vector::sealed::{List, Sealed};
use crate::{Block, Float, Int, Integer, Isa, Level, Mask, Simd, Uint, Vector};
use std::arch::aarch64::*;
use std::fmt;
use std::ops::*;

mod double;
mod float;
mod integer;
mod lanes;
mod narrow;

// ---- The set ----

/// Advanced SIMD with fused multiply-add, which every aarch64 has.
#[derive(Debug, Clone, Copy)]
pub struct Neon;
impl Sealed for Neon {}
impl Simd for Neon {
    const LEVEL: Level = Level::of_backend(Isa::Neon);
    type Float4 = Float4;
    type Int4 = Int4;
    type Uint4 = Uint4;
    type Bool4 = Bool4;
    type Float8 = Pair<Float4>;
    type Int8 = Pair<Int4>;
    type Uint8 = Pair<Uint4>;
    type Bool8 = Pair<Bool4>;
    type Float16 = Pair<Self::Float8>;
    type Int16 = Pair<Self::Int8>;
    type Uint16 = Pair<Self::Uint8>;
    type Bool16 = Pair<Self::Bool8>;
    type Double2 = Pair<f64>;
    type Double4 = Double4<double::Doubles>;
    type Double8 = Pair<Self::Double4>;
    type Float = Float4;
    narrow_types!(narrow::Short8, narrow::UShort8, narrow::Char16, narrow::UChar16);
}

/// A type over its register.
macro_rules! register {
    ($($(#[$doc:meta])* $V:ident($reg:ty);)*) => {$(
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
    )*};
}
register! {
    /// Four `f32`.
    Float4(float32x4_t);
    /// Four `i32`.
    Int4(int32x4_t);
    /// Four `u32`.
    Uint4(uint32x4_t);
    /// All bits of a true lane are ones, all of a false lane zeros.
    Bool4(uint32x4_t);
}
vector_basics!([] Float4, [] Int4, [] Uint4);

/// The bits of the lanes, whatever their type.
macro_rules! lane_bits {
    ($($V:ident, $x:ident: from $of:expr, to $to:expr;)*) => {$(
        impl $V {
            #[inline(always)]
            fn of_lane_bits($x: uint32x4_t) -> Self {
                Self($of)
            }
            #[inline(always)]
            fn lane_bits(self) -> uint32x4_t {
                let $x = self.0;
                $to
            }
        }
    )*};
}
lane_bits! {
    Float4, x: from intrinsics!(vreinterpretq_f32_u32(x)), to intrinsics!(vreinterpretq_u32_f32(x));
    Int4, x: from intrinsics!(vreinterpretq_s32_u32(x)), to intrinsics!(vreinterpretq_u32_s32(x));
    Uint4, x: from x, to x;
}

// ---- Masks ----

mask_basics!([] Bool4);

operators!([] Bool4:
    BitAnd bitand BitAndAssign bitand_assign = vandq_u32;
    BitOr bitor BitOrAssign bitor_assign = vorrq_u32;
    BitXor bitxor BitXorAssign bitxor_assign = veorq_u32;
);

impl Not for Bool4 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(intrinsics!(vmvnq_u32(self.0)))
    }
}

impl Bool4 {
    /// The bit of each lane in a bit mask.
    #[inline(always)]
    fn bit() -> uint32x4_t {
        Uint4::load(&[1, 2, 4, 8]).0
    }
}

impl Mask for Bool4 {
    const LANES: usize = 4;

    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self(Uint4::splat(u32::from(value).wrapping_neg()).0)
    }
    #[inline(always)]
    fn from_bitmask(bits: u32) -> Self {
        Self(intrinsics!(vtstq_u32(vdupq_n_u32(bits), Self::bit())))
    }
    #[inline(always)]
    fn bitmask(self) -> u32 {
        intrinsics!(vaddvq_u32(vandq_u32(self.0, Self::bit())))
    }
    #[inline(always)]
    fn any(self) -> bool {
        intrinsics!(vmaxvq_u32(self.0)) != 0
    }
    #[inline(always)]
    fn all(self) -> bool {
        intrinsics!(vminvq_u32(self.0)) != 0
    }
    #[inline(always)]
    fn count(self) -> usize {
        // A true lane is -1.
        intrinsics!(vaddvq_u32(self.0)).wrapping_neg() as usize
    }
}
