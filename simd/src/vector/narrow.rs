//! Vectors of `i16`, `u16`, `i8` and `u8`.

use super::sealed::{List, Sealed};
use super::{Int, Lane, Mask, Uint};
use std::fmt::Debug;
use std::ops::*;

/// What vectors of 16- and 8-bit integers share, 16 or 32 bytes of them. All lanes are zero by default; arithmetic wraps;
/// shift counts are taken modulo the bits of a lane, and `>>` keeps the sign of signed lanes.
///
/// ```
/// use simd::{Level, Narrow, UChar};
///
/// /// Every byte brighter, white at most.
/// #[inline(always)]
/// fn brighten_by<V: UChar>(bytes: &mut [u8], by: u8) {
///     for chunk in bytes.chunks_mut(V::LANES) {
///         V::load_partial(chunk).saturating_add(V::splat(by)).store_partial(chunk);
///     }
/// }
///
/// simd::kernel! {
///     fn brighten<S>(bytes: &mut [u8], by: u8) {
///         brighten_by::<S::UChar32>(bytes, by);
///     }
/// }
///
/// let mut bytes: Vec<u8> = (0..=255).collect();
/// brighten(Level::best(), &mut bytes, 10);
/// assert_eq!((bytes[7], bytes[250]), (17, 255));
/// ```
pub trait Narrow:
    Sealed
    + List
    + Copy
    + Debug
    + Default
    + Send
    + Sync
    + 'static
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
    /// Type of one lane.
    type Lane: Lane;
    /// The mask of these lanes.
    type Mask: Mask;
    /// The vector of as many signed lanes: this one, if they are.
    type Signed: Narrow<Mask = Self::Mask, Signed = Self::Signed, Unsigned = Self::Unsigned>;
    /// The vector of as many unsigned lanes: this one, if they are.
    type Unsigned: Narrow<Mask = Self::Mask, Signed = Self::Signed, Unsigned = Self::Unsigned>;
    /// The vector of half as many lanes, twice as wide and signed as these.
    type Wide;
    /// The type of sums: `i32` or `u32`.
    type Sum: Add<Output = Self::Sum>;
    /// Number of lanes.
    const LANES: usize;

    /// All lanes `x`.
    fn splat(x: Self::Lane) -> Self;

    /// The first [`Narrow::LANES`] elements of `src`.
    ///
    /// # Panics
    /// If `src` is shorter.
    fn load(src: &[Self::Lane]) -> Self;

    /// Writes the first [`Narrow::LANES`] elements of `dst`.
    ///
    /// # Panics
    /// If `dst` is shorter.
    fn store(self, dst: &mut [Self::Lane]);

    /// All of `src`, zeros in the lanes past its end; nothing past its end is read. Elements past [`Narrow::LANES`] are left out.
    #[inline(always)]
    fn load_partial(src: &[Self::Lane]) -> Self {
        if src.len() >= Self::LANES {
            return Self::load(src);
        }
        let mut lanes = [Self::Lane::default(); 32];
        lanes[..src.len()].copy_from_slice(src);
        Self::load(&lanes)
    }

    /// Writes as many lanes as `dst` has room for.
    #[inline(always)]
    fn store_partial(self, dst: &mut [Self::Lane]) {
        if dst.len() >= Self::LANES {
            return self.store(dst);
        }
        let n = dst.len();
        dst.copy_from_slice(&lanes(self)[..n]);
    }

    /// From a function of the lane number.
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> Self::Lane) -> Self {
        let mut lanes = [Self::Lane::default(); 32];
        for (i, lane) in lanes[..Self::LANES].iter_mut().enumerate() {
            *lane = f(i);
        }
        Self::load(&lanes)
    }

    /// One lane.
    ///
    /// # Panics
    /// If `lane >= LANES`.
    #[inline(always)]
    fn lane(self, lane: usize) -> Self::Lane {
        lanes(self)[..Self::LANES][lane]
    }

    /// Lanes of `on_true` where the mask is true, of `on_false` elsewhere.
    fn select(mask: Self::Mask, on_true: Self, on_false: Self) -> Self;
    /// `==` for each lane.
    fn eq(self, other: Self) -> Self::Mask;
    /// `!=` for each lane.
    #[inline(always)]
    fn ne(self, other: Self) -> Self::Mask {
        !self.eq(other)
    }
    /// `<` for each lane.
    fn lt(self, other: Self) -> Self::Mask;
    /// `<=` for each lane.
    fn le(self, other: Self) -> Self::Mask;
    /// `>` for each lane.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }
    /// `>=` for each lane.
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        other.le(self)
    }
    /// The smaller of two lanes.
    fn min(self, other: Self) -> Self;
    /// The larger of two lanes.
    fn max(self, other: Self) -> Self;

    /// Sum; at the ends of the lane type's range where it would leave that.
    #[doc(alias("adds"))]
    fn saturating_add(self, other: Self) -> Self;
    /// Difference; at the ends of the lane type's range where it would leave that.
    #[doc(alias("subs"))]
    fn saturating_sub(self, other: Self) -> Self;
    /// The upper half of the product's bits.
    #[doc(alias("mulhi"))]
    fn mul_high(self, other: Self) -> Self;
    /// Magnitude of the difference, which always fits without a sign.
    #[doc(alias("abd"))]
    #[inline(always)]
    fn abs_diff(self, other: Self) -> Self::Unsigned {
        (self.max(other) - self.min(other)).to_unsigned()
    }
    /// Half the sum, rounded up, without overflow: `(a + b + 1) >> 1`.
    #[doc(alias("avg"))]
    #[inline(always)]
    fn average(self, other: Self) -> Self {
        (self | other) - ((self ^ other) >> 1)
    }

    /// The same bits as signed lanes.
    fn to_signed(self) -> Self::Signed;
    /// The same bits as unsigned lanes.
    fn to_unsigned(self) -> Self::Unsigned;
    /// The same numbers in lanes of twice the bits: the lower lanes, the upper lanes.
    #[doc(alias("unpack", "cvt"))]
    fn widen(self) -> (Self::Wide, Self::Wide);
    /// The inverse of [`Narrow::widen`]: the numbers of two vectors, `low` in the lower lanes; the nearest that fits a lane.
    #[doc(alias("pack", "packs"))]
    fn narrow(low: Self::Wide, high: Self::Wide) -> Self;
    /// `a0 b0 a1 b1 ...`: the lower half of that, the upper half.
    #[doc(alias("zip", "unpack"))]
    fn interleave(self, other: Self) -> (Self, Self);
    /// Sum of the lanes, which does not overflow.
    fn reduce_add(self) -> Self::Sum;
}

