//! Integers, lane by lane.

use crate::harness::{Width, everywhere};
use crate::values;
use simd::{Float, Int, Vector};

mod int {
    use super::*;

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

        to_uint(a: int) -> uint { a.to_uint() } is { a as u32 }
        from_uint(a: uint) -> int { F::Int::from_uint(a) } is { a as i32 }
    }
}

mod uint {
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
            assert_eq!(out.uint_right, expected(|x, n| x >> n), "uint >>, {place}");
        }
    }
}
