//! The bounding volume hierarchy: a depth-first array of nodes with skip pointers.

pub mod build;
mod collapse;
mod epo;
mod node;
pub(crate) mod octo;
mod refit;
mod stats;
mod validate;
mod wide;

pub use build::BuildConfig;
pub use collapse::CollapseConfig;
pub use node::Node;
pub(crate) use octo::OctoNode;
pub use octo::{OctoBvh, OctoConfig};
pub use stats::BvhStats;
pub use wide::{Child, WideBvh, WideNode};

use crate::geometry::Triangle;

/// A tree over the triangles of a mesh. Node 0 is the root; empty when no triangle can be hit.
#[derive(Debug, Clone)]
pub struct Bvh {
    /// Nodes, depth first.
    pub nodes: Vec<Node>,
    /// Triangles in the order of the leaves; degenerate ones left out.
    pub triangles: Vec<Triangle>,
}
