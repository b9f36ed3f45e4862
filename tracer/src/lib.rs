//! Ray queries and rendering on portable SIMD: the same hits, bit for bit, on every instruction set, at every width, by every
//! method and on any number of threads.
//!
//! ```
//! use simd::Level;
//! use tracer::bvh::{BuildConfig, Bvh};
//! use tracer::geometry::{HitBatch, Ray, RayBatch};
//! use tracer::method::{Context, Method, Packet, Width};
//! use tracer::progress::Silent;
//! use tracer::scene::Mesh;
//!
//! # fn main() -> Result<(), tracer::Error> {
//! let mesh = Mesh {
//!     positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
//!     triangles: vec![[0, 1, 2]],
//!     ..Mesh::default()
//! };
//! let bvh = Bvh::build(&mesh, &BuildConfig::default(), &Silent)?;
//! let method = Packet::new(&bvh, Level::best(), Width::Auto);
//!
//! let rays: RayBatch = (0..1000).map(|i| Ray::new([0.25, 0.001 * i as f32, 2.0], [0.0, 0.0, -1.0])).collect();
//! let mut hits = HitBatch::new();
//! method.closest(&rays, &mut hits, &mut Context::default())?;
//! assert_eq!((hits.get(0).t, hits.get(0).primitive), (2.0, 0));
//! assert!(hits.get(900).is_miss());
//! # Ok(())
//! # }
//! ```
//!
//! # Map
//!
//! What comes later knows what comes before it, never the other way round.
//!
//! - [`scene`]: meshes, materials, lights, cameras; OBJ and PLY files; procedural scenes.
//! - [`geometry`]: boxes, triangles, rays and hits, and how they meet.
//! - [`bvh`]: the tree and its builders.
//! - [`method`]: ways of finding hits, behind one interface.
//! - [`render`]: pictures, in three passes.
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
