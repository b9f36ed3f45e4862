//! Tables 1 to 4 and figures 6 to 8 of Boulos, Wald and Benthin 2008, "Adaptive Ray Packet Reordering", measured anew.

mod chart;
mod counts;
mod frames;
mod goals;
mod paper;
mod scenes;
mod text;

use crate::console::Console;
use crate::machine::Machine;
use crate::report::Folder;
use crate::report::goals::Goal;
use counts::Counts;
use frames::{Frames, Setup, Task, Whole, Work};
use scenes::{Name, Scene, Surface};
use serde::Serialize;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use tracer::Error;
use tracer::progress::Progress;

/// Adaptive Ray Packet Reordering (Boulos, Wald and Benthin 2008): tables 1 to 4, figures 6 to 8
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Writes boulos.md, boulos.json and boulos_figure6.svg to boulos_figure8.svg, and prints the first. conference.obj.zst and crytek_sponza.obj.zst are \
looked for in the folder that TRACER_SCENES names, else in ../shared/scenes; what is missing is left out. Table 4 and the figures are of the conference room.

Examples:
  bench boulos --quick                              does it run?
  bench boulos                                      all of it
  bench boulos --scene conference --levels sse4.2:4,avx2:8 --repeat 5")]
pub struct Args {
    /// A scene to measure; repeat it for more [default: all]
    #[arg(long = "scene", value_name = "NAME")]
    scenes: Vec<Name>,
    /// A smoke run of seconds: 64 pixels each way, one round, to target/boulos
    #[arg(long)]
    quick: bool,
    /// Pixels each way [default: 1024]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=8192))]
    size: Option<u16>,
    /// Rounds, of which medians are taken [default: 3]
    #[arg(long, value_name = "N")]
    repeat: Option<NonZeroUsize>,
    /// Levels and widths: the first for all, the others for the conference room's diffuse frames [default: sse4.2:4, and the CPU's best
    /// level with 8 and 16]. Emulated levels (serial, scalar) are timed with one lane at any width
    #[arg(long, value_name = "LEVEL:WIDTH", value_delimiter = ',')]
    levels: Vec<Setup>,
    /// Cost of a box test for the builder, when a triangle test costs 1: the higher, the larger the leaves [default: 0.25, which makes
    /// triangle tests as small a part as the paper's]
    #[arg(long, value_name = "COST", default_value_t = Scene::BOX_COST, hide_default_value = true)]
    box_cost: f32,
    /// Folder for what is written [default: bench/reports]
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// All that was found.
#[derive(Debug, Serialize)]
struct Report {
    quick: bool,
    machine: Machine,
    size: usize,
    repeat: usize,
    box_cost: f32,
    setups: Vec<Setup>,
    scenes: Vec<(Name, String)>,
    skipped: Vec<Name>,
    frames: Vec<Frames>,
    counts: Option<Counts>,
    whole: Vec<Whole>,
    goals: Vec<Goal>,
}

/// Measures, prints and writes, on one thread.
pub fn run(args: &Args, console: &Console) -> Result<(), Error> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.map_err(|e| Error::Usage(format!("there is no thread to measure on: {e}")))?;
    let folder = Folder::open(args.output.as_deref(), args.quick, "boulos")?;
    let report = pool.install(|| measure(args, console))?;
    console.check()?;
    let markdown = text::markdown(&report);
    let figures = report.counts.as_ref().map_or(Ok(Vec::new()), chart::all)?;
    folder.write("boulos", markdown, &report, figures)
}

fn measure(args: &Args, console: &Console) -> Result<Report, Error> {
    let size = args.size.map_or(if args.quick { 64 } else { 1024 }, usize::from);
    let repeat = args.repeat.map_or(if args.quick { 1 } else { 3 }, NonZeroUsize::get);
    let setups = if args.levels.is_empty() { Setup::usual() } else { args.levels.clone() };
    if !(args.box_cost.is_finite() && args.box_cost >= 0.0) {
        return Err(Error::Usage(format!("a box test that costs {}: give a number from 0 on", args.box_cost)));
    }
    let task = Task { size, repeat, console };
    let mut report = Report {
        quick: args.quick,
        machine: Machine::now(),
        size,
        repeat,
        box_cost: args.box_cost,
        setups,
        scenes: Vec::new(),
        skipped: Vec::new(),
        frames: Vec::new(),
        counts: None,
        whole: Vec::new(),
        goals: Vec::new(),
    };
    for name in text::scenes(&args.scenes) {
        match Scene::open(name, args.box_cost, console)? {
            Some(mut scene) => report.add(&mut scene, &task)?,
            None => report.skipped.push(name),
        }
    }
    Ok(report)
}

impl Report {
    /// All that is measured on a scene.
    fn add(&mut self, scene: &mut Scene, task: &Task<'_>) -> Result<(), Error> {
        self.scenes.push((scene.name, scene.what.clone()));
        for surface in [Surface::Specular, Surface::Glossy, Surface::Diffuse] {
            let scenery = scene.paint(surface)?;
            let work = Work { scene, scenery: &scenery, surface };
            let in_full = scene.name == Name::Conference && surface == Surface::Diffuse;
            let setups = if in_full { self.setups.len() } else { 1 };
            for &setup in &self.setups[..setups] {
                let frames = frames::measure(&work, setup, task)?;
                if in_full {
                    self.goals.extend(goals::of_times(&frames));
                    self.whole.extend(frames::whole(&work, setup, task)?);
                }
                self.frames.push(frames);
            }
            if in_full {
                let counts = counts::count(&work, task)?;
                self.goals.extend(goals::of_counts(&counts));
                self.counts = Some(counts);
            }
        }
        Ok(())
    }
}
