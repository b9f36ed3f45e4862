//! Binned surface area heuristic, top down (Wald 2007, "On fast construction of SAH-based bounding volume hierarchies").

use super::{Tree, sweep};
use super::bins::{Bins, Grid, Split};
use super::primitive::{Box4, Primitive};
use crate::Error;
use crate::bvh::Node;
use crate::progress::Progress;
use rayon::prelude::*;

/// Knobs of the binned builder.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Config {
    /// Most triangles in a leaf: 1 to [`Node::MAX_LEAF`] (other values are clamped).
    pub max_leaf: u32,
    /// Cost of a box test, when that of a triangle test is 1. The higher, the larger the leaves.
    pub traversal_cost: f32,
    /// Which child is stored, and without ordered traversal visited, first.
    pub child_order: ChildOrder,
}

impl Default for Config {
    fn default() -> Self {
        Self { max_leaf: 8, traversal_cost: 1.0, child_order: ChildOrder::LargerFirst }
    }
}

/// Order of the two children of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChildOrder {
    /// The one with the larger surface area first (Geimer & Müller 2003, section 3.3): more likely to be hit, so that the
    /// second is visited with a shorter ray.
    LargerFirst,
    /// The one on the lower side of the split plane first.
    LowerFirst,
}

/// No leaf is deeper (the root is at depth 0): when only balanced splits still fit, splits are balanced.
pub const MAX_DEPTH: u32 = 64;

/// Subtrees of at most this many primitives are built by one thread into one array.
const SUBTREE: usize = 8192;
/// Primitives that one thread bins or scatters at a time above that. Both are constants, so that the tree is the same for any number of threads.
const CHUNK: usize = 16384;

pub(super) fn build(mut primitives: Vec<Primitive>, config: &Config, progress: &dyn Progress) -> Result<Tree, Error> {
    let n = primitives.len();
    let mut ids = vec![0; n];
    let mut scratch = primitives.clone();
    let [bounds, centers] = extents(&primitives);
    let range = Range { src: &mut primitives, dst: &mut scratch, ids: &mut ids, first: 0, depth: 0, bounds, centers };
    let config = Config { max_leaf: config.max_leaf.clamp(1, Node::MAX_LEAF), ..*config };
    let t = std::time::Instant::now();
    let top = Builder { config, progress }.top(range)?;
    eprintln!("  tree {:?}", t.elapsed());
    let mut nodes = Vec::with_capacity(top.len());
    top.flatten(&mut nodes);
    eprintln!("  flat {:?}", t.elapsed());
    Ok(Tree { nodes, ids })
}

/// Part of a tree; skip pointers count from the part's first node.
enum Part {
    Subtree(Vec<Node>),
    Inner(Node, Box<[Part; 2]>),
}

impl Part {
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

/// Primitives of which a subtree is to be built.
struct Range<'a> {
    src: &'a mut [Primitive],
    /// As long as `src`; where the children will find theirs.
    dst: &'a mut [Primitive],
    /// Where leaves write their triangles' ids.
    ids: &'a mut [u32],
    /// Place of `ids` in the whole array.
    first: usize,
    depth: u32,
    bounds: Box4,
    /// The box of the centers.
    centers: Box4,
}

impl<'a> Range<'a> {
    /// The children: the first `n` primitives and the rest, each side with its box and that of its centers.
    fn children(self, n: usize, sides: [[Box4; 2]; 2]) -> [Self; 2] {
        let depth = self.depth + 1;
        let (src, dst, ids) = (self.src.split_at_mut(n), self.dst.split_at_mut(n), self.ids.split_at_mut(n));
        let [[bounds, centers], b] = sides;
        [
            Self { src: src.0, dst: dst.0, ids: ids.0, first: self.first, depth, bounds, centers },
            Self { src: src.1, dst: dst.1, ids: ids.1, first: self.first + n, depth, bounds: b[0], centers: b[1] },
        ]
    }

