//! Emulation that stays serial: every lane passes an empty assembly statement, which LLVM cannot vectorize across.

use super::{list_lanes, scalar};
use crate::pair::Pair;
use crate::vector::sealed::{List, Sealed};
use crate::{Block, Double, Float, Int, Integer, Isa, Kernel, Level, Simd, Uint, Vector};
use std::fmt;
use std::num::Wrapping;
use std::ops::*;

// ---- The set ----

/// Emulation in scalar instructions.
#[derive(Debug, Clone, Copy)]
pub struct Serial;
scalar::emulation!(Serial, Fenced<f32>, Fenced<Wrapping<i32>>, Fenced<Wrapping<u32>>, Fenced<f64>);

/// Whether [`Fence::fence`] does anything on this architecture.
pub(crate) const FENCED: bool =
    cfg!(any(all(any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse2"), target_arch = "aarch64"));

/// A lane that can be hidden from the optimizer.
pub trait Fence: Vector<Mask = bool, Index = Wrapping<u32>> {
    /// Itself, by way of a register and an empty assembly statement: no instruction, and no vectorization across it.
    fn fence(self) -> Self;
}

macro_rules! fence {
    ($V:ty, $class:ident, $template:literal, $x:ident: $inner:expr) => {
        impl Fence for $V {
            #[inline(always)]
            #[allow(unused_mut, reason = "changed where there is a fence")]
            fn fence(self) -> Self {
                let mut $x = self;
                #[cfg(any(all(any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse2"), target_arch = "aarch64"))]
                // SAFETY: an assembly comment: no instruction at all.
                unsafe {
                    std::arch::asm!($template, inout($class) $inner, options(pure, nomem, nostack, preserves_flags));
                }
                $x
            }
        }
    };
}
#[cfg(target_arch = "aarch64")]
mod fences {
    use super::*;
    fence!(f32, vreg, "/* {0:s} */", x: x);
    fence!(f64, vreg, "/* {0:d} */", x: x);
    fence!(Wrapping<i32>, reg, "/* {0:w} */", x: x.0);
    fence!(Wrapping<u32>, reg, "/* {0:w} */", x: x.0);
}
#[cfg(not(target_arch = "aarch64"))]
mod fences {
    use super::*;
    fence!(f32, xmm_reg, "/* {0} */", x: x);
    fence!(f64, xmm_reg, "/* {0} */", x: x);
    fence!(Wrapping<i32>, reg, "/* {0:e} */", x: x.0);
    fence!(Wrapping<u32>, reg, "/* {0:e} */", x: x.0);
}

/// What a comparison found, fenced: its lane as `u32`.
#[inline(always)]
fn fenced(mask: bool) -> bool {
    Wrapping(u32::from(mask)).fence().0 & 1 != 0
}

/// A one-lane vector whose every result is fenced, and all that is loaded.
#[derive(Clone, Copy, Default)]
#[repr(transparent)]
pub struct Fenced<V>(V);
impl<V> Sealed for Fenced<V> {}
impl<V: List> List for Fenced<V> {
    fn list(&self, list: &mut fmt::DebugList<'_, '_>) {
        self.0.list(list);
    }
}
list_lanes!([V: List] Fenced<V>);

// ---- What all lanes share ----

macro_rules! operators {
    ($($Op:ident $op:ident $OpAssign:ident $op_assign:ident),*) => {$(
        impl<V: Fence + $Op<Output = V>> $Op for Fenced<V> {
            type Output = Self;
            #[inline(always)]
            fn $op(self, other: Self) -> Self {
                Self(self.0.$op(other.0).fence())
            }
        }
        impl<V: Fence + $Op<Output = V>> $OpAssign for Fenced<V> {
            #[inline(always)]
            fn $op_assign(&mut self, other: Self) {
                *self = self.$op(other);
            }
        }
    )*};
}
operators!(
    Add add AddAssign add_assign, Sub sub SubAssign sub_assign, Mul mul MulAssign mul_assign, Div div DivAssign div_assign,
    BitAnd bitand BitAndAssign bitand_assign, BitOr bitor BitOrAssign bitor_assign, BitXor bitxor BitXorAssign bitxor_assign
);

impl<V: Fence + Neg<Output = V>> Neg for Fenced<V> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self((-self.0).fence())
    }
}
impl<V: Fence + Not<Output = V>> Not for Fenced<V> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self((!self.0).fence())
    }
}
impl<V: Fence + Shl<usize, Output = V>> Shl<usize> for Fenced<V> {
    type Output = Self;
    #[inline(always)]
    fn shl(self, n: usize) -> Self {
        Self((self.0 << n).fence())
    }
}
impl<V: Fence + Shr<usize, Output = V>> Shr<usize> for Fenced<V> {
    type Output = Self;
    #[inline(always)]
    fn shr(self, n: usize) -> Self {
        Self((self.0 >> n).fence())
    }
}

impl<V: Fence> Vector for Fenced<V> {
    type Lane = V::Lane;
    type Mask = bool;
    type Index = Fenced<Wrapping<u32>>;
    const LANES: usize = 1;

