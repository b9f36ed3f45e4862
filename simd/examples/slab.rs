//! One ray against many boxes: the slab test, sixteen boxes to a block, in vectors of the level's width.

use simd::{Block, Float, Level, Mask, Vector};
use std::time::Instant;

/// Sixteen boxes as structure of arrays.
#[derive(Clone, Copy, Default)]
struct Boxes {
    min: [Block<f32>; 3],
    max: [Block<f32>; 3],
}

struct Ray {
    origin: [f32; 3],
    /// One over the direction; infinite where that is zero.
    inverse: [f32; 3],
    t_max: f32,
}

/// Which of the boxes of `chunk` the ray hits, and where it enters them.
#[inline(always)]
fn slab<F: Float>(boxes: &Boxes, chunk: usize, ray: &Ray) -> (F::Mask, F) {
    let (mut enter, mut leave) = (F::splat(0.0), F::splat(ray.t_max));
    for axis in 0..3 {
        let (origin, inverse) = (F::splat(ray.origin[axis]), F::splat(ray.inverse[axis]));
        let a = (F::load_block(&boxes.min[axis], chunk) - origin) * inverse;
        let b = (F::load_block(&boxes.max[axis], chunk) - origin) * inverse;
        // A ray in the plane of a side makes NaN of 0 * infinity: `min` and `max` then return their second operand.
        enter = a.min(b).max(enter);
        leave = a.max(b).min(leave);
    }
    (enter.le(leave), enter)
}

simd::kernel! {
    /// How many boxes the ray hits, and the first one with its distance; the lowest number among equals.
    fn hits<S>(boxes: &[Boxes], ray: &Ray) -> (usize, Option<(usize, f32)>) {
        let lanes = S::Float::LANES;
        let (mut count, mut first) = (0, None);
        let mut nearest = f32::INFINITY;
        for (i, boxes) in boxes.iter().enumerate() {
            for chunk in 0..16 / lanes {
                let (hit, enter) = slab::<S::Float>(boxes, chunk, ray);
                count += hit.count();
                let nearer = hit & enter.lt(S::Float::splat(nearest));
                if let Some(lane) = enter.min_index(nearer) {
                    nearest = enter.lane(lane);
                    first = Some((16 * i + chunk * lanes + lane, nearest));
                }
            }
        }
        (count, first)
    }
}

/// Numbers between 0 and 1 that look random.
fn noise(i: usize) -> f32 {
    ((i as u32).wrapping_mul(0x9e37_79b9) ^ 0x5bd1_e995).wrapping_mul(0x85eb_ca6b) as f32 / u32::MAX as f32
}

fn main() {
    let boxes: Vec<Boxes> = (0..64)
        .map(|i| {
            let mut boxes = Boxes::default();
            for (lane, axis) in (0..16).flat_map(|lane| (0..3).map(move |axis| (lane, axis))) {
                let min = noise((i * 16 + lane) * 3 + axis) * 10.0 - 5.0;
                boxes.min[axis].0[lane] = min;
                boxes.max[axis].0[lane] = min + 0.5;
            }
            boxes
        })
        .collect();
    let rays: Vec<Ray> = (0..2000)
        .map(|i| {
            let direction = [noise(3 * i) - 0.5, noise(3 * i + 1) - 0.5, if i % 10 == 0 { 0.0 } else { 1.0 }];
            Ray { origin: [0.0, 0.0, -10.0], inverse: direction.map(f32::recip), t_max: 100.0 }
        })
        .collect();

    let all = |level: Level| rays.iter().map(|ray| hits(level, &boxes, ray)).collect::<Vec<_>>();
    let expected = all(Level::SCALAR);
    for level in Level::available() {
        let clock = Instant::now();
        let found = all(level);
        let time = clock.elapsed();
        for (a, b) in found.iter().zip(&expected) {
            let bits = |hit: &(usize, Option<(usize, f32)>)| (hit.0, hit.1.map(|(i, t)| (i, t.to_bits())));
            assert_eq!(bits(a), bits(b), "{level}");
        }
        let tests = rays.len() as f64 * 16.0 * boxes.len() as f64;
        let sum: usize = found.iter().map(|hit| hit.0).sum();
        println!("{level:>7}: {sum} hits, {:.2} ns for a box", time.as_nanos() as f64 / tests);
    }
}
