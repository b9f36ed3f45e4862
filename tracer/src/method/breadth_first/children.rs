//! A frustum at a node: which of its children it meets, and in which order.

use crate::bvh::octo::Order;
use crate::bvh::{OctoBvh, OctoNode};
use crate::geometry::Vec3;
use crate::geometry::frustum::Frustum;
use simd::{Float, Integer, Mask, Vector};

/// Marks a leaf in a queue or on a stack, so that nothing need be read to tell.
pub(super) const LEAF: u32 = 1 << 31;

/// The children of a node that a frustum meets.
#[derive(Debug, Clone, Copy)]
pub(super) struct Children {
    pub(super) number: u32,
    /// Four bits for each, from the first to the last along the frustum: which child of the node it is, and in bit 3 whether it is a leaf.
    pub(super) sorted: u32,
    /// Child 0.
    pub(super) base: u32,
}

impl Children {
    /// A leaf is its own child.
    #[inline(always)]
    pub(super) fn of_leaf(node: u32) -> Self {
        Self { number: 1, sorted: 0, base: node }
    }

    /// Of an inner node.
    #[inline(always)]
    pub(super) fn of<F: Float>(rows: &[[f32; 8]], node: u32, frustum: &Frustum) -> Self {
        let row = OctoNode::of_row(&rows[node as usize]);
        let (first, number) = row.children();
        let (mut met, mut leaves) = (0, 0);
        let mut k = 0;
        while k < number as usize {
            let [x, y, z, block, high_x, high_y, high_z, _] = F::load_rows8(&rows[first as usize + k..]);
            let (low, high) = (Vec3 { x, y, z }, Vec3 { x: high_x, y: high_y, z: high_z });
            met |= frustum.meets(low, high).bitmask() << k;
            leaves |= OctoNode::are_leaves(block).bitmask() << k;
            k += F::LANES;
        }
        met &= (1 << number) - 1;
        Self { number: met.count_ones(), sorted: sort::<F>(met, leaves, row.order(frustum.signs)), base: first }
    }

    /// Child `k` of those that are met.
    #[inline(always)]
    pub(super) fn get(&self, k: u32) -> u32 {
        let child = self.sorted >> (4 * k);
        (self.base + (child & 7)) | (child & 8) << 28
    }
}

/// The root of a tree.
pub(super) fn root(tree: &OctoBvh) -> u32 {
    if tree.len() == 1 { LEAF } else { 0 }
}

/// The children of a bit mask, from the first to the last along the frustum.
#[inline(always)]
fn sort<F: Float>(met: u32, leaves: u32, order: Order) -> u32 {
    let eight = F::LANES == 8;
    let mut sorted = 0;
    if eight {
        let splat = F::Index::splat;
        let slots = F::Index::load(&[0, 1, 2, 3, 4, 5, 6, 7]) ^ splat(order.signs);
        let child = splat(order.children).shr_lanes(slots + slots + slots) & splat(7);
        let on = splat(met).shr_lanes(child) & splat(order.taken).shr_lanes(slots) & splat(1);
        let leaf = (splat(leaves).shr_lanes(child) & splat(1)) << 3;
        let shifts = F::Index::load(&[0, 4, 8, 12, 16, 20, 24, 28]);
        sorted = (child | leaf).compress(on.ne(splat(0))).shl_lanes(shifts).reduce_add();
    } else {
        let mut shift = 0;
        for place in 0..8 {
            let slot = place ^ order.signs;
            let child = order.children >> (3 * slot) & 7;
            let on = met >> child & order.taken >> slot & 1;
            sorted |= (on * (child | (leaves >> child & 1) << 3)) << shift;
            shift += 4 * on;
        }
    }
    sorted
}

/// Asks for the children of an inner node, whose own row is hoped to be there.
#[inline(always)]
pub(super) fn prefetch(rows: &[[f32; 8]], node: u32) {
    let Some(row) = rows.get(node as usize) else { return };
    let first = OctoNode::of_row(row).children().0 as usize;
    simd::prefetch(rows, first);
    simd::prefetch(rows, first + 2);
    simd::prefetch(rows, first + 4);
    simd::prefetch(rows, first + 6);
}

/// Number of children of some nodes.
pub(super) fn number(tree: &OctoBvh, nodes: &[u32]) -> u64 {
    let inner = nodes.iter().filter(|&node| node & LEAF == 0);
    inner.map(|&node| u64::from(OctoNode::of_row(&tree.rows()[node as usize]).children().1)).sum()
}

#[cfg(test)]
mod tests {
    use super::{Order, sort};
    use simd::{Level, kernel};

    kernel! {
        fn by_eight<S>(met: u32, leaves: u32, order: Order) -> u32 {
            sort::<S::Float8>(met, leaves, order)
        }
    }

    #[test]
    fn children_come_by_place() {
        // Child 0 in slot 2, child 1 in slot 5, child 2 in slot 7.
        let order = |signs| Order { children: 1 << 15 | 2 << 21, taken: 0b1010_0100, signs };
        let cases = [
            (0b111, 0, 0, 0x210),
            (0b111, 0, 7, 0x012),
            // Places 3, 4 and 6.
            (0b111, 0b010, 1, 0x290),
            (0b101, 0b100, 7, 0x00a),
            (0b100, 0b011, 0, 0x002),
            (0, 7, 0, 0),
        ];
        for (met, leaves, signs, expected) in cases {
            let expected = if signs == 7 && met == 0b101 { 0x0a } else { expected };
            assert_eq!(sort::<f32>(met, leaves, order(signs)), expected, "{met:b} {signs}");
            for level in Level::available() {
                assert_eq!(by_eight(level, met, leaves, order(signs)), expected, "{level}: {met:b} {signs}");
            }
        }
    }
}
