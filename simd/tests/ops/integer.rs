//! Integers, lane by lane.

use crate::harness::{Width, everywhere};
use crate::values;
use simd::{Float, Int, Uint, Vector};

mod int {
    use simd::{Int, Integer};

    operations! {
        add(a: int, b: int) -> int { a + b } is { a.wrapping_add(b) }
        sub(a: int, b: int) -> int { a - b } is { a.wrapping_sub(b) }
        mul(a: int, b: int) -> int { a * b } is { a.wrapping_mul(b) }
        add_assign(a: int, b: int) -> int { let mut x = a; x += b; x } is { a.wrapping_add(b) }
        sub_assign(a: int, b: int) -> int { let mut x = a; x -= b; x } is { a.wrapping_sub(b) }
        mul_assign(a: int, b: int) -> int { let mut x = a; x *= b; x } is { a.wrapping_mul(b) }
        neg(a: int) -> int { -a } is { a.wrapping_neg() }
        abs(a: int) -> int { a.abs() } is { a.wrapping_abs() }

        and(a: int, b: int) -> int { a & b } is { a & b }
        or(a: int, b: int) -> int { a | b } is { a | b }
        xor(a: int, b: int) -> int { a ^ b } is { a ^ b }
        not(a: int) -> int { !a } is { !a }
        and_assign(a: int, b: int) -> int { let mut x = a; x &= b; x } is { a & b }
        or_assign(a: int, b: int) -> int { let mut x = a; x |= b; x } is { a | b }
        xor_assign(a: int, b: int) -> int { let mut x = a; x ^= b; x } is { a ^ b }

        eq(a: int, b: int) -> mask { a.eq(b) } is { a == b }
        ne(a: int, b: int) -> mask { a.ne(b) } is { a != b }
        lt(a: int, b: int) -> mask { a.lt(b) } is { a < b }
        le(a: int, b: int) -> mask { a.le(b) } is { a <= b }
        gt(a: int, b: int) -> mask { a.gt(b) } is { a > b }
        ge(a: int, b: int) -> mask { a.ge(b) } is { a >= b }
        min(a: int, b: int) -> int { a.min(b) } is { if a < b { a } else { b } }
        max(a: int, b: int) -> int { a.max(b) } is { if a > b { a } else { b } }
        select(m: mask, a: int, b: int) -> int { F::Int::select(m, a, b) } is { if m { a } else { b } }

        shl_lanes(a: int, n: uint) -> int { a.shl_lanes(n) } is { a.wrapping_shl(n) }
        shr_lanes(a: int, n: uint) -> int { a.shr_lanes(n) } is { a.wrapping_shr(n) }
        saturating_add(a: int, b: int) -> int { Int::saturating_add(a, b) } is { i32::saturating_add(a, b) }
        saturating_sub(a: int, b: int) -> int { Int::saturating_sub(a, b) } is { i32::saturating_sub(a, b) }
        mul_high(a: int, b: int) -> int { Int::mul_high(a, b) } is { ((i64::from(a) * i64::from(b)) >> 32) as i32 }
        count_ones(a: int) -> uint { Int::count_ones(a) } is { i32::count_ones(a) }
        leading_zeros(a: int) -> uint { Int::leading_zeros(a) } is { i32::leading_zeros(a) }
        trailing_zeros(a: int) -> uint { Int::trailing_zeros(a) } is { i32::trailing_zeros(a) }

        to_uint_saturating(a: int) -> uint { a.to_uint_saturating() } is { a.max(0) as u32 }
        from_uint_saturating(a: uint) -> int { F::Int::from_uint_saturating(a) } is { a.min(i32::MAX as u32) as i32 }
        to_uint(a: int) -> uint { a.to_uint() } is { a as u32 }
        from_uint(a: uint) -> int { F::Int::from_uint(a) } is { a as i32 }
    }
}

mod uint {
    use simd::{Integer, Uint};

