//! Hints to the cache.

/// Asks for the cache line of `slice[index]` to be fetched to all levels. A hint: nothing happens when the index is out of
/// bounds or the architecture has no such instruction.
#[inline(always)]
pub fn prefetch<T>(slice: &[T], index: usize) {
    #[cfg(any(target_arch = "x86_64", all(target_arch = "x86", target_feature = "sse"), target_arch = "aarch64"))]
    if let Some(item) = slice.get(index) {
        let address = std::ptr::from_ref(item);
        #[cfg(target_arch = "x86")]
        use std::arch::x86::{_MM_HINT_T0, _mm_prefetch};
        #[cfg(target_arch = "x86_64")]
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        // SAFETY: a hint on a valid address; every x86-64 has the instruction, and x86 with SSE.
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(address.cast());
        }
        #[cfg(target_arch = "aarch64")]
        // SAFETY: a hint on a valid address; reads and writes nothing.
        unsafe {
            std::arch::asm!("prfm pldl1keep, [{0}]", in(reg) address, options(nostack, preserves_flags, readonly));
        }
    }
    #[cfg(not(any(
        target_arch = "x86_64",
        all(target_arch = "x86", target_feature = "sse"),
        target_arch = "aarch64"
    )))]
    let _ = (slice, index);
}
