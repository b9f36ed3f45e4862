//! Work written once for every vector width, and the choice of one.

use simd::{Float, Isa, Kernel, Level, Simd};
use std::fmt;
use std::str::FromStr;

/// Rays per packet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Width {
    /// A single ray, in `f32`.
    One,
    /// Four: the paper's.
    Four,
    /// Eight.
    Eight,
    /// Sixteen.
    Sixteen,
    /// What is fastest at the level.
    #[default]
    Auto,
}

impl Width {
    /// The number of rays at this level.
    #[must_use]
    pub fn lanes(self, level: Level) -> usize {
        match self {
            Self::One => 1,
            Self::Four => 4,
            Self::Eight => 8,
            Self::Sixteen => 16,
            Self::Auto => level.isa().lanes(),
        }
    }
}

impl FromStr for Width {
    type Err = String;
    fn from_str(s: &str) -> Result<Self, String> {
        match s {
            "1" => Ok(Self::One),
            "4" => Ok(Self::Four),
            "8" => Ok(Self::Eight),
            "16" => Ok(Self::Sixteen),
            "auto" => Ok(Self::Auto),
            _ => Err(format!("unknown width '{s}'; known: auto, 1, 4, 8, 16")),
        }
    }
}

impl fmt::Display for Width {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::One => "1",
            Self::Four => "4",
            Self::Eight => "8",
            Self::Sixteen => "16",
            Self::Auto => "auto",
        })
    }
}

/// Work that is generic over the vector type alone.
pub(crate) trait Lanes {
    type Output;

    /// With vectors of type `F`. Mark it `#[inline(always)]`.
    fn run<F: Float>(self) -> Self::Output;
}

/// Work that is generic over the vector type, and wants the level's others beside it.
pub(crate) trait SimdLanes {
    type Output;

    /// With vectors of type `F`. Mark it `#[inline(always)]`.
    fn run<S: Simd, F: Float>(self) -> Self::Output;
}

/// Numbers of the blocks and of their chunks, for vectors of type `F`. One loop instead of two, which would be unrolled.
#[inline(always)]
pub(crate) fn chunks<F: Float>(blocks: usize) -> impl Iterator<Item = (usize, usize)> {
    let per_block = 16 / F::LANES;
    (0..blocks * per_block).map(move |i| (i / per_block, i % per_block))
}

/// Level serial is there to be compared with float4: eight and sixteen fenced lanes would be a quarter of all machine code, and run as at level scalar.
pub(crate) const fn is_serial<S: Simd>() -> bool {
    matches!(S::LEVEL.isa(), Isa::Serial)
}

/// Runs `job` at a level with vectors of `lanes` lanes: 1 (plain `f32`, whatever the level), 4, 8 or 16.
pub(crate) fn run<J: Lanes>(level: Level, lanes: usize, job: J) -> J::Output {
    if lanes == 1 { job.run::<f32>() } else { level.run(Run::<_, _, false>(OfLanes(lanes), Alone(job))) }
}

/// [`run`] with the instructions that the whole program is compiled for, and no others: for work whose speed does not matter much.
pub(crate) fn run_once<J: Lanes>(lanes: usize, job: J) -> J::Output {
    if lanes == 1 { job.run::<f32>() } else { Level::run_native(Run::<_, _, false>(OfLanes(lanes), Alone(job))) }
}

/// Runs `job` with the registers of the level; with plain `f32` for [`Width::One`].
pub(crate) fn run_native<J: Lanes>(level: Level, width: Width, job: J) -> J::Output {
    if width == Width::One { job.run::<f32>() } else { level.run(Run::<_, _, false>(Native, Alone(job))) }
}

/// [`run`] for functions of which it is known that emulated levels are no use: there with plain `f32`, whatever the number of lanes. The bits are
/// the same.
pub(crate) fn run_plain_if_emulated<J: Lanes>(level: Level, lanes: usize, job: J) -> J::Output {
    run_simd(level, lanes, Alone(job))
}

/// [`run_native`] for long functions: at emulated levels too with plain `f32`, because their vectors become many times as much code. The bits
/// are the same.
pub(crate) fn run_long<J: Lanes>(level: Level, width: Width, job: J) -> J::Output {
    let level = if width == Width::One { Level::SCALAR } else { level };
    run_simd_native(level, Alone(job))
}

/// Runs `job` with vectors of eight lanes, at emulated levels with plain `f32`.
pub(crate) fn run_eight<J: Lanes>(level: Level, job: J) -> J::Output {
    level.run(Run::<_, _, true>(Eight, Alone(job)))
}

/// As [`run_plain_if_emulated`].
pub(crate) fn run_simd<J: SimdLanes>(level: Level, lanes: usize, job: J) -> J::Output {
    let level = if lanes == 1 { Level::SCALAR } else { level };
    level.run(Run::<_, _, true>(OfLanes(lanes), job))
}

/// [`run_simd`] with the registers of the level.
pub(crate) fn run_simd_native<J: SimdLanes>(level: Level, job: J) -> J::Output {
    level.run(Run::<_, _, true>(Native, job))
}

/// A job that needs no other vectors.
struct Alone<J>(J);

impl<J: Lanes> SimdLanes for Alone<J> {
    type Output = J::Output;

    #[inline(always)]
    fn run<S: Simd, F: Float>(self) -> J::Output {
        self.0.run::<F>()
    }
}

/// Which vectors a job is given.
trait Vectors {
    fn run<S: Simd, J: SimdLanes>(self, job: J) -> J::Output;
}

/// The registers of the level.
struct Native;

impl Vectors for Native {
    #[inline(always)]
    fn run<S: Simd, J: SimdLanes>(self, job: J) -> J::Output {
        job.run::<S, S::Float>()
    }
}

/// Eight lanes.
struct Eight;

impl Vectors for Eight {
    #[inline(always)]
    fn run<S: Simd, J: SimdLanes>(self, job: J) -> J::Output {
        job.run::<S, S::Float8>()
    }
}

/// As many lanes: 4, 8 or 16.
struct OfLanes(usize);

impl Vectors for OfLanes {
    #[inline(always)]
    fn run<S: Simd, J: SimdLanes>(self, job: J) -> J::Output {
        match self.0 {
            4 => job.run::<S, S::Float4>(),
            _ if const { is_serial::<S>() } => Level::SCALAR.run(Run::<_, _, false>(self, job)),
            8 => job.run::<S, S::Float8>(),
            _ => job.run::<S, S::Float16>(),
        }
    }
}

/// A job with the vectors that it is given; where it shall be plain if emulated, with `f32` in plain Rust instead of emulated ones.
struct Run<V, J, const PLAIN_IF_EMULATED: bool>(V, J);

impl<V: Vectors, J: SimdLanes, const PLAIN_IF_EMULATED: bool> Kernel for Run<V, J, PLAIN_IF_EMULATED> {
    type Output = J::Output;

    #[inline(always)]
    fn run<S: Simd>(self) -> J::Output {
        // What is compiled for emulated levels is decided here, by constants: it is many times as much code.
        if const { PLAIN_IF_EMULATED && is_serial::<S>() } {
            Level::SCALAR.run(self)
        } else if const { PLAIN_IF_EMULATED && matches!(S::LEVEL.isa(), Isa::Scalar) } {
            self.1.run::<S, f32>()
        } else {
            self.0.run::<S, J>(self.1)
        }
    }
}
