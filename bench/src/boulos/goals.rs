//! What must be reached, and whether it was.

use super::counts::{Counts, WIDTHS};
use super::frames::{Column, Frames};
use crate::report::goals::{Bound, Goal};
use tracer::method::{Traversal, Width};

/// Of the conference room's diffuse frames: ratios of times at each level and width.
pub fn of_times(frames: &Frames) -> Vec<Goal> {
    let Some(row) = frames.rows.last() else { return Vec::new() };
    let mut goals = Vec::new();
    let lanes = frames.setup.lanes();
    let mut goal = |over: Column, least: f64| {
        let (other, adaptive) = (row.cell(over), row.cell(Column::Reordered));
        goals.push(Goal {
            what: format!("adaptive over {}, {}, {} bounces", over.title(), frames.setup, row.bounces),
            bound: Bound::AtLeast(least),
            values: vec![
                ("frame".into(), Some(other.frame / adaptive.frame)),
                ("traversal".into(), Some(other.traversal / adaptive.traversal)),
            ],
        });
    };
    match lanes {
        4 => {
            goal(Column::Packet, 1.5);
            goal(Column::Single, 1.5);
        }
        8 => goal(Column::Single, 2.0),
        _ => goal(Column::Single, 3.0),
    }
    goal(Column::Simd, 1.0);
    let eye = |column: Column| frames.eye[column as usize];
    goals.push(Goal {
        what: format!("adaptive over {}, {}, eye rays", Column::Packet.title(), frames.setup),
        bound: Bound::AtLeast(0.95),
        values: vec![("traversal".into(), Some(eye(Column::Packet) / eye(Column::Reordered)))],
    });
    goals
}

/// Of what was counted.
pub fn of_counts(counts: &Counts) -> Vec<Goal> {
    let line = |width, traversal, line: usize| counts.row(width, traversal).map_or(0.0, |row| row.per_ray[line]);
    let ratio = |a: f64, b: f64| (b > 0.0).then(|| a / b);
    let mut goals = Vec::new();
    let mut goal =
        |what: String, bound, name: &str, value| goals.push(Goal { what, bound, values: vec![(name.into(), value)] });
    for (width, most) in [(Width::Four, 0.35), (Width::Sixteen, 0.17)] {
        let boxes = |traversal| line(width, traversal, 0);
        let value = ratio(boxes(Traversal::Adaptive), boxes(Traversal::Single));
        goal(format!("box tests, adaptive over single, width {width}"), Bound::AtMost(most), "ratio", value);
    }
    for width in WIDTHS {
        let reordered = |traversal| line(width, traversal, 2);
        let value = ratio(reordered(Traversal::Adaptive), reordered(Traversal::Exact));
        goal(format!("rays reordered, adaptive over exact, width {width}"), Bound::AtMost(0.4), "ratio", value);
    }
    let utilization = counts.row(Width::Sixteen, Traversal::Adaptive).and_then(|row| row.utilization());
    goal("lanes at work in box tests, adaptive, width 16".into(), Bound::AtLeast(0.45), "part", utilization);
    goals
}
