//! The crate `simd` beside hand-written intrinsics, `wide`, `pulp`, `fearless_simd` and what LLVM makes of plain Rust: eight
//! kernels, one file each, the contestants as functions in it.
//!
//! ```text
//! bench/simd_peers.sh                          # all contestants in rounds, and the table
//! cargo bench -p bench --bench simd_peers      # one round, with Criterion's plots in target/criterion
//! ```
//!
//! - `simd`, `pulp` and `fearless_simd` are dispatched at run time: one row per level.
//! - `wide` has no dispatch: it is what the build's target features make it. In a plain build that is SSE2, and the row says so;
//!   the script adds its rows from builds for AVX2 and, where the machine has it, AVX-512.
//! - `intrinsics` are the limit: `std::arch`, without checks at run time.
//! - `plain` is Rust without any of them, compiled for the level.
//!
//! All do the same arithmetic, unfused and in the same order, on the same inputs, and are checked before they are timed: bit for
//! bit against plain Rust, but for `sin_cos`, where it is 2e-6 against the `f64` of the standard library. No NaN is among the
//! inputs. A kernel that a peer lacks the operation for (gather, say) is left out.
//!
//! `instructions.rs` counts the instructions of the `simd` rows.

pub(crate) mod compress;
pub(crate) mod dot;
pub(crate) mod gather;
pub(crate) mod mandelbrot;
pub(crate) mod sin_cos;
pub(crate) mod slab;
pub(crate) mod transpose;
pub(crate) mod triangle;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use simd::{Isa, Level};
use std::arch::x86_64::*;
use std::hint::black_box;

/// On a boundary of 64 bytes: no vector crosses a cache line.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(64))]
pub(crate) struct Aligned<T>(pub T);

/// As many as a kernel takes.
pub(crate) type Floats<const N: usize> = Aligned<[f32; N]>;

/// Numbers between 0 and 1 that look random.
pub(crate) fn noise(i: usize) -> f32 {
    let x = (i as u32).wrapping_mul(0x9e37_79b9) ^ 0x5bd1_e995;
    ((x ^ x >> 15).wrapping_mul(0x85eb_ca6b) >> 8) as f32 / 16_777_216.0
}

/// A contestant: from the input to the output.
pub(crate) trait Run<I, O>: Fn(&I, &mut O) {}
impl<I, O, F: Fn(&I, &mut O)> Run<I, O> for F {}

type Check<I, O> = Box<dyn Fn(&I, &O) -> bool>;

/// Contestants of one kernel.
pub(crate) struct Contest<'a, I, O> {
    group: BenchmarkGroup<'a, WallTime>,
    input: Box<I>,
    output: Box<O>,
    blank: O,
    check: Check<I, O>,
}

impl<'a, I, O: Clone> Contest<'a, I, O> {
    /// `elements` are handled in a run, from `input` to what is `blank` before; `check` says whether the output is right.
    pub(crate) fn new(
        criterion: &'a mut Criterion,
        kernel: &str,
        elements: usize,
        (input, blank): (I, O),
        check: impl Fn(&I, &O) -> bool + 'static,
    ) -> Self {
        let mut group = criterion.benchmark_group(kernel);
        group.throughput(Throughput::Elements(elements as u64));
        let output = Box::new(blank.clone());
        Self { group, input: Box::new(input), output, blank, check: Box::new(check) }
    }

    /// Checks a contestant, then times it.
    pub(crate) fn enter(&mut self, who: &str, level: &str, run: impl Run<I, O>) {
        *self.output = self.blank.clone();
        run(&self.input, &mut self.output);
        assert!((self.check)(&self.input, &self.output), "{who} at {level}: a wrong result");
        let (input, output) = (&*self.input, &mut *self.output);
        self.group
            .bench_function(BenchmarkId::new(who, level), |b| b.iter(|| run(black_box(input), black_box(output))));
    }

    /// A kernel of the crate `simd`, from SSE4.2 up.
    pub(crate) fn simd(&mut self, run: impl Fn(Level, &I, &mut O)) {
        for level in [Isa::Sse42, Isa::Avx2, Isa::Avx512].into_iter().filter_map(Level::new) {
            self.enter("simd", level.isa().name(), |i: &I, o: &mut O| run(level, i, o));
        }
    }

    /// Functions that ask for no more than AVX2 with FMA, BMI1 and 2, LZCNT, and AVX-512 with F, BW, DQ and VL.
    pub(crate) fn intrinsics(&mut self, avx2: unsafe fn(&I, &mut O), avx512: unsafe fn(&I, &mut O)) {
        if Level::new(Isa::Avx2).is_some() {
            // SAFETY: the level is there, and with it what the function asks for.
            self.enter("intrinsics", "avx2", |i: &I, o: &mut O| unsafe { avx2(i, o) });
        }
        if Level::new(Isa::Avx512).is_some() {
            // SAFETY: as above.
            self.enter("intrinsics", "avx512", |i: &I, o: &mut O| unsafe { avx512(i, o) });
        }
    }

