//! Seconds per frame: the same rays by all methods in turn, and the rest of the frame.

use super::scenes::{Name, Scene, Surface};
use crate::console::Console;
use crate::report::clock::{Timed, median, timed};
use serde::Serialize;
use simd::{Isa, Level};
use std::collections::hash_map::DefaultHasher;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::str::FromStr;
use tracer::Error;
use tracer::geometry::{HitBatch, RayBatch};
use tracer::method::{Auto, BitVec, Context, Method, Reordering, Single, Traversal, Width};
use tracer::progress::{Progress, Silent};
use tracer::render::Scenery;
use tracer::render::integrator::{self, Config, Integrator, Means, Observer, Path, Query};

/// A column of the tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Column {
    Single,
    Simd,
    Packet,
    Reordered,
    Exact,
    Wide,
    Auto,
}

impl Column {
    /// In the order of the tables; the paper's come first.
    pub const ALL: [Self; 7] =
        [Self::Single, Self::Simd, Self::Packet, Self::Reordered, Self::Exact, Self::Wide, Self::Auto];

    /// As the tables have it.
    pub fn title(self) -> &'static str {
        match self {
            Self::Single => "Single",
            Self::Simd => "SIMD",
            Self::Packet => "Packet (64)",
            Self::Reordered => "Reordered (256)",
            Self::Exact => "Exact (256)",
            Self::Wide => "wide",
            Self::Auto => "auto",
        }
    }

    fn method<'a>(self, scene: &'a Scene, setup: Setup) -> Box<dyn Method + 'a> {
        let of = |traversal| Box::new(Reordering::new(&scene.bvh, setup.level, setup.width, traversal));
        match self {
            Self::Single => of(Traversal::Single),
            Self::Simd => of(Traversal::Simd),
            Self::Packet => of(Traversal::Packet),
            Self::Reordered => of(Traversal::Adaptive),
            Self::Exact => of(Traversal::Exact),
            Self::Wide => Box::new(Single::new(&scene.wide, setup.level)),
            Self::Auto => Box::new(Auto::new(&scene.wide, setup.level)),
        }
    }
}

/// An instruction set and a width.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Setup {
    pub level: Level,
    pub width: Width,
}

impl Setup {
    /// The paper's SSE (the best level where there is none), and the best level with 8 and 16 lanes.
    pub fn usual() -> Vec<Self> {
        let best = Level::best();
        let sse = Level::new(Isa::Sse42).unwrap_or(best);
        [(sse, Width::Four), (best, Width::Eight), (best, Width::Sixteen)]
            .map(|(level, width)| Self { level, width })
            .into()
    }

    /// Rays in a vector.
    pub fn lanes(self) -> usize {
        self.width.lanes(self.level)
    }
}

/// Reads `LEVEL:WIDTH`.
impl FromStr for Setup {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (level, width) = text.split_once(':').ok_or("give a level and a width, for example avx2:8")?;
        let level = level.parse().map_err(|e: simd::LevelError| e.to_string())?;
        let width: Width = width.parse()?;
        if width == Width::One {
            return Err("a width of 1 makes no groups: give 4, 8 or 16".into());
        }
        Ok(Self { level, width })
    }
}

impl fmt::Display for Setup {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, width {}", self.level, self.lanes())
    }
}

impl Serialize for Setup {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// What all measurements have in common.
#[derive(Clone, Copy)]
pub struct Task<'a> {
    /// Pixels each way.
    pub size: usize,
    /// Rounds, of which medians are taken.
    pub repeat: usize,
    pub console: &'a Console,
}

/// A scene with its surfaces of one kind.
pub struct Work<'a> {
    pub scene: &'a Scene,
    pub scenery: &'a Scenery,
    pub surface: Surface,
}

