//! What traversal leaves behind: for each frustum its leaves, in the order in which it comes to them.

use super::children::LEAF;
use crate::sort::{compact, head_flags};
use simd::Level;

/// Leaves of all frusta, those of one side by side.
#[derive(Debug, Default)]
pub(super) struct Leaves {
    pub(super) nodes: Vec<u32>,
    /// For each frustum the first of its leaves, and that behind the last.
    pub(super) ranges: Vec<[u32; 2]>,
    heads: Vec<u32>,
    bases: Vec<u32>,
}

impl Leaves {
    /// No leaves, for so many frusta.
    pub(super) fn clear(&mut self, frusta: usize) {
        self.nodes.clear();
        self.ranges.clear();
        self.ranges.resize(frusta, [0; 2]);
    }

    /// Appends pairs of frusta and leaves, those of a frustum side by side: the compression of section 3.1 with frusta in the place of hashes.
    pub(super) fn append(&mut self, level: Level, frusta: &[u32], nodes: &[u32]) {
        let offset = self.nodes.len() as u32;
        self.nodes.extend(nodes.iter().map(|node| node & !LEAF));
        self.heads.resize(frusta.len(), 0);
        self.bases.resize(frusta.len(), 0);
        head_flags(level, frusta, &mut self.heads);
        let distinct = compact(level, &self.heads, &mut self.bases);
        let ends = self.bases[..distinct].iter().skip(1).copied().chain([frusta.len() as u32]);
        for (&base, end) in self.bases[..distinct].iter().zip(ends) {
            self.ranges[frusta[base as usize] as usize] = [offset + base, offset + end];
        }
    }

    /// No longer the leaves of the first so many frusta, all of which came before those of others; how many these were.
    pub(super) fn forget(&mut self, frusta: usize) -> usize {
        let (gone, rest) = self.ranges.split_at_mut(frusta);
        let number = gone.iter().map(|range| range[1]).max().unwrap_or(0);
        gone.fill([0; 2]);
        for range in rest.iter_mut().filter(|range| range[1] > 0) {
            *range = range.map(|at| at - number);
        }
        self.nodes.drain(..number as usize);
        number as usize
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        let words = self.nodes.capacity() + self.heads.capacity() + self.bases.capacity();
        size_of::<u32>() * words + size_of::<[u32; 2]>() * self.ranges.capacity()
    }

    /// The leaves of a frustum.
    #[inline(always)]
    pub(super) fn of(&self, frustum: usize) -> &[u32] {
        let [begin, end] = self.ranges[frustum];
        &self.nodes[begin as usize..end as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_of_frusta() {
        for level in Level::available() {
            let mut leaves = Leaves::default();
            leaves.clear(7);
            leaves.append(level, &[0, 0, 2, 3, 3, 3], &[10, 11, 12, 13 | LEAF, 14, 15]);
            leaves.append(level, &[], &[]);
            leaves.append(level, &[5], &[16]);
            let lists: Vec<&[u32]> = (0..7).map(|i| leaves.of(i)).collect();
            assert_eq!(lists, [&[10, 11][..], &[], &[12], &[13, 14, 15], &[], &[16], &[]]);
            assert_eq!([leaves.forget(2), leaves.forget(2), leaves.forget(3)], [2, 0, 1]);
            leaves.append(level, &[6, 6], &[17, 18]);
            let lists: Vec<&[u32]> = (0..7).map(|i| leaves.of(i)).collect();
            assert_eq!(lists, [&[][..], &[], &[], &[13, 14, 15], &[], &[16], &[17, 18]]);
            assert_eq!(leaves.forget(7), 6);
        }
    }
}
