//! The sort stage of Garanzha and Loop 2010: scans and sorts beside copies and other crates' sorts, and whether rays that are sorted are traced faster by
//! more than it costs. Each measurement is a function that returns what it found, for other reports to call.

pub mod keys;
pub mod reorder;
pub mod scene;

use crate::console::Console;
use crate::machine::Machine;
use crate::report::clock::median;
use keys::{Keys, ScanTimes, SortTimes};
use reorder::ReorderTimes;
use scene::Scene;
use serde::Serialize;
use std::fmt::Write;
use std::num::NonZeroUsize;
use tracer::Error;

/// Sorting rays (Garanzha and Loop 2010, sections 3.1 and 5.2): scans, radix sort, compression, reordering before a method
#[derive(Debug, clap::Args)]
#[command(after_help = "\
On one thread at the CPU's best level, whatever SIMD_LEVEL says; CPU time, medians of rounds in which all take turns.

Examples:
  bench sort --quick                                does it run?
  bench sort                                        all of it
  bench sort --scene hairball --repeat 5 --json")]
pub struct Args {
    /// A built-in scene or a file whose rays are sorted; repeat it for more [default: balls:4 and hairball]
    #[arg(long = "scene", value_name = "SCENE")]
    scenes: Vec<String>,
    /// A smoke run of seconds: small arrays and pictures, one round
    #[arg(long)]
    quick: bool,
    /// Rounds, of which medians are taken [default: 5]
    #[arg(long, value_name = "N")]
    repeat: Option<NonZeroUsize>,
    /// Print what was found as JSON
    #[arg(long)]
    json: bool,
}

/// What was found, where and how.
#[derive(Debug, Serialize)]
struct Report {
    quick: bool,
    machine: Machine,
    repeat: usize,
    #[serde(flatten)]
    sorting: Sorting,
}

/// All that was found.
#[derive(Debug, Default, Serialize)]
pub struct Sorting {
    pub scans: Vec<ScanTimes>,
    pub sorts: Vec<SortTimes>,
    pub reorders: Vec<ReorderTimes>,
}

/// Measures and prints, on one thread.
pub fn run(args: &Args, console: &Console) -> Result<(), Error> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let pool = pool.map_err(|e| Error::Usage(format!("there is no thread to measure on: {e}")))?;
    let repeat = args.repeat.map_or(if args.quick { 1 } else { 5 }, NonZeroUsize::get);
    let machine = Machine::now();
    let sorting = pool.install(|| measure(&args.scenes, args.quick, repeat, console))?;
    let report = Report { quick: args.quick, machine, repeat, sorting };
    if args.json {
        let json = serde_json::to_string_pretty(&report);
        println!("{}", json.map_err(|e| Error::Geometry(format!("the report cannot be written as JSON: {e}")))?);
    } else {
        println!("{}", markdown(&report));
    }
    Ok(())
}

/// Measures on the current pool: on built-in scenes if none are named.
pub fn measure(scenes: &[String], quick: bool, repeat: usize, console: &Console) -> Result<Sorting, Error> {
    // The paper's 1024 x 768 pixels, and the same with 16 samples each.
    let (width, height) = if quick { (64, 48) } else { (1024, 768) };
    let (few, many) = (width * height, 16 * width * height);
    let mut found = Sorting {
        scans: [few, many].map(|number| keys::scans(number, repeat)).into(),
        sorts: [few, many].map(|number| keys::sorts(&Keys::random(number), repeat)).into(),
        reorders: Vec::new(),
    };
    let names = if quick { ["balls:2", "tree:4"] } else { ["balls:4", "hairball"] };
    let names = if scenes.is_empty() { names.map(String::from).into() } else { scenes.to_vec() };
    for name in names {
        let scene = Scene::open(&name, console)?;
        for samples in [1, 16] {
            found.sorts.push(keys::sorts(&scene.shadow_keys(width, height, samples)?, repeat));
        }
        let rays = scene.diffuse_rays(if quick { 64 } else { 2048 }, 2)?;
        // All at once, and as a renderer with less memory would have them.
        let batches = [rays.len(), 1 << 18, 1 << 16].into_iter().filter(|&batch| batch > 0 && batch <= rays.len());
        for batch in batches {
            found.reorders.extend(reorder::measure(&scene, &rays, batch, repeat)?);
        }
    }
    Ok(found)
}

fn markdown(report: &Report) -> String {
    let Machine { cpu, load_average, .. } = &report.machine;
    let mut text = String::from("# Sorting rays (Garanzha and Loop 2010)\n\n");
    if report.quick {
        text += "**A smoke run: its figures mean nothing.**\n\n";
    }
    let load = load_average.map_or(String::new(), |load| format!(", load average {load}"));
    let _ = writeln!(text, "{cpu}{load}; one thread, medians of {} rounds, milliseconds of CPU time.\n", report.repeat);
    text + &tables(&report.sorting)
}

/// The tables of a report.
pub fn tables(found: &Sorting) -> String {
    let mut text = String::from(
        "\n## Scans beside a copy of as many bytes\n\n\
             | elements | copy | exclusive scan | of the copy | segmented scan | head flags | compaction |\n\
             |---:|---:|---:|---:|---:|---:|---:|\n",
    );
    for t in &found.scans {
        let ScanTimes { number, copy, exclusive, segmented, heads, compact } = t;
        let ratio = exclusive / copy;
        let _ = writeln!(
            text,
            "| {number} | {copy:.2} | {exclusive:.2} | {ratio:.2} | {segmented:.2} | {heads:.2} | {compact:.2} |"
        );
    }
    text += "\n## Sorts of 32-bit keys with 32-bit values\n\n\
             Paper: 12.6 M keys of soft shadows in 40 ms with compression, 80 ms without (at least 1.8 times as fast).\n\n\
             | keys | number | a run | radix | rdst | voracious | std | best other / radix | four copies / radix | compressed | radix / compressed |\n\
             |---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n";
    for t in &found.sorts {
        let SortTimes { keys, number, run, copy, radix, rdst, voracious, std, compressed, same } = t;
        let (other, copies, gain) = (rdst.min(*voracious).min(*std) / radix, 4.0 * copy / radix, radix / compressed);
        let wrong = if *same { "" } else { " NOT THE SAME ORDER" };
        let _ = writeln!(
            text,
            "| {keys}{wrong} | {number} | {run:.1} | {radix:.2} | {rdst:.2} | {voracious:.2} | {std:.2} | {other:.2} | {copies:.2} | \
             {compressed:.2} | {gain:.2} |"
        );
    }
    text += "\n## Reordering before a method: diffuse rays after two reflections\n\n\
             Charged: hash, sort, gathering rays and putting hits back are part of the time.\n\n\
             | scene | rays | method | by | cell | a run | order | gather | trace | back | unsorted | sort charged | not charged |\n\
             |---|---:|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n";
    for t in &found.reorders {
        let ReorderTimes { scene, rays, method, by, cell, run, order, gather, trace, back, unsorted, same } = t;
        let (charged, not) = (unsorted / t.charged(), unsorted / trace);
        let wrong = if *same { "" } else { " NOT THE SAME HITS" };
        let _ = writeln!(
            text,
            "| {scene}{wrong} | {rays} | {method} | {by} | {cell:.4} | {run:.1} | {order:.1} | {gather:.1} | {trace:.1} | {back:.1} | \
             {unsorted:.1} | {charged:.2} | {not:.2} |"
        );
    }
    text
}

/// The middle of a number of measurements, in milliseconds.
fn median_ms(seconds: Vec<f64>) -> f64 {
    1e3 * median(&seconds)
}
