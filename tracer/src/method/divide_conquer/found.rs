//! What was found, for the caller.

use crate::geometry::{Hit, HitBlock};
use rayon::prelude::*;

/// Hits that one thread writes to blocks at a time.
const PORTION: usize = 1 << 14;

pub(super) fn to_blocks(found: &[Hit], blocks: &mut [HitBlock]) {
    let portions = found.par_chunks(PORTION).zip(blocks.par_chunks_mut(PORTION / 16));
    portions.for_each(|(hits, blocks)| {
        for (block, hits) in blocks.iter_mut().zip(hits.chunks_exact(16)) {
            for (lane, hit) in hits.iter().enumerate() {
                (block.t.0[lane], block.u.0[lane]) = (hit.t, hit.u);
                (block.v.0[lane], block.primitive.0[lane]) = (hit.v, hit.primitive);
            }
        }
    });
}

/// A bit for each ray that hits something.
pub(super) fn to_words(found: &[Hit], words: &mut [u16]) {
    for (word, hits) in words.iter_mut().zip(found.chunks_exact(16)) {
        *word = hits.iter().rev().fold(0, |bits, hit| bits << 1 | u16::from(!hit.is_miss()));
    }
}

/// Whether a hit counts more than another: at equal distance the lower id wins.
pub(super) fn is_better(hit: &Hit, than: &Hit) -> bool {
    hit.t < than.t || (hit.t == than.t && hit.primitive < than.primitive)
}
