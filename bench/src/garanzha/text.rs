//! The report in Markdown.

use super::race::Found;
use super::{Part, Report, SAMPLES, Sweep, chart, paper};
use crate::report::goals;
use crate::report::text::table;
use crate::sort;
use std::fmt::Write;

/// The whole report.
pub fn markdown(report: &Report) -> String {
    let mut text = head(report);
    text += &sort::tables(&report.sorting);
    if !report.parts.is_empty() {
        text += &format!(
            "\n## Table 1: {SAMPLES} shadow rays from each point, by the size of cells and packets\n\nLeaves captured / frusta, both for each ray / rays in a group of \
             {} (the paper: 32; here the rays of a point fill a group); million rays per second. In brackets the paper's, with all pixels of 1024x768 counted.\n",
            simd::Level::best().isa().lanes()
        );
        for part in &report.parts {
            let _ = write!(text, "\n{}:\n\n{}", part.name, table_1(part));
            let _ = writeln!(text, "\n![{}: rays per second by cells and packets]({})", part.name, chart::file(part));
        }
        text += "\n## Stages and speeds\n\nCPU milliseconds for all rays of a picture (figure 13), and million rays per second, with and without what sorting costs (figure 14). The paper's \
                 single rays are given sorted ones, whose sort it does not count: `wide, sorted` without.\n";
        for part in &report.parts {
            let _ = write!(
                text,
                "\n{}, {} eye rays along a Z-curve:\n\n{}",
                part.name,
                part.eye_rays,
                speeds(&part.eye, part.eye_rays)
            );
            let _ = write!(
                text,
                "\n{}, {} shadow rays, {SAMPLES} from each point:\n\n{}",
                part.name,
                part.shadow_rays,
                speeds(&part.shadows, part.shadow_rays)
            );
        }
        text += "\n## Variants\n\nSoft shadows: how many times as long as by default.\n\n";
        text += &variants(report);
        text += "\n## Figure 15: larger lamps, more samples\n\nMillion rays per second, the sort counted, for a quarter of the points.\n\n";
        text += &sweeps(report, "lamp", |part| &part.lamps);
        text += "\n";
        text += &sweeps(report, "samples", |part| &part.rates);
    }
    text += "\n## What must be reached\n\n";
    text += &goals::table(&report.goals);
    text
}

fn head(report: &Report) -> String {
    let mut text = String::from("# Fast Ray Sorting and Breadth-First Packet Traversal (Garanzha and Loop 2010)\n\n");
    if report.quick {
        text += "**A smoke run: its figures mean nothing.**\n\n";
    }
    let ([width, height], repeat) = (report.size, report.repeat);
    let _ = write!(
        text,
        "- machine: {}; one thread was used\n\
         - level: {}, the CPU's best\n\
         - picture: {width}x{height}; soft shadows to a square lamp that the paper does not describe, in batches of at most 2^20 rays\n\
         - measured: CPU time; all ways are given the same batches, one after the other on each batch, another one first in each round; medians of {repeat} rounds (of one in table 1, of two at most in \
         figure 15). Stages are parts of the time on the wall\n\
         - frusta: packets of at most 256 rays of one cell of 0.004 of the diagonal, sorted by origin (eye rays: not sorted, along a Z-curve), the tree by the surface area heuristic with at \
         most {} triangles a leaf, 8 children a node; `lamp in 4`, `in 16`: rays to each part of the lamp by themselves, made in that order\n\
         - `wide`: single rays through a tree of 8 children a node; `auto`: as many rays together as agree, through the same; `packet`: the packets of the paper of 2003\n\
         - paper: a GPU (GTX 285), its scenes, cameras and lamps differ from these\n",
        report.machine,
        simd::Level::best(),
        tracer::bvh::OctoConfig::default().max_leaf,
    );
    for part in &report.parts {
        let _ = writeln!(text, "- {}: {}", part.name, part.what);
    }
    for name in &report.skipped {
        let _ = writeln!(text, "- {name}: scene not found, skipped");
    }
    if !report.parts.is_empty() {
        text += "- all ways found the same hits in every batch, bit for bit\n";
    }
    text
}

