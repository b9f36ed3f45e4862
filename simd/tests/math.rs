//! How accurate the computed functions are, against the `f64` functions of `libm` (those of a target's own C library can be
//! wrong: MinGW's sine is, for large arguments), and their special values. One lane is enough: that every level gives its bits
//! is tested with the operations.
//!
//! `SIMD_TEST_EVERY=n` tests only every n-th argument, for emulated processors.

use simd::math::{acos, asin, atan, atan2, cbrt, cos, exp, exp2, ln, log2, pow, sin, sin_cos, tan};
use simd::{Level, Vector};

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
    let unit = f64::from_bits(((exponent.clamp(-126, 127) - 23 + 1023) as u64) << 52);
    (got - exact).abs() / unit
}

/// Of how many arguments one is tested.
fn every() -> usize {
    std::env::var("SIMD_TEST_EVERY").map_or(1, |n| n.parse().expect("SIMD_TEST_EVERY is a number from 1"))
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

/// The worst result for the floats with these bit patterns.
fn worst_of(patterns: impl Iterator<Item = u32>, function: fn(Level, &mut [f32]), exact: fn(f64) -> f64) -> Worst {
    let level = Level::best();
    let mut worst = Worst::default();
    let mut x = patterns.map(f32::from_bits).peekable();
    let mut got = [0.0; 1 << 12];
    while x.peek().is_some() {
        let arguments: Vec<f32> = x.by_ref().take(got.len()).collect();
        got[..arguments.len()].copy_from_slice(&arguments);
        function(level, &mut got);
        for (&x, got) in arguments.iter().zip(got) {
            worst.take(got, exact(f64::from(x)), [x, 0.0]);
        }
    }
    worst
}

/// Tests of functions of one number: `name: exact function, bound in ulp, ranges where every float is tested`.
macro_rules! unary {
    ($($name:ident: $exact:expr, $bound:literal, $ranges:expr;)*) => {
        $(mod $name {
            use super::*;

            simd::kernel! {
                fn of_all<S>(x: &mut [f32]) {
                    for x in x.chunks_exact_mut(S::Float16::LANES) {
                        simd::math::$name(S::Float16::load(x)).store(x);
                    }
                }
            }

            #[test]
            fn sample() {
                worst_of((0..=u32::MAX).step_by(2503 * every()), of_all, $exact).check($bound);
                let ranges: &[(f32, f32)] = &$ranges;
                for (low, high) in ranges {
                    worst_of((low.to_bits()..=high.to_bits()).step_by(every()), of_all, $exact).check($bound);
                }
            }

            /// After every change of the function: `cargo test --release -p simd --test math every_float -- --ignored`.
            #[test]
            #[ignore = "a minute or two for each function"]
            fn every_float() {
                let worst = worst_of(0..=u32::MAX, of_all, $exact);
                println!("{}: {} ulp at {}", stringify!($name), worst.ulps, worst.arguments[0]);
                worst.check($bound);
            }
        })*
    };
}

unary! {
    exp: libm::exp, 0.78, [(0.5, 1.0), (-0.5, -1.0), (88.7, 88.8), (-87.3, -87.4), (-103.9, -104.1)];
    exp2: libm::exp2, 1.19, [(0.5, 1.01), (-0.5, -1.01), (127.9, 128.1), (-125.9, -126.1), (-148.9, -151.1)];
    ln: libm::log, 0.501, [(f32::from_bits(1), 1.0e-40), (1.1e-38, 1.2e-38), (0.5, 2.0), (1.0e38, 1.1e38)];
    log2: libm::log2, 0.501, [(f32::from_bits(1), 1.0e-40), (1.1e-38, 1.2e-38), (0.5, 2.0), (1.0e38, 1.1e38)];
    cbrt: libm::cbrt, 0.505, [(f32::from_bits(1), 1.0e-40), (0.9, 1.1), (-2.0, -4.0), (3.3e38, f32::MAX)];
    sin: libm::sin, 0.95, [(0.5, 1.0), (-3.1, -3.2), (131_000.0, 131_200.0), (3.3e38, f32::MAX)];
    cos: libm::cos, 0.95, [(0.5, 1.0), (-1.5, -1.6), (131_000.0, 131_200.0), (3.3e38, f32::MAX)];
    tan: libm::tan, 1.3, [(0.5, 1.0), (-1.5, -1.6), (131_000.0, 131_200.0), (3.3e38, f32::MAX)];
    asin: libm::asin, 0.72, [(0.5, 1.01), (-0.49, -0.51)];
    acos: libm::acos, 0.69, [(0.5, 1.01), (-0.49, -0.51), (-0.99, -1.01)];
    atan: libm::atan, 0.85, [(0.4, 0.8), (0.99, 1.01), (-2.4, -2.5)];
}

simd::kernel! {
    /// In place of the bases.
    fn pow_of_all<S>(x: &mut [f32], y: &[f32]) {
        for (x, y) in x.chunks_exact_mut(S::Float16::LANES).zip(y.chunks_exact(S::Float16::LANES)) {
            pow(S::Float16::load(x), S::Float16::load(y)).store(x);
        }
    }
}

simd::kernel! {
    /// In place of the ordinates.
    fn atan2_of_all<S>(y: &mut [f32], x: &[f32]) {
        for (y, x) in y.chunks_exact_mut(S::Float16::LANES).zip(x.chunks_exact(S::Float16::LANES)) {
            atan2(S::Float16::load(y), S::Float16::load(x)).store(y);
        }
    }
}

/// Knuth's MMIX generator; the upper half is the random one.
fn random_numbers(mut state: u64) -> impl FnMut() -> u32 {
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 32) as u32
    }
}

