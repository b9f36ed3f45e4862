//! 1024 rows of eight fields to eight columns: array of structures to structure of arrays.

use super::{Aligned, Contest, noise, store8, store16};
use criterion::Criterion;
use std::arch::x86_64::*;

const N: usize = 1024;

/// Not a multiple of 4 KiB: eight columns that share a line of the cache would hide the shuffles.
const ROOM: usize = N + 16;

pub type Input = Aligned<[[f32; 8]; N]>;
pub type Output = Aligned<[[f32; ROOM]; 8]>;

/// The input, and the output before.
pub fn input() -> (Input, Output) {
    (Aligned(std::array::from_fn(|i| std::array::from_fn(|k| noise(8 * i + k)))), Aligned([[0.0; ROOM]; 8]))
}

pub fn contest(criterion: &mut Criterion) {
    let (input, blank) = input();
    let mut expected = Box::new(blank);
    plain(&input, &mut expected);

    let check = move |_: &Input, out: &Output| *out == *expected;
    let mut contest = Contest::new(criterion, "transpose", 8 * N, (input, blank), check);
    contest.simd(with_simd);
    contest.intrinsics(avx2, avx512);
    contest.wide(wide);
    contest.pulp(|arch, i, o| arch.dispatch(Pulp(i, o)));
    contest.fearless(|level, i, o| fearless_simd::dispatch!(level, simd => fearless(simd, i, o)));
    contest.plain(plain);
}

#[inline(always)]
fn plain(input: &Input, out: &mut Output) {
    for i in 0..N {
        for k in 0..8 {
            out.0[k][i] = input.0[i][k];
        }
    }
}

simd::kernel! {
    pub fn with_simd<S>(input: &Input, out: &mut Output) {
        use simd::Vector;
        let lanes = S::Float::LANES;
        for i in 0..N / lanes {
            let columns = S::Float::load_rows8(&input.0[i * lanes..]);
            for (k, column) in columns.into_iter().enumerate() {
                column.store(&mut out.0[k][i * lanes..]);
            }
        }
    }
}

#[inline]
#[target_feature(enable = "avx")]
fn quad(row: &[f32; 8], upper: usize) -> __m128 {
    // SAFETY: four to read.
    unsafe { _mm_loadu_ps(row.as_chunks::<4>().0[upper].as_ptr()) }
}

#[target_feature(enable = "avx2")]
fn avx2(input: &Input, out: &mut Output) {
    for (i, rows) in input.0.as_chunks::<8>().0.iter().enumerate() {
        for upper in 0..2 {
            // Four fields of rows 0 and 4, 1 and 5, ...; then a transpose in each half.
            let join = |k: usize| _mm256_set_m128(quad(&rows[k + 4], upper), quad(&rows[k], upper));
            let (a, b, c, d) = (join(0), join(1), join(2), join(3));
            let (ab_low, ab_high) = (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
            let (cd_low, cd_high) = (_mm256_unpacklo_ps(c, d), _mm256_unpackhi_ps(c, d));
            let columns = [
                _mm256_shuffle_ps::<0b01_00_01_00>(ab_low, cd_low),
                _mm256_shuffle_ps::<0b11_10_11_10>(ab_low, cd_low),
                _mm256_shuffle_ps::<0b01_00_01_00>(ab_high, cd_high),
                _mm256_shuffle_ps::<0b11_10_11_10>(ab_high, cd_high),
            ];
            for (k, &column) in columns.iter().enumerate() {
                store8(column, &mut out.0[4 * upper + k].as_chunks_mut().0[i]);
            }
        }
    }
}

#[target_feature(enable = "avx512f,avx512dq")]
fn avx512(input: &Input, out: &mut Output) {
    for (i, rows) in input.0.as_chunks::<16>().0.iter().enumerate() {
        for upper in 0..2 {
            let join = |k: usize| {
                let low = _mm256_set_m128(quad(&rows[k + 4], upper), quad(&rows[k], upper));
                let high = _mm256_set_m128(quad(&rows[k + 12], upper), quad(&rows[k + 8], upper));
                _mm512_insertf32x8::<1>(_mm512_castps256_ps512(low), high)
            };
            let (a, b, c, d) = (join(0), join(1), join(2), join(3));
            let (ab_low, ab_high) = (_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b));
            let (cd_low, cd_high) = (_mm512_unpacklo_ps(c, d), _mm512_unpackhi_ps(c, d));
            let columns = [
                _mm512_shuffle_ps::<0b01_00_01_00>(ab_low, cd_low),
                _mm512_shuffle_ps::<0b11_10_11_10>(ab_low, cd_low),
                _mm512_shuffle_ps::<0b01_00_01_00>(ab_high, cd_high),
                _mm512_shuffle_ps::<0b11_10_11_10>(ab_high, cd_high),
            ];
            for (k, &column) in columns.iter().enumerate() {
                store16(column, &mut out.0[4 * upper + k].as_chunks_mut().0[i]);
            }
        }
    }
}

/// Eight rows at a time, whatever the registers.
fn wide(input: &Input, out: &mut Output) {
    use wide::f32x8;
    for (i, rows) in input.0.as_chunks::<8>().0.iter().enumerate() {
        for (k, column) in f32x8::transpose(rows.map(f32x8::new)).into_iter().enumerate() {
            out.0[k].as_chunks_mut().0[i] = column.to_array();
        }
    }
}

struct Pulp<'a>(&'a Input, &'a mut Output);

impl pulp::WithSimd for Pulp<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, s: S) {
        let Self(input, out) = self;
        for (i, rows) in S::as_simd_f32s(input.0.as_flattened()).0.as_chunks::<8>().0.iter().enumerate() {
            // In order for eight; for two and four fields it would be another, for shuffles' sake.
            for (k, column) in s.deinterleave_shfl_f32s(*rows).into_iter().enumerate() {
                S::as_mut_simd_f32s(&mut out.0[k]).0[i] = column;
            }
        }
    }
}

/// Three rounds of even and odd lanes.
#[inline(always)]
fn fearless<S: fearless_simd::Simd>(simd: S, input: &Input, out: &mut Output) {
    use fearless_simd::prelude::*;
    let lanes = S::f32s::LEN;
    for i in 0..N / lanes {
        let rows = input.0[i * lanes..][..lanes].as_flattened();
        let mut x = [S::f32s::splat(simd, 0.0); 8];
        for (k, x) in x.iter_mut().enumerate() {
            *x = S::f32s::from_slice(simd, &rows[k * lanes..][..lanes]);
        }
        for _ in 0..3 {
            let mut y = x;
            for k in 0..4 {
                (y[k], y[k + 4]) = x[2 * k].deinterleave(x[2 * k + 1]);
            }
            x = y;
        }
        for (k, column) in x.into_iter().enumerate() {
            column.store_slice(&mut out.0[k][i * lanes..][..lanes]);
        }
    }
}