    #[inline(always)]
    fn splat(x: V::Lane) -> Self {
        Self(V::splat(x))
    }
    #[inline(always)]
    fn load(src: &[V::Lane]) -> Self {
        Self(V::load(src).fence())
    }
    #[inline(always)]
    fn store(self, dst: &mut [V::Lane]) {
        self.0.store(dst);
    }
    #[inline(always)]
    fn load_block(block: &Block<V::Lane>, chunk: usize) -> Self {
        Self(V::load_block(block, chunk).fence())
    }
    #[inline(always)]
    fn store_block(self, block: &mut Block<V::Lane>, chunk: usize) {
        self.0.store_block(block, chunk);
    }
    #[inline(always)]
    fn gather_masked(src: &[V::Lane], index: Self::Index, mask: bool, or: Self) -> Self {
        Self(V::gather_masked(src, index.0, mask, or.0).fence())
    }
    #[inline(always)]
    fn load_rows4(rows: &[[V::Lane; 4]]) -> [Self; 4] {
        let [a, b, c, d] = V::load_rows4(rows);
        [Self(a.fence()), Self(b.fence()), Self(c.fence()), Self(d.fence())]
    }
    #[inline(always)]
    fn store_rows4([a, b, c, d]: [Self; 4], rows: &mut [[V::Lane; 4]]) {
        V::store_rows4([a.0, b.0, c.0, d.0], rows);
    }
    scalar::one_lane!();
    #[inline(always)]
    fn select(mask: bool, on_true: Self, on_false: Self) -> Self {
        Self(V::select(mask, on_true.0, on_false.0).fence())
    }
    #[inline(always)]
    fn eq(self, other: Self) -> bool {
        fenced(self.0.eq(other.0))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        fenced(self.0.lt(other.0))
    }
    #[inline(always)]
    fn le(self, other: Self) -> bool {
        fenced(self.0.le(other.0))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0).fence())
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0).fence())
    }
    #[inline(always)]
    fn reduce_min(self) -> V::Lane {
        self.0.reduce_min()
    }
    #[inline(always)]
    fn reduce_max(self) -> V::Lane {
        self.0.reduce_max()
    }
}

macro_rules! fenced {
    ($V:ty as $Trait:ident: $($name:ident($($arg:ident),*);)*) => {$(
        #[inline(always)]
        fn $name(self $(, $arg: Self)*) -> Self {
            Self(<$V as $Trait>::$name(self.0 $(, $arg.0)*).fence())
        }
    )*};
}

// ---- Floats ----

impl<V: Fence + Float<Int = Wrapping<i32>>> Float for Fenced<V> {
    type Int = Fenced<Wrapping<i32>>;

    fenced! { V as Float:
        abs(); copysign(sign); sqrt(); floor(); ceil(); trunc(); round();
        mul_add(b, c); mul_sub(b, c); neg_mul_add(b, c); mul_add_exact(b, c);
    }
    #[inline(always)]
    fn mul_sign(self, sign: Self) -> Self {
        Self(self.0.mul_sign(sign.0).fence())
    }
    #[inline(always)]
    fn to_int(self) -> Self::Int {
        Fenced(self.0.to_int().fence())
    }
    #[inline(always)]
    fn to_uint(self) -> Self::Index {
        Fenced(self.0.to_uint().fence())
    }
    #[inline(always)]
    fn from_int(x: Self::Int) -> Self {
        Self(V::from_int(x.0).fence())
    }
    #[inline(always)]
    fn from_uint(x: Self::Index) -> Self {
        Self(V::from_uint(x.0).fence())
    }
    #[inline(always)]
    fn to_bits(self) -> Self::Index {
        Fenced(self.0.to_bits().fence())
    }
    #[inline(always)]
    fn from_bits(x: Self::Index) -> Self {
        Self(V::from_bits(x.0).fence())
    }
    #[inline(always)]
    fn reduce_add(self) -> f32 {
        self.0.reduce_add()
    }
}

impl<V: Fence + Double> Double for Fenced<V> {
    fenced! { V as Double:
        abs(); copysign(sign); sqrt(); floor(); ceil(); trunc(); round(); mul_add_exact(b, c);
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
    fn reduce_add(self) -> f64 {
        self.0.reduce_add()
    }
    #[inline(always)]
    fn reduce_mul(self) -> f64 {
        self.0.reduce_mul()
    }
}

// ---- Integers ----

impl<V: Fence + Integer> Integer for Fenced<V> {
    #[inline(always)]
    fn shl_lanes(self, n: Self::Index) -> Self {
        Self(self.0.shl_lanes(n.0).fence())
    }
    #[inline(always)]
    fn shr_lanes(self, n: Self::Index) -> Self {
        Self(self.0.shr_lanes(n.0).fence())
    }
}
impl Uint for Fenced<Wrapping<u32>> {
    fenced! { Wrapping<u32> as Uint:
        mul_high(other); count_ones(); leading_zeros(); trailing_zeros();
    }
}
impl Int for Fenced<Wrapping<i32>> {
    #[inline(always)]
    fn abs(self) -> Self {
        Self(Int::abs(self.0).fence())
    }
    #[inline(always)]
    fn to_uint(self) -> Fenced<Wrapping<u32>> {
        Fenced(self.0.to_uint())
    }
    #[inline(always)]
    fn from_uint(x: Fenced<Wrapping<u32>>) -> Self {
        Self(Wrapping::<i32>::from_uint(x.0))
    }
}
