//! Figure 12: million rays per second by the size of cells and packets.

use super::{Part, paper};
use crate::report::chart::{COLORS, Line, builder, legend, lines, svg};
use plotters::prelude::*;
use tracer::Error;

/// Names and texts of the figures.
pub fn all(parts: &[Part]) -> Result<Vec<(String, String)>, Error> {
    parts.iter().map(|part| Ok((file(part), figure(part)?))).collect()
}

/// The name of a scene's figure.
pub fn file(part: &Part) -> String {
    format!("garanzha_figure12_{}.svg", format!("{:?}", part.name).to_lowercase())
}

fn figure(part: &Part) -> Result<String, Error> {
    let cells = part.table.iter().zip(paper::PACKETS).zip(COLORS);
    let found: Vec<Line> = cells
        .map(|((row, packet), color)| Line {
            name: format!("at most {packet} rays in a packet"),
            color,
            dashed: false,
            points: row.iter().zip(paper::CELLS).map(|(cell, size)| (f64::from(size), cell.mrays)).collect(),
        })
        .collect();
    let most = found.iter().flat_map(|line| &line.points).fold(0.0_f64, |most, point| most.max(point.1));
    svg(|area| {
        let title = format!("{}: soft shadows by frusta, million rays per second", part.name);
        let mut builder = builder(area, &title);
        let mut chart = builder.build_cartesian_2d((0.0018_f64..0.018).log_scale(), 0.0..1.15 * most.max(1e-9))?;
        chart
            .configure_mesh()
            .x_desc("side of a cell, of the scene's diagonal")
            .y_desc("million rays per second")
            .x_labels(4)
            .x_label_formatter(&|x| format!("{x:.3}"))
            .light_line_style(WHITE)
            .draw()?;
        lines(&mut chart, &found)?;
        legend(&mut chart, SeriesLabelPosition::LowerRight)
    })
}
