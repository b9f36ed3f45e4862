//! One folder per instruction set, the same files in each: `mod` (the set, its registers and masks), `lanes` (what vectors of all
//! lane types share), `float`, `integer`, `narrow` (16- and 8-bit lanes). Emulation is a file: [`scalar`], and [`serial`] made of it.
//!
//! # Why this is sound
//!
//! Operations need no token, so a type that can be named is a licence to run its instructions. The backends' types are in
//! private modules behind sealed traits, and the only door is [`run`], called by [`Level::run`](crate::Level::run): a
//! [`Level`](crate::Level) is proof that detection found the instruction set. Beside it, [`native`](crate::native) names the
//! types whose instructions the whole program is compiled for. So whatever runs in an operation of a backend
//! type runs on a CPU that has its instructions. That is the argument of [`intrinsics!`]; memory is touched only through
//! references whose length was checked on the line above.

#![cfg_attr(
    not(any(
        target_arch = "x86",
        target_arch = "x86_64",
        target_arch = "aarch64",
        all(target_arch = "wasm32", target_feature = "simd128"),
        all(target_arch = "powerpc64", feature = "vsx")
    )),
    allow(unused, reason = "what backends of registers share; there is only emulation here")
)]
#![cfg_attr(
    not(all(feature = "sse4_2", feature = "avx2", feature = "avx512")),
    allow(unused, reason = "the levels that are left out; others use parts of them")
)]

pub(crate) mod scalar;
pub(crate) mod serial;
pub(crate) mod soft;

#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
pub(crate) mod avx2;
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
pub(crate) mod avx512;
mod narrow;
#[cfg(target_arch = "aarch64")]
pub(crate) mod neon;
#[cfg(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64"))]
mod quad;
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
pub(crate) mod sse;
mod tables;
#[cfg(all(target_arch = "powerpc64", feature = "vsx"))]
pub(crate) mod vsx;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
pub(crate) mod wasm;

use crate::{Isa, Kernel, Mask, Vector};

/// Instructions on registers alone: the one place that calls them.
macro_rules! intrinsics {
    ($($body:tt)*) => {
        // SAFETY: a backend's types are reached only through `Level::run`, whose level detection has confirmed (module docs).
        unsafe { $($body)* }
    };
}
use intrinsics;
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
use narrow::mul_high_by_widening;
#[cfg(not(any(target_arch = "wasm32", target_arch = "powerpc64")))]
use narrow::narrow_basics;
use narrow::narrow_types;

/// Binary operators with their assigning forms, each one intrinsic on the inner registers; first the type's generics.
macro_rules! operators {
    (@ [$($generics:tt)*] $V:ty, $Op:ident $op:ident $OpAssign:ident $op_assign:ident $intrinsic:ident) => {
        impl<$($generics)*> $Op for $V {
            type Output = Self;
            #[inline(always)]
            fn $op(self, other: Self) -> Self {
                Self::new(intrinsics!($intrinsic(self.0, other.0)))
            }
        }
        impl<$($generics)*> $OpAssign for $V {
            #[inline(always)]
            fn $op_assign(&mut self, other: Self) {
                *self = self.$op(other);
            }
        }
    };
    ($generics:tt $V:ty: $($Op:ident $op:ident $OpAssign:ident $op_assign:ident = $intrinsic:ident;)*) => {
        $(operators!(@ $generics $V, $Op $op $OpAssign $op_assign $intrinsic);)*
    };
}
use operators;

/// What vectors have beside operations: zeros as the default, and `Debug` that lists the lanes.
macro_rules! vector_basics {
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
                list.entries(&self.to_block().0[..Self::LANES]);
            }
        }
        list_lanes!([$($generics)*] $V);
    )*};
}
use vector_basics;

