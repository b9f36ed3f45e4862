//! What `std` has for `f32` and `core` has not, with the same bits; and the fused multiply-add of levels that lack it.

#[cfg(any(test, not(feature = "std")))]
mod portable {
    /// Bits of the fraction.
    const FRACTION: i32 = 23;

    /// Integer part: clears the bits of the fraction that are worth less than one.
    #[inline(always)]
    pub fn trunc(x: f32) -> f32 {
        let exponent = (x.to_bits() >> FRACTION & 0xff) as i32 - 127;
        match exponent {
            ..0 => 0.0_f32.copysign(x),
            0..FRACTION => f32::from_bits(x.to_bits() & u32::MAX << (FRACTION - exponent)),
            _ => x,
        }
    }

    #[inline(always)]
    pub fn floor(x: f32) -> f32 {
        let whole = trunc(x);
        if whole > x { whole - 1.0 } else { whole }
    }

    #[inline(always)]
    pub fn ceil(x: f32) -> f32 {
        let whole = trunc(x);
        if whole < x { whole + 1.0 } else { whole }
    }

    #[inline(always)]
    pub fn round_ties_even(x: f32) -> f32 {
        let whole = trunc(x);
        let rest = (x - whole).abs(); // exact
        let odd = whole as i32 & 1 != 0; // what saturates has no rest
        if rest > 0.5 || (rest == 0.5 && odd) { whole + 1.0_f32.copysign(x) } else { whole }
    }

    /// Correctly rounded, by the square root of an integer.
    #[inline(always)]
    #[cfg_attr(any(target_feature = "sse", target_feature = "neon"), allow(dead_code, reason = "has the instruction"))]
    pub fn sqrt(x: f32) -> f32 {
        if x.is_nan() || x <= 0.0 || x == f32::INFINITY {
            return if x < 0.0 { f32::NAN } else { x };
        }
        // x = fraction * 2^(exponent - 150), fraction of exactly 24 bits.
        let (mut fraction, mut exponent) = (x.to_bits() & 0x7f_ffff, (x.to_bits() >> FRACTION) as i32);
        if exponent == 0 {
            let shift = fraction.leading_zeros() - 8;
            fraction <<= shift;
            exponent = 1 - shift as i32;
        } else {
            fraction |= 1 << FRACTION;
        }
        // Shifted so that the exponent is even and the root has 25 bits: the last one rounds. There are no ties: an odd root
        // would have an odd square.
        let shift = 25 + ((exponent + 1) & 1);
        let root = (u64::from(fraction) << shift).isqrt() as u32;
        let root = (root + 1) >> 1;
        let exponent = (exponent - 150 - shift) / 2 + 151;
        // The root's leading bit adds one to the exponent, and one more if rounding has carried.
        f32::from_bits((((exponent - 1) as u32) << FRACTION) + root)
    }
}

macro_rules! std_or_portable {
    ($($name:ident),*) => {$(
        #[inline(always)]
        pub(super) fn $name(x: f32) -> f32 {
            #[cfg(feature = "std")]
            return f32::$name(x);
            #[cfg(not(feature = "std"))]
            return portable::$name(x);
        }
    )*};
}
std_or_portable!(floor, ceil, trunc, round_ties_even);

/// Square root, correctly rounded.
#[inline(always)]
pub(super) fn sqrt(x: f32) -> f32 {
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
    return portable::sqrt(x);
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

#[cfg(test)]
mod tests {
    use super::{mul_add, portable};

    /// Every 251st number, of all signs and exponents. Which NaN a NaN is does not matter.
    #[test]
    fn same_bits_as_std() {
        let same = |a: f32, b: f32| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
        for x in (0..=u32::MAX).step_by(251).map(f32::from_bits) {
            assert!(same(portable::floor(x), x.floor()), "floor {x:e}");
            assert!(same(portable::ceil(x), x.ceil()), "ceil {x:e}");
            assert!(same(portable::trunc(x), x.trunc()), "trunc {x:e}");
            assert!(same(portable::round_ties_even(x), x.round_ties_even()), "round {x:e}");
            assert!(same(portable::sqrt(x), x.sqrt()), "sqrt {x:e}");
        }
        for whole in -1000..1000 {
            for x in [whole as f32 + 0.5, whole as f32] {
                assert!(same(portable::round_ties_even(x), x.round_ties_even()), "round {x:e}");
                assert!(same(portable::sqrt(x * x), x.abs()), "sqrt of the square of {x:e}");
            }
        }
    }

    /// Against the standard library's.
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
