//! One ray against 1024 triangles, as structure of arrays (Moller and Trumbore 1997): the distance, infinity where it misses.

use super::{Contest, Floats, load8, load16, noise, store8, store16, wide_type};
use criterion::Criterion;
use std::arch::x86_64::*;
use std::ops::{Add, Mul, Sub};

const N: usize = 1024;

#[derive(Clone)]
pub struct Input {
    /// A corner, and the edges to the other two.
    corner: [Floats<N>; 3],
    edges: [[Floats<N>; 3]; 2],
    origin: [f32; 3],
    direction: [f32; 3],
    t_max: f32,
}

pub type Output = Floats<N>;

/// The input, and the output before.
pub fn input() -> (Input, Output) {
    let floats = |k: usize| super::Aligned(std::array::from_fn(|i| noise(9 * i + k) * 2.0 - 1.0));
    let corner = [0, 1, 2].map(|axis| super::Aligned(floats(axis).0.map(|x: f32| x * 0.5)));
    let edges = [[3, 4, 5].map(floats), [6, 7, 8].map(floats)];
    let input = Input { corner, edges, origin: [0.1, 0.2, -5.0], direction: [0.01, -0.02, 1.0], t_max: 100.0 };
    (input, super::Aligned([0.0; N]))
}

pub fn contest(criterion: &mut Criterion) {
    let (input, blank) = input();
    let mut expected = blank;
    plain(&input, &mut expected);
    let hits = expected.0.iter().filter(|t| t.is_finite()).count();
    assert!((N / 32..N / 2).contains(&hits), "{hits} of {N} triangles hit");

    let check = move |_: &Input, out: &Output| *out == expected;
    let mut contest = Contest::new(criterion, "triangle", N, (input, blank), check);
    contest.simd(with_simd);
    contest.intrinsics(avx2, avx512);
    contest.wide(wide);
    contest.pulp(|arch, i, o| arch.dispatch(Pulp(i, o)));
    contest.fearless(|level, i, o| fearless_simd::dispatch!(level, simd => fearless(simd, i, o)));
    contest.plain(plain);
}

/// The cross product, with the operations of a contestant.
macro_rules! cross {
    ([$($mul:tt)*], [$($sub:tt)*], $a:expr, $b:expr) => {{
        let (a, b) = ($a, $b);
        [
            $($sub)*($($mul)*(a[1], b[2]), $($mul)*(a[2], b[1])),
            $($sub)*($($mul)*(a[2], b[0]), $($mul)*(a[0], b[2])),
            $($sub)*($($mul)*(a[0], b[1]), $($mul)*(a[1], b[0])),
        ]
    }};
    ($a:expr, $b:expr) => { cross!([Mul::mul], [Sub::sub], $a, $b) };
}

/// The dot product, with the operations of a contestant.
macro_rules! dot {
    ([$($mul:tt)*], [$($add:tt)*], $a:expr, $b:expr) => {{
        let (a, b) = ($a, $b);
        $($add)*($($add)*($($mul)*(a[0], b[0]), $($mul)*(a[1], b[1])), $($mul)*(a[2], b[2]))
    }};
    ($a:expr, $b:expr) => { dot!([Mul::mul], [Add::add], $a, $b) };
}

#[inline(always)]
fn plain(input: &Input, out: &mut Output) {
    for i in 0..N {
        let of = |vectors: &[Floats<N>; 3]| [vectors[0].0[i], vectors[1].0[i], vectors[2].0[i]];
        let [e1, e2] = [of(&input.edges[0]), of(&input.edges[1])];
        let corner = of(&input.corner);
        let p = cross!(input.direction, e2);
        let inverse = 1.0 / dot!(e1, p);
        let s = [input.origin[0] - corner[0], input.origin[1] - corner[1], input.origin[2] - corner[2]];
        let u = dot!(s, p) * inverse;
        let q = cross!(s, e1);
        let v = dot!(input.direction, q) * inverse;
        let t = dot!(e2, q) * inverse;
        // Without short circuits: no branches.
        let hit = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (t > 0.0) & (t < input.t_max);
        out.0[i] = if hit { t } else { f32::INFINITY };
    }
}

simd::kernel! {
    pub fn with_simd<S>(input: &Input, out: &mut Output) {
        use simd::Vector;
        let (lanes, zero, one) = (S::Float::LANES, S::Float::splat(0.0), S::Float::splat(1.0));
        let splat = |v: [f32; 3]| [S::Float::splat(v[0]), S::Float::splat(v[1]), S::Float::splat(v[2])];
        let (origin, direction) = (splat(input.origin), splat(input.direction));
        for i in 0..N / lanes {
            let at = |floats: &Floats<N>| S::Float::load(&floats.0[i * lanes..]);
            let of = |vectors: &[Floats<N>; 3]| [at(&vectors[0]), at(&vectors[1]), at(&vectors[2])];
            let [e1, e2] = [of(&input.edges[0]), of(&input.edges[1])];
            let corner = of(&input.corner);
            let p = cross!(direction, e2);
            let inverse = one / dot!(e1, p);
            let s = [origin[0] - corner[0], origin[1] - corner[1], origin[2] - corner[2]];
            let u = dot!(s, p) * inverse;
            let q = cross!(s, e1);
            let v = dot!(direction, q) * inverse;
            let t = dot!(e2, q) * inverse;
            let hit = u.ge(zero) & v.ge(zero) & (u + v).le(one) & t.gt(zero) & t.lt(S::Float::splat(input.t_max));
            S::Float::select(hit, t, S::Float::splat(f32::INFINITY)).store(&mut out.0[i * lanes..]);
        }
    }
}

