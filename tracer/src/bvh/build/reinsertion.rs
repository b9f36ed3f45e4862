//! A tree by the surface area heuristic, then made better by moving subtrees to where they cost less (Bittner, Hapala and Havran 2013,
//! "Fast insertion-based optimization of bounding volume hierarchies"), many at a time (Meister and Bittner 2018, "Parallel
//! reinsertion for bounding volume hierarchy optimization"). The slowest to build and the best to trace.
//!
//! The tree is binary with one triangle in a leaf, so that its cost is the sum of the areas of its inner nodes. Moving a subtree
//! takes its parent out, which saves the parent's area and shrinks the boxes above; inserting it elsewhere makes a new parent there and
//! lets the boxes above grow. In a round the best place for each of some subtrees is searched in parallel, in the same tree for all; then the
//! moves are made one after the other, the most profitable first, without those that come near an earlier one of the round. So the
//! tree does not depend on the number of threads. At the end small subtrees become leaves where that costs less.

use super::primitive::{Box8, Primitive};
use super::{Tree, binned};
use crate::Error;
use crate::bvh::Node;
use crate::progress::Progress;
use rayon::prelude::*;

/// Knobs of the optimizing builder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Config {
    /// Of the tree to begin with, and of the leaves at the end.
    pub binned: binned::Config,
    /// Rounds of moves.
    pub rounds: u32,
    /// One of this many subtrees is considered in a round, the others in the next rounds (0 is taken as 1). Many rounds of few
    /// are better than few rounds of many, whose moves are in each other's way: on conference 16 rounds of an eighth of all leave a
    /// cost of 56.9 after 1.3 s, 4 rounds of all one of 57.4 after 1.5 s.
    pub stride: u32,
}

impl Default for Config {
    fn default() -> Self {
        Self { binned: binned::Config::default(), rounds: 16, stride: 8 }
    }
}

/// Most places looked at for a subtree: a bound for scenes in which everything overlaps. Others need fewer than 500.
const MAX_VISITS: u32 = 1000;

/// No node: the first child of a leaf.
const NONE: u32 = u32::MAX;
const ROOT: u32 = 0;

pub(super) fn build(primitives: Vec<Primitive>, config: &Config, progress: &dyn Progress) -> Result<Tree, Error> {
    let single = binned::Config { max_leaf: 1, ..config.binned };
    let Tree { nodes, ids } = binned::build(primitives, &single, progress)?;
    let mut links = Links::new(&nodes);
    drop(nodes);
    progress.stage("optimize", u64::from(config.rounds));
    for round in 0..config.rounds {
        progress.check()?;
        links.improve(round, config.stride.max(1));
        progress.advance(1);
    }
    progress.check()?;
    Ok(links.flatten(&ids, &config.binned))
}

/// A binary tree whose nodes can be moved. Node 0 is the root.
struct Links {
    bounds: Vec<Box8>,
    parents: Vec<u32>,
    /// Both children, or [`NONE`] and the place of a leaf's triangle.
    children: Vec<[u32; 2]>,
}

/// A subtree, the node that shall become its sibling, and by how much areas shrink.
#[derive(Clone, Copy)]
struct Move {
    gain: f32,
    node: u32,
    to: u32,
}

impl Links {
    fn new(nodes: &[Node]) -> Self {
        let bounds = nodes.iter().map(Node::bounds).map(|b| Box8::new(&b, 0.0)).collect();
        let (mut parents, mut children) = (vec![ROOT; nodes.len()], Vec::with_capacity(nodes.len()));
        for (i, node) in nodes.iter().enumerate() {
            let (first, count) = node.triangles();
            if count > 0 {
                children.push([NONE, first]);
                continue;
            }
            let both = [i as u32 + 1, nodes[i + 1].skip()];
            both.iter().for_each(|&child| parents[child as usize] = i as u32);
            children.push(both);
        }
        Self { bounds, parents, children }
    }

    fn sibling(&self, node: u32) -> u32 {
        let [a, b] = self.children[self.parents[node as usize] as usize];
        if a == node { b } else { a }
    }

    fn is_leaf(&self, node: u32) -> bool {
        self.children[node as usize][0] == NONE
    }

    fn area(&self, node: u32) -> f32 {
        self.bounds[node as usize].half_area()
    }

    fn improve(&mut self, round: u32, stride: u32) {
        let first = 1 + round % stride;
        let mut moves: Vec<Move> = (first..self.parents.len() as u32)
            .into_par_iter()
            .step_by(stride as usize)
            .map_init(Vec::new, |stack, node| self.search(node, stack))
            .filter(|m| m.gain > 0.0)
            .collect();
        moves.par_sort_unstable_by(|a, b| b.gain.total_cmp(&a.gain).then(a.node.cmp(&b.node)));
        let mut touched = vec![false; self.parents.len()];
        for m in &moves {
            let parent = self.parents[m.node as usize];
            let near = [
                m.node,
                m.to,
                parent,
                self.sibling(m.node),
                self.parents[m.to as usize],
                self.parents[parent as usize],
            ];
            if near.iter().all(|&node| !touched[node as usize]) {
                near.iter().for_each(|&node| touched[node as usize] = true);
                self.apply(m);
            }
        }
    }

