//! Options that several subcommands share.

use crate::machine;
use crate::method::MethodChoice;
use clap::{Args, ValueEnum};
use rayon::{ThreadPool, ThreadPoolBuilder};
use simd::Level;
use std::fmt;
use std::num::NonZeroUsize;
use std::path::Path;
use std::str::FromStr;
use tracer::Error;
use tracer::bvh::BuildConfig;
use tracer::method::{SlabForm, Width};
use tracer::model::Camera;
use tracer::sort::Reorder;

/// What the picture shows.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Picture")]
pub struct PictureOptions {
    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value_t)]
    pub size: Size,
    /// Where to look from: ex,ey,ez/ax,ay,az/ux,uy,uz/fov; up and fov (vertical, degrees) may be left out [default: the
    /// scene's own view, else one that shows all of it]
    #[arg(long, value_name = "EYE/AT/UP/FOV", allow_hyphen_values = true)]
    pub camera: Option<Camera>,
    /// Let the lights cast shadows
    #[arg(long)]
    pub shadows: bool,
}

/// How the tree is built.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Tree")]
pub struct BuildOptions {
    /// How the tree is built
    #[arg(long, value_name = "BUILDER", default_value_t, value_enum)]
    pub build: Builder,
    /// Seed of the order of insertion, for --build insertion; to render with random numbers, their seed too [default: 0]
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
}

/// How rays are traced.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Tracing")]
pub struct TraceOptions {
    #[command(flatten)]
    pub level: LevelOption,
    /// How hits are found: the results are the same, the speed is not [default: packet to render by eye; auto to trace and for
    /// other integrators, unless --width or --slab is given]
    #[arg(long, value_name = "METHOD", value_enum)]
    pub method: Option<MethodChoice>,
    #[command(flatten)]
    pub reorder: ReorderOption,
    /// Rays per packet: auto, 1, 4, 8 or 16
    #[arg(long, value_name = "RAYS", default_value_t)]
    pub width: Width,
    /// Form of the box test: the results are the same, the speed is not
    #[arg(long, value_name = "FORM", default_value_t, value_enum)]
    pub slab: Slab,
    #[command(flatten)]
    pub threads: ThreadsOption,
}

#[derive(Debug, Clone, Copy, Default, Args)]
pub struct ReorderOption {
    /// Sort rays before they are traced (Garanzha and Loop 2010): none; by hash, the cell of the origin and then the direction; origin, that
    /// alone; or direction, then origin. The results are the same, the speed is not
    #[arg(long, value_name = "ORDER", default_value_t)]
    pub reorder: Reorder,
}

#[derive(Debug, Clone, Default, Args)]
pub struct LevelOption {
    /// Instruction set: auto, serial, scalar, sse2, sse4.2, avx2, avx512, neon or vsx [default: what the environment variable
    /// SIMD_LEVEL names, else auto: the fastest of this CPU]
    #[arg(long, value_name = "LEVEL")]
    pub level: Option<LevelChoice>,
}

#[derive(Debug, Clone, Copy, Default, Args)]
pub struct ThreadsOption {
    /// Number of threads [default: one for each core]
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
}

/// Pixels.
#[derive(Debug, Clone, Copy)]
pub struct Size {
    pub width: usize,
    pub height: usize,
}

impl Default for Size {
    fn default() -> Self {
        Self { width: 512, height: 512 }
    }
}

impl Size {
    const MAX: usize = 65_535;

    pub fn pixels(self) -> usize {
        self.width * self.height
    }

