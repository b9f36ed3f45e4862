//! Boxes, triangles and rays, and how they meet.

pub(crate) mod aabb;
pub(crate) mod cull;
pub(crate) mod frustum;
mod hit;
pub(crate) mod moller_trumbore;
pub(crate) mod nearest;
mod ray;
pub(crate) mod slab;
mod triangle;
mod triangle_group;
mod vec3;
pub(crate) mod watertight;

pub use aabb::Aabb;
pub use hit::{Hit, HitBatch, HitBlock};
pub use nearest::Nearest;
pub(crate) use ray::Packet;
pub use ray::{Ray, RayBatch, RayBlock};
pub use triangle::Triangle;
pub use triangle_group::TriangleGroup;
pub use vec3::Vec3;
