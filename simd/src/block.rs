//! Aligned storage.

/// Sixteen 32-bit lanes, one cache line: the unit of structure-of-arrays storage. Each vector width loads its share of it
/// with aligned accesses, see [`Vector::load_block`](crate::Vector::load_block).
///
/// ```
/// let block = simd::Block([1.0_f32; 16]);
/// assert_eq!(std::mem::align_of_val(&block), 64);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub struct Block<T>(pub [T; 16]);

impl<T: Copy + Default> Default for Block<T> {
    #[inline(always)]
    fn default() -> Self {
        Self([T::default(); 16])
    }
}

/// Slices of blocks as slices of lanes and back, without copying; for lanes of four bytes or a multiple (checked when compiling),
/// between which alignment leaves no gap.
///
/// ```
/// use simd::Block;
///
/// let blocks = [Block([1.0_f32; 16]), Block([2.0; 16])];
/// let lanes = Block::flatten(&blocks);
/// assert_eq!(lanes[15..17], [1.0, 2.0]);
/// assert_eq!(Block::slice_of(lanes), Some(&blocks[..]));
/// assert_eq!(Block::slice_of(&lanes[1..17]), None); // not aligned
/// assert_eq!(Block::slice_of(&lanes[..17]), None); // not whole blocks
/// ```
impl<T> Block<T> {
    const NO_GAPS: () = assert!(size_of::<Self>() == 16 * size_of::<T>(), "lanes must have a multiple of four bytes");

    /// The lanes as blocks, if they are aligned to 64 bytes and their number is a multiple of 16.
    #[must_use]
    #[inline]
    pub fn slice_of(lanes: &[T]) -> Option<&[Self]> {
        const { Self::NO_GAPS };
        let blocks = lanes.as_ptr().cast::<Self>();
        // SAFETY: a block is 16 lanes without gaps, the pointer is aligned for blocks, and the lanes are so many whole blocks,
        // borrowed as long as the result.
        (blocks.is_aligned() && lanes.len().is_multiple_of(16))
            .then(|| unsafe { std::slice::from_raw_parts(blocks, lanes.len() / 16) })
    }

    /// The lanes as blocks, if they are aligned to 64 bytes and their number is a multiple of 16.
    #[must_use]
    #[inline]
    pub fn slice_of_mut(lanes: &mut [T]) -> Option<&mut [Self]> {
        const { Self::NO_GAPS };
        let blocks = lanes.as_mut_ptr().cast::<Self>();
        // SAFETY: as in `slice_of`; borrowed mutably.
        (blocks.is_aligned() && lanes.len().is_multiple_of(16))
            .then(|| unsafe { std::slice::from_raw_parts_mut(blocks, lanes.len() / 16) })
    }

    /// The lanes of the blocks.
    #[must_use]
    #[inline]
    pub fn flatten(blocks: &[Self]) -> &[T] {
        const { Self::NO_GAPS };
        // SAFETY: a block is 16 lanes without gaps; borrowed as long as the result.
        unsafe { std::slice::from_raw_parts(blocks.as_ptr().cast(), 16 * blocks.len()) }
    }

    /// The lanes of the blocks.
    #[must_use]
    #[inline]
    pub fn flatten_mut(blocks: &mut [Self]) -> &mut [T] {
        const { Self::NO_GAPS };
        // SAFETY: as in `flatten`; borrowed mutably.
        unsafe { std::slice::from_raw_parts_mut(blocks.as_mut_ptr().cast(), 16 * blocks.len()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices() {
        let mut blocks = [Block([0_u32; 16]); 3];
        for (i, lane) in Block::flatten_mut(&mut blocks).iter_mut().enumerate() {
            *lane = i as u32;
        }
        assert_eq!(blocks[2].0[1], 33);
        let lanes = Block::flatten_mut(&mut blocks);
        assert_eq!(lanes.len(), 48);
        Block::slice_of_mut(&mut lanes[16..]).unwrap()[1].0[0] = 7;
        assert_eq!(lanes[32], 7);
        assert_eq!(Block::slice_of_mut(&mut lanes[4..20]), None);
        assert_eq!(Block::slice_of_mut(&mut lanes[..15]), None);
        assert_eq!(Block::slice_of(&lanes[..0]), Some(&[][..]));
        assert_eq!(Block::flatten(&[Block([1.5_f64; 16]); 2]), [1.5; 32]);
    }
}
