//! Random numbers that depend on the seed, the pixel, the number of the sample and the dimension alone.

use simd::{Float, Integer, Vector};

/// Points of a (0,2)-sequence for every pixel and every pair of dimensions: Sobol's first two dimensions, shuffled and scrambled as Owen
/// has it, by hashes (Burley 2020, "Practical Hash-based Owen Scrambling", Journal of Computer Graphics Techniques 9(4)).
///
/// The first 2^k samples of a pixel lie one in each of 2^k equal boxes of any shape, which is why a picture has less noise than from
/// independent numbers. The same numbers on every level, at every width and on any number of threads.
///
/// ```
/// use tracer::render::Sampler;
///
/// let sampler = Sampler::new(7);
/// let [x, y] = sampler.pair::<f32>(std::num::Wrapping(1234), 0, 0);
/// assert!((0.0..1.0).contains(&x) && (0.0..1.0).contains(&y));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sampler {
    seed: u32,
}

impl Sampler {
    /// Other seeds, other noise.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Self { seed: mix(seed as u32 ^ mix((seed >> 32) as u32 ^ 0x9e37_79b9)) }
    }

    /// Two numbers in [0, 1), multiples of 2^-24, for a pixel (any number that names it) in each lane: dimensions `2 * pair` and
    /// `2 * pair + 1` of a sample.
    #[inline(always)]
    #[must_use]
    pub fn pair<F: Float>(self, pixel: F::Index, sample: u32, pair: u32) -> [F; 2] {
        let key = mix_lanes(pixel ^ F::Index::splat(mix(self.seed ^ mix(pair.wrapping_add(0x51ed_270b)))));
        // The shuffled number of the sample, with its bits reversed: the first dimension, not yet scrambled.
        let shuffled = reverse(permute(F::Index::splat(sample.reverse_bits()), key));
        let x = permute(shuffled, mix_lanes(key ^ F::Index::splat(0xc2b2_ae35)));
        let y = permute(pascal(shuffled), mix_lanes(key ^ F::Index::splat(0x27d4_eb2f)));
        [fraction(reverse(x)), fraction(reverse(y))]
    }
}

/// The upper 24 bits as a number in [0, 1), exactly.
#[inline(always)]
fn fraction<F: Float>(bits: F::Index) -> F {
    F::from_uint(bits >> 8) * F::splat(1.0 / 16_777_216.0)
}

/// Changes each bit by those below it alone (Laine and Karras 2011, "Stratified Sampling for Stochastic Transparency"): on bits in
/// reversed order that is a scrambling as Owen has it.
#[inline(always)]
fn permute<V: Integer + Vector<Lane = u32>>(x: V, seed: V) -> V {
    let mut x = x + seed;
    x ^= x * V::splat(0x6c50_b47c);
    x ^= x * V::splat(0xb82f_1e52);
    x ^= x * V::splat(0xc7af_e638);
    x ^= x * V::splat(0x8d22_f6e6);
    x
}

/// Sobol's second dimension, its bits reversed: bit j is the sum of all bits k for which the binomial of k over j is odd, which are those
/// that have all ones of j (Lucas).
#[inline(always)]
fn pascal<V: Integer + Vector<Lane = u32>>(x: V) -> V {
    let mut x = x;
    x ^= (x >> 1) & V::splat(0x5555_5555);
    x ^= (x >> 2) & V::splat(0x3333_3333);
    x ^= (x >> 4) & V::splat(0x0f0f_0f0f);
    x ^= (x >> 8) & V::splat(0x00ff_00ff);
    x ^ (x >> 16)
}

#[inline(always)]
fn reverse<V: Integer + Vector<Lane = u32>>(x: V) -> V {
    let mut x = x;
    x = ((x >> 1) & V::splat(0x5555_5555)) | ((x & V::splat(0x5555_5555)) << 1);
    x = ((x >> 2) & V::splat(0x3333_3333)) | ((x & V::splat(0x3333_3333)) << 2);
    x = ((x >> 4) & V::splat(0x0f0f_0f0f)) | ((x & V::splat(0x0f0f_0f0f)) << 4);
    x = ((x >> 8) & V::splat(0x00ff_00ff)) | ((x & V::splat(0x00ff_00ff)) << 8);
    (x >> 16) | (x << 16)
}

/// A hash of 32 bits (Wellons 2018, "lowbias32").
fn mix(x: u32) -> u32 {
    let x = (x ^ x >> 16).wrapping_mul(0x7feb_352d);
    let x = (x ^ x >> 15).wrapping_mul(0x846c_a68b);
    x ^ x >> 16
}

