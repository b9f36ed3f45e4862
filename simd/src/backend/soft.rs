//! What `std` has for floats and `core` has not, with the same bits; and the fused multiply-add of levels that lack it.

/// Rounding and square root in integer arithmetic; `$wide` has twice the bits, `$bias` is of the exponent.
#[cfg(any(test, not(feature = "std")))]
macro_rules! portable {
    ($name:ident: $f:ty, $bits:ty, $wide:ty, $int:ty, fraction $fraction:literal, bias $bias:literal) => {
        pub mod $name {
            /// Bits of the fraction.
            const FRACTION: i32 = $fraction;
            /// The bits of the fraction.
            const MASK: $bits = (1 << FRACTION) - 1;

            /// Integer part: clears the bits of the fraction that are worth less than one.
            #[inline(always)]
            pub fn trunc(x: $f) -> $f {
                let exponent = ((x.to_bits() >> FRACTION) as i32 & (2 * $bias + 1)) - $bias;
                match exponent {
                    ..0 => <$f>::copysign(0.0, x),
                    0..FRACTION => <$f>::from_bits(x.to_bits() & <$bits>::MAX << (FRACTION - exponent)),
                    _ => x,
                }
            }

            #[inline(always)]
            pub fn floor(x: $f) -> $f {
                let whole = trunc(x);
                if whole > x { whole - 1.0 } else { whole }
            }

            #[inline(always)]
            pub fn ceil(x: $f) -> $f {
                let whole = trunc(x);
                if whole < x { whole + 1.0 } else { whole }
            }

            #[inline(always)]
            pub fn round_ties_even(x: $f) -> $f {
                let whole = trunc(x);
                let rest = (x - whole).abs(); // exact
                let odd = whole as $int & 1 != 0; // what saturates has no rest
                if rest > 0.5 || (rest == 0.5 && odd) { whole + <$f>::copysign(1.0, x) } else { whole }
            }

            /// Correctly rounded, by the square root of an integer.
            #[inline(always)]
            #[allow(dead_code, reason = "there are processors with the instruction")]
            pub fn sqrt(x: $f) -> $f {
                if x.is_nan() || x <= 0.0 || x == <$f>::INFINITY {
                    return if x < 0.0 { <$f>::NAN } else { x };
                }
                // x = fraction * 2^(exponent - bias - FRACTION), fraction of exactly FRACTION + 1 bits.
                let (mut fraction, mut exponent) = (x.to_bits() & MASK, (x.to_bits() >> FRACTION) as i32);
                if exponent == 0 {
                    let shift = fraction.leading_zeros() as i32 - (<$bits>::BITS as i32 - 1 - FRACTION);
                    fraction <<= shift;
                    exponent = 1 - shift;
                } else {
                    fraction |= 1 << FRACTION;
                }
                // Shifted so that the exponent is even and the root has FRACTION + 2 bits: the last one rounds. There are no ties: an
                // odd root would have an odd square.
                let unit = exponent - $bias - FRACTION;
                let shift = FRACTION + 2 + ((unit ^ FRACTION) & 1);
                let root = (<$wide>::from(fraction) << shift).isqrt() as $bits;
                let root = (root + 1) >> 1;
                let exponent = (unit - shift) / 2 + 1 + $bias + FRACTION;
                // The root's leading bit adds one to the exponent, and one more if rounding has carried.
                <$f>::from_bits((((exponent - 1) as $bits) << FRACTION) + root)
            }
        }
    };
}
#[cfg(any(test, not(feature = "std")))]
mod portable {
    portable!(single: f32, u32, u64, i32, fraction 23, bias 127);
    portable!(double: f64, u64, u128, i64, fraction 52, bias 1023);
}

macro_rules! std_or_portable {
    ($module:ident $f:ty: $($name:ident)*) => {$(
        #[inline(always)]
        pub(crate) fn $name(x: $f) -> $f {
            #[cfg(feature = "std")]
            return <$f>::$name(x);
            #[cfg(not(feature = "std"))]
            return super::portable::$module::$name(x);
        }
    )*};
}

/// Of `f32`.
pub(crate) mod single {
    std_or_portable!(single f32: floor ceil trunc round_ties_even);

