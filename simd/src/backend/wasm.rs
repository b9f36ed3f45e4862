//! WebAssembly, four lanes: `simd128`, and `relaxed-simd` on top of it, told apart by a marker.
//!
//! There is nothing to detect: a module that has an instruction its engine lacks is rejected as a whole. So this file is part
//! of builds that have the features, and calling an instruction is safe there; only memory is not.
#![allow(unused_unsafe, reason = "of macros that other backends share, whose instructions are unsafe to call")]

use super::{check_bounds, debug_lanes, intrinsics, operators};
use crate::pair::Pair;
use crate::vector::sealed::Sealed;
use crate::{Block, Float, Int, Integer, Isa, Kernel, Level, Mask, Simd, Uint, Vector};
use std::arch::wasm32::*;
use std::fmt;
use std::marker::PhantomData;
use std::ops::*;

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
            type Float = Self::Float4;
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
debug_lanes!([I: MulAdd] Float4<I>, [] Int4, [] Uint4);

// ---- Masks ----

impl Sealed for Bool4 {}
impl fmt::Debug for Bool4 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:04b}", self.bitmask())
    }
}

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

// ---- What all lanes share ----

/// Columns to rows, and back.
#[inline(always)]
fn transpose([a, b, c, d]: [v128; 4]) -> [v128; 4] {
    let (ab_lo, ab_hi) = (u32x4_shuffle::<0, 4, 1, 5>(a, b), u32x4_shuffle::<2, 6, 3, 7>(a, b));
    let (cd_lo, cd_hi) = (u32x4_shuffle::<0, 4, 1, 5>(c, d), u32x4_shuffle::<2, 6, 3, 7>(c, d));
    [
        u64x2_shuffle::<0, 2>(ab_lo, cd_lo),
        u64x2_shuffle::<1, 3>(ab_lo, cd_lo),
        u64x2_shuffle::<0, 2>(ab_hi, cd_hi),
        u64x2_shuffle::<1, 3>(ab_hi, cd_hi),
    ]
}

/// [`Vector`] of one lane type from its intrinsics: memory in common, minimum and maximum given.
macro_rules! vector {
    (
        [$($generics:tt)*] $V:ty, $Lane:ty: splat $splat:ident, first $extract:ident, eq $eq:ident, lt $lt:ident, le $le:ident,
        { $($given:tt)* }
    ) => {
        impl<$($generics)*> $V {
            /// The halves with each other, then lane 0 with lane 1.
            #[inline(always)]
            fn reduce(self, op: impl Fn(Self, Self) -> Self) -> $Lane {
                let two = op(self, Self::new(u64x2_shuffle::<1, 1>(self.0, self.0)));
                let one = op(two, Self::new(u32x4_shuffle::<1, 1, 1, 1>(two.0, two.0)));
                $extract::<0>(one.0)
            }
        }

        impl<$($generics)*> Vector for $V {
            type Lane = $Lane;
            type Mask = Bool4;
            type Index = Uint4;
            const LANES: usize = 4;

            #[inline(always)]
            fn splat(x: $Lane) -> Self {
                Self::new($splat(x))
            }
            #[inline(always)]
            fn load(src: &[$Lane]) -> Self {
                let src: *const $Lane = src[..4].as_ptr();
                // SAFETY: four elements are there to read.
                Self::new(unsafe { v128_load(src.cast()) })
            }
            #[inline(always)]
            fn store(self, dst: &mut [$Lane]) {
                let dst: *mut $Lane = dst[..4].as_mut_ptr();
                // SAFETY: four elements are there to write.
                unsafe { v128_store(dst.cast(), self.0) }
            }
            #[inline(always)]
            fn load_block(block: &Block<$Lane>, chunk: usize) -> Self {
                Self::load(&block.0.as_chunks::<4>().0[chunk])
            }
            #[inline(always)]
            fn store_block(self, block: &mut Block<$Lane>, chunk: usize) {
                self.store(&mut block.0.as_chunks_mut::<4>().0[chunk]);
            }
            #[inline(always)]
            fn gather_masked(src: &[$Lane], index: Uint4, mask: Bool4, or: Self) -> Self {
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
                let row = |i: usize| Self::load(&rows[i]).0;
                let [a, b, c, d] = transpose([row(0), row(1), row(2), row(3)]);
                [Self::new(a), Self::new(b), Self::new(c), Self::new(d)]
            }
            #[inline(always)]
            fn store_rows4([a, b, c, d]: [Self; 4], rows: &mut [[$Lane; 4]]) {
                let [a, b, c, d] = transpose([a.0, b.0, c.0, d.0]);
                let rows = &mut rows[..4];
                Self::new(a).store(&mut rows[0]);
                Self::new(b).store(&mut rows[1]);
                Self::new(c).store(&mut rows[2]);
                Self::new(d).store(&mut rows[3]);
            }
            #[inline(always)]
            fn select(mask: Bool4, on_true: Self, on_false: Self) -> Self {
                Self::new(v128_bitselect(on_true.0, on_false.0, mask.0))
            }
            #[inline(always)]
            fn eq(self, other: Self) -> Bool4 {
                Bool4($eq(self.0, other.0))
            }
            #[inline(always)]
            fn lt(self, other: Self) -> Bool4 {
                Bool4($lt(self.0, other.0))
            }
            #[inline(always)]
            fn le(self, other: Self) -> Bool4 {
                Bool4($le(self.0, other.0))
            }
            #[inline(always)]
            fn reduce_min(self) -> $Lane {
                self.reduce(Self::min)
            }
            #[inline(always)]
            fn reduce_max(self) -> $Lane {
                self.reduce(Self::max)
            }
            $($given)*
        }
    };
}

