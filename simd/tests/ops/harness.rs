//! Levels times widths, and operations lane by lane against an expression in plain Rust.

use crate::golden::Hash;
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
    #[cfg(target_family = "wasm")]
    crate::message::keep();
    let widths = [Width::One, Width::Four, Width::Eight, Width::Sixteen];
    Level::available().flat_map(move |level| widths.map(|width| (level, width)))
}

/// Whether the relaxed operations are fused there, as documented. Where that is left open there are two possibilities.
pub fn fused(level: Level, width: Width) -> &'static [bool] {
    match level.isa() {
        _ if width == Width::One => &[false],
        Isa::Avx2 | Isa::Avx512 | Isa::Neon | Isa::Vsx => &[true],
        Isa::WasmRelaxed => &[false, true],
        _ => &[false],
    }
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

/// The bit patterns of a vector; a narrow one has the first lanes.
pub type Lanes = [u32; 16];

/// An operation, on up to three arguments, at a level and width.
pub type Run<'a> = &'a dyn Fn(Level, Width, &[Lanes; 3], &mut Lanes);

/// Runs the operation everywhere on all inputs and compares every lane with what is expected of (fused, its arguments). Where
/// it may be fused or not, it has to be the one or the other on all inputs.
/// What is strict has to match its golden hash, too.
pub fn check(
    name: &str,
    strict: bool,
    arity: usize,
    run: Run<'_>,
    same: fn(u32, u32) -> bool,
    expected: &dyn Fn(bool, [u32; 3]) -> u32,
) {
    let rows = values::rows(arity);
    let of_all = |fused| rows.iter().map(|&row| expected(fused, row)).collect::<Vec<_>>();
    let expected = [of_all(false), of_all(true)];
    for (level, width) in everywhere() {
        let lanes = width.lanes();
        let mut hash = Hash::new();
        let mut first_difference = |expected: &[u32]| {
            rows.chunks_exact(lanes).zip(expected.chunks_exact(lanes)).find_map(|(rows, expected)| {
                let arguments = std::array::from_fn(|k| std::array::from_fn(|lane| rows[lane % lanes][k]));
                // Whatever an operation leaves unwritten will not pass for its result.
                let mut out = [0xdead_beef; 16];
                run(level, width, &arguments, &mut out);
                // Whether NaN are told apart.
                let exact = !same(0x7fc0_0000, 0x7fc0_0001);
                out[..lanes].iter().for_each(|&x| if exact { hash.add(x) } else { hash.add_number(x) });
                let i = (0..lanes).find(|&i| !same(out[i], expected[i]))?;
                let of = rows[i][..arity].iter().map(|&x| readings(x)).collect::<Vec<_>>().join(" and ");
                let (got, want) = (readings(out[i]), readings(expected[i]));
                Some(format!("{level}, {lanes} lanes, lane {i}: of {of} got {got}, expected {want}"))
            })
        };
        let mut differences = Vec::new();
        let passes = fused(level, width).iter().any(|&fused| {
            let difference = first_difference(&expected[usize::from(fused)]);
            let none = difference.is_none();
            differences.extend(difference);
            none
        });
        assert!(passes, "{}", differences.join("; or if fused: "));
        if strict {
            hash.check(level, name, lanes);
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
///
/// One kernel serves all operations of an invocation, on one vector: a kernel for each, with a loop over many, would be
/// optimized at every level and width, for minutes.
macro_rules! operations {
    ($($name:ident($($x:ident: $kind:ident),+) -> $out:ident $vector:block is $(relaxed($fused:ident))? $number:block)*) => {
        #[derive(Clone, Copy)]
        #[allow(non_camel_case_types, reason = "named as the tests")]
        enum Operation {
            $($name),*
        }

        #[inline(always)]
        fn body<F: simd::Float>(operation: Operation, arguments: &[$crate::harness::Lanes; 3], out: &mut $crate::harness::Lanes) {
            use simd::Vector;
            let [a, b, c] = arguments;
            let arguments = [F::Index::load(a), F::Index::load(b), F::Index::load(c)];
            let result = match operation {
                $(Operation::$name => {
                    let [$($x,)+ ..] = arguments;
                    $(let $x = vector_of!($kind, $x);)+
                    bits_of_vector!($out, $vector)
                })*
            };
            result.store(out);
        }

        simd::kernel! {
            fn run<S>(
                width: $crate::harness::Width, operation: Operation,
                arguments: &[$crate::harness::Lanes; 3], out: &mut $crate::harness::Lanes
            ) {
                at_width!(S, width, body(operation, arguments, out))
            }
        }

        $(#[test]
        fn $name() {
            let arity = [$(stringify!($x)),+].len();
            let run = |level, width, arguments: &_, out: &mut _| run(level, width, Operation::$name, arguments, out);
            let relaxed: &[&str] = &[$(stringify!($fused))?];
            let name = concat!(module_path!(), "::", stringify!($name)).trim_start_matches("ops::");
            $crate::harness::check(name, relaxed.is_empty(), arity, &run, comparison!($out), &|_fused, [$($x,)+ ..]| {
                $(let $x = number_of!($kind, $x);)+
                $(let $fused = _fused;)?
                bits_of_number!($out, $number)
            });
        })*
    };
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
        <F::Index as simd::Vector>::eq(
            ($bits) & <F::Index as simd::Vector>::splat(1),
            <F::Index as simd::Vector>::splat(1),
        )
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
        <F::Index as simd::Vector>::select(
            $x,
            <F::Index as simd::Vector>::splat(1),
            <F::Index as simd::Vector>::splat(0),
        )
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
