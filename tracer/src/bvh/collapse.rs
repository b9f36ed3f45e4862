//! From a binary tree to a wide one: which inner nodes to leave out, and which subtrees to make leaves, so that the surface area
//! heuristic's cost of the whole is least (Ylitie, Karras and Laine 2017, section 3.1).

use super::wide::GROUP;
use super::{Bvh, Child, Node, WideBvh, WideNode};
use crate::geometry::{Aabb, Triangle, TriangleGroup};
use rayon::prelude::*;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// What collapsing weighs against each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CollapseConfig {
    /// Cost of a node, when that of a group of triangles is 1.
    pub node_cost: f32,
    /// Most triangles in a leaf: at most four times [`Child::MAX_GROUPS`].
    pub max_leaf: usize,
}

impl Default for CollapseConfig {
    fn default() -> Self {
        Self { node_cost: 1.0, max_leaf: 2 * GROUP }
    }
}

/// What becomes of a node of the binary tree.
#[derive(Clone, Copy, PartialEq)]
enum Fate {
    Leaf,
    Node,
}

/// What was found best for a subtree.
#[derive(Clone, Copy)]
struct Best<const N: usize> {
    /// `left[i]`: as at most `i + 1` children of a wide node above it, how many of these the first child gets; 0 where fewer cost no more.
    left: [u8; N],
    fate: Fate,
    /// First triangle and number of triangles.
    triangles: (u32, u32),
}

impl Bvh {
    /// The wide tree with the least cost that leaves out nodes of this one.
    #[must_use]
    pub fn collapse<const N: usize>(&self, config: &CollapseConfig) -> WideBvh<N> {
        collapse(Cow::Borrowed(&self.nodes), self.triangles.len(), &|place| self.triangles[place], config)
    }
}

/// The wide tree made of these nodes, over `number` triangles in the order of the leaves.
pub(super) fn collapse<const N: usize>(
    nodes: Cow<[Node]>,
    number: usize,
    triangle: &(impl Fn(usize) -> Triangle + Sync),
    config: &CollapseConfig,
) -> WideBvh<N> {
    const { assert!(N == 4 || N == 8 || N == 16, "wide nodes have 4, 8 or 16 children") }
    let mut wide = WideBvh { nodes: Vec::new(), groups: Vec::new(), triangles: number, depth: 0 };
    if nodes.is_empty() {
        return wide;
    }
    let nodes = in_twos(nodes);
    let best = best::<N>(&nodes, config);
    wide.nodes.push(WideNode::EMPTY);
    let emit = Emit { nodes: &nodes, best: &best };
    // Even when the whole tree is one leaf there is a node above it.
    let mut todo = vec![(0, 0, 1)];
    let mut roots = Vec::with_capacity(N);
    let mut leaves = Leaves::default();
    while let Some((at, binary, depth)) = todo.pop() {
        wide.depth = wide.depth.max(depth);
        roots.clear();
        if best[binary].fate == Fate::Leaf {
            roots.push(binary);
        } else {
            emit.open(binary, N, &mut roots);
        }
        // Rays that ask for any hit visit the last child first: the one most likely to be hit for what it costs (after Nah and Manocha 2014,
        // "SATO: surface area traversal order for shadow ray tracing").
        let promise = |root: usize| nodes[root].bounds().half_area() / best[root].triangles.1 as f32;
        roots.sort_by(|&a, &b| promise(a).total_cmp(&promise(b)));
        for (i, &root) in roots.iter().enumerate() {
            let child = if best[root].fate == Fate::Leaf {
                leaves.add(best[root].triangles)
            } else {
                wide.nodes.push(WideNode::EMPTY);
                todo.push((wide.nodes.len() - 1, root, depth + 1));
                Child::node(wide.nodes.len() - 1)
            };
            wide.nodes[at].set(i, &nodes[root].bounds(), child);
        }
    }
    // Before there are groups, which take as much.
    drop((best, nodes));
    let mut all = simd::vec_in_huge_pages(wide.nodes.len());
    all.append(&mut wide.nodes);
    wide.nodes = all;
    let group = |(first, number): (u32, u32)| {
        let mut group = TriangleGroup::EMPTY;
        for lane in 0..number as usize {
            group.set(lane, &triangle(first as usize + lane));
        }
        group
    };
    wide.groups = simd::vec_in_huge_pages(leaves.groups.len());
    leaves.groups.into_par_iter().map(group).collect_into_vec(&mut wide.groups);
    wide
}

