//! 16- and 8-bit lanes, emulated: arrays.

use super::super::serial::Fence;
use super::super::{Isa, Mask, list_lanes, mask_basics};
use super::narrow_basics;
use crate::vector::sealed::{List, Sealed};
use crate::{Char, Lane, Narrow, Short, Simd, UChar, UShort, Vector};
use std::fmt;
use std::marker::PhantomData;
use std::num::Wrapping;
use std::ops::*;

/// Lanes of numbers or, as a mask, of truth values, worked on one after the other; at level serial each passes the fence.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct Lanes<T, const N: usize, S>([T; N], PhantomData<S>);

/// A lane, and its way through the fence.
pub trait Fenced: Copy + Default {
    /// Itself, hidden from the optimizer.
    fn fenced(self) -> Self;
}

impl Fenced for bool {
    #[inline(always)]
    fn fenced(self) -> Self {
        Wrapping(u32::from(self)).fence().0 & 1 != 0
    }
}

impl<T: Fenced, const N: usize, S: Simd> Lanes<T, N, S> {
    #[inline(always)]
    fn of(f: impl Fn(usize) -> T) -> Self {
        let mut lanes = [T::default(); N];
        for (i, lane) in lanes.iter_mut().enumerate() {
            let x = f(i);
            *lane = if const { matches!(S::LEVEL.isa(), Isa::Serial) } { x.fenced() } else { x };
        }
        Self(lanes, PhantomData)
    }
}

/// Operators lane by lane.
macro_rules! by_lane {
    (@ [$($generics:tt)*] $V:ty, $Op:ident $op:ident $OpAssign:ident $op_assign:ident $f:expr) => {
        impl<$($generics)*> $Op for $V {
            type Output = Self;
            #[inline(always)]
            fn $op(self, other: Self) -> Self {
                Self::of(|i| $f(self.0[i], other.0[i]))
            }
        }
        impl<$($generics)*> $OpAssign for $V {
            #[inline(always)]
            fn $op_assign(&mut self, other: Self) {
                *self = self.$op(other);
            }
        }
    };
    ($generics:tt $V:ty: $($Op:ident $op:ident $OpAssign:ident $op_assign:ident = $f:expr;)*) => {
        $(by_lane!(@ $generics $V, $Op $op $OpAssign $op_assign $f);)*
    };
}

mask_basics!([const N: usize, S: Simd] Lanes<bool, N, S>);
by_lane!([const N: usize, S: Simd] Lanes<bool, N, S>:
    BitAnd bitand BitAndAssign bitand_assign = BitAnd::bitand;
    BitOr bitor BitOrAssign bitor_assign = BitOr::bitor;
    BitXor bitxor BitXorAssign bitxor_assign = BitXor::bitxor;
);

impl<const N: usize, S: Simd> Not for Lanes<bool, N, S> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self::of(|i| !self.0[i])
    }
}

impl<const N: usize, S: Simd> Mask for Lanes<bool, N, S> {
    const LANES: usize = N;

    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self([value; N], PhantomData)
    }
    #[inline(always)]
    fn from_bitmask(bits: u32) -> Self {
        Self::of(|i| bits >> i & 1 != 0)
    }
    #[inline(always)]
    fn bitmask(self) -> u32 {
        let mut bits = 0;
        for (i, &lane) in self.0.iter().enumerate() {
            bits |= u32::from(lane) << i;
        }
        bits
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.bitmask() != 0
    }
    #[inline(always)]
    fn all(self) -> bool {
        !(!self).any()
    }
}