    /// Square root, correctly rounded.
    #[inline(always)]
    pub(crate) fn sqrt(x: f32) -> f32 {
        #[cfg(feature = "std")]
        return f32::sqrt(x);
        #[cfg(all(not(feature = "std"), any(target_arch = "x86", target_arch = "x86_64"), target_feature = "sse"))]
        {
            #[cfg(target_arch = "x86")]
            use core::arch::x86::*;
            #[cfg(target_arch = "x86_64")]
            use core::arch::x86_64::*;
            // SAFETY: everything here is compiled for SSE.
            return unsafe { _mm_cvtss_f32(_mm_sqrt_ss(_mm_set_ss(x))) };
        }
        #[cfg(all(not(feature = "std"), target_arch = "aarch64", target_feature = "neon"))]
        {
            use core::arch::aarch64::*;
            // SAFETY: everything here is compiled for NEON.
            return unsafe { vget_lane_f32::<0>(vsqrt_f32(vdup_n_f32(x))) };
        }
        #[allow(unreachable_code, reason = "for processors without the instruction")]
        #[cfg(not(feature = "std"))]
        return super::portable::single::sqrt(x);
    }
}

/// Of `f64`.
pub(crate) mod double {
    std_or_portable!(double f64: floor ceil trunc round_ties_even sqrt);
}

/// `a * b + c` with one rounding.
///
/// The product is exact in `f64`. The sum is rounded to odd there (Boldo & Melquiond 2008): what is lost leaves its trace in the
/// last bit, so that the second rounding, to `f32`, is the only one that counts.
pub(crate) fn mul_add(a: f32, b: f32, c: f32) -> f32 {
    let (product, c) = (f64::from(a) * f64::from(b), f64::from(c));
    let sum = product + c;
    // The error of the sum, exact (Knuth).
    let virtual_c = sum - product;
    let error = (product - (sum - virtual_c)) + (c - virtual_c);
    let bits = sum.to_bits();
    // NaN errors come with infinite sums, and those are final.
    if error.abs() > 0.0 && bits & 1 == 0 {
        let away_from_zero = (error > 0.0) == (sum > 0.0);
        return f64::from_bits(if away_from_zero { bits + 1 } else { bits - 1 }) as f32;
    }
    sum as f32
}

/// A finite number other than zero as an integer times a power of two; the integer's highest bit is bit 125.
#[inline(always)]
fn scaled(mantissa: u128, exponent: i32) -> (u128, i32) {
    let shift = mantissa.leading_zeros() as i32 - 2;
    (mantissa << shift, exponent - shift)
}

/// `a * b + c` with one rounding, of `f64`: in integers, with the bits that fall off the end gathered in the last one.
pub(crate) fn mul_add_double(a: f64, b: f64, c: f64) -> f64 {
    let product = a * b;
    if !(a.is_finite() && b.is_finite()) || a == 0.0 || b == 0.0 {
        return product + c;
    }
    if !c.is_finite() {
        return c; // where the product may have overflowed
    }
    if c == 0.0 {
        return product;
    }
    let parts = |x: f64| {
        let (fraction, exponent) = (x.to_bits() & ((1 << 52) - 1), (x.to_bits() >> 52) as i32 & 2047);
        // Denormals have the exponent of the smallest normal numbers, and no hidden bit.
        if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) }
    };
    let ((a_bits, a_exponent), (b_bits, b_exponent), (c_bits, c_exponent)) = (parts(a), parts(b), parts(c));
    let first = scaled(u128::from(a_bits) * u128::from(b_bits), a_exponent + b_exponent);
    let second = scaled(u128::from(c_bits), c_exponent);
    let (first_sign, second_sign) = (a.is_sign_negative() != b.is_sign_negative(), c.is_sign_negative());
    let first_is_larger = (first.1, first.0) >= (second.1, second.0);
    let ((large, exponent), (small, small_exponent), sign) =
        if first_is_larger { (first, second, first_sign) } else { (second, first, second_sign) };

    let sum = {
        let distance = (exponent - small_exponent) as u32;
        let (kept, lost) =
            if distance > 127 { (0, true) } else { (small >> distance, small << (127 - distance) << 1 != 0) };
        // Both have twenty zeros at the end: bits are lost only where no leading ones can cancel.
        let small = kept | u128::from(lost);
        if first_sign == second_sign { large + small } else { large - small }
    };
    if sum == 0 {
        return 0.0;
    }
    // As many bits as a number of this size has, from 2^-1074 up.
    let highest = 127 - sum.leading_zeros() as i32 + exponent;
    let unit = (highest - 52).max(-1074);
    let rounded = match unit - exponent {
        shift @ ..=0 => (sum << -shift) as u64,
        shift @ 1..=127 => {
            let (whole, rest, half) = ((sum >> shift) as u64, sum & ((1 << shift) - 1), 1 << (shift - 1));
            whole + u64::from(rest > half || rest == half && whole & 1 == 1)
        }
        _ => 0,
    };
    // A hidden bit, and one that rounding carried, add to the exponent.
    let finite = (((unit + 1074).min(2046) as u64) << 52) + rounded;
    let bits = if highest > 1023 { f64::INFINITY.to_bits() } else { finite };
    f64::from_bits(bits | u64::from(sign) << 63)
}

