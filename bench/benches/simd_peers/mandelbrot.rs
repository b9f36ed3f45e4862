//! 256 x 64 points of the Mandelbrot set, up to 64 iterations: a loop that a vector leaves when its last lane does.

use super::{Contest, Floats, load8, load16, wide_type};
use criterion::Criterion;
use std::arch::x86_64::*;

const WIDTH: usize = 256;
const HEIGHT: usize = 64;
const ITERATIONS: usize = 64;

#[derive(Clone)]
pub struct Input {
    /// Of the columns and of the rows.
    re: Floats<WIDTH>,
    im: Floats<HEIGHT>,
}

pub type Output = super::Aligned<[[i32; WIDTH]; HEIGHT]>;

/// The input, and the output before.
pub fn input() -> (Input, Output) {
    let input = Input {
        re: super::Aligned(std::array::from_fn(|i| i as f32 * (3.0 / WIDTH as f32) - 2.2)),
        im: super::Aligned(std::array::from_fn(|i| i as f32 * (1.2 / HEIGHT as f32))),
    };
    (input, super::Aligned([[0; WIDTH]; HEIGHT]))
}

pub fn contest(criterion: &mut Criterion) {
    let (input, blank) = input();
    let mut expected = Box::new(blank);
    plain(&input, &mut expected);

    let check = move |_: &Input, out: &Output| *out == *expected;
    let mut contest = Contest::new(criterion, "mandelbrot", WIDTH * HEIGHT, (input, blank), check);
    contest.simd(with_simd);
    contest.intrinsics(avx2, avx512);
    contest.wide(wide);
    contest.pulp(|arch, i, o| arch.dispatch(Pulp(i, o)));
    contest.fearless(|level, i, o| fearless_simd::dispatch!(level, simd => fearless(simd, i, o)));
    contest.plain(plain);
}

#[inline(always)]
fn plain(input: &Input, out: &mut Output) {
    for (out, &im) in out.0.iter_mut().zip(&input.im.0) {
        for (out, &re) in out.iter_mut().zip(&input.re.0) {
            let (mut x, mut y, mut count) = (re, im, 0);
            for _ in 0..ITERATIONS {
                let (xx, yy) = (x * x, y * y);
                if xx + yy > 4.0 {
                    break;
                }
                count += 1;
                y = (x + x) * y + im;
                x = xx - yy + re;
            }
            *out = count;
        }
    }
}

simd::kernel! {
    pub fn with_simd<S>(input: &Input, out: &mut Output) {
        iterate::<S::Float>(input, out);
    }
}

#[inline(always)]
fn iterate<F: simd::Float>(input: &Input, out: &mut Output) {
    use simd::{Mask, Vector};
    for (out, &im) in out.0.iter_mut().zip(&input.im.0) {
        let im = F::splat(im);
        for i in 0..WIDTH / F::LANES {
            let re = F::load(&input.re.0[i * F::LANES..]);
            let (mut x, mut y, mut count) = (re, im, F::Int::splat(0));
            let mut inside = F::Mask::splat(true);
            for _ in 0..ITERATIONS {
                let (xx, yy) = (x * x, y * y);
                inside &= (xx + yy).le(F::splat(4.0));
                if inside.none() {
                    break;
                }
                count = F::Int::select(inside, count + F::Int::splat(1), count);
                y = (x + x) * y + im;
                x = xx - yy + re;
            }
            count.store(&mut out[i * F::LANES..]);
        }
    }
}

#[target_feature(enable = "avx2")]
fn avx2(input: &Input, out: &mut Output) {
    let four = _mm256_set1_ps(4.0);
    for (out, &im) in out.0.iter_mut().zip(&input.im.0) {
        let im = _mm256_set1_ps(im);
        for (out, re) in out.as_chunks_mut::<8>().0.iter_mut().zip(input.re.0.as_chunks::<8>().0) {
            let re = load8(re);
            let (mut x, mut y, mut count) = (re, im, _mm256_setzero_si256());
            let mut inside = _mm256_castsi256_ps(_mm256_set1_epi32(-1));
            for _ in 0..ITERATIONS {
                let (xx, yy) = (_mm256_mul_ps(x, x), _mm256_mul_ps(y, y));
                inside = _mm256_and_ps(inside, _mm256_cmp_ps::<_CMP_LE_OQ>(_mm256_add_ps(xx, yy), four));
                if _mm256_movemask_ps(inside) == 0 {
                    break;
                }
                // A mask that is on is -1.
                count = _mm256_sub_epi32(count, _mm256_castps_si256(inside));
                y = _mm256_add_ps(_mm256_mul_ps(_mm256_add_ps(x, x), y), im);
                x = _mm256_add_ps(_mm256_sub_ps(xx, yy), re);
            }
            // SAFETY: eight integers to write.
            unsafe { _mm256_storeu_si256(out.as_mut_ptr().cast(), count) };
        }
    }
}

