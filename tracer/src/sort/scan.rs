//! Scans of `u32`, the primitives that stages of sorting and traversal are made of (Garanzha and Loop 2010, section 2.1; Sengupta,
//! Harris and Garland 2008). Sums wrap.
//!
//! One thread goes over an array once. Several take chunks: first the sum of each, then, from the sums of those before it, its scan.

use super::output::{Source, fill};
use rayon::prelude::*;
use simd::{Integer, Level, Mask, Simd, Uint, Vector, kernel};

/// Elements in a chunk, what a thread takes at a time.
const CHUNK: usize = 1 << 16;

/// The vector of `u32` in a level's registers.
type Native<S> = <<S as Simd>::Float as Vector>::Index;

/// Whether arrays of so many elements are worth several threads.
fn in_chunks(len: usize) -> bool {
    len > CHUNK && rayon::current_num_threads() > 1
}

/// Writes the sum of all elements before each to `sums`, and returns the sum of all.
///
/// ```
/// let mut sums = [0; 4];
/// assert_eq!(tracer::sort::exclusive_scan(simd::Level::best(), &[3, 1, 0, 5], &mut sums), 9);
/// assert_eq!(sums, [0, 3, 4, 4]);
/// ```
///
/// # Panics
/// If the arrays differ in length.
pub fn exclusive_scan(level: Level, values: &[u32], sums: &mut [u32]) -> u32 {
    let len = values.len();
    assert!(sums.len() == len, "a scan of {len} elements to {}", sums.len());
    if !in_chunks(len) {
        return scan_chunk(level, 0, values, sums, len);
    }
    let mut starts: Vec<u32> = values.par_chunks(CHUNK).map(|values| sum_chunk(level, values)).collect();
    let total = accumulate(&mut starts);
    let chunks = values.par_chunks(CHUNK).zip(sums.par_chunks_mut(CHUNK)).zip(&starts);
    chunks.for_each(|((values, sums), &start)| {
        scan_chunk(level, start, values, sums, len);
    });
    total
}

/// Replaces numbers by the sum of those before each; returns the sum of all.
fn accumulate(numbers: &mut [u32]) -> u32 {
    let mut sum = 0_u32;
    for number in numbers {
        (*number, sum) = (sum, sum.wrapping_add(*number));
    }
    sum
}

kernel! {
    /// The scan of a part of an array of `total` elements, from `start` on; returns the sum to go on from.
    fn scan_chunk<S>(start: u32, values: &[u32], sums: &mut [u32], total: usize) -> u32 {
        let mut scan = Scan::<Native<S>> { values, sum: Native::<S>::splat(start) };
        fill(&mut scan, sums, total);
        scan.sum.lane(0)
    }
}

kernel! {
    fn sum_chunk<S>(values: &[u32]) -> u32 {
        let mut sum = Native::<S>::default();
        let (vectors, rest) = values.split_at(values.len() / Native::<S>::LANES * Native::<S>::LANES);
        for values in vectors.chunks_exact(Native::<S>::LANES) {
            sum += Native::<S>::load(values);
        }
        sum += Native::<S>::load_partial(rest);
        sum.reduce_add()
    }
}

/// The sum of all elements before each, and of those before the array's part.
struct Scan<'a, U> {
    values: &'a [u32],
    /// So far, in all lanes.
    sum: U,
}

impl<U: Uint> Source<U> for Scan<'_, U> {
    #[inline(always)]
    fn vector(&mut self, first: usize) -> U {
        let values = U::load(&self.values[first..]);
        let sums = values.prefix_sum();
        let before = self.sum + sums - values;
        self.sum += last_lane(sums);
        before
    }

    #[inline(always)]
    fn single(&mut self, i: usize) -> u32 {
        let before = self.sum.lane(0);
        self.sum += U::splat(self.values[i]);
        before
    }
}

/// The last lane in all lanes.
#[inline(always)]
fn last_lane<U: Uint>(x: U) -> U {
    x.swizzle(|_| U::LANES - 1)
}

