//! Times of scans and sorts.

use super::median_ms;
use crate::report::clock::timed;
use rdst::{RadixKey, RadixSort as _};
use serde::Serialize;
use simd::{Block, Level, Vector, kernel};
use std::cmp::Ordering;
use tracer::sort::{RadixSort, RaySort, compact, exclusive_scan, head_flags, segmented_scan};
use voracious_radix_sort::{RadixSort as _, Radixable};

/// Milliseconds for a number of elements.
#[derive(Debug, Clone, Serialize)]
pub struct ScanTimes {
    pub number: usize,
    /// From one array to another, as the standard library copies or past the caches, whichever is faster.
    pub copy: f64,
    pub exclusive: f64,
    pub segmented: f64,
    pub heads: f64,
    pub compact: f64,
}

/// Times scans of `number` elements, of which every fourth begins a segment.
pub fn scans(number: usize, repeat: usize) -> ScanTimes {
    let level = Level::best();
    let values: Vec<u32> = (0..number as u32).map(|i| i.wrapping_mul(0x9e37_79b9) >> 20).collect();
    let keys: Vec<u32> = (0..number as u32).map(|i| i / 4).collect();
    let mut flags = vec![0; number];
    head_flags(level, &keys, &mut flags);
    let (mut to, mut sums) = (vec![0; number], values.clone());
    let mut times: [Vec<f64>; 5] = Default::default();
    for _ in 0..=repeat {
        let round = [
            copy_time(&values, &mut to),
            timed(|| exclusive_scan(level, &values, &mut to)).1,
            timed(|| segmented_scan(level, &mut sums, &flags)).1,
            timed(|| head_flags(level, &keys, &mut to)).1,
            timed(|| compact(level, &flags, &mut to)).1,
        ];
        times.iter_mut().zip(round).for_each(|(times, time)| times.push(time));
    }
    // The first round warms up.
    let [copy, exclusive, segmented, heads, compact] = times.map(|mut times| median_ms(times.split_off(1)));
    ScanTimes { number, copy, exclusive, segmented, heads, compact }
}

/// The seconds to copy an array, by the faster of two ways.
fn copy_time(from: &[u32], to: &mut [u32]) -> f64 {
    let plain = timed(|| to.copy_from_slice(from)).1;
    let past_caches = timed(|| stream(Level::best(), from, to)).1;
    plain.min(past_caches)
}

kernel! {
    /// Writes past the caches: memory that is written whole need not be read first.
    fn stream<S>(from: &[u32], to: &mut [u32]) {
        let lanes = <S::Float as Vector>::Index::LANES;
        let ahead = to.as_ptr().align_offset(align_of::<Block<u32>>()).min(to.len());
        let (from_head, from) = from.split_at(ahead);
        let (to_head, to) = to.split_at_mut(ahead);
        to_head.copy_from_slice(from_head);
        let whole = to.len() / 16 * 16;
        let (to, to_rest) = to.split_at_mut(whole);
        if let Some(blocks) = Block::slice_of_mut(to) {
            <S::Float as Vector>::Index::stream(blocks, |i| <S::Float as Vector>::Index::load(&from[lanes * i..]));
        }
        to_rest.copy_from_slice(&from[whole..]);
    }
}

/// Keys to be sorted.
#[derive(Debug, Clone)]
pub struct Keys {
    pub name: String,
    pub keys: Vec<u32>,
}

impl Keys {
    /// Without any order.
    pub fn random(number: usize) -> Self {
        let mut state = 1_u64;
        let next = |_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 32) as u32
        };
        Self { name: "random".into(), keys: (0..number).map(next).collect() }
    }
}

/// Milliseconds for keys with values.
#[derive(Debug, Clone, Serialize)]
pub struct SortTimes {
    pub keys: String,
    pub number: usize,
    /// Keys in a run of equal ones, as they come.
    pub run: f64,
    /// Copying keys and values once, the faster way: what a pass can be measured by.
    pub copy: f64,
    /// [`RadixSort`].
    pub radix: f64,
    pub rdst: f64,
    pub voracious: f64,
    /// `sort_unstable_by_key`.
    pub std: f64,
    /// [`RaySort`]: compression, sort, decompression, from hashes to the order of rays.
    pub compressed: f64,
    /// Whether all sorts found the same order of keys, and both of ours the same order of values.
    pub same: bool,
}

/// A key and its value, as other crates sort them.
#[derive(Debug, Clone, Copy)]
struct Pair {
    key: u32,
    value: u32,
}

impl RadixKey for Pair {
    const LEVELS: usize = 4;

    #[inline]
    fn get_level(&self, level: usize) -> u8 {
        (self.key >> (8 * level)) as u8
    }
}

impl PartialEq for Pair {
    fn eq(&self, other: &Self) -> bool {
        self.key == other.key
    }
}

impl PartialOrd for Pair {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.key.partial_cmp(&other.key)
    }
}

impl Radixable<u32> for Pair {
    type Key = u32;

    #[inline]
    fn key(&self) -> u32 {
        self.key
    }
}

/// Times our sort, others, and the scheme of compression on the same keys.
pub fn sorts(keys: &Keys, repeat: usize) -> SortTimes {
    let Keys { name, keys } = keys;
    let number = keys.len();
    let pairs: Vec<Pair> = keys.iter().zip(0..).map(|(&key, value)| Pair { key, value }).collect();
    let mut copied = pairs.clone();
    let words: Vec<u32> = pairs.iter().flat_map(|pair| [pair.key, pair.value]).collect();
    let mut words_to = words.clone();
    let (mut radix, mut scheme) = (RadixSort::new(), RaySort::default());
    let (mut sorted, mut values, mut order) = (Vec::new(), Vec::new(), Vec::new());
    let mut times: [Vec<f64>; 6] = Default::default();
    let mut same = true;
    for _ in 0..=repeat {
        sorted.clone_from(keys);
        values.clear();
        values.extend(0..number as u32);
        let copy = copy_time(&words, &mut words_to);
        let ours = timed(|| radix.sort(&mut sorted, &mut values)).1;
        let mut other = |sort: &dyn Fn(&mut [Pair])| {
            copied.copy_from_slice(&pairs);
            let seconds = timed(|| sort(&mut copied)).1;
            same &= copied.iter().map(|pair| pair.key).eq(sorted.iter().copied());
            // Not all of them are stable.
            same &= copied.iter().all(|pair| keys[pair.value as usize] == pair.key);
            seconds
        };
        let rdst = other(&|pairs| pairs.radix_sort_builder().with_parallel(false).with_single_threaded_tuner().sort());
        let voracious = other(&|pairs| pairs.voracious_sort());
        let std = other(&|pairs| pairs.sort_unstable_by_key(|pair| pair.key));
        let compressed = timed(|| scheme.order(Level::best(), keys, &mut order)).1;
        same &= order == values;
        let round = [copy, ours, rdst, voracious, std, compressed];
        times.iter_mut().zip(round).for_each(|(times, time)| times.push(time));
    }
    let [copy, radix, rdst, voracious, std, compressed] = times.map(|mut times| median_ms(times.split_off(1)));
    let runs = 1 + keys.windows(2).filter(|pair| pair[0] != pair[1]).count();
    let run = number as f64 / runs as f64;
    SortTimes { keys: name.clone(), number, run, copy, radix, rdst, voracious, std, compressed, same }
}
