//! Table 1 of Áfra 2012, "Incoherent Ray Tracing without Acceleration Structures", measured anew, with the time to build trees and without, and what it says
//! of phases, memory and variants.

mod chart;
mod dynamic;
mod goals;
mod inside;
mod paper;
mod race;
mod scenes;
mod speed;
mod text;
mod variants;

use crate::console::Console;
use crate::machine::Machine;
use crate::report::Folder;
use crate::report::goals::Goal;
use dynamic::Dynamic;
use inside::Inside;
use race::Task;
use scenes::{Name, Scene};
use serde::Serialize;
use simd::{Isa, Level};
use speed::Speeds;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use tracer::Error;
use tracer::progress::Progress;
use variants::Variants;

/// Incoherent Ray Tracing without Acceleration Structures (Áfra 2012): table 1, time with building, phases, memory, variants
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Writes afra.md, afra.json and afra_figure_SCENE.svg, and prints the first. The conference room, conference.obj.zst, is looked for in the folder that TRACER_SCENES \
names, else in ../shared/scenes; if it is missing it is left out.

Examples:
  bench afra --quick                           does it run?
  bench afra                                   all of it
  bench afra --scene conference --levels sse4.2,avx2 --repeat 5")]
pub struct Args {
    /// A scene to measure; repeat it for more [default: all]
    #[arg(long = "scene", value_name = "NAME")]
    scenes: Vec<Name>,
    /// A smoke run of seconds: a picture of 64x48, one round, few hairs, to target/afra
    #[arg(long)]
    quick: bool,
    /// Width of the picture; the height is three quarters of it [default: 1024]
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u16).range(4..=4096))]
    size: Option<u16>,
    /// Rounds, of which medians are taken [default: 3]
    #[arg(long, value_name = "N")]
    repeat: Option<NonZeroUsize>,
    /// Levels of table 1; the last is that of all else [default: those of sse4.2, avx2 and avx512 that the CPU has, else its best]
    #[arg(long, value_name = "LEVEL", value_delimiter = ',')]
    levels: Vec<Level>,
    /// Folder for what is written [default: bench/reports]
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// All that was found.
#[derive(Debug, Serialize)]
struct Report {
    quick: bool,
    machine: Machine,
    /// Threads where all are used.
    threads: usize,
    size: [usize; 2],
    repeat: usize,
    levels: Vec<String>,
    skipped: Vec<Name>,
    parts: Vec<Part>,
    goals: Vec<Goal>,
}

/// What was found of a scene.
#[derive(Debug, Serialize)]
struct Part {
    what: String,
    speeds: Speeds,
    dynamic: Dynamic,
    inside: Inside,
    variants: Variants,
}

/// Measures, prints and writes.
pub fn run(args: &Args, console: &Console) -> Result<(), Error> {
    let width = args.size.map_or(if args.quick { 64 } else { 1024 }, usize::from);
    let repeat = args.repeat.map_or(if args.quick { 1 } else { 3 }, NonZeroUsize::get);
    let task = Task::new([width, 3 * width / 4], repeat, args.quick, console)?;
    let folder = Folder::open(args.output.as_deref(), args.quick, "afra")?;
    let report = measure(args, &task)?;
    console.check()?;
    let figures = chart::all(report.parts.iter().map(|part| &part.dynamic))?;
    folder.write("afra", text::markdown(&report), &report, figures)
}

fn measure(args: &Args, task: &Task<'_>) -> Result<Report, Error> {
    let levels = if args.levels.is_empty() { usual_levels() } else { args.levels.clone() };
    let mut report = Report {
        quick: args.quick,
        machine: Machine::now(),
        threads: task.threads(),
        size: task.size,
        repeat: task.repeat,
        levels: levels.iter().map(ToString::to_string).collect(),
        skipped: Vec::new(),
        parts: Vec::new(),
        goals: Vec::new(),
    };
    for name in Name::chosen(&args.scenes) {
        match Scene::open(name, args.quick, task.console)? {
            Some(scene) => report.parts.push(part(&scene, &levels, task)?),
            None => report.skipped.push(name),
        }
    }
    report.goals = goals::all(&report.parts);
    Ok(report)
}

/// All that is measured on a scene.
fn part(scene: &Scene, levels: &[Level], task: &Task<'_>) -> Result<Part, Error> {
    let best = levels.last().copied().unwrap_or_else(Level::best);
    let rays = scene.rays(task.size, speed::BOUNCES[1] as u32, task)?;
    let speeds = speed::measure(scene, &rays, levels, task)?;
    let variants = variants::measure(scene, &rays, best, task)?;
    let inside = inside::measure(scene, &rays, best, task)?;
    let dynamic = dynamic::measure(scene, &rays, best, task)?;
    Ok(Part { what: scene.what.clone(), speeds, dynamic, inside, variants })
}

/// The paper's SSE, its AVX as nearly as may be, and what came later.
fn usual_levels() -> Vec<Level> {
    let levels: Vec<Level> = [Isa::Sse42, Isa::Avx2, Isa::Avx512].into_iter().filter_map(Level::new).collect();
    if levels.is_empty() { vec![Level::best()] } else { levels }
}