#[test]
fn pow_of_random_pairs() {
    let mut random = random_numbers(1);
    let n = (1 << 18) / every() * 16;
    let (mut x, mut y) = (Vec::with_capacity(n), Vec::with_capacity(n));
    for i in 0..n {
        // Any base; between 1/2 and 2; near 1, at all distances.
        let base = f32::from_bits(match i % 3 {
            0 => 1 + random() % (INF.to_bits() - 1),
            1 => 0.5_f32.to_bits() + random() % (1 << 24),
            _ => 1.0_f32.to_bits().wrapping_add_signed(random() as i32 >> (8 + random() % 23)),
        });
        // Logarithms of the result between -151 and 151, half of them between -1 and 1.
        let scale = if random().is_multiple_of(2) { 151.0 } else { 1.0 };
        let exponent = f64::from(random() as i32) / 2.0_f64.powi(31) * scale;
        x.push(base);
        y.push((exponent / libm::log2(base.into())) as f32);
    }
    let mut got = x.clone();
    pow_of_all(Level::best(), &mut got, &y);
    let mut worst = Worst::default();
    for ((got, x), y) in got.into_iter().zip(x).zip(y) {
        worst.take(got, libm::pow(x.into(), y.into()), [x, y]);
    }
    worst.check(1.31);
}

/// The worst result of `atan2` for that many random points.
fn worst_atan2(n: usize, seed: u64) -> Worst {
    let mut random = random_numbers(seed);
    let (mut y, mut x) = (Vec::with_capacity(n), Vec::with_capacity(n));
    for i in 0..n {
        let ordinate = random();
        // Anywhere; at angles of all sizes that are not all but zero; about as far as the ordinate.
        let abscissa = match i % 3 {
            0 => random(),
            1 => ordinate.wrapping_add_signed(random() as i32 >> (4 + random() % 8)),
            _ => ordinate.wrapping_add_signed(random() as i32 >> 7) ^ (random() & 1 << 31),
        };
        y.push(f32::from_bits(ordinate));
        x.push(f32::from_bits(abscissa));
    }
    let mut got = y.clone();
    atan2_of_all(Level::best(), &mut got, &x);
    let mut worst = Worst::default();
    for ((got, y), x) in got.into_iter().zip(y).zip(x) {
        worst.take(got, libm::atan2(y.into(), x.into()), [y, x]);
    }
    worst
}

#[test]
fn atan2_of_random_pairs() {
    worst_atan2((1 << 18) / every() * 16, 1).check(0.86);
}

