//! The report in Markdown.

use super::Report;
use super::counts::{CountRow, WIDTHS};
use super::frames::{Column, Frames, Whole};
use super::paper;
use super::scenes::{Name, Scene, Surface};
use crate::report::goals;
use crate::report::text::table;
use std::fmt::Write;
use tracer::method::Width;

/// The whole report.
pub fn markdown(report: &Report) -> String {
    let mut text = head(report);
    for paper in &paper::TABLES {
        // The first level and width has all scenes, so it comes first.
        let mut setups: Vec<_> = report.frames.iter().filter(|f| f.surface == paper.surface).map(|f| f.setup).collect();
        setups.dedup();
        for setup in setups {
            let frames = report.frames.iter().filter(|f| f.surface == paper.surface && f.setup == setup);
            let surface = format!("{:?}", paper.surface).to_lowercase();
            let _ = writeln!(text, "\n## Table {}: {surface}, {setup}\n", paper.number);
            text += &frame_table(paper, &frames.collect::<Vec<_>>());
        }
    }
    if let Some(counts) = &report.counts {
        text += "\n## Table 4: per ray, conference, diffuse, 2 bounces\n\nA test of a group of rays counts once. In \
                 brackets the paper's.\n\n";
        for (width, rows) in WIDTHS.into_iter().zip(counts.rows.chunks(5)) {
            text += &count_table(width, rows);
            text += "\n";
        }
        text += "Lanes at work: rays that a ray-by-ray traversal would test, over tests times width.\n\n## Figures 6 to 8\n";
        for number in [6, 7, 8] {
            let _ = writeln!(text, "\n![Figure {number}](boulos_figure{number}.svg)");
        }
    }
    if !report.whole.is_empty() {
        text += "\n## The whole frame\n\nRendered by one method from beginning to end: conference, diffuse, 2 bounces, 1 sample.\n\n";
        text += &whole_table(&report.whole);
    }
    if !report.goals.is_empty() {
        text += "\n## What must be reached\n\nConference, diffuse. Frames have what all methods share, so their ratio is the stricter one.\n\n";
        text += &goals::table(&report.goals);
    }
    text
}

/// What was measured, where and how.
fn head(report: &Report) -> String {
    let mut text = String::from("# Adaptive Ray Packet Reordering (Boulos, Wald and Benthin 2008)\n\n");
    if report.quick {
        text += "**A smoke run: its figures mean nothing.**\n\n";
    }
    let machine = &report.machine;
    let (size, repeat) = (report.size, report.repeat);
    let setups: Vec<String> = report.setups.iter().map(ToString::to_string).collect();
    let _ = write!(
        text,
        "- machine: {machine}; one was used\n\
         - levels and widths: {}; the first for all scenes, the others for the conference room's diffuse frames\n\
         - picture: {size}x{size}, 1 sample per pixel, one area light, one light sample per hit; no roulette, no attenuation\n\
         - measured: CPU time of one thread. Every method is given the same batches of rays, those of a real frame, one method after the other on \
         each batch, another one first in each round; median of the rounds, of which there were {repeat}. A frame is the method's traversal, and making rays and \
         shading (the median of as many frames, shading grouped by material model; ungrouped for Single, as in the paper)\n\
         - columns: the paper's five, on one binary tree; `wide`: single rays through a tree of 8 children a node; `auto`: as many rays together \
         as agree, through the same. In brackets the speed-up over Single\n\
         - surfaces: all of one kind; glossy ones follow their coat's lobe alone, its exponent {} (the paper does not name its own)\n\
         - tree: surface area heuristic over bins, a box test at {} of a triangle test{}\n\
         - paper: SSE on one core of a 3.0 GHz Clovertown; its traversals, scenes, cameras and renderer differ from these\n",
        setups.join("; "),
        Surface::SHININESS,
        report.box_cost,
        if report.box_cost == Scene::BOX_COST {
            ": leaves as small as make triangle tests the paper's part (table 4)"
        } else {
            ""
        }
    );
    for (name, what) in &report.scenes {
        let _ = writeln!(text, "- {name}: {what}");
    }
    for name in &report.skipped {
        let _ = writeln!(text, "- {name}: scene not found, skipped");
    }
    let different: Vec<String> = report
        .frames
        .iter()
        .filter(|f| !f.different.is_empty())
        .map(|f| format!("{}, {:?}, {}: {}", f.scene, f.surface, f.setup, f.different.join(", ")))
        .collect();
    if report.frames.is_empty() {
        text += "- nothing was measured\n";
    } else if different.is_empty() {
        text += "- all methods found the same hits in every batch, bit for bit\n";
    } else {
        let _ = writeln!(text, "- **NOT THE SAME HITS** as Single: {}", different.join("; "));
    }
    text
}

