//! Angles, in radians.

use super::{Double, nearest_integer, polynomial};
use crate::{Block, Float, Int, Mask, Vector};
use core::f32::consts::{FRAC_2_PI, FRAC_PI_2};

/// Sine. Lanes beyond ±2^17 are no less accurate, but reduced one by one.
///
/// | `x` | result |
/// |---|---|
/// | ±0, denormal | `x` |
/// | ±∞, NaN | NaN |
#[inline(always)]
pub fn sin<F: Float>(x: F) -> F {
    sin_cos(x).0
}

/// Cosine. Lanes beyond ±2^17 are no less accurate, but reduced one by one.
///
/// | `x` | result |
/// |---|---|
/// | ±0, denormal | 1 |
/// | ±∞, NaN | NaN |
#[inline(always)]
pub fn cos<F: Float>(x: F) -> F {
    sin_cos(x).1
}

/// [`sin`] and [`cos`], the same bits as theirs, for little more than the price of one.
#[inline(always)]
pub fn sin_cos<F: Float>(x: F) -> (F, F) {
    let (n, r) = reduced(x);
    let (sin, cos) = sin_cos_of_reduced(r);
    let one = F::Index::splat(1);
    let odd = (n & one).eq(one);
    // Bit 1 of n, and of n + 1, as sign bits.
    let (sin_sign, cos_sign) = (F::from_bits(n << 30), F::from_bits((n + one) << 30));
    let cosine = F::select(odd, sin.hi, cos.hi).mul_sign(cos_sign);
    let sine = F::select(odd, cos.hi, sin.hi).mul_sign(sin_sign);
    (keep_zero(x, sine), cosine)
}

/// Tangent. Lanes beyond ±2^17 are no less accurate, but reduced one by one.
///
/// | `x` | result |
/// |---|---|
/// | ±0, denormal | `x` |
/// | ±∞, NaN | NaN |
#[inline(always)]
pub fn tan<F: Float>(x: F) -> F {
    let (n, r) = reduced(x);
    let (sin, cos) = sin_cos_of_reduced(r);
    let one = F::Index::splat(1);
    let odd = (n & one).eq(one);
    let tangent = Double::select(odd, cos, sin).over(Double::select(odd, sin, cos));
    // The sign bit of odd ones: -cos / sin.
    keep_zero(x, (tangent.hi + tangent.lo).mul_sign(F::from_bits(n << 31)))
}

/// Arc sine, between -π/2 and π/2.
///
/// | `x` | result |
/// |---|---|
/// | ±0, denormal | `x` |
/// | ±1 | ±π/2, rounded |
/// | beyond ±1, NaN | NaN |
#[inline(always)]
pub fn asin<F: Float>(x: F) -> F {
    let (small, arc) = small_arc_sine(x.abs());
    let turns = F::select(small, F::splat(0.0), F::splat(2.0));
    let factor = F::select(small, F::splat(1.0), F::splat(-2.0));
    angle(turns, factor, arc).mul_sign(x)
}

/// Arc cosine, between 0 and π.
///
/// | `x` | result |
/// |---|---|
/// | 1 | 0 |
/// | ±0 | π/2, rounded |
/// | -1 | π, rounded |
/// | beyond ±1, NaN | NaN |
#[inline(always)]
pub fn acos<F: Float>(x: F) -> F {
    let (small, arc) = small_arc_sine(x.abs());
    let of_large = F::select(x.lt(F::splat(0.0)), F::splat(4.0), F::splat(0.0));
    let turns = F::select(small, F::splat(2.0), of_large);
    let factor = F::select(small, F::splat(-1.0), F::splat(2.0)).mul_sign(x);
    angle(turns, factor, arc)
}

/// Arc tangent, between -π/2 and π/2.
///
/// | `x` | result |
/// |---|---|
/// | ±0, denormal | `x` |
/// | ±∞ | ±π/2, rounded |
/// | NaN | NaN |
#[inline(always)]
pub fn atan<F: Float>(x: F) -> F {
    arc_tangent(x.abs(), F::splat(1.0), F::Mask::splat(false)).mul_sign(x)
}