    /// The best place for a subtree; without gain if that is where it is.
    fn search(&self, node: u32, stack: &mut Vec<(f32, u32)>) -> Move {
        let mut best = Move { gain: 0.0, node, to: NONE };
        let parent = self.parents[node as usize];
        if parent == ROOT {
            return best;
        }
        let bounds = self.bounds[node as usize];
        let area = bounds.half_area();
        // What is saved above the pivot, whose box without the subtree is `rest`.
        let (mut pivot, mut side, mut saved) = (parent, self.sibling(node), self.area(parent));
        let mut rest = self.bounds[side as usize];
        let mut visits = 0;
        loop {
            stack.push((saved, side));
            while let Some((limit, at)) = stack.pop() {
                // The new parent is no smaller than the subtree.
                let promising = limit - area > best.gain;
                if !promising || visits > MAX_VISITS {
                    continue;
                }
                visits += 1;
                let gain = limit - self.bounds[at as usize].union(&bounds).half_area();
                if gain > best.gain && at != parent && !(pivot == parent && at == side) {
                    best = Move { gain, to: at, ..best };
                }
                let [a, b] = self.children[at as usize];
                if a != NONE {
                    let limit = gain + self.area(at);
                    stack.extend([(limit, b), (limit, a)]);
                }
            }
            if pivot != parent {
                rest = rest.union(&self.bounds[side as usize]);
                saved += self.area(pivot) - rest.half_area();
            }
            if pivot == ROOT {
                return best;
            }
            // Right above the pivot the new parent is as large as the pivot was.
            let gain = saved - self.area(pivot);
            if gain > best.gain {
                best = Move { gain, to: pivot, ..best };
            }
            side = self.sibling(pivot);
            pivot = self.parents[pivot as usize];
        }
    }

    fn apply(&mut self, m: &Move) {
        let (parent, sibling) = (self.parents[m.node as usize], self.sibling(m.node));
        let grandparent = self.parents[parent as usize];
        self.replace(grandparent, parent, sibling);
        self.refit(grandparent);
        let above = self.parents[m.to as usize];
        self.replace(above, m.to, parent);
        self.children[parent as usize] = [m.node, m.to];
        self.parents[m.to as usize] = parent;
        self.refit(parent);
    }

    /// Makes `new` the child of `parent` that `old` was.
    fn replace(&mut self, parent: u32, old: u32, new: u32) {
        let children = &mut self.children[parent as usize];
        children[usize::from(children[1] == old)] = new;
        self.parents[new as usize] = parent;
    }

    /// Boxes of an inner node and those above it.
    fn refit(&mut self, mut node: u32) {
        loop {
            let [a, b] = self.children[node as usize];
            self.bounds[node as usize] = self.bounds[a as usize].union(&self.bounds[b as usize]);
            if node == ROOT {
                return;
            }
            node = self.parents[node as usize];
        }
    }

    /// The depth-first array, larger children first.
    fn flatten(mut self, ids: &[u32], config: &binned::Config) -> Tree {
        let mut order = Vec::with_capacity(self.parents.len());
        let mut stack = vec![ROOT];
        while let Some(node) = stack.pop() {
            order.push(node);
            let [a, b] = self.children[node as usize];
            if a != NONE {
                let both = if self.area(b) > self.area(a) { [b, a] } else { [a, b] };
                self.children[node as usize] = both;
                stack.extend([both[1], both[0]]);
            }
        }
        let counts = self.leaves(&order, config);
        let mut tree = Tree { nodes: Vec::with_capacity(order.len()), ids: Vec::with_capacity(ids.len()) };
        // Inner nodes above: where they are in the array, and how many triangles there are when they end.
        let mut open: Vec<(usize, usize)> = Vec::new();
        let mut in_leaf = 0;
        for &node in &order {
            let bounds = self.bounds[node as usize].aabb();
            let (count, is_leaf) = counts[node as usize];
            let (at, first) = (tree.nodes.len(), tree.ids.len());
            if in_leaf == 0 {
                if is_leaf {
                    tree.nodes.push(Node::leaf(&bounds, at as u32 + 1, first as u32, count));
                    in_leaf = count;
                } else {
                    tree.nodes.push(Node::inner(&bounds, 0));
                    open.push((at, first + count as usize));
                }
            }
            if let [NONE, triangle] = self.children[node as usize] {
                tree.ids.push(ids[triangle as usize]);
                in_leaf -= 1;
            }
            while let Some(&(at, _)) = open.last().filter(|&&(_, end)| end == tree.ids.len()) {
                tree.nodes[at] = tree.nodes[at].with_skip(tree.nodes.len() as u32);
                open.pop();
            }
        }
        tree.nodes.shrink_to_fit();
        tree
    }

