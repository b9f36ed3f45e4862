//! The report in Markdown.

use super::chart;
use super::dynamic::{Crossover, Dynamic, RIVALS, Rays};
use super::inside::WAYS;
use super::paper;
use super::speed::{Kind, Speeds};
use super::variants::DEFAULT;
use super::{Name, Part, Report};
use crate::report::goals;
use crate::report::text::table;
use std::fmt::Write;
use tracer::method::DivideConquer;

/// The whole report.
pub fn markdown(report: &Report) -> String {
    let mut text = head(report);
    if report.parts.is_empty() {
        return text;
    }
    text += "\n## Table 1: million rays per second, building not counted\n\nFor each scene: paths with 1 and with 8 bounces, each on one thread (ST) and on all (MT). All rays of \
             the paths are counted, those of the eye among them. Below, what the paper printed.\n\n";
    text += &speed_table(report);
    text += "\nDAC over MBVH8 at each level:\n\n";
    text += &ratio_table(report);
    text += "\n## With building: a frame of a scene that changes\n\nCPU milliseconds on one thread. DAC takes the triangles' boxes; a tree is built by the \
             fast builder (along a space-filling curve) or the medium one (surface area heuristic) and collapsed to 8 children a node, then traced by single \
             rays (MBVH8) or by as many rays together as agree (`auto`). In brackets how many times as long it takes as DAC.\n\n";
    text += &frame_table(report);
    text += "\n## Where a tree begins to pay\n\nThe picture's size changes the rays per triangle; the best of the four trees and methods above is taken.\n\n";
    for part in report.parts.iter().filter(|part| !part.dynamic.points.is_empty()) {
        text += &crossover(&part.dynamic);
    }
    text += "\n## Phases\n\nParts of the time of DAC by the clock on the wall, one thread, 1 bounce, in the shortest round.\n\n";
    text += &phase_table(report);
    text += "\n## Memory\n\nMiB for the eye rays (R) and the triangles (T) on N threads. By the paper's formula, 32 R + (48 + 4 N) T, hits and stack left out; by Mora's, 36 R + (40 + 4 N) T. \
             Held: boxes, complements and ids, and what the method keeps from batch to batch: 32 R rays, 16 R hits, 4 T ids, and copies of rays where halves are \
             shared.\n\n";
    text += &memory_table(report);
    text += "\n## Variants\n\nCPU milliseconds on one thread, eye rays and rays of the first bounce; in brackets how many times as long as by default.\n\n";
    text += &variant_table(report);
    text += "\n## Threads\n\n1 bounce. Scaling: CPU time of one thread over the time of all by the clock on the wall, which other load on the machine makes \
             longer; work: CPU time of all threads over that of one. Where there are more rays than triangles for each thread, sharing halves is \
             the same as naive.\n\n";
    text += &scaling_table(report);
    if !report.goals.is_empty() {
        text += "\n## What must be reached\n\n";
        text += &goals::table(&report.goals);
    }
    text
}

/// What was measured, where and how.
fn head(report: &Report) -> String {
    let mut text = String::from("# Incoherent Ray Tracing without Acceleration Structures (Áfra 2012)\n\n");
    if report.quick {
        text += "**A smoke run: its figures mean nothing.**\n\n";
    }
    let ([width, height], repeat, threads) = (report.size, report.repeat, report.threads);
    let levels = report.levels.join(", ");
    let last = report.levels.last().map_or("", String::as_str);
    let _ = write!(
        text,
        "- machine: {}; {threads} used where all are (MT)\n\
         - levels: {levels} in table 1; all else at {last}\n\
         - picture: {width}x{height}, one path per pixel, all surfaces grey and matt, no roulette, no attenuation, rays of infinite length; first hits of the path's rays \
         alone, no shadow rays\n\
         - measured: finding hits, by CPU time on one thread (ST), by the clock on the wall on all (MT). All methods are given the same batches of rays, one for each bounce, one method \
         after the other on each batch, another one first in each round; median of the rounds of each batch, of which there were {repeat} ({} for bounces 2 to 8, 1 \
         for pictures of more than a million rays where sizes vary). Making rays and shading are not counted\n\
         - DAC: divide and conquer, vectors as wide as the level's. MBVH: single rays through trees of 4, 8 and 16 children a node, built by the medium builder (surface \
         area heuristic throughout, collapsed at least cost): stronger than the paper's, which split through the middle where there were more than 16 K triangles\n\
         - paper: 4 cores with 8 threads; its scenes, cameras and renderer differ from these\n",
        report.machine,
        repeat.div_ceil(3),
    );
    for part in &report.parts {
        let _ = writeln!(text, "- {}: {}", part.speeds.scene, part.what);
    }
    for name in &report.skipped {
        let _ = writeln!(text, "- {name}: scene not found, skipped");
    }
    if !report.parts.is_empty() {
        text += "- all methods found the same hits in every batch, bit for bit\n";
    }
    text
}

