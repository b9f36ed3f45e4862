//! Trees for frusta: up to eight children a node, 32 bytes a node, stored breadth first (Garanzha & Loop 2010, section 3.3).

use super::collapse::in_twos;
use super::{Bvh, Node};
use crate::Error;
use crate::geometry::Aabb;
use simd::{AlignedVec, Float, Vector};
use std::borrow::Cow;

/// How a binary tree becomes an [`OctoBvh`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OctoConfig {
    /// Levels of the binary tree that become one: 1 to 3 (other values are clamped), which gives nodes of up to 2, 4 or 8 children.
    pub levels: u32,
    /// Subtrees of at most so many triangles become a leaf (by default 8, the fastest; the paper has 10); leaves of the binary tree stay leaves. At most 255.
    pub max_leaf: u32,
}

impl Default for OctoConfig {
    fn default() -> Self {
        Self { levels: 3, max_leaf: 8 }
    }
}

/// A tree of up to eight children a node. Made from a [`Bvh`], whose triangles it refers to.
///
/// ```
/// use tracer::bvh::{BuildConfig, Bvh, OctoBvh, OctoConfig};
/// use tracer::{model::Model, progress::Silent};
///
/// # fn main() -> Result<(), tracer::Error> {
/// let (model, _warnings) = Model::open("balls:1", &Silent)?;
/// let bvh = Bvh::build(&model.mesh, &BuildConfig::default(), &Silent)?;
/// let octo = OctoBvh::new(&bvh, &OctoConfig::default())?;
/// assert!(octo.len() < bvh.nodes.len());
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct OctoBvh {
    /// The nodes, the root first, the children of a node side by side; then [`OctoBvh::PADDING`] empty ones, so that eight can be read anywhere.
    rows: AlignedVec<[f32; 8]>,
    /// Levels below the root.
    depth: usize,
}

/// A node: `min, block, max, order` in eight words, 32 bytes.
///
/// The block says which nodes are its children: 24 bits for the first, 8 for their number. The order has three bits for each slot: which child is in it. Slots are
/// places in the node's box, three times halved: bit 2 of a slot says in which half across a first axis, bit 1 and bit 0 across a second and a third, which
/// bits 24 to 29 of the order name (two for each). So for a ray that goes up on all axes the children lie in the order of their slots, and for another
/// child `i` of that order is the one in slot `i ^ signs`, where `signs` has a bit for each of the three axes on which the ray goes down.
///
/// A leaf has no children. The upper 24 bits of its block are the number of its triangles, and its order is the first of them.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct OctoNode([f32; 8]);

const _: () = assert!(size_of::<OctoNode>() == 32);

impl OctoNode {
    fn new(b: &Aabb, block: u32, order: u32) -> Self {
        let bits = f32::from_bits;
        Self([b.min[0], b.min[1], b.min[2], bits(block), b.max[0], b.max[1], b.max[2], bits(order)])
    }

    #[inline(always)]
    pub(crate) fn of_row(row: &[f32; 8]) -> Self {
        Self(*row)
    }

    /// First child and number of children, which is 0 for a leaf.
    #[inline(always)]
    pub(crate) fn children(&self) -> (u32, u32) {
        let block = self.0[3].to_bits();
        (block >> 8, block & 255)
    }

    /// Which nodes are leaves, by their blocks.
    #[inline(always)]
    pub(crate) fn are_leaves<F: Float>(block: F) -> F::Mask {
        (block.to_bits() & F::Index::splat(255)).eq(F::Index::splat(0))
    }

    /// First triangle and number of triangles of a leaf.
    #[inline(always)]
    pub(crate) fn triangles(&self) -> (u32, u32) {
        (self.0[7].to_bits(), self.0[3].to_bits() >> 8)
    }

    /// The order of the children of an inner node for rays with these signs (a bit per axis, set for negative).
    #[inline(always)]
    pub(crate) fn order(&self, signs: u32) -> Order {
        let order = self.0[7].to_bits();
        let sign = |shift: u32| signs >> (order >> shift & 3) & 1;
        let signs = sign(24) << 2 | sign(26) << 1 | sign(28);
        let number = self.0[3].to_bits() & 255;
        Order { children: order & 0xff_ffff, taken: TAKEN[number as usize % 16], signs }
    }
}

/// Which child comes when: the one in slot `i ^ signs`, if that is taken.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Order {
    /// Three bits for each slot.
    pub(crate) children: u32,
    /// A bit for each slot.
    pub(crate) taken: u32,
    pub(crate) signs: u32,
}

/// Slots that are taken, by the number of children: halves, quarters and eighths are as nearly equal as can be, the lower ones larger.
const TAKEN: [u32; 16] = [
    0,
    0b0000_0001,
    0b0001_0001,
    0b0001_0101,
    0b0101_0101,
    0b0101_0111,
    0b0111_0111,
    0b0111_1111,
    0b1111_1111,
    0,
    0,
    0,
    0,
    0,
    0,
    0,
];

