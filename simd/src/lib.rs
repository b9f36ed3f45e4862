//! Portable SIMD: a kernel is written once, generic over one type parameter, and runs on scalar emulation, SSE2, SSE4.2,
//! AVX2, AVX-512 or NEON, four, eight or sixteen lanes wide, with the same bits on all of them. No `unsafe` in your code.
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
//! - [`Level`]: an instruction set that this CPU has. [`Level::best`], [`Level::from_env`] (`SIMD_LEVEL`), [`Level::available`].
//! - [`kernel!`], [`dispatch!`]: run code at a level; both are sugar for [`Kernel`] and [`Level::run`].
//! - [`Simd`]: the types of a level. [`Vector`], [`Float`], [`Int`], [`Uint`], [`Mask`]: what they can do;
//!   [`Narrow`]: what those of 16- and 8-bit lanes can; [`operations`]: all of it in one table.
//! - [`Block`]: aligned storage. [`math`]: functions computed from operations. [`prefetch`]: a hint.
//!
//! # Inlining
//!
//! Every generic function on the way from `kernel!` to the loop must be `#[inline(always)]`. What is not inlined is compiled
//! without the level's instructions: still correct, but each operation becomes a call through memory. Closures, `array::map` and
//! deep chains of iterators are not reliably inlined either: prefer plain loops over chunks and blocks.
//!
//! # The types cannot be named
//!
//! A type that can be named would be a licence to run its instructions anywhere, so the backends are out of reach:
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

mod backend;
mod block;
mod level;
pub mod math;
pub mod operations;
mod pair;
mod prefetch;
mod soft;
mod vector;

pub use block::Block;
pub use level::{Isa, Kernel, Level, LevelError};
pub use prefetch::prefetch;
pub use vector::{Char, Narrow, Short, UChar, UShort};
pub use vector::{Float, Halves, Int, Integer, Lane, Mask, SetLanes, Simd, Uint, Vector};
