//! Sine and cosine of 4096 numbers. The contestants differ: `simd` and the intrinsics are within one unit of the last place or
//! so, `wide` is not; `plain` is the standard library, one by one. All are within 2e-6.

use super::{Contest, Floats, load8, load16, noise, store8, store16, wide_type};
use criterion::Criterion;
use std::arch::x86_64::*;
use std::f32::consts::{FRAC_2_PI, FRAC_PI_2};

const N: usize = 4096;

pub type Input = Floats<N>;

#[derive(Clone)]
pub struct Output {
    sin: Floats<N>,
    cos: Floats<N>,
}

/// The input, and the output before.
pub fn input() -> (Input, Output) {
    (
        super::Aligned(std::array::from_fn(|i| noise(i) * 200.0 - 100.0)),
        Output { sin: super::Aligned([0.0; N]), cos: super::Aligned([0.0; N]) },
    )
}

pub fn contest(criterion: &mut Criterion) {
    let (input, blank) = input();
    let mut contest = Contest::new(criterion, "sin_cos", N, (input, blank), right);
    contest.simd(with_simd);
    contest.intrinsics(avx2, avx512);
    contest.wide(wide);
    contest.plain(plain);
}

fn right(input: &Input, out: &Output) -> bool {
    let mut numbers = input.0.iter().zip(out.sin.0.iter().zip(&out.cos.0));
    numbers.all(|(&x, (&sin, &cos))| {
        let exact = f64::from(x).sin_cos();
        (f64::from(sin) - exact.0).abs().max((f64::from(cos) - exact.1).abs()) < 2e-6
    })
}

#[inline(always)]
fn plain(input: &Input, out: &mut Output) {
    for ((x, sin), cos) in input.0.iter().zip(&mut out.sin.0).zip(&mut out.cos.0) {
        (*sin, *cos) = x.sin_cos();
    }
}

simd::kernel! {
    pub fn with_simd<S>(input: &Input, out: &mut Output) {
        use simd::Vector;
        let lanes = S::Float::LANES;
        for i in 0..N / lanes {
            let (sin, cos) = simd::math::sin_cos(S::Float::load(&input.0[i * lanes..]));
            sin.store(&mut out.sin.0[i * lanes..]);
            cos.store(&mut out.cos.0[i * lanes..]);
        }
    }
}

/// Beyond this, the reduction needs more bits of 2/π.
const LARGE: f32 = 131_072.0;

/// As the standard library has it.
#[cold]
fn one_by_one(x: &[f32], sin: &mut [f32], cos: &mut [f32]) {
    for ((x, sin), cos) in x.iter().zip(sin).zip(cos) {
        (*sin, *cos) = x.sin_cos();
    }
}

/// A register as slices of the input and the outputs.
macro_rules! registers {
    ($input:ident, $out:ident, $lanes:literal) => {{
        let (sin, cos) = ($out.sin.0.as_chunks_mut::<$lanes>().0, $out.cos.0.as_chunks_mut::<$lanes>().0);
        $input.0.as_chunks::<$lanes>().0.iter().zip(sin).zip(cos)
    }};
}

/// The algorithm of `simd::math`, and its bits; products are exact thanks to FMA.
#[target_feature(enable = "avx2,fma")]
fn avx2(input: &Input, out: &mut Output) {
    let set = |x: f32| _mm256_set1_ps(x);
    let (mul, add, sub) = (|a, b| _mm256_mul_ps(a, b), |a, b| _mm256_add_ps(a, b), |a, b| _mm256_sub_ps(a, b));
    let (sign, magic) = (_mm256_set1_epi32(i32::MIN), set(12_582_912.0));
    // A product or a sum, and what rounding lost.
    let product = |a, b| (mul(a, b), _mm256_fmsub_ps(a, b, mul(a, b)));
    let sum = |a, b| (add(a, b), sub(b, sub(add(a, b), a)));
    for ((from, to_sin), to_cos) in registers!(input, out, 8) {
        let x = load8(from);
        if _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LT_OQ>(set(LARGE), _mm256_andnot_ps(set(-0.0), x))) != 0 {
            one_by_one(from, to_sin, to_cos);
            continue;
        }
        // x = n π/2 + r, the π/2 in three parts.
        let shifted = add(mul(x, set(FRAC_2_PI)), magic);
        let n = _mm256_sub_epi32(_mm256_castps_si256(shifted), _mm256_castps_si256(magic));
        let rounded = sub(shifted, magic);
        let first = product(rounded, set(FRAC_PI_2));
        let second = product(rounded, set(-4.371_139e-8));
        let zero = _mm256_setzero_ps();
        let difference = sum(sub(x, first.0), sub(zero, first.1));
        let rest = sub(sub(difference.1, second.1), mul(rounded, set(-1.715_124_5e-15)));
        let difference = sum(difference.0, sub(zero, second.0));
        let (r, rest) = sum(difference.0, add(difference.1, rest));

        let z = mul(r, r);
        let q = add(mul(add(mul(set(-0.000_195_060_23), z), set(0.008_332_098)), z), set(-0.166_666_54));
        let sin = add(r, add(rest, mul(mul(r, z), q)));
        let q = add(mul(add(mul(set(2.442_864_4e-5), z), set(-0.001_388_729_1)), z), set(0.041_666_646));
        let (cos, lost) = sum(set(1.0), mul(set(-0.5), z));
        let cos = add(cos, add(lost, sub(mul(mul(z, z), q), mul(r, rest))));

        // A blend looks at the sign bit.
        let odd = _mm256_castsi256_ps(_mm256_slli_epi32::<31>(n));
        let flip = |x, n| {
            let flipped = _mm256_and_si256(_mm256_slli_epi32::<30>(n), sign);
            _mm256_xor_ps(x, _mm256_castsi256_ps(flipped))
        };
        let cosine = flip(_mm256_blendv_ps(cos, sin, odd), _mm256_add_epi32(n, _mm256_set1_epi32(1)));
        let sine = flip(_mm256_blendv_ps(sin, cos, odd), n);
        // -0 would lose its sign.
        let sine = _mm256_blendv_ps(sine, x, _mm256_cmp_ps::<_CMP_EQ_OQ>(x, zero));
        store8(sine, to_sin);
        store8(cosine, to_cos);
    }
}

