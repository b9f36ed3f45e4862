//! Packets in blocks of sixteen rays (Garanzha & Loop 2010, section 3.1: decomposition).

/// Runs of blocks. A run is one packet, or it is a single block that several packets share.
#[derive(Debug, Clone, Copy)]
pub(super) struct Runs<'a> {
    /// First block of each run, and the end of the last; counted from `offset`.
    bases: &'a [u32],
    offset: u32,
    /// For each run a bit for each lane in which a packet begins; that is bit 0 alone for a run of several blocks.
    pub(super) cuts: &'a [u16],
}

impl<'a> Runs<'a> {
    pub(super) fn len(&self) -> usize {
        self.cuts.len()
    }

    /// The first block of a run, and the end.
    #[inline(always)]
    pub(super) fn blocks(&self, run: usize) -> [u32; 2] {
        [self.bases[run] - self.offset, self.bases[run + 1] - self.offset]
    }

    /// The first block of all, and the end.
    pub(super) fn all_blocks(&self) -> [usize; 2] {
        [self.bases[0] as usize, self.bases[self.cuts.len()] as usize]
    }

    /// Some of these runs, their blocks counted from the first of them.
    pub(super) fn part(&self, first: usize, end: usize) -> Runs<'a> {
        Self { bases: &self.bases[first..=end], offset: self.bases[first], cuts: &self.cuts[first..end] }
    }
}

/// The runs of a batch.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Decomposition {
    bases: Vec<u32>,
    cuts: Vec<u16>,
}

impl Decomposition {
    /// Packets of `most` blocks, and what is left.
    pub(super) fn regular(blocks: usize, most: usize) -> Self {
        let mut bases: Vec<u32> = (0..blocks as u32).step_by(most).collect();
        let cuts = vec![1; bases.len()];
        bases.push(blocks as u32);
        Self { bases, cuts }
    }

    /// Packets of rays of one cell alone, at most `most` blocks each. `starts` are the first rays of all cells, ascending from 0.
    pub(super) fn of_cells(starts: impl Iterator<Item = u32>, blocks: usize, most: usize) -> Self {
        let (mut bases, mut cuts) = (Vec::new(), Vec::new());
        let mut starts = starts.peekable();
        let mut shared_before = true;
        for block in 0..blocks as u32 {
            let mut cut = 0;
            while let Some(start) = starts.next_if(|&start| start < 16 * (block + 1)) {
                cut |= 1_u16 << (start % 16);
            }
            let shared = cut & !1 != 0;
            let full = bases.last().is_some_and(|&first: &u32| (block - first) as usize >= most);
            if shared || shared_before || cut != 0 || full {
                bases.push(block);
                cuts.push(cut | 1);
            }
            shared_before = shared;
        }
        bases.push(blocks as u32);
        Self { bases, cuts }
    }

    pub(super) fn runs(&self) -> Runs<'_> {
        Runs { bases: &self.bases, offset: 0, cuts: &self.cuts }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_become_packets() {
        let of_cells = |starts: &[u32], blocks, most| {
            let Decomposition { bases, cuts } = Decomposition::of_cells(starts.iter().copied(), blocks, most);
            (bases, cuts)
        };
        assert_eq!(of_cells(&[0], 5, 2), (vec![0, 2, 4, 5], vec![1, 1, 1]));
        assert_eq!(of_cells(&[0, 32], 5, 4), (vec![0, 2, 5], vec![1, 1]));
        assert_eq!(of_cells(&[0, 35, 40], 5, 4), (vec![0, 2, 3, 5], vec![1, 0b1_0000_1001, 1]));
        assert_eq!(of_cells(&[0, 1, 16, 17], 2, 4), (vec![0, 1, 2], vec![3, 3]));
        assert_eq!(of_cells(&[], 0, 4), (vec![0], vec![]));
        assert_eq!(Decomposition::regular(5, 2), Decomposition::of_cells([0].into_iter(), 5, 2));
        assert_eq!(Decomposition::regular(0, 2), Decomposition::of_cells([].into_iter(), 0, 2));
        let all = Decomposition::regular(9, 2);
        let part = all.runs().part(1, 3);
        assert_eq!((part.len(), part.all_blocks(), part.blocks(1)), (2, [2, 6], [2, 4]));
    }
}
