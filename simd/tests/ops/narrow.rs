//! Vectors of 16- and 8-bit lanes: of bytes every pair of operands, of 16-bit lanes special values crossed and random ones.

use crate::values::Random;
use simd::{Level, Mask, Narrow, UChar};
use std::fmt::Debug;

/// Every level, with the vectors of 16 bytes and with those of 32.
fn everywhere() -> impl Iterator<Item = (Level, bool)> {
    Level::available().flat_map(|level| [(level, false), (level, true)])
}

/// Pairs of operands.
fn pairs(bits: u32) -> Vec<[u32; 2]> {
    let values: Vec<u32> = if bits == 8 {
        (0..256).collect()
    } else {
        let around = [0, 1 << 7, 1 << 8, 1 << 12, 0x5555, 1 << 14, 1 << 15, 0xaaaa, 0xff00];
        around.into_iter().flat_map(|x| (0..5).map(move |d| x + d + 0xfffe)).collect()
    };
    let mut pairs: Vec<_> = values.iter().flat_map(|&a| values.iter().map(move |&b| [a, b])).collect();
    let mut random = Random(1);
    pairs.extend((0..1 << 12).map(|_| [random.bits(), random.bits()]));
    pairs.resize(pairs.len().next_multiple_of(32), [0; 2]);
    pairs
}

/// Not generic over vectors, lest it be compiled at each level.
#[inline(never)]
fn check<T: PartialEq + Debug>(name: &str, got: &[T], expected: &[T]) {
    assert_eq!(got, expected, "{name}");
}

