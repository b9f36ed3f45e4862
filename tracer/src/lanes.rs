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

/// Numbers of the blocks and of their chunks, for vectors of type `F`. One loop instead of two, which would be unrolled.
#[inline(always)]
pub(crate) fn chunks<F: Float>(blocks: usize) -> impl Iterator<Item = (usize, usize)> {
    let per_block = 16 / F::LANES;
    (0..blocks * per_block).map(move |i| (i / per_block, i % per_block))
}

/// Runs `job` at a level with vectors of `lanes` lanes: 1 (plain `f32`, whatever the level), 4, 8 or 16.
pub(crate) fn run<J: Lanes>(level: Level, lanes: usize, job: J) -> J::Output {
    if lanes == 1 { job.run::<f32>() } else { level.run(AtWidth { lanes, job }) }
}

/// [`run`] for functions of which it is known that emulated levels are no use: there with plain `f32`, whatever the number of lanes. The bits are
/// the same.
pub(crate) fn run_plain_if_emulated<J: Lanes>(level: Level, lanes: usize, job: J) -> J::Output {
    if lanes == 1 { plain(job) } else { level.run(AtWidthOrPlain { lanes, job }) }
}

struct AtWidthOrPlain<J> {
    lanes: usize,
    job: J,
}

impl<J: Lanes> Kernel for AtWidthOrPlain<J> {
    type Output = J::Output;

    #[inline(always)]
    fn run<S: Simd>(self) -> J::Output {
        // Not by way of `AtWidth`, which would be compiled for emulated levels after all.
        if const { matches!(S::LEVEL.isa(), Isa::Serial | Isa::Scalar) } {
            return plain(self.job);
        }
        match self.lanes {
            4 => self.job.run::<S::Float4>(),
            8 => self.job.run::<S::Float8>(),
            _ => self.job.run::<S::Float16>(),
        }
    }
}

/// Runs `job` with vectors of eight lanes, at emulated levels with plain `f32`.
pub(crate) fn run_eight<J: Lanes>(level: Level, job: J) -> J::Output {
    level.run(Eight(job))
}

struct Eight<J>(J);

impl<J: Lanes> Kernel for Eight<J> {
    type Output = J::Output;

    #[inline(always)]
    fn run<S: Simd>(self) -> J::Output {
        if const { matches!(S::LEVEL.isa(), Isa::Serial | Isa::Scalar) } {
            plain(self.0)
        } else {
            self.0.run::<S::Float8>()
        }
    }
}

/// Runs `job` with the registers of the level; with plain `f32` for [`Width::One`].
pub(crate) fn run_native<J: Lanes>(level: Level, width: Width, job: J) -> J::Output {
    if width == Width::One { job.run::<f32>() } else { level.run(Native(job)) }
}

/// [`run_native`] for long functions: at emulated levels too with plain `f32`, because their vectors become many times as much code. The bits
/// are the same.
pub(crate) fn run_long<J: Lanes>(level: Level, width: Width, job: J) -> J::Output {
    if width == Width::One { plain(job) } else { level.run(Long(job)) }
}

struct Long<J>(J);

impl<J: Lanes> Kernel for Long<J> {
    type Output = J::Output;

    #[inline(always)]
    fn run<S: Simd>(self) -> J::Output {
        if const { matches!(S::LEVEL.isa(), Isa::Serial | Isa::Scalar) } {
            plain(self.0)
        } else {
            self.0.run::<S::Float>()
        }
    }
}

#[inline(never)]
fn plain<J: Lanes>(job: J) -> J::Output {
    job.run::<f32>()
}

struct Native<J>(J);

impl<J: Lanes> Kernel for Native<J> {
    type Output = J::Output;

    #[inline(always)]
    fn run<S: Simd>(self) -> J::Output {
        self.0.run::<S::Float>()
    }
}

/// [`run`] with the instructions that the whole program is compiled for, and no others: for work whose speed does not matter much.
pub(crate) fn run_once<J: Lanes>(lanes: usize, job: J) -> J::Output {
    if lanes == 1 { job.run::<f32>() } else { Level::run_native(AtWidth { lanes, job }) }
}

struct AtWidth<J> {
    lanes: usize,
    job: J,
}

impl<J: Lanes> Kernel for AtWidth<J> {
    type Output = J::Output;

    #[inline(always)]
    fn run<S: Simd>(self) -> J::Output {
        match self.lanes {
            4 => self.job.run::<S::Float4>(),
            _ if const { is_serial::<S>() } => Level::SCALAR.run(self),
            8 => self.job.run::<S::Float8>(),
            _ => self.job.run::<S::Float16>(),
        }
    }
}

/// Level serial is there to be compared with float4: eight and sixteen fenced lanes would be a quarter of all machine code, and run as at level scalar.
pub(crate) const fn is_serial<S: Simd>() -> bool {
    matches!(S::LEVEL.isa(), Isa::Serial)
}

/// Work that is generic over the vector type, and wants the level's others beside it.
pub(crate) trait SimdLanes {
    type Output;

    /// With vectors of type `F`. Mark it `#[inline(always)]`.
    fn run<S: Simd, F: Float>(self) -> Self::Output;
}

/// Runs `job` at a level with vectors of `lanes` lanes: 4, 8 or 16, or 1, which is plain `f32` in plain Rust. So it is at emulated levels, whatever the number of
/// lanes: vectors become many times as much code there. The bits are the same.
pub(crate) fn run_simd<J: SimdLanes>(level: Level, lanes: usize, job: J) -> J::Output {
    let level = if lanes == 1 { Level::SCALAR } else { level };
    level.run(SimdAtWidth { lanes, job })
}

struct SimdAtWidth<J> {
    lanes: usize,
    job: J,
}

impl<J: SimdLanes> Kernel for SimdAtWidth<J> {
    type Output = J::Output;

    #[inline(always)]
    fn run<S: Simd>(self) -> J::Output {
        if const { is_serial::<S>() } {
            return Level::SCALAR.run(self);
        }
        if const { matches!(S::LEVEL.isa(), Isa::Scalar) } {
            return self.job.run::<S, f32>();
        }
        match self.lanes {
            4 => self.job.run::<S, S::Float4>(),
            8 => self.job.run::<S, S::Float8>(),
            _ => self.job.run::<S, S::Float16>(),
        }
    }
}

/// [`run_simd`] with the registers of the level.
pub(crate) fn run_simd_native<J: SimdLanes>(level: Level, job: J) -> J::Output {
    level.run(SimdNative(job))
}

struct SimdNative<J>(J);

impl<J: SimdLanes> Kernel for SimdNative<J> {
    type Output = J::Output;

    #[inline(always)]
    fn run<S: Simd>(self) -> J::Output {
        if const { is_serial::<S>() } {
            return Level::SCALAR.run(self);
        }
        if const { matches!(S::LEVEL.isa(), Isa::Scalar) } {
            self.0.run::<S, f32>()
        } else {
            self.0.run::<S, S::Float>()
        }
    }
}