/// The nodes, with at most two children each: where there are more ([insertion](super::build::insertion) makes such), all but the
/// first get a node of their own above them.
pub(super) fn in_twos(nodes: Cow<[Node]>) -> Cow<[Node]> {
    // The box of the new node, and where the subtree ends, by the node before which it comes.
    let mut new = BTreeMap::new();
    let mut siblings = Vec::new();
    for (i, node) in nodes.iter().enumerate().filter(|(_, node)| node.triangles().1 == 0) {
        let end = node.skip() as usize;
        siblings.clear();
        let mut child = i + 1;
        while child < end {
            siblings.push(child);
            child = nodes[child].skip() as usize;
        }
        let mut bounds = Aabb::EMPTY;
        for (k, &child) in siblings.iter().enumerate().skip(1).rev() {
            bounds = bounds.union(&nodes[child].bounds());
            if k + 1 < siblings.len() {
                new.insert(child, (bounds, end));
            }
        }
    }
    if new.is_empty() {
        return nodes;
    }
    let mut place = Vec::with_capacity(nodes.len() + 1);
    let mut number = 0;
    for i in 0..=nodes.len() {
        place.push(number);
        number += 1 + u32::from(new.contains_key(&i));
    }
    let mut twos = Vec::with_capacity(nodes.len() + new.len());
    for (i, node) in nodes.iter().enumerate() {
        if let Some((bounds, end)) = new.get(&i) {
            twos.push(Node::inner(bounds, place[*end]));
        }
        twos.push(node.with_skip(place[node.skip() as usize]));
    }
    Cow::Owned(twos)
}

fn best<const N: usize>(nodes: &[Node], config: &CollapseConfig) -> Vec<Best<N>> {
    let mut best = simd::vec_in_huge_pages(nodes.len());
    best.resize(nodes.len(), Best { left: [0; N], fate: Fate::Leaf, triangles: (0, 0) });
    let max_leaf = config.max_leaf.min(GROUP * Child::MAX_GROUPS);
    // Costs of the subtrees that have no parent yet, as at most 1, 2, ... children: from the last node to the first the children of a
    // node lie on top, the first above the second.
    let mut waiting: Vec<[f32; N]> = Vec::new();
    for (i, node) in nodes.iter().enumerate().rev() {
        let area = node.bounds().half_area();
        let groups = |number: u32| (number as usize).div_ceil(GROUP) as f32;
        let mut this = Best { left: [0; N], fate: Fate::Leaf, triangles: node.triangles() };
        let mut costs = [area * groups(this.triangles.1); N];
        let below = if this.triangles.1 == 0 { waiting.pop().zip(waiting.pop()) } else { None };
        if let Some((a, b)) = below {
            let [first, second] = children(nodes, i).map(|child| best[child].triangles);
            let number = first.1 + second.1;
            this.triangles = (first.0, number);
            costs[0] = area * groups(number);
            // As `k + 1` children: from those of both sides.
            for k in 1..N {
                let (mut cost, mut left) = (f32::INFINITY, 1);
                for l in 0..k {
                    let sum = a[l] + b[k - 1 - l];
                    if sum < cost {
                        (cost, left) = (sum, l + 1);
                    }
                }
                (costs[k], this.left[k]) = (cost, left as u8);
            }
            let as_node = costs[N - 1] + area * config.node_cost;
            if number as usize > max_leaf || as_node < costs[0] {
                costs[0] = as_node;
                this.fate = Fate::Node;
            }
            for k in 1..N {
                if costs[k - 1] <= costs[k] {
                    (costs[k], this.left[k]) = (costs[k - 1], 0);
                }
            }
        }
        waiting.push(costs);
        best[i] = this;
    }
    best
}

