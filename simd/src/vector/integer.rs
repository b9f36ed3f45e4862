//! Vectors of `i32` and `u32`.

use super::Vector;
use super::lanes::{reduce, scan, up_by_one};
use std::ops::*;

/// What `i32` and `u32` vectors share. Arithmetic wraps; shift counts are taken modulo 32.
pub trait Integer:
    Vector
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
    + Not<Output = Self>
    + Shl<usize, Output = Self>
    + Shr<usize, Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + BitAndAssign
    + BitOrAssign
    + BitXorAssign
{
    /// To the left, each lane by its own count modulo 32.
    #[doc(alias("sllv"))]
    #[inline(always)]
    fn shl_lanes(self, n: Self::Index) -> Self {
        shift_in_steps(self, n, |x, n| x << n)
    }
    /// To the right as `>>`, each lane by its own count modulo 32.
    #[doc(alias("srlv", "srav"))]
    #[inline(always)]
    fn shr_lanes(self, n: Self::Index) -> Self {
        shift_in_steps(self, n, |x, n| x >> n)
    }
    /// Sum of the lanes, wrapping.
    #[inline(always)]
    fn reduce_add(self) -> Self::Lane {
        reduce(self, |a, b| a + b)
    }
    /// Product of the lanes, wrapping.
    #[inline(always)]
    fn reduce_mul(self) -> Self::Lane {
        reduce(self, |a, b| a * b)
    }
    /// Lane `i` becomes the sum of lanes `0..=i`, wrapping.
    #[doc(alias("cumsum", "scan"))]
    #[inline(always)]
    fn prefix_sum(self) -> Self {
        scan(self, |a, b| a + b)
    }
    /// The sum of the lanes below, wrapping; 0 in the first.
    #[inline(always)]
    fn prefix_sum_exclusive(self) -> Self {
        up_by_one(self.prefix_sum())
    }
}

/// Vectors of `i32`; `>>` keeps the sign.
pub trait Int: Integer + Vector<Lane = i32> + Neg<Output = Self> {
    /// Magnitude; `i32::MIN` stays.
    fn abs(self) -> Self;
    /// The same bits as `u32`.
    fn to_uint(self) -> Self::Index;
    /// The same bits as `i32`.
    fn from_uint(x: Self::Index) -> Self;

    /// 0 for negative numbers.
    #[inline(always)]
    fn to_uint_saturating(self) -> Self::Index {
        self.max(Self::splat(0)).to_uint()
    }
    /// `i32::MAX` for what is larger.
    #[inline(always)]
    fn from_uint_saturating(x: Self::Index) -> Self {
        Self::from_uint(x.min(Self::Index::splat(i32::MAX as u32)))
    }
    /// Sum, at most `i32::MAX` and at least `i32::MIN`.
    #[doc(alias("adds"))]
    #[inline(always)]
    fn saturating_add(self, other: Self) -> Self {
        let sum = self + other;
        // Overflow: both operands have the sign that the sum has not.
        let limit = Self::from_uint(self.to_uint() >> 31) + Self::splat(i32::MAX);
        Self::select(((self ^ sum) & (other ^ sum)).lt(Self::splat(0)), limit, sum)
    }
    /// Difference, at most `i32::MAX` and at least `i32::MIN`.
    #[doc(alias("subs"))]
    #[inline(always)]
    fn saturating_sub(self, other: Self) -> Self {
        let difference = self - other;
        let limit = Self::from_uint(self.to_uint() >> 31) + Self::splat(i32::MAX);
        Self::select(((self ^ other) & (self ^ difference)).lt(Self::splat(0)), limit, difference)
    }
    /// The upper 32 bits of the 64-bit product.
    #[doc(alias("mulhi"))]
    #[inline(always)]
    fn mul_high(self, other: Self) -> Self {
        let unsigned = Self::from_uint(self.to_uint().mul_high(other.to_uint()));
        unsigned - (other & (self >> 31)) - (self & (other >> 31))
    }
    /// As [`Uint::rotate_left`].
    #[inline(always)]
    fn rotate_left(self, n: usize) -> Self {
        Self::from_uint(self.to_uint().rotate_left(n))
    }
    /// As [`Uint::rotate_right`].
    #[inline(always)]
    fn rotate_right(self, n: usize) -> Self {
        Self::from_uint(self.to_uint().rotate_right(n))
    }
    /// Number of ones among the bits.
    #[inline(always)]
    fn count_ones(self) -> Self::Index {
        self.to_uint().count_ones()
    }
    /// Number of zeros above the highest one; 32 of zero.
    #[inline(always)]
    fn leading_zeros(self) -> Self::Index {
        self.to_uint().leading_zeros()
    }
    /// Number of zeros below the lowest one; 32 of zero.
    #[inline(always)]
    fn trailing_zeros(self) -> Self::Index {
        self.to_uint().trailing_zeros()
    }
}

