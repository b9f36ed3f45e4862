//! Table 1 and figures 12 to 15 of Garanzha and Loop 2010, "Fast Ray Sorting and Breadth-First Packet Traversal for GPU Ray Tracing", measured anew on a
//! CPU, with the sort stage by itself.

mod chart;
mod goals;
mod paper;
mod race;
mod scenes;
mod strata;
mod text;

use crate::console::Console;
use crate::machine::Machine;
use crate::report::Folder;
use crate::report::goals::Goal;
use crate::sort::{self, Sorting};
use race::{Found, Query, Racer, Way};
use scenes::{Name, Scene};
use serde::Serialize;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use tracer::Error;
use tracer::geometry::RayBatch;
use tracer::method::{Context, Visit};
use tracer::progress::Progress;
use tracer::sort::{RayHash, Reorder};
use tracer::stats::Frusta;

/// Fast Ray Sorting and Breadth-First Packet Traversal (Garanzha and Loop 2010): the sort stage, table 1, figures 12 to 15
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Writes garanzha.md, garanzha.json and garanzha_figure12_SCENE.svg, and prints the first. conference.obj.zst and crytek_sponza.obj.zst are looked for in \
the folder that TRACER_SCENES names, else in ../shared/scenes; what is missing is left out. At the CPU's best level, whatever SIMD_LEVEL says.

Examples:
  bench garanzha --quick                       does it run?
  bench garanzha                               all of it
  bench garanzha --scene conference --repeat 5")]
pub struct Args {
    /// A scene to measure; repeat it for more [default: all]
    #[arg(long = "scene", value_name = "NAME")]
    scenes: Vec<Name>,
    /// A smoke run of seconds: a picture of 64x48, one round, to target/garanzha
    #[arg(long)]
    quick: bool,
    /// Width of the picture; the height is three quarters of it [default: 1024]
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u16).range(4..=4096))]
    size: Option<u16>,
    /// Rounds, of which medians are taken [default: 3]
    #[arg(long, value_name = "N")]
    repeat: Option<NonZeroUsize>,
    /// Folder for what is written [default: bench/reports]
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Shadow rays from each point: as many as the paper has.
const SAMPLES: usize = 16;
/// Rays in a batch at most.
const BATCH: usize = 1 << 20;
/// How many times as large the lamp is, in the paper's sense of figure 15.
const LAMPS: [f32; 4] = [1.0, 2.0, 4.0, 8.0];
/// Shadow rays from each point, for figure 15.
const RATES: [usize; 4] = [1, 4, 16, 64];

/// All that was found.
#[derive(Debug, Serialize)]
struct Report {
    quick: bool,
    machine: Machine,
    size: [usize; 2],
    repeat: usize,
    skipped: Vec<Name>,
    sorting: Sorting,
    parts: Vec<Part>,
    goals: Vec<Goal>,
}

/// What was found of a scene.
#[derive(Debug, Serialize)]
struct Part {
    name: Name,
    what: String,
    eye_rays: usize,
    /// Eye rays along a Z-curve.
    eye: Vec<Found>,
    shadow_rays: usize,
    /// Soft shadows.
    shadows: Vec<Found>,
    /// By the most rays in a packet and the size of cells.
    table: Vec<Vec<Cell>>,
    /// By the size of the lamp.
    lamps: Vec<Sweep>,
    /// By the number of shadow rays from each point.
    rates: Vec<Sweep>,
}

/// Of table 1, and figure 12.
#[derive(Debug, Clone, Copy, Serialize)]
struct Cell {
    leaves: u64,
    frusta: u64,
    rays_per_group: f64,
    mrays: f64,
}

/// Of figure 15.
#[derive(Debug, Serialize)]
struct Sweep {
    of: f32,
    rays: usize,
    found: Vec<Found>,
}

/// Measures, prints and writes, on one thread.
pub fn run(args: &Args, console: &Console) -> Result<(), Error> {
    let folder = Folder::open(args.output.as_deref(), args.quick, "garanzha")?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.map_err(|e| Error::Usage(format!("there is no thread to measure on: {e}")))?;
    let report = pool.install(|| measure(args, console))?;
    console.check()?;
    let figures = chart::all(&report.parts)?;
    folder.write("garanzha", text::markdown(&report), &report, figures)
}

fn measure(args: &Args, console: &Console) -> Result<Report, Error> {
    let width = args.size.map_or(if args.quick { 64 } else { 1024 }, usize::from);
    let repeat = args.repeat.map_or(if args.quick { 1 } else { 3 }, NonZeroUsize::get);
    let size = [width, 3 * width / 4];
    console.stage("sorting", 0);
    let mut report = Report {
        quick: args.quick,
        machine: Machine::now(),
        size,
        repeat,
        skipped: Vec::new(),
        sorting: sort::measure(&[], args.quick, repeat, console)?,
        parts: Vec::new(),
        goals: Vec::new(),
    };
    for name in Name::chosen(&args.scenes) {
        match Scene::open(name, console)? {
            Some(scene) => report.parts.push(part(&scene, size, repeat, console)?),
            None => report.skipped.push(name),
        }
    }
    report.goals = goals::all(&report);
    Ok(report)
}