/// Times of one scene and surface at one level and width.
#[derive(Debug, Clone, Serialize)]
pub struct Frames {
    pub scene: Name,
    pub surface: Surface,
    pub setup: Setup,
    /// For each number of bounces.
    pub rows: Vec<Row>,
    /// Seconds for the eye rays alone, by column.
    pub eye: Vec<f64>,
    /// Methods that found other hits than the first: there should be none.
    pub different: Vec<String>,
}

/// Times with a number of bounces.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    pub bounces: u32,
    pub rays: u64,
    /// By [`Column::ALL`].
    pub columns: Vec<Cell>,
}

/// Seconds by one method.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Cell {
    pub column: Column,
    /// Finding hits.
    pub traversal: f64,
    /// That, making rays and shading.
    pub frame: f64,
    /// Of the frame over single rays.
    pub speed_up: f64,
    /// Of the traversal alone.
    pub traversal_speed_up: f64,
}

impl Row {
    /// By a method.
    pub fn cell(&self, column: Column) -> Cell {
        self.columns[column as usize]
    }
}

/// Seconds of one round: for each number of reflections before, by column.
type Round = Vec<[f64; Column::ALL.len()]>;

/// Times all methods on all batches of rays of a frame, in turn, and the rest of the frames.
pub fn measure(work: &Work<'_>, setup: Setup, task: &Task<'_>) -> Result<Frames, Error> {
    let bounces = work.surface.bounces();
    let most = bounces[2];
    let methods = Column::ALL.map(|column| column.method(work.scene, setup));
    let stage = format!("{}, {:?}, {setup}:", work.scene.name, work.surface);
    task.console.stage(&stage, task.repeat as u64 * (14 * u64::from(most + 1) + 6));
    let mut watch = Watch { methods: &methods, task, rounds: Vec::new(), eye: Vec::new(), different: Vec::new() };
    let mut rest = vec![[const { Vec::new() }; 2]; bounces.len()];
    let mut rays = [0; 3];
    for _ in 0..task.repeat {
        watch.round(work, setup, most)?;
        for (i, &bounces) in bounces.iter().enumerate() {
            // Single rays gain nothing by grouping: "only single ray avoids this step" (section 5).
            for (grouped, rest) in [true, false].into_iter().zip(&mut rest[i]) {
                let took = render(work, &*methods[Column::Auto as usize], setup, bounces, grouped, task, None)?;
                rays[i] = took.rays;
                rest.push(took.parts[1] + took.parts[2]);
                task.console.advance(1);
            }
        }
    }
    let rows = (0..bounces.len()).map(|i| {
        let [grouped, ungrouped] = &rest[i];
        row(bounces[i], rays[i], &watch.rounds, median(grouped), median(ungrouped))
    });
    let rows = rows.collect();
    let column = |c: usize| median(&watch.eye.iter().map(|round| round[c]).collect::<Vec<_>>());
    let eye = (0..Column::ALL.len()).map(column).collect();
    task.console.clear();
    Ok(Frames { scene: work.scene.name, surface: work.surface, setup, rows, eye, different: watch.different })
}

/// A row from the rounds. The rays of a frame with few bounces are the first of one with more.
fn row(bounces: u32, rays: u64, rounds: &[Round], grouped: f64, ungrouped: f64) -> Row {
    let traversal = |column: Column| {
        let sum = |round: &Round| round.iter().take(bounces as usize + 1).map(|depth| depth[column as usize]).sum();
        median(&rounds.iter().map(sum).collect::<Vec<f64>>())
    };
    let rest = |column| if column == Column::Single { ungrouped } else { grouped };
    let single = traversal(Column::Single);
    let columns = Column::ALL.map(|column| {
        let traversal = traversal(column);
        let frame = traversal + rest(column);
        Cell {
            column,
            traversal,
            frame,
            speed_up: (single + ungrouped) / frame,
            traversal_speed_up: single / traversal,
        }
    });
    Row { bounces, rays, columns: columns.into() }
}

