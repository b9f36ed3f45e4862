//! 4096 entries of a table of 64 KiB.

use super::{Aligned, Contest, Floats, noise, store8, store16};
use criterion::Criterion;
use std::arch::x86_64::*;

const N: usize = 4096;
const TABLE: usize = 64 * 1024 / 4;

#[derive(Clone)]
pub struct Input {
    table: Floats<TABLE>,
    /// Below `TABLE`, all of them.
    indices: Aligned<[u32; N]>,
}

pub type Output = Floats<N>;

/// The input, and the output before.
pub fn input() -> (Input, Output) {
    let input = Input {
        table: Aligned(std::array::from_fn(noise)),
        indices: Aligned(std::array::from_fn(|i| (noise(i) * TABLE as f32) as u32 % TABLE as u32)),
    };
    (input, Aligned([0.0; N]))
}

pub fn contest(criterion: &mut Criterion) {
    let (input, blank) = input();
    let mut expected = blank;
    plain(&input, &mut expected);

    let check = move |_: &Input, out: &Output| *out == expected;
    let mut contest = Contest::new(criterion, "gather", N, (input, blank), check);
    contest.simd(with_simd);
    contest.intrinsics(avx2, avx512);
    contest.plain(plain);
}

/// With a check of every index.
#[inline(always)]
fn plain(input: &Input, out: &mut Output) {
    for (out, &index) in out.0.iter_mut().zip(&input.indices.0) {
        *out = input.table.0[index as usize];
    }
}

simd::kernel! {
    /// With a check of every vector of indices.
    pub fn with_simd<S>(input: &Input, out: &mut Output) {
        look_up::<S::Float>(input, out);
    }
}

#[inline(always)]
fn look_up<F: simd::Float>(input: &Input, out: &mut Output) {
    use simd::Vector;
    for i in (0..N).step_by(F::LANES) {
        let indices = F::Index::load(&input.indices.0[i..]);
        F::gather(&input.table.0, indices).store(&mut out.0[i..]);
    }
}

/// Without a check.
#[target_feature(enable = "avx2")]
fn avx2(input: &Input, out: &mut Output) {
    for (indices, out) in input.indices.0.as_chunks::<8>().0.iter().zip(out.0.as_chunks_mut::<8>().0) {
        // SAFETY: eight indices to read; all of them below `TABLE`, and the table has so many.
        let x = unsafe {
            let indices = _mm256_loadu_si256(indices.as_ptr().cast());
            _mm256_i32gather_ps::<4>(input.table.0.as_ptr(), indices)
        };
        store8(x, out);
    }
}

/// Without a check.
#[target_feature(enable = "avx512f")]
fn avx512(input: &Input, out: &mut Output) {
    for (indices, out) in input.indices.0.as_chunks::<16>().0.iter().zip(out.0.as_chunks_mut::<16>().0) {
        // SAFETY: sixteen indices to read; all of them below `TABLE`, and the table has so many.
        let x = unsafe {
            let indices = _mm512_loadu_si512(indices.as_ptr().cast());
            _mm512_i32gather_ps::<4>(indices, input.table.0.as_ptr())
        };
        store16(x, out);
    }
}