    /// Plain Rust, always inlined, compiled for the build's target features, and for two levels.
    pub(crate) fn plain(&mut self, run: impl Run<I, O>) {
        self.enter("plain", "baseline", &run);
        if Level::new(Isa::Avx2).is_some() {
            // SAFETY: the level is there, and with it what the function asks for.
            self.enter("plain", "avx2", |i: &I, o: &mut O| unsafe { for_avx2(&run, i, o) });
        }
        if Level::new(Isa::Avx512).is_some() {
            // SAFETY: as above.
            self.enter("plain", "avx512", |i: &I, o: &mut O| unsafe { for_avx512(&run, i, o) });
        }
    }

    /// `pulp`, at the instruction sets it may dispatch to.
    pub(crate) fn pulp(&mut self, run: impl Fn(pulp::Arch, &I, &mut O)) {
        let (v3, v4) = (pulp::x86::V3::try_new(), pulp::x86::V4::try_new());
        let levels = [("avx2", v3.map(pulp::Arch::V3)), ("avx512", v4.map(pulp::Arch::V4))];
        for (name, arch) in levels.into_iter().filter_map(|(name, arch)| Some((name, arch?))) {
            self.enter("pulp", name, |i: &I, o: &mut O| run(arch, i, o));
        }
    }

    /// `fearless_simd`, at the instruction sets it may dispatch to.
    pub(crate) fn fearless(&mut self, run: impl Fn(fearless_simd::Level, &I, &mut O)) {
        use fearless_simd::Level;
        let best = Level::new();
        let levels = [
            ("sse4.2", best.as_sse4_2().map(Level::Sse4_2)),
            ("avx2", best.as_avx2().map(Level::Avx2)),
            ("avx512", best.as_avx512().map(Level::Avx512)),
        ];
        for (name, level) in levels.into_iter().filter_map(|(name, level)| Some((name, level?))) {
            self.enter("fearless_simd", name, |i: &I, o: &mut O| run(level, i, o));
        }
    }

    /// `wide`, as this build has it.
    pub(crate) fn wide(&mut self, run: impl Run<I, O>) {
        self.enter("wide", wide_type::LEVEL, run);
    }
}

#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt")]
fn for_avx2<I, O>(run: &impl Run<I, O>, input: &I, output: &mut O) {
    run(input, output);
}

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,fma,bmi1,bmi2,lzcnt")]
fn for_avx512<I, O>(run: &impl Run<I, O>, input: &I, output: &mut O) {
    run(input, output);
}

/// The vectors of `wide` that fit the registers of this build.
pub(crate) mod wide_type {
    #[cfg(target_feature = "avx512f")]
    mod fits {
        pub(crate) type F = wide::f32x16;
        pub(crate) const LANES: usize = 16;
        pub(crate) const LEVEL: &str = "avx512 build";
    }
    #[cfg(all(target_feature = "avx2", not(target_feature = "avx512f")))]
    mod fits {
        pub(crate) type F = wide::f32x8;
        pub(crate) const LANES: usize = 8;
        pub(crate) const LEVEL: &str = "avx2 build";
    }
    #[cfg(not(target_feature = "avx2"))]
    mod fits {
        pub(crate) type F = wide::f32x4;
        pub(crate) const LANES: usize = 4;
        pub(crate) const LEVEL: &str = if cfg!(target_feature = "sse4.1") { "sse4.2 build" } else { "sse2 build" };
    }
    pub(crate) use fits::*;

    /// Vector number `i`.
    #[inline(always)]
    pub(crate) fn load(floats: &[f32], i: usize) -> F {
        F::new(floats.as_chunks().0[i])
    }

    #[inline(always)]
    pub(crate) fn store(x: F, floats: &mut [f32], i: usize) {
        floats.as_chunks_mut().0[i] = x.to_array();
    }
}

#[inline]
#[target_feature(enable = "avx")]
pub(crate) fn load8(x: &[f32; 8]) -> __m256 {
    // SAFETY: eight to read.
    unsafe { _mm256_loadu_ps(x.as_ptr()) }
}

#[inline]
#[target_feature(enable = "avx")]
pub(crate) fn store8(x: __m256, to: &mut [f32; 8]) {
    // SAFETY: eight to write.
    unsafe { _mm256_storeu_ps(to.as_mut_ptr(), x) }
}

#[inline]
#[target_feature(enable = "avx512f")]
pub(crate) fn load16(x: &[f32; 16]) -> __m512 {
    // SAFETY: sixteen to read.
    unsafe { _mm512_loadu_ps(x.as_ptr()) }
}

#[inline]
#[target_feature(enable = "avx512f")]
pub(crate) fn store16(x: __m512, to: &mut [f32; 16]) {
    // SAFETY: sixteen to write.
    unsafe { _mm512_storeu_ps(to.as_mut_ptr(), x) }
}

criterion_group!(
    benches,
    slab::contest,
    triangle::contest,
    mandelbrot::contest,
    dot::contest,
    transpose::contest,
    compress::contest,
    sin_cos::contest,
    gather::contest
);
criterion_main!(benches);
