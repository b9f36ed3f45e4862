//! Figures 6 to 8 in SVG.

use super::counts::{Counts, WIDTHS};
use crate::report::chart::{self, Area, COLORS, Chart, Drawn, Line, SIZE, builder, legend, svg};
use plotters::prelude::*;
use tracer::Error;
use tracer::method::{Traversal, Width};

/// What figures 7 and 8 compare.
const COMPARED: [(Traversal, &str); 3] =
    [(Traversal::Simd, "SIMD"), (Traversal::Adaptive, "adaptive"), (Traversal::Exact, "exact")];

/// Names of the files and what is in them.
pub fn all(counts: &Counts) -> Result<Vec<(String, String)>, Error> {
    Ok(vec![
        ("boulos_figure6.svg".into(), svg(|area| figure_6(counts, area))?),
        ("boulos_figure7.svg".into(), svg(|area| figure_7(counts, area))?),
        ("boulos_figure8.svg".into(), svg(|area| figure_8(counts, area))?),
    ])
}

fn figure_6(counts: &Counts, area: &Area<'_>) -> Drawn {
    let lines = counts.benefits.iter().enumerate().map(|(i, benefit)| Line {
        name: format!("bounces: {}, {}", benefit.bounces, benefit.intervals),
        color: COLORS[i / 2 % COLORS.len()],
        dashed: benefit.intervals == "loose",
        points: (0..).map(f64::from).zip(benefit.by_depth.iter().copied()).collect(),
    });
    let title = "Benefit of interval tests by depth (conference, diffuse, never left out)";
    draw_lines(area, title, "box tests saved per ray, less interval tests", &lines.collect::<Vec<_>>())
}

fn figure_8(counts: &Counts, area: &Area<'_>) -> Drawn {
    let line = |(i, (traversal, name)): (usize, (Traversal, &str))| {
        let by_depth = counts.row(Width::Sixteen, traversal).map_or(&[][..], |row| &row.utilization_by_depth);
        let points = (0..).map(f64::from).zip(by_depth).filter_map(|(x, y)| Some((x, 100.0 * (*y)?)));
        Line { name: name.into(), color: COLORS[i], dashed: false, points: points.collect() }
    };
    let lines: Vec<Line> = COMPARED.into_iter().enumerate().map(line).collect();
    let title = "SIMD utilization of box tests by depth, width 16 (conference, diffuse, 2 bounces)";
    draw_lines(area, title, "lanes at work, %", &lines)
}

fn draw_lines(area: &Area<'_>, title: &str, y_title: &str, lines: &[Line]) -> Drawn {
    let points = || lines.iter().flat_map(|line| &line.points);
    let end = points().map(|p| p.0).fold(10.0, f64::max);
    let low = points().map(|p| p.1).fold(0.0, f64::min);
    let high = points().map(|p| p.1).fold(0.0, f64::max);
    // Without points there is still an axis.
    let room = if high > low { 0.05 * (high - low) } else { 1.0 };
    let low = if low < 0.0 { low - room } else { 0.0 };
    let mut chart = builder(area, title).build_cartesian_2d(0.0..end, low..high + room)?;
    grid(&mut chart, "depth of the node", y_title, 3)?;
    chart::lines(&mut chart, lines)?;
    legend(&mut chart, SeriesLabelPosition::UpperRight)
}