/// The two children of an inner node.
fn children(nodes: &[Node], i: usize) -> [usize; 2] {
    [i + 1, nodes[i + 1].skip() as usize]
}

struct Emit<'a, const N: usize> {
    nodes: &'a [Node],
    best: &'a [Best<N>],
}

impl<const N: usize> Emit<'_, N> {
    /// The subtrees that become the at most `room` children of the wide node made of node `i`.
    fn open(&self, i: usize, room: usize, roots: &mut Vec<usize>) {
        let [a, b] = children(self.nodes, i);
        let left = (0..room).rev().map(|k| (k, self.best[i].left[k] as usize)).find(|&(_, left)| left > 0);
        // A node that stays has at least two children.
        let (k, left) = left.unwrap_or((1, 1));
        for (child, room) in [(a, left), (b, k + 1 - left)] {
            // One child, or where fewer cost no more: the subtree whole.
            let whole = (0..room).all(|k| self.best[child].left[k] == 0);
            if room == 1 || whole { roots.push(child) } else { self.open(child, room, roots) }
        }
    }
}

/// Leaves whose triangles are not yet put into groups.
#[derive(Default)]
struct Leaves {
    /// First triangle and number of triangles of each group.
    groups: Vec<(u32, u32)>,
}

impl Leaves {
    fn add(&mut self, (first, number): (u32, u32)) -> Child {
        let begin = self.groups.len();
        let places = (first..first + number).step_by(GROUP);
        self.groups.extend(places.map(|place| (place, (first + number - place).min(GROUP as u32))));
        Child::leaf(begin, self.groups.len() - begin)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::BuildConfig;
    use crate::geometry::Hit;
    use crate::model::builtin;
    use crate::progress::Silent;

    fn tree(spec: &str, config: &BuildConfig) -> Bvh {
        let scene = builtin(spec).expect("a built-in scene").expect("a possible size");
        Bvh::build(&scene.mesh, config, &Silent).expect("a valid mesh")
    }

    fn check<const N: usize>(bvh: &Bvh, config: &CollapseConfig) {
        let wide = bvh.collapse::<N>(config);
        wide.validate().unwrap_or_else(|e| panic!("{config:?}: {e}"));
        let mut ids: Vec<u32> = wide.groups.iter().flat_map(|g| g.id).filter(|&id| id != Hit::NO_PRIMITIVE).collect();
        ids.sort_unstable();
        let mut expected: Vec<u32> = bvh.triangles.iter().map(|t| t.id).collect();
        expected.sort_unstable();
        assert!(ids == expected, "every triangle once");
    }

    #[test]
    fn wide_trees_hold_what_binary_trees_hold() {
        let builders = [BuildConfig::default(), BuildConfig::insertion(7), BuildConfig::fast(), BuildConfig::high()];
        for (spec, builder) in
            [("balls:1", 0), ("rings:1", 1), ("tree:3", 0), ("tree:3", 1), ("tree:3", 2), ("tree:3", 3)]
        {
            let bvh = tree(spec, &builders[builder]);
            for node_cost in [0.0, 0.3, 1.0, 100.0] {
                for max_leaf in [0, 4, 1000] {
                    let config = CollapseConfig { node_cost, max_leaf };
                    check::<4>(&bvh, &config);
                    check::<8>(&bvh, &config);
                    check::<16>(&bvh, &config);
                }
            }
        }
    }

    #[test]
    fn one_triangle_is_a_leaf_below_a_node() {
        let mut bvh = tree("balls:1", &BuildConfig::default());
        let bounds = bvh.triangles[0].bounds();
        bvh.triangles.truncate(1);
        bvh.nodes = vec![Node::leaf(&bounds, 1, 0, 1)];
        check::<8>(&bvh, &CollapseConfig::default());
        assert_eq!(bvh.collapse::<8>(&CollapseConfig::default()).nodes.len(), 1);
    }
}
