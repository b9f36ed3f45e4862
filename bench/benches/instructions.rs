//! Instructions of the eight kernels of `simd_peers` in the crate `simd`, level by level, as callgrind counts them: a figure that
//! neither the load of the machine nor its clock changes. Up to AVX2, which is what valgrind runs.
//!
//! ```text
//! bench/instructions.sh             counts, and compares with the accepted counts in bench/instructions.txt
//! bench/instructions.sh --accept    counts, and accepts what was counted
//! ```

#![allow(missing_docs, reason = "of what the macros make")]

use gungraun::{library_benchmark, library_benchmark_group, main};
use simd::{Isa, Level};
use std::hint::black_box;

#[path = "simd_peers/main.rs"]
#[allow(dead_code, reason = "the peers, and Criterion's main")]
mod simd_peers;

/// What a kernel works on.
type Ready<I, O> = (Level, Box<I>, Box<O>);

fn ready<I, O>(isa: Isa, (input, output): (I, O)) -> Ready<I, O> {
    let level = Level::new(isa).unwrap_or_else(|| panic!("level {isa} is not to be had under valgrind here"));
    (level, Box::new(input), Box::new(output))
}

macro_rules! kernels {
    ($($kernel:ident)*) => {
        $(
            #[library_benchmark]
            #[bench::serial(ready(Isa::Serial, simd_peers::$kernel::input()))]
            #[bench::sse2(ready(Isa::Sse2, simd_peers::$kernel::input()))]
            #[bench::sse4_2(ready(Isa::Sse42, simd_peers::$kernel::input()))]
            #[bench::avx2(ready(Isa::Avx2, simd_peers::$kernel::input()))]
            fn $kernel((level, input, mut output): Ready<simd_peers::$kernel::Input, simd_peers::$kernel::Output>) -> Ready<simd_peers::$kernel::Input, simd_peers::$kernel::Output> {
                simd_peers::$kernel::with_simd(level, black_box(&input), black_box(&mut output));
                // Dropped behind the count.
                (level, input, output)
            }
        )*
        library_benchmark_group!(name = kernels, benchmarks = [$($kernel),*]);
    };
}
kernels!(slab triangle mandelbrot dot transpose compress sin_cos gather);
main!(library_benchmark_groups = kernels);
