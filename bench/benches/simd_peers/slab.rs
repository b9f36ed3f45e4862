//! One ray against 1024 boxes, as structure of arrays: where it enters them, infinity where it misses.

use super::{Contest, Floats, load8, load16, noise, store8, store16, wide_type};
use criterion::Criterion;
use std::arch::x86_64::*;

const N: usize = 1024;

#[derive(Clone)]
pub struct Input {
    min: [Floats<N>; 3],
    max: [Floats<N>; 3],
    origin: [f32; 3],
    /// One over the direction.
    inverse: [f32; 3],
    t_max: f32,
}

pub type Output = Floats<N>;

/// The input, and the output before.
pub fn input() -> (Input, Output) {
    let min: [_; 3] =
        std::array::from_fn(|axis| super::Aligned(std::array::from_fn(|i| noise(3 * i + axis) * 4.0 - 2.0)));
    let max = min.map(|side| super::Aligned(side.0.map(|x| x + 1.5)));
    let direction = [0.1_f32, -0.2, 1.0];
    let inverse = direction.map(f32::recip);
    let input = Input { min, max, origin: [0.1, 0.2, -5.0], inverse, t_max: 100.0 };
    (input, super::Aligned([0.0; N]))
}

pub fn contest(criterion: &mut Criterion) {
    let (input, blank) = input();
    let mut expected = blank;
    plain(&input, &mut expected);
    let hits = expected.0.iter().filter(|t| t.is_finite()).count();
    assert!((N / 16..N).contains(&hits), "{hits} of {N} boxes hit");

    let check = move |_: &Input, out: &Output| *out == expected;
    let mut contest = Contest::new(criterion, "slab", N, (input, blank), check);
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
        let (mut enter, mut leave) = (0.0, input.t_max);
        for axis in 0..3 {
            let a = (input.min[axis].0[i] - input.origin[axis]) * input.inverse[axis];
            let b = (input.max[axis].0[i] - input.origin[axis]) * input.inverse[axis];
            let (near, far) = (if a < b { a } else { b }, if a > b { a } else { b });
            enter = if near > enter { near } else { enter };
            leave = if far < leave { far } else { leave };
        }
        out.0[i] = if enter <= leave { enter } else { f32::INFINITY };
    }
}

simd::kernel! {
    pub fn with_simd<S>(input: &Input, out: &mut Output) {
        use simd::Vector;
        let lanes = S::Float::LANES;
        for i in 0..N / lanes {
            let at = |floats: &Floats<N>| S::Float::load(&floats.0[i * lanes..]);
            let (mut enter, mut leave) = (S::Float::splat(0.0), S::Float::splat(input.t_max));
            for axis in 0..3 {
                let (origin, inverse) = (S::Float::splat(input.origin[axis]), S::Float::splat(input.inverse[axis]));
                let a = (at(&input.min[axis]) - origin) * inverse;
                let b = (at(&input.max[axis]) - origin) * inverse;
                enter = a.min(b).max(enter);
                leave = a.max(b).min(leave);
            }
            let t = S::Float::select(enter.le(leave), enter, S::Float::splat(f32::INFINITY));
            t.store(&mut out.0[i * lanes..]);
        }
    }
}

#[target_feature(enable = "avx2")]
fn avx2(input: &Input, out: &mut Output) {
    let splat = |v: [f32; 3]| [_mm256_set1_ps(v[0]), _mm256_set1_ps(v[1]), _mm256_set1_ps(v[2])];
    let (origin, inverse) = (splat(input.origin), splat(input.inverse));
    for (i, out) in out.0.as_chunks_mut::<8>().0.iter_mut().enumerate() {
        let (mut enter, mut leave) = (_mm256_setzero_ps(), _mm256_set1_ps(input.t_max));
        for axis in 0..3 {
            let a = load8(&input.min[axis].0.as_chunks().0[i]);
            let b = load8(&input.max[axis].0.as_chunks().0[i]);
            let a = _mm256_mul_ps(_mm256_sub_ps(a, origin[axis]), inverse[axis]);
            let b = _mm256_mul_ps(_mm256_sub_ps(b, origin[axis]), inverse[axis]);
            enter = _mm256_max_ps(_mm256_min_ps(a, b), enter);
            leave = _mm256_min_ps(_mm256_max_ps(a, b), leave);
        }
        let hit = _mm256_cmp_ps::<_CMP_LE_OQ>(enter, leave);
        store8(_mm256_blendv_ps(_mm256_set1_ps(f32::INFINITY), enter, hit), out);
    }
}

