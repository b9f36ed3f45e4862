//! Ray queries and rendering on portable SIMD: the same hits, bit for bit, on every instruction set, at every width, by every
//! method and on any number of threads.
//!
//! ```
//! use tracer::geometry::{HitBatch, Ray, RayBatch};
//! use tracer::Scene;
//!
//! # fn main() -> Result<(), tracer::Error> {
//! let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
//! let scene = Scene::builder().triangles(corners, vec![[0, 1, 2]]).build()?;
//!
//! let hit = scene.closest(&Ray::new([0.25, 0.25, 2.0], [0.0, 0.0, -1.0]));
//! assert_eq!(hit.map(|hit| (hit.t, hit.primitive)), Some((2.0, 0)));
//!
//! // Many at once, in any order: faster by far, and on all threads.
//! let rays: RayBatch = (0..1000).map(|i| Ray::new([0.25, 0.001 * i as f32, 2.0], [0.0, 0.0, -1.0])).collect();
//! let mut hits = HitBatch::new();
//! scene.closest_batch(&rays, &mut hits);
//! assert!(hits.get(900).is_miss());
//! # Ok(())
//! # }
//! ```
//!
//! Trees and methods can be had one by one as well, to compare them:
//!
//! ```
//! use simd::Level;
//! use tracer::bvh::{BuildConfig, Bvh};
//! use tracer::geometry::{HitBatch, Ray, RayBatch};
//! use tracer::method::{Context, Method, Packet, Width};
//! use tracer::{model::Model, progress::Silent};
//!
//! # fn main() -> Result<(), tracer::Error> {
//! let (model, _warnings) = Model::open("balls:1", &Silent)?;
//! let bvh = Bvh::build(&model.mesh, &BuildConfig::default(), &Silent)?;
//! let rays: RayBatch = (0..100).map(|i| Ray::new([0.01 * i as f32, 0.0, 5.0], [0.0, 0.0, -1.0])).collect();
//! let mut hits = HitBatch::new();
//! Packet::new(&bvh, Level::best(), Width::Auto).closest(&rays, &mut hits, &mut Context::default())?;
//! # Ok(())
//! # }
//! ```
//!
//! # Map
//!
//! What comes later knows what comes before it, never the other way round.
//!
//! - [`model`]: meshes, materials, textures, lights, cameras; OBJ, PLY and glTF files; procedural scenes.
//! - [`geometry`]: boxes, triangles, rays and hits, and how they meet.
//! - [`bvh`]: the tree and its builders.
//! - [`method`]: ways of finding hits, behind one interface.
//! - [`sort`]: scans and sorting, by which methods put rays into order.
//! - [`Scene`]: a tree and a method, ready to be asked: all that most programs need.
//! - [`World`]: scenes at many places, and surfaces that are no triangles.
//! - [`render`]: pictures, in three passes; with secondary rays, [`render::integrator`].
//!
//! - [`progress`], [`stats`], [`output`], [`error`]: progress and an end to it, counters, files written whole or not at all, what can go wrong.
//!
//! # Features
//!
//! - `cli` (default): the command and what it needs; a library turns it off with `default-features = false`.
//! - `gltf` and `textures`: read such files; both are part of `cli`.
//! - `glam` and `mint`: conversions to and from the types of those crates: module `interop`.
#![forbid(unsafe_code)]

pub mod bvh;
mod clock;
pub mod error;
pub mod geometry;
mod hash;
#[cfg(any(feature = "glam", feature = "mint"))]
pub mod interop;
mod lanes;
pub mod method;
pub mod model;
pub mod output;
mod parallel;
pub mod progress;
pub mod render;
mod scene;
mod sealed;
pub mod sort;
pub mod stats;
mod world;

pub use error::Error;
pub use scene::{Scene, SceneBuilder};
pub use world::{Primitives, World, WorldBuilder, WorldHit};
