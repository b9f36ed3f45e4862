//! `tracer trace`: a batch of rays from NumPy, their hits back to it.

use crate::args::{self, BuildOptions, TraceOptions};
use crate::console::Console;
use crate::method::{MethodChoice, reordered};
use crate::npy;
use crate::workload::{self, Built, Structure, median, mrays_per_s, ms};
use cpu_time::{ProcessTime, ThreadTime};
use indicatif::HumanCount;
use serde::Serialize;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use tracer::Error;
use tracer::geometry::{Aabb, HitBatch, RayBatch};
use tracer::method::{BitVec, Context};
use tracer::progress::Progress;

/// Trace a batch of rays that NumPy wrote
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Rays are an array of shape (N, 8), float32: org x y z, t_min, dir x y z, t_max. Directions need not be of unit length; t is
in units of their length. Hits are a structured array of shape (N,) with the fields t, u, v (float32) and primitive
(uint32), in the order of the rays; for a miss t is inf and primitive 4294967295. Primitives are counted in the order of the
file, polygons cut into fans. A ray with a NaN or infinite origin or direction, or without direction, hits nothing.

Examples:
  tracer trace atrium.obj --rays rays.npy --hits hits.npy
  tracer trace balls --rays rays.npy --hits dark.npy --any --threads 1 --repeat 5 --json

  import numpy as np
  np.save('rays.npy', np.array([[0, 0, 5, 0, 0, 0, -1, np.inf]], '<f4'))
  hits = np.load('hits.npy'); print(hits['t'], hits['primitive'])")]
pub struct Args {
    /// A file or a built-in scene
    scene: String,
    /// Rays to read, .npy
    #[arg(long, value_name = "FILE")]
    rays: PathBuf,
    /// Hits to write, .npy
    #[arg(long, value_name = "FILE")]
    hits: PathBuf,
    /// Find out only whether each ray hits anything: writes an array of booleans
    #[arg(long)]
    any: bool,
    /// Trace this many times and report the median of the times
    #[arg(long, value_name = "N", default_value = "1")]
    repeat: NonZeroUsize,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    build: BuildOptions,
    #[command(flatten)]
    trace: TraceOptions,
}

#[derive(Serialize)]
struct Report {
    scene: String,
    triangles: usize,
    rays: usize,
    hits: usize,
    build: &'static str,
    build_ms: f64,
    /// CPU time of all threads.
    trace_ms: f64,
    wall_ms: f64,
    mrays_per_s: f64,
    level: String,
    width: usize,
    method: String,
    reorder: &'static str,
    threads: usize,
}

pub fn run(args: &Args, console: &Console) -> Result<ExitCode, Error> {
    args.trace.level.choose()?;
    args.build.config()?;
    let method = args.trace.method(MethodChoice::Auto)?;
    args::check_folder(Some(&args.hits))?;
    let pool = args::pool(args.trace.threads.threads)?;
    let report = pool.install(|| {
        let rays = npy::read_rays(&args.rays, console)?;
        let (scene, _) = workload::open(&args.scene, console)?;
        let mesh = &scene.mesh;
        let structure = Structure::new(method, mesh, || Built::new(mesh, &args.build, console))?;
        let (name, triangles, bounds) = (scene.name, mesh.triangles.len(), mesh.bounds());
        // All that is needed was made of it: make room for the hits.
        drop(scene.mesh);
        let report = trace(args, &structure, &bounds, &rays, console)?;
        Ok(Report { scene: name, triangles, ..report })
    })?;
    if args.json {
        console.print_json(&report)?
    } else {
        console.print(&text(&report, args))?
    }
    Ok(ExitCode::SUCCESS)
}

/// Traces and writes the hits; what concerns the scene is left for the caller to tell.
fn trace(
    args: &Args,
    structure: &Structure,
    bounds: &Aabb,
    rays: &RayBatch,
    console: &Console,
) -> Result<Report, Error> {
    let (level, _) = args.trace.level.choose()?;
    let choice = structure.choice;
    let method = choice.over(&structure.tree, level, args.trace.width, args.trace.form());
    let reorder = args.trace.reorder.reorder;
    let method = reordered(method, bounds, level, reorder);
    let mut cx = Context { counters: None, cancel: Some(console.cancel()) };
    let (mut hits, mut occluded) = (HitBatch::new(), BitVec::new());
    console.stage("trace", args.repeat.get() as u64);
    let (mut cpu, mut wall) = (Vec::new(), Vec::new());
    for _ in 0..args.repeat.get() {
        let (start, clock) = (Instant::now(), CpuClock::start());
        if args.any {
            method.any(rays, &mut occluded, &mut cx)?;
        } else {
            method.closest(rays, &mut hits, &mut cx)?;
        }
        cpu.push(ms(clock.elapsed()));
        wall.push(ms(start.elapsed()));
        console.advance(1);
    }
    let number = if args.any {
        npy::write_bools(&args.hits, &occluded, console)?;
        occluded.count_ones()
    } else {
        npy::write_hits(&args.hits, &hits, console)?;
        hits.iter().filter(|h| !h.is_miss()).count()
    };
    let threads = rayon::current_num_threads();
    let (trace_ms, wall_ms) = (median(cpu), median(wall));
    Ok(Report {
        scene: String::new(),
        triangles: 0,
        rays: rays.len(),
        hits: number,
        build: structure.build,
        build_ms: structure.build_ms,
        trace_ms,
        wall_ms,
        mrays_per_s: mrays_per_s(rays.len(), if threads == 1 { trace_ms } else { wall_ms }),
        level: level.to_string(),
        width: args.trace.width.lanes(level),
        method: choice.name(),
        reorder: reorder.name(),
        threads,
    })
}

/// CPU time of this thread when it is the only one of the pool, else of all threads.
enum CpuClock {
    Thread(ThreadTime),
    Process(ProcessTime),
}

impl CpuClock {
    fn start() -> Self {
        if rayon::current_num_threads() == 1 {
            Self::Thread(ThreadTime::now())
        } else {
            Self::Process(ProcessTime::now())
        }
    }

    fn elapsed(&self) -> Duration {
        match self {
            Self::Thread(start) => start.elapsed(),
            Self::Process(start) => start.elapsed(),
        }
    }
}

fn text(r: &Report, args: &Args) -> String {
    let [rays, hits, triangles] = [r.rays, r.hits, r.triangles].map(|n| HumanCount(n as u64).to_string());
    let Report {
        scene, build, build_ms, trace_ms, wall_ms, mrays_per_s, level, method, reorder, width, threads, ..
    } = r;
    let made = match *build {
        Structure::NONE => "no tree, triangles taken apart".into(),
        _ => format!("{build} tree built"),
    };
    format!(
        "\
scene     {scene}, {triangles} triangles; {made} in {build_ms:.0} ms
traced    {rays} rays, {hits} hit; level {level}, method {method}, reorder {reorder}, {width} lanes, {threads} threads
time      {trace_ms:.2} ms of CPU, {wall_ms:.2} ms on the clock: {mrays_per_s:.2} Mrays/s
wrote     {}
",
        args.hits.display()
    )
}
