//! What a tree looks like: its size and expected cost.

use super::{Bvh, Node};
use crate::geometry::Triangle;

/// Measures of a tree.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BvhStats {
    /// Nodes, leaves included.
    pub nodes: usize,
    /// Leaves.
    pub leaves: usize,
    /// Triangles in the leaves: those of the mesh that are not degenerate.
    pub triangles: usize,
    /// Steps from the root to the deepest leaf.
    pub max_depth: usize,
    /// Triangles in a leaf, on average.
    pub mean_leaf: f64,
    /// Expected number of box tests and triangle tests, each at cost 1, of a random line that hits the root's box (Goldsmith & Salmon 1987;
    /// MacDonald & Booth 1990). The stackless loop tests the root once, every child of a node that is hit, every triangle of a leaf that is hit.
    pub sah_cost: f64,
    /// Memory of nodes and triangles, in bytes.
    pub bytes: usize,
    /// `bytes / triangles`.
    pub bytes_per_triangle: f64,
}

impl Bvh {
    /// Measures the tree; all zero when it is empty.
    #[must_use]
    pub fn stats(&self) -> BvhStats {
        let (nodes, triangles) = (self.nodes.len(), self.triangles.len());
        let Some(root) = self.nodes.first() else { return BvhStats::default() };
        let mut leaves = 0;
        let mut max_depth = 0;
        let mut cost = root.bounds().half_area_f64();
        // Inner nodes above the current one: where each ends, and its area.
        let mut above: Vec<(usize, f64)> = Vec::new();
        for (i, node) in self.nodes.iter().enumerate() {
            while above.last().is_some_and(|&(end, _)| end <= i) {
                above.pop();
            }
            if let Some((_, parent_area)) = above.last() {
                cost += parent_area;
            }
            let (_, count) = node.triangles();
            if count == 0 {
                above.push((node.skip() as usize, node.bounds().half_area_f64()));
            } else {
                leaves += 1;
                max_depth = max_depth.max(above.len());
                cost += f64::from(count) * node.bounds().half_area_f64();
            }
        }
        let bytes = nodes * size_of::<Node>() + triangles * size_of::<Triangle>();
        let per = |a: f64, b: usize| if b == 0 { 0.0 } else { a / b as f64 };
        BvhStats {
            nodes,
            leaves,
            triangles,
            max_depth,
            mean_leaf: per(triangles as f64, leaves),
            sah_cost: cost / root.bounds().half_area_f64(),
            bytes,
            bytes_per_triangle: per(bytes as f64, triangles),
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A root around two leaves: unit squares' halves at z = 0 and z = 1.
    pub(in crate::bvh) fn two_leaves() -> Bvh {
        let triangle = |z: f32, id| Triangle::new([[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]], id, 0);
        let triangles = vec![triangle(0.0, 4), triangle(1.0, 2)];
        let [a, b] = [0, 1].map(|i: usize| triangles[i].bounds());
        let nodes = vec![Node::inner(&a.union(&b), 3), Node::leaf(&a, 2, 0, 1), Node::leaf(&b, 3, 1, 1)];
        Bvh { nodes, triangles }
    }

    #[test]
    fn stats_of_a_small_tree() {
        let bvh = two_leaves();
        bvh.validate().unwrap();
        let stats = bvh.stats();
        assert_eq!((stats.nodes, stats.leaves, stats.triangles, stats.max_depth), (3, 2, 2, 1));
        assert_eq!((stats.mean_leaf, stats.bytes, stats.bytes_per_triangle), (1.0, 192, 96.0));
        // The root's box, its two children, and each triangle with its leaf's third of the root's area.
        assert!((stats.sah_cost - (1.0 + 2.0 + 2.0 / 3.0)).abs() < 1e-12);
    }

    #[test]
    fn an_empty_tree_is_valid() {
        let empty = Bvh { nodes: Vec::new(), triangles: Vec::new() };
        empty.validate().unwrap();
        assert_eq!(empty.stats(), BvhStats::default());
    }

    #[test]
    fn a_lone_leaf_costs_its_tests() {
        let mut bvh = two_leaves();
        let bounds = bvh.nodes[0].bounds();
        bvh.nodes = vec![Node::leaf(&bounds, 1, 0, 2)];
        bvh.validate().unwrap();
        assert_eq!((bvh.stats().sah_cost, bvh.stats().max_depth), (3.0, 0));
    }
}