/// The angle of the point (`x`, `y`), between -π and π, with the sign of `y` also when that is -0. Note the order.
///
/// | `y` | `x` | result |
/// |---|---|---|
/// | ±0 | positive, 0, ∞ | ±0 |
/// | ±0 | negative, -0, -∞ | ±π, rounded |
/// | positive (negative) | ±0 | π/2 (-π/2), rounded |
/// | ±∞ | finite | ±π/2, rounded |
/// | ±finite | ∞ (-∞) | ±0 (±π) |
/// | ±∞ | ∞ (-∞) | ±π/4 (±3π/4), rounded |
/// | NaN in either | | NaN |
///
/// Quotients that are denormal, or nearly 0 or infinite, are as accurate as others.
#[inline(always)]
pub fn atan2<F: Float>(y: F, x: F) -> F {
    // By a power of 2, so that the larger one is neither so small that remainders underflow nor so large that the sum overflows:
    // what the smaller one loses then is below all results.
    let (a, b) = (y.abs(), x.abs());
    let larger = a.max(b);
    let scale = F::select(larger.gt(F::splat(1.0e30)), F::splat(1.0 / 4_294_967_296.0), F::splat(1.0));
    let scale = F::select(larger.lt(F::splat(1.0e-18)), F::splat(18_446_744_073_709_551_616.0), scale);
    let sign = F::Index::splat(1 << 31);
    arc_tangent(a * scale, b * scale, (x.to_bits() & sign).eq(sign)).mul_sign(y)
}

/// `x` where it is a zero, whose sign has been lost.
#[inline(always)]
fn keep_zero<F: Float>(x: F, result: F) -> F {
    F::select(x.eq(F::splat(0.0)), x, result)
}

/// n modulo 4, its higher bits arbitrary, and r: `x` = n π/2 + r, |r| < 0.8. All of r's bits count, also where it nearly
/// vanishes. NaN of ±∞ and NaN.
#[inline(always)]
fn reduced<F: Float>(x: F) -> (F::Index, Double<F>) {
    let (n, rounded) = nearest_integer(x * F::splat(FRAC_2_PI));
    // π/2 in three floats. The first difference is exact, the products with the first two are too.
    let first = exact_product(rounded, FRAC_PI_2);
    let r = Double::sum(x - first.hi, -first.lo);
    let second = exact_product(rounded, -4.371_139e-8);
    let difference = Double::sum(r.hi, -second.hi);
    let rest = (r.lo - second.lo) - rounded * F::splat(-1.715_124_5e-15);
    let mut r = Double::sum(difference.hi, difference.lo + rest);

    let mut n = n.to_uint();
    let large = x.abs().gt(F::splat(LARGE));
    if large.any() {
        let (mut quadrants, mut his, mut los) = (n.to_block(), r.hi.to_block(), r.lo.to_block());
        reduce_large(&x.to_block(), large.bitmask(), &mut quadrants, &mut his, &mut los);
        n = F::Index::load_block(&quadrants, 0);
        r = Double { hi: F::load_block(&his, 0), lo: F::load_block(&los, 0) };
    }
    (n, r)
}

/// `a * b` exactly, where nothing over- or underflows: with the level's fused operation the same bits as without.
#[inline(always)]
fn exact_product<F: Float>(a: F, b: f32) -> Double<F> {
    let b = F::splat(b);
    let hi = a * b;
    Double { hi, lo: a.product_error(b, hi) }
}

/// Up to here `x` 2/π has fraction bits enough to find the nearest integer, almost: to keep |r| below 0.8.
const LARGE: f32 = 131_072.0;

/// The same for some lanes, all of them beyond [`LARGE`], with as many bits of 2/π as it takes (M. H. Payne and R. N. Hanek,
/// "Radian reduction for trigonometric functions", 1983).
#[cold]
fn reduce_large(x: &Block<f32>, lanes: u32, n: &mut Block<u32>, hi: &mut Block<f32>, lo: &mut Block<f32>) {
    /// 2/π * 2^248: bit 255 stands for 2^7.
    const TWO_OVER_PI: [u128; 2] =
        [0x00a2_f983_6e4e_4415_29fc_2757_d1f5_34dd, 0xc0db_6295_993c_4390_41fe_5163_abde_bbc5];

    for i in (0..16).filter(|i| lanes >> i & 1 == 1) {
        let x = x.0[i];
        if !x.is_finite() {
            hi.0[i] = f32::NAN;
            continue;
        }
        // |x| = m * 2^e. Bits of 2/π that make multiples of 4 are shifted out: the window's highest bit stands for 2^(1 - e).
        let e = (x.to_bits() >> 23 & 0xff) as i32 - 150;
        let m = u128::from(x.to_bits() & 0x7f_ffff | 0x80_0000);
        let shift = (e + 6) as u32;
        let window = TWO_OVER_PI[0] << shift | (TWO_OVER_PI[1] >> 1) >> (127 - shift);
        // x 2/π modulo 4, in units of 2^-126; its nearest integer, and what remains in units of 2^-64.
        let product = m.wrapping_mul(window);
        let quadrant = (product.wrapping_add(1 << 125) >> 126) as u32;
        let fraction = (product << 2 >> 64) as i64;
        let r = fraction as f64 * (core::f64::consts::FRAC_PI_2 / 18_446_744_073_709_551_616.0);
        let (quadrant, r) = if x < 0.0 { (quadrant.wrapping_neg(), -r) } else { (quadrant, r) };
        n.0[i] = quadrant;
        hi.0[i] = r as f32;
        lo.0[i] = (r - f64::from(hi.0[i])) as f32;
    }
}

