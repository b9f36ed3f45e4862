//! The dot product of 4096 numbers, in 64 partial sums: one order at every width, and enough independent sums for all registers.

use super::{Contest, Floats, load8, load16, noise, wide_type};
use criterion::Criterion;
use std::arch::x86_64::*;

const N: usize = 4096;
/// Partial sums. Then number `i` takes in `i + 32`, `i + 16`, and so on, down to one.
const SUMS: usize = 64;

#[derive(Clone)]
pub struct Input {
    a: Floats<N>,
    b: Floats<N>,
}

pub type Output = f32;

/// The input, and the output before.
pub fn input() -> (Input, Output) {
    let floats = |k: usize| super::Aligned(std::array::from_fn(|i| noise(2 * i + k) - 0.4));
    (Input { a: floats(0), b: floats(1) }, 0.0)
}

pub fn contest(criterion: &mut Criterion) {
    let (input, blank) = input();
    let mut expected = 0.0;
    plain(&input, &mut expected);

    let check = move |_: &Input, sum: &f32| sum.to_bits() == expected.to_bits();
    let mut contest = Contest::new(criterion, "dot", N, (input, blank), check);
    contest.simd(with_simd);
    contest.intrinsics(avx2, avx512);
    contest.wide(wide);
    contest.pulp(|arch, i, o| arch.dispatch(Pulp(i, o)));
    contest.fearless(|level, i, o| fearless_simd::dispatch!(level, simd => fearless(simd, i, o)));
    contest.plain(plain);
}

/// Adds the upper half to the lower until one is left.
#[inline(always)]
fn tree<const N: usize>(mut sums: [f32; N]) -> f32 {
    let mut n = N / 2;
    while n > 0 {
        for i in 0..n {
            sums[i] += sums[i + n];
        }
        n /= 2;
    }
    sums[0]
}

#[inline(always)]
fn plain(input: &Input, sum: &mut f32) {
    let mut sums = [0.0; SUMS];
    for (a, b) in input.a.0.as_chunks::<SUMS>().0.iter().zip(input.b.0.as_chunks::<SUMS>().0) {
        for i in 0..SUMS {
            sums[i] += a[i] * b[i];
        }
    }
    *sum = tree(sums);
}

simd::kernel! {
    pub fn with_simd<S>(input: &Input, sum: &mut f32) {
        use simd::{Float, Vector};
        let mut sums = [S::Float16::splat(0.0); SUMS / 16];
        for (a, b) in input.a.0.as_chunks::<SUMS>().0.iter().zip(input.b.0.as_chunks::<SUMS>().0) {
            for (k, sum) in sums.iter_mut().enumerate() {
                *sum += S::Float16::load(&a[16 * k..]) * S::Float16::load(&b[16 * k..]);
            }
        }
        *sum = ((sums[0] + sums[2]) + (sums[1] + sums[3])).reduce_add();
    }
}

#[target_feature(enable = "avx2")]
fn avx2(input: &Input, sum: &mut f32) {
    let mut s = [_mm256_setzero_ps(); 8];
    for (a, b) in input.a.0.as_chunks::<SUMS>().0.iter().zip(input.b.0.as_chunks::<SUMS>().0) {
        for (k, sum) in s.iter_mut().enumerate() {
            let (a, b) = (load8(&a.as_chunks().0[k]), load8(&b.as_chunks().0[k]));
            *sum = _mm256_add_ps(*sum, _mm256_mul_ps(a, b));
        }
    }
    let pair = |k: usize| _mm256_add_ps(s[k], s[k + 4]);
    let s = _mm256_add_ps(_mm256_add_ps(pair(0), pair(2)), _mm256_add_ps(pair(1), pair(3)));
    *sum = sum8(s);
}

#[target_feature(enable = "avx")]
fn sum8(s: __m256) -> f32 {
    let s = _mm_add_ps(_mm256_castps256_ps128(s), _mm256_extractf128_ps::<1>(s));
    let s = _mm_add_ps(s, _mm_movehl_ps(s, s));
    _mm_cvtss_f32(_mm_add_ss(s, _mm_shuffle_ps::<1>(s, s)))
}

#[target_feature(enable = "avx512f,avx512dq")]
fn avx512(input: &Input, sum: &mut f32) {
    let mut s = [_mm512_setzero_ps(); 4];
    for (a, b) in input.a.0.as_chunks::<SUMS>().0.iter().zip(input.b.0.as_chunks::<SUMS>().0) {
        for (k, sum) in s.iter_mut().enumerate() {
            let (a, b) = (load16(&a.as_chunks().0[k]), load16(&b.as_chunks().0[k]));
            *sum = _mm512_add_ps(*sum, _mm512_mul_ps(a, b));
        }
    }
    let s = _mm512_add_ps(_mm512_add_ps(s[0], s[2]), _mm512_add_ps(s[1], s[3]));
    *sum = sum8(_mm256_add_ps(_mm512_castps512_ps256(s), _mm512_extractf32x8_ps::<1>(s)));
}

fn wide(input: &Input, sum: &mut f32) {
    use wide_type::{F, LANES, load};
    let mut sums = [F::splat(0.0); SUMS / LANES];
    for (a, b) in input.a.0.as_chunks::<SUMS>().0.iter().zip(input.b.0.as_chunks::<SUMS>().0) {
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum += load(a, k) * load(b, k);
        }
    }
    let mut n = SUMS / LANES / 2;
    while n > 0 {
        for k in 0..n {
            sums[k] += sums[k + n];
        }
        n /= 2;
    }
    *sum = tree(sums[0].to_array());
}

struct Pulp<'a>(&'a Input, &'a mut f32);

impl pulp::WithSimd for Pulp<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, s: S) {
        let Self(input, sum) = self;
        // Room for the sums of four lanes and up.
        let mut sums = [s.splat_f32s(0.0); SUMS / 4];
        let used = SUMS / S::F32_LANES;
        for (a, b) in input.a.0.as_chunks::<SUMS>().0.iter().zip(input.b.0.as_chunks::<SUMS>().0) {
            let (a, b) = (S::as_simd_f32s(a).0, S::as_simd_f32s(b).0);
            for k in 0..used {
                sums[k] = s.add_f32s(sums[k], s.mul_f32s(a[k], b[k]));
            }
        }
        let mut n = used / 2;
        while n > 0 {
            for k in 0..n {
                sums[k] = s.add_f32s(sums[k], sums[k + n]);
            }
            n /= 2;
        }
        *sum = s.reduce_sum_f32s(sums[0]);
    }
}

#[inline(always)]
fn fearless<S: fearless_simd::Simd>(simd: S, input: &Input, sum: &mut f32) {
    use fearless_simd::{f32x16, prelude::*};
    let mut sums = [f32x16::splat(simd, 0.0); SUMS / 16];
    for (a, b) in input.a.0.as_chunks::<SUMS>().0.iter().zip(input.b.0.as_chunks::<SUMS>().0) {
        for (k, sum) in sums.iter_mut().enumerate() {
            let (a, b) = (&a[16 * k..][..16], &b[16 * k..][..16]);
            *sum += f32x16::from_slice(simd, a) * f32x16::from_slice(simd, b);
        }
    }
    *sum = ((sums[0] + sums[2]) + (sums[1] + sums[3])).reduce_sum();
}
