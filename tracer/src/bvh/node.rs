//! The 32-byte node with a skip pointer (Geimer & Müller 2003, sections 3.2 and 3.3; Smits 1998).

use crate::geometry::Aabb;

/// A node of the depth-first array: `min, skip, max, leaf` in eight words.
///
/// The first child of an inner node is the next node; [`Node::skip`] is where to go on when the box is missed (and after a
/// leaf). Stored as floats so that a plane can be picked by index: [`Node::planes`]; the two integers travel as bit patterns.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub struct Node([f32; 8]);

const _: () = assert!(size_of::<Node>() == 32 && align_of::<Node>() == 32);

impl Node {
    /// Most triangles in a leaf.
    pub const MAX_LEAF: u32 = 15;
    /// Most triangles in a tree.
    pub const MAX_TRIANGLES: usize = 1 << 28;

    /// An inner node.
    #[must_use]
    pub fn inner(bounds: &Aabb, skip: u32) -> Self {
        Self::new(bounds, skip, 0)
    }

    /// A leaf of `count` triangles (1 to [`Node::MAX_LEAF`]) from number `first` of the tree's triangle array.
    #[must_use]
    pub fn leaf(bounds: &Aabb, skip: u32, first: u32, count: u32) -> Self {
        debug_assert!((1..=Self::MAX_LEAF).contains(&count) && (first as usize) < Self::MAX_TRIANGLES);
        Self::new(bounds, skip, first << 4 | count)
    }

    fn new(b: &Aabb, skip: u32, leaf: u32) -> Self {
        let bits = f32::from_bits;
        Self([b.min[0], b.min[1], b.min[2], bits(skip), b.max[0], b.max[1], b.max[2], bits(leaf)])
    }

    /// The box.
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let p = &self.0;
        Aabb { min: [p[0], p[1], p[2]], max: [p[4], p[5], p[6]] }
    }

    /// All eight words: `min` at 0..3, `max` at 4..7.
    #[inline(always)]
    #[must_use]
    pub fn planes(&self) -> &[f32; 8] {
        &self.0
    }

    /// Index of the node to go to when this one is missed.
    #[inline(always)]
    #[must_use]
    pub fn skip(&self) -> u32 {
        self.0[3].to_bits()
    }

    /// The same node with another skip pointer.
    #[must_use]
    pub fn with_skip(mut self, skip: u32) -> Self {
        self.0[3] = f32::from_bits(skip);
        self
    }

    /// The same node with another box.
    #[must_use]
    pub fn with_bounds(self, bounds: &Aabb) -> Self {
        Self::new(bounds, self.skip(), self.0[7].to_bits())
    }

    /// First triangle and number of triangles; the number is 0 for an inner node.
    #[inline(always)]
    #[must_use]
    pub fn triangles(&self) -> (u32, u32) {
        let leaf = self.0[7].to_bits();
        (leaf >> 4, leaf & 15)
    }
}
