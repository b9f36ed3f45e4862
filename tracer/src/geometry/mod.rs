//! Boxes, triangles and rays, and how they meet.

mod aabb;
mod triangle;

pub use aabb::Aabb;
pub use triangle::Triangle;
