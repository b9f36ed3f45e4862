//! Masks.

use crate::harness::{Width, everywhere};
use crate::values::Random;
use simd::{Float, Mask};

/// Everything there is to know about two masks.
#[derive(Debug, PartialEq)]
struct Observed {
    bits: u32,
    any: bool,
    all: bool,
    none: bool,
    count: usize,
    first: Option<usize>,
    last: Option<usize>,
    set_lanes: Vec<usize>,
    /// With the other mask, itself and the default.
    equal: [bool; 3],
    not: u32,
    /// `&`, `|`, `^`, then the assigning forms.
    with_other: [u32; 6],
}

#[inline(always)]
fn observe_all<F: Float>(pairs: &[(u32, u32)]) -> Vec<Observed> {
    let observe = |&(a, b): &(u32, u32)| {
        let (a, b) = (F::Mask::from_bitmask(a), F::Mask::from_bitmask(b));
        let (mut and, mut or, mut xor) = (a, a, a);
        and &= b;
        or |= b;
        xor ^= b;
        Observed {
            bits: a.bitmask(),
            any: a.any(),
            all: a.all(),
            none: a.none(),
            count: a.count(),
            first: a.first(),
            last: a.last(),
            set_lanes: a.set_lanes().collect(),
            equal: [a == b, a == !!a, a == F::Mask::default()],
            not: (!a).bitmask(),
            with_other: [a & b, a | b, a ^ b, and, or, xor].map(F::Mask::bitmask),
        }
    };
    pairs.iter().map(observe).collect()
}

simd::kernel! {
    fn observe<S>(width: Width, pairs: &[(u32, u32)]) -> Vec<Observed> {
        at_width!(S, width, observe_all(pairs))
    }
}

/// The bits of `lanes` lanes.
fn low_bits(lanes: usize) -> u32 {
    (1 << lanes) - 1
}

fn expected((a, b): (u32, u32), lanes: usize) -> Observed {
    let all = low_bits(lanes);
    let (a, b) = (a & all, b & all);
    Observed {
        bits: a,
        any: a != 0,
        all: a == all,
        none: a == 0,
        count: (0..lanes).filter(|i| a >> i & 1 == 1).count(),
        first: (0..lanes).find(|i| a >> i & 1 == 1),
        last: (0..lanes).rev().find(|i| a >> i & 1 == 1),
        set_lanes: (0..lanes).filter(|i| a >> i & 1 == 1).collect(),
        equal: [a == b, true, a == 0],
        not: a ^ all,
        with_other: [a & b, a | b, a ^ b, a & b, a | b, a ^ b],
    }
}

/// Every mask of sixteen lanes, with higher bits that have to be ignored, beside a random one.
#[test]
fn every_mask() {
    let mut random = Random(2);
    let pairs: Vec<(u32, u32)> =
        (0..1 << 16).map(|a| (a | if a % 3 == 0 { 0 } else { random.bits() << 16 }, random.bits())).collect();
    for (level, width) in everywhere() {
        let observed = observe(level, width, &pairs);
        for (observed, &pair) in observed.iter().zip(&pairs) {
            assert_eq!(*observed, expected(pair, width.lanes()), "{level}, {width:?}, {pair:x?}");
        }
    }
}

#[inline(always)]
fn constructed_masks<F: Float>(n: usize) -> [u32; 3] {
    [F::Mask::first_n(n), F::Mask::splat(false), F::Mask::splat(true)].map(F::Mask::bitmask)
}

simd::kernel! {
    fn constructed<S>(width: Width, n: usize) -> [u32; 3] {
        at_width!(S, width, constructed_masks(n))
    }
}

#[test]
fn first_n_and_splat() {
    for (level, width) in everywhere() {
        for n in (0..40).chain([1 << 31, usize::MAX]) {
            let first_n = (0..width.lanes()).filter(|&i| i < n).map(|i| 1 << i).sum();
            let expected = [first_n, 0, low_bits(width.lanes())];
            assert_eq!(constructed(level, width, n), expected, "{level}, {width:?}, {n}");
        }
    }
}
