//! A frustum at a node: which of its children it meets, and in which order.

use crate::bvh::{OctoBvh, OctoNode};
use crate::geometry::Vec3;
use crate::geometry::frustum::Frustum;
use simd::{Float, Mask};

/// The children of a node that a frustum meets.
#[derive(Debug, Clone, Copy)]
pub(super) struct Children {
    pub(super) number: u32,
    /// Three bits for each, from the first to the last along the frustum: which child of the node it is.
    pub(super) sorted: u32,
    /// Child 0.
    pub(super) base: u32,
    /// A leaf is its own child.
    pub(super) is_leaf: bool,
}

impl Children {
    #[inline(always)]
    pub(super) fn of<F: Float>(rows: &[[f32; 8]], node: u32, frustum: &Frustum) -> Self {
        let row = OctoNode::of_row(&rows[node as usize]);
        let (first, number) = row.children();
        if number == 0 {
            return Self { number: 1, sorted: 0, base: node, is_leaf: true };
        }
        let mut met = 0;
        let mut k = 0;
        while k < number as usize {
            let [x, y, z, _, high_x, high_y, high_z, _] = F::load_rows8(&rows[first as usize + k..]);
            let (low, high) = (Vec3 { x, y, z }, Vec3 { x: high_x, y: high_y, z: high_z });
            met |= frustum.meets(low, high).bitmask() << k;
            k += F::LANES;
        }
        met &= (1 << number) - 1;
        Self { number: met.count_ones(), sorted: sort(met, row.places(frustum.signs)), base: first, is_leaf: false }
    }
}

/// The children of a bit mask by their places.
#[inline(always)]
fn sort(mut met: u32, places: u32) -> u32 {
    let (mut taken, mut child_at) = (0_u32, 0);
    while met != 0 {
        let child = met.trailing_zeros();
        met &= met - 1;
        let place = places >> (3 * child) & 7;
        taken |= 1 << place;
        child_at |= child << (3 * place);
    }
    let (mut sorted, mut shift) = (0, 0);
    while taken != 0 {
        let place = taken.trailing_zeros();
        taken &= taken - 1;
        sorted |= (child_at >> (3 * place) & 7) << shift;
        shift += 3;
    }
    sorted
}

/// Asks for the children of a node, whose own row is hoped to be there.
#[inline(always)]
pub(super) fn prefetch(rows: &[[f32; 8]], node: u32) {
    let (first, number) = OctoNode::of_row(&rows[node as usize]).children();
    if number != 0 {
        let first = first as usize;
        simd::prefetch(rows, first);
        simd::prefetch(rows, first + 2);
        simd::prefetch(rows, first + 4);
        simd::prefetch(rows, first + 6);
    }
}

/// Number of children of some nodes.
pub(super) fn number(tree: &OctoBvh, nodes: &[u32]) -> u64 {
    let number = |&node: &u32| u64::from(OctoNode::of_row(&tree.rows()[node as usize]).children().1);
    nodes.iter().map(number).sum()
}

#[cfg(test)]
mod tests {
    use super::sort;

    #[test]
    fn children_come_by_place() {
        // Child 0 at place 5, child 1 at 2, child 2 at 7.
        let places = 5 | 2 << 3 | 7 << 6;
        assert_eq!(sort(0b111, places), 0b010_000_001);
        assert_eq!(sort(0b101, places), 0b010_000);
        assert_eq!(sort(0b100, places), 0b010);
        assert_eq!(sort(0, places), 0);
    }
}