fn frame_table(paper: &paper::Table, frames: &[&Frames]) -> String {
    let mut rows = Vec::new();
    for part in 0..paper.bounces.len() {
        for frames in frames {
            let row = &frames.rows[part];
            let cell = |column: Column, seconds: f64, speed_up: f64| {
                let seconds = format!("{seconds:.3}");
                if column == Column::Single { seconds } else { format!("{seconds} ({speed_up:.2}x)") }
            };
            let scene = frames.scene.to_string();
            let mut line = |what: &str, cells: Vec<String>| {
                let mut row = vec![scene.clone(), row.bounces.to_string(), what.into()];
                row.extend(cells);
                row.resize(3 + Column::ALL.len(), String::new());
                rows.push(row);
            };
            line("frame", row.columns.iter().map(|c| cell(c.column, c.frame, c.speed_up)).collect());
            let traversal = |c: &super::frames::Cell| cell(c.column, c.traversal, c.traversal_speed_up);
            line("traversal", row.columns.iter().map(traversal).collect());
            line("paper", paper_cells(paper.row(part, frames.scene)));
        }
    }
    let mut header = vec!["scene", "bounces", "seconds"];
    header.extend(Column::ALL.map(Column::title));
    table(&header, &rows)
}

fn paper_cells(row: paper::Row) -> Vec<String> {
    let [single, others @ ..] = row.seconds;
    let others = others.into_iter().zip(row.speed_ups);
    let others = others.map(|(seconds, speed_up)| format!("{seconds:.1} ({speed_up:.1}x)"));
    [format!("{single:.1}")].into_iter().chain(others).collect()
}

fn count_table(width: Width, rows: &[CountRow]) -> String {
    let mut lines = Vec::new();
    for (i, (name, paper)) in paper::TABLE_4.iter().enumerate() {
        let cells = rows.iter().zip(paper).map(|(row, paper)| {
            let value = row.per_ray[i];
            if width == Width::Four { format!("{value:.2} ({paper:.1})") } else { format!("{value:.2}") }
        });
        lines.push([(*name).to_owned()].into_iter().chain(cells).collect());
    }
    let percent = |row: &CountRow| row.utilization().map_or("–".into(), |part| format!("{:.0} %", 100.0 * part));
    lines.push(["lanes at work".to_owned()].into_iter().chain(rows.iter().map(percent)).collect());
    let title = format!("width {width}");
    let header: Vec<&str> = [title.as_str()].into_iter().chain(rows.iter().map(|row| row.traversal.as_str())).collect();
    table(&header, &lines)
}

fn whole_table(whole: &[Whole]) -> String {
    let rows = whole.iter().map(|w| {
        let mut row = vec![w.column.title().into(), w.setup.to_string()];
        row.extend([format!("{:.3}", w.seconds), format!("{:.2}", w.mrays_per_s)]);
        row.extend(w.shares.map(|share| format!("{:.1} %", 100.0 * share)));
        row
    });
    table(&["method", "level", "seconds", "Mrays/s", "traversal", "shading", "generation"], &rows.collect::<Vec<_>>())
}

/// Names of scenes in the order of the paper.
pub fn scenes(names: &[Name]) -> Vec<Name> {
    let all = [Name::Sponza, Name::Fairy, Name::Conference];
    all.into_iter().filter(|name| names.is_empty() || names.contains(name)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_paper_as_printed() {
        let row = paper::table(Surface::Specular).row(1, Name::Conference);
        assert_eq!(paper_cells(row), ["17.3", "10.0 (1.7x)", "8.2 (2.1x)", "7.9 (2.2x)"]);
    }

    #[test]
    fn scenes_in_order() {
        assert_eq!(scenes(&[Name::Conference, Name::Sponza]), [Name::Sponza, Name::Conference]);
        assert_eq!(scenes(&[]).len(), 3);
    }
}
