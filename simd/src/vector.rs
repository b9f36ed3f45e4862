//! The operations: the traits [`Simd`], [`Vector`], [`Float`], [`Int`], [`Uint`] and [`Mask`].
//!
//! Every operation returns the same bits on every backend and at every width, with two exceptions that say so: the *relaxed*
//! `mul_add` family, which is fused where the hardware has it, and which of the many NaNs a NaN result is.
//! No backend flushes denormals to zero or fuses what is written apart: `a * b + c` rounds twice.
//!
//! Lane 0 is the first in memory. Integer arithmetic wraps.

use crate::{Block, Level};
use std::fmt::Debug;
use std::ops::*;

pub(crate) mod sealed {
    /// Keeps the traits of this crate implementable by its backends alone.
    pub trait Sealed {}
}
use sealed::Sealed;

/// An instruction set: its vector types. Reached through [`Kernel::run`](crate::Kernel::run) only.
///
/// The types carry the seed paper's names, float4, int4 and bool4, and their 8- and 16-wide kin. One mask per width serves
/// all lane types.
pub trait Simd: Sealed + Copy + Debug + Send + Sync + 'static {
    /// The level these types belong to.
    const LEVEL: Level;

    /// Four `f32`.
    #[doc(alias("float4", "f32x4", "vfloat4"))]
    type Float4: Float<Mask = Self::Bool4, Int = Self::Int4, Index = Self::Uint4>;
    /// Four `i32`.
    #[doc(alias("int4", "i32x4", "vint4"))]
    type Int4: Int<Mask = Self::Bool4, Index = Self::Uint4>;
    /// Four `u32`.
    #[doc(alias("uint4", "u32x4", "vuint4"))]
    type Uint4: Uint<Mask = Self::Bool4>;
    /// Mask of four lanes.
    #[doc(alias("bool4", "mask32x4", "vbool4"))]
    type Bool4: Mask;

    /// Eight `f32`.
    #[doc(alias("float8", "f32x8", "vfloat8"))]
    type Float8: Float<Mask = Self::Bool8, Int = Self::Int8, Index = Self::Uint8>;
    /// Eight `i32`.
    #[doc(alias("int8", "i32x8", "vint8"))]
    type Int8: Int<Mask = Self::Bool8, Index = Self::Uint8>;
    /// Eight `u32`.
    #[doc(alias("uint8", "u32x8", "vuint8"))]
    type Uint8: Uint<Mask = Self::Bool8>;
    /// Mask of eight lanes.
    #[doc(alias("bool8", "mask32x8", "vbool8"))]
    type Bool8: Mask;

    /// Sixteen `f32`.
    #[doc(alias("float16", "f32x16", "vfloat16"))]
    type Float16: Float<Mask = Self::Bool16, Int = Self::Int16, Index = Self::Uint16>;
    /// Sixteen `i32`.
    #[doc(alias("int16", "i32x16", "vint16"))]
    type Int16: Int<Mask = Self::Bool16, Index = Self::Uint16>;
    /// Sixteen `u32`.
    #[doc(alias("uint16", "u32x16", "vuint16"))]
    type Uint16: Uint<Mask = Self::Bool16>;
    /// Mask of sixteen lanes.
    #[doc(alias("bool16", "mask32x16", "vbool16"))]
    type Bool16: Mask;

    /// `f32` in the width of this level's registers.
    type Float: Float;
}

/// The type of one lane: `f32`, `i32` or `u32`.
pub trait Lane: Sealed + Copy + Debug + Default + PartialEq + PartialOrd + Send + Sync + 'static {
    /// Not smaller than any other value (infinity for `f32`).
    const LARGEST: Self;
}

/// One truth value per lane.
pub trait Mask:
    Sealed
    + Copy
    + Debug
    + Send
    + Sync
    + 'static
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
    + Not<Output = Self>
    + BitAndAssign
    + BitOrAssign
    + BitXorAssign
{
    /// Number of lanes.
    const LANES: usize;

    /// All lanes the same.
    fn splat(value: bool) -> Self;
    /// Lane `i` from bit `i`; higher bits are ignored.
    fn from_bitmask(bits: u32) -> Self;
    /// Lane `i` in bit `i`, the bits above [`Mask::LANES`] zero.
    fn bitmask(self) -> u32;
    /// True when at least one lane is true.
    fn any(self) -> bool;
    /// True when every lane is true.
    fn all(self) -> bool;

    /// True when no lane is true.
    #[inline(always)]
    fn none(self) -> bool {
        !self.any()
    }
    /// Number of true lanes.
    #[inline(always)]
    fn count(self) -> usize {
        self.bitmask().count_ones() as usize
    }
    /// The first true lane.
    #[inline(always)]
    fn first(self) -> Option<usize> {
        let bits = self.bitmask();
        (bits != 0).then(|| bits.trailing_zeros() as usize)
    }
    /// The first `n` lanes true, the others false; all true when `n >= LANES`.
    #[inline(always)]
    fn first_n(n: usize) -> Self {
        Self::from_bitmask(if n >= 32 { u32::MAX } else { (1 << n) - 1 })
    }
}