fn speed_table(report: &Report) -> String {
    let mut header = vec!["method".to_owned(), "level".to_owned()];
    for part in &report.parts {
        header.extend(["1 ST", "1 MT", "8 ST", "8 MT"].map(|column| format!("{} {column}", short(part.speeds.scene))));
    }
    let number = |x: f64| format!("{x:.2}");
    let mut rows = Vec::new();
    // Every scene has the same rows.
    for (i, first) in report.parts[0].speeds.rows.iter().enumerate() {
        let mut row = vec![first.kind.title().to_owned(), first.level.clone()];
        row.extend(report.parts.iter().flat_map(|part| part.speeds.rows[i].mrays.map(number)));
        rows.push(row);
    }
    for line in &paper::TABLE_1 {
        let mut row = vec![format!("paper: {}", line.method), format!("{}, {}", line.simd, line.cpu)];
        row.extend(report.parts.iter().flat_map(|p| line.mrays[p.speeds.scene as usize].map(|x| format!("{x:.1}"))));
        rows.push(row);
    }
    table(&header.iter().map(String::as_str).collect::<Vec<_>>(), &rows)
}

fn short(name: Name) -> &'static str {
    match name {
        Name::Conference => "conf.",
        Name::Fairy => "fairy",
        Name::Hairball => "hair",
    }
}

fn ratio_table(report: &Report) -> String {
    let mut rows = Vec::new();
    for part in &report.parts {
        let Speeds { scene, rows: speeds, .. } = &part.speeds;
        for level in speeds.chunks(Kind::ALL.len()) {
            let [dac, mbvh8] = [Kind::Dac, Kind::Mbvh8].map(|kind| level[kind as usize].mrays);
            rows.push(ratio_row(scene.to_string(), &level[0].level, dac, mbvh8));
        }
        let [dac, mbvh8] = [3, 5].map(|line: usize| paper::TABLE_1[line].mrays[*scene as usize]);
        rows.push(ratio_row(scene.to_string(), "paper: AVX, i7-2600", dac, mbvh8));
    }
    table(&["scene", "level", "1 ST", "1 MT", "8 ST", "8 MT"], &rows)
}

fn ratio_row(scene: String, level: &str, dac: [f64; 4], mbvh8: [f64; 4]) -> Vec<String> {
    let ratios = dac.into_iter().zip(mbvh8).map(|(dac, mbvh8)| format!("{:.2}", dac / mbvh8));
    [scene, level.into()].into_iter().chain(ratios).collect()
}

fn frame_table(report: &Report) -> String {
    let mut rows = Vec::new();
    for part in &report.parts {
        let (dynamic, frame) = (&part.dynamic, &part.dynamic.frame);
        let ms = |seconds: f64| format!("{:.1}", 1e3 * seconds);
        let per_triangle = |rays| format!("{:.2}", dynamic.rays_per_triangle(frame, rays));
        for (rival, name) in RIVALS.into_iter().enumerate() {
            let total = |rays| {
                let total = dynamic.total(frame, rival, rays);
                let ratio = total / dynamic.total(frame, 0, rays);
                if rival == 0 { ms(total) } else { format!("{} ({ratio:.2}x)", ms(total)) }
            };
            let [eye, bounce] = frame.trace[rival];
            let build = dynamic.total(frame, rival, Rays::Eye) - eye;
            let mut row = vec![dynamic.scene.to_string(), name.to_owned(), ms(build), ms(eye), ms(bounce)];
            row.extend([per_triangle(Rays::Eye), total(Rays::Eye), per_triangle(Rays::Path), total(Rays::Path)]);
            rows.push(row);
        }
    }
    let header = [
        "scene",
        "method",
        "build",
        "eye rays",
        "bounce",
        "rays per triangle",
        "frame of eye rays",
        "rays per triangle",
        "frame with 1 bounce",
    ];
    table(&header, &rows)
}

