//! Levels times widths, and operations lane by lane against an expression in plain Rust.

use crate::values;
use simd::{Isa, Level};

/// Number of lanes: one lane is plain `f32`, `Wrapping<i32>`, `Wrapping<u32>` and `bool`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Width {
    One,
    Four,
    Eight,
    Sixteen,
}

impl Width {
    pub fn lanes(self) -> usize {
        match self {
            Self::One => 1,
            Self::Four => 4,
            Self::Eight => 8,
            Self::Sixteen => 16,
        }
    }
}

/// Every level of this CPU with every width.
pub fn everywhere() -> impl Iterator<Item = (Level, Width)> {
    let widths = [Width::One, Width::Four, Width::Eight, Width::Sixteen];
    Level::available().flat_map(move |level| widths.map(|width| (level, width)))
}

/// Whether the relaxed operations are documented to be fused there.
pub fn fused(level: Level, width: Width) -> bool {
    width != Width::One && matches!(level.isa(), Isa::Avx2 | Isa::Avx512 | Isa::Neon)
}

/// Calls a function generic over `Float` with the type of set `$S` and that width.
macro_rules! at_width {
    ($S:ident, $width:expr, $body:ident($($arg:expr),*)) => {
        match $width {
            $crate::harness::Width::One => $body::<f32>($($arg),*),
            $crate::harness::Width::Four => $body::<$S::Float4>($($arg),*),
            $crate::harness::Width::Eight => $body::<$S::Float8>($($arg),*),
            $crate::harness::Width::Sixteen => $body::<$S::Float16>($($arg),*),
        }
    };
}

/// An operation on columns of bit patterns, a kernel.
pub type Run = fn(Level, Width, &[Vec<u32>], &mut [u32]);

/// Runs the operation everywhere on all inputs and compares every lane with what is expected of (fused, its arguments).
pub fn check(arity: usize, run: Run, same: fn(u32, u32) -> bool, expected: &dyn Fn(bool, &[u32]) -> u32) {
    let columns = values::columns(arity);
    let row = |i: usize| columns.iter().map(|column| column[i]).collect::<Vec<_>>();
    let rows = columns[0].len();
    let of_all = |fused| (0..rows).map(|i| expected(fused, &row(i))).collect::<Vec<_>>();
    let expected = [of_all(false), of_all(true)];
    for (level, width) in everywhere() {
        // Whatever an operation leaves unwritten will not pass for its result.
        let mut out: Vec<u32> = (0..rows as u32).map(|i| i.wrapping_mul(0x9e37_79b9)).collect();
        run(level, width, &columns, &mut out);
        let expected = &expected[usize::from(fused(level, width))];
        if let Some(i) = (0..rows).find(|&i| !same(out[i], expected[i])) {
            let (got, want, lanes) = (out[i], expected[i], width.lanes());
            panic!(
                "{level}, {lanes} lanes, lane {}: of {} got {}, expected {}",
                i % lanes,
                row(i).into_iter().map(readings).collect::<Vec<_>>().join(" and "),
                readings(got),
                readings(want)
            );
        }
    }
}

/// A bit pattern as what it may stand for.
fn readings(bits: u32) -> String {
    format!("{bits:#010x} ({:e}, {})", f32::from_bits(bits), bits as i32)
}

pub fn same_bits(a: u32, b: u32) -> bool {
    a == b
}

/// Which NaN it is may differ.
pub fn same_number(a: u32, b: u32) -> bool {
    a == b || (f32::from_bits(a).is_nan() && f32::from_bits(b).is_nan())
}

/// Tests of lane-wise operations: `name(arguments) -> result { on vectors } is { on numbers }`. In the first block `F` is the
/// `Float` type of the width. Types: `float`, `int`, `uint`, `mask`, and as a result `exact_float`, whose NaN are compared too.
/// `relaxed(fused)` names a variable for the second block: whether to expect one rounding.
macro_rules! operations {
    ($($name:ident($($x:ident: $kind:ident),+) -> $out:ident $vector:block is $(relaxed($fused:ident))? $number:block)*) => {$(
        #[test]
        fn $name() {
            #[inline(always)]
            fn body<F: simd::Float>(columns: &[Vec<u32>], out: &mut [u32]) {
                use simd::Vector;
                for at in (0..out.len()).step_by(F::LANES) {
                    let mut column = columns.iter();
                    $(let $x = vector_of!($kind, <F::Index as Vector>::load(&column.next().unwrap()[at..]));)+
                    <F::Index as Vector>::store(bits_of_vector!($out, $vector), &mut out[at..]);
                }
            }
            simd::kernel! {
                fn run<S>(width: $crate::harness::Width, columns: &[Vec<u32>], out: &mut [u32]) {
                    at_width!(S, width, body(columns, out))
                }
            }
            let arguments = [$(stringify!($x)),+];
            $crate::harness::check(arguments.len(), run, comparison!($out), &|_fused, row| {
                let mut row = row.iter();
                $(let $x = number_of!($kind, *row.next().unwrap());)+
                $(let $fused = _fused;)?
                bits_of_number!($out, $number)
            });
        }
    )*};
}

/// An argument of the vector expression.
macro_rules! vector_of {
    (float, $bits:expr) => {
        F::from_bits($bits)
    };
    (int, $bits:expr) => {
        <F::Int as simd::Int>::from_uint($bits)
    };
    (uint, $bits:expr) => {
        $bits
    };
    (mask, $bits:expr) => {
        <F::Index as simd::Vector>::eq($bits & F::Index::splat(1), F::Index::splat(1))
    };
}

/// The same argument of the expression in plain Rust.
macro_rules! number_of {
    (float, $bits:expr) => {
        f32::from_bits($bits)
    };
    (int, $bits:expr) => {
        $bits as i32
    };
    (uint, $bits:expr) => {
        $bits
    };
    (mask, $bits:expr) => {
        $bits & 1 == 1
    };
}

macro_rules! bits_of_vector {
    (float, $x:expr) => {
        F::to_bits($x)
    };
    (exact_float, $x:expr) => {
        F::to_bits($x)
    };
    (int, $x:expr) => {
        <F::Int as simd::Int>::to_uint($x)
    };
    (uint, $x:expr) => {
        $x
    };
    (mask, $x:expr) => {
        <F::Index as simd::Vector>::select($x, F::Index::splat(1), F::Index::splat(0))
    };
}

macro_rules! bits_of_number {
    (float, $x:expr) => {
        f32::to_bits($x)
    };
    (exact_float, $x:expr) => {
        f32::to_bits($x)
    };
    (int, $x:expr) => {
        $x as u32
    };
    (uint, $x:expr) => {
        $x
    };
    (mask, $x:expr) => {
        u32::from($x)
    };
}

macro_rules! comparison {
    (float) => {
        $crate::harness::same_number
    };
    ($other:ident) => {
        $crate::harness::same_bits
    };
}