/// Adds to each element those before it down to the last head: where `heads` is not zero, a segment begins. Inclusive, in place. Elements before
/// the first head are a segment too.
///
/// ```
/// let mut values = [1, 1, 1, 7, 1];
/// tracer::sort::segmented_scan(simd::Level::best(), &mut values, &[1, 0, 0, 1, 0]);
/// assert_eq!(values, [1, 2, 3, 7, 8]);
/// ```
///
/// # Panics
/// If the arrays differ in length.
pub fn segmented_scan(level: Level, values: &mut [u32], heads: &[u32]) {
    let len = values.len();
    assert!(heads.len() == len, "a scan of {len} elements with {} flags", heads.len());
    if !in_chunks(len) {
        segmented_chunk(level, 0, values, heads);
        return;
    }
    let chunks = values.par_chunks(CHUNK).zip(heads.par_chunks(CHUNK));
    let tails: Vec<Tail> = chunks.map(|(values, heads)| Tail::of(level, values, heads)).collect();
    let mut sum = 0;
    let before = |tail: &Tail| {
        let before = sum;
        sum = if tail.begins { tail.sum } else { tail.sum.wrapping_add(before) };
        before
    };
    let starts: Vec<u32> = tails.iter().map(before).collect();
    let chunks = values.par_chunks_mut(CHUNK).zip(heads.par_chunks(CHUNK)).zip(starts);
    chunks.for_each(|((values, heads), start)| segmented_chunk(level, start, values, heads));
}

/// What a chunk leaves to the next: the segment that is open at its end.
struct Tail {
    /// Whether that begins in the chunk.
    begins: bool,
    /// Of its elements in the chunk.
    sum: u32,
}

impl Tail {
    fn of(level: Level, values: &[u32], heads: &[u32]) -> Self {
        let head = heads.iter().rposition(|&head| head != 0);
        Self { begins: head.is_some(), sum: sum_chunk(level, &values[head.unwrap_or(0)..]) }
    }
}

kernel! {
    /// A part of an array; `start` is the sum of the segment that is open before it.
    fn segmented_chunk<S>(start: u32, values: &mut [u32], heads: &[u32]) {
        let lanes = Native::<S>::LANES;
        let vectors = values.len() / lanes * lanes;
        let mut sum = Native::<S>::splat(start);
        for (values, heads) in values.chunks_exact_mut(lanes).zip(heads.chunks_exact(lanes)) {
            let sums = segmented_vector(sum, Native::<S>::load(values), Native::<S>::load(heads));
            sums.store(values);
            sum = last_lane(sums);
        }
        let (values, heads) = (&mut values[vectors..], &heads[vectors..]);
        let rest = Native::<S>::load_partial(values);
        segmented_vector(sum, rest, Native::<S>::load_partial(heads)).store_partial(values);
    }
}

/// Lane `i` becomes the sum of the lanes from the last head on, and of `before` if there is none up to lane `i`.
#[inline(always)]
fn segmented_vector<U: Uint>(before: U, values: U, heads: U) -> U {
    let heads = heads.ne(U::default()).bitmask();
    // As a prefix sum, but nothing is taken in across a head: `closed` has those lanes with a head among the `n` up to them.
    let (mut sums, mut closed, mut n) = (values, heads, 1);
    while n < U::LANES {
        let open = U::Mask::from_bitmask(!closed & !((1 << n) - 1));
        sums = U::select(open, sums + sums.rotate_lanes_right(n), sums);
        closed |= closed << n;
        n *= 2;
    }
    let before_all_heads = U::Mask::from_bitmask(!heads & heads.wrapping_sub(1));
    U::select(before_all_heads, sums + before, sums)
}

