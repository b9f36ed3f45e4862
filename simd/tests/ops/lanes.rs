//! Across the lanes of a vector, for every lane type; and how tests reach vectors by their lane type.

use crate::harness::{Width, everywhere};
use crate::values::SPECIAL;
use proptest::prelude::*;
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

fn check_reductions<L: AnyLane>(patterns: &[u32; 16], mask: u32) -> Result<(), TestCaseError> {
    let numbers = patterns.map(L::of_bits);
    for (level, width) in everywhere() {
        let numbers = &numbers[..width.lanes()];
        let (min, max, min_index) = L::run(level, width, Reduce(numbers, mask));
        let place = format!("{level}, {numbers:?}, mask {mask:x}");
        prop_assert_eq!(min.bits(), tree(numbers, |a, b| if a < b { a } else { b }).bits(), "reduce_min, {}", place);
        prop_assert_eq!(max.bits(), tree(numbers, |a, b| if a > b { a } else { b }).bits(), "reduce_max, {}", place);
        prop_assert_eq!(min_index, first_smallest(numbers, mask), "min_index, {}", place);
    }
    Ok(())
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

/// Lanes with many equal and special values among them.
fn sixteen_lanes() -> impl Strategy<Value = [u32; 16]> {
    let lane = prop_oneof![
        proptest::sample::select(SPECIAL.clone()),
        proptest::sample::select(vec![0.0_f32.to_bits(), (-0.0_f32).to_bits(), 1.0_f32.to_bits(), f32::NAN.to_bits()]),
        any::<u32>(),
    ];
    proptest::array::uniform16(lane)
}

proptest! {
    #[test]
    fn reductions(patterns in sixteen_lanes(), mask in any::<u32>()) {
        check_reductions::<f32>(&patterns, mask)?;
        check_reductions::<i32>(&patterns, mask)?;
        check_reductions::<u32>(&patterns, mask)?;
    }

    #[test]
    fn reduce_add(numbers in proptest::array::uniform16(prop_oneof![-16.0_f32..16.0, proptest::num::f32::ANY])) {
        for (level, width) in everywhere() {
            let numbers = &numbers[..width.lanes()];
            let (got, expected) = (sum(level, width, numbers), tree(numbers, |a, b| a + b));
            let same = got.to_bits() == expected.to_bits() || got.is_nan() && expected.is_nan();
            prop_assert!(same, "{level}: got {got}, expected {expected}");
        }
    }
}

/// The lane types' largest value, as what fills the lanes that are off, is not mistaken for one of them.
#[test]
fn min_index_of_the_largest() -> Result<(), TestCaseError> {
    for mask in [0, 1, 2, 0x8000, 0xfff8, u32::MAX] {
        check_reductions::<f32>(&[f32::INFINITY.to_bits(); 16], mask)?;
        check_reductions::<f32>(&[f32::NAN.to_bits(); 16], mask)?;
        check_reductions::<i32>(&[i32::MAX as u32; 16], mask)?;
        check_reductions::<u32>(&[u32::MAX; 16], mask)?;
    }
    Ok(())
}