#[target_feature(enable = "avx512f")]
fn avx512(input: &Input, out: &mut Output) {
    let (four, one) = (_mm512_set1_ps(4.0), _mm512_set1_epi32(1));
    for (out, &im) in out.0.iter_mut().zip(&input.im.0) {
        let im = _mm512_set1_ps(im);
        for (out, re) in out.as_chunks_mut::<16>().0.iter_mut().zip(input.re.0.as_chunks::<16>().0) {
            let re = load16(re);
            let (mut x, mut y, mut count) = (re, im, _mm512_setzero_si512());
            let mut inside = 0xffff;
            for _ in 0..ITERATIONS {
                let (xx, yy) = (_mm512_mul_ps(x, x), _mm512_mul_ps(y, y));
                inside = _mm512_mask_cmp_ps_mask::<_CMP_LE_OQ>(inside, _mm512_add_ps(xx, yy), four);
                if inside == 0 {
                    break;
                }
                count = _mm512_mask_add_epi32(count, inside, count, one);
                y = _mm512_add_ps(_mm512_mul_ps(_mm512_add_ps(x, x), y), im);
                x = _mm512_add_ps(_mm512_sub_ps(xx, yy), re);
            }
            // SAFETY: sixteen integers to write.
            unsafe { _mm512_storeu_si512(out.as_mut_ptr().cast(), count) };
        }
    }
}

fn wide(input: &Input, out: &mut Output) {
    use wide_type::{F, LANES, load};
    let one = F::splat(1.0);
    for (out, &im) in out.0.iter_mut().zip(&input.im.0) {
        let im = F::splat(im);
        for (i, out) in out.as_chunks_mut::<LANES>().0.iter_mut().enumerate() {
            let re = load(&input.re.0, i);
            // Counted as floats: masks are floats.
            let (mut x, mut y, mut count) = (re, im, F::splat(0.0));
            let mut inside = x.simd_eq(x);
            for _ in 0..ITERATIONS {
                let (xx, yy) = (x * x, y * y);
                inside &= (xx + yy).simd_le(F::splat(4.0));
                if inside.none() {
                    break;
                }
                count += inside & one;
                y = (x + x) * y + im;
                x = xx - yy + re;
            }
            *out = count.fast_trunc_int().to_array();
        }
    }
}

struct Pulp<'a>(&'a Input, &'a mut Output);

impl pulp::WithSimd for Pulp<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, s: S) {
        let Self(input, out) = self;
        let (one, four) = (s.splat_i32s(1), s.splat_f32s(4.0));
        for (out, &im) in out.0.iter_mut().zip(&input.im.0) {
            let im = s.splat_f32s(im);
            let res = S::as_simd_f32s(&input.re.0).0;
            for (out, &re) in S::as_mut_simd_i32s(out).0.iter_mut().zip(res) {
                let (mut x, mut y, mut count) = (re, im, s.splat_i32s(0));
                let mut inside = s.equal_f32s(re, re);
                for _ in 0..ITERATIONS {
                    let (xx, yy) = (s.mul_f32s(x, x), s.mul_f32s(y, y));
                    inside = s.and_m32s(inside, s.less_than_or_equal_f32s(s.add_f32s(xx, yy), four));
                    if s.first_true_m32s(inside) == S::F32_LANES {
                        break;
                    }
                    count = s.select_i32s(inside, s.add_i32s(count, one), count);
                    y = s.add_f32s(s.mul_f32s(s.add_f32s(x, x), y), im);
                    x = s.add_f32s(s.sub_f32s(xx, yy), re);
                }
                *out = count;
            }
        }
    }
}

#[inline(always)]
fn fearless<S: fearless_simd::Simd>(simd: S, input: &Input, out: &mut Output) {
    use fearless_simd::prelude::*;
    let lanes = S::f32s::LEN;
    for (out, &im) in out.0.iter_mut().zip(&input.im.0) {
        let im = S::f32s::splat(simd, im);
        for i in 0..WIDTH / lanes {
            let re = S::f32s::from_slice(simd, &input.re.0[i * lanes..][..lanes]);
            let (mut x, mut y, mut count) = (re, im, S::i32s::splat(simd, 0));
            let mut inside = S::mask32s::splat(simd, true);
            for _ in 0..ITERATIONS {
                let (xx, yy) = (x * x, y * y);
                inside &= (xx + yy).simd_le(4.0);
                if inside.all_false() {
                    break;
                }
                count = inside.select(count + 1, count);
                y = (x + x) * y + im;
                x = xx - yy + re;
            }
            count.store_slice(&mut out[i * lanes..][..lanes]);
        }
    }
}
