//! Long arrays written from front to back.

use simd::{Block, Uint};

/// From so many elements on an array is written past the caches: what comes next would find nothing of it there anyway, and memory that is
/// written whole need not be read first.
const LONG: usize = 1 << 22;

/// What an array is filled with.
///
/// A trait because closures are not always inlined into the code of a level. Mark the functions `#[inline(always)]`.
pub(super) trait Source<U: Uint> {
    /// The next elements, as many as the vector has lanes; the first of them is number `first`.
    fn vector(&mut self, first: usize) -> U;

    /// The next element, number `i`.
    fn single(&mut self, i: usize) -> u32;
}

/// Fills a part of an array that has `total` elements.
#[inline(always)]
pub(super) fn fill<U: Uint>(source: &mut impl Source<U>, part: &mut [u32], total: usize) {
    let len = part.len();
    let mut done = 0;
    if total >= LONG {
        done = part.as_ptr().align_offset(align_of::<Block<u32>>()).min(len);
        for (i, to) in part[..done].iter_mut().enumerate() {
            *to = source.single(i);
        }
        let blocks = (len - done) / 16;
        if let Some(blocks) = Block::slice_of_mut(&mut part[done..done + 16 * blocks]) {
            U::stream(blocks, |i| source.vector(done + U::LANES * i));
            done += 16 * blocks.len();
        }
    }
    let vectors = (len - done) / U::LANES;
    for (i, to) in part[done..].chunks_exact_mut(U::LANES).enumerate() {
        source.vector(done + U::LANES * i).store(to);
    }
    done += vectors * U::LANES;
    for (i, to) in part[done..].iter_mut().enumerate() {
        *to = source.single(done + i);
    }
}
