//! Hits: one, and a batch in structure-of-arrays blocks.

use crate::hash::fnv1a;
use simd::Block;

/// Where a ray meets a triangle first.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Hit {
    /// Distance in units of the direction's length; infinite for a miss.
    pub t: f32,
    /// Barycentric weight of the triangle's second vertex; 0 for a miss.
    pub u: f32,
    /// Barycentric weight of the triangle's third vertex; 0 for a miss.
    pub v: f32,
    /// Place of the triangle in the mesh; [`Hit::NO_PRIMITIVE`] for a miss.
    pub primitive: u32,
}

impl Hit {
    /// The primitive of a miss.
    pub const NO_PRIMITIVE: u32 = u32::MAX;
    /// Nothing hit.
    pub const MISS: Self = Self { t: f32::INFINITY, u: 0.0, v: 0.0, primitive: Self::NO_PRIMITIVE };

    /// True when nothing was hit.
    #[must_use]
    pub const fn is_miss(&self) -> bool {
        self.primitive == Self::NO_PRIMITIVE
    }
}

/// The hits of sixteen rays.
#[derive(Debug, Clone)]
#[repr(C)]
pub struct HitBlock {
    /// [`Hit::t`].
    pub t: Block<f32>,
    /// [`Hit::u`].
    pub u: Block<f32>,
    /// [`Hit::v`].
    pub v: Block<f32>,
    /// [`Hit::primitive`].
    pub primitive: Block<u32>,
}

impl HitBlock {
    /// Sixteen misses.
    pub const MISS: Self = Self {
        t: Block([Hit::MISS.t; 16]),
        u: Block([Hit::MISS.u; 16]),
        v: Block([Hit::MISS.v; 16]),
        primitive: Block([Hit::MISS.primitive; 16]),
    };

    /// The hit of one ray.
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> Hit {
        Hit { t: self.t.0[lane], u: self.u.0[lane], v: self.v.0[lane], primitive: self.primitive.0[lane] }
    }
}

/// The hits of a [`RayBatch`](super::RayBatch), in the order of its rays.
#[derive(Debug, Clone, Default)]
pub struct HitBatch {
    blocks: Vec<HitBlock>,
    len: usize,
}

impl HitBatch {
    /// No hits yet; methods make it as long as their rays.
    #[must_use]
    pub const fn new() -> Self {
        Self { blocks: Vec::new(), len: 0 }
    }

    /// Number of hits, misses among them.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.len
    }

    /// True when there are none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The hits, sixteen at a time; what lies past [`HitBatch::len`] are misses.
    #[must_use]
    pub fn blocks(&self) -> &[HitBlock] {
        &self.blocks
    }

    /// `len` places to write hits to: what they held is left.
    pub(crate) fn resize(&mut self, len: usize) -> &mut [HitBlock] {
        self.len = len;
        self.blocks.resize(len.div_ceil(16), HitBlock::MISS);
        &mut self.blocks
    }

    /// The hit of ray `i`.
    ///
    /// # Panics
    /// If `i >= len()`.
    #[must_use]
    #[inline]
    pub fn get(&self, i: usize) -> Hit {
        assert!(i < self.len, "hit {i} of {}", self.len);
        self.blocks[i / 16].get(i % 16)
    }

    /// A hash of all bits of all hits.
    #[must_use]
    pub fn hash(&self) -> u64 {
        fnv1a(self.iter().flat_map(|h| [h.t.to_bits(), h.u.to_bits(), h.v.to_bits(), h.primitive]))
    }

    /// The hits in the order of the rays.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Hit> + '_ {
        (0..self.len).map(|i| self.get(i))
    }
}