impl OctoBvh {
    /// Most nodes in a tree: what a block can name.
    pub const MAX_NODES: usize = 1 << 24;
    const PADDING: usize = 16;

    /// By leaving out two of three levels of a binary tree, or what the configuration says.
    ///
    /// # Errors
    /// [`Error::Geometry`] if there would be more than [`OctoBvh::MAX_NODES`].
    pub fn new(bvh: &Bvh, config: &OctoConfig) -> Result<Self, Error> {
        let nodes = in_twos(Cow::Borrowed(&bvh.nodes));
        let mut tree = Self { rows: AlignedVec::new(), depth: 0 };
        let levels = config.levels.clamp(1, 3);
        let max_leaf = config.max_leaf.min(255);
        // The nodes of a level, each the root of a subtree of the binary tree.
        let mut level: Vec<usize> = if nodes.is_empty() { Vec::new() } else { vec![0] };
        let (mut below, mut first_below) = (Vec::new(), 1);
        while !level.is_empty() {
            below.clear();
            for &root in &level {
                let triangles = triangles(&nodes, root);
                if nodes[root].triangles().1 > 0 || triangles.1 <= max_leaf {
                    let leaf = OctoNode::new(&nodes[root].bounds(), triangles.1 << 8, triangles.0);
                    tree.rows.push(leaf.0);
                    continue;
                }
                let mut children = children(&nodes, root, levels, max_leaf);
                let order = sort(&nodes, &mut children);
                let first = first_below + below.len();
                if first + children.len() > Self::MAX_NODES {
                    let message = "the tree has more than 2^24 nodes of up to eight children: use larger leaves";
                    return Err(Error::Geometry(message.into()));
                }
                let block = (first as u32) << 8 | children.len() as u32;
                tree.rows.push(OctoNode::new(&nodes[root].bounds(), block, order).0);
                below.extend(children);
            }
            std::mem::swap(&mut level, &mut below);
            tree.depth += usize::from(!level.is_empty());
            first_below += level.len();
        }
        for _ in 0..Self::PADDING {
            tree.rows.push(OctoNode::new(&Aabb::EMPTY, 0, 0).0);
        }
        Ok(tree)
    }

    /// Number of nodes, leaves among them.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows.len() - Self::PADDING
    }

    /// True when no triangle can be hit.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Levels below the root.
    #[must_use]
    pub fn depth(&self) -> usize {
        self.depth
    }

    /// Bytes of memory.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.rows.len() * size_of::<OctoNode>()
    }

    /// The box around everything; empty without triangles.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let row = &self.rows[0];
        Aabb { min: [row[0], row[1], row[2]], max: [row[4], row[5], row[6]] }
    }

    /// All nodes and the padding behind them, as their words.
    #[inline(always)]
    pub(crate) fn rows(&self) -> &[[f32; 8]] {
        &self.rows
    }
}

/// First triangle and number of triangles of a subtree.
fn triangles(nodes: &[Node], root: usize) -> (u32, u32) {
    let mut first = root;
    while nodes[first].triangles().1 == 0 {
        first += 1;
    }
    let first = nodes[first].triangles().0;
    // The last node of a subtree is a leaf.
    let last = nodes[nodes[root].skip() as usize - 1].triangles();
    (first, last.0 + last.1 - first)
}

/// The subtrees some levels below a node, or leaves above that.
fn children(nodes: &[Node], root: usize, levels: u32, max_leaf: u32) -> Vec<usize> {
    let mut open = vec![root];
    for level in 0..levels {
        let mut next = Vec::with_capacity(8);
        for &node in &open {
            let is_leaf = nodes[node].triangles().1 > 0 || triangles(nodes, node).1 <= max_leaf;
            if level > 0 && is_leaf {
                next.push(node);
            } else {
                next.extend([node + 1, nodes[node + 1].skip() as usize]);
            }
        }
        open = next;
    }
    open
}

/// Sorts children by slot, and says which those are: see [`OctoNode`].
fn sort(nodes: &[Node], children: &mut [usize]) -> u32 {
    let center = |child: usize| nodes[child].bounds().center();
    let mut slots = [0_u32; 8];
    let mut order = 0;
    // Groups of children that share the upper bits of their slots: where they begin.
    let mut groups = vec![0, children.len()];
    for bit in (0..3).rev() {
        let extent = |axis: usize| {
            let of = |group: &[usize]| {
                let (low, high) = range(group.iter().map(|&child| center(child)[axis]));
                if low < high { high - low } else { 0.0 }
            };
            groups.windows(2).map(|ends| of(&children[ends[0]..ends[1]])).sum::<f32>()
        };
        let extents = [extent(0), extent(1), extent(2)];
        let axis = (1..3).fold(0, |best, axis| if extents[axis] > extents[best] { axis } else { best });
        order |= (axis as u32) << (28 - 2 * bit);
        let mut halves = vec![0];
        for ends in groups.windows(2) {
            let group = &mut children[ends[0]..ends[1]];
            // Stable: what is equal stays as it is. The slots of a group are equal, so they need not move.
            group.sort_by(|&a, &b| center(a)[axis].total_cmp(&center(b)[axis]));
            let half = group.len().div_ceil(2);
            slots[ends[0] + half..ends[1]].iter_mut().for_each(|slot| *slot |= 1 << bit);
            halves.extend([ends[0] + half, ends[1]]);
        }
        halves.dedup();
        groups = halves;
    }
    let taken = slots.iter().take(children.len()).enumerate();
    taken.fold(order, |order, (child, slot)| order | (child as u32) << (3 * slot))
}

