//! Across the lanes of a vector, for every lane type; and how tests reach vectors by their lane type.

use crate::golden::Hash;
use crate::harness::{Width, everywhere, same_number};
use crate::values::{Random, SPECIAL};
use simd::{Block, Float, Int, Integer, Kernel, Lane, Level, Mask, Simd, Vector};
use std::num::Wrapping;

/// Work on vectors of one lane type, whatever their width.
pub trait Job<L> {
    type Output;
    fn run<V: Vector<Lane = L>>(self) -> Self::Output;
}

/// A lane type of which tests can make and compare values, and reach the vectors.
pub trait AnyLane: Lane {
    fn of_bits(bits: u32) -> Self;
    fn bits(self) -> u32;
    fn run<J: Job<Self>>(level: Level, width: Width, job: J) -> J::Output;
}

macro_rules! any_lane {
    ($Lane:ty, $of:expr, $bits:expr, $One:ty, $Four:ident, $Eight:ident, $Sixteen:ident) => {
        impl AnyLane for $Lane {
            fn of_bits(bits: u32) -> Self {
                $of(bits)
            }
            fn bits(self) -> u32 {
                $bits(self)
            }
            fn run<J: Job<Self>>(level: Level, width: Width, job: J) -> J::Output {
                struct At<J>(Width, J);
                impl<J: Job<$Lane>> Kernel for At<J> {
                    type Output = J::Output;
                    #[inline(always)]
                    fn run<S: Simd>(self) -> J::Output {
                        match self.0 {
                            Width::One => self.1.run::<$One>(),
                            Width::Four => self.1.run::<S::$Four>(),
                            Width::Eight => self.1.run::<S::$Eight>(),
                            Width::Sixteen => self.1.run::<S::$Sixteen>(),
                        }
                    }
                }
                level.run(At(width, job))
            }
        }
    };
}
any_lane!(f32, f32::from_bits, f32::to_bits, f32, Float4, Float8, Float16);
any_lane!(i32, |x| x as i32, |x| x as u32, Wrapping<i32>, Int4, Int8, Int16);
any_lane!(u32, |x| x, |x| x, Wrapping<u32>, Uint4, Uint8, Uint16);

/// Minimum, maximum, and where the minimum is among the lanes that are on.
struct Reduce<'a, L>(&'a [L], u32);
impl<L: AnyLane> Job<L> for Reduce<'_, L> {
    type Output = (L, L, [Option<usize>; 2]);
    #[inline(always)]
    fn run<V: Vector<Lane = L>>(self) -> Self::Output {
        let x = V::load(self.0);
        let mask = V::Mask::from_bitmask(self.1);
        (x.reduce_min(), x.reduce_max(), [x.min_index(mask), x.max_index(mask)])
    }
}

/// Lane `i` with lane `i + n/2`, until one is left.
fn tree<L: Copy>(lanes: &[L], operation: fn(L, L) -> L) -> L {
    match lanes.split_at(lanes.len() / 2) {
        ([], last) => last[0],
        (lower, upper) => {
            let halved: Vec<L> = lower.iter().zip(upper).map(|(&a, &b)| operation(a, b)).collect();
            tree(&halved, operation)
        }
    }
}

fn first_of<L: PartialOrd + Copy>(lanes: &[L], mask: u32, is_better: fn(L, L) -> bool) -> Option<usize> {
    let is_number = |x: L| x.partial_cmp(&x).is_some();
    let on = (0..lanes.len()).filter(|&i| mask >> i & 1 == 1 && is_number(lanes[i]));
    on.reduce(|best, i| if is_better(lanes[i], lanes[best]) { i } else { best })
}

fn check_reductions<L: AnyLane>(patterns: &[u32; 16], mask: u32) {
    let numbers = patterns.map(L::of_bits);
    for (level, width) in everywhere() {
        let numbers = &numbers[..width.lanes()];
        let (min, max, indices) = L::run(level, width, Reduce(numbers, mask));
        let of = || format!("{level}, {numbers:?} = {:x?}, mask {mask:x}", &patterns[..width.lanes()]);
        assert_eq!(min.bits(), tree(numbers, |a, b| if a < b { a } else { b }).bits(), "reduce_min, {}", of());
        assert_eq!(max.bits(), tree(numbers, |a, b| if a > b { a } else { b }).bits(), "reduce_max, {}", of());
        let expected = [first_of(numbers, mask, |a, b| a < b), first_of(numbers, mask, |a, b| a > b)];
        assert_eq!(indices, expected, "min_index, max_index, {}", of());
    }
}

#[inline(always)]
fn sum_of_lanes<F: Float>(numbers: &[f32]) -> f32 {
    F::load(numbers).reduce_add()
}

