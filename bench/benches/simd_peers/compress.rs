//! Those of 4096 numbers that are above a threshold, in their order.

use super::{Contest, Floats, load8, load16, noise, store8, store16};
use criterion::Criterion;
use std::arch::x86_64::*;

const N: usize = 4096;
/// Vectors are written whole: the output has room for one more.
const ROOM: usize = N + 16;

#[derive(Clone)]
pub struct Input {
    numbers: Floats<N>,
    threshold: f32,
}

#[derive(Clone)]
pub struct Output {
    len: usize,
    numbers: Floats<ROOM>,
}

/// The input, and the output before.
pub fn input() -> (Input, Output) {
    (
        Input { numbers: super::Aligned(std::array::from_fn(noise)), threshold: 0.6 },
        Output { len: 0, numbers: super::Aligned([0.0; ROOM]) },
    )
}

pub fn contest(criterion: &mut Criterion) {
    let (input, blank) = input();
    let mut expected = blank.clone();
    plain(&input, &mut expected);
    assert!((N / 3..N / 2).contains(&expected.len), "{} of {N} are above", expected.len);

    let check = move |_: &Input, out: &Output| {
        out.len == expected.len && out.numbers.0[..out.len] == expected.numbers.0[..expected.len]
    };
    let mut contest = Contest::new(criterion, "compress", N, (input, blank), check);
    contest.simd(with_simd);
    contest.intrinsics(avx2, avx512);
    contest.fearless(|level, i, o| fearless_simd::dispatch!(level, simd => fearless(simd, i, o)));
    contest.plain(plain);
}

#[inline(always)]
fn plain(input: &Input, out: &mut Output) {
    let mut len = 0;
    for &x in &input.numbers.0 {
        // Written always, kept when above: no branch.
        out.numbers.0[len] = x;
        len += usize::from(x > input.threshold);
    }
    out.len = len;
}

simd::kernel! {
    pub fn with_simd<S>(input: &Input, out: &mut Output) {
        use simd::Vector;
        let threshold = S::Float::splat(input.threshold);
        let mut len = 0;
        for i in (0..N).step_by(S::Float::LANES) {
            let x = S::Float::load(&input.numbers.0[i..]);
            len += x.compress_store(x.gt(threshold), &mut out.numbers.0[len..]);
        }
        out.len = len;
    }
}

/// For each mask of eight lanes those that are on, then others, as bytes.
static LANES: [u64; 256] = lanes();

const fn lanes() -> [u64; 256] {
    let mut table = [0; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut n) = (0, 0);
        while lane < 8 {
            if mask >> lane & 1 == 1 {
                table[mask] |= lane << (8 * n);
                n += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
}

#[target_feature(enable = "avx2,popcnt")]
fn avx2(input: &Input, out: &mut Output) {
    let threshold = _mm256_set1_ps(input.threshold);
    let mut len = 0;
    for numbers in input.numbers.0.as_chunks::<8>().0 {
        let x = load8(numbers);
        let mask = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(threshold, x)) as usize;
        let lanes = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(LANES[mask] as i64));
        // SAFETY: no more than `N` before it and eight now.
        let to = unsafe { &mut *out.numbers.0.as_mut_ptr().add(len).cast() };
        store8(_mm256_permutevar8x32_ps(x, lanes), to);
        len += mask.count_ones() as usize;
    }
    out.len = len;
}

#[target_feature(enable = "avx512f,popcnt")]
fn avx512(input: &Input, out: &mut Output) {
    let threshold = _mm512_set1_ps(input.threshold);
    let mut len = 0;
    for numbers in input.numbers.0.as_chunks::<16>().0 {
        let x = load16(numbers);
        let mask = _mm512_cmp_ps_mask::<_CMP_LT_OQ>(threshold, x);
        // SAFETY: no more than `N` before it and sixteen now.
        let to = unsafe { &mut *out.numbers.0.as_mut_ptr().add(len).cast() };
        // In a register: to memory, the instruction is microcode on some.
        store16(_mm512_maskz_compress_ps(mask, x), to);
        len += mask.count_ones() as usize;
    }
    out.len = len;
}

#[inline(always)]
fn fearless<S: fearless_simd::Simd>(simd: S, input: &Input, out: &mut Output) {
    use fearless_simd::prelude::*;
    let lanes = S::f32s::LEN;
    let mut len = 0;
    for numbers in input.numbers.0.chunks_exact(lanes) {
        let x = S::f32s::from_slice(simd, numbers);
        let mask = x.simd_gt(input.threshold);
        x.compress(mask).store_slice(&mut out.numbers.0[len..][..lanes]);
        len += mask.to_bitmask().count_ones() as usize;
    }
    out.len = len;
}
