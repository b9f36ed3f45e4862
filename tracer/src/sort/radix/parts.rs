//! An array parted by the highest digit of its keys.

use super::digits::distribute;
use super::record::{DIGITS, Record, starts};
use super::source::{GROUP, Group, Source};
use rayon::prelude::*;
use std::ops::Range;

/// Records that a thread takes at a time, at the least.
const CHUNK: usize = 1 << 16;

/// Moves records to `to`, by a byte of their keys, the highest in which they differ; those of the same byte stay in order. Returns
/// where each part ends.
pub(super) fn part<R: Record>(from: &(impl Source<R> + ?Sized), byte: usize, to: &mut [R]) -> [u32; DIGITS] {
    match byte {
        0 => part_by::<R, 0>(from, to),
        1 => part_by::<R, 1>(from, to),
        2 => part_by::<R, 2>(from, to),
        3 => part_by::<R, 3>(from, to),
        4 => part_by::<R, 4>(from, to),
        5 => part_by::<R, 5>(from, to),
        6 => part_by::<R, 6>(from, to),
        _ => part_by::<R, 7>(from, to),
    }
}

fn part_by<R: Record, const BYTE: usize>(from: &(impl Source<R> + ?Sized), to: &mut [R]) -> [u32; DIGITS] {
    let (len, threads) = (from.len(), rayon::current_num_threads());
    if threads == 1 {
        // It ends where the next starts.
        let mut next = starts(&count::<R, BYTE>(from, 0..len));
        distribute::<R, BYTE>(from, to, &mut next);
        return next;
    }
    // The result does not depend on their number.
    let chunks = (4 * threads).min(len / CHUNK).max(1);
    let range = |i: usize| i * len / chunks..(i + 1) * len / chunks;
    let counts: Vec<_> = (0..chunks).into_par_iter().map(|i| count::<R, BYTE>(from, range(i))).collect();
    // Of each part first what the first chunk has, then what the second has, and so on.
    let mut places: Vec<Vec<&mut [R]>> = counts.iter().map(|_| Vec::with_capacity(DIGITS)).collect();
    let (mut ends, mut end, mut rest) = ([0; DIGITS], 0, to);
    for digit in 0..DIGITS {
        for (counts, places) in counts.iter().zip(&mut places) {
            let place;
            (place, rest) = rest.split_at_mut(counts[digit] as usize);
            end += counts[digit];
            places.push(place);
        }
        ends[digit] = end;
    }
    let work = places.into_par_iter().enumerate();
    work.for_each(|(i, mut places)| distribute_range::<R, BYTE>(from, range(i), &mut places));
    ends
}

fn count<R: Record, const BYTE: usize>(from: &(impl Source<R> + ?Sized), range: Range<usize>) -> [u32; DIGITS] {
    let mut counts = [0; DIGITS];
    from.keys(range).for_each(|key| counts[R::new(key, 0).digit::<BYTE>()] += 1);
    counts
}

/// Moves the records of a range to the places of their digits, which have room for them alone.
fn distribute_range<R: Record, const BYTE: usize>(
    from: &(impl Source<R> + ?Sized),
    range: Range<usize>,
    places: &mut [&mut [R]],
) {
    let Some(places) = places.first_chunk_mut::<DIGITS>() else { return };
    let mut next = [0_u32; DIGITS];
    let groups = from.groups(range.clone()).flat_map(|group| (0..GROUP).map(move |i| group.get(i)));
    for record in groups.chain(from.rest(range)) {
        let digit = record.digit::<BYTE>();
        places[digit][next[digit] as usize] = record;
        next[digit] += 1;
    }
}
