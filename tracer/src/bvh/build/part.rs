//! Subtrees that were built apart, put together to one depth-first array.

use crate::bvh::Node;
use crate::geometry::Aabb;

/// Part of a tree; skip pointers count from the part's first node.
pub(super) enum Part {
    Subtree(Vec<Node>),
    Inner(Node, Box<[Part; 2]>),
}

impl Part {
    /// An inner node above two parts.
    pub(super) fn inner(bounds: &Aabb, a: Self, b: Self) -> Self {
        Self::Inner(Node::inner(bounds, (1 + a.len() + b.len()) as u32), Box::new([a, b]))
    }

    /// All nodes, depth first.
    pub(super) fn into_nodes(self) -> Vec<Node> {
        let mut nodes = simd::vec_in_huge_pages(self.len());
        self.flatten(&mut nodes);
        nodes
    }

    /// Number of nodes.
    fn len(&self) -> usize {
        match self {
            Self::Subtree(nodes) => nodes.len(),
            Self::Inner(node, _) => node.skip() as usize,
        }
    }

    /// Appends the nodes, depth first.
    fn flatten(self, nodes: &mut Vec<Node>) {
        let base = nodes.len() as u32;
        let moved = |n: Node| n.with_skip(n.skip() + base);
        match self {
            Self::Subtree(part) => nodes.extend(part.into_iter().map(moved)),
            Self::Inner(node, children) => {
                nodes.push(moved(node));
                children.into_iter().for_each(|c| c.flatten(nodes));
            }
        }
    }
}