/// All that is measured on a scene.
fn part(scene: &Scene, [width, height]: [usize; 2], repeat: usize, console: &Console) -> Result<Part, Error> {
    let mut cx = Context { counters: None, cancel: Some(console.cancel()) };
    console.stage(&format!("{}: eye rays", scene.name), 0);
    let (eye_rays, hits) = scene.eye([width, height], &mut cx)?;
    let eye = race_all(scene, Query::Closest, 1, std::slice::from_ref(&eye_rays), repeat, &mut cx)?;

    console.stage(&format!("{}: soft shadows", scene.name), 0);
    let points = Scene::points(&eye_rays, &hits);
    let rays = batches(scene, &points, SAMPLES, 1.0);
    let shadows = race_all(scene, Query::Any, SAMPLES, &rays, repeat, &mut cx)?;
    console.stage(&format!("{}: table 1", scene.name), 0);
    let table = table(scene, &rays, &mut cx)?;
    let shadow_rays = rays.iter().map(RayBatch::len).sum();
    drop(rays);

    console.stage(&format!("{}: lamps and samples", scene.name), 0);
    // Every fourth point along the Z-curve, by sixteens: a picture with half as many pixels each way would have them as close.
    let few: Vec<[f32; 3]> = points.chunks(16).step_by(4).flatten().copied().collect();
    let mut sweep = |samples, scale: f32, of| {
        let rays = batches(scene, &few, samples, scale);
        let found = race_all(scene, Query::Any, samples, &rays, repeat.min(2), &mut cx)?;
        Ok(Sweep { of, rays: rays.iter().map(RayBatch::len).sum(), found })
    };
    let lamps = LAMPS.into_iter().map(|scale| sweep(SAMPLES, scale, scale)).collect::<Result<_, Error>>()?;
    let rates = RATES.into_iter().map(|n| sweep(n, 1.0, n as f32)).collect::<Result<_, Error>>()?;
    console.clear();
    let (name, what) = (scene.name, scene.what.clone());
    Ok(Part { name, what, eye_rays: eye_rays.len(), eye, shadow_rays, shadows, table, lamps, rates })
}

fn batches(scene: &Scene, points: &[[f32; 3]], samples: usize, scale: f32) -> Vec<RayBatch> {
    points.chunks((BATCH / samples).max(1)).map(|points| scene.shadows(points, samples, scale)).collect()
}

/// Frusta in their variants and what they are compared with, for so many rays from each point.
fn race_all(
    scene: &Scene,
    query: Query,
    samples: usize,
    rays: &[RayBatch],
    repeat: usize,
    cx: &mut Context<'_>,
) -> Result<Vec<Found>, Error> {
    let by = if query == Query::Any { Reorder::Origin } else { Reorder::Hash };
    let mut racers = race::frusta(scene);
    if query == Query::Any {
        racers.extend(race::strata(scene, samples));
    }
    racers.extend(race::rivals(scene, RayHash::new(&scene.bounds, by)));
    race::race(&mut racers, query, rays, repeat, cx)?;
    Ok(racers.iter().map(Racer::found).collect())
}

/// Table 1 and figure 12: one round after one that warms up.
fn table(scene: &Scene, rays: &[RayBatch], cx: &mut Context<'_>) -> Result<Vec<Vec<Cell>>, Error> {
    let all: usize = rays.iter().map(RayBatch::len).sum();
    let mut table = Vec::new();
    for packet in paper::PACKETS {
        let mut row = Vec::new();
        for cell in paper::CELLS {
            let hash = RayHash::with_cell(&scene.bounds, Reorder::Origin, cell);
            let method = Racer::frusta(scene, &scene.octo, hash, packet, Visit::BreadthFirst);
            let mut counted = Frusta::default();
            for rays in rays {
                counted = counted + race::count(&method, rays, cx)?;
            }
            let mut racers = [Racer::new("frusta", Way::Frusta(method))];
            race::race(&mut racers, Query::Any, rays, 1, cx)?;
            row.push(Cell {
                leaves: counted.leaves,
                frusta: counted.frusta,
                rays_per_group: counted.rays as f64 / counted.groups.max(1) as f64,
                mrays: 1e-6 * all as f64 / racers[0].found().times.all(),
            });
        }
        table.push(row);
    }
    Ok(table)
}