fn crossover(dynamic: &Dynamic) -> String {
    let mut text = String::new();
    for (rays, what) in [(Rays::Path, "paths with 1 bounce"), (Rays::Eye, "eye rays alone")] {
        let found = match dynamic.crossover(rays) {
            Crossover::At(x) => format!("DAC is faster up to **{x:.2} rays per triangle**"),
            Crossover::Below([from, to]) => {
                format!("DAC is faster from {from:.3} to {to:.2} rays per triangle, everywhere")
            }
            Crossover::Above([from, to]) => {
                format!("a tree is faster from {from:.3} to {to:.2} rays per triangle, everywhere")
            }
            Crossover::Unclear => "now the one, now the other is faster".into(),
        };
        let _ = writeln!(text, "- {}, {what}: {found}", dynamic.scene);
    }
    let _ = writeln!(text, "\n![{}: time against rays per triangle]({})\n", dynamic.scene, chart::file(dynamic));
    let rows = dynamic.points.iter().map(|point| {
        let mut row = vec![format!("{}x{}", point.pixels[0], point.pixels[1])];
        for rays in [Rays::Eye, Rays::Path] {
            row.push(format!("{:.3}", dynamic.rays_per_triangle(point, rays)));
            let seconds =
                [dynamic.total(point, 0, rays), dynamic.best_by(1, point, rays), dynamic.best_by(2, point, rays)];
            row.extend(seconds.map(|seconds| format!("{:.1}", 1e3 * seconds)));
        }
        row
    });
    let header = [
        "picture",
        "eye rays per triangle",
        "DAC, ms",
        "fast",
        "medium",
        "rays, 1 bounce",
        "DAC, ms",
        "fast",
        "medium",
    ];
    text + &table(&header, &rows.collect::<Vec<_>>()) + "\n"
}

fn phase_table(report: &Report) -> String {
    let mut rows = Vec::new();
    for Part { inside, .. } in &report.parts {
        let mut row = |way: &str, cells: [String; 4]| {
            rows.push([inside.scene.to_string(), way.to_owned()].into_iter().chain(cells).collect::<Vec<_>>());
        };
        for (way, phases) in WAYS.into_iter().zip(inside.phases) {
            let all: f64 = phases.iter().sum();
            let [filter, intersect, partition] = phases.map(|seconds| format!("{:.0} %", 100.0 * seconds / all));
            row(way, [filter, intersect, partition, format!("{:.1}", 1e3 * all)]);
        }
        if let Some(shares) = paper::phases(inside.scene) {
            let [filter, intersect, partition] = shares.map(|share| format!("{share} %"));
            row("paper", [filter, intersect, partition, String::new()]);
        }
    }
    table(&["scene", "", "filter", "intersect", "partition", "ms"], &rows)
}

fn memory_table(report: &Report) -> String {
    let mib = |bytes: usize| format!("{:.1}", bytes as f64 / f64::from(1 << 20));
    let rows = report.parts.iter().flat_map(|part| {
        let memory = &part.inside.memory;
        let (rays, triangles) = (memory.rays, memory.triangles);
        let dac = |what: &str, threads: usize, held: usize| {
            let formulas = [DivideConquer::bytes, paper::mora_bytes].map(|of| mib(of(rays, triangles, threads)));
            let mut row = vec![part.inside.scene.to_string(), what.to_owned(), threads.to_string()];
            row.extend(formulas);
            row.extend([mib(memory.boxes), mib(held), mib(memory.boxes + held)]);
            row
        };
        let [one, tasks, naive] = memory.method;
        let mut rows = vec![dac("DAC", 1, one), dac("DAC, halves shared", memory.threads, tasks)];
        rows.push(dac("DAC, naive", memory.threads, naive));
        for (name, bytes) in ["MBVH4", "MBVH8", "MBVH16"].into_iter().zip(memory.trees) {
            let mut row = vec![part.inside.scene.to_string(), name.to_owned()];
            row.resize(7, "–".into());
            row.push(mib(bytes));
            rows.push(row);
        }
        rows
    });
    let header = ["scene", "method", "N", "paper's formula", "Mora's", "boxes held", "method holds", "held in all"];
    table(&header, &rows.collect::<Vec<_>>())
}

fn variant_table(report: &Report) -> String {
    let rows = report.parts.iter().flat_map(|Part { variants, .. }| {
        variants.rows.iter().map(|row| {
            let cell = |batch: usize| {
                let ms = format!("{:.1}", 1e3 * row.seconds[batch]);
                let ratio = variants.ratio([DEFAULT, &row.name], batch).unwrap_or(f64::NAN);
                if row.name == DEFAULT { ms } else { format!("{ms} ({ratio:.2}x)") }
            };
            vec![variants.scene.to_string(), row.name.clone(), cell(0), cell(1)]
        })
    });
    table(&["scene", "variant", "eye rays", "bounce"], &rows.collect::<Vec<_>>())
}

fn scaling_table(report: &Report) -> String {
    let rows = report.parts.iter().flat_map(|Part { variants, .. }| {
        variants.scaling.iter().map(|scaling| {
            let ms = |seconds: f64| format!("{:.1}", 1e3 * seconds);
            let mut row = vec![variants.scene.to_string(), scaling.name.clone()];
            row.extend([ms(scaling.one.seconds), ms(scaling.all.seconds)]);
            row.extend([scaling.speed_up(), scaling.work()].map(|ratio| format!("{ratio:.2}")));
            row
        })
    });
    let all = format!("{} threads, ms", report.threads);
    table(&["scene", "method", "one thread, ms", &all, "scaling", "work"], &rows.collect::<Vec<_>>())
}
