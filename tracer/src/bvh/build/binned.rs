//! The surface area heuristic over bins, top down (Wald 2007, "On fast construction of SAH-based bounding volume hierarchies"), on all
//! three axes, and over all primitives where few are left.

use super::bins::{Binning, Bins};
use super::part::Part;
use super::primitive::{Box8, Primitive, centers, union};
use super::sah::Split;
use super::sweep::{self, Sweep};
use super::{MAX_DEPTH, PIECE, Tree};
use crate::Error;
use crate::bvh::Node;
use crate::progress::Progress;
use simd::Level;

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
        Self { max_leaf: Node::MAX_LEAF, traversal_cost: 1.0, child_order: ChildOrder::LargerFirst }
    }
}

/// Order of the two children of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChildOrder {
    /// The one with the larger surface area first (Geimer & Müller 2003, section 3.3): more likely to be hit, so that
    /// the second is visited with a shorter ray.
    LargerFirst,
    /// The one on the lower side of the split plane first.
    LowerFirst,
}

pub(super) fn build(mut primitives: Vec<Primitive>, config: &Config, progress: &dyn Progress) -> Result<Tree, Error> {
    let mut ids = vec![0; primitives.len()];
    let mut scratch = simd::vec_in_huge_pages(primitives.len());
    scratch.extend_from_slice(&primitives);
    let bounds = union(&primitives);
    let range = Range { src: &mut primitives, dst: &mut scratch, ids: &mut ids, first: 0, depth: 0, bounds };
    let config = Config { max_leaf: config.max_leaf.clamp(1, Node::MAX_LEAF), ..*config };
    let top = Builder { level: Level::best(), config, progress }.top(range)?;
    // Before the nodes are put together, which takes as much.
    drop((primitives, scratch));
    Ok(Tree { nodes: top.into_nodes(), ids })
}

/// The primitives of a subtree to be built.
struct Range<'a> {
    src: &'a mut [Primitive],
    /// As long as `src`: room to move them to.
    dst: &'a mut [Primitive],
    /// Where leaves write their triangles' ids.
    ids: &'a mut [u32],
    /// Place of `ids` in the whole array.
    first: usize,
    depth: u32,
    bounds: Box8,
}

impl<'a> Range<'a> {
    /// The same after all primitives were moved to `dst`.
    fn moved(self) -> Self {
        let Self { src, dst, .. } = self;
        Self { src: dst, dst: src, ..self }
    }

    /// The first `n` primitives and the rest, with their boxes.
    fn split_at(self, n: usize, [a, b]: [Box8; 2]) -> [Self; 2] {
        let depth = self.depth + 1;
        let (src, dst, ids) = (self.src.split_at_mut(n), self.dst.split_at_mut(n), self.ids.split_at_mut(n));
        [
            Self { src: src.0, dst: dst.0, ids: ids.0, first: self.first, depth, bounds: a },
            Self { src: src.1, dst: dst.1, ids: ids.1, first: self.first + n, depth, bounds: b },
        ]
    }
}

/// How to split a range.
enum Plan<'a> {
    Bins(Binning<'a>, Split),
    Order(Sweep),
    /// No plane between bins or centers has primitives on both sides, or all cost more than numbers can tell.
    Halves,
}

impl<'a> Plan<'a> {
    fn new(level: Level, primitives: &[Primitive], bins: &'a mut Bins) -> Self {
        if primitives.len() <= sweep::MAX {
            return sweep::best(level, primitives).map_or(Self::Halves, Self::Order);
        }
        let binning = Binning::new(level, primitives, bins);
        match binning.best {
            Some(split) => Self::Bins(binning, split),
            None => Self::Halves,
        }
    }

    fn cost(&self) -> f32 {
        match self {
            Self::Bins(_, split) | Self::Order(Sweep { split, .. }) => split.cost,
            Self::Halves => f32::INFINITY,
        }
    }
}

struct Builder<'a> {
    /// The tree does not depend on it.
    level: Level,
    config: Config,
    progress: &'a dyn Progress,
}

