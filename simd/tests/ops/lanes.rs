//! Across the lanes of a vector, for every lane type; and how tests reach vectors by their lane type.

use crate::harness::{Width, everywhere, same_number};
use crate::values::{Random, SPECIAL};
use simd::{Float, Kernel, Lane, Level, Mask, Simd, Vector};
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
    type Output = (L, L, Option<usize>);
    #[inline(always)]
    fn run<V: Vector<Lane = L>>(self) -> Self::Output {
        let x = V::load(self.0);
        (x.reduce_min(), x.reduce_max(), x.min_index(V::Mask::from_bitmask(self.1)))
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

fn first_smallest<L: PartialOrd + Copy>(lanes: &[L], mask: u32) -> Option<usize> {
    let is_number = |x: L| x.partial_cmp(&x).is_some();
    let on = (0..lanes.len()).filter(|&i| mask >> i & 1 == 1 && is_number(lanes[i]));
    on.reduce(|best, i| if lanes[i] < lanes[best] { i } else { best })
}

fn check_reductions<L: AnyLane>(patterns: &[u32; 16], mask: u32) {
    let numbers = patterns.map(L::of_bits);
    for (level, width) in everywhere() {
        let numbers = &numbers[..width.lanes()];
        let (min, max, min_index) = L::run(level, width, Reduce(numbers, mask));
        let of = || format!("{level}, {numbers:?} = {:x?}, mask {mask:x}", &patterns[..width.lanes()]);
        assert_eq!(min.bits(), tree(numbers, |a, b| if a < b { a } else { b }).bits(), "reduce_min, {}", of());
        assert_eq!(max.bits(), tree(numbers, |a, b| if a > b { a } else { b }).bits(), "reduce_max, {}", of());
        assert_eq!(min_index, first_smallest(numbers, mask), "min_index, {}", of());
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
        check_reductions::<i32>(&[i32::MAX as u32; 16], mask);
        check_reductions::<u32>(&[u32::MAX; 16], mask);
    }
}