#[target_feature(enable = "avx2")]
fn avx2(input: &Input, out: &mut Output) {
    let (zero, one) = (_mm256_setzero_ps(), _mm256_set1_ps(1.0));
    let splat = |v: [f32; 3]| [_mm256_set1_ps(v[0]), _mm256_set1_ps(v[1]), _mm256_set1_ps(v[2])];
    let (origin, direction) = (splat(input.origin), splat(input.direction));
    for (i, out) in out.0.as_chunks_mut::<8>().0.iter_mut().enumerate() {
        let at = |floats: &Floats<N>| load8(&floats.0.as_chunks().0[i]);
        let of = |vectors: &[Floats<N>; 3]| [at(&vectors[0]), at(&vectors[1]), at(&vectors[2])];
        let [e1, e2] = [of(&input.edges[0]), of(&input.edges[1])];
        let corner = of(&input.corner);
        let p = cross!([_mm256_mul_ps], [_mm256_sub_ps], direction, e2);
        let inverse = _mm256_div_ps(one, dot!([_mm256_mul_ps], [_mm256_add_ps], e1, p));
        let s = |k: usize| _mm256_sub_ps(origin[k], corner[k]);
        let s = [s(0), s(1), s(2)];
        let u = _mm256_mul_ps(dot!([_mm256_mul_ps], [_mm256_add_ps], s, p), inverse);
        let q = cross!([_mm256_mul_ps], [_mm256_sub_ps], s, e1);
        let v = _mm256_mul_ps(dot!([_mm256_mul_ps], [_mm256_add_ps], direction, q), inverse);
        let t = _mm256_mul_ps(dot!([_mm256_mul_ps], [_mm256_add_ps], e2, q), inverse);
        let inside = _mm256_and_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(zero, u), _mm256_cmp_ps::<_CMP_LE_OQ>(zero, v));
        let inside = _mm256_and_ps(inside, _mm256_cmp_ps::<_CMP_LE_OQ>(_mm256_add_ps(u, v), one));
        let ahead = _mm256_cmp_ps::<_CMP_LT_OQ>(zero, t);
        let near = _mm256_cmp_ps::<_CMP_LT_OQ>(t, _mm256_set1_ps(input.t_max));
        let hit = _mm256_and_ps(inside, _mm256_and_ps(ahead, near));
        store8(_mm256_blendv_ps(_mm256_set1_ps(f32::INFINITY), t, hit), out);
    }
}

#[target_feature(enable = "avx512f")]
fn avx512(input: &Input, out: &mut Output) {
    let (zero, one) = (_mm512_setzero_ps(), _mm512_set1_ps(1.0));
    let splat = |v: [f32; 3]| [_mm512_set1_ps(v[0]), _mm512_set1_ps(v[1]), _mm512_set1_ps(v[2])];
    let (origin, direction) = (splat(input.origin), splat(input.direction));
    for (i, out) in out.0.as_chunks_mut::<16>().0.iter_mut().enumerate() {
        let at = |floats: &Floats<N>| load16(&floats.0.as_chunks().0[i]);
        let of = |vectors: &[Floats<N>; 3]| [at(&vectors[0]), at(&vectors[1]), at(&vectors[2])];
        let [e1, e2] = [of(&input.edges[0]), of(&input.edges[1])];
        let corner = of(&input.corner);
        let p = cross!([_mm512_mul_ps], [_mm512_sub_ps], direction, e2);
        let inverse = _mm512_div_ps(one, dot!([_mm512_mul_ps], [_mm512_add_ps], e1, p));
        let s = |k: usize| _mm512_sub_ps(origin[k], corner[k]);
        let s = [s(0), s(1), s(2)];
        let u = _mm512_mul_ps(dot!([_mm512_mul_ps], [_mm512_add_ps], s, p), inverse);
        let q = cross!([_mm512_mul_ps], [_mm512_sub_ps], s, e1);
        let v = _mm512_mul_ps(dot!([_mm512_mul_ps], [_mm512_add_ps], direction, q), inverse);
        let t = _mm512_mul_ps(dot!([_mm512_mul_ps], [_mm512_add_ps], e2, q), inverse);
        // Each comparison under the mask of the one before.
        let hit = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(zero, u);
        let hit = _mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(hit, zero, v);
        let hit = _mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(hit, _mm512_add_ps(u, v), one);
        let hit = _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(hit, zero, t);
        let hit = _mm512_mask_cmp_ps_mask::<_CMP_LT_OQ>(hit, t, _mm512_set1_ps(input.t_max));
        store16(_mm512_mask_blend_ps(hit, _mm512_set1_ps(f32::INFINITY), t), out);
    }
}