// ---- Floats ----

vector! {
    [I: MulAdd] Float4<I>, f32: splat f32x4_splat, first f32x4_extract_lane, eq f32x4_eq, lt f32x4_lt, le f32x4_le,
{
    // The pseudo-minimum of (a, b) is `if b < a { b } else { a }`. Not `f32x4_min`: it returns NaN when either is, and orders
    // the zeros. With relaxed SIMD, LLVM 22 makes a relaxed minimum of it, which may return either of NaN and a number, and of
    // the zeros (llvm/llvm-project#177814); not so of a selection by bits.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if cfg!(target_feature = "relaxed-simd") {
            Self::select(self.lt(other), self, other)
        } else {
            Self::new(f32x4_pmin(other.0, self.0))
        }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if cfg!(target_feature = "relaxed-simd") {
            Self::select(other.lt(self), self, other)
        } else {
            Self::new(f32x4_pmax(other.0, self.0))
        }
    }
} }

operators!([I: MulAdd] Float4<I>:
    Add add AddAssign add_assign = f32x4_add;
    Sub sub SubAssign sub_assign = f32x4_sub;
    Mul mul MulAssign mul_assign = f32x4_mul;
    Div div DivAssign div_assign = f32x4_div;
);

impl<I: MulAdd> Neg for Float4<I> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(f32x4_neg(self.0))
    }
}

impl<I: MulAdd> Float for Float4<I> {
    type Int = Int4;

    #[inline(always)]
    fn abs(self) -> Self {
        Self::new(f32x4_abs(self.0))
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Self::new(v128_bitselect(sign.0, self.0, u32x4_splat(1 << 31)))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::new(f32x4_sqrt(self.0))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self::new(f32x4_floor(self.0))
    }
    #[inline(always)]
    fn ceil(self) -> Self {
        Self::new(f32x4_ceil(self.0))
    }
    #[inline(always)]
    fn trunc(self) -> Self {
        Self::new(f32x4_trunc(self.0))
    }
    #[inline(always)]
    fn round(self) -> Self {
        Self::new(f32x4_nearest(self.0))
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self::new(I::mul_add(self.0, b.0, c.0))
    }
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        self.mul_add(b, -c)
    }
    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        Self::new(I::neg_mul_add(self.0, b.0, c.0))
    }

    // The conversions saturate and take NaN to 0 by themselves.
    #[inline(always)]
    fn to_int(self) -> Int4 {
        Int4(i32x4_trunc_sat_f32x4(self.0))
    }
    #[inline(always)]
    fn to_uint(self) -> Uint4 {
        Uint4(u32x4_trunc_sat_f32x4(self.0))
    }
    #[inline(always)]
    fn from_int(x: Int4) -> Self {
        Self::new(f32x4_convert_i32x4(x.0))
    }
    #[inline(always)]
    fn from_uint(x: Uint4) -> Self {
        Self::new(f32x4_convert_u32x4(x.0))
    }
    #[inline(always)]
    fn to_bits(self) -> Uint4 {
        Uint4(self.0)
    }
    #[inline(always)]
    fn from_bits(x: Uint4) -> Self {
        Self::new(x.0)
    }
    #[inline(always)]
    fn reduce_add(self) -> f32 {
        self.reduce(Self::add)
    }
}

// ---- Integers ----

/// Operators that `i32` and `u32` share.
macro_rules! integer {
    ($V:ident: $shr:ident) => {
        operators!([] $V:
            Add add AddAssign add_assign = i32x4_add;
            Sub sub SubAssign sub_assign = i32x4_sub;
            Mul mul MulAssign mul_assign = i32x4_mul;
            BitAnd bitand BitAndAssign bitand_assign = v128_and;
            BitOr bitor BitOrAssign bitor_assign = v128_or;
            BitXor bitxor BitXorAssign bitxor_assign = v128_xor;
        );
        impl Not for $V {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self(v128_not(self.0))
            }
        }
        // The instructions take the count modulo 32 by themselves.
        impl Shl<usize> for $V {
            type Output = Self;
            #[inline(always)]
            fn shl(self, n: usize) -> Self {
                Self(i32x4_shl(self.0, n as u32))
            }
        }
        impl Shr<usize> for $V {
            type Output = Self;
            #[inline(always)]
            fn shr(self, n: usize) -> Self {
                Self($shr(self.0, n as u32))
            }
        }
        impl Integer for $V {}
    };
}
integer!(Int4: i32x4_shr);
integer!(Uint4: u32x4_shr);

vector! {
    [] Int4, i32: splat i32x4_splat, first i32x4_extract_lane, eq i32x4_eq, lt i32x4_lt, le i32x4_le,
{
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(i32x4_min(self.0, other.0))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(i32x4_max(self.0, other.0))
    }
} }

impl Neg for Int4 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(i32x4_neg(self.0))
    }
}

impl Int for Int4 {
    #[inline(always)]
    fn abs(self) -> Self {
        Self(i32x4_abs(self.0))
    }
    #[inline(always)]
    fn to_uint(self) -> Uint4 {
        Uint4(self.0)
    }
    #[inline(always)]
    fn from_uint(x: Uint4) -> Self {
        Self(x.0)
    }
}

vector! {
    [] Uint4, u32: splat u32x4_splat, first u32x4_extract_lane, eq u32x4_eq, lt u32x4_lt, le u32x4_le,
{
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(u32x4_min(self.0, other.0))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(u32x4_max(self.0, other.0))
    }
} }

impl Uint for Uint4 {}
