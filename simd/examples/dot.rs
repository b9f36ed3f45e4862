//! A dot product with a remainder, the sum in the same order at every level: that of sixteen lanes.
//!
//! Sums depend on their order. With a vector of the level's own width it would be another order at each width; with a fixed
//! width, here `Float16`, it is one order, emulated by two or four registers where they are narrower.

use simd::{Float, Level, Vector};
use std::time::Instant;

simd::kernel! {
    fn dot<S>(a: &[f32], b: &[f32]) -> f32 {
        let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<16>(), b.as_chunks::<16>());
        let mut sum = S::Float16::splat(0.0);
        for (a, b) in a.iter().zip(b) {
            sum += S::Float16::load(a) * S::Float16::load(b);
        }
        // The rest, filled up with zeros.
        let (mut a, mut b) = ([0.0; 16], [0.0; 16]);
        a[..a_rest.len()].copy_from_slice(a_rest);
        b[..b_rest.len()].copy_from_slice(b_rest);
        sum += S::Float16::load(&a) * S::Float16::load(&b);
        sum.reduce_add()
    }
}

fn main() {
    let a: Vec<f32> = (0..2011).map(|i| (i as f32 * 0.1).cos()).collect();
    let b: Vec<f32> = (0..2011).map(|i| (i as f32 * 0.1 + 0.2).cos()).collect();
    let exact: f64 = a.iter().zip(&b).map(|(&a, &b)| f64::from(a) * f64::from(b)).sum();

    let expected = dot(Level::SCALAR, &a, &b);
    assert!((f64::from(expected) - exact).abs() < 1e-6 * exact, "{expected} is not {exact}");
    // All lengths of the remainder.
    for n in 0..40 {
        let in_f64: f64 = a[..n].iter().zip(&b[..n]).map(|(&a, &b)| f64::from(a) * f64::from(b)).sum();
        assert!((f64::from(dot(Level::best(), &a[..n], &b[..n])) - in_f64).abs() < 1e-5);
    }
    for level in Level::available() {
        assert_eq!(dot(level, &a, &b).to_bits(), expected.to_bits(), "{level}: other bits");

        let (rounds, clock) = (10_000, Instant::now());
        for _ in 0..rounds {
            std::hint::black_box(dot(level, std::hint::black_box(&a), &b));
        }
        let elements = rounds as f64 * a.len() as f64;
        println!("{level:>7}: {expected}, {:.2} elements/ns", elements / clock.elapsed().as_nanos() as f64);
    }
}
