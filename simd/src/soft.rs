//! Operations in plain Rust that some hardware has.

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
            let (got, expected) = (super::mul_add(a, b, c), a.mul_add(b, c));
            assert!(
                got.to_bits() == expected.to_bits() || got.is_nan() && expected.is_nan(),
                "{a:e} * {b:e} + {c:e}: got {got:e}, expected {expected:e}"
            );
        }
    }
}
