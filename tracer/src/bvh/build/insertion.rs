//! One triangle after the other into a tree of any arity (Goldsmith & Salmon 1987, "Automatic creation of object hierarchies for ray
//! tracing"), children then sorted by surface area (Geimer & Müller 2003, section 3.3).
//!
//! The cost of a tree is the expected number of box tests of a line that hits the root: a node with `k` children costs `k` tests
//! whenever it is hit, which is as likely as its surface area `A` is large. A new triangle `o` walks down from the root. At each inner node
//! `N`, whose growth and that of all nodes above adds `I` = sum of `k * (A(node + o) - A(node))`, it could
//!
//! - become one more child of `N`, which adds `I + A(N + o)`, unless `N` is full ([`Config::max_children`]);
//! - form a new node with a leaf `L` among the children, in the place of `L`, which adds `I + 2 * A(L + o)`;
//! - go on to the inner child whose surface area grows least (on a tie the smaller one, then the one with fewer triangles, then
//!   the older one), unless what is inherited from there alone is no better than the best place so far.
//!
//! The best place on this way is taken, the first on a tie. Every leaf has one triangle.
//!
//! The tree depends on the order of insertion, which the papers leave open. It is shuffled, since that of a file is a gamble: it
//! makes a better tree of balls (a fifth less costly), a worse one of conference (a third more costly).

use super::Tree;
use super::primitive::Primitive;
use crate::Error;
use crate::bvh::Node;
use crate::geometry::Aabb;
use crate::progress::Progress;

/// Knobs of the insertion builder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Config {
    /// Seed of the shuffled order in which triangles are inserted; `None` for the order of the mesh.
    pub seed: Option<u64>,
    /// Most children of a node, at least 2. Without a bound many equal triangles would all become children of one node.
    pub max_children: u32,
    /// Whether children are sorted by decreasing surface area, so that large ones, likely to be hit, are visited first.
    pub sort_children: bool,
}

impl Default for Config {
    fn default() -> Self {
        Self { seed: Some(0), max_children: 32, sort_children: true }
    }
}

/// Triangles inserted between two reports of progress.
const STEP: usize = 4096;

pub(super) fn build(mut primitives: Vec<Primitive>, config: &Config, progress: &dyn Progress) -> Result<Tree, Error> {
    if let Some(seed) = config.seed {
        shuffle(&mut primitives, seed);
    }
    let mut hierarchy = Hierarchy::new(config, primitives.len());
    for chunk in primitives.chunks(STEP) {
        progress.check()?;
        for p in chunk {
            hierarchy.insert(&p.0.aabb(), p.id());
        }
        progress.advance(chunk.len() as u64);
    }
    Ok(hierarchy.flatten(config.sort_children))
}

/// Fisher-Yates with numbers of SplitMix64 (Steele, Lea & Flood 2014).
fn shuffle<T>(items: &mut [T], mut state: u64) {
    for i in (1..items.len()).rev() {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        // The high half of a product instead of a remainder: as even, and no division.
        let j = (u128::from(z) * (i as u128 + 1)) >> 64;
        items.swap(i, j as usize);
    }
}

/// No node: the end of a list of children.
const NONE: u32 = u32::MAX;

/// A node while the tree grows: its children are a linked list.
#[derive(Clone, Copy)]
struct Growing {
    bounds: Aabb,
    first_child: u32,
    next_sibling: u32,
    /// Number of children; 0 for a leaf.
    children: u32,
    /// Id of a leaf's triangle, or number of triangles below an inner node.
    triangles: u32,
}

/// Where a triangle could go.
struct Place {
    cost: f64,
    /// Number of nodes on the path down to the parent-to-be.
    depth: usize,
    /// The leaf to share a new node with.
    leaf: Option<u32>,
}

struct Hierarchy {
    max_children: u32,
    /// Node 0 is the root, an inner node from the beginning.
    nodes: Vec<Growing>,
    /// Nodes on the way down of the current insertion.
    path: Vec<u32>,
}

impl Hierarchy {
    fn new(config: &Config, triangles: usize) -> Self {
        let mut nodes = Vec::with_capacity(2 * triangles);
        nodes.push(Growing { bounds: Aabb::EMPTY, first_child: NONE, next_sibling: NONE, children: 0, triangles: 0 });
        Self { max_children: config.max_children.max(2), nodes, path: Vec::new() }
    }

    fn insert(&mut self, bounds: &Aabb, id: u32) {
        let place = self.search(bounds);
        for &n in &self.path[..place.depth] {
            let node = &mut self.nodes[n as usize];
            node.bounds = node.bounds.union(bounds);
            node.triangles += 1;
        }
        let mut parent = self.path[place.depth - 1];
        if let Some(leaf) = place.leaf {
            // The leaf's node becomes the new inner node, so that the list it stands in need not change.
            let old = self.nodes[leaf as usize];
            let inner =
                Growing { bounds: old.bounds.union(bounds), first_child: NONE, children: 0, triangles: 2, ..old };
            self.nodes[leaf as usize] = inner;
            self.add_leaf(leaf, &old.bounds, old.triangles);
            parent = leaf;
        }
        self.add_leaf(parent, bounds, id);
    }

    fn add_leaf(&mut self, parent: u32, bounds: &Aabb, id: u32) {
        let new = self.nodes.len() as u32;
        let node = &mut self.nodes[parent as usize];
        let next_sibling = std::mem::replace(&mut node.first_child, new);
        node.children += 1;
        self.nodes.push(Growing { bounds: *bounds, first_child: NONE, next_sibling, children: 0, triangles: id });
    }

