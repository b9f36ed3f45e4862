//! Wide trees: nodes of `N` children whose boxes lie side by side, for a single ray against all of them at once (Dammertz, Hanika
//! and Keller 2008; Ernst and Greiner 2008; Wald, Benthin and Boulos 2008).

use super::validate::structure;
use crate::geometry::{Aabb, Hit, TriangleGroup};

/// A tree of `N` children a node (4, 8 or 16), over groups of [`WideBvh::GROUP`] triangles. Made from a [`Bvh`](super::Bvh).
#[derive(Debug, Clone)]
pub struct WideBvh<const N: usize> {
    /// Nodes; the root first, parents before their children. Empty when no triangle can be hit.
    pub nodes: Vec<WideNode<N>>,
    /// Triangles, those of a leaf side by side.
    pub groups: Vec<TriangleGroup<{ GROUP }>>,
    /// Number of triangles.
    pub triangles: usize,
    /// Nodes on the longest way from the root to a leaf.
    pub depth: usize,
}

/// Triangles in a group. Four suit every level: leaves are small.
pub(super) const GROUP: usize = 4;

impl<const N: usize> WideBvh<N> {
    /// Triangles in a group.
    pub const GROUP: usize = GROUP;
    /// Asks for the memory of a child, which will be looked at soon.
    #[inline(always)]
    pub(crate) fn prefetch(&self, child: Child) {
        if child.is_leaf() {
            let first = child.groups().0;
            simd::prefetch(&self.groups, first);
            if let Some(group) = self.groups.get(first) {
                simd::prefetch(&group.e1, 1);
                simd::prefetch(&group.e2, 2);
            }
        } else {
            simd::prefetch(&self.nodes, child.index());
            if let Some(node) = self.nodes.get(child.index()) {
                simd::prefetch(&node.planes, 2);
                simd::prefetch(&node.planes, 4);
                simd::prefetch(&node.children, 0);
            }
        }
    }

    /// From nodes and groups that come from elsewhere: anything that could make a traversal fail or not end is refused.
    ///
    /// # Errors
    /// The first fault, in words.
    pub(crate) fn from_parts(nodes: Vec<WideNode<N>>, groups: Vec<TriangleGroup<GROUP>>) -> Result<Self, String> {
        let depth = structure(&nodes, groups.len())?;
        let triangles = groups.iter().flat_map(|group| group.id).filter(|&id| id != Hit::NO_PRIMITIVE).count();
        Ok(Self { nodes, groups, triangles, depth })
    }

    /// The largest distance of a plane from zero.
    pub(crate) fn largest_coordinate(&self) -> f32 {
        let planes = self.nodes.first().into_iter().flat_map(|root| root.planes.iter().flatten());
        planes.map(|plane| plane.abs()).filter(|plane| plane.is_finite()).fold(0.0, f32::max)
    }

    /// The box around all, as traversal has it; empty when there is nothing in the tree.
    pub(crate) fn bounds(&self) -> Aabb {
        let children =
            self.nodes.first().into_iter().flat_map(|root| (0..N).map(|i| root.planes.map(|plane| plane[i])));
        children.fold(Aabb::EMPTY, |all, [a, b, c, x, y, z]| all.union(&Aabb { min: [a, b, c], max: [x, y, z] }))
    }

    /// Memory of nodes and triangles, in bytes.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<WideNode<N>>() + self.groups.len() * size_of::<TriangleGroup<GROUP>>()
    }
}

/// The boxes of `N` children as structure of arrays, and what is in them.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub struct WideNode<const N: usize> {
    /// Lower and upper planes: minimum x, y, z, maximum x, y, z. Where there is no child, the box that nothing meets.
    pub planes: [[f32; N]; 6],
    /// What is in the boxes.
    pub children: [Child; N],
}

impl<const N: usize> WideNode<N> {
    /// Without children.
    pub const EMPTY: Self = Self {
        planes: [
            [f32::INFINITY; N],
            [f32::INFINITY; N],
            [f32::INFINITY; N],
            [f32::NEG_INFINITY; N],
            [f32::NEG_INFINITY; N],
            [f32::NEG_INFINITY; N],
        ],
        children: [Child::NONE; N],
    };

    /// The box of a child.
    ///
    /// # Panics
    /// If `i >= N`.
    #[must_use]
    pub fn bounds(&self, i: usize) -> Aabb {
        Aabb { min: [0, 1, 2].map(|axis| self.planes[axis][i]), max: [3, 4, 5].map(|axis| self.planes[axis][i]) }
    }

    /// With another child.
    pub(super) fn set(&mut self, i: usize, bounds: &Aabb, child: Child) {
        for axis in 0..3 {
            self.planes[axis][i] = bounds.min[axis];
            self.planes[axis + 3][i] = bounds.max[axis];
        }
        self.children[i] = child;
    }
}

/// A node or a leaf.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Child(u32);

impl Child {
    /// No child.
    pub const NONE: Self = Self(u32::MAX);
    pub(super) const LEAF: u32 = 1 << 31;
    /// Most groups in a leaf.
    pub const MAX_GROUPS: usize = 8;

    /// Node number `i`.
    pub(crate) fn node(i: usize) -> Self {
        Self(i as u32)
    }

    /// A leaf of `number` groups (1 to [`Child::MAX_GROUPS`]) from `first` on.
    pub(super) fn leaf(first: usize, number: usize) -> Self {
        Self(Self::LEAF | (first as u32) << 3 | (number as u32 - 1))
    }

    /// True for a leaf.
    #[inline(always)]
    #[must_use]
    pub fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }

    /// The number of the node, if it is one.
    #[inline(always)]
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }

    /// First group, and the one behind the last, if it is a leaf.
    #[inline(always)]
    #[must_use]
    pub fn groups(self) -> (usize, usize) {
        let first = (self.0 & !Self::LEAF) >> 3;
        (first as usize, (first + (self.0 & 7) + 1) as usize)
    }

    /// As a number, for a stack.
    #[inline(always)]
    pub(crate) fn bits(self) -> u32 {
        self.0
    }

    /// The inverse of [`Child::bits`].
    #[inline(always)]
    pub(crate) fn from_bits(bits: u32) -> Self {
        Self(bits)
    }
}