    fn write_ids(self) {
        for (id, p) in self.ids.iter_mut().zip(self.src) {
            *id = p.id();
        }
    }
}

struct Builder<'a> {
    config: Config,
    progress: &'a dyn Progress,
}

impl Builder<'_> {
    /// Builds large subtrees in parallel, smaller ones each in one piece.
    fn top(&self, mut range: Range) -> Result<Part, Error> {
        let n = range.src.len();
        if n > SUBTREE {
            let bounds = range.bounds.aabb();
            match self.split(range) {
                Err(leaf) => range = leaf,
                Ok([a, b]) => {
                    let (a, b) = rayon::join(|| self.top(a), || self.top(b));
                    let (a, b) = (a?, b?);
                    let node = Node::inner(&bounds, (1 + a.len() + b.len()) as u32);
                    return Ok(Part::Inner(node, Box::new([a, b])));
                }
            }
        }
        self.progress.check()?;
        let mut nodes = Vec::with_capacity(n);
        self.subtree(range, &mut nodes);
        self.progress.advance(n as u64);
        Ok(Part::Subtree(nodes))
    }

    fn subtree(&self, range: Range, nodes: &mut Vec<Node>) {
        let (at, bounds) = (nodes.len(), range.bounds.aabb());
        nodes.push(Node::inner(&bounds, 0));
        match self.split(range) {
            Ok(children) => {
                children.into_iter().for_each(|c| self.subtree(c, nodes));
                nodes[at] = nodes[at].with_skip(nodes.len() as u32);
            }
            Err(leaf) => {
                nodes[at] = Node::leaf(&bounds, at as u32 + 1, leaf.first as u32, leaf.src.len() as u32);
                leaf.write_ids();
            }
        }
    }

    /// The two children of an inner node, or back the range that is to be a leaf.
    fn split<'a>(&self, range: Range<'a>) -> Result<[Range<'a>; 2], Range<'a>> {
        let n = range.src.len();
        if n == 1 {
            return Err(range);
        }
        if n <= sweep::MAX {
            return self.small(range);
        }
        let grid = Grid::new(&range.centers);
        let mut bins = Bins::EMPTY;
        let mut chunks = Vec::new();
        if n > SUBTREE {
            chunks = range.src.par_chunks(CHUNK).map(|c| { let mut b = Bins::EMPTY; b.add(c, &grid); b }).collect();
            chunks.iter().for_each(|b| bins.merge(b));
        } else {
            bins.add(range.src, &grid);
        }
        let split = bins.best();
        let area = range.bounds.half_area();
        let cost = 2.0 * self.config.traversal_cost * area + split.as_ref().map_or(f32::INFINITY, |s| s.cost);
        if n <= self.config.max_leaf as usize && !(cost < area * n as f32) {
            return Err(range);
        }
        let balanced_levels = usize::BITS - (n - 1).leading_zeros();
        Ok(match split {
            Some(split) if range.depth + balanced_levels < MAX_DEPTH => self.partition(range, &split, &grid, &bins, &chunks),
            _ => self.halve(range),
        })
    }

    fn small<'a>(&self, range: Range<'a>) -> Result<[Range<'a>; 2], Range<'a>> {
        let n = range.src.len();
        let split = sweep::best(range.src);
        let area = range.bounds.half_area();
        let cost = 2.0 * self.config.traversal_cost * area + split.cost;
        if n <= self.config.max_leaf as usize && !(cost < area * n as f32) {
            return Err(range);
        }
        if split.cost == f32::INFINITY {
            return Ok(self.halve(range));
        }
        let flip = self.config.child_order == ChildOrder::LargerFirst && split.sides[1].half_area() > split.sides[0].half_area();
        let [mut a, mut b] = split.sides;
        let mut k = split.lower;
        for (p, rank) in range.src.iter().zip(split.ranks) {
            let at = if flip { n - 1 - rank } else { rank };
            range.dst[at] = *p;
        }
        if flip {
            std::mem::swap(&mut a, &mut b);
            k = n - k;
        }
        let Range { src, dst, .. } = range;
        Ok(Range { src: dst, dst: src, ..range }.children(k, [[a, Box4::EMPTY], [b, Box4::EMPTY]]))
    }

    fn partition<'a>(&self, range: Range<'a>, split: &Split, grid: &Grid, bins: &Bins, chunks: &[Bins]) -> [Range<'a>; 2] {
        let mut sides = bins.sides(split);
        let flip = self.config.child_order == ChildOrder::LargerFirst && sides[1].1.half_area() > sides[0].1.half_area();
        if flip {
            sides.swap(0, 1);
        }
        let [(n, a), (_, b)] = sides;
        let is_first = |p: &Primitive| (grid.bins(p.center())[split.axis] < split.bin) != flip;
        let (mut first, mut second) = range.dst.split_at_mut(n);
        let centers = if chunks.is_empty() {
            scatter(range.src, first, second, is_first)
        } else {
            let mut parts = Vec::new();
            for (src, bins) in range.src.chunks(CHUNK).zip(chunks) {
                let n = bins.sides(split)[usize::from(flip)].0;
                let (f, s) = (first.split_off_mut(..n), second.split_off_mut(..src.len() - n));
                parts.push((src, f.unwrap_or_default(), s.unwrap_or_default()));
            }
            let centers: Vec<_> = parts.into_par_iter().map(|(src, f, s)| scatter(src, f, s, is_first)).collect();
            centers.iter().fold([Box4::EMPTY; 2], |[a, b], c| [a.union(&c[0]), b.union(&c[1])])
        };
        let Range { src, dst, .. } = range;
        Range { src: dst, dst: src, ..range }.children(n, [[a, centers[0]], [b, centers[1]]])
    }

    /// Splits in two equal halves by the centers along the widest axis.
    fn halve<'a>(&self, range: Range<'a>) -> [Range<'a>; 2] {
        let extent = |i: usize| range.centers.max[i] - range.centers.min[i];
        let axis = (1..3).fold(0, |a, b| if extent(b) > extent(a) { b } else { a });
        let mut n = range.src.len() / 2;
        let key = |p: &Primitive| (p.center()[axis], p.id());
        range.src.select_nth_unstable_by(n, |a, b| {
            let (a, b) = (key(a), key(b));
            a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
        });
        let (a, b) = range.src.split_at(n);
        let mut sides = [extents(a), extents(b)];
        if self.config.child_order == ChildOrder::LargerFirst && sides[1][0].half_area() > sides[0][0].half_area() {
            range.src.rotate_left(n);
            sides.swap(0, 1);
            n = range.src.len() - n;
        }
        range.children(n, sides)
    }
}

/// The box of the primitives and that of their centers.
fn extents(primitives: &[Primitive]) -> [Box4; 2] {
    primitives.iter().fold([Box4::EMPTY; 2], |[b, c], p| {
        let center = p.center();
        [b.union(&p.0), c.union(&Box4 { min: center, max: center })]
    })
}

/// Moves each primitive to one of two places, which it fills; returns the boxes of the centers there.
#[inline(always)]
fn scatter(src: &[Primitive], first: &mut [Primitive], second: &mut [Primitive], is_first: impl Fn(&Primitive) -> bool) -> [Box4; 2] {
    let mut centers = [Box4::EMPTY; 2];
    let (mut a, mut b) = (0, 0);
    for p in src {
        // Writing to both and keeping one needs no branch, which would be mispredicted half of the time.
        let is_first = is_first(p);
        if let Some(to) = first.get_mut(a) {
            *to = *p;
        }
        if let Some(to) = second.get_mut(b) {
            *to = *p;
        }
        a += usize::from(is_first);
        b += usize::from(!is_first);
        centers[usize::from(!is_first)].grow(p.center());
    }
    centers
}