/// Tests of one lane type: `lanewise`, each lane against plain Rust, and `whole`, what concerns more than one lane.
macro_rules! lane_type {
    (
        $kind:ident: $T:ident, $Trait:ident $V16:ident $V32:ident, bits $same:ident, wide $W:ident, sum $Sum:ident,
        $a:ident $b:ident $n:ident $truth:ident: $($name:ident: $vector:expr => $number:expr;)*
    ) => {
        mod $kind {
            use super::*;
            #[allow(unused_imports, reason = "where wider lanes have 32 bits")]
            use simd::{$Trait, Vector};

            type Lanes = [$T; 32];
            const NAMES: &[&str] = &[
                "add",
                "sub",
                "mul",
                "and",
                "or",
                "xor",
                "not",
                "shl",
                "shr",
                "eq",
                "ne",
                "lt",
                "le",
                "gt",
                "ge",
                "select",
                "min",
                "max",
                "saturating_add",
                "saturating_sub",
                "mul_high",
                "average",
                "abs_diff",
                "to_signed",
                "to_unsigned",
                $(stringify!($name)),*
            ];
            type Results = [Lanes; NAMES.len()];

            #[inline(always)]
            fn lanewise_of<V: $Trait>([a, b]: &[Lanes; 2], $n: usize, out: &mut Results) {
                let ($a, $b) = (V::load(a), V::load(b));
                let $truth = |mask| V::select(mask, V::splat(1), V::splat(0));
                for (to, x) in out.iter_mut().zip([
                    $a + $b,
                    $a - $b,
                    $a * $b,
                    $a & $b,
                    $a | $b,
                    $a ^ $b,
                    !$a,
                    $a << $n,
                    $a >> $n,
                    $truth($a.eq($b)),
                    $truth($a.ne($b)),
                    $truth($a.lt($b)),
                    $truth($a.le($b)),
                    $truth($a.gt($b)),
                    $truth($a.ge($b)),
                    V::select(($a & V::splat(1)).eq(V::splat(1)), $a, $b),
                    $a.min($b),
                    $a.max($b),
                    $a.saturating_add($b),
                    $a.saturating_sub($b),
                    $a.mul_high($b),
                    $a.average($b),
                    $a.abs_diff($b).$same(),
                    $a.to_signed().$same(),
                    $a.to_unsigned().$same(),
                    $($vector),*
                ]) {
                    x.store(to);
                }
            }

            simd::kernel! {
                fn lanewise_at<S>(wide: bool, arguments: &[Lanes; 2], n: usize, out: &mut Results) {
                    if wide { lanewise_of::<S::$V32>(arguments, n, out) } else { lanewise_of::<S::$V16>(arguments, n, out) }
                }
            }

            #[test]
            fn lanewise() {
                let pairs: Vec<[$T; 2]> = pairs($T::BITS).into_iter().map(|pair| pair.map(|x| x as $T)).collect();
                for (level, wide) in everywhere() {
                    let lanes = if wide { 256 } else { 128 } / $T::BITS as usize;
                    for (i, chunk) in pairs.chunks_exact(lanes).enumerate() {
                        let arguments = [0, 1].map(|k| std::array::from_fn(|lane| chunk[lane % lanes][k]));
                        let ($n, mut out) = (i % 40, [[77; 32]; NAMES.len()]);
                        lanewise_at(level, wide, &arguments, $n, &mut out);
                        for (lane, &[$a, $b]) in chunk.iter().enumerate() {
                            let $truth = |x: bool| x as $T;
                            let expected: [$T; NAMES.len()] = [
                                $a.wrapping_add($b),
                                $a.wrapping_sub($b),
                                $a.wrapping_mul($b),
                                $a & $b,
                                $a | $b,
                                $a ^ $b,
                                !$a,
                                $a.wrapping_shl($n as u32),
                                $a.wrapping_shr($n as u32),
                                $truth($a == $b),
                                $truth($a != $b),
                                $truth($a < $b),
                                $truth($a <= $b),
                                $truth($a > $b),
                                $truth($a >= $b),
                                if $a & 1 == 1 { $a } else { $b },
                                if $a < $b { $a } else { $b },
                                if $a > $b { $a } else { $b },
                                $a.saturating_add($b),
                                $a.saturating_sub($b),
                                ((i64::from($a) * i64::from($b)) >> $T::BITS) as $T,
                                ((i64::from($a) + i64::from($b) + 1) >> 1) as $T,
                                $a.abs_diff($b) as $T,
                                $a,
                                $a,
                                $($number),*
                            ];
                            for (k, name) in NAMES.iter().enumerate() {
                                let got = out[k][lane];
                                assert_eq!(got, expected[k], "{level}, {lanes} lanes, {name} of {}, {}, {}", $a, $b, $n);
                            }
                        }
                    }
                }
            }

            #[inline(always)]
            fn whole_of<V: $Trait>(a: &Lanes, b: &Lanes, wide: &[$W; 32]) {
                let n = V::LANES;
                check("bytes", &[n * size_of::<$T>()], &[size_of::<V>().min(32)]);
                let (x, y, mut out, mut both) = (V::load(a), V::load(b), [0; 64], [0; 64]);

                x.interleave(y).0.store(&mut out);
                x.interleave(y).1.store(&mut out[n..]);
                for i in 0..n {
                    (both[2 * i], both[2 * i + 1]) = (a[i], b[i]);
                }
                check("interleave", &out, &both);
                let sum = a[..n].iter().map(|&x| $Sum::from(x)).sum();
                check("reduce_add", &[x.reduce_add()], &[sum]);
                check("from_fn", &[V::from_fn(|i| a[n - 1 - i]).lane(2), x.lane(n - 1)], &[a[n - 3], a[n - 1]]);
                check("debug", &[format!("{x:?}")], &[format!("{:?}", &a[..n])]);

                let mut widened = [0; 32];
                x.widen().0.store(&mut widened);
                x.widen().1.store(&mut widened[n / 2..]);
                check("widen", &widened[..n], &a.map($W::from)[..n]);
                out = [0; 64];
                V::narrow(V::Wide::load(wide), V::Wide::load(&wide[n / 2..])).store(&mut out);
                check("narrow", &out[..n], &wide.map(|x| x.clamp($T::MIN.into(), $T::MAX.into()) as $T)[..n]);

                for length in 0..=n + 1 {
                    let (mut part, mut expected) = ([5; 34], [5; 34]);
                    V::load_partial(&a[..length.min(32)]).store(&mut part);
                    expected[..n].fill(0);
                    expected[..length.min(n)].copy_from_slice(&a[..length.min(n)]);
                    check("load_partial", &part, &expected);
                    (part, expected) = ([5; 34], [5; 34]);
                    x.store_partial(&mut part[..length]);
                    expected[..length.min(n)].copy_from_slice(&a[..length.min(n)]);
                    check("store_partial", &part, &expected);
                }
                {
                    let (mut s, mut t) = (x, x);
                    s += y;
                    s *= y;
                    s -= x;
                    t &= y;
                    t ^= x;
                    t |= V::splat(1);
                    check("assign", &[s.eq((x + y) * y - x).all(), t.eq(((x & y) ^ x) | V::splat(1)).all()], &[true; 2]);
                }

                let (p, q) = (x.lt(y), (x & V::splat(1)).eq(V::default()));
                let (p_bits, q_bits) = (0..n).fold((0_u32, 0_u32), |(p, q), i| {
                    (p | u32::from(a[i] < b[i]) << i, q | u32::from(a[i] & 1 == 0) << i)
                });
                let ones = u32::MAX >> (32 - n);
                let mut assigned = p;
                assigned |= q;
                assigned &= !(p & q);
                assigned ^= p;
                check("masks",
                    &[p.bitmask(), q.bitmask(), (p & q).bitmask(), (p | q).bitmask(), (p ^ q).bitmask(), (!p).bitmask(),
                        assigned.bitmask(), V::Mask::from_bitmask(p_bits).bitmask(), V::Mask::LANES as u32],
                    &[p_bits, q_bits, p_bits & q_bits, p_bits | q_bits, p_bits ^ q_bits, !p_bits & ones,
                        q_bits, p_bits, n as u32]);
                check("any, all", &[p.any(), p.all(), p.none(), p == q, (p | !p).all(), (p & !p).any()],
                    &[p_bits != 0, p_bits == ones, p_bits == 0, p_bits == q_bits, true, false]);
                check("splat", &[V::Mask::splat(true).bitmask(), V::Mask::splat(false).bitmask()], &[ones, 0]);
                for i in 0..=n {
                    let first = V::Mask::first_n(i);
                    check("first_n", &[first.count(), first.bitmask().trailing_ones() as usize], &[i, i]);
                    let all_but = !V::Mask::from_bitmask(1 << (i % n));
                    let lane = V::select(all_but, x, y).lane(i % n);
                    check("one lane", &[all_but.all(), all_but.none(), lane == b[i % n]], &[false, false, true]);
                }
            }

            simd::kernel! {
                fn whole_at<S>(wide: bool, a: &Lanes, b: &Lanes, numbers: &[$W; 32]) {
                    if wide { whole_of::<S::$V32>(a, b, numbers) } else { whole_of::<S::$V16>(a, b, numbers) }
                }
            }

            #[test]
            fn whole() {
                let (mut random, mut wide_random) = (Random(2), Random(3));
                for i in 0..200 {
                    // Of sums and saturation the ends matter, too.
                    let [a, b] = [0, 1].map(|k| match i + k {
                        0 => [$T::MAX; 32],
                        1 => [$T::MIN; 32],
                        _ => [0; 32].map(|_| random.bits() as $T),
                    });
                    let wide = [0; 32].map(|_| (wide_random.bits() as $W) >> (wide_random.bits() % ($T::BITS + 1)));
                    for (level, width) in everywhere() {
                        whole_at(level, width, &a, &b, &wide);
                    }
                }
            }

            simd::kernel! {
                fn short_slice<S>(store: bool) {
                    let lanes = S::$V32::LANES;
                    let mut memory = [0; 32];
                    let memory = &mut memory[..lanes - 1];
                    if store { S::$V32::splat(1).store(memory) } else { S::$V32::load(memory).store(&mut [0; 32]) }
                }
            }

            #[test]
            fn short_slices() {
                for level in Level::available() {
                    for store in [false, true] {
                        let run = || {
                            short_slice(level, store);
                        };
                        assert!(crate::memory::panics(run), "{level}");
                    }
                }
            }
        }
    };
}

