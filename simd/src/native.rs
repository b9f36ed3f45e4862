//! The best types of the compilation target, by name and without dispatch.
//!
//! What the whole program is compiled for needs no detection, so these types can be used anywhere: in structs, in any function,
//! in constants of a library that is built for one machine. Results have the same bits as at any [`Level`].
//!
//! ```
//! use simd::native::{Float, LEVEL};
//! use simd::{Float as _, Vector};
//!
//! /// No kernel, no level: a plain function.
//! fn sum_of_squares(numbers: &[f32]) -> f32 {
//!     let mut sum = Float::splat(0.0);
//!     for chunk in numbers.chunks_exact(Float::LANES) {
//!         let x = Float::load(chunk);
//!         sum += x * x;
//!     }
//!     sum.reduce_add()
//! }
//!
//! assert_eq!(sum_of_squares(&[2.0; 64]), 256.0);
//! println!("compiled for {LEVEL}");
//! ```
//!
//! # Which level that is
//!
//! | compiled for | level |
//! |---|---|
//! | x86-64, as it comes | SSE2 |
//! | `-C target-cpu=x86-64-v2` | SSE4.2 |
//! | `-C target-cpu=x86-64-v3`, or `native` on most machines | AVX2 |
//! | `-C target-cpu=x86-64-v4`, or `native` on a machine that has it | AVX-512 |
//! | aarch64 | NEON |
//! | powerpc64le with the cargo feature `vsx` | VSX |
//! | wasm32 with `+simd128`, with `+relaxed-simd` | wasm, wasm-relaxed |
//! | anything else | scalar |
//!
//! Set it for all crates at once, with `RUSTFLAGS` or `build.rustflags` in cargo's configuration.
//!
//! # When it is right
//!
//! When the program runs where it is built, or on machines that are known. It is the smallest (one copy of the code), and calls
//! can be inlined anywhere. Without such flags it means SSE2 on x86-64: a program for everybody's machines is faster by
//! [`kernel!`](crate::kernel), which uses what each has. The cargo features of the x86 levels change nothing here.

#![allow(unused_imports, reason = "what is hidden by something better")]

use crate::{Level, Simd};

// Each module takes what the one before it has, unless there is something better: a name hides what comes by `*`. The conditions
// are the features that `backend::run` enables.

mod baseline {
    #[cfg(all(target_arch = "aarch64", target_feature = "neon"))]
    pub use crate::backend::neon::Neon as Native;
    #[cfg(not(any(
        all(any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse", target_feature = "sse2"),
        all(target_arch = "aarch64", target_feature = "neon"),
        all(target_arch = "wasm32", target_feature = "simd128"),
        all(target_arch = "powerpc64", target_endian = "little", feature = "vsx", target_feature = "power8-vector")
    )))]
    pub use crate::backend::scalar::Scalar as Native;
    #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse", target_feature = "sse2"))]
    pub use crate::backend::sse::Sse2 as Native;
    #[cfg(all(
        target_arch = "powerpc64",
        target_endian = "little",
        feature = "vsx",
        target_feature = "power8-vector"
    ))]
    pub use crate::backend::vsx::Vsx as Native;
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128", not(target_feature = "relaxed-simd")))]
    pub use crate::backend::wasm::Wasm as Native;
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128", target_feature = "relaxed-simd"))]
    pub use crate::backend::wasm::WasmRelaxed as Native;
}

mod v2 {
    pub use super::baseline::*;
    #[cfg(all(
        any(target_arch = "x86", target_arch = "x86_64"),
        target_feature = "sse3",
        target_feature = "ssse3",
        target_feature = "sse4.1",
        target_feature = "sse4.2",
        target_feature = "popcnt"
    ))]
    pub use crate::backend::sse::Sse42 as Native;
}

mod v3 {
    pub use super::v2::*;
    #[cfg(all(
        any(target_arch = "x86", target_arch = "x86_64"),
        target_feature = "avx2",
        target_feature = "fma",
        target_feature = "bmi1",
        target_feature = "bmi2",
        target_feature = "lzcnt",
        target_feature = "popcnt",
        target_feature = "f16c"
    ))]
    pub use crate::backend::avx2::Avx2 as Native;
}

mod v4 {
    pub use super::v3::*;
    #[cfg(all(
        any(target_arch = "x86", target_arch = "x86_64"),
        target_feature = "avx512f",
        target_feature = "avx512bw",
        target_feature = "avx512cd",
        target_feature = "avx512dq",
        target_feature = "avx512vl",
        target_feature = "avx2",
        target_feature = "fma",
        target_feature = "bmi1",
        target_feature = "bmi2",
        target_feature = "lzcnt",
        target_feature = "popcnt",
        target_feature = "f16c"
    ))]
    pub use crate::backend::avx512::Avx512 as Native;
}

/// The best instruction set that all processors have which this program is compiled for.
pub type Native = v4::Native;

/// The level of [`Native`].
pub const LEVEL: Level = <Native as Simd>::LEVEL;

macro_rules! types {
    ($($(#[$doc:meta])* $name:ident)*) => {$(
        $(#[$doc])*
        pub type $name = <Native as Simd>::$name;
    )*};
}
types! {
    /// Four `f32`.
    Float4
    /// Four `i32`.
    Int4
    /// Four `u32`.
    Uint4
    /// Mask of four lanes.
    Bool4
    /// Eight `f32`.
    Float8
    /// Eight `i32`.
    Int8
    /// Eight `u32`.
    Uint8
    /// Mask of eight lanes.
    Bool8
    /// Sixteen `f32`.
    Float16
    /// Sixteen `i32`.
    Int16
    /// Sixteen `u32`.
    Uint16
    /// Mask of sixteen lanes.
    Bool16
    /// Two `f64`.
    Double2
    /// Four `f64`.
    Double4
    /// Eight `f64`.
    Double8
    /// `f32` in the width of the registers.
    Float
    /// Eight `i16`.
    Short8
    /// Eight `u16`.
    UShort8
    /// Sixteen `i16`.
    Short16
    /// Sixteen `u16`.
    UShort16
    /// Sixteen `i8`.
    Char16
    /// Sixteen `u8`.
    UChar16
    /// Thirty-two `i8`.
    Char32
    /// Thirty-two `u8`.
    UChar32
}