    operations! {
        add(a: uint, b: uint) -> uint { a + b } is { a.wrapping_add(b) }
        sub(a: uint, b: uint) -> uint { a - b } is { a.wrapping_sub(b) }
        mul(a: uint, b: uint) -> uint { a * b } is { a.wrapping_mul(b) }
        add_assign(a: uint, b: uint) -> uint { let mut x = a; x += b; x } is { a.wrapping_add(b) }
        sub_assign(a: uint, b: uint) -> uint { let mut x = a; x -= b; x } is { a.wrapping_sub(b) }
        mul_assign(a: uint, b: uint) -> uint { let mut x = a; x *= b; x } is { a.wrapping_mul(b) }

        and(a: uint, b: uint) -> uint { a & b } is { a & b }
        or(a: uint, b: uint) -> uint { a | b } is { a | b }
        xor(a: uint, b: uint) -> uint { a ^ b } is { a ^ b }
        not(a: uint) -> uint { !a } is { !a }
        and_assign(a: uint, b: uint) -> uint { let mut x = a; x &= b; x } is { a & b }
        or_assign(a: uint, b: uint) -> uint { let mut x = a; x |= b; x } is { a | b }
        xor_assign(a: uint, b: uint) -> uint { let mut x = a; x ^= b; x } is { a ^ b }

        eq(a: uint, b: uint) -> mask { a.eq(b) } is { a == b }
        ne(a: uint, b: uint) -> mask { a.ne(b) } is { a != b }
        lt(a: uint, b: uint) -> mask { a.lt(b) } is { a < b }
        le(a: uint, b: uint) -> mask { a.le(b) } is { a <= b }
        gt(a: uint, b: uint) -> mask { a.gt(b) } is { a > b }
        ge(a: uint, b: uint) -> mask { a.ge(b) } is { a >= b }
        min(a: uint, b: uint) -> uint { a.min(b) } is { if a < b { a } else { b } }
        max(a: uint, b: uint) -> uint { a.max(b) } is { if a > b { a } else { b } }
        shl_lanes(a: uint, n: uint) -> uint { a.shl_lanes(n) } is { a.wrapping_shl(n) }
        shr_lanes(a: uint, n: uint) -> uint { a.shr_lanes(n) } is { a.wrapping_shr(n) }
        saturating_add(a: uint, b: uint) -> uint { Uint::saturating_add(a, b) } is { u32::saturating_add(a, b) }
        saturating_sub(a: uint, b: uint) -> uint { Uint::saturating_sub(a, b) } is { u32::saturating_sub(a, b) }
        mul_high(a: uint, b: uint) -> uint { Uint::mul_high(a, b) } is { ((u64::from(a) * u64::from(b)) >> 32) as u32 }
        count_ones(a: uint) -> uint { Uint::count_ones(a) } is { u32::count_ones(a) }
        leading_zeros(a: uint) -> uint { Uint::leading_zeros(a) } is { u32::leading_zeros(a) }
        trailing_zeros(a: uint) -> uint { Uint::trailing_zeros(a) } is { u32::trailing_zeros(a) }
        select(m: mask, a: uint, b: uint) -> uint { F::Index::select(m, a, b) } is { if m { a } else { b } }
    }
}

/// The four shifts, by a count that all lanes share.
#[derive(Default)]
struct Shifted {
    int_left: Vec<u32>,
    int_right: Vec<u32>,
    uint_left: Vec<u32>,
    uint_right: Vec<u32>,
    int_rotated: Vec<u32>,
    uint_rotated: Vec<u32>,
    uint_rotated_back: Vec<u32>,
}

#[inline(always)]
fn shift_all<F: Float>(n: usize, src: &[u32]) -> Shifted {
    let mut out = Shifted::default();
    for chunk in src.chunks_exact(F::LANES) {
        let uint = F::Index::load(chunk);
        let int = F::Int::from_uint(uint);
        out.int_left.extend_from_slice(&(int << n).to_uint().to_block().0[..F::LANES]);
        out.int_right.extend_from_slice(&(int >> n).to_uint().to_block().0[..F::LANES]);
        out.uint_left.extend_from_slice(&(uint << n).to_block().0[..F::LANES]);
        out.uint_right.extend_from_slice(&(uint >> n).to_block().0[..F::LANES]);
        out.int_rotated.extend_from_slice(&Int::rotate_right(int, n).to_uint().to_block().0[..F::LANES]);
        out.uint_rotated.extend_from_slice(&Uint::rotate_left(uint, n).to_block().0[..F::LANES]);
        out.uint_rotated_back
            .extend_from_slice(&Uint::rotate_right(Uint::rotate_left(uint, n), n).to_block().0[..F::LANES]);
    }
    out
}

simd::kernel! {
    fn shift<S>(width: Width, n: usize, src: &[u32]) -> Shifted {
        at_width!(S, width, shift_all(n, src))
    }
}

#[test]
fn shifts() {
    let src = &values::SPECIAL[..96];
    for (level, width) in everywhere() {
        for n in (0..=66).chain([255, 256, 1 << 31, usize::MAX - 31, usize::MAX]) {
            let out = shift(level, width, n, src);
            let expected = |shifted: fn(u32, usize) -> u32| src.iter().map(|&x| shifted(x, n % 32)).collect::<Vec<_>>();
            let place = format!("{level}, {width:?}, by {n}");
            assert_eq!(out.int_left, expected(|x, n| x << n), "int <<, {place}");
            assert_eq!(out.int_right, expected(|x, n| (x as i32 >> n) as u32), "int >>, {place}");
            assert_eq!(out.uint_left, expected(|x, n| x << n), "uint <<, {place}");
            assert_eq!(out.int_rotated, expected(|x, n| x.rotate_right(n as u32)), "int rotate, {place}");
            assert_eq!(out.uint_rotated, expected(|x, n| x.rotate_left(n as u32)), "uint rotate, {place}");
            assert_eq!(out.uint_rotated_back, src, "uint rotate and back, {place}");
            assert_eq!(out.uint_right, expected(|x, n| x >> n), "uint >>, {place}");
        }
    }
}
