//! Against loops.

use super::*;
use crate::sort::test::{self, random};
use rayon::ThreadPoolBuilder;

/// Lengths about those of vectors and chunks.
const LENGTHS: [usize; 12] = [0, 1, 3, 15, 16, 17, 100, 1000, CHUNK - 1, CHUNK, CHUNK + 1, 3 * CHUNK + 77];

/// Flags of which one in `rarity` is on.
fn flags(len: usize, rarity: u32, seed: u32) -> Vec<u32> {
    random(len, seed).iter().map(|x| u32::from(x % rarity == 0)).collect()
}

/// At all levels, on one thread and on several.
fn everywhere(check: impl Fn(Level) + Sync) {
    test::everywhere(|| Level::available().for_each(&check));
}

#[test]
fn exclusive_scans_are_sums_of_what_comes_before() {
    everywhere(|level| {
        for len in LENGTHS {
            // Large enough for sums to wrap.
            let values: Vec<u32> = random(len, 1).iter().map(|x| x << 2).collect();
            let mut sums = vec![7; len];
            let total = exclusive_scan(level, &values, &mut sums);
            let mut sum = 0_u32;
            for (i, value) in values.iter().enumerate() {
                assert_eq!(sums[i], sum, "{level}, {len} elements, {i}");
                sum = sum.wrapping_add(*value);
            }
            assert_eq!(total, sum, "{level}, {len} elements");
        }
    });
}

#[test]
fn segmented_scans_begin_anew_at_heads() {
    everywhere(|level| {
        for len in LENGTHS {
            for rarity in [1, 2, 7, 40, 100_000, u32::MAX] {
                let (values, heads) = (random(len, 2), flags(len, rarity, 3));
                let mut sums = values.clone();
                segmented_scan(level, &mut sums, &heads);
                let mut sum = 0_u32;
                for i in 0..len {
                    sum = if heads[i] != 0 { values[i] } else { sum.wrapping_add(values[i]) };
                    assert_eq!(sums[i], sum, "{level}, {len} elements, 1 in {rarity}, {i}");
                }
            }
        }
    });
}

#[test]
fn head_flags_tell_where_keys_change() {
    everywhere(|level| {
        for len in LENGTHS {
            let keys: Vec<u32> = random(len, 4).iter().map(|x| x % 2).collect();
            let mut flags = vec![9; len];
            head_flags(level, &keys, &mut flags);
            for i in 0..len {
                let expected = u32::from(i == 0 || keys[i] != keys[i - 1]);
                assert_eq!(flags[i], expected, "{level}, {len} keys, {i}");
            }
        }
    });
}

#[test]
fn compaction_lists_the_places_of_flags() {
    everywhere(|level| {
        for len in LENGTHS {
            for rarity in [1, 3, 50, u32::MAX] {
                let flags = flags(len, rarity, 5);
                let expected: Vec<u32> = (0..len as u32).filter(|&i| flags[i as usize] != 0).collect();
                let mut places = vec![0; expected.len()];
                assert_eq!(compact(level, &flags, &mut places), expected.len());
                assert_eq!(places, expected, "{level}, {len} flags");
            }
        }
    });
}

/// Long arrays are written in another way.
#[test]
fn long_arrays() {
    let len = (1 << 22) + 1005;
    let values = random(len, 6);
    let (mut sums, mut flags) = (vec![0; len + 3], vec![0; len]);
    let level = Level::best();
    let total = exclusive_scan(level, &values, &mut sums[3..]);
    head_flags(level, &values, &mut flags);
    let mut sum = 0_u32;
    for i in 0..len {
        assert_eq!(sums[3 + i], sum, "{i}");
        sum = sum.wrapping_add(values[i]);
        assert_eq!(flags[i], u32::from(i == 0 || values[i] != values[i - 1]), "{i}");
    }
    assert_eq!(total, sum);
}

#[test]
#[should_panic(expected = "room for 2")]
fn compaction_without_room() {
    let flags = vec![1; 2 * CHUNK];
    let pool = ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    pool.install(|| compact(Level::best(), &flags, &mut [0; 2]));
}