simd::kernel! {
    fn sum<S>(width: Width, numbers: &[f32]) -> f32 {
        at_width!(S, width, sum_of_lanes(numbers))
    }
}

/// How many random vectors the reductions are tried on.
const CASES: usize = 2048;

impl Random {
    /// Any of these.
    fn one_of(&mut self, patterns: &[u32]) -> u32 {
        patterns[self.bits() as usize % patterns.len()]
    }

    /// Lanes with many equal and special values among them.
    fn sixteen_lanes(&mut self) -> [u32; 16] {
        let few = [0.0, -0.0, 1.0, f32::NAN].map(f32::to_bits);
        std::array::from_fn(|_| match self.bits() % 3 {
            0 => self.one_of(&SPECIAL),
            1 => self.one_of(&few),
            _ => self.bits(),
        })
    }

    /// Lanes of similar size, and in every other vector some of any size.
    fn sixteen_floats(&mut self) -> [f32; 16] {
        let wild = self.bits() % 2 == 1;
        std::array::from_fn(|_| match wild && self.bits() % 2 == 1 {
            true => f32::from_bits(self.bits()),
            false => self.moderate(),
        })
    }
}

#[test]
fn reductions() {
    let mut random = Random(5);
    for _ in 0..CASES {
        let (patterns, mask) = (random.sixteen_lanes(), random.bits());
        check_reductions::<f32>(&patterns, mask);
        check_reductions::<i32>(&patterns, mask);
        check_reductions::<u32>(&patterns, mask);
    }
}

#[test]
fn reduce_add() {
    let mut random = Random(6);
    for _ in 0..CASES {
        let numbers = random.sixteen_floats();
        for (level, width) in everywhere() {
            let numbers = &numbers[..width.lanes()];
            let (got, expected) = (sum(level, width, numbers), tree(numbers, |a, b| a + b));
            let same = same_number(got.to_bits(), expected.to_bits());
            assert!(same, "{level}: of {numbers:?} got {got:e}, expected {expected:e}");
        }
    }
}

/// The lane types' largest value, as what fills the lanes that are off, is not mistaken for one of them.
#[test]
fn min_index_of_the_largest() {
    for mask in [0, 1, 2, 0x8000, 0xfff8, u32::MAX] {
        check_reductions::<f32>(&[f32::INFINITY.to_bits(); 16], mask);
        check_reductions::<f32>(&[f32::NAN.to_bits(); 16], mask);
        check_reductions::<f32>(&[f32::NEG_INFINITY.to_bits(); 16], mask);
        check_reductions::<i32>(&[i32::MAX as u32; 16], mask);
        check_reductions::<i32>(&[i32::MIN as u32; 16], mask);
        check_reductions::<u32>(&[u32::MAX; 16], mask);
        check_reductions::<u32>(&[0; 16], mask);
    }
}

/// All that moves lanes about, the results one after the other, in blocks.
struct Move<'a, L> {
    a: &'a [L],
    b: &'a [L],
    index: &'a [u32],
    n: usize,
    mask: u32,
    out: &'a mut Vec<Block<L>>,
}
impl<L: AnyLane> Job<L> for Move<'_, L> {
    type Output = usize;
    #[inline(always)]
    fn run<V: Vector<Lane = L>>(self) -> usize {
        let Self { a, b, index, n, mask, out } = self;
        let (a, b, index, mask) = (V::load(a), V::load(b), V::Index::load(index), V::Mask::from_bitmask(mask));
        let (low, high) = a.interleave(b);
        let (even, odd) = a.deinterleave(b);
        let moved = [
            a.lookup(index),
            a.swizzle(|i| i ^ 1),
            a.rotate_lanes_left(n),
            a.rotate_lanes_right(n),
            a.reverse(),
            low,
            high,
            even,
            odd,
            a.compress(mask),
            a.expand(mask),
            a.with_lane(n % V::LANES, b.lane(0)),
        ];
        out.extend(moved.map(V::to_block));
        let mut square = [V::default(); 16];
        for (i, row) in square[..V::LANES].iter_mut().enumerate() {
            *row = a.rotate_lanes_left(i);
        }
        V::transpose(&mut square[..V::LANES]);
        out.extend(square[..V::LANES].iter().map(|row| row.to_block()));
        let mut list = [L::default(); 20];
        let count = a.compress_store(mask, &mut list);
        let mut short = list;
        assert_eq!(a.compress_store(mask, &mut short[..count]), count);
        assert_eq!(bits_of(&short), bits_of(&list));
        out.push(Block(std::array::from_fn(|i| list[i])));
        count
    }
}