/// After every change of the function, as the other long tests.
#[test]
#[ignore = "a minute"]
fn atan2_of_many_random_pairs() {
    let worst = (0..200).map(|seed| worst_atan2(1 << 21, seed)).max_by(|a, b| a.ulps.total_cmp(&b.ulps)).unwrap();
    println!("atan2: {} ulp at {:?}", worst.ulps, worst.arguments);
    worst.check(0.86);
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
            // C99's rules, as `libm::pow` follows them.
            let expected = libm::pow(x.into(), y.into()) as f32;
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

/// `function` gives exactly these results.
fn gives(name: &str, function: fn(f32) -> f32, expected: &[(f32, f32)]) {
    for &(x, expected) in expected {
        assert!(same(function(x), expected), "{name}({x:e}) = {:e}, expected {expected:e}", function(x));
    }
}

/// Zeros, the smallest denormals and what is between them and `up_to` stay as they are.
fn keeps_small(name: &str, function: fn(f32) -> f32, up_to: f32) {
    for bits in (0..16).chain((16..up_to.to_bits()).step_by(9973)) {
        let x = f32::from_bits(bits);
        gives(name, function, &[(x, x), (-x, -x)]);
    }
}

#[test]
fn special_values_of_exp() {
    let tiny = f32::from_bits(1);
    gives("exp", exp, &[(0.0, 1.0), (-0.0, 1.0), (tiny, 1.0), (-tiny, 1.0), (INF, INF), (-INF, 0.0), (NAN, NAN)]);
    gives("exp", exp, &[(f32::MAX, INF), (f32::MIN, 0.0), (88.73, INF), (-103.98, 0.0), (-103.97, tiny)]);
    assert!(exp(88.722_83_f32) < INF && exp(-87.35_f32) < f32::MIN_POSITIVE && exp(-87.33_f32) > f32::MIN_POSITIVE);
}

#[test]
fn special_values_of_ln() {
    gives("ln", ln, &[(0.0, -INF), (-0.0, -INF), (1.0, 0.0), (INF, INF), (NAN, NAN)]);
    gives("ln", ln, &[(-1.0, NAN), (-INF, NAN), (-f32::MIN_POSITIVE, NAN), (-f32::from_bits(1), NAN)]);
}

#[test]
fn special_values_of_cbrt() {
    gives("cbrt", cbrt, &[(0.0, 0.0), (-0.0, -0.0), (INF, INF), (-INF, -INF), (NAN, NAN)]);
    for n in 1..=256 {
        let root = n as f32;
        gives("cbrt", cbrt, &[(root * root * root, root), (-root * root * root, -root)]);
    }
    for n in -49..=42 {
        let root = 2.0_f32.powi(n);
        gives("cbrt", cbrt, &[(root * root * root, root)]);
    }
}

#[test]
fn special_values_of_sin_cos_and_tan() {
    for (name, function) in [("sin", sin as fn(f32) -> f32), ("tan", tan)] {
        gives(name, function, &[(INF, NAN), (-INF, NAN), (NAN, NAN)]);
        keeps_small(name, function, 1.0e-4);
    }
    let tiny = f32::from_bits(1);
    gives("cos", cos, &[(0.0, 1.0), (-0.0, 1.0), (tiny, 1.0), (-tiny, 1.0), (INF, NAN), (-INF, NAN), (NAN, NAN)]);
    for x in (0..=u32::MAX).step_by(99_991).map(f32::from_bits) {
        let (s, c) = sin_cos(x);
        assert!(same(s, sin(x)) && same(c, cos(x)), "sin_cos({x:e})");
        assert!(same(sin(-x), -s) && same(cos(-x), c) && same(tan(-x), -tan(x)), "{x:e} mirrored");
    }
}

#[test]
fn special_values_of_asin_and_acos() {
    use std::f32::consts::{FRAC_PI_2, PI};
    let beyond = [INF, -INF, NAN, 1.000_000_1, -1.000_000_1, f32::MAX, f32::MIN].map(|x| (x, NAN));
    gives("asin", asin, &beyond);
    gives("asin", asin, &[(1.0, FRAC_PI_2), (-1.0, -FRAC_PI_2)]);
    keeps_small("asin", asin, 1.0e-4);
    gives("acos", acos, &beyond);
    gives("acos", acos, &[(1.0, 0.0), (0.0, FRAC_PI_2), (-0.0, FRAC_PI_2), (f32::from_bits(1), FRAC_PI_2), (-1.0, PI)]);
}

#[test]
fn special_values_of_atan() {
    use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};
    gives("atan", atan, &[(INF, FRAC_PI_2), (-INF, -FRAC_PI_2), (f32::MAX, FRAC_PI_2), (f32::MIN, -FRAC_PI_2)]);
    gives("atan", atan, &[(1.0, FRAC_PI_4), (-1.0, -FRAC_PI_4), (NAN, NAN)]);
    keeps_small("atan", atan, 1.0e-4);
}

#[test]
fn special_values_of_atan2() {
    let tiny = [f32::from_bits(1), f32::from_bits(5), f32::MIN_POSITIVE, 1.5e-38, 1.0e-30, 1.0e-18];
    let values = [0.0, 0.3, 1.0, 2.5, 1.0e18, 1.0e30, 3.0e38, f32::MAX, INF, NAN];
    let values: Vec<f32> = tiny.into_iter().chain(values).flat_map(|x| [x, -x]).collect();
    for &y in &values {
        for &x in &values {
            // C99's rules, as `f64::atan2` follows them. The sign of a zero is that of `y`.
            let (got, exact) = (atan2(y, x), libm::atan2(y.into(), x.into()));
            let sign = got.is_nan() || got.is_sign_negative() == y.is_sign_negative();
            assert!(sign && ulps(got, exact) < 1.0, "atan2({y:e}, {x:e}) = {got:e}, expected {exact:e}");
        }
    }
}