/// Sine and cosine for |r| < 0.8.
#[inline(always)]
fn sin_cos_of_reduced<F: Float>(r: Double<F>) -> (Double<F>, Double<F>) {
    let z = r.hi * r.hi;
    // (sin r - r) / r^3 and (cos r - 1 + r^2 / 2) / r^4: minimax, relative error of the sine below 2^-27.8.
    let q = polynomial(z, [-0.166_666_54, 0.008_332_098, -0.000_195_060_23]);
    let sin = Double::sum(r.hi, r.lo + r.hi * z * q);
    let q = polynomial(z, [0.041_666_646, -0.001_388_729_1, 2.442_864_4e-5]);
    let cos = Double::sum(F::splat(1.0), F::splat(-0.5) * z);
    (sin, Double::sum(cos.hi, cos.lo + (z * z * q - r.hi * r.lo)))
}

/// Whether `x` <= 1/2; the arc sine of `x` if so, else that of sqrt((1 - x) / 2), half the arc cosine of `x`. For x >= 0.
#[inline(always)]
fn small_arc_sine<F: Float>(x: F) -> (F::Mask, Double<F>) {
    let half = F::splat(0.5);
    let large = x.gt(half);
    let z = F::select(large, (F::splat(1.0) - x) * half, x * x);
    let root = z.sqrt();
    let square = Double::product(root, root);
    // The divisor is not 0 where the root is.
    let rest = ((z - square.hi) - square.lo) / (root + root).max(F::splat(f32::MIN_POSITIVE));
    let s = Double { hi: F::select(large, root, x), lo: F::select(large, rest, F::splat(0.0)) };
    // (asin s - s) / s^3: minimax, relative error of the result below 2^-27.5.
    let q = polynomial(z, [0.166_667_54, 0.074_952_52, 0.045_476_04, 0.024_152_09, 0.042_211_805]);
    (!large, Double { hi: s.hi, lo: s.lo + s.hi * z * q })
}

/// Arc tangent of `y / x`, for both >= 0; π less that where `mirrored`.
#[inline(always)]
fn arc_tangent<F: Float>(y: F, x: F, mirrored: F::Mask) -> F {
    let (zero, one) = (F::splat(0.0), F::splat(1.0));
    let swapped = y.gt(x);
    let (a, b) = (F::select(swapped, x, y), F::select(swapped, y, x));

    // a <= b. Above tan(π/8), atan(a / b) = π/4 + atan((a - b) / (a + b)). Infinities are equal.
    let turned = a.gt(b * F::splat(0.414_213_57)) | a.eq(F::splat(f32::INFINITY));
    let (difference, sum) = (Double::sum(-b, a), Double::sum(b, a));
    let numerator = Double::select(turned, difference, Double { hi: a, lo: zero });
    let t = numerator.over(Double::select(turned, sum, Double { hi: b, lo: zero }));
    // 0 / 0 and ∞ / ∞ leave no more than what the turn says.
    let hi = F::select(a.eq(b), zero, t.hi);
    // Where that is tiny, remainders have underflowed, and it is the result.
    let lo = F::select(hi.abs().gt(F::splat(1.0e-12)), t.lo, zero);
    // (atan t - t) / t^3: minimax, relative error of the result below 2^-30.
    let z = hi * hi;
    let q = polynomial(z, [-0.333_333_16, 0.199_985_33, -0.142_445_1, 0.106_001_66, -0.060_927_12]);
    let arc = Double { hi, lo: lo + hi * z * q };

    let turns = F::select(turned, one, zero);
    let (turns, factor) = (F::select(swapped, F::splat(2.0) - turns, turns), F::select(swapped, -one, one));
    let (turns, factor) = (F::select(mirrored, F::splat(4.0) - turns, turns), F::select(mirrored, -factor, factor));
    angle(turns, factor, arc)
}

/// `turns` π/4 + `factor` `arc`, for `turns` an integer between 0 and 4, `factor` a power of two, and no large `arc`.
#[inline(always)]
fn angle<F: Float>(turns: F, factor: F, arc: Double<F>) -> F {
    // π/4 in two floats, the lowest bits of the first 0: its multiples are exact.
    let (hi, lo) = (F::splat(f32::from_bits(0x3f49_0fd8)), F::splat(1.569_582_4e-7));
    let sum = Double::sum(turns * hi, factor * arc.hi);
    sum.hi + (sum.lo + (turns * lo + factor * arc.lo))
}