#[target_feature(enable = "avx512f")]
fn avx512(input: &Input, out: &mut Output) {
    let splat = |v: [f32; 3]| [_mm512_set1_ps(v[0]), _mm512_set1_ps(v[1]), _mm512_set1_ps(v[2])];
    let (origin, inverse) = (splat(input.origin), splat(input.inverse));
    for (i, out) in out.0.as_chunks_mut::<16>().0.iter_mut().enumerate() {
        let (mut enter, mut leave) = (_mm512_setzero_ps(), _mm512_set1_ps(input.t_max));
        for axis in 0..3 {
            let a = load16(&input.min[axis].0.as_chunks().0[i]);
            let b = load16(&input.max[axis].0.as_chunks().0[i]);
            let a = _mm512_mul_ps(_mm512_sub_ps(a, origin[axis]), inverse[axis]);
            let b = _mm512_mul_ps(_mm512_sub_ps(b, origin[axis]), inverse[axis]);
            enter = _mm512_max_ps(_mm512_min_ps(a, b), enter);
            leave = _mm512_min_ps(_mm512_max_ps(a, b), leave);
        }
        let hit = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(enter, leave);
        store16(_mm512_mask_blend_ps(hit, _mm512_set1_ps(f32::INFINITY), enter), out);
    }
}

fn wide(input: &Input, out: &mut Output) {
    use wide_type::{F, LANES, load, store};
    for i in 0..N / LANES {
        let (mut enter, mut leave) = (F::splat(0.0), F::splat(input.t_max));
        for axis in 0..3 {
            let (origin, inverse) = (F::splat(input.origin[axis]), F::splat(input.inverse[axis]));
            let a = (load(&input.min[axis].0, i) - origin) * inverse;
            let b = (load(&input.max[axis].0, i) - origin) * inverse;
            enter = a.fast_min(b).fast_max(enter);
            leave = a.fast_max(b).fast_min(leave);
        }
        store(enter.simd_le(leave).select(enter, F::splat(f32::INFINITY)), &mut out.0, i);
    }
}

struct Pulp<'a>(&'a Input, &'a mut Output);

impl pulp::WithSimd for Pulp<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, s: S) {
        let Self(input, out) = self;
        let min = [0, 1, 2].map(|axis: usize| S::as_simd_f32s(&input.min[axis].0).0);
        let max = [0, 1, 2].map(|axis: usize| S::as_simd_f32s(&input.max[axis].0).0);
        for (i, out) in S::as_mut_simd_f32s(&mut out.0).0.iter_mut().enumerate() {
            let (mut enter, mut leave) = (s.splat_f32s(0.0), s.splat_f32s(input.t_max));
            for axis in 0..3 {
                let (origin, inverse) = (s.splat_f32s(input.origin[axis]), s.splat_f32s(input.inverse[axis]));
                let a = s.mul_f32s(s.sub_f32s(min[axis][i], origin), inverse);
                let b = s.mul_f32s(s.sub_f32s(max[axis][i], origin), inverse);
                enter = s.max_f32s(s.min_f32s(a, b), enter);
                leave = s.min_f32s(s.max_f32s(a, b), leave);
            }
            *out = s.select_f32s(s.less_than_or_equal_f32s(enter, leave), enter, s.splat_f32s(f32::INFINITY));
        }
    }
}

#[inline(always)]
fn fearless<S: fearless_simd::Simd>(simd: S, input: &Input, out: &mut Output) {
    use fearless_simd::prelude::*;
    let lanes = S::f32s::LEN;
    for i in 0..N / lanes {
        let (mut enter, mut leave) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, input.t_max));
        for axis in 0..3 {
            let (origin, inverse) = (input.origin[axis], input.inverse[axis]);
            let a = (S::f32s::from_slice(simd, &input.min[axis].0[i * lanes..][..lanes]) - origin) * inverse;
            let b = (S::f32s::from_slice(simd, &input.max[axis].0[i * lanes..][..lanes]) - origin) * inverse;
            enter = a.min(b).max(enter);
            leave = a.max(b).min(leave);
        }
        let t = enter.simd_le(leave).select(enter, S::f32s::splat(simd, f32::INFINITY));
        t.store_slice(&mut out.0[i * lanes..][..lanes]);
    }
}
