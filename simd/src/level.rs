//! Levels: which instruction set to use, found, listed, parsed, forced; and the way into it.

use crate::{Simd, backend};
#[cfg(feature = "alloc")]
use alloc::{borrow::ToOwned, string::String, vec::Vec};
use std::fmt;
#[cfg(feature = "alloc")]
use std::str::FromStr;
#[cfg(feature = "std")]
use std::sync::OnceLock;

/// An instruction set that this crate knows, whether or not this CPU has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[non_exhaustive]
pub enum Isa {
    /// Plain Rust, one lane at a time; LLVM may vectorize it again. The same bits as all others, but on 32-bit x86 without SSE2 (target i586),
    /// whose FPU rounds otherwise.
    Scalar,
    /// Plain Rust, with LLVM kept from vectorizing: the honest emulation that speed-ups are measured against.
    Serial,
    /// x86: SSE and SSE2, four lanes.
    Sse2,
    /// x86-64-v2: SSE4.2, SSSE3, POPCNT, four lanes.
    Sse42,
    /// x86-64-v3: AVX2, FMA, BMI1, BMI2, LZCNT, F16C, eight lanes.
    Avx2,
    /// x86-64-v4: AVX-512 F, BW, CD, DQ and VL (Skylake-X and later), sixteen lanes, mask registers.
    Avx512,
    /// ARM: Advanced SIMD, four lanes.
    Neon,
    /// powerpc64le: AltiVec and VSX of POWER8, four lanes. With the cargo feature `vsx`, which needs nightly Rust.
    Vsx,
    /// WebAssembly: SIMD, four lanes. Not detected but compiled in: `-C target-feature=+simd128`.
    Wasm,
    /// WebAssembly: relaxed SIMD, four lanes: `-C target-feature=+relaxed-simd`. Whether the relaxed operations are fused there
    /// is up to the engine. In such a build LLVM 22 may compile `if a < b { a } else { b }` in plain
    /// Rust to a relaxed minimum, [`Isa::Scalar`] included: of NaN and a number, or of zeros, it is either.
    WasmRelaxed,
}

impl Isa {
    /// All of them, slowest first.
    pub const ALL: [Self; 10] = [
        Self::Serial,
        Self::Scalar,
        Self::Sse2,
        Self::Sse42,
        Self::Avx2,
        Self::Avx512,
        Self::Neon,
        Self::Vsx,
        Self::Wasm,
        Self::WasmRelaxed,
    ];

    /// The name that [`Level::from_str`] and `SIMD_LEVEL` take.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Serial => "serial",
            Self::Sse2 => "sse2",
            Self::Sse42 => "sse4.2",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
            Self::Neon => "neon",
            Self::Vsx => "vsx",
            Self::Wasm => "wasm",
            Self::WasmRelaxed => "wasm-relaxed",
        }
    }

    /// Number of `f32` lanes of a register: [`Simd::Float`].
    #[must_use]
    pub const fn lanes(self) -> usize {
        match self {
            Self::Avx2 => 8,
            Self::Avx512 => 16,
            _ => 4,
        }
    }

    /// Whether this build has code for it: a cargo feature, or what the whole program is compiled for.
    #[allow(clippy::match_like_matches_macro, reason = "constants")]
    const fn compiled(self) -> bool {
        match self {
            Self::Sse42 => cfg!(any(feature = "sse4_2", target_feature = "sse4.2")),
            Self::Avx2 => cfg!(any(feature = "avx2", target_feature = "avx2")),
            Self::Avx512 => cfg!(any(feature = "avx512", target_feature = "avx512f")),
            Self::Vsx => cfg!(feature = "vsx"),
            _ => true,
        }
    }

    #[cfg_attr(not(feature = "std"), allow(clippy::nonminimal_bool, reason = "constants, without detection"))]
    fn detected(self) -> bool {
        #[allow(unused_macros, reason = "there are architectures with emulation only")]
        macro_rules! cpu_has {
            ($detect:ident: $($feature:tt)*) => { $(cpu_has!(@ $detect $feature))&&* };
            (@ $detect:ident $feature:tt) => {{
                #[cfg(feature = "std")]
                let has = std::arch::$detect!($feature);
                #[cfg(not(feature = "std"))]
                let has = cfg!(target_feature = $feature);
                has
            }};
        }
        match self {
            Self::Scalar => true,
            Self::Serial => backend::serial::FENCED,
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Sse2 => cpu_has!(is_x86_feature_detected: "sse" "sse2"),
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Sse42 => {
                Self::Sse2.detected() && cpu_has!(is_x86_feature_detected: "sse3" "ssse3" "sse4.1" "sse4.2" "popcnt")
            }
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Avx2 => {
                Self::Sse42.detected()
                    && cpu_has!(is_x86_feature_detected: "avx" "avx2" "fma" "bmi1" "bmi2" "lzcnt" "f16c")
            }
            #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
            Self::Avx512 => {
                Self::Avx2.detected()
                    && cpu_has!(is_x86_feature_detected: "avx512f" "avx512bw" "avx512cd" "avx512dq" "avx512vl")
            }
            #[cfg(target_arch = "aarch64")]
            Self::Neon => cpu_has!(is_aarch64_feature_detected: "neon"),
            // Of the two byte orders the one that is tested.
            #[cfg(all(target_arch = "powerpc64", feature = "vsx"))]
            Self::Vsx => {
                cfg!(target_endian = "little")
                    && cpu_has!(is_powerpc64_feature_detected: "altivec" "vsx" "power8-altivec" "power8-vector")
            }
            // An engine rejects a module with instructions it lacks as a whole: where this runs, it has them.
            #[cfg(target_arch = "wasm32")]
            Self::Wasm => cfg!(target_feature = "simd128"),
            #[cfg(target_arch = "wasm32")]
            Self::WasmRelaxed => cfg!(target_feature = "relaxed-simd"),
            #[allow(unreachable_patterns, reason = "reached by the levels of other architectures")]
            _ => false,
        }
    }
}

