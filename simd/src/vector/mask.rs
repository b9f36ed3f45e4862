//! Masks.

use super::sealed::{List, Sealed};
use std::fmt::Debug;
use std::ops::*;

/// One truth value per lane. All are false by default.
pub trait Mask:
    Sealed
    + List
    + Copy
    + Debug
    + Default
    + PartialEq
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
    /// The last true lane.
    #[inline(always)]
    fn last(self) -> Option<usize> {
        self.bitmask().checked_ilog2().map(|lane| lane as usize)
    }
    /// The true lanes, ascending.
    ///
    /// ```
    /// use simd::Mask;
    /// let lanes = simd::dispatch!(simd::Level::best(), |S| -> Vec<usize> {
    ///     S::Bool8::from_bitmask(0b1010_0001).set_lanes().collect()
    /// });
    /// assert_eq!(lanes, [0, 5, 7]);
    /// ```
    #[inline(always)]
    fn set_lanes(self) -> SetLanes {
        SetLanes(self.bitmask())
    }
}

/// The true lanes of a mask: [`Mask::set_lanes`].
#[derive(Debug, Clone)]
pub struct SetLanes(u32);

impl Iterator for SetLanes {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        let lane = (self.0 != 0).then(|| self.0.trailing_zeros() as usize);
        self.0 &= self.0.wrapping_sub(1);
        lane
    }
    #[inline(always)]
    fn size_hint(&self) -> (usize, Option<usize>) {
        let n = self.0.count_ones() as usize;
        (n, Some(n))
    }
}

impl ExactSizeIterator for SetLanes {}