/// What vectors of every lane type can do.
pub trait Vector: Sealed + Copy + Debug + Send + Sync + 'static {
    /// Type of one lane.
    type Lane: Lane;
    /// The mask of this width.
    type Mask: Mask;
    /// The `u32` vector of this width: indices.
    type Index: Uint<Mask = Self::Mask>;
    /// Number of lanes.
    const LANES: usize;

    /// All lanes `x`.
    fn splat(x: Self::Lane) -> Self;

    /// The first [`Vector::LANES`] elements of `src`.
    ///
    /// # Panics
    /// If `src` is shorter.
    fn load(src: &[Self::Lane]) -> Self;

    /// Writes the first [`Vector::LANES`] elements of `dst`.
    ///
    /// # Panics
    /// If `dst` is shorter.
    fn store(self, dst: &mut [Self::Lane]);

    /// Aligned load of group `chunk` of the block: elements `chunk * LANES ..`.
    ///
    /// # Panics
    /// If `chunk >= 16 / LANES`.
    fn load_block(block: &Block<Self::Lane>, chunk: usize) -> Self;

    /// Aligned store of group `chunk` of the block: elements `chunk * LANES ..`.
    ///
    /// # Panics
    /// If `chunk >= 16 / LANES`.
    fn store_block(self, block: &mut Block<Self::Lane>, chunk: usize);

    /// `src[index[i]]` for each lane.
    ///
    /// # Panics
    /// If an index is out of bounds (one comparison for the whole vector).
    #[inline(always)]
    fn gather(src: &[Self::Lane], index: Self::Index) -> Self {
        Self::gather_masked(src, index, Self::Mask::splat(true), Self::splat(Self::Lane::default()))
    }

    /// `src[index[i]]` where the mask is true, `or` elsewhere; indices of lanes that are off are not looked at.
    ///
    /// # Panics
    /// If the index of a lane that is on is out of bounds (one comparison for the whole vector).
    fn gather_masked(src: &[Self::Lane], index: Self::Index, mask: Self::Mask, or: Self) -> Self;

    /// Array of structures to structure of arrays: field `k` of the first [`Vector::LANES`] rows in vector `k`.
    ///
    /// # Panics
    /// If there are fewer rows.
    fn load_rows4(rows: &[[Self::Lane; 4]]) -> [Self; 4];

    /// The inverse of [`Vector::load_rows4`].
    ///
    /// # Panics
    /// If there are fewer than [`Vector::LANES`] rows.
    fn store_rows4(columns: [Self; 4], rows: &mut [[Self::Lane; 4]]);

    /// `on_true` where the mask is true, else `on_false`.
    #[doc(alias("blend", "vec_select", "if_then_else"))]
    fn select(mask: Self::Mask, on_true: Self, on_false: Self) -> Self;

    /// `self == other`; false for NaN; 0 equals -0.
    #[doc(alias("simd_eq", "cmpeq"))]
    fn eq(self, other: Self) -> Self::Mask;
    /// `self < other`; false for NaN.
    #[doc(alias("simd_lt", "cmplt"))]
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`; false for NaN.
    #[doc(alias("simd_le", "cmple"))]
    fn le(self, other: Self) -> Self::Mask;
    /// `self != other`; true for NaN.
    #[inline(always)]
    fn ne(self, other: Self) -> Self::Mask {
        !self.eq(other)
    }
    /// `self > other`; false for NaN.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }
    /// `self >= other`; false for NaN.
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        other.le(self)
    }

    /// `if self < other { self } else { other }`: `other` when either is NaN or both are zeros.
    fn min(self, other: Self) -> Self;
    /// `if self > other { self } else { other }`: `other` when either is NaN or both are zeros.
    fn max(self, other: Self) -> Self;

    /// [`Vector::min`] over the lanes, as a tree: lane `i` with lane `i + LANES/2`, then the halves of that, down to one.
    fn reduce_min(self) -> Self::Lane;
    /// [`Vector::max`] over the lanes, in the order of [`Vector::reduce_min`].
    fn reduce_max(self) -> Self::Lane;

    /// The lane of the smallest value among those that are on, NaN left out; the lowest lane among equals.
    #[doc(alias("argmin", "select_min"))]
    #[inline(always)]
    fn min_index(self, mask: Self::Mask) -> Option<usize> {
        let mask = mask & self.eq(self);
        let rest = Self::select(mask, self, Self::splat(Self::Lane::LARGEST));
        (mask & rest.eq(Self::splat(rest.reduce_min()))).first()
    }

    /// From a function of the lane number.
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> Self::Lane) -> Self {
        let mut block = Block::default();
        for (i, x) in block.0[..Self::LANES].iter_mut().enumerate() {
            *x = f(i);
        }
        Self::load_block(&block, 0)
    }

    /// The lanes, in the first [`Vector::LANES`] elements of a block; the others are zero.
    #[inline(always)]
    fn to_block(self) -> Block<Self::Lane> {
        let mut block = Block::default();
        self.store_block(&mut block, 0);
        block
    }

    /// One lane.
    ///
    /// # Panics
    /// If `lane >= LANES`.
    #[inline(always)]
    fn lane(self, lane: usize) -> Self::Lane {
        self.to_block().0[..Self::LANES][lane]
    }
}

/// Vectors of `f32`. `f32` itself is one, of a single lane.
pub trait Float:
    Vector<Lane = f32>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
{
    /// The `i32` vector of this width.
    type Int: Int<Mask = Self::Mask, Index = Self::Index>;

    /// Clears the sign bit.
    fn abs(self) -> Self;
    /// Magnitude of `self`, sign bit of `sign`.
    fn copysign(self, sign: Self) -> Self;
    /// Square root, correctly rounded; NaN below zero, -0 of -0.
    fn sqrt(self) -> Self;
    /// Largest integer not above; keeps -0.
    fn floor(self) -> Self;
    /// Smallest integer not below; -0 above -1 and below 0.
    fn ceil(self) -> Self;
    /// Integer part; keeps the sign of zero.
    fn trunc(self) -> Self;
    /// Nearest integer, ties to even; keeps the sign of zero.
    #[doc(alias("round_ties_even", "nearbyint", "rint"))]
    fn round(self) -> Self;

    /// `self * b + c`, *relaxed*: fused (one rounding) where the level has it, else two roundings. Its bits differ between levels.
    #[doc(alias("fma", "madd", "vec_madd"))]
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// `self * b - c`, relaxed as [`Float::mul_add`].
    #[doc(alias("msub", "fmsub"))]
    fn mul_sub(self, b: Self, c: Self) -> Self;
    /// `c - self * b`, relaxed as [`Float::mul_add`]: AltiVec's `vec_nmsub`, the seed's `nmsub`.
    #[doc(alias("nmsub", "vec_nmsub", "fnmadd"))]
    fn neg_mul_add(self, b: Self, c: Self) -> Self;

    /// Towards zero, as `as i32` does: saturating, NaN becomes 0.
    fn to_int(self) -> Self::Int;
    /// Towards zero, as `as u32` does: saturating, NaN and negative numbers become 0.
    fn to_uint(self) -> Self::Index;
    /// Nearest `f32`, ties to even.
    fn from_int(x: Self::Int) -> Self;
    /// Nearest `f32`, ties to even.
    fn from_uint(x: Self::Index) -> Self;
    /// The bit pattern.
    fn to_bits(self) -> Self::Index;
    /// From a bit pattern.
    fn from_bits(x: Self::Index) -> Self;

    /// Sum of the lanes, added in the order of [`Vector::reduce_min`].
    fn reduce_add(self) -> f32;

    /// `self`, negated where `sign` has its sign bit set.
    #[inline(always)]
    fn mul_sign(self, sign: Self) -> Self {
        Self::from_bits(self.to_bits() ^ (sign.to_bits() & Self::Index::splat(1 << 31)))
    }
    /// The smaller; the other one when one is NaN.
    #[inline(always)]
    fn min_num(self, other: Self) -> Self {
        Self::select(other.eq(other), self.min(other), self)
    }
    /// The larger; the other one when one is NaN.
    #[inline(always)]
    fn max_num(self, other: Self) -> Self {
        Self::select(other.eq(other), self.max(other), self)
    }
    /// `self.max(lo).min(hi)`: `lo` for NaN.
    #[inline(always)]
    fn clamp(self, lo: Self, hi: Self) -> Self {
        self.max(lo).min(hi)
    }
}

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
}

/// Vectors of `i32`; `>>` keeps the sign.
pub trait Int: Integer + Vector<Lane = i32> + Neg<Output = Self> {
    /// Magnitude; `i32::MIN` stays.
    fn abs(self) -> Self;
    /// The same bits as `u32`.
    fn to_uint(self) -> Self::Index;
    /// The same bits as `i32`.
    fn from_uint(x: Self::Index) -> Self;
}

/// Vectors of `u32`; `>>` fills with zeros.
pub trait Uint: Integer + Vector<Lane = u32, Index = Self> {}