/// [`mix`] in each lane.
#[inline(always)]
fn mix_lanes<V: Integer + Vector<Lane = u32>>(x: V) -> V {
    let x = (x ^ (x >> 16)) * V::splat(0x7feb_352d);
    let x = (x ^ (x >> 15)) * V::splat(0x846c_a68b);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{self, Lanes};
    use simd::Level;
    use std::num::Wrapping;

    fn points(seed: u64, pixel: u32, pair: u32, count: u32) -> Vec<[f32; 2]> {
        (0..count).map(|sample| Sampler::new(seed).pair::<f32>(Wrapping(pixel), sample, pair)).collect()
    }

    /// One point in each of 2^k boxes, whatever their shape, and exact multiples of 2^-24.
    #[test]
    fn points_are_a_net() {
        for (seed, pixel, pair) in [(0, 0, 0), (0, 1, 0), (1, 77, 3), (u64::MAX, u32::MAX, 40)] {
            for k in [0, 1, 4, 7, 10] {
                let points = points(seed, pixel, pair, 1 << k);
                for columns in 0..=k {
                    let mut boxes = vec![0; 1 << k];
                    for &[x, y] in &points {
                        let column = (x * (1 << columns) as f32) as usize;
                        let row = (y * (1 << (k - columns)) as f32) as usize;
                        boxes[row << columns | column] += 1;
                    }
                    assert!(boxes.iter().all(|&n| n == 1), "seed {seed}, pixel {pixel}, pair {pair}: 2^{k} points");
                }
                let whole = |c: f32| (c * 16_777_216.0).fract() == 0.0 && (0.0..1.0).contains(&c);
                assert!(points.as_flattened().iter().all(|&c| whole(c)));
            }
        }
    }

    /// Over pixels, pairs and seeds the numbers are uniform and independent of each other: chi-square over 64 boxes, and correlations.
    #[test]
    fn uniform_over_pixels_pairs_and_seeds() {
        const N: u32 = 1 << 14;
        type At = fn(u32) -> [f32; 2];
        let series: [(&str, At); 4] = [
            ("pixels", |i| Sampler::new(3).pair::<f32>(Wrapping(i), 0, 0)),
            ("pixels of another sample", |i| Sampler::new(3).pair::<f32>(Wrapping((i & 127) << 16 | i >> 7), 5, 1)),
            ("pairs", |i| Sampler::new(3).pair::<f32>(Wrapping(9), 0, i)),
            ("seeds", |i| Sampler::new(u64::from(i)).pair::<f32>(Wrapping(9), 0, 0)),
        ];
        for (name, at) in series {
            let mut boxes = [0_f64; 64];
            let (mut xy, mut neighbours, mut before) = (0.0, 0.0, 0.5);
            for i in 0..N {
                let [x, y] = at(i);
                boxes[(x * 8.0) as usize * 8 + (y * 8.0) as usize] += 1.0;
                xy += f64::from((x - 0.5) * (y - 0.5));
                neighbours += f64::from((x - 0.5) * (before - 0.5));
                before = x;
            }
            let expected = f64::from(N) / 64.0;
            let chi2: f64 = boxes.iter().map(|n| (n - expected) * (n - expected) / expected).sum();
            // 63 degrees of freedom: 103.4 is exceeded once in a thousand.
            assert!(chi2 < 103.4, "{name}: chi-square {chi2}");
            // The standard deviation of a sum of N products of uniform numbers is sqrt(N) / 12.
            let four_sigma = f64::from(N).sqrt() / 3.0;
            assert!(xy.abs() < four_sigma && neighbours.abs() < four_sigma, "{name}: {xy}, {neighbours}");
        }
    }

    /// The numbers of 64 pixels with vectors of a type.
    struct Bits;
    impl Lanes for Bits {
        type Output = Vec<[u32; 2]>;

        #[inline(always)]
        fn run<F: Float>(self) -> Self::Output {
            let (mut bits, mut first) = (Vec::new(), 0);
            while first < 64 {
                let pixel = F::Index::from_fn(|lane| (first + lane) as u32 * 0x0001_0003);
                let [x, y] = Sampler::new(5).pair::<F>(pixel, 11, 2);
                let (x, y) = (x.to_bits().to_block(), y.to_bits().to_block());
                bits.extend((0..F::LANES).map(|lane| [x.0[lane], y.0[lane]]));
                first += F::LANES;
            }
            bits
        }
    }

    #[test]
    fn the_same_bits_at_every_level_and_width() {
        let expected = lanes::run(Level::SCALAR, 1, Bits);
        assert_eq!(expected.len(), 64);
        for level in Level::available() {
            for width in [1, 4, 8, 16] {
                assert_eq!(lanes::run(level, width, Bits), expected, "{level}, {width} lanes");
            }
        }
    }
}
