//! How accurate the computed functions are, against `f64`, and their special values. One lane is enough: that every level
//! gives its bits is tested with the operations.

use simd::math::{exp2, log2, pow};
use simd::{Level, Vector};
use std::ops::RangeInclusive;

const INF: f32 = f32::INFINITY;
const NAN: f32 = f32::NAN;

/// The distance to the exact result in units of its last place.
fn ulps(got: f32, exact: f64) -> f64 {
    if got.is_nan() || exact.is_nan() {
        return if got.is_nan() && exact.is_nan() { 0.0 } else { f64::INFINITY };
    }
    // Where the result overflows, 2^128 is the number that comes after the largest one.
    let limit = 2.0_f64.powi(128);
    let (got, exact) = (f64::from(got).clamp(-limit, limit), exact.clamp(-limit, limit));
    let exponent = (exact.abs().to_bits() >> 52) as i32 - 1023;
    (got - exact).abs() / 2.0_f64.powi(exponent.clamp(-126, 127) - 23)
}

/// The worst of many results, and its arguments.
#[derive(Default)]
struct Worst {
    ulps: f64,
    arguments: [f32; 2],
}

impl Worst {
    fn take(&mut self, got: f32, exact: f64, arguments: [f32; 2]) {
        let ulps = ulps(got, exact);
        if ulps > self.ulps {
            *self = Self { ulps, arguments };
        }
    }

    fn check(&self, bound: f64) {
        assert!(self.ulps < bound, "{} ulp at {:?}", self.ulps, self.arguments);
    }
}

simd::kernel! {
    fn exp2_of_all<S>(x: &mut [f32]) {
        for x in x.chunks_exact_mut(S::Float16::LANES) {
            exp2(S::Float16::load(x)).store(x);
        }
    }
}

simd::kernel! {
    fn log2_of_all<S>(x: &mut [f32]) {
        for x in x.chunks_exact_mut(S::Float16::LANES) {
            log2(S::Float16::load(x)).store(x);
        }
    }
}

simd::kernel! {
    /// In place of the bases.
    fn pow_of_all<S>(x: &mut [f32], y: &[f32]) {
        for (x, y) in x.chunks_exact_mut(S::Float16::LANES).zip(y.chunks_exact(S::Float16::LANES)) {
            pow(S::Float16::load(x), S::Float16::load(y)).store(x);
        }
    }
}

/// The worst result for the floats with these bit patterns.
fn worst_of(patterns: RangeInclusive<u32>, function: fn(Level, &mut [f32]), exact: fn(f64) -> f64) -> Worst {
    let level = Level::best();
    let mut worst = Worst::default();
    let mut first = *patterns.start() & !15;
    loop {
        let last = first.saturating_add((1 << 16) - 1).min(*patterns.end() | 15);
        let x: Vec<f32> = (first..=last).map(f32::from_bits).collect();
        let mut got = x.clone();
        function(level, &mut got);
        for (&x, got) in x.iter().zip(got) {
            worst.take(got, exact(f64::from(x)), [x, 0.0]);
        }
        if last >= *patterns.end() {
            return worst;
        }
        first = last + 1;
    }
}

fn bits_between(low: f32, high: f32) -> RangeInclusive<u32> {
    low.to_bits()..=high.to_bits()
}

#[test]
fn exp2_of_a_binade() {
    for sign in [1.0, -1.0] {
        for (low, high) in [(0.5, 1.0), (1.0, 1.01), (64.0, 64.5), (127.5, 128.5), (125.9, 126.1), (148.9, 151.1)] {
            worst_of(bits_between(sign * low, sign * high), exp2_of_all, f64::exp2).check(1.19);
        }
    }
}

#[test]
fn log2_of_two_binades() {
    // Denormals, and either side of 1, where the result vanishes.
    for (low, high) in [(f32::from_bits(1), 1.0e-40), (1.1e-38, 1.2e-38), (0.5, 2.0), (1.0e38, 1.1e38)] {
        worst_of(bits_between(low, high), log2_of_all, f64::log2).check(0.501);
    }
}

#[test]
#[ignore = "minutes"]
fn every_float() {
    worst_of(0..=u32::MAX, exp2_of_all, f64::exp2).check(1.19);
    worst_of(0..=u32::MAX, log2_of_all, f64::log2).check(0.501);
}

