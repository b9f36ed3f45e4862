//! Rays put into the order of their hashes: compression, sorting, decompression (Garanzha and Loop 2010, figure 3), each in one sweep.
//!
//! Rays that come one after the other often have the same hash: what is sorted are runs of them. The size of a run is not sorted along. It is the
//! distance to the next head in an array of bits, which lies in the cache where arrays of numbers would not.

use super::RadixSort;
use rayon::prelude::*;
use simd::{Level, Mask, Simd, Vector, kernel};

/// Hashes, or sorted runs, that a thread takes at a time: a multiple of 64.
const CHUNK: usize = 1 << 16;

/// The vector of `u32` in a level's registers.
type Native<S> = <<S as Simd>::Float as Vector>::Index;

/// Puts rays into the order of their hashes; keeps its memory.
///
/// ```
/// let mut sort = tracer::sort::RaySort::default();
/// let mut order = Vec::new();
/// sort.order(simd::Level::best(), &[7, 7, 3, 7], &mut order);
/// assert_eq!(order, [2, 0, 1, 3]);
/// assert_eq!(sort.cells().collect::<Vec<_>>(), [(3, 0), (7, 1)]);
/// ```
#[derive(Debug, Default)]
pub struct RaySort {
    radix: RadixSort,
    /// Hashes of the runs, sorted.
    hashes: Vec<u32>,
    /// Where each run begins among the rays.
    bases: Vec<u32>,
    /// For each ray, whether a run begins there; and once more behind the last.
    heads: Vec<u64>,
    /// Whether most runs were of one ray, so that the rays were sorted one by one.
    single: bool,
}

impl RaySort {
    /// Writes the numbers of the rays by ascending hash to `order`; those of equal hash stay in order.
    ///
    /// # Panics
    /// If there are more than [`u32::MAX`].
    pub fn order(&mut self, level: Level, hashes: &[u32], order: &mut Vec<u32>) {
        order.resize(hashes.len(), 0);
        let runs = self.find_runs(level, hashes);
        self.single = 4 * runs.iter().sum::<usize>() > 3 * hashes.len();
        if self.single {
            self.hashes.clear();
            self.hashes.extend_from_slice(hashes);
            order.iter_mut().zip(0..).for_each(|(to, i)| *to = i);
            return self.radix.sort(&mut self.hashes, order);
        }
        self.compress(level, hashes, &runs);
        self.radix.sort(&mut self.hashes, &mut self.bases);
        self.decompress(level, order);
    }

    /// How many runs of rays were sorted: those of equal hashes, unless most are of a single ray; then each ray is one.
    #[must_use]
    pub fn runs(&self) -> usize {
        self.hashes.len()
    }

    /// Each hash and the place of its first ray in the order.
    pub fn cells(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        let mut end = 0;
        self.hashes.iter().enumerate().filter_map(move |(i, &hash)| {
            let start = end;
            end += if self.single { 1 } else { size(&self.heads, self.bases[i]) };
            (i == 0 || self.hashes[i - 1] != hash).then_some((hash, start))
        })
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        let words = self.hashes.capacity() + self.bases.capacity() + 2 * self.heads.capacity();
        self.radix.bytes() + size_of::<u32>() * words
    }

    /// Marks where runs begin; returns how many do in each chunk.
    fn find_runs(&mut self, level: Level, hashes: &[u32]) -> Vec<usize> {
        let len = hashes.len();
        assert!(u32::try_from(len).is_ok(), "{len} rays are too many to sort");
        self.heads.resize(len / 64 + 1, 0);
        let before = |i: usize| if i == 0 { !hashes[0] } else { hashes[i * CHUNK - 1] };
        let chunks = hashes.par_chunks(CHUNK).zip(self.heads.par_chunks_mut(CHUNK / 64)).enumerate();
        chunks.map(|(i, (hashes, heads))| find_heads(level, before(i), hashes, heads)).collect()
    }

    /// Lists the runs, so many for each chunk.
    fn compress(&mut self, level: Level, hashes: &[u32], runs: &[usize]) {
        let total = runs.iter().sum();
        self.hashes.resize(total, 0);
        self.bases.resize(total, 0);
        let (mut rest_hashes, mut rest_bases) = (&mut self.hashes[..], &mut self.bases[..]);
        let mut places = Vec::with_capacity(runs.len());
        for &count in runs {
            let (hashes, bases);
            (hashes, rest_hashes) = rest_hashes.split_at_mut(count);
            (bases, rest_bases) = rest_bases.split_at_mut(count);
            places.push((hashes, bases));
        }
        let chunks = hashes.par_chunks(CHUNK).zip(self.heads.par_chunks(CHUNK / 64)).zip(places).enumerate();
        chunks.for_each(|(i, ((hashes, heads), (to_hashes, to_bases)))| {
            pick(level, (i * CHUNK) as u32, hashes, heads, to_hashes, to_bases);
        });
        let len = hashes.len();
        let last = &mut self.heads[len / 64];
        *last = if len.is_multiple_of(64) { 1 } else { *last | 1 << (len % 64) };
    }

    /// Writes the rays of the runs, in the order of the runs.
    fn decompress(&self, level: Level, order: &mut [u32]) {
        let heads = &self.heads[..];
        if rayon::current_num_threads() == 1 {
            expand(level, &self.bases, heads, order);
            return;
        }
        let sizes: Vec<usize> = self.bases.par_chunks(CHUNK).map(|bases| total_size(heads, bases)).collect();
        let mut rest = order;
        let mut places = Vec::with_capacity(sizes.len());
        for size in sizes {
            let place;
            (place, rest) = rest.split_at_mut(size);
            places.push(place);
        }
        self.bases.par_chunks(CHUNK).zip(places).for_each(|(bases, place)| expand(level, bases, heads, place));
    }
}

