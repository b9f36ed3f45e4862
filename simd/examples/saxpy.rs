//! `y += a * x` over slices of any length: whole vectors, then the rest one lane at a time with the same source.

use simd::{AlignedVec, Float, Level, Vector};
use std::time::Instant;

/// One vector: `f32` is a vector of one lane.
#[inline(always)]
fn step<F: Float>(a: f32, x: &[f32], y: &mut [f32]) {
    // Two roundings, at every level. `mul_add` would be faster where there is FMA, and round once there.
    let sum = F::splat(a) * F::load(x) + F::load(y);
    sum.store(y);
}

simd::kernel! {
    fn saxpy<S>(a: f32, x: &[f32], y: &mut [f32]) {
        let lanes = S::Float::LANES;
        let whole = x.len().min(y.len()) / lanes * lanes;
        let (x, x_rest) = x.split_at(whole);
        let (y, y_rest) = y.split_at_mut(whole);
        for (x, y) in x.chunks_exact(lanes).zip(y.chunks_exact_mut(lanes)) {
            step::<S::Float>(a, x, y);
        }
        for (x, y) in x_rest.chunks(1).zip(y_rest.chunks_mut(1)) {
            step::<f32>(a, x, y);
        }
    }
}

fn main() {
    // Fits the first-level cache: else the memory's speed is measured.
    let x: AlignedVec<f32> = (0..3003).map(|i| (i as f32).sin()).collect();
    let start: AlignedVec<f32> = x.iter().map(|x| 1.0 - x).collect();

    let mut expected = start.clone();
    saxpy(Level::SCALAR, 0.7, &x, &mut expected);
    for level in Level::available() {
        let mut y = start.clone();
        saxpy(level, 0.7, &x, &mut y);
        assert!(y.iter().zip(&expected).all(|(a, b)| a.to_bits() == b.to_bits()), "{level}: other bits");

        let (rounds, clock) = (10_000, Instant::now());
        for _ in 0..rounds {
            saxpy(level, 0.7, &x, &mut y);
        }
        let elements = rounds as f64 * x.len() as f64;
        println!(
            "{level:>7}: y[3002] = {}, {:.2} elements/ns",
            expected[3002],
            elements / clock.elapsed().as_nanos() as f64
        );
    }
}
