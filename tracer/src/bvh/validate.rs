//! Whether trees are well-formed.

use super::wide::GROUP;
use super::{Bvh, Child, WideBvh, WideNode};
use crate::geometry::{Aabb, Hit, Triangle, TriangleGroup};

impl Bvh {
    /// Checks that the tree is well-formed: subtrees nest and end where their skip pointers say, every box is exactly the union of what
    /// it holds, leaves hold all triangles in order, and no triangle twice or degenerate (but for points, which
    /// [`Bvh::refit`] leaves of such).
    ///
    /// # Errors
    /// The first fault, in words.
    pub fn validate(&self) -> Result<(), String> {
        let nodes = &self.nodes;
        if nodes.len() >= u32::MAX as usize {
            return Err(format!("{} nodes are too many", nodes.len()));
        }
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
            if next_triangle > self.triangles.len() {
                return Err(format!("leaf {i} has triangles beyond the end"));
            }
        }
        if next_triangle != self.triangles.len() {
            return Err(format!("leaves hold {next_triangle} of {} triangles", self.triangles.len()));
        }
        for (i, node) in nodes.iter().enumerate().rev() {
            let (bounds, held) = (node.bounds(), self.held(i));
            if bounds != held {
                return Err(format!("node {i} has the box {bounds:?} around {held:?}"));
            }
        }
        check_triangles(self.triangles.iter().copied())
    }
}

impl<const N: usize> WideBvh<N> {
    /// Checks that the tree is well-formed: every node but the root has one parent, before it; every box is exactly the union of what
    /// it holds; every group is in one leaf, every triangle in one lane, none degenerate (but for points, which
    /// [`WideBvh::refit`] leaves of such); lanes without a triangle cannot be hit; [`WideBvh::triangles`] and [`WideBvh::depth`] are right.
    ///
    /// # Errors
    /// The first fault, in words.
    pub fn validate(&self) -> Result<(), String> {
        let depth = structure(&self.nodes, self.groups.len())?;
        if depth != self.depth {
            return Err(format!("the depth is {depth} instead of {}", self.depth));
        }
        let mut is_held = vec![false; self.groups.len()];
        for (i, node) in self.nodes.iter().enumerate() {
            for (slot, &child) in node.children.iter().enumerate().filter(|(_, child)| **child != Child::NONE) {
                let (bounds, held) = (node.bounds(slot), self.held(child));
                if bounds != held {
                    return Err(format!("child {slot} of node {i} has the box {bounds:?} around {held:?}"));
                }
                if child.is_leaf() {
                    let (first, end) = child.groups();
                    for (group, is_held) in (first..end).zip(&mut is_held[first..end]) {
                        if std::mem::replace(is_held, true) {
                            return Err(format!("group {group} is in two leaves"));
                        }
                    }
                }
            }
        }
        if let Some(group) = is_held.iter().position(|held| !held) {
            return Err(format!("group {group} is in no leaf"));
        }
        if self.groups.iter().any(is_hittable_without_triangle) {
            return Err("a lane without a triangle can be hit".into());
        }
        let triangles: Vec<Triangle> =
            self.groups.iter().flat_map(|group| (0..GROUP).filter_map(|lane| group.triangle(lane))).collect();
        if triangles.len() != self.triangles {
            return Err(format!("there are {} triangles instead of {}", triangles.len(), self.triangles));
        }
        check_triangles(triangles.into_iter())
    }
}

fn is_hittable_without_triangle(group: &TriangleGroup<GROUP>) -> bool {
    let has_extent = |lane: usize| group.e1.iter().chain(&group.e2).any(|edge| edge[lane] != 0.0);
    (0..GROUP).any(|lane| group.id[lane] == Hit::NO_PRIMITIVE && has_extent(lane))
}