/// Times methods on each batch that it is shown.
struct Watch<'a> {
    methods: &'a [Box<dyn Method + 'a>; Column::ALL.len()],
    task: &'a Task<'a>,
    rounds: Vec<Round>,
    eye: Vec<[f64; Column::ALL.len()]>,
    different: Vec<String>,
}

impl Watch<'_> {
    fn round(&mut self, work: &Work<'_>, setup: Setup, bounces: u32) -> Result<(), Error> {
        let number = self.rounds.len();
        self.rounds.push(vec![[0.0; Column::ALL.len()]; bounces as usize + 1]);
        let (methods, task) = (self.methods, self.task);
        let (mut asked, mut result) = (Asked::default(), Ok(()));
        let mut observer = |depth: usize, query: Query, rays: &RayBatch| {
            if result.is_ok() {
                result = self.batch(number, depth, query, rays, &mut asked);
            }
        };
        let auto = &*methods[Column::Auto as usize];
        render(work, auto, setup, bounces, true, task, Some(&mut observer))?;
        result
    }

    fn batch(
        &mut self,
        round: usize,
        depth: usize,
        query: Query,
        rays: &RayBatch,
        asked: &mut Asked,
    ) -> Result<(), Error> {
        let n = Column::ALL.len();
        let mut seconds = [0.0; Column::ALL.len()];
        let mut hashes = [0; Column::ALL.len()];
        // Another method begins in each round.
        for i in (0..n).map(|i| (round + i) % n) {
            let mut cx = Context { counters: None, cancel: Some(self.task.console.cancel()) };
            seconds[i] = asked.ask(&*self.methods[i], query, rays, &mut cx)?;
            hashes[i] = asked.hash(query);
            self.rounds[round][depth][i] += seconds[i];
            self.task.console.advance(1);
        }
        if depth == 0 && query == Query::Closest {
            self.eye.push(seconds);
        }
        for (column, hash) in Column::ALL.into_iter().zip(hashes) {
            let name = column.title().to_owned();
            if hash != hashes[0] && !self.different.contains(&name) {
                self.different.push(name);
            }
        }
        Ok(())
    }
}

/// Room for answers.
pub struct Asked {
    hits: HitBatch,
    occluded: BitVec,
}

impl Default for Asked {
    fn default() -> Self {
        Self { hits: HitBatch::new(), occluded: BitVec::new() }
    }
}

impl Asked {
    /// Asks a method, and returns the seconds it took.
    pub fn ask(
        &mut self,
        method: &dyn Method,
        query: Query,
        rays: &RayBatch,
        cx: &mut Context<'_>,
    ) -> Result<f64, Error> {
        let (done, seconds) = timed(|| match query {
            Query::Closest => method.closest(rays, &mut self.hits, cx),
            Query::Any => method.any(rays, &mut self.occluded, cx),
        });
        done.map(|()| seconds)
    }

    /// Of the last answer.
    fn hash(&self, query: Query) -> u64 {
        match query {
            Query::Closest => self.hits.hash(),
            Query::Any => {
                let mut hasher = DefaultHasher::new();
                self.occluded.words().hash(&mut hasher);
                hasher.finish()
            }
        }
    }
}

/// What a frame took.
pub struct Took {
    pub rays: u64,
    /// Seconds of traversal, shading, generation.
    pub parts: [f64; 3],
}

/// A whole frame.
pub fn render<'b>(
    work: &Work<'_>,
    method: &dyn Method,
    setup: Setup,
    bounces: u32,
    group_shading: bool,
    task: &Task<'b>,
    observer: Option<&mut Observer<'b>>,
) -> Result<Took, Error> {
    let coat_alone = work.surface == Surface::Glossy;
    let integrator = Integrator::Path(Path { bounces, coat_alone, ..Path::default() });
    let config = Config { integrator, level: setup.level, group_shading, ..Config::new(task.size, task.size) };
    let mut cx = Context { counters: None, cancel: Some(task.console.cancel()) };
    let method = Timed::new(method);
    let means = Means { method: &method, cx: &mut cx, observer, progress: &Silent };
    let (rendering, seconds) =
        timed(|| integrator::render(&work.scene.model, work.scenery, work.scene.camera, &config, means));
    let times = rendering?.times;
    // The rest is divided as the renderer's own clock, that on the wall, has it.
    let rest = (seconds - method.seconds()).max(0.0);
    let (shading, generation) = (times.shading.as_secs_f64(), times.generation.as_secs_f64());
    let shading = rest * shading / (shading + generation).max(1e-9);
    Ok(Took { rays: times.rays(), parts: [method.seconds(), shading, rest - shading] })
}