fn figure_7(counts: &Counts, area: &Area<'_>) -> Drawn {
    let (boxes, triangles) = area.split_vertically(SIZE.1 / 2);
    let value = |width, traversal, of_boxes: bool| {
        let row = counts.row(width, traversal)?;
        if of_boxes { row.box_speed_up } else { row.triangle_speed_up }
    };
    for (area, of_boxes, title) in [
        (&boxes, true, "Rays per box test (conference, diffuse, 2 bounces)"),
        (&triangles, false, "Rays per triangle test"),
    ] {
        let values: Vec<[f64; 3]> =
            WIDTHS.iter().map(|&width| COMPARED.map(|(t, _)| value(width, t, of_boxes).unwrap_or(0.0))).collect();
        let high = values.as_flattened().iter().copied().fold(1.0, f64::max);
        let mut chart = builder(area, title).build_cartesian_2d(0.0..WIDTHS.len() as f64 + 0.5, 0.0..1.25 * high)?;
        chart
            .configure_mesh()
            .disable_x_mesh()
            .disable_x_axis()
            .y_desc("SIMD speed-up")
            .y_labels(5)
            .y_label_formatter(&|y| format!("{y:.1}"))
            .label_style(("sans-serif", 15))
            .light_line_style(WHITE)
            .draw()?;
        // To the right of the bars there is room for the legend.
        for (i, (_, label)) in COMPARED.into_iter().enumerate() {
            let color = COLORS[i];
            let left = |group: usize| group as f64 + 0.14 + 0.24 * i as f64;
            let bars = values.iter().enumerate().map(|(group, value)| {
                Rectangle::new([(left(group), 0.0), (left(group) + 0.22, value[i])], color.filled())
            });
            chart
                .draw_series(bars)?
                .label(label)
                .legend(move |(x, y)| Rectangle::new([(x, y - 6), (x + 14, y + 6)], color.filled()));
            let small = ("sans-serif", 14).into_font().color(&BLACK);
            chart.draw_series(values.iter().enumerate().map(|(group, value)| {
                Text::new(format!("{:.2}", value[i]), (left(group) + 0.05, value[i] + 0.1 * high), small.clone())
            }))?;
        }
        let large = ("sans-serif", 16).into_font().color(&BLACK);
        chart.draw_series(WIDTHS.iter().enumerate().map(|(group, width)| {
            Text::new(format!("width {width}"), (group as f64 + 0.4, 1.2 * high), large.clone())
        }))?;
        legend(&mut chart, SeriesLabelPosition::UpperRight)?;
    }
    Ok(())
}

fn grid(chart: &mut Chart<'_, '_>, x: &str, y: &str, digits: usize) -> Drawn {
    let short = |value: &f64| format!("{value:.digits$}").trim_end_matches('0').trim_end_matches('.').to_owned();
    chart
        .configure_mesh()
        .x_desc(x)
        .y_desc(y)
        .x_label_formatter(&|x| format!("{x:.0}"))
        .y_label_formatter(&short)
        .label_style(("sans-serif", 15))
        .light_line_style(WHITE)
        .draw()
}

#[cfg(test)]
mod tests {
    use super::super::counts::{Benefit, CountRow, TRAVERSALS};
    use super::*;

    fn counts(by_depth: &[f64]) -> Counts {
        let row = |(width, traversal): (Width, Traversal)| CountRow {
            traversal: format!("{traversal:?}"),
            width: width.to_string().parse().expect("a number"),
            per_ray: [1.0; 6],
            box_speed_up: by_depth.first().copied(),
            triangle_speed_up: by_depth.first().copied(),
            utilization_by_depth: by_depth.iter().map(|&x| Some(x)).collect(),
        };
        let rows = WIDTHS.into_iter().flat_map(|width| TRAVERSALS.map(|traversal| row((width, traversal))));
        let benefit = |intervals| Benefit { intervals, bounces: 2, by_depth: by_depth.into() };
        Counts { rays: [1; 3], rows: rows.collect(), benefits: vec![benefit("tight"), benefit("loose")] }
    }

    /// Legends and axes are there, with and without anything counted.
    #[test]
    fn figures_are_labelled() {
        for by_depth in [&[0.5, -0.25, 0.125][..], &[]] {
            let figures = all(&counts(by_depth)).expect("drawn");
            for ((name, text), words) in figures.iter().zip([
                ["depth of the node", "bounces: 2, loose", "box tests saved"],
                ["width 16", "adaptive", "Rays per triangle test"],
                ["depth of the node", "exact", "lanes at work"],
            ]) {
                assert!(text.starts_with("<svg") && text.trim_end().ends_with("</svg>"), "{name}");
                assert!(!text.contains("NaN") && !text.contains("inf"), "{name}");
                for word in words {
                    assert!(text.contains(word), "{name} lacks {word}");
                }
            }
        }
    }
}