/// Writes 1 where a run of equal keys begins, 0 elsewhere (the paper's figure 4).
///
/// # Panics
/// If the arrays differ in length.
pub fn head_flags(level: Level, keys: &[u32], flags: &mut [u32]) {
    let len = keys.len();
    assert!(flags.len() == len, "flags of {len} keys to {} elements", flags.len());
    let Some((first, rest)) = flags.split_first_mut() else { return };
    *first = 1;
    if !in_chunks(len) {
        return head_flags_chunk(level, keys, rest, len);
    }
    let chunks = rest.par_chunks_mut(CHUNK).enumerate();
    chunks.for_each(|(i, flags)| head_flags_chunk(level, &keys[i * CHUNK..][..flags.len() + 1], flags, len));
}

kernel! {
    /// Flags of all keys but the first, of a part of an array of `total` elements.
    fn head_flags_chunk<S>(keys: &[u32], flags: &mut [u32], total: usize) {
        fill::<Native<S>>(&mut Heads { keys }, flags, total);
    }
}

/// Whether each key differs from the one before it; the first has none.
struct Heads<'a> {
    keys: &'a [u32],
}

impl<U: Uint> Source<U> for Heads<'_> {
    #[inline(always)]
    fn vector(&mut self, first: usize) -> U {
        let keys = &self.keys[first..];
        let differ = U::load(keys).ne(U::load(&keys[1..]));
        U::select(differ, U::splat(1), U::default())
    }

    #[inline(always)]
    fn single(&mut self, i: usize) -> u32 {
        u32::from(self.keys[i] != self.keys[i + 1])
    }
}

/// Writes the places where `flags` is not zero to the front of `places`, ascending, and returns their number: what is written to the places that an
/// exclusive scan of flags gives.
///
/// ```
/// let mut places = [0; 4];
/// assert_eq!(tracer::sort::compact(simd::Level::best(), &[1, 0, 0, 1], &mut places), 2);
/// assert_eq!(places[..2], [0, 3]);
/// ```
///
/// # Panics
/// If `places` has no room for them.
pub fn compact(level: Level, flags: &[u32], places: &mut [u32]) -> usize {
    if !in_chunks(flags.len()) {
        return compact_chunk(level, 0, flags, places);
    }
    let counts: Vec<usize> = flags.par_chunks(CHUNK).map(|flags| count_chunk(level, flags)).collect();
    let (total, room) = (counts.iter().sum(), places.len());
    assert!(total <= room, "{total} places, room for {room}");
    let mut rest = &mut places[..total];
    let mut parts = Vec::with_capacity(counts.len());
    for count in counts {
        let part;
        (part, rest) = rest.split_at_mut(count);
        parts.push(part);
    }
    flags.par_chunks(CHUNK).zip(parts).enumerate().for_each(|(i, (flags, part))| {
        compact_chunk(level, i * CHUNK, flags, part);
    });
    total
}

kernel! {
    fn count_chunk<S>(flags: &[u32]) -> usize {
        let lanes = Native::<S>::LANES;
        let mut count = 0;
        for flags in flags.chunks_exact(lanes) {
            count += Native::<S>::load(flags).ne(Native::<S>::default()).count();
        }
        let rest = &flags[flags.len() / lanes * lanes..];
        count + Native::<S>::load_partial(rest).ne(Native::<S>::default()).count()
    }
}

kernel! {
    /// The places of the flags of a chunk whose first element has the place `first`.
    fn compact_chunk<S>(first: usize, flags: &[u32], places: &mut [u32]) -> usize {
        let lanes = Native::<S>::LANES;
        let mut numbers = Native::<S>::splat(first as u32) + Native::<S>::from_fn(|i| i as u32);
        let mut count = 0;
        for flags in flags.chunks_exact(lanes) {
            let on = Native::<S>::load(flags).ne(Native::<S>::default());
            count += numbers.compress_store(on, &mut places[count..]);
            numbers += Native::<S>::splat(lanes as u32);
        }
        let rest = &flags[flags.len() / lanes * lanes..];
        let on = Native::<S>::load_partial(rest).ne(Native::<S>::default());
        count + numbers.compress_store(on, &mut places[count..])
    }
}

#[cfg(test)]
mod tests;
