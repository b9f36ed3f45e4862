//! Passes from the lowest digit to the highest, for arrays that fit into the caches.

use super::long_enough;
use super::record::{DIGITS, Record, starts};
use super::source::{Arrays, GROUP, Group, Source};
use std::mem::swap;

/// Two arrays that records are moved to in turn. They stay in the cache from part to part.
#[derive(Debug, Default)]
pub(super) struct Room<R>(pub(super) [Vec<R>; 2]);

impl<R: Record> Room<R> {
    /// Of `len` records each.
    pub(super) fn of(&mut self, len: usize) -> (&mut [R], &mut [R]) {
        let [one, other] = &mut self.0;
        (long_enough(one, len), long_enough(other, len))
    }
}

/// Sorts records by the lowest `bytes` bytes of their keys, and writes them to `out`. Bytes that are the same in all keys are left out.
pub(super) fn sort_digits<R: Record>(records: &[R], out: Arrays<'_, R>, bytes: usize, room: &mut Room<R>) {
    let mut passes = Passes { records, moved: false, room: room.of(records.len()) };
    match bytes {
        0 => {}
        1 => passes.all::<1>(),
        2 => passes.all::<2>(),
        3 => passes.all::<3>(),
        4 => passes.all::<4>(),
        5 | 6 => passes.all::<6>(),
        _ => passes.all::<8>(),
    }
    out.fill(if passes.moved { passes.room.0 } else { records });
}

/// Records on their way.
struct Passes<'a, R> {
    records: &'a [R],
    /// Whether they are in the first array of the room by now.
    moved: bool,
    room: (&'a mut [R], &'a mut [R]),
}

impl<R: Record> Passes<'_, R> {
    fn all<const BYTES: usize>(&mut self) {
        let counts = histograms::<R, BYTES>(self.records);
        for (byte, counts) in counts.iter().enumerate() {
            match byte {
                0 => self.one::<0>(counts),
                1 => self.one::<1>(counts),
                2 => self.one::<2>(counts),
                3 => self.one::<3>(counts),
                4 => self.one::<4>(counts),
                5 => self.one::<5>(counts),
                6 => self.one::<6>(counts),
                _ => self.one::<7>(counts),
            }
        }
    }

    fn one<const BYTE: usize>(&mut self, counts: &[u32; DIGITS]) {
        if self.records.first().is_none_or(|first| counts[first.digit::<BYTE>()] as usize == self.records.len()) {
            return;
        }
        let (to, free) = &mut self.room;
        if self.moved {
            distribute::<R, BYTE>(&**to, free, &mut starts(counts));
            swap(to, free);
        } else {
            distribute::<R, BYTE>(self.records, to, &mut starts(counts));
            self.moved = true;
        }
    }
}

/// How often each digit occurs, of all passes in one sweep.
fn histograms<R: Record, const BYTES: usize>(records: &[R]) -> [[u32; DIGITS]; BYTES] {
    let mut counts = [[0; DIGITS]; BYTES];
    for &record in records {
        let key: u64 = record.key().into();
        for (byte, counts) in counts.iter_mut().enumerate() {
            counts[(key >> (8 * byte)) as usize % DIGITS] += 1;
        }
    }
    counts
}

/// Moves records to where `next` says for their digit.
pub(super) fn distribute<R: Record, const BYTE: usize>(
    from: &(impl Source<R> + ?Sized),
    to: &mut [R],
    next: &mut [u32; DIGITS],
) {
    let len = from.len();
    for group in from.groups(0..len) {
        let mut digits = [0; GROUP];
        for (i, digit) in digits.iter_mut().enumerate() {
            *digit = group.get(i).digit::<BYTE>();
        }
        for (i, &digit) in digits.iter().enumerate() {
            let place = next[digit];
            to[place as usize] = group.get(i);
            next[digit] = place + 1;
        }
    }
    for record in from.rest(0..len) {
        let digit = record.digit::<BYTE>();
        to[next[digit] as usize] = record;
        next[digit] += 1;
    }
}
