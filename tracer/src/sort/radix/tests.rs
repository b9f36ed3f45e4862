//! Against the stable sort of the standard library.

use super::*;
use crate::sort::test::{everywhere, random};

/// Keys of several kinds.
fn kinds(len: usize) -> Vec<(&'static str, Vec<u32>)> {
    let random = random(len, 1);
    let of = |f: &dyn Fn(usize, u32) -> u32| random.iter().enumerate().map(|(i, &x)| f(i, x)).collect();
    vec![
        ("random", of(&|_, x| x)),
        ("equal", of(&|_, _| 0xdead_beef)),
        ("two", of(&|_, x| (x % 2) << 31)),
        ("low bits", of(&|_, x| x % 300)),
        ("high bits", of(&|_, x| x << 20)),
        ("ascending", of(&|i, _| i as u32)),
        ("descending", of(&|i, _| u32::MAX - i as u32)),
        ("runs", of(&|i, _| (i as u32 / 5).wrapping_mul(0x9e37_79b9))),
        ("extremes", of(&|_, x| if x % 2 == 0 { 0 } else { u32::MAX })),
        ("most in one part", of(&|_, x| if x % 64 == 0 { x } else { x % (1 << 20) })),
    ]
}

const LENGTHS: [usize; 10] = [0, 1, 2, 7, 63, 64, 1000, 70_001, LARGE + 1, 2 * LARGE + 13];

#[test]
fn sorts_as_the_standard_library_does() {
    everywhere(|| {
        let mut sort = RadixSort::new();
        for len in LENGTHS {
            for (kind, keys) in kinds(len) {
                // Values that tell where they were.
                let mut expected: Vec<(u32, u32)> = keys.iter().copied().zip(0..).collect();
                expected.sort_by_key(|&(key, _)| key);
                let (mut sorted, mut values) = (keys.clone(), (0..len as u32).collect::<Vec<u32>>());
                sort.sort(&mut sorted, &mut values);
                assert!(sorted.iter().copied().zip(values).eq(expected), "{kind}, {len}");
            }
        }
    });
}

#[test]
fn sorts_long_keys() {
    everywhere(|| {
        let mut sort = RadixSort::new();
        for len in LENGTHS {
            for (kind, keys) in kinds(len) {
                let spread = |(i, &key): (usize, &u32)| u64::from(key) << (i % 3 * 16) | u64::from(key) >> 7;
                for keys in [
                    keys.iter().enumerate().map(spread).collect::<Vec<u64>>(),
                    keys.iter().map(|&k| k.into()).collect(),
                ] {
                    let mut expected: Vec<(u64, u32)> = keys.iter().copied().zip(0..).collect();
                    expected.sort_by_key(|&(key, _)| key);
                    let (mut sorted, mut values) = (keys.clone(), (0..len as u32).collect::<Vec<u32>>());
                    sort.sort_64(&mut sorted, &mut values);
                    assert!(sorted.iter().copied().zip(values).eq(expected), "{kind}, {len}");
                }
            }
        }
    });
}

#[test]
#[should_panic(expected = "3 keys with 2 values")]
fn arrays_of_different_lengths() {
    RadixSort::new().sort(&mut [1, 2, 3], &mut [1, 2]);
}