fn bits_of<L: AnyLane>(lanes: &[L]) -> Vec<u32> {
    lanes.iter().map(|x| x.bits()).collect()
}

fn check_moves<L: AnyLane>(a: &[u32; 16], b: &[u32; 16], index: &[u32; 16], n: usize, mask: u32, hashes: &mut [Hash]) {
    let (a, b) = (a.map(L::of_bits), b.map(L::of_bits));
    for ((level, width), hash) in everywhere().zip(hashes) {
        let lanes = width.lanes();
        let mut out = Vec::new();
        let count = L::run(level, width, Move { a: &a, b: &b, index, n, mask, out: &mut out });

        let on: Vec<usize> = (0..lanes).filter(|i| mask >> i & 1 == 1).collect();
        let both: Vec<L> = a[..lanes].iter().chain(&b[..lanes]).copied().collect();
        let zipped = |i: usize| if i.is_multiple_of(2) { a[i / 2] } else { b[i / 2] };
        let zero = L::default();
        let functions: [&dyn Fn(usize) -> L; 12] = [
            &|i| a[index[i] as usize % lanes],
            &|i| a[(i ^ 1) % lanes],
            &|i| a[(i + n) % lanes],
            &|i| a[(i + lanes - n % lanes) % lanes],
            &|i| a[lanes - 1 - i],
            &|i| if lanes == 1 { a[0] } else { zipped(i) },
            &|i| if lanes == 1 { b[0] } else { zipped(lanes + i) },
            &|i| if lanes == 1 { a[0] } else { both[2 * i] },
            &|i| if lanes == 1 { b[0] } else { both[2 * i + 1] },
            &|i| on.get(i).map_or(zero, |&lane| a[lane]),
            &|i| on.iter().position(|&lane| lane == i).map_or(zero, |rank| a[rank]),
            &|i| if i == n % lanes { b[0] } else { a[i] },
        ];
        let mut expected: Vec<Vec<L>> = functions.iter().map(|f| (0..lanes).map(f).collect()).collect();
        expected.extend((0..lanes).map(|i| (0..lanes).map(|j| a[(i + j) % lanes]).collect()));
        expected.push(on.iter().map(|&lane| a[lane]).collect());
        assert_eq!(count, on.len(), "{level}, {width:?}");
        assert_eq!(out.len(), expected.len());
        for (k, (got, mut expected)) in out.iter().zip(expected).enumerate() {
            expected.resize(16, zero);
            got.0.iter().for_each(|x| hash.add(x.bits()));
            assert_eq!(bits_of(&got.0), bits_of(&expected), "{level}, {width:?}, result {k}, n {n}, mask {mask:x}");
        }
    }
}

/// Every mask of eight lanes, and random ones.
#[test]
fn moves() {
    let mut random = Random(7);
    let mut hashes = [(); 3].map(|()| vec![Hash::new(); everywhere().count()]);
    for round in 0..2000 {
        let mut row = || std::array::from_fn(|_| random.bits());
        let (a, b, index) = (row(), row(), row());
        let (n, mask) = (random.bits() as usize % 40, if round < 256 { round | round << 8 } else { random.bits() });
        check_moves::<f32>(&a, &b, &index, n, mask, &mut hashes[0]);
        check_moves::<i32>(&a, &b, &index, n, mask, &mut hashes[1]);
        check_moves::<u32>(&a, &b, &index, n, mask, &mut hashes[2]);
    }
    for (name, hashes) in ["lanes::moves_f32", "lanes::moves_i32", "lanes::moves_u32"].iter().zip(hashes) {
        for ((level, width), hash) in everywhere().zip(hashes) {
            hash.check(level, name, width.lanes());
        }
    }
}

/// Sums and products of floats; then of `i32` and of `u32`.
#[derive(Debug)]
struct Folded {
    float: [Block<f32>; 2],
    product: f32,
    integer: [Block<u32>; 4],
    folds: [u32; 4],
}

#[inline(always)]
fn fold_all<F: Float>(bits: &[u32]) -> Folded {
    let uint = F::Index::load(bits);
    let (float, int) = (F::from_bits(uint), F::Int::from_uint(uint));
    Folded {
        float: [float.prefix_sum().to_block(), float.prefix_sum_exclusive().to_block()],
        product: float.reduce_mul(),
        integer: [
            int.prefix_sum().to_uint().to_block(),
            int.prefix_sum_exclusive().to_uint().to_block(),
            uint.prefix_sum().to_block(),
            uint.prefix_sum_exclusive().to_block(),
        ],
        folds: [int.reduce_add() as u32, int.reduce_mul() as u32, uint.reduce_add(), uint.reduce_mul()],
    }
}