#[test]
fn pow_of_random_pairs() {
    let mut state = 1_u64;
    let mut random = || {
        // Knuth's MMIX generator; the upper half is the random one.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 32) as u32
    };
    let n = 1 << 22;
    let (mut x, mut y) = (Vec::with_capacity(n), Vec::with_capacity(n));
    for i in 0..n {
        // Any base; between 1/2 and 2; near 1, at all distances.
        let base = f32::from_bits(match i % 3 {
            0 => 1 + random() % (INF.to_bits() - 1),
            1 => 0.5_f32.to_bits() + random() % (1 << 24),
            _ => 1.0_f32.to_bits().wrapping_add_signed(random() as i32 >> (8 + random() % 23)),
        });
        // Logarithms of the result between -151 and 151, half of them between -1 and 1.
        let scale = if random() % 2 == 0 { 151.0 } else { 1.0 };
        let exponent = f64::from(random() as i32) / 2.0_f64.powi(31) * scale;
        x.push(base);
        y.push((exponent / f64::from(base).log2()) as f32);
    }
    let mut got = x.clone();
    pow_of_all(Level::best(), &mut got, &y);
    let mut worst = Worst::default();
    for ((got, x), y) in got.into_iter().zip(x).zip(y) {
        worst.take(got, f64::from(x).powf(f64::from(y)), [x, y]);
    }
    worst.check(1.31);
}

/// Bits, but all NaN are one.
fn same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
}

#[test]
fn special_values_of_exp2() {
    for (x, expected) in [(-INF, 0.0), (INF, INF), (NAN, NAN), (-0.0, 1.0), (f32::from_bits(1), 1.0)] {
        assert!(same(exp2(x), expected), "exp2({x}) = {}", exp2(x));
    }
    for (x, expected) in [(f32::MAX, INF), (f32::MIN, 0.0), (128.0, INF), (-150.0, 0.0), (-149.0, f32::from_bits(1))] {
        assert!(same(exp2(x), expected), "exp2({x}) = {}", exp2(x));
    }
    for n in -149..128 {
        assert_eq!(f64::from(exp2(n as f32)), 2.0_f64.powi(n));
    }
}

#[test]
fn special_values_of_log2() {
    let nans = [NAN, -1.0, -INF, -f32::MIN_POSITIVE, -f32::from_bits(1)];
    for x in nans {
        assert!(log2(x).is_nan(), "log2({x}) = {}", log2(x));
    }
    for (x, expected) in [(0.0, -INF), (-0.0, -INF), (INF, INF), (1.0, 0.0)] {
        assert!(same(log2(x), expected), "log2({x}) = {}", log2(x));
    }
    for n in -149..128 {
        assert_eq!(log2(2.0_f64.powi(n) as f32), n as f32);
    }
}

#[test]
fn special_values_of_pow() {
    let values = [0.0, f32::from_bits(1), 0.5, 0.999_999_94, 1.0, 1.000_000_1, 2.0, 1.0e30, f32::MAX, INF, NAN];
    for x in values {
        for y in values.into_iter().flat_map(|y| [y, -y]) {
            // C99's rules, as `f64::powf` follows them.
            let expected = f64::from(x).powf(f64::from(y)) as f32;
            let got = pow(x, y);
            let saturated = expected == 0.0 || expected == 1.0 || !expected.is_finite();
            let equal = if saturated { same(got, expected) } else { ulps(got, expected.into()) <= 2.0 };
            assert!(equal, "pow({x:e}, {y:e}) = {got:e}, expected {expected:e}");
        }
    }
    // Bases that are not positive.
    for (x, y, expected) in [(-0.0, 3.0, 0.0), (-0.0, -3.0, INF), (-0.0, 0.0, 1.0), (-2.0, 0.0, 1.0), (-INF, 0.0, 1.0)]
    {
        assert!(same(pow(x, y), expected), "pow({x}, {y}) = {}", pow(x, y));
    }
    for (x, y) in [(-2.0, 3.0), (-2.0, 0.5), (-INF, 3.0), (-INF, -3.0), (-1.0, INF), (-1.0, NAN)] {
        assert!(pow(x, y).is_nan(), "pow({x}, {y}) = {}", pow(x, y));
    }
}
