//! `f64`: every operation bit for bit against plain Rust, on special values crossed with each other and on random ones.

use crate::values::Random;
use simd::{Double, Float, Isa, Level, Vector};

/// The results for two arguments, in the order of [`expected`].
#[inline(always)]
fn results_of<D: Double, F: Float>(a: &[f64], b: &[f64], out: &mut Vec<f64>) {
    let (a, b) = (D::load(a), D::load(b));
    let truth = |mask: D::Mask| D::select(mask, D::splat(1.0), D::default());
    let ints: F::Int = a.to_int();
    let floats: F = a.to_float();
    let mut sum = a;
    sum += b;
    let results = [
        sum,
        a - b,
        a * b,
        a / b,
        -a,
        a.abs(),
        a.copysign(b),
        a.sqrt(),
        a.floor(),
        a.ceil(),
        a.trunc(),
        a.round(),
        a.min(b),
        a.max(b),
        a.min_num(b),
        a.max_num(b),
        a.clamp(b, D::splat(2.0)),
        a.fract(),
        truth(a.eq(b)),
        truth(a.ne(b)),
        truth(a.lt(b)),
        truth(a.le(b)),
        truth(a.gt(b)),
        truth(a.ge(b)),
        D::from_int(ints),
        D::from_float(floats),
        a.reverse(),
        a.interleave(b).0,
        a.deinterleave(b).1,
        a.compress(a.lt(b)),
        D::splat(a.reduce_add()),
        D::splat(a.reduce_mul()),
        D::splat(a.reduce_min()),
        D::splat(a.min_index(b.ge(b)).map_or(-1.0, |lane| lane as f64)),
        D::gather(&[1.5, 2.5, 3.5], D::Index::from_fn(|i| (i % 3) as u32)),
        a.mul_add_exact(b, a),
        a.mul_add_exact(b, -(a * b)),
    ];
    for result in results {
        out.extend_from_slice(&result.to_block().0[..D::LANES]);
    }
}

/// Of one lane: the integer arithmetic that a test beside it compares with the standard library. That is not taken here, for the C
/// library behind it rounds twice on some targets (MinGW, emulators).
fn fused(a: f64, b: f64, c: f64) -> f64 {
    Double::mul_add_exact(a, b, c)
}

/// The same of numbers.
fn expected(a: &[f64], b: &[f64], out: &mut Vec<f64>) {
    let n = a.len();
    let truth = |x: bool| if x { 1.0 } else { 0.0 };
    let tree = |f: fn(f64, f64) -> f64| {
        let mut x = a.to_vec();
        while x.len() > 1 {
            let half = x.len() / 2;
            x = (0..half).map(|i| f(x[i], x[i + half])).collect();
        }
        x[0]
    };
    let max = |a: f64, b: f64| if a > b { a } else { b };
    let min = |a: f64, b: f64| if a < b { a } else { b };
    let smaller: Vec<f64> = (0..n).filter(|&i| a[i] < b[i]).map(|i| a[i]).collect();
    let least = (0..n)
        .filter(|&i| !b[i].is_nan() && !a[i].is_nan())
        .reduce(|best, i| if a[i] < a[best] { i } else { best })
        .map_or(-1.0, |lane| lane as f64);
    let functions: [&dyn Fn(usize) -> f64; 37] = [
        &|i| a[i] + b[i],
        &|i| a[i] - b[i],
        &|i| a[i] * b[i],
        &|i| a[i] / b[i],
        &|i| -a[i],
        &|i| a[i].abs(),
        &|i| a[i].copysign(b[i]),
        &|i| a[i].sqrt(),
        &|i| a[i].floor(),
        &|i| a[i].ceil(),
        &|i| a[i].trunc(),
        &|i| a[i].round_ties_even(),
        &|i| min(a[i], b[i]),
        &|i| max(a[i], b[i]),
        &|i| if b[i].is_nan() || a[i] < b[i] { a[i] } else { b[i] },
        &|i| if b[i].is_nan() || a[i] > b[i] { a[i] } else { b[i] },
        &|i| min(max(a[i], b[i]), 2.0),
        &|i| a[i] - a[i].floor(),
        &|i| truth(a[i] == b[i]),
        &|i| truth(a[i] != b[i]),
        &|i| truth(a[i] < b[i]),
        &|i| truth(a[i] <= b[i]),
        &|i| truth(a[i] > b[i]),
        &|i| truth(a[i] >= b[i]),
        &|i| f64::from(a[i] as i32),
        &|i| f64::from(a[i] as f32),
        &|i| a[n - 1 - i],
        &|i| if i % 2 == 0 { a[i / 2] } else { b[i / 2] },
        &|i| if 2 * i + 1 < n { a[2 * i + 1] } else { b[2 * i + 1 - n] },
        &|i| smaller.get(i).copied().unwrap_or_default(),
        &|_| tree(|a, b| a + b),
        &|_| tree(|a, b| a * b),
        &|_| tree(min),
        &|_| least,
        &|i| [1.5, 2.5, 3.5][i % 3],
        &|i| fused(a[i], b[i], a[i]),
        &|i| fused(a[i], b[i], -(a[i] * b[i])),
    ];
    for function in functions {
        out.extend((0..n).map(function));
    }
}