simd::kernel! {
    fn fold<S>(width: Width, bits: &[u32]) -> Folded {
        at_width!(S, width, fold_all(bits))
    }
}

/// As documented: lane `i - n` is added to lane `i`, for `n` = 1, 2, 4, ...
fn kogge_stone<L: Copy>(lanes: &[L], add: fn(L, L) -> L) -> Vec<L> {
    let (mut lanes, mut n) = (lanes.to_vec(), 1);
    while n < lanes.len() {
        lanes = (0..lanes.len()).map(|i| if i < n { lanes[i] } else { add(lanes[i - n], lanes[i]) }).collect();
        n *= 2;
    }
    lanes
}

#[test]
fn folds() {
    let mut random = Random(8);
    let mut hashes = vec![Hash::new(); everywhere().count()];
    for round in 0..3000 {
        let bits: [u32; 16] = std::array::from_fn(|_| match round % 3 {
            0 => random.bits(),
            1 => SPECIAL[random.bits() as usize % SPECIAL.len()],
            _ => (random.bits() as f32 / 1e9 - 2.0).to_bits(),
        });
        for ((level, width), hash) in everywhere().zip(&mut hashes) {
            let (lanes, place) = (width.lanes(), format!("{level}, {width:?}, {bits:x?}"));
            let got = fold(level, width, &bits);
            let floats = got.float.iter().flat_map(|block| block.0).chain([got.product]);
            floats.for_each(|x| hash.add_number(x.to_bits()));
            got.integer.iter().flat_map(|block| block.0).chain(got.folds).for_each(|x| hash.add(x));
            let same = |a: f32, b: f32| a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan();

            let floats: Vec<f32> = bits[..lanes].iter().map(|&b| f32::from_bits(b)).collect();
            let sums = kogge_stone(&floats, |a, b| a + b);
            for i in 0..lanes {
                assert!(same(got.float[0].0[i], sums[i]), "{place}: prefix_sum of floats, lane {i}");
                let below = if i == 0 { 0.0 } else { sums[i - 1] };
                assert!(same(got.float[1].0[i], below), "{place}: prefix_sum_exclusive of floats, lane {i}");
            }
            assert!(same(got.product, tree(&floats, |a, b| a * b)), "{place}: product of floats");

            let mut sums = vec![0_u32];
            bits[..lanes].iter().for_each(|&x| sums.push(sums[sums.len() - 1].wrapping_add(x)));
            for k in 0..4 {
                let expected = if k % 2 == 0 { &sums[1..] } else { &sums[..lanes] };
                assert_eq!(&got.integer[k].0[..lanes], expected, "{place}: prefix sums of integers");
            }
            let product = bits[..lanes].iter().fold(1, |a: u32, &b| a.wrapping_mul(b));
            assert_eq!(got.folds, [sums[lanes], product, sums[lanes], product], "{place}: folds of integers");
        }
    }
    for ((level, width), hash) in everywhere().zip(hashes) {
        hash.check(level, "lanes::folds", width.lanes());
    }
}

simd::kernel! {
    /// Halves and back, of eight lanes and of sixteen.
    fn split<S>(a: &[f32; 16]) -> ([f32; 4], [f32; 16], bool) {
        use simd::Halves;
        let x = S::Float8::load(a);
        let (low, high) = (x.low(), x.high());
        let mut quarter = [0.0; 4];
        high.store(&mut quarter);
        let y = S::Float16::from_halves(S::Float8::from_halves(high, low), S::Float16::load(a).high());
        (quarter, y.to_block().0, S::Int8::from_halves(S::Int4::splat(1), S::Int4::splat(2)).high().lane(3) == 2)
    }
}

#[test]
fn halves() {
    let a = std::array::from_fn(|i| i as f32);
    for level in Level::available() {
        let expected = std::array::from_fn(|i| if i < 8 { (i ^ 4) as f32 } else { i as f32 });
        assert_eq!(split(level, &a), ([4.0, 5.0, 6.0, 7.0], expected, true), "{level}");
    }
}

simd::kernel! {
    fn shown<S>() -> [String; 3] {
        let x = S::Float8::from_fn(|i| i as f32);
        [format!("{:?}", x), format!("{:?}", x.gt(S::Float8::splat(5.0))), format!("{:?}", S::Int4::default())]
    }
}

/// `Debug` shows the lanes, the same at every level.
#[test]
fn debug() {
    for level in Level::available() {
        let [float, mask, int] = shown(level);
        assert_eq!(float, "[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]", "{level}");
        assert_eq!(mask, "[false, false, false, false, false, false, true, true]", "{level}");
        assert_eq!(int, "[0, 0, 0, 0]", "{level}");
    }
}
