//! Ray queries and rendering on portable SIMD.
#![forbid(unsafe_code)]

pub mod bvh;
pub mod error;
pub mod geometry;
mod hash;
mod lanes;
pub mod method;
pub mod output;
mod parallel;
pub mod progress;
pub mod render;
pub mod scene;
pub mod stats;

pub use error::Error;
