//! Blurs a grey picture: a weighted mean of five times five pixels, down the columns and then along the rows.
//!
//! Vectors need not be aligned: a row is read at five offsets. The last vector of a row overlaps the one before it, which is
//! simpler than a remainder, and writes the same values twice.

use simd::{Float, Level, Vector};
use std::time::Instant;

/// Binomial: close to the bell curve.
const WEIGHTS: [f32; 5] = [1.0 / 16.0, 4.0 / 16.0, 6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0];
/// Pixels that a row is extended by on either side.
const MARGIN: usize = 2;

struct Picture {
    width: usize,
    pixels: Vec<f32>,
}

/// Where vectors of `lanes` pixels start so that they cover a row, the last one overlapping.
#[inline(always)]
fn starts(width: usize, lanes: usize) -> impl Iterator<Item = usize> {
    (0..width.div_ceil(lanes)).map(move |i| (i * lanes).min(width - lanes))
}

/// The weighted mean of five vectors, in this order of additions at every level.
#[inline(always)]
fn mean<F: Float>(pixels: [F; 5]) -> F {
    let [a, b, c, d, e] = pixels;
    let [outer, inner, middle, ..] = WEIGHTS;
    (a + e) * F::splat(outer) + (b + d) * F::splat(inner) + c * F::splat(middle)
}

simd::kernel! {
    /// Beyond its edges, the picture continues as at the edge. At least sixteen pixels wide.
    fn blur<S>(picture: &Picture, output: &mut [f32]) {
        let (width, lanes) = (picture.width, S::Float::LANES);
        let rows = picture.pixels.chunks_exact(width);
        let last = rows.len() - 1;
        let row = |y: usize| &picture.pixels[y * width..][..width];
        // One row, blurred along the columns, with its margins.
        let mut line = vec![0.0; width + 2 * MARGIN];
        for (y, output) in output.chunks_exact_mut(width).enumerate() {
            let [a, b] = [row(y.saturating_sub(2)), row(y.saturating_sub(1))];
            let [c, d, e] = [row(y), row((y + 1).min(last)), row((y + 2).min(last))];
            for x in starts(width, lanes) {
                let load = |row: &[f32]| S::Float::load(&row[x..]);
                mean([load(a), load(b), load(c), load(d), load(e)]).store(&mut line[MARGIN + x..]);
            }
            let (first, end) = (line[MARGIN], line[MARGIN + width - 1]);
            line[..MARGIN].fill(first);
            line[MARGIN + width..].fill(end);
            for x in starts(width, lanes) {
                let load = |offset| S::Float::load(&line[x + offset..]);
                mean([load(0), load(1), load(2), load(3), load(4)]).store(&mut output[x..]);
            }
        }
    }
}

/// The same for one pixel, the plain way.
fn blurred_pixel(picture: &Picture, x: usize, y: usize) -> f64 {
    let (width, height) = (picture.width as isize, (picture.pixels.len() / picture.width) as isize);
    let mut sum = 0.0;
    for (j, wy) in WEIGHTS.iter().enumerate() {
        for (i, wx) in WEIGHTS.iter().enumerate() {
            let x = (x as isize + i as isize - 2).clamp(0, width - 1);
            let y = (y as isize + j as isize - 2).clamp(0, height - 1);
            sum += f64::from(picture.pixels[(y * width + x) as usize]) * f64::from(wx * wy);
        }
    }
    sum
}

fn main() {
    let (width, height) = (509, 300);
    let disc = |x: usize, y: usize| (x as f32 - 250.0).hypot(y as f32 - 150.0) < 100.0;
    let pixels = (0..width * height).map(|i| if disc(i % width, i / width) { 1.0 } else { 0.1 });
    let picture = Picture { width, pixels: pixels.collect() };

    let mut expected = vec![0.0; width * height];
    blur(Level::SCALAR, &picture, &mut expected);
    for (x, y) in [(0, 0), (150, 150), (151, 140), (width - 1, height - 1), (250, 50), (300, 61)] {
        let (blurred, plain) = (expected[y * width + x], blurred_pixel(&picture, x, y));
        assert!((f64::from(blurred) - plain).abs() < 1e-6, "({x}, {y}): {blurred} is not {plain}");
    }
    for level in Level::available() {
        let mut output = vec![0.0; width * height];
        let clock = Instant::now();
        let rounds = 20;
        for _ in 0..rounds {
            blur(level, &picture, &mut output);
        }
        let time = clock.elapsed() / rounds;
        assert!(output.iter().zip(&expected).all(|(a, b)| a.to_bits() == b.to_bits()), "{level}: other bits");
        println!("{level:>7}: {width} x {height} pixels in {:.0} µs", time.as_secs_f64() * 1e6);
    }
}
