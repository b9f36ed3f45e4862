//! Along a space-filling curve (Lauterbach, Garland, Sengupta, Luebke and Manocha 2009, "Fast BVH construction on GPUs"): centers are
//! sorted by their Morton codes, those of large triangles apart, and each range of them is split where the highest bit changes that
//! is not the same in all. The fastest of the builders, most often with the worst trees.

use super::part::Part;
use super::primitive::{Box8, Primitive, centers};
use super::{MAX_DEPTH, PIECE, Tree};
use crate::Error;
use crate::bvh::Node;
use crate::progress::Progress;
use rayon::prelude::*;

/// Knobs of the linear builder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Config {
    /// Most triangles in a leaf: 1 to [`Node::MAX_LEAF`] (other values are clamped).
    pub max_leaf: u32,
    /// Cost of a box test, when that of a triangle test is 1: subtrees of at most `max_leaf` triangles become a leaf where that
    /// costs less by the surface area heuristic.
    pub traversal_cost: f32,
}

impl Default for Config {
    fn default() -> Self {
        Self { max_leaf: Node::MAX_LEAF, traversal_cost: 1.0 }
    }
}

/// Bits of a code on each axis.
const BITS: u32 = 21;

/// Triangles of this part of the scene's size and larger (floors, walls) get a subtree of their own next to the root, by the highest
/// bit of their codes (after Vinkler, Bittner and Havran 2017, "Extended Morton codes for high performance bounding volume hierarchy
/// construction"). Among small ones each would enlarge all boxes on the way down to it: without this the cost of balls is
/// 3.6 times as high, that of conference 1.27 times.
const LARGE: f32 = 0.25;

pub(super) fn build(primitives: Vec<Primitive>, config: &Config, progress: &dyn Progress) -> Result<Tree, Error> {
    let config = Config { max_leaf: config.max_leaf.clamp(1, Node::MAX_LEAF), ..*config };
    let keys = keys(&primitives);
    progress.check()?;
    let mut sorted = simd::vec_in_huge_pages(primitives.len());
    keys.par_iter().map(|&(_, i)| primitives[i as usize]).collect_into_vec(&mut sorted);
    drop(primitives);
    let builder = Builder { primitives: &sorted, keys: &keys, config, progress };
    let (top, _) = builder.top(Range { first: 0, end: sorted.len(), depth: 0 })?;
    let ids = sorted.par_iter().map(Primitive::id).collect();
    // Before the nodes are put together, which takes as much.
    drop((sorted, keys));
    Ok(Tree { nodes: top.into_nodes(), ids })
}

/// Codes of the centers and places of the primitives, sorted: equal codes by their place.
fn keys(primitives: &[Primitive]) -> Vec<(u64, u32)> {
    let all = primitives.par_chunks(PIECE).map(centers).reduce(|| Box8::EMPTY, |a, b| a.union(&b));
    // The same scale on all axes, so that cells are cubes and long sides are halved first.
    let extent = (0..3).map(|axis| all.extent(axis)).fold(0.0, f32::max);
    let scale = ((1 << BITS) as f32 - 1.0) / extent;
    let code = |p: &Primitive| {
        // Twice as large as the triangle, as centers are.
        let size = 2.0 * (0..3).map(|axis| p.0.extent(axis)).fold(0.0, f32::max);
        let is_small = size < LARGE * extent;
        let mut code = u64::from(is_small) << (3 * BITS);
        for axis in 0..3 {
            // Where centers have no extent, or not a finite one, this is NaN or 0, which become 0.
            code |= spread(((p.center(axis) - all.0[axis]) * scale) as u32) << (2 - axis);
        }
        code
    };
    let mut keys = simd::vec_in_huge_pages(primitives.len());
    primitives.par_iter().enumerate().map(|(i, p)| (code(p), i as u32)).collect_into_vec(&mut keys);
    keys.par_sort_unstable();
    keys
}

/// The lowest 21 bits, each followed by two zeros.
fn spread(x: u32) -> u64 {
    let mut x = u64::from(x & ((1 << BITS) - 1));
    for (shift, mask) in [
        (32, 0x001f_0000_0000_ffff),
        (16, 0x001f_0000_ff00_00ff),
        (8, 0x100f_00f0_0f00_f00f),
        (4, 0x10c3_0c30_c30c_30c3),
        (2, 0x1249_2492_4924_9249),
    ] {
        x = (x | x << shift) & mask;
    }
    x
}