/// Vectors of one lane type.
macro_rules! lanes {
    ($($T:ident $N:literal: $Signed:ident $Unsigned:ident $Sum:ident, $W:ident $Wide:ty;)*) => {$(
        impl Sealed for $T {}
        impl Lane for $T {
            const LARGEST: Self = $T::MAX;
            const SMALLEST: Self = $T::MIN;
        }
        impl Fenced for $T {
            #[inline(always)]
            fn fenced(self) -> Self {
                Wrapping(self as u32).fence().0 as Self
            }
        }
        narrow_basics!([S: Simd] Lanes<$T, $N, S>);
        by_lane!([S: Simd] Lanes<$T, $N, S>:
            Add add AddAssign add_assign = $T::wrapping_add;
            Sub sub SubAssign sub_assign = $T::wrapping_sub;
            Mul mul MulAssign mul_assign = $T::wrapping_mul;
            BitAnd bitand BitAndAssign bitand_assign = BitAnd::bitand;
            BitOr bitor BitOrAssign bitor_assign = BitOr::bitor;
            BitXor bitxor BitXorAssign bitxor_assign = BitXor::bitxor;
        );
        impl<S: Simd> Not for Lanes<$T, $N, S> {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self::of(|i| !self.0[i])
            }
        }
        impl<S: Simd> Shl<usize> for Lanes<$T, $N, S> {
            type Output = Self;
            #[inline(always)]
            fn shl(self, n: usize) -> Self {
                Self::of(|i| self.0[i].wrapping_shl(n as u32))
            }
        }
        impl<S: Simd> Shr<usize> for Lanes<$T, $N, S> {
            type Output = Self;
            #[inline(always)]
            fn shr(self, n: usize) -> Self {
                Self::of(|i| self.0[i].wrapping_shr(n as u32))
            }
        }
        impl<S: Simd> Narrow for Lanes<$T, $N, S> {
            type Lane = $T;
            type Mask = Lanes<bool, $N, S>;
            type Signed = Lanes<$Signed, $N, S>;
            type Unsigned = Lanes<$Unsigned, $N, S>;
            type Wide = $Wide;
            type Sum = $Sum;
            const LANES: usize = $N;

            #[inline(always)]
            fn splat(x: $T) -> Self {
                Self([x; $N], PhantomData)
            }
            #[inline(always)]
            fn load(src: &[$T]) -> Self {
                let src = &src[..$N];
                Self::of(|i| src[i])
            }
            #[inline(always)]
            fn store(self, dst: &mut [$T]) {
                dst[..$N].copy_from_slice(&self.0);
            }
            #[inline(always)]
            fn select(mask: Self::Mask, on_true: Self, on_false: Self) -> Self {
                Self::of(|i| if mask.0[i] { on_true.0[i] } else { on_false.0[i] })
            }
            #[inline(always)]
            fn eq(self, other: Self) -> Self::Mask {
                Lanes::of(|i| self.0[i] == other.0[i])
            }
            #[inline(always)]
            fn lt(self, other: Self) -> Self::Mask {
                Lanes::of(|i| self.0[i] < other.0[i])
            }
            #[inline(always)]
            fn le(self, other: Self) -> Self::Mask {
                Lanes::of(|i| self.0[i] <= other.0[i])
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                Self::of(|i| self.0[i].min(other.0[i]))
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                Self::of(|i| self.0[i].max(other.0[i]))
            }
            #[inline(always)]
            fn saturating_add(self, other: Self) -> Self {
                Self::of(|i| self.0[i].saturating_add(other.0[i]))
            }
            #[inline(always)]
            fn saturating_sub(self, other: Self) -> Self {
                Self::of(|i| self.0[i].saturating_sub(other.0[i]))
            }
            #[inline(always)]
            fn mul_high(self, other: Self) -> Self {
                Self::of(|i| (($W::from(self.0[i]) * $W::from(other.0[i])) >> $T::BITS) as $T)
            }
            #[inline(always)]
            fn abs_diff(self, other: Self) -> Self::Unsigned {
                Lanes::of(|i| self.0[i].abs_diff(other.0[i]))
            }
            #[inline(always)]
            fn average(self, other: Self) -> Self {
                Self::of(|i| ((i32::from(self.0[i]) + i32::from(other.0[i]) + 1) >> 1) as $T)
            }
            #[inline(always)]
            fn to_signed(self) -> Self::Signed {
                Lanes::of(|i| self.0[i] as $Signed)
            }
            #[inline(always)]
            fn to_unsigned(self) -> Self::Unsigned {
                Lanes::of(|i| self.0[i] as $Unsigned)
            }
            #[inline(always)]
            fn widen(self) -> (Self::Wide, Self::Wide) {
                let mut wide = [0; $N];
                for (to, from) in wide.iter_mut().zip(self.0) {
                    *to = $W::from(from);
                }
                (<$Wide>::load(&wide), <$Wide>::load(&wide[$N / 2..]))
            }
            #[inline(always)]
            fn narrow(low: Self::Wide, high: Self::Wide) -> Self {
                let mut wide = [0; $N];
                low.store(&mut wide);
                high.store(&mut wide[$N / 2..]);
                Self::of(|i| wide[i].clamp($T::MIN.into(), $T::MAX.into()) as $T)
            }
            #[inline(always)]
            fn interleave(self, other: Self) -> (Self, Self) {
                let at = |i: usize| if i % 2 == 0 { self.0[i / 2] } else { other.0[i / 2] };
                (Self::of(at), Self::of(|i| at($N + i)))
            }
            #[inline(always)]
            fn reduce_add(self) -> $Sum {
                let mut sum = 0;
                for x in self.0 {
                    sum += $Sum::from(x);
                }
                sum
            }
        }
    )*};
}
lanes! {
    i16 8: i16 u16 i32, i32 S::Int4;
    u16 8: i16 u16 u32, u32 S::Uint4;
    i8 16: i8 u8 i32, i16 Lanes<i16, 8, S>;
    u8 16: i8 u8 u32, u16 Lanes<u16, 8, S>;
}

impl<S: Simd> Short for Lanes<i16, 8, S> {}
impl<S: Simd> UShort for Lanes<u16, 8, S> {}
impl<S: Simd> Char for Lanes<i8, 16, S> {}
impl<S: Simd> UChar for Lanes<u8, 16, S> {
    #[inline(always)]
    fn narrow_signed(low: Lanes<i16, 8, S>, high: Lanes<i16, 8, S>) -> Self {
        Self::of(|i| if i < 8 { low.0[i] } else { high.0[i - 8] }.clamp(0, 255) as u8)
    }
    #[inline(always)]
    fn sum_abs_diff(self, other: Self) -> u32 {
        self.abs_diff(other).reduce_add()
    }
    #[inline(always)]
    fn lookup(self, index: Self) -> Self {
        Self::of(|i| self.0[usize::from(index.0[i] % 16)])
    }
}