fn range(numbers: impl Iterator<Item = f32>) -> (f32, f32) {
    numbers.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::BuildConfig;
    use crate::bvh::build::binned;
    use crate::model::builtin;
    use crate::progress::Silent;

    fn tree(spec: &str, config: &BuildConfig) -> Bvh {
        let scene = builtin(spec).expect("a built-in scene").expect("a possible size");
        Bvh::build(&scene.mesh, config, &Silent).expect("a valid mesh")
    }

    fn bounds(row: &[f32; 8]) -> Aabb {
        Aabb { min: [row[0], row[1], row[2]], max: [row[4], row[5], row[6]] }
    }

    fn check(bvh: &Bvh, config: OctoConfig) {
        let octo = OctoBvh::new(bvh, &config).expect("few nodes");
        let mut seen = vec![0_u8; bvh.triangles.len()];
        let mut next = 1;
        for row in &octo.rows()[..octo.len()] {
            let node = OctoNode::of_row(row);
            let (first, number) = node.children();
            if number == 0 {
                let (first, number) = node.triangles();
                assert!(number > 0);
                for i in first..first + number {
                    seen[i as usize] += 1;
                    assert!(bounds(row).contains(&bvh.triangles[i as usize].bounds()));
                }
                continue;
            }
            assert!(first == next && (2..=1 << config.levels).contains(&number), "breadth first");
            next += number;
            let children = &octo.rows()[first as usize..(first + number) as usize];
            assert!(children.iter().all(|child| bounds(row).contains(&bounds(child))));
            check_order(&node, children);
        }
        assert!(seen.iter().all(|&times| times == 1), "every triangle once");
        assert_eq!(next as usize, octo.len());
    }

    /// For every octant places are different, those of the opposite octant are turned round, and along the first axis the half with lower places
    /// comes first.
    fn check_order(node: &OctoNode, children: &[[f32; 8]]) {
        let axis = (node.0[7].to_bits() >> 24 & 3) as usize;
        let places = |signs: u32| {
            let (order, mut places) = (node.order(signs), vec![8; children.len()]);
            for place in (0..8).filter(|place| order.taken >> (place ^ order.signs) & 1 != 0) {
                let child = order.children >> (3 * (place ^ order.signs)) & 7;
                assert_eq!(std::mem::replace(&mut places[child as usize], place), 8);
            }
            assert!(places.iter().all(|&place| place < 8));
            places
        };
        for signs in 0..8 {
            let (opposite, places) = (places(!signs & 7), places(signs));
            assert!(places.iter().zip(opposite).all(|(place, opposite)| opposite == 7 - place));
            let up = if signs >> axis & 1 == 0 { 1.0 } else { -1.0 };
            let half = |upper: bool| {
                let members = children.iter().zip(&places).filter(move |&(_, &place)| (place > 3) == upper);
                range(members.map(|(row, _)| up * bounds(row).center()[axis]))
            };
            assert!(half(false).1 <= half(true).0);
        }
    }

    #[test]
    fn trees_hold_what_binary_trees_hold() {
        let ten = binned::Config { max_leaf: 10, traversal_cost: 10.0, ..binned::Config::default() };
        let builders = [BuildConfig::default(), BuildConfig::Binned(ten), BuildConfig::insertion(7)];
        for builder in builders {
            let bvh = tree("tree:3", &builder);
            for levels in 1..4 {
                for max_leaf in [0, 4, 10, 255] {
                    check(&bvh, OctoConfig { levels, max_leaf });
                }
            }
        }
    }

    #[test]
    fn small_trees() {
        let mut bvh = tree("balls:1", &BuildConfig::default());
        let whole = bvh.triangles[0].bounds();
        bvh.triangles.truncate(1);
        bvh.nodes = vec![Node::leaf(&whole, 1, 0, 1)];
        check(&bvh, OctoConfig::default());
        assert_eq!(OctoBvh::new(&bvh, &OctoConfig::default()).expect("one node").depth(), 0);
        bvh.triangles.clear();
        bvh.nodes.clear();
        let octo = OctoBvh::new(&bvh, &OctoConfig::default()).expect("no nodes");
        assert!(octo.is_empty() && octo.bounds() == Aabb::EMPTY);
    }
}