simd::kernel! {
    fn results4<S>(a: &[f64], b: &[f64], out: &mut Vec<f64>) {
        results_of::<S::Double4, S::Float4>(a, b, out);
    }
}
simd::kernel! {
    fn results8<S>(a: &[f64], b: &[f64], out: &mut Vec<f64>) {
        results_of::<S::Double8, S::Float8>(a, b, out);
    }
}
/// The relaxed family.
#[inline(always)]
fn relaxed_of<D: Double>(a: &[f64], b: &[f64], c: &[f64], out: &mut Vec<f64>) {
    let (a, b, c) = (D::load(a), D::load(b), D::load(c));
    for result in [a.mul_add(b, c), a.mul_sub(b, c), a.neg_mul_add(b, c), a.neg_mul_sub(b, c)] {
        out.extend_from_slice(&result.to_block().0[..D::LANES]);
    }
}
simd::kernel! {
    fn relaxed<S>(a: &[f64], b: &[f64], c: &[f64], out: &mut Vec<f64>) {
        relaxed_of::<S::Double4>(a, b, c, out);
        relaxed_of::<S::Double8>(a, b, c, out);
    }
}

/// Rounded once where the level has the instruction, else twice.
#[test]
fn relaxed_is_fused_where_it_says() {
    let mut random = Random(10);
    let mut different = 0;
    for _ in 0..1000 {
        let mut numbers = || std::array::from_fn::<f64, 8, _>(|_| f64::from(random.bits() as i32) / 65_537.0);
        let (a, b, c) = (numbers(), numbers(), numbers());
        for level in Level::available() {
            let is_fused = matches!(level.isa(), Isa::Avx2 | Isa::Avx512 | Isa::Neon);
            let mut got = Vec::new();
            relaxed(level, &a, &b, &c, &mut got);
            for (k, &got) in got.iter().enumerate() {
                let (lanes, k) = if k < 16 { (4, k) } else { (8, k - 16) };
                let (i, operation) = (k % lanes, k / lanes);
                let (factor, sum) = ([a[i], a[i], -a[i], -a[i]][operation], [c[i], -c[i], c[i], -c[i]][operation]);
                let (once, twice) = (fused(factor, b[i], sum), factor * b[i] + sum);
                different += usize::from(once != twice);
                let expected = if is_fused { once } else { twice };
                assert!(
                    got == expected,
                    "{level}, {lanes} lanes, operation {operation}: {got:e}, expected {expected:e}"
                );
            }
        }
    }
    assert!(different > 1000, "only {different} numbers tell one rounding from two");
}

simd::kernel! {
    /// Halves of four, two lanes each.
    fn halves<S>(a: &[f64]) -> [f64; 2] {
        use simd::Halves;
        let (low, high) = (S::Double4::load(a).low(), S::Double4::load(a).high());
        let mut out = [0.0; 2];
        (low * high + S::Double2::splat(0.5)).store(&mut out);
        out
    }
}

#[test]
fn operations() {
    let special = [
        0.0,
        -0.0,
        1.0,
        -1.5,
        2.5,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
        5e-324,
        -2.2e-308,
        f64::MAX,
        4_503_599_627_370_497.5,
        -2_147_483_648.7,
        1e-40,
        3.4e38,
        -0.4,
    ];
    let mut random = Random(9);
    let mut number = || match random.bits() % 3 {
        0 => special[random.bits() as usize % special.len()],
        1 => f64::from_bits(u64::from(random.bits()) << 32 | u64::from(random.bits())),
        _ => f64::from(random.bits() as i32) / 65_536.0,
    };
    for round in 0..3000 {
        let [mut a, mut b]: [[f64; 8]; 2] = std::array::from_fn(|_| std::array::from_fn(|_| number()));
        if round < 32 {
            // Each special value with each, eight at a time.
            a = [special[round / 2]; 8];
            b = std::array::from_fn(|i| special[8 * (round % 2) + i]);
        }
        for lanes in [4, 8] {
            let mut correct = Vec::new();
            expected(&a[..lanes], &b[..lanes], &mut correct);
            for level in Level::available() {
                let mut got = Vec::new();
                if lanes == 4 {
                    results4(level, &a, &b, &mut got)
                } else {
                    results8(level, &a, &b, &mut got)
                }
                assert_eq!(got.len(), correct.len());
                for (i, (got, correct)) in got.iter().zip(&correct).enumerate() {
                    let same = got.to_bits() == correct.to_bits() || got.is_nan() && correct.is_nan();
                    assert!(
                        same,
                        "{level}, {lanes} lanes, operation {}, lane {} of {a:?} and {b:?}: got {got:e}, expected {correct:e}",
                        i / lanes,
                        i % lanes
                    );
                }
            }
        }
    }
    for level in Level::available() {
        assert_eq!(halves(level, &[1.0, 2.0, 3.0, 4.0]), [3.5, 8.5], "{level}");
    }
}
