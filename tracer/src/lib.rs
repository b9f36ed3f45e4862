//! Ray queries and rendering on portable SIMD.
#![forbid(unsafe_code)]

pub mod bvh;
pub mod error;
pub mod geometry;
pub mod output;
pub mod progress;
pub mod scene;

pub use error::Error;