/// What masks have beside operations: all false as the default, equality, and `Debug` that lists the lanes.
macro_rules! mask_basics {
    ([$($generics:tt)*] $M:ty) => {
        impl<$($generics)*> Sealed for $M {}
        impl<$($generics)*> Default for $M {
            #[inline(always)]
            fn default() -> Self {
                Self::splat(false)
            }
        }
        impl<$($generics)*> PartialEq for $M {
            #[inline(always)]
            fn eq(&self, other: &Self) -> bool {
                self.bitmask() == other.bitmask()
            }
        }
        impl<$($generics)*> List for $M {
            fn list(&self, list: &mut fmt::DebugList<'_, '_>) {
                list.entries((0..Self::LANES).map(|i| self.bitmask() >> i & 1 != 0));
            }
        }
        list_lanes!([$($generics)*] $M);
    };
}
use mask_basics;

/// `Debug` as a list of the lanes, the same at every level.
macro_rules! list_lanes {
    ([$($generics:tt)*] $V:ty) => {
        impl<$($generics)*> fmt::Debug for $V {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                let mut list = f.debug_list();
                self.list(&mut list);
                list.finish()
            }
        }
    };
}
pub(crate) use list_lanes;

/// The bounds check of gathers and scatters: panics if the index of a lane that is on is not below `len`.
#[inline(always)]
pub(crate) fn check_bounds<V: Vector>(len: usize, index: V::Index, mask: V::Mask) {
    // No index can be out of bounds of a longer slice.
    if let Ok(len) = u32::try_from(len)
        && (mask & V::Index::splat(len).le(index)).any()
    {
        out_of_bounds(len);
    }
}

#[cold]
#[inline(never)]
fn out_of_bounds(len: u32) -> ! {
    panic!("gather or scatter: an index is out of bounds of a slice of {len}");
}

/// Runs the kernel with the types of `isa`. The conditions are those of `Isa::compiled`.
///
/// `isa` comes out of a [`Level`](crate::Level): this CPU has it.
#[inline]
pub(crate) fn run<K: Kernel>(isa: Isa, kernel: K) -> K::Output {
    #[allow(unused_macros, reason = "there are architectures with nothing to detect")]
    macro_rules! with_features {
        ($features:literal, $S:ty) => {{
            #[target_feature(enable = $features)]
            fn run<K: Kernel>(kernel: K) -> K::Output {
                kernel.run::<$S>()
            }
            // SAFETY: `isa` comes out of a `Level`, which exists only where detection found these features.
            unsafe { run(kernel) }
        }};
    }
    match isa {
        Isa::Serial => serial::run(kernel),
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Isa::Sse2 => with_features!("sse,sse2", sse::Sse2),
        #[cfg(all(
            any(target_arch = "x86", target_arch = "x86_64"),
            any(feature = "sse4_2", target_feature = "sse4.2")
        ))]
        Isa::Sse42 => with_features!("sse3,ssse3,sse4.1,sse4.2,popcnt", sse::Sse42),
        #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), any(feature = "avx2", target_feature = "avx2")))]
        Isa::Avx2 => with_features!("avx2,fma,bmi1,bmi2,lzcnt,popcnt,f16c", avx2::Avx2),
        #[cfg(all(
            any(target_arch = "x86", target_arch = "x86_64"),
            any(feature = "avx512", target_feature = "avx512f")
        ))]
        Isa::Avx512 => with_features!(
            "avx512f,avx512bw,avx512cd,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt,f16c",
            avx512::Avx512
        ),
        #[cfg(target_arch = "aarch64")]
        Isa::Neon => with_features!("neon", neon::Neon),
        #[cfg(all(target_arch = "powerpc64", feature = "vsx"))]
        Isa::Vsx => with_features!("altivec,vsx,power8-altivec,power8-vector", vsx::Vsx),
        #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
        Isa::Wasm => wasm::run::<wasm::Wasm, K>(kernel),
        #[cfg(all(target_arch = "wasm32", target_feature = "relaxed-simd"))]
        Isa::WasmRelaxed => wasm::run::<wasm::WasmRelaxed, K>(kernel),
        _ => scalar::run(kernel),
    }
}
