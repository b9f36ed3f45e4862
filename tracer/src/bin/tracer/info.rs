//! `tracer info`: what there is to work with.

use crate::args::{self, BuildOptions, LevelOption, ThreadsOption};
use crate::console::Console;
use crate::machine;
use crate::workload::{self, Built};
use indicatif::{HumanBytes, HumanCount};
use serde::Serialize;
use std::fmt::Write;
use std::process::ExitCode;
use tracer::Error;
use tracer::bvh::{CollapseConfig, Node};
use tracer::geometry::Triangle;

/// Show the CPU's levels, and what a scene's tree looks like
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  tracer info                                       CPU and levels
  tracer info rings --build insertion               the paper's tree
  tracer info rings --build high --epo              the best tree, and its overlap")]
pub struct Args {
    /// A file or a built-in scene; without one, only the machine is shown
    scene: Option<String>,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Measure the tree's effective overlap (EPO) too: slower than building it
    #[arg(long)]
    epo: bool,
    #[command(flatten)]
    build: BuildOptions,
    #[command(flatten)]
    level: LevelOption,
    #[command(flatten)]
    threads: ThreadsOption,
}

#[derive(Serialize)]
struct Report {
    cpu: String,
    threads: usize,
    levels: Vec<&'static str>,
    missing: Vec<&'static str>,
    level: String,
    why: &'static str,
    lanes: usize,
    node_bytes: usize,
    triangle_bytes: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    scene: Option<SceneReport>,
}

#[derive(Serialize)]
struct SceneReport {
    name: String,
    triangles: usize,
    degenerate: usize,
    build: &'static str,
    nodes: usize,
    leaves: usize,
    mean_leaf: f64,
    depth: usize,
    sah_cost: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    epo_cost: Option<f64>,
    bytes: usize,
    bytes_per_triangle: f64,
    wide_bytes: usize,
    wide_bytes_per_triangle: f64,
    peak_bytes: u64,
    load_ms: f64,
    build_ms: f64,
}

pub fn run(args: &Args, console: &Console) -> Result<ExitCode, Error> {
    let (level, why) = args.level.choose()?;
    args.build.config()?;
    let pool = args::pool(args.threads.threads)?;
    let (levels, missing) = machine::levels();
    let scene = match &args.scene {
        Some(spec) => Some(pool.install(|| measure(spec, args, console))?),
        None => None,
    };
    let report = Report {
        cpu: machine::cpu(),
        threads: pool.current_num_threads(),
        levels,
        missing,
        level: level.to_string(),
        why,
        lanes: level.isa().lanes(),
        node_bytes: size_of::<Node>(),
        triangle_bytes: size_of::<Triangle>(),
        scene,
    };
    if args.json {
        console.print_json(&report)?
    } else {
        console.print(&text(&report))?
    }
    Ok(ExitCode::SUCCESS)
}

fn measure(spec: &str, args: &Args, console: &Console) -> Result<SceneReport, Error> {
    let (scene, load_ms) = workload::open(spec, console)?;
    let Built { bvh, name: build, ms: build_ms } = Built::new(&scene.mesh, &args.build, console)?;
    let stats = bvh.stats();
    let epo_cost = if args.epo { Some(bvh.epo_cost(console)?) } else { None };
    console.clear();
    let wide_bytes = bvh.collapse::<8>(&CollapseConfig::default()).bytes();
    let triangles = scene.mesh.triangles.len();
    Ok(SceneReport {
        name: scene.name,
        triangles,
        degenerate: triangles - stats.triangles,
        build,
        nodes: stats.nodes,
        leaves: stats.leaves,
        mean_leaf: stats.mean_leaf,
        depth: stats.max_depth,
        sah_cost: stats.sah_cost,
        epo_cost,
        bytes: stats.bytes,
        bytes_per_triangle: stats.bytes_per_triangle,
        wide_bytes,
        wide_bytes_per_triangle: wide_bytes as f64 / stats.triangles.max(1) as f64,
        peak_bytes: args.build.config()?.peak_bytes(triangles),
        load_ms,
        build_ms,
    })
}

fn text(report: &Report) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let mut line = |name: &str, value: String| {
        let _ = writeln!(text, "{name:<10} {value}");
    };
    line("CPU", format!("{}, threads: {}", report.cpu, report.threads));
    line("levels", format!("{}; missing: {}", list(&report.levels), list(&report.missing)));
    line("chosen", format!("{}, {} lanes: {}", report.level, report.lanes, report.why));
    line("sizes", format!("node {} bytes, triangle {} bytes", report.node_bytes, report.triangle_bytes));
    if let Some(scene) = &report.scene {
        let count = |n: usize| HumanCount(n as u64);
        line("scene", format!("{}, read in {:.0} ms", scene.name, scene.load_ms));
        line("triangles", format!("{}, {} of them degenerate", count(scene.triangles), count(scene.degenerate)));
        line("tree", format!("{}, built in {:.0} ms", scene.build, scene.build_ms));
        line("nodes", format!("{}, {} of them leaves", count(scene.nodes), count(scene.leaves)));
        line("leaves", format!("{:.2} triangles on average", scene.mean_leaf));
        line("depth", scene.depth.to_string());
        line("SAH cost", format!("{:.2} box and triangle tests of a random line that hits the root", scene.sah_cost));
        if let Some(cost) = scene.epo_cost {
            line(
                "EPO cost",
                format!("{cost:.2} of these tests for nothing, where a ray ends on a random point of the scene"),
            );
        }
        let bytes = HumanBytes(scene.bytes as u64);
        line("memory", format!("{bytes} of nodes and triangles, {:.1} bytes per triangle", scene.bytes_per_triangle));
        let (bytes, peak) = (HumanBytes(scene.wide_bytes as u64), HumanBytes(scene.peak_bytes));
        let each = scene.wide_bytes_per_triangle;
        line("wide tree", format!("{bytes}, {each:.1} bytes per triangle; while it is built at most {peak}"));
    }
    text
}

/// Names with blanks between them.
pub fn list(names: &[&str]) -> String {
    if names.is_empty() { "none".into() } else { names.join(" ") }
}