impl fmt::Display for Isa {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// An instruction set that this CPU has: the proof of it, made by detection alone.
///
/// ```
/// use simd::{Isa, Level};
/// let level = Level::best();
/// println!("{level}: {} lanes", level.isa().lanes());
/// assert!(Level::new(Isa::Scalar).is_some());
/// # #[cfg(feature = "alloc")]
/// assert!("sse5".parse::<Level>().is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Level(Isa);

impl Level {
    /// The environment variable that forces a level: see [`Level::from_env`].
    #[cfg(feature = "std")]
    pub const ENV: &'static str = "SIMD_LEVEL";
    /// Plain Rust: every machine has it.
    pub const SCALAR: Self = Self(Isa::Scalar);

    /// For the backends, whose code runs only after detection.
    pub(crate) const fn of_backend(isa: Isa) -> Self {
        Self(isa)
    }

    /// This instruction set, if the CPU has it and this build does not leave it out.
    ///
    /// Without feature `std`: if all CPUs that this was compiled for have it.
    #[must_use]
    pub fn new(isa: Isa) -> Option<Self> {
        (isa.compiled() && isa.detected()).then_some(Self(isa))
    }

    /// All that this CPU has, slowest first.
    pub fn available() -> impl DoubleEndedIterator<Item = Self> {
        Isa::ALL.into_iter().filter_map(Self::new)
    }

    /// The fastest that this CPU has.
    #[must_use]
    pub fn best() -> Self {
        Self::available().next_back().unwrap_or(Self::SCALAR)
    }

    /// The level that the environment variable `SIMD_LEVEL` names; [`Level::best`] when it is unset, empty or `auto`.
    ///
    /// # Errors
    /// [`LevelError`] when the name is unknown or this CPU lacks that level.
    #[cfg(feature = "std")]
    pub fn from_env() -> Result<Self, LevelError> {
        match std::env::var(Self::ENV) {
            Ok(name) if !name.is_empty() && name != "auto" => name.parse(),
            _ => Ok(Self::best()),
        }
    }

    /// [`Level::from_env`], asked once per process: further calls cost a few instructions, and later changes of the environment
    /// change nothing.
    ///
    /// ```
    /// // What `SIMD_LEVEL` says; if that cannot be had, say so and take the best.
    /// let level = simd::Level::cached().unwrap_or_else(|error| {
    ///     eprintln!("{error}");
    ///     simd::Level::best()
    /// });
    /// # assert_eq!(simd::Level::cached(), Ok(level));
    /// ```
    ///
    /// # Errors
    /// Those of [`Level::from_env`], the same at each call: a level that is asked for and cannot be had is not replaced silently.
    #[cfg(feature = "std")]
    #[inline]
    pub fn cached() -> Result<Self, LevelError> {
        static LEVEL: OnceLock<Result<Level, LevelError>> = OnceLock::new();
        LEVEL.get_or_init(Self::from_env).clone()
    }

    /// Runs `kernel` with the instructions that the whole program is compiled for ([`native`](crate::native)), and compiles it for nothing
    /// else: for work whose speed does not matter much.
    #[inline(never)]
    pub fn run_native<K: Kernel>(kernel: K) -> K::Output {
        kernel.run::<crate::native::Native>()
    }

    /// Which instruction set it is.
    #[must_use]
    pub const fn isa(self) -> Isa {
        self.0
    }

