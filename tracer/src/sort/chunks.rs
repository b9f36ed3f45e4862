//! Compression, decompression and decomposition by scans, as the paper describes them (Garanzha and Loop 2010, section 3.1). What sorts rays,
//! [`RaySort`](super::RaySort), does the first two in a sweep each; these tell what it must find.

use super::scan::{compact, exclusive_scan, head_flags, segmented_scan};
use simd::Level;

/// Runs of equal hashes.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Chunks {
    /// The hash of each.
    pub hash: Vec<u32>,
    /// The place of its first ray.
    pub base: Vec<u32>,
    /// The number of its rays.
    pub size: Vec<u32>,
}

impl Chunks {
    /// The runs of a sequence (figure 4).
    #[must_use]
    pub fn compress(level: Level, hashes: &[u32]) -> Self {
        let mut flags = vec![0; hashes.len()];
        head_flags(level, hashes, &mut flags);
        // The scan's sum is the number of chunks; compaction does without the places that it gives.
        let mut scan = vec![0; hashes.len()];
        let number = exclusive_scan(level, &flags, &mut scan) as usize;
        let mut base = vec![0; number];
        compact(level, &flags, &mut base);
        let hash = base.iter().map(|&base| hashes[base as usize]).collect();
        let ends = base.iter().skip(1).copied().chain([hashes.len() as u32]);
        let size = base.iter().zip(ends).map(|(base, end)| end - base).collect();
        Self { hash, base, size }
    }

    /// All places of the chunks, in the order of the chunks (figure 5).
    #[must_use]
    pub fn decompress(&self, level: Level) -> Vec<u32> {
        let Self { base, size, .. } = self;
        let mut scan = vec![0; size.len()];
        let len = exclusive_scan(level, size, &mut scan) as usize;
        expand(level, &scan, base, 1, len)
    }

    /// Where packets of at most `most` rays begin, each within a chunk (figure 6).
    ///
    /// # Panics
    /// If `most` is 0.
    #[must_use]
    pub fn decompose(&self, level: Level, most: u32) -> Vec<u32> {
        let packets: Vec<u32> = self.size.iter().map(|size| size.div_ceil(most)).collect();
        let mut scan = vec![0; packets.len()];
        let len = exclusive_scan(level, &packets, &mut scan) as usize;
        expand(level, &scan, &self.base, most, len)
    }
}

/// Arithmetic sequences one after the other: each starts at a place, from a number, and goes on by `step`.
fn expand(level: Level, places: &[u32], from: &[u32], step: u32, len: usize) -> Vec<u32> {
    let (mut skeleton, mut heads) = (vec![step; len], vec![0; len]);
    for (&place, &from) in places.iter().zip(from) {
        skeleton[place as usize] = from;
        heads[place as usize] = 1;
    }
    segmented_scan(level, &mut skeleton, &heads);
    skeleton
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sort::test;

    /// Figure 4: hashes with the head flags 1 0 0 1 0 0 0 1 0 1 0 0 0 0 1 0 0 1 0 0. (The letters of its figure are lost; these sort as well as others.)
    const SIZES: [u32; 6] = [3, 4, 2, 5, 3, 3];
    const HASHES: [u32; 6] = [30, 10, 20, 10, 40, 20];

    fn hashes() -> Vec<u32> {
        let runs = HASHES.iter().zip(SIZES);
        runs.flat_map(|(&hash, size)| vec![hash; size as usize]).collect()
    }

    #[test]
    fn figure_4_compression() {
        for level in Level::available() {
            let hashes = hashes();
            let mut flags = [0; 20];
            head_flags(level, &hashes, &mut flags);
            assert_eq!(flags, [1, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0]);
            let mut scan = [0; 20];
            assert_eq!(exclusive_scan(level, &flags, &mut scan), 6);
            assert_eq!(scan, [0, 1, 1, 1, 2, 2, 2, 2, 3, 3, 4, 4, 4, 4, 4, 5, 5, 5, 6, 6]);
            let chunks = Chunks::compress(level, &hashes);
            assert_eq!(chunks.base, [0, 3, 7, 9, 14, 17]);
            assert_eq!(chunks.size, SIZES);
            assert_eq!(chunks.hash, HASHES);
        }
    }

    #[test]
    fn figure_5_decompression() {
        for level in Level::available() {
            // Sorted by hash: chunks 1, 3, 2, 5, 0, 4.
            let sorted = Chunks {
                hash: vec![10, 10, 20, 20, 30, 40],
                base: vec![3, 9, 7, 17, 0, 14],
                size: vec![4, 5, 2, 3, 3, 3],
            };
            let mut scan = [0; 6];
            assert_eq!(exclusive_scan(level, &sorted.size, &mut scan), 20);
            assert_eq!(scan, [0, 4, 9, 11, 14, 17]);
            let ids = [3, 4, 5, 6, 9, 10, 11, 12, 13, 7, 8, 17, 18, 19, 0, 1, 2, 14, 15, 16];
            assert_eq!(sorted.decompress(level), ids);
        }
    }

    #[test]
    fn figure_6_decomposition() {
        for level in Level::available() {
            // The cells of the rays of figure 5, of 9, 5, 3 and 3 rays, in packets of at most 4.
            let cells = Chunks { hash: vec![10, 20, 30, 40], base: vec![0, 9, 14, 17], size: vec![9, 5, 3, 3] };
            assert_eq!(cells.decompose(level, 4), [0, 4, 8, 9, 13, 14, 17]);
        }
    }

    #[test]
    fn nothing() {
        let chunks = Chunks::compress(Level::SCALAR, &[]);
        assert_eq!(chunks, Chunks::default());
        assert!(chunks.decompress(Level::SCALAR).is_empty() && chunks.decompose(Level::SCALAR, 4).is_empty());
    }

    #[test]
    fn there_and_back() {
        test::everywhere(|| {
            for level in Level::available() {
                let hashes: Vec<u32> = test::random(200_000, 9).iter().map(|x| x % 3).collect();
                let chunks = Chunks::compress(level, &hashes);
                assert!(chunks.decompress(level).into_iter().eq(0..200_000), "{level}");
                assert_eq!(chunks.decompose(level, 1).len(), 200_000, "{level}");
            }
        });
    }
}
