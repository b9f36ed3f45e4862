//! The Mandelbrot set: a loop that each lane leaves at its own time.
//!
//! `cargo run --release -p simd --example mandelbrot -- picture.ppm` also writes the picture.

use simd::{Float, Level, Mask, Vector};
use std::io::Write;
use std::time::Instant;

const WIDTH: usize = 768;
const HEIGHT: usize = 512;
const ITERATIONS: usize = 200;

/// How many iterations of `z = z * z + c` stay within the circle of radius 2.
#[inline(always)]
fn iterations<F: Float>(re: F, im: F) -> F::Int {
    let (mut x, mut y) = (re, im);
    let mut count = F::Int::splat(0);
    let mut inside = F::Mask::splat(true);
    for _ in 0..ITERATIONS {
        let (xx, yy) = (x * x, y * y);
        inside &= (xx + yy).le(F::splat(4.0));
        // The loop goes on until the last lane has left; those that have left no longer count.
        if inside.none() {
            break;
        }
        count = F::Int::select(inside, count + F::Int::splat(1), count);
        y = (x + x) * y + im;
        x = xx - yy + re;
    }
    count
}

simd::kernel! {
    fn mandelbrot<S>(counts: &mut [i32]) {
        let lanes = S::Float::LANES;
        assert!(WIDTH.is_multiple_of(lanes));
        let scale = 3.0 / WIDTH as f32;
        for (row, counts) in counts.chunks_exact_mut(WIDTH).enumerate() {
            let im = S::Float::splat((row as f32 - HEIGHT as f32 / 2.0) * scale);
            for (i, counts) in counts.chunks_exact_mut(lanes).enumerate() {
                let column = S::Float::from_fn(|lane| (i * lanes + lane) as f32);
                let re = column * S::Float::splat(scale) - S::Float::splat(2.2);
                iterations(re, im).store(counts);
            }
        }
    }
}

/// Dark blue outside, brighter towards the border, black inside.
fn color(count: i32) -> [u8; 3] {
    if count as usize == ITERATIONS {
        return [0; 3];
    }
    let t = (count as f32 / ITERATIONS as f32).powf(0.45);
    [t * 1.6, t * t * 1.8, 0.25 + t * 0.8].map(|c| (c.min(1.0) * 255.0) as u8)
}

fn main() -> std::io::Result<()> {
    let mut expected = vec![0; WIDTH * HEIGHT];
    mandelbrot(Level::SCALAR, &mut expected);
    let inside = expected.iter().filter(|&&n| n as usize == ITERATIONS).count();
    for level in Level::available() {
        let mut counts = vec![0; WIDTH * HEIGHT];
        let clock = Instant::now();
        mandelbrot(level, &mut counts);
        let time = clock.elapsed();
        assert_eq!(counts, expected, "{level}");
        println!("{level:>7}: {inside} pixels inside, {:.1} ms", time.as_secs_f64() * 1e3);
    }
    if let Some(path) = std::env::args_os().nth(1) {
        let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
        writeln!(file, "P6 {WIDTH} {HEIGHT} 255")?;
        for &count in &expected {
            file.write_all(&color(count))?;
        }
        file.flush()?;
    }
    Ok(())
}