fn table_1(part: &Part) -> String {
    let rows = part.table.iter().zip(paper::PACKETS).zip(&paper::TABLE_1).map(|((row, packet), printed)| {
        let cells = row.iter().zip(printed).map(|(cell, printed)| {
            let [leaves, frusta, rays] = printed[part.name as usize];
            // In the paper's picture, 1024 x 768, all points that are seen have shadow rays.
            let [leaves, frusta] = [leaves, frusta].map(|thousands| 1000.0 * thousands / (1024.0 * 768.0 * 16.0));
            let per_ray = |n: u64| n as f64 / part.shadow_rays as f64;
            format!(
                "{:.3} / {:.4} / {:.1}; {:.2} ({leaves:.3} / {frusta:.4} / {rays})",
                per_ray(cell.leaves),
                per_ray(cell.frusta),
                cell.rays_per_group,
                cell.mrays
            )
        });
        [format!("at most {packet} rays")].into_iter().chain(cells).collect::<Vec<_>>()
    });
    let header: Vec<String> =
        ["packet".into()].into_iter().chain(paper::CELLS.map(|cell| format!("cell {cell}"))).collect();
    table(&header.iter().map(String::as_str).collect::<Vec<_>>(), &rows.collect::<Vec<_>>())
}

fn speeds(found: &[Found], rays: usize) -> String {
    let rows = found.iter().map(|Found { name, times }| {
        let ms = |seconds: f64| if seconds == 0.0 { "–".into() } else { format!("{:.1}", 1e3 * seconds) };
        let mrays = |seconds: f64| format!("{:.2}", 1e-6 * rays as f64 / seconds);
        let stages = [times.sort, times.frusta, times.traversal, times.intersection].map(ms);
        let mut row = vec![name.clone()];
        row.extend(stages);
        row.extend([ms(times.all()), mrays(times.all()), mrays(times.not_sort())]);
        row
    });
    let header = ["", "sort", "frusta", "traversal", "intersection", "all", "Mrays/s, sort counted", "not counted"];
    table(&header, &rows.collect::<Vec<_>>())
}

fn variants(report: &Report) -> String {
    let mut rows = Vec::new();
    for part in &report.parts {
        let [breadth, two, depth] = [0, 1, 2].map(|i: usize| part.shadows[i].times);
        let sorted = part.shadows.iter().find(|found| found.name == "wide, sorted").map(|found| found.times);
        let mut row = |what: &str, stage: f64, all: f64, printed: f64| {
            rows.push(vec![
                part.name.to_string(),
                what.to_owned(),
                format!("{stage:.2}x"),
                format!("{all:.2}x"),
                format!("{printed}x"),
            ]);
        };
        row("two children a node", two.traversal / breadth.traversal, two.all() / breadth.all(), paper::EIGHT_OVER_TWO);
        row("depth first", depth.traversal / breadth.traversal, depth.all() / breadth.all(), paper::BREADTH_OVER_DEPTH);
        if let Some(sorted) = sorted {
            let ratio = sorted.not_sort() / breadth.all();
            row("single rays, sorted, the sort not counted", ratio, ratio, paper::OVER_SINGLE);
        }
    }
    table(&["scene", "instead", "traversal", "all", "paper"], &rows)
}

fn sweeps(report: &Report, what: &str, of: impl Fn(&Part) -> &Vec<Sweep>) -> String {
    let names: Vec<&str> = report.parts[0].shadows.iter().map(|found| found.name.as_str()).collect();
    let header: Vec<&str> = ["scene", what].into_iter().chain(names).collect();
    let rows = report.parts.iter().flat_map(|part| {
        of(part).iter().map(|sweep| {
            let mrays = |found: &Found| format!("{:.2}", 1e-6 * sweep.rays as f64 / found.times.all());
            let mut row = vec![part.name.to_string(), sweep.of.to_string()];
            row.extend(sweep.found.iter().map(mrays));
            row
        })
    });
    table(&header, &rows.collect::<Vec<_>>())
}