#[cfg(test)]
mod tests {
    use super::{mul_add, mul_add_double, portable};

    macro_rules! same_bits_as_std {
        ($name:ident: $f:ty, $bits:ty) => {
            /// Spread over all signs and exponents. Which NaN a NaN is does not matter.
            #[test]
            fn $name() {
                let same = |a: $f, b: $f| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
                let check = |x: $f| {
                    assert!(same(portable::$name::floor(x), x.floor()), "floor {x:e}");
                    assert!(same(portable::$name::ceil(x), x.ceil()), "ceil {x:e}");
                    assert!(same(portable::$name::trunc(x), x.trunc()), "trunc {x:e}");
                    assert!(same(portable::$name::round_ties_even(x), x.round_ties_even()), "round {x:e}");
                    assert!(same(portable::$name::sqrt(x), x.sqrt()), "sqrt {x:e}");
                };
                let step = <$bits>::MAX / 10_000_019;
                (0..10_000_019).for_each(|i| check(<$f>::from_bits(step * i)));
                for whole in -1000..1000_i16 {
                    let x = <$f>::from(whole);
                    [x, x + 0.5, x * x, x * x * x / 7.0].into_iter().for_each(check);
                }
            }
        };
    }
    same_bits_as_std!(single: f32, u32);
    same_bits_as_std!(double: f64, u64);

    /// Against the standard library's, on numbers of like size, with cancellation, near overflow and underflow.
    #[cfg(not(all(windows, target_env = "gnu")))]
    #[test]
    fn fused_double() {
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            state ^ state >> 32
        };
        for round in 0..3_000_000 {
            let [mut a, mut b, mut c] = [random(), random(), random()].map(f64::from_bits);
            match round % 6 {
                0 => {
                    [a, b, c] =
                        [a, b, c].map(|x| f64::from_bits(x.to_bits() & 0x803f_ffff_ffff_ffff | 0x3fc0_0000_0000_0000))
                }
                1 => c = -(a * b),
                2 => c = -(a * b) * (1.0 + f64::EPSILON),
                // Short numbers: ties.
                3 => [a, b, c] = [a, b, c].map(|x| f64::from_bits(x.to_bits() & 0xbfff_fff0_0000_0000)),
                // Denormal results.
                4 => {
                    [a, b] =
                        [a, b].map(|x| f64::from_bits(x.to_bits() & 0x800f_ffff_ffff_ffff | 0x1e50_0000_0000_0000));
                    c = f64::from_bits(c.to_bits() & 0x803f_ffff_ffff_ffff);
                }
                _ => {}
            }
            let (got, expected) = (mul_add_double(a, b, c), a.mul_add(b, c));
            assert!(
                got.to_bits() == expected.to_bits() || got.is_nan() && expected.is_nan(),
                "{a:e} * {b:e} + {c:e}: got {got:e}, expected {expected:e}"
            );
        }
    }

    /// Against the standard library's (where it is right: the C library of MinGW rounds twice).
    #[cfg(not(all(windows, target_env = "gnu")))]
    #[test]
    fn fused() {
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            state ^ state >> 16
        };
        for round in 0..3_000_000 {
            let [mut a, mut b, mut c] = [random(), random(), random()].map(f32::from_bits);
            if round % 3 == 0 {
                // Of like size, with cancellation.
                [a, b, c] = [a, b, c].map(|x| f32::from_bits(x.to_bits() & 0x81ff_ffff | 0x3e00_0000));
                c = if round % 2 == 0 { -(a * b) } else { c };
            } else if round % 3 == 1 {
                c = -(a * b) * (1.0 + f32::EPSILON);
                b = if round % 2 == 0 { f32::from_bits(b.to_bits() & 0xffff_f000) } else { b };
            }
            let (got, expected) = (mul_add(a, b, c), a.mul_add(b, c));
            assert!(
                got.to_bits() == expected.to_bits() || got.is_nan() && expected.is_nan(),
                "{a:e} * {b:e} + {c:e}: got {got:e}, expected {expected:e}"
            );
        }
    }
}
