//! What a tree looks like: its size and expected cost, and whether it is well-formed.

use super::{Bvh, Node};
use crate::geometry::{Aabb, Triangle};

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

    /// Checks that the tree is well-formed: subtrees nest and end where their skip pointers say, every box is exactly the union of what
    /// it holds, leaves hold all triangles in order, and no triangle twice or degenerate.
    ///
    /// # Errors
    /// The first fault, in words.
    pub fn validate(&self) -> Result<(), String> {
        let nodes = &self.nodes;
        if nodes.len() >= u32::MAX as usize {
            return Err(format!("{} nodes are too many", nodes.len()));
        }
        // Union of what each node holds, children adding themselves to their parents.
        let mut held = vec![Aabb::EMPTY; nodes.len()];
        let mut above: Vec<usize> = Vec::new();
        let mut next_triangle = 0;
        for (i, node) in nodes.iter().enumerate() {
            while above.last().is_some_and(|&a| nodes[a].skip() as usize == i) {
                above.pop();
            }
            let end = above.last().map_or(nodes.len(), |&a| nodes[a].skip() as usize);
            if i > 0 && above.is_empty() {
                return Err(format!("node {i} is a second root"));
            }
            let skip = node.skip() as usize;
            let (first, count) = node.triangles();
            if count == 0 {
                // A single child would be a wasted box test, none would be nothing.
                if skip <= i + 2 || skip > end {
                    return Err(format!("inner node {i} skips to {skip}, its parent to {end}"));
                }
                above.push(i);
                continue;
            }
            if skip != i + 1 {
                return Err(format!("leaf {i} skips to {skip}"));
            }
            if first as usize != next_triangle {
                return Err(format!("leaf {i} starts at triangle {first} instead of {next_triangle}"));
            }
            next_triangle += count as usize;
            let Some(triangles) = self.triangles.get(first as usize..next_triangle) else {
                return Err(format!("leaf {i} has triangles beyond the end"));
            };
            held[i] = triangles.iter().fold(Aabb::EMPTY, |b, t| b.union(&t.bounds()));
        }
        self.validate_boxes(held)?;
        self.validate_triangles(next_triangle)
    }

    fn validate_boxes(&self, mut held: Vec<Aabb>) -> Result<(), String> {
        for (i, node) in self.nodes.iter().enumerate().rev() {
            // All children lie behind: visit them by their skip pointers.
            if node.triangles().1 == 0 {
                let mut child = i + 1;
                while child < node.skip() as usize {
                    held[i] = held[i].union(&held[child]);
                    child = self.nodes[child].skip() as usize;
                }
            }
            if node.bounds() != held[i] {
                return Err(format!("node {i} has the box {:?} around {:?}", node.bounds(), held[i]));
            }
        }
        Ok(())
    }

    fn validate_triangles(&self, in_leaves: usize) -> Result<(), String> {
        if in_leaves != self.triangles.len() {
            return Err(format!("leaves hold {in_leaves} of {} triangles", self.triangles.len()));
        }
        let mut ids: Vec<u32> = self.triangles.iter().map(|t| t.id).collect();
        ids.sort_unstable();
        if let Some(pair) = ids.windows(2).find(|p| p[0] == p[1]) {
            return Err(format!("triangle {} is stored twice", pair[0]));
        }
        match self.triangles.iter().find(|t| t.is_degenerate()) {
            Some(t) => Err(format!("triangle {} is degenerate", t.id)),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A root around two leaves: unit squares' halves at z = 0 and z = 1.
    fn two_leaves() -> Bvh {
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

    #[test]
    fn degenerate_triangles_are_found() {
        let triangle = Triangle::new([[0.0; 3], [1.0; 3], [2.0; 3]], 0, 0);
        let bvh = Bvh { nodes: vec![Node::leaf(&triangle.bounds(), 1, 0, 1)], triangles: vec![triangle] };
        assert!(bvh.validate().unwrap_err().contains("degenerate"));
    }

    #[test]
    fn faults_are_found() {
        let fault = |break_it: &dyn Fn(&mut Bvh)| {
            let mut bvh = two_leaves();
            break_it(&mut bvh);
            bvh.validate().unwrap_err()
        };
        let small = Aabb { min: [0.0; 3], max: [1.0, 1.0, 0.5] };
        for (message, break_it) in [
            ("inner node 0 skips", &(|b: &mut Bvh| b.nodes[0] = b.nodes[0].with_skip(2)) as &dyn Fn(&mut Bvh)),
            ("inner node 0 skips", &|b| b.nodes[0] = b.nodes[0].with_skip(4)),
            ("leaf 1 skips", &|b| b.nodes[1] = b.nodes[1].with_skip(3)),
            ("second root", &|b| b.nodes.push(b.nodes[2].with_skip(4))),
            ("leaf 2 starts", &|b| b.nodes[2] = Node::leaf(&b.nodes[2].bounds(), 3, 0, 1)),
            ("beyond the end", &|b| b.nodes[2] = Node::leaf(&b.nodes[2].bounds(), 3, 1, 2)),
            ("node 0 has the box", &|b| b.nodes[0] = Node::inner(&small, 3)),
            ("node 2 has the box", &|b| b.triangles[1].v0[2] = 0.75),
            ("of 3 triangles", &|b| b.triangles.push(b.triangles[0])),
            ("stored twice", &|b| b.triangles[1].id = 4),
        ] {
            let found = fault(break_it);
            assert!(found.contains(message), "{found} instead of {message}");
        }
    }
}