/// The algorithm of `simd::math`, and its bits; products are exact thanks to FMA.
#[target_feature(enable = "avx512f,avx512dq")]
fn avx512(input: &Input, out: &mut Output) {
    let set = |x: f32| _mm512_set1_ps(x);
    let (mul, add, sub) = (|a, b| _mm512_mul_ps(a, b), |a, b| _mm512_add_ps(a, b), |a, b| _mm512_sub_ps(a, b));
    let (sign, magic) = (_mm512_set1_epi32(i32::MIN), set(12_582_912.0));
    // A product or a sum, and what rounding lost.
    let product = |a, b| (mul(a, b), _mm512_fmsub_ps(a, b, mul(a, b)));
    let sum = |a, b| (add(a, b), sub(b, sub(add(a, b), a)));
    for ((from, to_sin), to_cos) in registers!(input, out, 16) {
        let x = load16(from);
        if _mm512_cmp_ps_mask::<_CMP_LT_OQ>(set(LARGE), _mm512_abs_ps(x)) != 0 {
            one_by_one(from, to_sin, to_cos);
            continue;
        }
        // x = n π/2 + r, the π/2 in three parts.
        let shifted = add(mul(x, set(FRAC_2_PI)), magic);
        let n = _mm512_sub_epi32(_mm512_castps_si512(shifted), _mm512_castps_si512(magic));
        let rounded = sub(shifted, magic);
        let first = product(rounded, set(FRAC_PI_2));
        let second = product(rounded, set(-4.371_139e-8));
        let zero = _mm512_setzero_ps();
        let difference = sum(sub(x, first.0), sub(zero, first.1));
        let rest = sub(sub(difference.1, second.1), mul(rounded, set(-1.715_124_5e-15)));
        let difference = sum(difference.0, sub(zero, second.0));
        let (r, rest) = sum(difference.0, add(difference.1, rest));

        let z = mul(r, r);
        let q = add(mul(add(mul(set(-0.000_195_060_23), z), set(0.008_332_098)), z), set(-0.166_666_54));
        let sin = add(r, add(rest, mul(mul(r, z), q)));
        let q = add(mul(add(mul(set(2.442_864_4e-5), z), set(-0.001_388_729_1)), z), set(0.041_666_646));
        let (cos, lost) = sum(set(1.0), mul(set(-0.5), z));
        let cos = add(cos, add(lost, sub(mul(mul(z, z), q), mul(r, rest))));

        let one = _mm512_set1_epi32(1);
        let odd = _mm512_test_epi32_mask(n, one);
        // x ^ (sign of n << 30).
        let flip = |x, n| {
            let (x, n) = (_mm512_castps_si512(x), _mm512_slli_epi32::<30>(n));
            _mm512_castsi512_ps(_mm512_ternarylogic_epi32::<0x78>(x, n, sign))
        };
        let cosine = flip(_mm512_mask_blend_ps(odd, cos, sin), _mm512_add_epi32(n, one));
        let sine = flip(_mm512_mask_blend_ps(odd, sin, cos), n);
        // -0 would lose its sign.
        let sine = _mm512_mask_blend_ps(_mm512_cmp_ps_mask::<_CMP_EQ_OQ>(x, zero), sine, x);
        store16(sine, to_sin);
        store16(cosine, to_cos);
    }
}

fn wide(input: &Input, out: &mut Output) {
    use wide_type::{LANES, load, store};
    for i in 0..N / LANES {
        let (sin, cos) = load(&input.0, i).sin_cos();
        store(sin, &mut out.sin.0, i);
        store(cos, &mut out.cos.0, i);
    }
}
