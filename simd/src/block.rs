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

/// The lanes of blocks, one after the other.
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
#[inline(always)]
pub(crate) fn lanes_mut<T>(blocks: &mut [Block<T>]) -> &mut [T] {
    let (lanes, n) = (blocks.as_mut_ptr().cast(), 16 * blocks.len());
    const { assert!(size_of::<T>() == 4) }
    // SAFETY: a block is sixteen lanes and, as those have 4 bytes, nothing else.
    unsafe { std::slice::from_raw_parts_mut(lanes, n) }
}
