//! Portable SIMD: a kernel is written once, generic over one type parameter, and runs on scalar emulation, SSE2, SSE4.2,
//! AVX2, AVX-512, NEON or WebAssembly, four, eight or sixteen lanes wide, with the same bits on all of them. No `unsafe` in your
//! code.
//!
//! ```
//! use simd::{Float, Level, Mask, Simd, Vector};
//!
//! /// How many of the numbers lie between `lo` and `hi`: any vector type, `f32` itself among them.
//! #[inline(always)]
//! fn count_between<F: Float>(numbers: &[f32], lo: f32, hi: f32) -> usize {
//!     let (lo, hi) = (F::splat(lo), F::splat(hi));
//!     let mut count = 0;
//!     for chunk in numbers.chunks_exact(F::LANES) {
//!         let x = F::load(chunk);
//!         count += (lo.le(x) & x.le(hi)).count();
//!     }
//!     count
//! }
//!
//! simd::kernel! {
//!     /// The same on the registers of a level.
//!     fn count<S>(numbers: &[f32]) -> usize {
//!         count_between::<S::Float>(numbers, 0.0, 1.0)
//!     }
//! }
//!
//! let numbers: Vec<f32> = (0..64).map(|i| i as f32 / 16.0).collect();
//! for level in Level::available() {
//!     assert_eq!(count(level, &numbers), 17, "{level}");
//! }
//! assert_eq!(count_between::<f32>(&numbers, 0.0, 1.0), 17);
//! ```
//!
//! # Map
//!
//! - [`Level`]: an instruction set that this CPU has. [`Level::best`], [`Level::from_env`] (`SIMD_LEVEL`), [`Level::cached`],
//!   [`Level::available`].
//! - [`kernel!`], [`dispatch!`]: run code at a level; both are sugar for [`Kernel`] and [`Level::run`].
//! - [`native`]: the types of the compilation target, without dispatch.
//! - [`Simd`]: the types of a level. [`Vector`], [`Float`], [`Int`], [`Uint`], [`Double`], [`Mask`]: what they can do;
//!   [`Narrow`]: what those of 16- and 8-bit lanes can; [`operations`]: all of it in one table.
//! - [`Block`], [`AlignedVec`]: aligned storage. [`math`]: functions computed from operations. [`prefetch`] and
//!   [`vec_in_huge_pages`]: hints.
//! - [`coming_from`]: the idioms of other libraries.
//! - [`interop`]: conversions for bytemuck, glam, wide and pulp, each a feature.
//!
//! # Features
//!
//! - `std` (default): detection of the CPU's levels, and [`Level::from_env`]. Without it the crate is `no_std`, and the levels are
//!   those that the whole program is compiled for, as with `-C target-feature=+avx2`: `core` cannot detect.
//! - `alloc` (part of `std`): [`AlignedVec`], levels by name, [`LevelError`].
//! - `sse4_2`, `avx2`, `avx512` (default): the x86 levels above the baseline. A level that is left out is unavailable, unless the
//!   whole program is compiled for it.
//! - `vsx`: the level of powerpc64le, whose instructions nightly Rust alone knows; nothing on other architectures.
//! - `bytemuck`, `glam`, `wide`, `pulp`: conversions, see [`interop`].
//!
//! # Which way, and what it costs
//!
//! | | when it is right | cost |
//! |---|---|---|
//! | all levels, [`kernel!`] | one binary for all machines | a copy of every kernel for each level |
//! | fewer levels, as `default-features = false, features = ["std", "avx2"]` | size counts: nearly all x86 machines have AVX2, the others take SSE2 | fewer copies |
//! | [`native`], `-C target-cpu=...` | it runs where it is built, or on known machines | one copy, no dispatch; crashes on older machines |
//!
//! A level adds the size of the kernels' machine code. Text of the stripped examples of this crate, about 370 kB each and nearly
//! all of it the standard library, above what they have with `std` alone (emulation and SSE2):
//!
//! | example | + `sse4_2` | + `avx2` | + `avx512` | + all three |
//! |---|---|---|---|---|
//! | `saxpy` | 0.2 kB | 0.2 kB | 0.2 kB | 1.7 kB |
//! | `slab` | 1.6 kB | 2.1 kB | 1.8 kB | 4.0 kB |
//! | `blur` | 2.0 kB | 2.1 kB | 2.1 kB | 3.6 kB |
//! | `mandelbrot` | 0.0 kB | 0.2 kB | 0.1 kB | 1.7 kB |
//!
//! # Inlining
//!
//! Every generic function on the way from `kernel!` to the loop must be `#[inline(always)]`. What is not inlined is compiled
//! without the level's instructions: still correct, but each operation becomes a call through memory. Closures, `array::map` and
//! deep chains of iterators are not reliably inlined either: prefer plain loops over chunks and blocks.
//!
//! # The types cannot be named
//!
//! A type that can be named would be a licence to run its instructions anywhere, so the backends are out of reach (only what the
//! whole program is compiled for anyway has names, in [`native`]):
//!
//! ```compile_fail
//! let x = simd::backend::avx512::Float16::splat(1.0); // private module
//! ```
//!
//! and so are levels that detection has not confirmed:
//!
//! ```compile_fail
//! let level = simd::Level(simd::Isa::Avx512); // private field
//! ```

#![cfg_attr(not(any(feature = "std", test)), no_std)]
#![cfg_attr(
    all(target_arch = "powerpc64", feature = "vsx"),
    feature(portable_simd, powerpc_target_feature, stdarch_powerpc)
)]
#![cfg_attr(
    all(target_arch = "powerpc64", feature = "vsx", feature = "std"),
    feature(stdarch_powerpc_feature_detection)
)]

#[cfg(feature = "alloc")]
extern crate alloc;
// What the modules take from `std` is in `core` too, except where they ask for the feature.
#[cfg(not(feature = "std"))]
extern crate core as std;

#[cfg(feature = "alloc")]
mod aligned;
mod backend;
mod block;
pub mod coming_from;
#[cfg(feature = "alloc")]
mod huge_pages;
pub mod interop;
mod level;
pub mod math;
pub mod native;
pub mod operations;
mod pair;
mod prefetch;
mod vector;

#[cfg(feature = "alloc")]
pub use aligned::AlignedVec;
pub use block::Block;
#[cfg(feature = "alloc")]
pub use huge_pages::vec_in_huge_pages;
#[cfg(feature = "alloc")]
pub use level::LevelError;
pub use level::{Isa, Kernel, Level};
pub use prefetch::prefetch;
pub use vector::{Char, Narrow, Short, UChar, UShort};
pub use vector::{Double, Float, Halves, Int, Integer, Lane, Mask, SetLanes, Simd, Uint, Vector};
