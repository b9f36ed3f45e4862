//! What is not one rounding of the exact result: reciprocals from estimates, and half precision.

use crate::harness::{Width, everywhere};
use crate::values::SPECIAL;
use simd::Float;

#[inline(always)]
fn reciprocals_of<F: Float>(src: &[f32], out: &mut [[f32; 4]]) {
    for (src, out) in src.chunks_exact(F::LANES).zip(out.chunks_exact_mut(F::LANES)) {
        let x = F::load(src);
        F::store_rows4([x.rcp_approx(), x.rsqrt_approx(), x.rcp(), x.rsqrt()], out);
    }
}

simd::kernel! {
    fn reciprocals<S>(width: Width, src: &[f32], out: &mut [[f32; 4]]) {
        at_width!(S, width, reciprocals_of(src, out))
    }
}

/// The distance in units of the last place of the exact result.
fn ulp(got: f32, exact: f64) -> f64 {
    let exponent = exact.abs().log2().floor().max(-126.0) as i32;
    (f64::from(got) - exact).abs() / 2_f64.powi(exponent - 23)
}

/// Within the documented bounds on numbers of every exponent, and as documented on special values.
#[test]
fn reciprocals_are_close() {
    let mut src: Vec<f32> = (0..1 << 18).map(|i: u32| f32::from_bits(i.wrapping_mul(16_381))).collect();
    src.extend(SPECIAL.iter().map(|&bits| f32::from_bits(bits)));
    src.extend([0x7e80_0000, 0x7e80_0001, 0x7eff_ffff, 0x7f00_0000].map(f32::from_bits));
    src.resize(src.len().next_multiple_of(16), 1.0);
    let mut out = vec![[0.0; 4]; src.len()];
    for (level, width) in everywhere() {
        reciprocals(level, width, &src, &mut out);
        for (&x, &[rcp_approx, rsqrt_approx, rcp, rsqrt]) in src.iter().zip(&out) {
            let place = format!("{level}, {width:?}, {x:e} ({:#x})", x.to_bits());
            let (exact, root) = (1.0 / f64::from(x), 1.0 / f64::from(x).sqrt());
            if x.is_nan() {
                assert!(rcp.is_nan() && rsqrt.is_nan(), "{place}");
                continue;
            }
            if x == 0.0 || x.is_infinite() || (exact as f32).is_infinite() {
                assert_eq!(rcp.to_bits(), (exact as f32).to_bits(), "{place}: rcp {rcp:e}");
            } else {
                assert!(ulp(rcp, exact) <= 2.0, "{place}: rcp {rcp:e}, {} ulp", ulp(rcp, exact));
            }
            if x < 0.0 {
                assert!(rsqrt.is_nan(), "{place}: rsqrt {rsqrt:e}");
            } else if x == 0.0 || x == f32::INFINITY {
                assert_eq!(rsqrt.to_bits(), (root as f32).to_bits(), "{place}: rsqrt {rsqrt:e}");
            } else {
                assert!(ulp(rsqrt, root) <= 2.0, "{place}: rsqrt {rsqrt:e}, {} ulp", ulp(rsqrt, root));
            }
            if (5.5e-20..1.8e19).contains(&x.abs()) {
                let error = (f64::from(rcp_approx) / exact - 1.0).abs();
                assert!(error <= 1.0 / 256.0, "{place}: rcp_approx {rcp_approx:e}");
                let error = (f64::from(rsqrt_approx) / root - 1.0).abs();
                assert!(x < 0.0 || error <= 1.0 / 256.0, "{place}: rsqrt_approx {rsqrt_approx:e}");
            }
        }
    }
}

#[inline(always)]
fn from_half<F: Float>(src: &[u16], out: &mut [f32]) {
    for (src, out) in src.chunks_exact(F::LANES).zip(out.chunks_exact_mut(F::LANES)) {
        F::load_f16(src).store(out);
    }
}

#[inline(always)]
fn to_half<F: Float>(src: &[f32], out: &mut [u16]) {
    for (src, out) in src.chunks_exact(F::LANES).zip(out.chunks_exact_mut(F::LANES)) {
        F::load(src).store_f16(out);
    }
}

simd::kernel! {
    fn load_f16<S>(width: Width, src: &[u16], out: &mut [f32]) {
        at_width!(S, width, from_half(src, out))
    }
}
simd::kernel! {
    fn store_f16<S>(width: Width, src: &[f32], out: &mut [u16]) {
        at_width!(S, width, to_half(src, out))
    }
}

/// By the definition of binary16.
fn value_of_half(half: u16) -> f64 {
    let (exponent, fraction) = (i32::from(half >> 10 & 31), f64::from(half & 1023));
    let size = match exponent {
        0 => fraction * 2_f64.powi(-24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1024.0 + fraction) * 2_f64.powi(exponent - 25),
    };
    if half >> 15 == 1 { -size } else { size }
}

/// All of them, exactly.
#[test]
fn every_half_loads() {
    let src: Vec<u16> = (0..=u16::MAX).collect();
    let mut out = vec![0.0; src.len()];
    for (level, width) in everywhere() {
        load_f16(level, width, &src, &mut out);
        for (&half, &got) in src.iter().zip(&out) {
            let expected = value_of_half(half) as f32;
            let same = got.to_bits() == expected.to_bits() || got.is_nan() && expected.is_nan();
            assert!(same, "{level}, {width:?}: {half:#06x} gave {got:e}, expected {expected:e}");
        }
    }
}

/// Every half, the middle between it and the next, and their neighbours: to nearest, ties to even.
#[test]
fn halves_store_to_nearest() {
    let mut src = Vec::new();
    for half in 0..0x7c00_u16 {
        // 65536 would come after the largest number.
        let next = if half == 0x7bff { 65536.0 } else { value_of_half(half + 1) };
        let (this, middle) = (value_of_half(half) as f32, (0.5 * (value_of_half(half) + next)) as f32);
        let below = f32::from_bits(middle.to_bits() - 1);
        let above = f32::from_bits(middle.to_bits() + 1);
        let even = if half % 2 == 0 { half } else { half + 1 };
        src.extend([(this, half), (below, half), (middle, even), (above, half + 1)]);
    }
    src.extend([(f32::MAX, 0x7c00), (f32::INFINITY, 0x7c00), (1e-30, 0), (f32::from_bits(1), 0)]);
    src.extend(src.clone().into_iter().map(|(x, half)| (-x, half | 0x8000)));
    let not_numbers = src.len();
    src.resize(not_numbers + 16, (f32::NAN, 0));
    src.resize(src.len().next_multiple_of(16), (0.0, 0));
    let numbers: Vec<f32> = src.iter().map(|x| x.0).collect();
    let mut out = vec![0; src.len()];
    for (level, width) in everywhere() {
        store_f16(level, width, &numbers, &mut out);
        for (i, (&(x, half), &got)) in src.iter().zip(&out).enumerate() {
            if x.is_nan() {
                assert!(value_of_half(got).is_nan(), "{level}, {width:?}: NaN gave {got:#06x}");
            } else {
                assert_eq!(got, half, "{level}, {width:?}, number {i}: {x:e}");
            }
        }
    }
}