/// The number of rays in the run that begins at `base`.
#[inline(always)]
fn size(heads: &[u64], base: u32) -> u32 {
    let next = base as usize + 1;
    let mut word = next / 64;
    let mut bits = heads[word] >> (next % 64) << (next % 64);
    while bits == 0 {
        word += 1;
        bits = heads[word];
    }
    (64 * word) as u32 + bits.trailing_zeros() - base
}

fn total_size(heads: &[u64], bases: &[u32]) -> usize {
    bases.iter().map(|&base| size(heads, base) as usize).sum()
}

kernel! {
    /// Marks the hashes that differ from the one before, `before` being that before the first; returns their number.
    fn find_heads<S>(before: u32, hashes: &[u32], heads: &mut [u64]) -> usize {
        let lanes = Native::<S>::LANES;
        let one = <Native<S> as Vector>::Mask::first_n(1);
        let mut before = Native::<S>::splat(before);
        let mut count = 0;
        for (hashes, word) in hashes.chunks(64).zip(heads) {
            let mut bits = 0;
            for i in 0..64 / lanes {
                let rest = &hashes[(i * lanes).min(hashes.len())..];
                let these = Native::<S>::load_partial(rest);
                // The last lane first, from the hashes before.
                let up = these.rotate_lanes_right(1);
                let differ = these.ne(Native::<S>::select(one, before, up)).bitmask();
                before = up;
                let on = if rest.len() < lanes { (1 << rest.len()) - 1 } else { u32::MAX };
                bits |= u64::from(differ & on) << (i * lanes);
            }
            *word = bits;
            count += bits.count_ones() as usize;
        }
        count
    }
}

kernel! {
    /// The hashes that are marked, and their places, the first of the chunk being `first`.
    fn pick<S>(first: u32, hashes: &[u32], heads: &[u64], to_hashes: &mut [u32], to_places: &mut [u32]) {
        let lanes = Native::<S>::LANES;
        let mut places = Native::<S>::splat(first) + Native::<S>::from_fn(|i| i as u32);
        let mut count = 0;
        for (hashes, &word) in hashes.chunks(64).zip(heads) {
            for i in 0..64 / lanes {
                let these = Native::<S>::load_partial(&hashes[(i * lanes).min(hashes.len())..]);
                let on = <Native<S> as Vector>::Mask::from_bitmask((word >> (i * lanes)) as u32);
                these.compress_store(on, &mut to_hashes[count..]);
                count += places.compress_store(on, &mut to_places[count..]);
                places += Native::<S>::splat(lanes as u32);
            }
        }
    }
}

kernel! {
    /// The rays of runs, one after the other.
    fn expand<S>(bases: &[u32], heads: &[u64], order: &mut [u32]) {
        let lanes = Native::<S>::LANES;
        let numbers = Native::<S>::from_fn(|i| i as u32);
        let mut done = 0;
        for &base in bases {
            let size = size(heads, base) as usize;
            let mut written = 0;
            // Whole vectors: what is too much, the next run writes over.
            while written < size {
                let rays = Native::<S>::splat(base + written as u32) + numbers;
                rays.store_partial(&mut order[done + written..]);
                written += lanes;
            }
            done += size;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sort::{Chunks, test};

    fn kinds(len: usize) -> Vec<Vec<u32>> {
        let random = test::random(len, 11);
        let runs = |longest: u32| {
            let mut hash = 0;
            let mut rest = 0;
            let next = |&x: &u32| {
                if rest == 0 {
                    (hash, rest) = (x >> 7 & 0x3ff, x % longest + 1);
                }
                rest -= 1;
                hash
            };
            random.iter().map(next).collect::<Vec<u32>>()
        };
        vec![random.clone(), vec![u32::MAX; len], runs(2), runs(9), runs(300), (0..len as u32).collect()]
    }

    #[test]
    fn order_is_that_of_a_stable_sort() {
        test::everywhere(|| {
            for level in Level::available() {
                let mut sort = RaySort::default();
                let mut order = vec![1, 2, 3];
                for len in [0, 1, 2, 63, 64, 65, 1000, CHUNK - 1, CHUNK, CHUNK + 1, 3 * CHUNK + 130] {
                    for hashes in kinds(len) {
                        let mut expected: Vec<u32> = (0..len as u32).collect();
                        expected.sort_by_key(|&i| hashes[i as usize]);
                        sort.order(level, &hashes, &mut order);
                        assert!(order == expected, "{level}, {len}");

                        let sorted: Vec<u32> = order.iter().map(|&i| hashes[i as usize]).collect();
                        let cells = Chunks::compress(level, &sorted);
                        let expected = cells.hash.iter().copied().zip(cells.base.iter().copied());
                        assert!(sort.cells().eq(expected), "{level}, {len}: cells");
                        let runs = Chunks::compress(level, &hashes).base.len();
                        assert_eq!(sort.runs(), if 4 * runs > 3 * len { len } else { runs });
                    }
                }
            }
        });
    }

    /// The scheme as the paper has it, step by step.
    #[test]
    fn order_is_that_of_the_scheme_by_scans() {
        let level = Level::best();
        for hashes in kinds(100_000) {
            let chunks = Chunks::compress(level, &hashes);
            let mut numbers: Vec<u32> = (0..chunks.base.len() as u32).collect();
            let mut hash = chunks.hash.clone();
            RadixSort::new().sort(&mut hash, &mut numbers);
            let of = |list: &[u32]| numbers.iter().map(|&i| list[i as usize]).collect();
            let sorted = Chunks { hash, base: of(&chunks.base), size: of(&chunks.size) };
            let mut order = Vec::new();
            RaySort::default().order(level, &hashes, &mut order);
            assert!(sorted.decompress(level) == order);
        }
    }
}
