//! Every operation at every level of this CPU and every width, bit for bit against plain Rust.

#[macro_use]
mod harness;
mod double;
mod estimates;
mod float;
mod golden;
mod integer;
mod lanes;
mod mask;
mod math;
mod memory;
#[cfg(target_family = "wasm")]
mod message;
mod narrow;
mod values;

use harness::{Width, everywhere};
use simd::{Isa, Level, Vector};
use std::any::TypeId;
use std::io::Write;

simd::kernel! {
    fn level_inside<S>() -> Level {
        S::LEVEL
    }
}

/// WebAssembly without a system has no environment when it runs.
fn required_levels() -> String {
    #[cfg(target_family = "wasm")]
    return option_env!("SIMD_TEST_LEVELS").unwrap_or_default().to_owned();
    #[cfg(not(target_family = "wasm"))]
    std::env::var("SIMD_TEST_LEVELS").unwrap_or_default()
}

/// Says what ran, past the test harness, which shows the output of failed tests only. The variable `SIMD_TEST_LEVELS`
/// lists levels that have to be there.
#[test]
fn levels() {
    for level in Level::available() {
        assert_eq!(level_inside(level), level);
    }
    let (ran, missing): (Vec<Isa>, Vec<Isa>) = Isa::ALL.into_iter().partition(|&isa| Level::new(isa).is_some());
    let names = |isas: &[Isa]| isas.iter().map(|isa| isa.name()).collect::<Vec<_>>().join(", ");
    let report = format!("levels run: {}; levels missing on this CPU: {}", names(&ran), names(&missing));
    // A closed stderr is no reason to fail.
    let _ = writeln!(std::io::stderr().lock(), "{report}");

    let required = required_levels();
    for name in required.split(',').map(str::trim).filter(|name| !name.is_empty()) {
        assert!(ran.iter().any(|isa| isa.name() == name), "SIMD_TEST_LEVELS asks for '{name}'; {report}");
    }
}

simd::kernel! {
    /// The lanes of the native type, and whether it is the type of that width.
    fn native<S>() -> (usize, bool) {
        let fixed = match S::Float::LANES {
            4 => TypeId::of::<S::Float4>(),
            8 => TypeId::of::<S::Float8>(),
            _ => TypeId::of::<S::Float16>(),
        };
        (S::Float::LANES, fixed == TypeId::of::<S::Float>())
    }
}

/// The native width is one of the others under another name: what holds for those holds for it.
#[test]
fn native_width() {
    for level in Level::available() {
        assert_eq!(native(level), (level.isa().lanes(), true), "{level}");
    }
}

simd::kernel! {
    fn lanes_of_width<S>(width: Width) -> [usize; 4] {
        use simd::{Float, Mask};
        #[inline(always)]
        fn lanes<F: Float>() -> [usize; 4] {
            [F::LANES, F::Int::LANES, F::Index::LANES, F::Mask::LANES]
        }
        at_width!(S, width, lanes())
    }
}

#[test]
fn lanes_of_widths() {
    for (level, width) in everywhere() {
        assert_eq!(lanes_of_width(level, width), [width.lanes(); 4], "{level}");
    }
}
