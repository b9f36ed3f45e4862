//! A stable radix sort of keys with values.
//!
//! Arrays that do not fit into the second-level cache are first parted by their highest digit, once through memory; the parts are then sorted from
//! the lowest digit to the highest, in the cache. A pass in the cache takes half the time of one through memory, and parts are what threads
//! take. Both ways of sorting are stable, so the order is the same whatever the parts.

mod digits;
mod parts;
mod record;
mod source;

use digits::{Room, sort_digits};
use parts::part;
use rayon::prelude::*;
use record::{DIGITS, Long, Record};
use source::Arrays;

/// More records than these are parted: they and the room to move them lie in the third-level cache.
const LARGE: usize = 1 << 18;
/// Fewer are sorted by comparison.
const SMALL: usize = 64;

/// A stable sort of keys with values, and the memory it needs, which is used again: 8 bytes for each key of 32 bits, 16 for each of 64,
/// and some megabytes for each thread. Where very many keys have the same highest byte and differ in the next, they take as much again while they are
/// sorted.
///
/// ```
/// let (mut keys, mut values) = ([5, 1, 5, 0], [0, 1, 2, 3]);
/// tracer::sort::RadixSort::new().sort(&mut keys, &mut values);
/// assert_eq!((keys, values), ([0, 1, 5, 5], [3, 1, 0, 2]));
/// ```
#[derive(Debug, Default)]
pub struct RadixSort {
    short: Memory<u64>,
    long: Memory<Long>,
}

impl RadixSort {
    /// Without memory yet.
    #[must_use]
    pub const fn new() -> Self {
        Self { short: Memory::new(), long: Memory::new() }
    }

    /// Sorts by keys of 32 bits; what has the same key stays in order.
    ///
    /// # Panics
    /// If the arrays differ in length or are longer than [`u32::MAX`].
    pub fn sort(&mut self, keys: &mut [u32], values: &mut [u32]) {
        self.short.sort(keys, values);
    }

    /// The same of keys of 64 bits.
    ///
    /// # Panics
    /// As [`RadixSort::sort`].
    pub fn sort_64(&mut self, keys: &mut [u64], values: &mut [u32]) {
        self.long.sort(keys, values);
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        self.short.bytes() + self.long.bytes()
    }
}

/// What is used again.
#[derive(Debug, Default)]
struct Memory<R> {
    records: Vec<R>,
    room: Room<R>,
}

impl<R: Record> Memory<R> {
    const fn new() -> Self {
        Self { records: Vec::new(), room: Room([const { Vec::new() }; 2]) }
    }

    fn bytes(&self) -> usize {
        let room = self.room.0.iter().map(Vec::capacity).sum::<usize>();
        size_of::<R>() * (self.records.capacity() + room)
    }

    fn sort(&mut self, keys: &mut [R::Key], values: &mut [u32]) {
        let len = keys.len();
        assert!(values.len() == len, "{len} keys with {} values", values.len());
        assert!(u32::try_from(len).is_ok(), "{len} keys are too many to sort");
        let bytes = differing_bytes(keys.iter().map(|&key| key.into()));
        if bytes == 0 {
            return;
        }
        let records = long_enough(&mut self.records, len);
        let arrays = Arrays { keys, values };
        if len > LARGE {
            let ends = part(&arrays, bytes - 1, records);
            return sort_parts(&ends, records, arrays, bytes - 1, &mut self.room);
        }
        for ((record, &key), &value) in records.iter_mut().zip(&*arrays.keys).zip(&*arrays.values) {
            *record = R::new(key, value);
        }
        sort(records, arrays, bytes, &mut self.room);
    }
}

/// The first `len` elements of memory that is made that long.
fn long_enough<R: Record>(memory: &mut Vec<R>, len: usize) -> &mut [R] {
    if memory.len() < len {
        *memory = simd::vec_in_huge_pages(len);
        memory.resize(len, R::default());
    }
    &mut memory[..len]
}

/// The number of low bytes in which keys differ: above them they are all the same.
fn differing_bytes(mut keys: impl Iterator<Item = u64>) -> usize {
    let Some(first) = keys.next() else { return 0 };
    let differing = keys.fold(0, |bits, key| bits | (key ^ first));
    (u64::BITS - differing.leading_zeros()).div_ceil(8) as usize
}

/// Sorts records by the lowest `bytes` bytes of their keys, and writes them to `out`.
fn sort<R: Record>(records: &[R], out: Arrays<'_, R>, bytes: usize, room: &mut Room<R>) {
    let len = records.len();
    // A byte that is the same in all of them is no reason to move them.
    let differing = || differing_bytes(records.iter().map(|record| record.key().into()));
    let bytes = if len > LARGE { differing().min(bytes) } else { bytes };
    if len > LARGE && bytes > 1 {
        let mut parted = Vec::new();
        let parted = long_enough(&mut parted, len);
        let ends = part(records, bytes - 1, parted);
        sort_parts(&ends, parted, out, bytes - 1, room);
    } else if len < SMALL {
        let (sorted, _) = room.of(len);
        sorted.copy_from_slice(records);
        sorted.sort_by_key(|record| record.key().into());
        out.fill(sorted);
    } else {
        sort_digits(records, out, bytes, room);
    }
}

/// Sorts each of the parts of an array, which are told by where they end.
fn sort_parts<R: Record>(ends: &[u32; DIGITS], records: &[R], out: Arrays<'_, R>, bytes: usize, room: &mut Room<R>) {
    let mut parts = Vec::with_capacity(DIGITS);
    let (mut start, mut out) = (0, out);
    for &end in ends {
        let end = end as usize;
        let (this, rest) = out.split_at(end - start);
        if end > start {
            parts.push((&records[start..end], this));
        }
        (start, out) = (end, rest);
    }
    if rayon::current_num_threads() == 1 {
        parts.into_iter().for_each(|(records, out)| sort(records, out, bytes, room));
    } else {
        parts.into_par_iter().for_each_init(Room::default, |room, (records, out)| sort(records, out, bytes, room));
    }
}

#[cfg(test)]
mod tests;
