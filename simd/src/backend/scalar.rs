//! One lane: `f32`, [`Wrapping<i32>`], [`Wrapping<u32>`] and `bool` as vectors. They define what every operation means.
//!
//! Emulated vectors are pairs of pairs of these.

use super::soft;
use crate::pair::Pair;
use crate::vector::sealed::{List, Sealed};
use crate::{Block, Double, Float, Int, Integer, Isa, Kernel, Lane, Level, Mask, Simd, Uint, Vector};
use std::fmt;
use std::num::Wrapping;

// ---- The set ----

/// Emulation as LLVM likes to compile it.
#[derive(Debug, Clone, Copy)]
pub struct Scalar;

/// The vector types of an emulation, from its one-lane types.
macro_rules! emulation {
    ($Level:ident, $f:ty, $i:ty, $u:ty, $d:ty) => {
        impl Sealed for $Level {}
        impl Simd for $Level {
            const LEVEL: Level = Level::of_backend(Isa::$Level);
            type Float4 = Pair<Pair<$f>>;
            type Int4 = Pair<Pair<$i>>;
            type Uint4 = Pair<Pair<$u>>;
            type Bool4 = Pair<Pair<bool>>;
            type Float8 = Pair<Self::Float4>;
            type Int8 = Pair<Self::Int4>;
            type Uint8 = Pair<Self::Uint4>;
            type Bool8 = Pair<Self::Bool4>;
            type Float16 = Pair<Self::Float8>;
            type Int16 = Pair<Self::Int8>;
            type Uint16 = Pair<Self::Uint8>;
            type Bool16 = Pair<Self::Bool8>;
            type Double2 = Pair<$d>;
            type Double4 = Pair<Self::Double2>;
            type Double8 = Pair<Self::Double4>;
            type Float = Self::Float4;
            $crate::backend::narrow_types!();
        }

        // Like the functions of the other levels, which cannot be inlined.
        #[inline(never)]
        pub(crate) fn run<K: Kernel>(kernel: K) -> K::Output {
            kernel.run::<$Level>()
        }
    };
}
pub(super) use emulation;
emulation!(Scalar, f32, Wrapping<i32>, Wrapping<u32>, f64);

// ---- Masks ----

impl Sealed for bool {}
impl Mask for bool {
    const LANES: usize = 1;

    #[inline(always)]
    fn splat(value: bool) -> Self {
        value
    }
    #[inline(always)]
    fn from_bitmask(bits: u32) -> Self {
        bits & 1 != 0
    }
    #[inline(always)]
    fn bitmask(self) -> u32 {
        u32::from(self)
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn all(self) -> bool {
        self
    }
}

impl List for bool {
    fn list(&self, list: &mut fmt::DebugList<'_, '_>) {
        list.entry(self);
    }
}

// ---- What all lanes share ----

/// Moving lanes about, where there is one.
macro_rules! one_lane {
    () => {
        #[inline(always)]
        fn lookup(self, _index: Self::Index) -> Self {
            self
        }
        #[inline(always)]
        fn interleave(self, other: Self) -> (Self, Self) {
            (self, other)
        }
        #[inline(always)]
        fn deinterleave(self, other: Self) -> (Self, Self) {
            (self, other)
        }
        #[inline(always)]
        fn compress(self, mask: bool) -> Self {
            Self::select(mask, self, Self::default())
        }
        #[inline(always)]
        fn expand(self, mask: bool) -> Self {
            Self::select(mask, self, Self::default())
        }
    };
}
pub(super) use one_lane;

/// [`Vector`] of one lane type, from a value and back.
macro_rules! lane {
    ($Lane:ty, $V:ty, $smallest:expr, $largest:expr, $of:expr, $get:expr) => {
        impl Lane for $Lane {
            const LARGEST: Self = $largest;
            const SMALLEST: Self = $smallest;
        }
        impl List for $V {
            fn list(&self, list: &mut fmt::DebugList<'_, '_>) {
                list.entry(&$get(*self));
            }
        }
        impl Vector for $V {
            type Lane = $Lane;
            type Mask = bool;
            type Index = Wrapping<u32>;
            const LANES: usize = 1;

            #[inline(always)]
            fn splat(x: $Lane) -> Self {
                $of(x)
            }
            #[inline(always)]
            fn load(src: &[$Lane]) -> Self {
                $of(src[0])
            }
            #[inline(always)]
            fn store(self, dst: &mut [$Lane]) {
                dst[0] = $get(self);
            }
            #[inline(always)]
            fn load_block(block: &Block<$Lane>, chunk: usize) -> Self {
                $of(block.0[chunk])
            }
            #[inline(always)]
            fn store_block(self, block: &mut Block<$Lane>, chunk: usize) {
                block.0[chunk] = $get(self);
            }
            #[inline(always)]
            fn gather_masked(src: &[$Lane], index: Wrapping<u32>, mask: bool, or: Self) -> Self {
                if mask { $of(src[index.0 as usize]) } else { or }
            }
            #[inline(always)]
            fn load_rows4(rows: &[[$Lane; 4]]) -> [Self; 4] {
                let [a, b, c, d] = rows[0];
                [$of(a), $of(b), $of(c), $of(d)]
            }
            #[inline(always)]
            fn store_rows4([a, b, c, d]: [Self; 4], rows: &mut [[$Lane; 4]]) {
                rows[0] = [$get(a), $get(b), $get(c), $get(d)];
            }
            one_lane!();
            #[inline(always)]
            fn select(mask: bool, on_true: Self, on_false: Self) -> Self {
                if mask { on_true } else { on_false }
            }
            #[inline(always)]
            fn eq(self, other: Self) -> bool {
                self == other
            }
            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn le(self, other: Self) -> bool {
                self <= other
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if self < other { self } else { other }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if self > other { self } else { other }
            }
            #[inline(always)]
            fn reduce_min(self) -> $Lane {
                $get(self)
            }
            #[inline(always)]
            fn reduce_max(self) -> $Lane {
                $get(self)
            }
        }
    };
}

impl Sealed for f32 {}
impl Sealed for f64 {}
impl Sealed for i32 {}
impl Sealed for u32 {}
impl<T> Sealed for Wrapping<T> {}
lane!(f64, f64, f64::NEG_INFINITY, f64::INFINITY, std::convert::identity, std::convert::identity);
lane!(f32, f32, f32::NEG_INFINITY, f32::INFINITY, std::convert::identity, std::convert::identity);
lane!(i32, Wrapping<i32>, i32::MIN, i32::MAX, Wrapping, |w: Wrapping<i32>| w.0);
lane!(u32, Wrapping<u32>, u32::MIN, u32::MAX, Wrapping, |w: Wrapping<u32>| w.0);

// ---- Floats ----

impl Float for f32 {
    type Int = Wrapping<i32>;

    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        self.copysign(sign)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        soft::single::sqrt(self)
    }
    #[inline(always)]
    fn floor(self) -> Self {
        soft::single::floor(self)
    }
    #[inline(always)]
    fn ceil(self) -> Self {
        soft::single::ceil(self)
    }
    #[inline(always)]
    fn trunc(self) -> Self {
        soft::single::trunc(self)
    }
    #[inline(always)]
    fn round(self) -> Self {
        soft::single::round_ties_even(self)
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        self * b - c
    }
    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        c - self * b
    }
    #[inline(always)]
    fn mul_add_exact(self, b: Self, c: Self) -> Self {
        crate::backend::soft::mul_add(self, b, c)
    }
    #[inline(always)]
    fn to_int(self) -> Wrapping<i32> {
        Wrapping(self as i32)
    }
    #[inline(always)]
    fn to_uint(self) -> Wrapping<u32> {
        Wrapping(self as u32)
    }
    #[inline(always)]
    fn from_int(x: Wrapping<i32>) -> Self {
        x.0 as f32
    }
    #[inline(always)]
    fn from_uint(x: Wrapping<u32>) -> Self {
        x.0 as f32
    }
    #[inline(always)]
    fn to_bits(self) -> Wrapping<u32> {
        Wrapping(self.to_bits())
    }
    #[inline(always)]
    fn from_bits(x: Wrapping<u32>) -> Self {
        f32::from_bits(x.0)
    }
    #[inline(always)]
    fn reduce_add(self) -> f32 {
        self
    }
}

