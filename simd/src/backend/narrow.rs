//! 16- and 8-bit lanes: what the backends share, and emulation.

mod emulation;

pub use emulation::Lanes;

/// The associated types of [`Simd`] for 16- and 8-bit lanes: those of 32 bytes given too, or made of two; or all emulated.
macro_rules! narrow_types {
    () => {
        $crate::backend::narrow_types!(
            $crate::backend::narrow::Lanes<i16, 8, Self>,
            $crate::backend::narrow::Lanes<u16, 8, Self>,
            $crate::backend::narrow::Lanes<i8, 16, Self>, $crate::backend::narrow::Lanes<u8, 16, Self>
        );
    };
    ($Short:ty, $UShort:ty, $Char:ty, $UChar:ty) => {
        $crate::backend::narrow_types!($Short, $UShort, $Char, $UChar;
            $crate::pair::Pair<$Short>, $crate::pair::Pair<$UShort>, $crate::pair::Pair<$Char>, $crate::pair::Pair<$UChar>);
    };
    ($Short:ty, $UShort:ty, $Char:ty, $UChar:ty; $Short2:ty, $UShort2:ty, $Char2:ty, $UChar2:ty) => {
        type Short8 = $Short;
        type UShort8 = $UShort;
        type Char16 = $Char;
        type UChar16 = $UChar;
        type Short16 = $Short2;
        type UShort16 = $UShort2;
        type Char32 = $Char2;
        type UChar32 = $UChar2;
    };
}
pub(super) use narrow_types;

/// What these vectors have beside operations: zeros as the default, and `Debug` that lists the lanes.
macro_rules! narrow_basics {
    ($([$($generics:tt)*] $V:ty),*) => {$(
        impl<$($generics)*> Sealed for $V {}
        impl<$($generics)*> Default for $V {
            #[inline(always)]
            fn default() -> Self {
                Self::splat(Default::default())
            }
        }
        impl<$($generics)*> List for $V {
            fn list(&self, list: &mut fmt::DebugList<'_, '_>) {
                list.entries((0..Self::LANES).map(|i| self.lane(i)));
            }
        }
        list_lanes!([$($generics)*] $V);
    )*};
}
pub(super) use narrow_basics;

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
/// [`Narrow::mul_high`](crate::Narrow::mul_high) of bytes: products of twice the bits, and the upper halves of those.
#[inline(always)]
pub(super) fn mul_high_by_widening<V: crate::Narrow<Wide: crate::Narrow>>(a: V, b: V) -> V {
    let ((a0, a1), (b0, b1)) = (a.widen(), b.widen());
    V::narrow((a0 * b0) >> 8, (a1 * b1) >> 8)
}