    /// Runs `kernel` compiled for this level.
    ///
    /// The call costs one predictable branch and cannot be inlined into the caller: make it once per batch, not per element.
    #[inline]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        backend::run(self.0, kernel)
    }
}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

#[cfg(feature = "alloc")]
impl FromStr for Level {
    type Err = LevelError;

    fn from_str(name: &str) -> Result<Self, LevelError> {
        let isa = Isa::ALL.into_iter().find(|isa| isa.name() == name);
        let isa = isa.ok_or_else(|| LevelError::Unknown(name.to_owned()))?;
        Self::new(isa).ok_or(LevelError::Unavailable(isa))
    }
}

/// Why a level cannot be had.
#[cfg(feature = "alloc")]
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum LevelError {
    /// No level has this name.
    Unknown(String),
    /// This CPU (or this build, for another architecture) lacks it.
    Unavailable(Isa),
}

#[cfg(feature = "alloc")]
impl fmt::Display for LevelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = |levels: Vec<&str>| levels.join(", ");
        match self {
            Self::Unknown(name) => {
                write!(f, "unknown level '{name}'; known: auto, {}", names(Isa::ALL.map(Isa::name).to_vec()))
            }
            Self::Unavailable(isa) => {
                let here = Level::available().map(|l| l.0.name()).collect();
                if isa.compiled() {
                    write!(f, "this CPU lacks level '{isa}'; it has: {}", names(here))
                } else {
                    write!(f, "this build leaves out level '{isa}'; it has: {}", names(here))
                }
            }
        }
    }
}

#[cfg(feature = "alloc")]
impl std::error::Error for LevelError {}

/// Code written once, to be run at any [`Level`].
///
/// Mark `run`, and every generic function and closure it reaches, `#[inline(always)]`: what is not inlined is compiled without
/// the level's instructions and passes its vectors through memory. [`kernel!`](crate::kernel) writes the implementation for you.
pub trait Kernel {
    /// What it returns.
    type Output;
    /// The work, with the types of instruction set `S`.
    fn run<S: Simd>(self) -> Self::Output;
}

/// Turns a function generic over [`Simd`] into one that takes the [`Level`] as its first argument.
///
/// ```
/// use simd::{Float, Level, Simd, Vector};
///
/// simd::kernel! {
///     /// `y += a * x`.
///     pub fn saxpy<S>(a: f32, x: &[f32], y: &mut [f32]) {
///         let lanes = S::Float::LANES;
///         for (x, y) in x.chunks_exact(lanes).zip(y.chunks_exact_mut(lanes)) {
///             let sum = S::Float::splat(a) * S::Float::load(x) + S::Float::load(y);
///             sum.store(y);
///         }
///     }
/// }
///
/// let mut y = [1.0; 32];
/// saxpy(Level::best(), 2.0, &[3.0; 32], &mut y);
/// assert_eq!(y, [7.0; 32]);
/// ```
#[macro_export]
macro_rules! kernel {
    ($(#[$meta:meta])* $vis:vis fn $name:ident<$S:ident>($($arg:ident: $ty:ty),* $(,)?) $body:block) => {
        $crate::kernel! { $(#[$meta])* $vis fn $name<$S>($($arg: $ty),*) -> () $body }
    };
    ($(#[$meta:meta])* $vis:vis fn $name:ident<$S:ident>($($arg:ident: $ty:ty),* $(,)?) -> $out:ty $body:block) => {
        $(#[$meta])*
        $vis fn $name(level: $crate::Level, $($arg: $ty),*) -> $out {
            struct Run<Arguments>(Arguments);
            impl $crate::Kernel for Run<($($ty,)*)> {
                type Output = $out;
                #[inline(always)]
                fn run<$S: $crate::Simd>(self) -> $out {
                    let ($($arg,)*) = self.0;
                    $body
                }
            }
            level.run(Run(($($arg,)*)))
        }
    };
}

/// Runs a block at a level; the variables it uses are named, with their types, between the bars.
///
/// ```
/// use simd::{Float, Level, Vector, dispatch};
///
/// let x = [0.5_f32; 16];
/// let x = &x;
/// let sum = dispatch!(Level::best(), |S, x: &[f32; 16]| -> f32 { S::Float16::load(x).reduce_add() });
/// assert_eq!(sum, 8.0);
/// ```
#[macro_export]
macro_rules! dispatch {
    ($level:expr, |$S:ident $(, $arg:ident: $ty:ty)* $(,)?| -> $out:ty $body:block) => {{
        $crate::kernel! { fn run<$S>($($arg: $ty),*) -> $out $body }
        run($level, $($arg),*)
    }};
    ($level:expr, |$S:ident $(, $arg:ident: $ty:ty)* $(,)?| $body:block) => {
        $crate::dispatch!($level, |$S $(, $arg: $ty)*| -> () $body)
    };
}