impl Double for f64 {
    #[inline(always)]
    fn abs(self) -> Self {
        self.abs()
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        self.copysign(sign)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        soft::double::sqrt(self)
    }
    #[inline(always)]
    fn floor(self) -> Self {
        soft::double::floor(self)
    }
    #[inline(always)]
    fn ceil(self) -> Self {
        soft::double::ceil(self)
    }
    #[inline(always)]
    fn trunc(self) -> Self {
        soft::double::trunc(self)
    }
    #[inline(always)]
    fn round(self) -> Self {
        soft::double::round_ties_even(self)
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        self * b - c
    }
    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        c - self * b
    }
    #[inline(always)]
    fn mul_add_exact(self, b: Self, c: Self) -> Self {
        soft::mul_add_double(self, b, c)
    }
    #[inline(always)]
    fn reduce_add(self) -> f64 {
        self
    }
    #[inline(always)]
    fn reduce_mul(self) -> f64 {
        self
    }
}

// ---- Integers ----

macro_rules! integer {
    ($($Lane:ty),*) => {$(
        impl Integer for Wrapping<$Lane> {
            #[inline(always)]
            fn shl_lanes(self, n: Wrapping<u32>) -> Self {
                Self(self.0.wrapping_shl(n.0))
            }
            #[inline(always)]
            fn shr_lanes(self, n: Wrapping<u32>) -> Self {
                Self(self.0.wrapping_shr(n.0))
            }
        }
    )*};
}
integer!(i32, u32);

impl Uint for Wrapping<u32> {
    #[inline(always)]
    fn mul_high(self, other: Self) -> Self {
        Self(((u64::from(self.0) * u64::from(other.0)) >> 32) as u32)
    }
    #[inline(always)]
    fn count_ones(self) -> Self {
        Self(self.0.count_ones())
    }
    #[inline(always)]
    fn leading_zeros(self) -> Self {
        Self(self.0.leading_zeros())
    }
    #[inline(always)]
    fn trailing_zeros(self) -> Self {
        Self(self.0.trailing_zeros())
    }
}

impl Int for Wrapping<i32> {
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.wrapping_abs())
    }
    #[inline(always)]
    fn to_uint(self) -> Wrapping<u32> {
        Wrapping(self.0 as u32)
    }
    #[inline(always)]
    fn from_uint(x: Wrapping<u32>) -> Self {
        Self(x.0 as i32)
    }
}