fn wide(input: &Input, out: &mut Output) {
    use wide_type::{F, LANES, load, store};
    let (origin, direction) = (input.origin.map(F::splat), input.direction.map(F::splat));
    for i in 0..N / LANES {
        let at = |floats: &Floats<N>| load(&floats.0, i);
        let of = |vectors: &[Floats<N>; 3]| [at(&vectors[0]), at(&vectors[1]), at(&vectors[2])];
        let [e1, e2] = [of(&input.edges[0]), of(&input.edges[1])];
        let corner = of(&input.corner);
        let p = cross!(direction, e2);
        let inverse = F::splat(1.0) / dot!(e1, p);
        let s = [origin[0] - corner[0], origin[1] - corner[1], origin[2] - corner[2]];
        let u = dot!(s, p) * inverse;
        let q = cross!(s, e1);
        let v = dot!(direction, q) * inverse;
        let t = dot!(e2, q) * inverse;
        let zero = F::splat(0.0);
        let inside = u.simd_ge(zero) & v.simd_ge(zero) & (u + v).simd_le(F::splat(1.0));
        let hit = inside & t.simd_gt(zero) & t.simd_lt(F::splat(input.t_max));
        store(hit.select(t, F::splat(f32::INFINITY)), &mut out.0, i);
    }
}

struct Pulp<'a>(&'a Input, &'a mut Output);

impl pulp::WithSimd for Pulp<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, s: S) {
        let Self(input, out) = self;
        let (zero, one) = (s.splat_f32s(0.0), s.splat_f32s(1.0));
        let splat = |v: [f32; 3]| [s.splat_f32s(v[0]), s.splat_f32s(v[1]), s.splat_f32s(v[2])];
        let (origin, direction) = (splat(input.origin), splat(input.direction));
        for (i, out) in S::as_mut_simd_f32s(&mut out.0).0.iter_mut().enumerate() {
            let at = |floats: &Floats<N>| S::as_simd_f32s(&floats.0).0[i];
            let of = |vectors: &[Floats<N>; 3]| [at(&vectors[0]), at(&vectors[1]), at(&vectors[2])];
            let [e1, e2] = [of(&input.edges[0]), of(&input.edges[1])];
            let corner = of(&input.corner);
            let p = cross!([s.mul_f32s], [s.sub_f32s], direction, e2);
            let inverse = s.div_f32s(one, dot!([s.mul_f32s], [s.add_f32s], e1, p));
            let to = |k: usize| s.sub_f32s(origin[k], corner[k]);
            let to = [to(0), to(1), to(2)];
            let u = s.mul_f32s(dot!([s.mul_f32s], [s.add_f32s], to, p), inverse);
            let q = cross!([s.mul_f32s], [s.sub_f32s], to, e1);
            let v = s.mul_f32s(dot!([s.mul_f32s], [s.add_f32s], direction, q), inverse);
            let t = s.mul_f32s(dot!([s.mul_f32s], [s.add_f32s], e2, q), inverse);
            let inside = s.and_m32s(s.greater_than_or_equal_f32s(u, zero), s.greater_than_or_equal_f32s(v, zero));
            let inside = s.and_m32s(inside, s.less_than_or_equal_f32s(s.add_f32s(u, v), one));
            let near = s.less_than_f32s(t, s.splat_f32s(input.t_max));
            let hit = s.and_m32s(inside, s.and_m32s(s.greater_than_f32s(t, zero), near));
            *out = s.select_f32s(hit, t, s.splat_f32s(f32::INFINITY));
        }
    }
}

#[inline(always)]
fn fearless<S: fearless_simd::Simd>(simd: S, input: &Input, out: &mut Output) {
    use fearless_simd::prelude::*;
    let lanes = S::f32s::LEN;
    let splat = |v: [f32; 3]| [S::f32s::splat(simd, v[0]), S::f32s::splat(simd, v[1]), S::f32s::splat(simd, v[2])];
    let (origin, direction) = (splat(input.origin), splat(input.direction));
    for i in 0..N / lanes {
        let at = |floats: &Floats<N>| S::f32s::from_slice(simd, &floats.0[i * lanes..][..lanes]);
        let of = |vectors: &[Floats<N>; 3]| [at(&vectors[0]), at(&vectors[1]), at(&vectors[2])];
        let [e1, e2] = [of(&input.edges[0]), of(&input.edges[1])];
        let corner = of(&input.corner);
        let p = cross!(direction, e2);
        let inverse = S::f32s::splat(simd, 1.0) / dot!(e1, p);
        let s = [origin[0] - corner[0], origin[1] - corner[1], origin[2] - corner[2]];
        let u = dot!(s, p) * inverse;
        let q = cross!(s, e1);
        let v = dot!(direction, q) * inverse;
        let t = dot!(e2, q) * inverse;
        let hit = u.simd_ge(0.0) & v.simd_ge(0.0) & (u + v).simd_le(1.0) & t.simd_gt(0.0) & t.simd_lt(input.t_max);
        hit.select(t, S::f32s::splat(simd, f32::INFINITY)).store_slice(&mut out.0[i * lanes..][..lanes]);
    }
}