impl Builder<'_> {
    /// Builds large subtrees in parallel, smaller ones each in one piece.
    fn top(&self, mut range: Range) -> Result<Part, Error> {
        let mut bins = Bins::EMPTY;
        if range.src.len() > PIECE {
            let bounds = range.bounds.aabb();
            match self.split(range, &mut bins) {
                Ok([a, b]) => {
                    let (a, b) = rayon::join(|| self.top(a), || self.top(b));
                    let (a, b) = (a?, b?);
                    return Ok(Part::inner(&bounds, a, b));
                }
                Err(leaf) => range = leaf,
            }
        }
        self.progress.check()?;
        let n = range.src.len();
        let mut nodes = Vec::with_capacity(n);
        self.subtree(range, &mut nodes, &mut bins);
        self.progress.advance(n as u64);
        Ok(Part::Subtree(nodes))
    }

    /// Appends the nodes of a subtree. Recursion is no deeper than [`MAX_DEPTH`].
    fn subtree(&self, range: Range, nodes: &mut Vec<Node>, bins: &mut Bins) {
        let (at, bounds) = (nodes.len(), range.bounds.aabb());
        nodes.push(Node::inner(&bounds, 0));
        match self.split(range, bins) {
            Ok([a, b]) => {
                self.subtree(a, nodes, bins);
                self.subtree(b, nodes, bins);
                nodes[at] = nodes[at].with_skip(nodes.len() as u32);
            }
            Err(leaf) => {
                nodes[at] = Node::leaf(&bounds, at as u32 + 1, leaf.first as u32, leaf.src.len() as u32);
                leaf.ids.iter_mut().zip(leaf.src).for_each(|(id, p)| *id = p.id());
            }
        }
    }

    /// The children of an inner node, or the range itself when it shall be a leaf.
    fn split<'a>(&self, range: Range<'a>, bins: &mut Bins) -> Result<[Range<'a>; 2], Range<'a>> {
        let n = range.src.len();
        let area = range.bounds.half_area();
        // What a split costs beside its two sides, and what a leaf costs.
        let (as_node, as_leaf) = (2.0 * self.config.traversal_cost * area, area * n as f32);
        if n <= self.config.max_leaf as usize {
            // No sides cost less than their primitives one by one. Costs may be NaN, of coordinates so large that areas overflow.
            let least: f32 = range.src.iter().map(|p| p.0.half_area()).sum();
            let may_be_worth_it = least + as_node < as_leaf;
            if !may_be_worth_it {
                return Err(range);
            }
        }
        let plan = Plan::new(self.level, range.src, bins);
        if n <= self.config.max_leaf as usize {
            let is_worth_it = plan.cost() + as_node < as_leaf;
            if !is_worth_it {
                return Err(range);
            }
        }
        let balanced_levels = usize::BITS - (n - 1).leading_zeros();
        Ok(match plan {
            _ if range.depth + balanced_levels >= MAX_DEPTH => self.split_in_halves(range),
            Plan::Bins(binning, split) => self.split_by_bins(range, &split, &binning),
            Plan::Order(sweep) => self.split_by_rank(range, &sweep),
            Plan::Halves => self.split_in_halves(range),
        })
    }

    fn split_by_bins<'a>(&self, range: Range<'a>, split: &Split, binning: &Binning) -> [Range<'a>; 2] {
        let mut n = binning.count_below(split);
        let mut sides = binning.sides(split);
        if self.shall_swap(&sides) {
            sides.swap(0, 1);
            n = range.src.len() - n;
            let (above, below) = range.dst.split_at_mut(n);
            binning.scatter(split, range.src, below, above);
        } else {
            let (below, above) = range.dst.split_at_mut(n);
            binning.scatter(split, range.src, below, above);
        }
        range.moved().split_at(n, sides)
    }

    fn split_by_rank<'a>(&self, range: Range<'a>, sweep: &Sweep) -> [Range<'a>; 2] {
        for (p, rank) in range.src.iter().zip(sweep.ranks) {
            range.dst[rank as usize] = *p;
        }
        self.split_at(range.moved(), sweep.split.below)
    }

    /// By the centers along the axis on which they extend most.
    fn split_in_halves<'a>(&self, range: Range<'a>) -> [Range<'a>; 2] {
        let centers = centers(range.src);
        let axis = (1..3).fold(0, |a, b| if centers.extent(b) > centers.extent(a) { b } else { a });
        let n = range.src.len() / 2;
        range.src.select_nth_unstable_by(n, |a, b| a.center(axis).total_cmp(&b.center(axis)).then(a.id().cmp(&b.id())));
        self.split_at(range, n)
    }

    /// The first `n` primitives and the rest as children, in the configured order.
    fn split_at<'a>(&self, range: Range<'a>, n: usize) -> [Range<'a>; 2] {
        let (below, above) = range.src.split_at(n);
        let sides @ [b, a] = [union(below), union(above)];
        if self.shall_swap(&sides) {
            range.src.rotate_left(n);
            let rest = range.src.len() - n;
            return range.split_at(rest, [a, b]);
        }
        range.split_at(n, sides)
    }

    /// Whether the upper side shall be the first child.
    fn shall_swap(&self, [below, above]: &[Box8; 2]) -> bool {
        self.config.child_order == ChildOrder::LargerFirst && above.half_area() > below.half_area()
    }
}