    /// The cheapest place on the way down that the module's documentation describes; leaves that way in `path`.
    fn search(&mut self, bounds: &Aabb) -> Place {
        let area_with = |b: &Aabb| b.union(bounds).half_area_f64();
        let mut best = Place { cost: f64::INFINITY, depth: 1, leaf: None };
        let mut inherited = 0.0;
        let mut at = 0;
        self.path.clear();
        loop {
            self.path.push(at);
            let depth = self.path.len();
            let node = &self.nodes[at as usize];
            let area = area_with(&node.bounds);
            inherited += f64::from(node.children) * (area - node.bounds.half_area_f64());
            if inherited >= best.cost {
                return best;
            }
            if node.children < self.max_children && inherited + area < best.cost {
                best = Place { cost: inherited + area, depth, leaf: None };
            }
            let mut least = (f64::INFINITY, f64::INFINITY, u32::MAX, NONE);
            let mut next = node.first_child;
            while next != NONE {
                let child = &self.nodes[next as usize];
                let area = area_with(&child.bounds);
                if child.children == 0 {
                    let cost = inherited + 2.0 * area;
                    if cost < best.cost {
                        best = Place { cost, depth, leaf: Some(next) };
                    }
                } else {
                    let before = child.bounds.half_area_f64();
                    let key = (area - before, before, child.triangles, next);
                    if key < least {
                        least = key;
                    }
                }
                next = child.next_sibling;
            }
            at = least.3;
            if at == NONE {
                return best;
            }
        }
    }

    fn flatten(self, sort: bool) -> Tree {
        enum Visit {
            Open(u32),
            /// All nodes below this one are in the array.
            Close(usize),
        }
        let root = &self.nodes[0];
        // A lone triangle needs no inner node around it.
        let root = if root.children == 1 { root.first_child } else { 0 };
        let (mut nodes, mut ids) = (Vec::with_capacity(self.nodes.len()), Vec::new());
        let mut stack = vec![Visit::Open(root)];
        let mut children = Vec::new();
        while let Some(visit) = stack.pop() {
            let slot = match visit {
                Visit::Open(slot) => &self.nodes[slot as usize],
                Visit::Close(at) => {
                    nodes[at] = Node::with_skip(nodes[at], nodes.len() as u32);
                    continue;
                }
            };
            let at = nodes.len();
            if slot.children == 0 {
                nodes.push(Node::leaf(&slot.bounds, at as u32 + 1, ids.len() as u32, 1));
                ids.push(slot.triangles);
                continue;
            }
            nodes.push(Node::inner(&slot.bounds, 0));
            stack.push(Visit::Close(at));
            children.clear();
            let mut next = slot.first_child;
            while next != NONE {
                children.push(next);
                next = self.nodes[next as usize].next_sibling;
            }
            // Lists are newest first, and a stack turns them round: oldest first, then, if sorted, the largest.
            if sort {
                let area = |n: &u32| self.nodes[*n as usize].bounds.half_area_f64();
                children.sort_by(|a, b| area(a).total_cmp(&area(b)));
            }
            stack.extend(children.iter().map(|&c| Visit::Open(c)));
        }
        Tree { nodes, ids }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shuffling_is_a_permutation_that_depends_on_the_seed() {
        let shuffled = |seed| {
            let mut items: Vec<u32> = (0..1000).collect();
            shuffle(&mut items, seed);
            items
        };
        assert_ne!(shuffled(1), shuffled(2));
        let moved = shuffled(1).iter().enumerate().filter(|&(i, &x)| i as u32 != x).count();
        assert!(moved > 950, "{moved} of 1000 moved");
        let mut sorted = shuffled(1);
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..1000));
    }

    fn cube(x: f32, size: f32) -> Aabb {
        Aabb { min: [x, 0.0, 0.0], max: [x + size, size, size] }
    }

    #[test]
    fn near_ones_are_grouped() {
        let mut h = Hierarchy::new(&Config::default(), 4);
        for (id, x) in [0.0, 100.0, 1.5, 101.5].into_iter().enumerate() {
            h.insert(&cube(x, 1.0), id as u32);
        }
        let tree = h.flatten(true);
        assert_eq!(tree.nodes.len(), 7, "two pairs");
        assert_eq!(tree.nodes[1].bounds(), cube(0.0, 1.0).union(&cube(1.5, 1.0)));
        assert_eq!(tree.ids, [0, 2, 1, 3]);
    }

    #[test]
    fn no_node_has_more_children_than_allowed() {
        for max_children in [2, 3, 8] {
            let mut h = Hierarchy::new(&Config { max_children, ..Default::default() }, 1000);
            (0..1000).for_each(|id| h.insert(&cube(0.0, 1.0), id));
            assert!(h.nodes.iter().all(|n| n.children <= max_children));
            let tree = h.flatten(true);
            assert_eq!(tree.ids.len(), 1000);
        }
    }

    #[test]
    fn deep_trees_need_no_deep_stack() {
        // A chain: every node has a leaf and the next node.
        let n = 200_000;
        let mut h = Hierarchy::new(&Config::default(), n);
        for i in 0..n as u32 {
            h.add_leaf(2 * i, &cube(0.0, 1.0), i);
            h.add_leaf(2 * i, &cube(0.0, 1.0), i);
        }
        let tree = h.flatten(true);
        assert_eq!(tree.nodes.len(), 2 * n + 1);
        assert_eq!(tree.nodes[0].skip() as usize, tree.nodes.len());
    }
}