/// Sorted primitives of a subtree.
#[derive(Clone, Copy)]
struct Range {
    first: usize,
    end: usize,
    depth: u32,
}

impl Range {
    fn len(self) -> usize {
        self.end - self.first
    }
}

/// What a subtree adds to its parents: its box, and its cost times half the area of the root.
type Summary = (Box8, f32);

struct Builder<'a> {
    primitives: &'a [Primitive],
    keys: &'a [(u64, u32)],
    config: Config,
    progress: &'a dyn Progress,
}

impl Builder<'_> {
    /// Builds large subtrees in parallel, smaller ones each in one piece.
    fn top(&self, range: Range) -> Result<(Part, Summary), Error> {
        if range.len() > PIECE {
            let [a, b] = self.split(range);
            let (a, b) = rayon::join(|| self.top(a), || self.top(b));
            let ((a, (a_box, a_cost)), (b, (b_box, b_cost))) = (a?, b?);
            let bounds = a_box.union(&b_box);
            return Ok((Part::inner(&bounds.aabb(), a, b), (bounds, a_cost + b_cost)));
        }
        self.progress.check()?;
        let mut nodes = Vec::with_capacity(range.len());
        let summary = self.subtree(range, &mut nodes);
        self.progress.advance(range.len() as u64);
        Ok((Part::Subtree(nodes), summary))
    }

    /// Appends the nodes of a subtree. Recursion is no deeper than [`MAX_DEPTH`].
    fn subtree(&self, range: Range, nodes: &mut Vec<Node>) -> Summary {
        let (at, n) = (nodes.len(), range.len());
        if n == 1 {
            let bounds = self.primitives[range.first].0;
            nodes.push(Node::leaf(&bounds.aabb(), at as u32 + 1, range.first as u32, 1));
            return (bounds, bounds.half_area());
        }
        nodes.push(Node::inner(&Box8::EMPTY.aabb(), 0));
        let [a, b] = self.split(range);
        let (a_box, a_cost) = self.subtree(a, nodes);
        let (b_box, b_cost) = self.subtree(b, nodes);
        let bounds = a_box.union(&b_box);
        let area = bounds.half_area();
        let (as_leaf, as_node) = (area * n as f32, 2.0 * self.config.traversal_cost * area + a_cost + b_cost);
        // Costs may be NaN, of coordinates so large that areas overflow.
        let is_worth_it = as_node < as_leaf;
        if n <= self.config.max_leaf as usize && !is_worth_it {
            nodes.truncate(at);
            nodes.push(Node::leaf(&bounds.aabb(), at as u32 + 1, range.first as u32, n as u32));
            return (bounds, as_leaf);
        }
        nodes[at] = Node::inner(&bounds.aabb(), nodes.len() as u32);
        (bounds, as_node)
    }

    /// Where the highest bit changes; in the middle where all codes are equal, or else the tree could get too deep.
    fn split(&self, range: Range) -> [Range; 2] {
        let Range { first, end, depth } = range;
        let balanced_levels = usize::BITS - (range.len() - 1).leading_zeros();
        let differing = self.keys[first].0 ^ self.keys[end - 1].0;
        let middle = if differing == 0 || depth + balanced_levels >= MAX_DEPTH {
            first + range.len() / 2
        } else {
            let bit = 1 << differing.ilog2();
            first + self.keys[first..end].partition_point(|(code, _)| code & bit == 0)
        };
        [Range { first, end: middle, depth: depth + 1 }, Range { first: middle, end, depth: depth + 1 }]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_triangles_come_first() {
        use crate::geometry::Aabb;
        let small = |id: u32| Aabb { min: [id as f32; 3], max: [id as f32 + 1.0; 3] };
        let mut primitives: Vec<_> = (0..9).map(|id| Primitive::new(&small(id), id)).collect();
        primitives.push(Primitive::new(&Aabb { min: [4.0; 3], max: [4.5, 7.0, 4.5] }, 9));
        let places: Vec<u32> = keys(&primitives).into_iter().map(|(_, place)| place).collect();
        assert_eq!(places, [9, 0, 1, 2, 3, 4, 5, 6, 7, 8]);
    }

    #[test]
    fn spreading_keeps_every_bit() {
        for bit in 0..BITS {
            assert_eq!(spread(1 << bit), 1 << (3 * bit));
        }
        assert_eq!(spread(u32::MAX), 0x1249_2492_4924_9249);
    }
}
