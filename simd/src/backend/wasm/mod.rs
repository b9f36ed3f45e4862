//! WebAssembly, four lanes: `simd128`, and `relaxed-simd` on top of it, told apart by a marker.
//!
//! There is nothing to detect: a module that has an instruction its engine lacks is rejected as a whole. So this file is part
//! of builds that have the features, and calling an instruction is safe there; only memory is not.
#![allow(unused_unsafe, reason = "of macros that other backends share, whose instructions are unsafe to call")]

use super::tables::COMPRESS4;
use super::{check_bounds, intrinsics, list_lanes, mask_basics, narrow_types, operators, vector_basics};
use crate::pair::Pair;
use crate::vector::sealed::{List, Sealed};
use crate::{Block, Float, Int, Integer, Isa, Kernel, Level, Mask, Simd, Uint, Vector};
use std::arch::wasm32::*;
use std::fmt;
use std::marker::PhantomData;
use std::ops::*;

mod float;
mod integer;
mod lanes;

// ---- The set ----

/// What the levels differ in.
pub trait MulAdd: Copy + Send + Sync + 'static {
    /// `a * b + c`, relaxed.
    fn mul_add(a: v128, b: v128, c: v128) -> v128;
    /// `c - a * b`, relaxed.
    fn neg_mul_add(a: v128, b: v128, c: v128) -> v128;
}

/// Two roundings.
#[derive(Debug, Clone, Copy)]
pub struct Wasm;
impl MulAdd for Wasm {
    #[inline(always)]
    fn mul_add(a: v128, b: v128, c: v128) -> v128 {
        f32x4_add(f32x4_mul(a, b), c)
    }
    #[inline(always)]
    fn neg_mul_add(a: v128, b: v128, c: v128) -> v128 {
        f32x4_sub(c, f32x4_mul(a, b))
    }
}

/// One rounding or two, whichever the engine finds faster.
#[cfg(target_feature = "relaxed-simd")]
#[derive(Debug, Clone, Copy)]
pub struct WasmRelaxed;
#[cfg(target_feature = "relaxed-simd")]
impl MulAdd for WasmRelaxed {
    #[inline(always)]
    fn mul_add(a: v128, b: v128, c: v128) -> v128 {
        f32x4_relaxed_madd(a, b, c)
    }
    #[inline(always)]
    fn neg_mul_add(a: v128, b: v128, c: v128) -> v128 {
        f32x4_relaxed_nmadd(a, b, c)
    }
}

macro_rules! four_lanes_native {
    ($Level:ident) => {
        impl Sealed for $Level {}
        impl Simd for $Level {
            const LEVEL: Level = Level::of_backend(Isa::$Level);
            type Float4 = Float4<Self>;
            type Int4 = Int4;
            type Uint4 = Uint4;
            type Bool4 = Bool4;
            type Float8 = Pair<Self::Float4>;
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
            type Float = Self::Float4;
            narrow_types!();
        }
    };
}
four_lanes_native!(Wasm);
#[cfg(target_feature = "relaxed-simd")]
four_lanes_native!(WasmRelaxed);

// Like the functions of the other levels, which cannot be inlined.
#[inline(never)]
pub(super) fn run<S: Simd, K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<S>()
}

/// Four `f32`.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct Float4<I>(v128, PhantomData<I>);

impl<I> Float4<I> {
    #[inline(always)]
    fn new(x: v128) -> Self {
        Self(x, PhantomData)
    }
}

/// A type over its register.
macro_rules! register {
    ($($(#[$doc:meta])* $V:ident;)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy)]
        #[repr(transparent)]
        pub struct $V(v128);

        impl $V {
            #[inline(always)]
            fn new(x: v128) -> Self {
                Self(x)
            }
        }
    )*};
}
register! {
    /// Four `i32`.
    Int4;
    /// Four `u32`.
    Uint4;
    /// All bits of a true lane are ones, all of a false lane zeros.
    Bool4;
}
vector_basics!([I: MulAdd] Float4<I>, [] Int4, [] Uint4);

// ---- Masks ----

mask_basics!([] Bool4);

operators!([] Bool4:
    BitAnd bitand BitAndAssign bitand_assign = v128_and;
    BitOr bitor BitOrAssign bitor_assign = v128_or;
    BitXor bitxor BitXorAssign bitxor_assign = v128_xor;
);

impl Not for Bool4 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(v128_not(self.0))
    }
}

impl Mask for Bool4 {
    const LANES: usize = 4;

    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self(i32x4_splat(-i32::from(value)))
    }
    #[inline(always)]
    fn from_bitmask(bits: u32) -> Self {
        let bit = u32x4(1, 2, 4, 8);
        Self(u32x4_eq(v128_and(u32x4_splat(bits), bit), bit))
    }
    #[inline(always)]
    fn bitmask(self) -> u32 {
        u32x4_bitmask(self.0).into()
    }
    #[inline(always)]
    fn any(self) -> bool {
        v128_any_true(self.0)
    }
    #[inline(always)]
    fn all(self) -> bool {
        u32x4_all_true(self.0)
    }
}