    /// Number of triangles below each node, and whether it shall be a leaf. `order` has parents before their children.
    fn leaves(&self, order: &[u32], config: &binned::Config) -> Vec<(u32, bool)> {
        let max_leaf = config.max_leaf.clamp(1, Node::MAX_LEAF);
        let mut counts = vec![(1, true); order.len()];
        let mut costs = vec![0.0; order.len()];
        for &node in order.iter().rev() {
            let i = node as usize;
            let area = self.area(node);
            costs[i] = area;
            if self.is_leaf(node) {
                continue;
            }
            let [a, b] = self.children[i].map(|child| child as usize);
            let count = counts[a].0 + counts[b].0;
            let (as_leaf, as_node) = (area * count as f32, 2.0 * config.traversal_cost * area + costs[a] + costs[b]);
            // Costs may be NaN, of coordinates so large that areas overflow.
            let is_worth_it = as_node < as_leaf;
            let is_leaf = count <= max_leaf && !is_worth_it;
            costs[i] = if is_leaf { as_leaf } else { as_node };
            counts[i] = (count, is_leaf);
        }
        counts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;
    use crate::progress::Silent;

    fn cube(x: f32, size: f32) -> Aabb {
        Aabb { min: [x, 0.0, 0.0], max: [x + size, size, size] }
    }

    /// Two far pairs of cubes, one of each pair with one of the other.
    fn mixed_up() -> Links {
        let cubes = [0.0, 100.0, 1.5, 101.5].map(|x| cube(x, 1.0));
        let pairs = [cubes[0].union(&cubes[1]), cubes[2].union(&cubes[3])];
        let leaf = |i: usize, place: u32| Node::leaf(&cubes[i], place + 1, i as u32, 1);
        let root = Node::inner(&pairs[0].union(&pairs[1]), 7);
        let inner = [Node::inner(&pairs[0], 4), Node::inner(&pairs[1], 7)];
        Links::new(&[root, inner[0], leaf(0, 2), leaf(1, 3), inner[1], leaf(2, 5), leaf(3, 6)])
    }

    #[test]
    fn near_ones_are_brought_together() {
        let mut links = mixed_up();
        let before = links.area(1) + links.area(4);
        (0..4).for_each(|round| links.improve(round, 1));
        let config = binned::Config { max_leaf: 1, ..Default::default() };
        let tree = links.flatten(&[10, 11, 12, 13], &config);
        let inner: Vec<Aabb> = tree.nodes.iter().filter(|n| n.triangles().1 == 0).map(Node::bounds).collect();
        assert_eq!(inner.len(), 3);
        let pairs = [cube(0.0, 1.0).union(&cube(1.5, 1.0)), cube(100.0, 1.0).union(&cube(101.5, 1.0))];
        assert!(inner[1..].iter().all(|b| pairs.contains(b)), "{inner:?}");
        assert!(inner[1].half_area() + inner[2].half_area() < 0.1 * before);
        let mut ids = tree.ids;
        ids.sort_unstable();
        assert_eq!(ids, [10, 11, 12, 13]);
    }

    /// The best of all places for every subtree, tried one by one, saves what the search says.
    #[test]
    fn the_search_finds_the_best_place() {
        let mut state = 7_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as f32 / 16.0
        };
        let boxes = (0..24).map(|id| {
            let [a, b] = [0, 1].map(|_| [random(), random(), random()]);
            Primitive::new(&Aabb::of_points([a, b.map(|x| x * 0.1 + a[0])]), id)
        });
        let single = binned::Config { max_leaf: 1, ..Default::default() };
        let tree = binned::build(boxes.collect(), &single, &Silent).expect("not cancelled");
        let total = |links: &Links| (0..links.parents.len() as u32).map(|n| f64::from(links.area(n))).sum::<f64>();
        let below = |links: &Links, mut node: u32, above: u32| {
            while node != ROOT && node != above {
                node = links.parents[node as usize];
            }
            node == above
        };
        let nodes = tree.nodes.len() as u32;
        let mut improvable = 0;
        for node in 1..nodes {
            let links = Links::new(&tree.nodes);
            if links.parents[node as usize] == ROOT {
                continue;
            }
            let found = links.search(node, &mut Vec::new());
            let before = total(&links);
            let place = |&to: &u32| !below(&links, to, node) && to != links.parents[node as usize] && to != ROOT;
            let gains = (1..nodes).filter(place).map(|to| {
                let mut moved = Links::new(&tree.nodes);
                moved.apply(&Move { gain: 0.0, node, to });
                before - total(&moved)
            });
            let best = gains.fold(0.0, f64::max);
            assert!((f64::from(found.gain) - best).abs() < 1e-2 * before.sqrt(), "{node}: {} {best}", found.gain);
            improvable += u32::from(best > 0.0);
        }
        assert!(improvable > 5, "{improvable}");
    }
}