    /// Refuses a picture that does not fit into memory.
    pub fn check(self) -> Result<(), Error> {
        // A ray and a hit, a colour of the pass and of the picture, the encoded picture; shadow rays.
        const BYTES_PER_PIXEL: u64 = 128;
        machine::check_memory(BYTES_PER_PIXEL * self.pixels() as u64, &format!("a picture of {self} pixels"))
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |s: &str| s.parse().ok().filter(|n| (1..=Self::MAX).contains(n));
        let size = text.split_once('x').and_then(|(w, h)| Some(Self { width: side(w)?, height: side(h)? }));
        size.ok_or_else(|| format!("give width and height from 1 to {} pixels, for example 1280x720", Self::MAX))
    }
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub enum Builder {
    /// Along a space-filling curve: built 1.3 to 1.6 times as fast as medium, traced slower
    Fast,
    /// Surface area heuristic over bins: fast to build and to trace (also called binned)
    #[default]
    #[value(alias = "binned")]
    Medium,
    /// Medium, then improved by moving subtrees: built 8 to 11 times as long, traced fastest
    High,
    /// One triangle after the other, as in the paper of 2003: slow
    Insertion,
}

impl BuildOptions {
    pub fn config(&self) -> Result<BuildConfig, Error> {
        if self.seed.is_some() && self.build != Builder::Insertion {
            return Err(Error::Usage("--seed is for --build insertion: give both or leave --seed out".into()));
        }
        Ok(match self.build {
            Builder::Fast => BuildConfig::fast(),
            Builder::Medium => BuildConfig::medium(),
            Builder::High => BuildConfig::high(),
            Builder::Insertion => BuildConfig::insertion(self.seed.unwrap_or(0)),
        })
    }

    pub fn name(&self) -> &'static str {
        match self.build {
            Builder::Fast => "fast",
            Builder::Medium => "medium",
            Builder::High => "high",
            Builder::Insertion => "insertion",
        }
    }
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub enum Slab {
    /// Enter a box if any ray of the packet meets it
    #[default]
    Exact,
    /// The paper's simpler test, which lets some packets in for nothing
    Conservative,
}

impl TraceOptions {
    /// The form of the box test.
    pub fn form(&self) -> SlabForm {
        match self.slab {
            Slab::Exact => SlabForm::Exact,
            Slab::Conservative => SlabForm::Conservative,
        }
    }

    /// The method that was asked for, else `usual`; packets where only these have the options that were given.
    pub fn method(&self, usual: MethodChoice) -> Result<MethodChoice, Error> {
        if let Some(method) = self.method {
            return method.check(self.width, self.form()).map(|()| method);
        }
        Ok(if usual.check(self.width, self.form()).is_ok() { usual } else { MethodChoice::Packet })
    }
}

#[derive(Debug, Clone, Copy)]
pub enum LevelChoice {
    Auto,
    Is(Level),
}

impl FromStr for LevelChoice {
    type Err = simd::LevelError;

    fn from_str(name: &str) -> Result<Self, simd::LevelError> {
        if name == "auto" { Ok(Self::Auto) } else { name.parse().map(Self::Is) }
    }
}

impl LevelOption {
    /// The level to use, and why.
    pub fn choose(&self) -> Result<(Level, &'static str), Error> {
        const FASTEST: &str = "the fastest of this CPU";
        match self.level {
            Some(LevelChoice::Is(level)) => Ok((level, "asked for by --level")),
            Some(LevelChoice::Auto) => Ok((Level::best(), FASTEST)),
            None => {
                let level = Level::from_env().map_err(|e| Error::Usage(format!("SIMD_LEVEL: {e}")))?;
                let forced = std::env::var(Level::ENV).is_ok_and(|name| !name.is_empty() && name != "auto");
                Ok((level, if forced { "asked for by SIMD_LEVEL" } else { FASTEST }))
            }
        }
    }
}

/// Refuses a file in a folder that is not there, before the long work; what else can go wrong shows when it is written.
pub fn check_folder(file: Option<&Path>) -> Result<(), Error> {
    let Some(file) = file else { return Ok(()) };
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let found = folder.metadata().map(drop);
    found.map_err(|source| Error::Io { action: "create", path: file.to_owned(), source })
}

/// A pool of this many threads; of one per core when not given.
pub fn pool(threads: Option<NonZeroUsize>) -> Result<ThreadPool, Error> {
    const MAX: usize = 4096;
    let n = threads.map_or(0, NonZeroUsize::get);
    if n > MAX {
        return Err(Error::Usage(format!("--threads {n}: {MAX} is the most")));
    }
    let pool = ThreadPoolBuilder::new().num_threads(n).build();
    pool.map_err(|e| Error::Usage(format!("cannot start {n} threads ({e}): give a smaller --threads")))
}
