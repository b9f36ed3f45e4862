//! Pairs of vectors of 16- and 8-bit integers.

use super::Pair;
use crate::{Char, Narrow, Short, UChar, UShort};

/// Methods that do the same to both halves.
macro_rules! lanewise {
    ($($name:ident($($arg:ident),*) -> $Out:ty;)*) => {$(
        #[inline(always)]
        fn $name(self $(, $arg: Self)*) -> $Out {
            Pair(self.0.$name($($arg.0),*), self.1.$name($($arg.1),*))
        }
    )*};
}

impl<V: Narrow> Narrow for Pair<V> {
    type Lane = V::Lane;
    type Mask = Pair<V::Mask>;
    type Signed = Pair<V::Signed>;
    type Unsigned = Pair<V::Unsigned>;
    type Wide = Pair<V::Wide>;
    type Sum = V::Sum;
    const LANES: usize = 2 * V::LANES;

    lanewise! {
        eq(other) -> Self::Mask; lt(other) -> Self::Mask; le(other) -> Self::Mask;
        min(other) -> Self; max(other) -> Self;
        saturating_add(other) -> Self; saturating_sub(other) -> Self; mul_high(other) -> Self; average(other) -> Self;
        abs_diff(other) -> Self::Unsigned; to_signed() -> Self::Signed; to_unsigned() -> Self::Unsigned;
    }
    #[inline(always)]
    fn splat(x: V::Lane) -> Self {
        Self(V::splat(x), V::splat(x))
    }
    #[inline(always)]
    fn load(src: &[V::Lane]) -> Self {
        let src = &src[..Self::LANES];
        Self(V::load(src), V::load(&src[V::LANES..]))
    }
    #[inline(always)]
    fn store(self, dst: &mut [V::Lane]) {
        let dst = &mut dst[..Self::LANES];
        self.0.store(dst);
        self.1.store(&mut dst[V::LANES..]);
    }
    #[inline(always)]
    fn select(mask: Self::Mask, on_true: Self, on_false: Self) -> Self {
        Self(V::select(mask.0, on_true.0, on_false.0), V::select(mask.1, on_true.1, on_false.1))
    }
    #[inline(always)]
    fn widen(self) -> (Self::Wide, Self::Wide) {
        let ((a, b), (c, d)) = (self.0.widen(), self.1.widen());
        (Pair(a, b), Pair(c, d))
    }
    #[inline(always)]
    fn narrow(low: Self::Wide, high: Self::Wide) -> Self {
        Self(V::narrow(low.0, low.1), V::narrow(high.0, high.1))
    }
    #[inline(always)]
    fn interleave(self, other: Self) -> (Self, Self) {
        let (a, b) = (self.0.interleave(other.0), self.1.interleave(other.1));
        (Self(a.0, a.1), Self(b.0, b.1))
    }
    #[inline(always)]
    fn reduce_add(self) -> V::Sum {
        self.0.reduce_add() + self.1.reduce_add()
    }
}

impl<V: Short> Short for Pair<V> {}
impl<V: UShort> UShort for Pair<V> {}
impl<V: Char> Char for Pair<V> {}
impl<V: UChar> UChar for Pair<V> {
    lanewise! { lookup(index) -> Self; }
    #[inline(always)]
    fn narrow_signed(low: <Self::Wide as Narrow>::Signed, high: <Self::Wide as Narrow>::Signed) -> Self {
        Self(V::narrow_signed(low.0, low.1), V::narrow_signed(high.0, high.1))
    }
    #[inline(always)]
    fn sum_abs_diff(self, other: Self) -> u32 {
        self.0.sum_abs_diff(other.0) + self.1.sum_abs_diff(other.1)
    }
}