/// Vectors of `i16`.
pub trait Short: Narrow<Lane = i16, Signed = Self, Wide: Int, Sum = i32> {
    /// Magnitude; `i16::MIN` stays.
    #[inline(always)]
    fn abs(self) -> Self {
        self.max(Self::default() - self)
    }
}

/// Vectors of `u16`.
pub trait UShort: Narrow<Lane = u16, Signed: Short, Unsigned = Self, Wide: Uint, Sum = u32> {}

/// Vectors of `i8`.
pub trait Char: Narrow<Lane = i8, Signed = Self, Wide: Short, Sum = i32> {
    /// Magnitude; `i8::MIN` stays.
    #[inline(always)]
    fn abs(self) -> Self {
        self.max(Self::default() - self)
    }
}

/// Vectors of `u8`.
pub trait UChar: Narrow<Lane = u8, Signed: Char, Unsigned = Self, Wide: UShort, Sum = u32> {
    /// As [`Narrow::narrow`], of signed numbers: 0 for negative ones, 255 for those above.
    #[doc(alias("packus"))]
    fn narrow_signed(low: <Self::Wide as Narrow>::Signed, high: <Self::Wide as Narrow>::Signed) -> Self;
    /// Sum of the magnitudes of the differences.
    #[doc(alias("sad"))]
    fn sum_abs_diff(self, other: Self) -> u32;
    /// A table of sixteen bytes for each sixteen lanes: lane `i` becomes lane `index[i] % 16` of those sixteen that `i` belongs to.
    ///
    /// ```
    /// use simd::{Narrow, UChar};
    /// let digits = simd::dispatch!(simd::Level::best(), |S| -> [u8; 16] {
    ///     let mut digits = [0; 16];
    ///     S::UChar16::load(b"0123456789abcdef").lookup(S::UChar16::from_fn(|i| (3 * i) as u8)).store(&mut digits);
    ///     digits
    /// });
    /// assert_eq!(&digits, b"0369cf258be147ad");
    /// ```
    #[doc(alias("pshufb", "shuffle", "swizzle"))]
    fn lookup(self, index: Self) -> Self;
}

/// The lanes, and zeros behind them.
#[inline(always)]
pub(crate) fn lanes<V: Narrow>(x: V) -> [V::Lane; 32] {
    let mut lanes = [V::Lane::default(); 32];
    x.store(&mut lanes);
    lanes
}