lane_type! { short: i16, Short Short8 Short16, bits to_signed, wide i32, sum i32,
    a b n truth: abs: a.abs() => a.wrapping_abs();
}
lane_type! { ushort: u16, UShort UShort8 UShort16, bits to_unsigned, wide u32, sum u32, a b n truth: }
lane_type! { char: i8, Char Char16 Char32, bits to_signed, wide i16, sum i32,
    a b n truth: abs: a.abs() => a.wrapping_abs();
}
lane_type! { uchar: u8, UChar UChar16 UChar32, bits to_unsigned, wide u16, sum u32, a b n truth: }

#[inline(always)]
fn bytes_of<V: UChar>(a: &[u8; 32], b: &[u8; 32], wide: &[i16; 32]) {
    let (x, y, n) = (V::load(a), V::load(b), V::LANES);
    check("sum_abs_diff", &[x.sum_abs_diff(y)], &[(0..n).map(|i| u32::from(a[i].abs_diff(b[i]))).sum()]);
    let mut out = [0; 32];
    x.lookup(y).store(&mut out);
    let expected: [u8; 32] = std::array::from_fn(|i| a[i / 16 * 16 + usize::from(b[i]) % 16]);
    check("lookup", &out[..n], &expected[..n]);
    let (low, high) = wide.split_at(n / 2);
    let signed = |lanes: &[i16]| <V::Wide as Narrow>::Signed::load(lanes);
    V::narrow_signed(signed(low), signed(high)).store(&mut out);
    check("narrow_signed", &out[..n], &wide.map(|x| x.clamp(0, 255) as u8)[..n]);
}

simd::kernel! {
    fn bytes_at<S>(wide: bool, a: &[u8; 32], b: &[u8; 32], numbers: &[i16; 32]) {
        if wide { bytes_of::<S::UChar32>(a, b, numbers) } else { bytes_of::<S::UChar16>(a, b, numbers) }
    }
}

#[test]
fn bytes() {
    let mut random = Random(4);
    for i in 0..400 {
        let [a, b] = [0, 1].map(|k| match i + k {
            0 => [u8::MAX; 32],
            1 => [0; 32],
            _ => [0; 32].map(|_| random.bits() as u8),
        });
        let wide = [0; 32].map(|_| (random.bits() as i16) >> (random.bits() % 10));
        for (level, width) in everywhere() {
            bytes_at(level, width, &a, &b, &wide);
        }
    }
}