/// Vectors of `u32`; `>>` fills with zeros.
pub trait Uint: Integer + Vector<Lane = u32, Index = Self> {
    /// Sum, at most `u32::MAX`.
    #[doc(alias("adds"))]
    #[inline(always)]
    fn saturating_add(self, other: Self) -> Self {
        self + other.min(!self)
    }
    /// Difference, at least 0.
    #[doc(alias("subs"))]
    #[inline(always)]
    fn saturating_sub(self, other: Self) -> Self {
        self.max(other) - other
    }
    /// The upper 32 bits of the 64-bit product.
    #[doc(alias("mulhi"))]
    #[inline(always)]
    fn mul_high(self, other: Self) -> Self {
        // By halves of 16 bits.
        let low = Self::splat(0xffff);
        let (a, b, c, d) = (self >> 16, self & low, other >> 16, other & low);
        let middle = a * d + ((b * d) >> 16);
        let carry = b * c + (middle & low);
        a * c + (middle >> 16) + (carry >> 16)
    }
    /// The bits moved up by `n % 32` places, those pushed out at the top put in at the bottom.
    #[doc(alias("rotl"))]
    #[inline(always)]
    fn rotate_left(self, n: usize) -> Self {
        (self << n) | (self >> (32 - n % 32))
    }
    /// The bits moved down by `n % 32` places, those pushed out at the bottom put in at the top.
    #[doc(alias("rotr"))]
    #[inline(always)]
    fn rotate_right(self, n: usize) -> Self {
        (self >> n) | (self << (32 - n % 32))
    }
    /// Number of ones among the bits.
    #[doc(alias("popcnt"))]
    #[inline(always)]
    fn count_ones(self) -> Self {
        // In pairs of bits, in fours, in bytes; the product adds the bytes.
        let pairs = self - ((self >> 1) & Self::splat(0x5555_5555));
        let fours = (pairs & Self::splat(0x3333_3333)) + ((pairs >> 2) & Self::splat(0x3333_3333));
        let bytes = (fours + (fours >> 4)) & Self::splat(0x0f0f_0f0f);
        (bytes * Self::splat(0x0101_0101)) >> 24
    }
    /// Number of zeros above the highest one; 32 of zero.
    #[doc(alias("lzcnt", "clz"))]
    #[inline(always)]
    fn leading_zeros(self) -> Self {
        let mut x = self;
        let mut n = 1;
        while n < 32 {
            x |= x >> n;
            n *= 2;
        }
        (!x).count_ones()
    }
    /// Number of zeros below the lowest one; 32 of zero.
    #[doc(alias("tzcnt", "ctz"))]
    #[inline(always)]
    fn trailing_zeros(self) -> Self {
        (!self & (self - Self::splat(1))).count_ones()
    }
}

/// Shifts each lane by its own count, in a step for each bit of the count.
#[inline(always)]
pub(crate) fn shift_in_steps<V: Integer>(x: V, n: V::Index, shift: impl Fn(V, usize) -> V) -> V {
    let (mut x, mut step) = (x, 16);
    while step > 0 {
        let on = (n & V::Index::splat(step)).ne(V::Index::default());
        x = V::select(on, shift(x, step as usize), x);
        step /= 2;
    }
    x
}