/// All that keeps a traversal from failing and from running forever; the depth.
pub(super) fn structure<const N: usize>(nodes: &[WideNode<N>], groups: usize) -> Result<usize, String> {
    if nodes.len() >= Child::LEAF as usize {
        return Err(format!("{} nodes are too many", nodes.len()));
    }
    // Depth of each node, once its parent was seen: children come after their parents, so that there is no circle.
    let mut depths = vec![0; nodes.len()];
    if let Some(root) = depths.first_mut() {
        *root = 1;
    }
    for (i, node) in nodes.iter().enumerate() {
        if depths[i] == 0 {
            return Err(format!("node {i} has no parent before it"));
        }
        let below = depths[i] + 1;
        for (slot, &child) in node.children.iter().enumerate() {
            let bounds = node.bounds(slot);
            let boxed = bounds.is_finite() && (0..3).all(|axis| bounds.min[axis] <= bounds.max[axis]);
            if child == Child::NONE {
                if bounds != Aabb::EMPTY {
                    return Err(format!("node {i} has a box without a child"));
                }
            } else if !boxed {
                return Err(format!("node {i} has a child without a box"));
            } else if child.is_leaf() {
                if child.groups().1 > groups {
                    return Err(format!("a leaf of node {i} has triangles beyond the end"));
                }
            } else {
                match depths.get_mut(child.index()) {
                    Some(depth) if *depth == 0 => *depth = below,
                    _ => return Err(format!("node {i} has a child that is none")),
                }
            }
        }
    }
    Ok(depths.into_iter().max().unwrap_or(0))
}

/// None twice, and none degenerate but for points.
fn check_triangles(triangles: impl Iterator<Item = Triangle>) -> Result<(), String> {
    let mut ids = Vec::new();
    for t in triangles {
        if t.is_degenerate() && !t.is_point() {
            return Err(format!("triangle {} is degenerate", t.id));
        }
        ids.push(t.id);
    }
    ids.sort_unstable();
    match ids.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(format!("triangle {} is stored twice", pair[0])),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::super::stats::tests::two_leaves;
    use super::super::{CollapseConfig, Node};
    use super::*;

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

    #[test]
    fn faults_of_wide_trees_are_found() {
        let fault = |break_it: &dyn Fn(&mut WideBvh<4>)| {
            // Two leaves below the root.
            let mut wide = two_leaves().collapse::<4>(&CollapseConfig { node_cost: 0.0, max_leaf: 0 });
            wide.validate().expect("as it was made");
            assert_eq!((wide.nodes.len(), wide.groups.len()), (1, 2));
            break_it(&mut wide);
            wide.validate().expect_err("broken")
        };
        let a = Child::leaf(0, 1);
        for (message, break_it) in [
            ("no parent before it", &(|w: &mut WideBvh<4>| w.nodes.push(WideNode::EMPTY)) as &dyn Fn(&mut WideBvh<4>)),
            ("a box without a child", &|w| w.nodes[0].children[1] = Child::NONE),
            ("a child without a box", &|w| w.nodes[0].children[2] = a),
            ("a child without a box", &|w| w.nodes[0].planes[2][0] = f32::NAN),
            ("beyond the end", &|w| w.nodes[0].children[1] = Child::leaf(1, 2)),
            ("a child that is none", &|w| w.nodes[0].children[1] = Child::node(1)),
            ("a child that is none", &|w| w.nodes[0].children[1] = Child::node(0)),
            ("child 0 of node 0 has the box", &|w| w.nodes[0].planes[3][0] = 0.5),
            ("child 1 of node 0 has the box", &|w| w.groups[1].v0[2][0] += 0.5),
            ("group 0 is in two leaves", &|w| {
                let bounds = w.nodes[0].bounds(0);
                w.nodes[0].set(2, &bounds, a);
            }),
            ("group 1 is in no leaf", &|w| w.nodes[0].set(1, &Aabb::EMPTY, Child::NONE)),
            ("can be hit", &|w| w.groups[1].e1[0][3] = 1.0),
            ("triangles instead of", &|w| w.triangles = 3),
            ("the depth is", &|w| w.depth = 2),
            ("stored twice", &|w| w.groups[1].id[0] = w.groups[0].id[0]),
        ] {
            let found = fault(break_it);
            assert!(found.contains(message), "{found} instead of {message}");
        }
    }
}
