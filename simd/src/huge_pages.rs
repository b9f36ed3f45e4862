//! Memory in large pages.

use alloc::vec::Vec;

/// An empty vector with room for `capacity` elements, which the system is asked to put into huge pages: random reads of tens of
/// megabytes then miss the TLB much less often, and the first touch of the memory costs less. A hint: on Linux with transparent huge pages
/// (`madvise` or `always`) it works for vectors of several megabytes, elsewhere this is [`Vec::with_capacity`].
///
/// ```
/// let mut numbers = simd::vec_in_huge_pages(1 << 20);
/// numbers.extend(0..1 << 20);
/// assert_eq!(numbers.len(), 1 << 20);
/// ```
#[must_use]
pub fn vec_in_huge_pages<T>(capacity: usize) -> Vec<T> {
    #[allow(unused_mut, reason = "only Linux has a hint")]
    let mut vec = Vec::with_capacity(capacity);
    #[cfg(all(feature = "std", target_os = "linux", not(miri)))]
    advise(vec.spare_capacity_mut());
    vec
}

#[cfg(all(feature = "std", target_os = "linux", not(miri)))]
fn advise<T>(memory: &mut [core::mem::MaybeUninit<T>]) {
    use core::ffi::{c_int, c_void};
    unsafe extern "C" {
        fn madvise(address: *mut c_void, length: usize, advice: c_int) -> c_int;
    }
    const MADV_HUGEPAGE: c_int = 14;
    /// The largest usual size of a small page, at whose multiples advice begins and ends.
    const PAGE: usize = 1 << 16;
    let (start, bytes) = (memory.as_mut_ptr().cast::<u8>(), size_of_val(memory));
    let skipped = start.align_offset(PAGE);
    let length = bytes.saturating_sub(skipped) / PAGE * PAGE;
    if length >= 1 << 21 {
        // SAFETY: the range lies inside of `memory`, and the advice changes nothing that can be read there. That it is not taken is no error.
        unsafe {
            madvise(start.add(skipped).cast(), length, MADV_HUGEPAGE);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::vec_in_huge_pages;

    #[test]
    fn any_size_works() {
        for capacity in [0, 1, 1000, 65_536, 262_143, 3_000_001] {
            let mut vec = vec_in_huge_pages::<u32>(capacity);
            assert!(vec.is_empty() && vec.capacity() >= capacity);
            vec.extend(0..capacity as u32);
            vec.push(7);
            assert!(vec.iter().take(capacity).copied().eq(0..capacity as u32));
        }
        assert!(vec_in_huge_pages::<()>(100).capacity() >= 100);
    }
}
