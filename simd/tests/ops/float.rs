//! Floats, lane by lane.

/// `a * b + c` with one rounding. Not `f32::mul_add`: without the instruction that is the C library's, and not all are right.
fn rounded_once(a: f32, b: f32, c: f32) -> f32 {
    let (product, c) = (f64::from(a) * f64::from(b), f64::from(c)); // exact
    let sum = product + c;
    let of_c = sum - product;
    let error = (product - (sum - of_c)) + (c - of_c); // exact if finite
    if !sum.is_finite() || error == 0.0 || sum.to_bits() & 1 == 1 {
        return sum as f32;
    }
    // Rounding to odd first makes the second rounding right (Boldo and Melquiond, "Emulation of FMA", 2008).
    let away_from_zero = (error > 0.0) == (sum > 0.0);
    f64::from_bits(if away_from_zero { sum.to_bits() + 1 } else { sum.to_bits() - 1 }) as f32
}

operations! {
    add(a: float, b: float) -> float { a + b } is { a + b }
    sub(a: float, b: float) -> float { a - b } is { a - b }
    mul(a: float, b: float) -> float { a * b } is { a * b }
    div(a: float, b: float) -> float { a / b } is { a / b }
    add_assign(a: float, b: float) -> float { let mut x = a; x += b; x } is { a + b }
    sub_assign(a: float, b: float) -> float { let mut x = a; x -= b; x } is { a - b }
    mul_assign(a: float, b: float) -> float { let mut x = a; x *= b; x } is { a * b }
    div_assign(a: float, b: float) -> float { let mut x = a; x /= b; x } is { a / b }
    neg(a: float) -> exact_float { -a } is { f32::from_bits(a.to_bits() ^ 1 << 31) }

    not_fused(a: float, b: float, c: float) -> float { a * b + c } is { let product = a * b; product + c }
    mul_add(a: float, b: float, c: float) -> float { a.mul_add(b, c) } is relaxed(fused) {
        if fused { rounded_once(a, b, c) } else { a * b + c }
    }
    mul_sub(a: float, b: float, c: float) -> float { a.mul_sub(b, c) } is relaxed(fused) {
        if fused { rounded_once(a, b, -c) } else { a * b - c }
    }
    neg_mul_add(a: float, b: float, c: float) -> float { a.neg_mul_add(b, c) } is relaxed(fused) {
        if fused { rounded_once(-a, b, c) } else { c - a * b }
    }

    neg_mul_sub(a: float, b: float, c: float) -> float { a.neg_mul_sub(b, c) } is relaxed(fused) {
        if fused { rounded_once(-a, b, -c) } else { -(a * b) - c }
    }
    mul_add_exact(a: float, b: float, c: float) -> float { a.mul_add_exact(b, c) } is { rounded_once(a, b, c) }

    eq(a: float, b: float) -> mask { a.eq(b) } is { a == b }
    ne(a: float, b: float) -> mask { a.ne(b) } is { a != b }
    lt(a: float, b: float) -> mask { a.lt(b) } is { a < b }
    le(a: float, b: float) -> mask { a.le(b) } is { a <= b }
    gt(a: float, b: float) -> mask { a.gt(b) } is { a > b }
    ge(a: float, b: float) -> mask { a.ge(b) } is { a >= b }
    select(m: mask, a: float, b: float) -> exact_float { F::select(m, a, b) } is { if m { a } else { b } }

    min(a: float, b: float) -> exact_float { a.min(b) } is { if a < b { a } else { b } }
    max(a: float, b: float) -> exact_float { a.max(b) } is { if a > b { a } else { b } }
    min_num(a: float, b: float) -> float { a.min_num(b) } is { if b.is_nan() || a < b { a } else { b } }
    max_num(a: float, b: float) -> float { a.max_num(b) } is { if b.is_nan() || a > b { a } else { b } }
    clamp(a: float, lo: float, hi: float) -> float { a.clamp(lo, hi) } is {
        let above = if a > lo { a } else { lo };
        if above < hi { above } else { hi }
    }

    abs(a: float) -> exact_float { a.abs() } is { f32::from_bits(a.to_bits() & 0x7fff_ffff) }
    copysign(a: float, b: float) -> exact_float { a.copysign(b) } is {
        f32::from_bits(a.to_bits() & 0x7fff_ffff | b.to_bits() & 0x8000_0000)
    }
    mul_sign(a: float, b: float) -> exact_float { a.mul_sign(b) } is {
        f32::from_bits(a.to_bits() ^ b.to_bits() & 0x8000_0000)
    }
    sqrt(a: float) -> float { a.sqrt() } is { a.sqrt() }
    floor(a: float) -> float { a.floor() } is { a.floor() }
    ceil(a: float) -> float { a.ceil() } is { a.ceil() }
    trunc(a: float) -> float { a.trunc() } is { a.trunc() }
    round(a: float) -> float { a.round() } is { a.round_ties_even() }

    fract(a: float) -> float { a.fract() } is { a - a.floor() }

    to_int(a: float) -> int { a.to_int() } is { a as i32 }
    to_uint(a: float) -> uint { a.to_uint() } is { a as u32 }
    from_int(a: int) -> float { F::from_int(a) } is { a as f32 }
    from_uint(a: uint) -> float { F::from_uint(a) } is { a as f32 }
    to_bits(a: float) -> uint { a.to_bits() } is { a.to_bits() }
    from_bits(a: uint) -> exact_float { F::from_bits(a) } is { f32::from_bits(a) }
}