/// A frame that was rendered by one method from beginning to end.
#[derive(Debug, Clone, Serialize)]
pub struct Whole {
    pub column: Column,
    pub setup: Setup,
    pub bounces: u32,
    pub seconds: f64,
    pub mrays_per_s: f64,
    /// Parts of the whole: traversal, shading, generation.
    pub shares: [f64; 3],
}

/// Renders whole frames with most bounces by the adaptive method and by `auto`, in turn.
pub fn whole(work: &Work<'_>, setup: Setup, task: &Task<'_>) -> Result<Vec<Whole>, Error> {
    let bounces = work.surface.bounces()[2];
    let columns = [Column::Reordered, Column::Auto];
    let mut parts = columns.map(|_| [const { Vec::new() }; 3]);
    let mut rays = 0;
    task.console.stage(&format!("whole frames, {setup}:"), 2 * task.repeat as u64);
    for _ in 0..task.repeat {
        for (column, parts) in columns.into_iter().zip(&mut parts) {
            let method = column.method(work.scene, setup);
            let took = render(work, &*method, setup, bounces, true, task, None)?;
            rays = took.rays;
            for (seconds, part) in parts.iter_mut().zip(took.parts) {
                seconds.push(part);
            }
            task.console.advance(1);
        }
    }
    task.console.clear();
    let whole = |(column, parts): (Column, [Vec<f64>; 3])| {
        let parts = parts.each_ref().map(|part| median(part));
        let seconds: f64 = parts.iter().sum();
        let shares = parts.map(|part| part / seconds);
        Whole { column, setup, bounces, seconds, mrays_per_s: rays as f64 * 1e-6 / seconds, shares }
    };
    Ok(columns.into_iter().zip(parts).map(whole).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sums up to the bounces asked for, medians over rounds, the rest of the frame by whether shading is grouped.
    #[test]
    fn rows_from_rounds() {
        let round = |scale: f64| {
            let depth = |seconds: f64| std::array::from_fn(|c| if c == 0 { 4.0 * seconds } else { seconds } * scale);
            vec![depth(1.0), depth(2.0), depth(1000.0)]
        };
        let row = row(1, 77, &[round(1.0), round(5.0), round(2.0)], 2.0, 6.0);
        let [single, simd] = [Column::Single, Column::Simd].map(|column| row.cell(column));
        assert_eq!((row.bounces, row.rays), (1, 77));
        assert_eq!((single.traversal, single.frame, single.speed_up), (24.0, 30.0, 1.0));
        assert_eq!((simd.traversal, simd.frame), (6.0, 8.0));
        assert_eq!((simd.speed_up, simd.traversal_speed_up), (3.75, 4.0));
    }

    #[test]
    fn columns_are_in_order() {
        for (i, column) in Column::ALL.into_iter().enumerate() {
            assert_eq!(column as usize, i);
        }
    }

    #[test]
    fn setups() {
        let setup: Setup = "scalar:16".parse().expect("every CPU has it");
        assert_eq!((setup.lanes(), setup.to_string().as_str()), (16, "scalar, width 16"));
        for (text, reason) in [
            ("sse", "for example"),
            ("mmx:4", "unknown level"),
            ("scalar:5", "unknown width"),
            ("scalar:1", "no groups"),
        ] {
            let e = text.parse::<Setup>().expect_err(text);
            assert!(e.contains(reason), "{e}");
        }
    }
}
