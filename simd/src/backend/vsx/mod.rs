//! powerpc64le, four lanes: AltiVec and VSX, as POWER8 has them.
//!
//! Behind a feature, because `core::arch` has these instructions in nightly Rust alone. It lacks some of them (division, square
//! roots and most comparisons of floats, the count of bits); those are of portable SIMD, which compiles to one instruction each.

use super::tables::COMPRESS4;
use super::{check_bounds, intrinsics, list_lanes, mask_basics, narrow_types, operators, vector_basics};
use crate::pair::Pair;
use crate::vector::sealed::{List, Sealed};
use crate::{Block, Float, Int, Integer, Isa, Level, Mask, Simd, Uint, Vector};
use std::arch::powerpc64::*;
use std::fmt;
use std::mem::transmute;
use std::ops::*;

mod float;
mod integer;
mod lanes;

// ---- The set ----

/// AltiVec and VSX with fused multiply-add.
#[derive(Debug, Clone, Copy)]
pub struct Vsx;
impl Sealed for Vsx {}
impl Simd for Vsx {
    const LEVEL: Level = Level::of_backend(Isa::Vsx);
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
    type Double4 = Pair<Self::Double2>;
    type Double8 = Pair<Self::Double4>;
    type Float = Float4;
    narrow_types!();
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
    Float4(vector_float);
    /// Four `i32`.
    Int4(vector_signed_int);
    /// Four `u32`.
    Uint4(vector_unsigned_int);
    /// All bits of a true lane are ones, all of a false lane zeros.
    Bool4(vector_unsigned_int);
}
vector_basics!([] Float4, [] Int4, [] Uint4);

// ---- Masks ----

mask_basics!([] Bool4);

operators!([] Bool4:
    BitAnd bitand BitAndAssign bitand_assign = vec_and;
    BitOr bitor BitOrAssign bitor_assign = vec_or;
    BitXor bitxor BitXorAssign bitxor_assign = vec_xor;
);

impl Not for Bool4 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(intrinsics!(vec_nor(self.0, self.0)))
    }
}

impl Bool4 {
    /// The bit of each lane in a bit mask.
    #[inline(always)]
    fn bit() -> Uint4 {
        Uint4::load(&[1, 2, 4, 8])
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
        (Uint4::splat(bits) & Self::bit()).eq(Self::bit())
    }
    #[inline(always)]
    fn bitmask(self) -> u32 {
        // Two general registers, folded.
        let bits: u128 = intrinsics!(transmute(vec_and(self.0, Self::bit().0)));
        let bits = bits as u64 | (bits >> 64) as u64;
        (bits | bits >> 32) as u32
    }
    #[inline(always)]
    fn any(self) -> bool {
        intrinsics!(vec_any_ne(self.0, Uint4::default().0))
    }
    #[inline(always)]
    fn all(self) -> bool {
        intrinsics!(vec_all_ne(self.0, Uint4::default().0))
    }
}
