//! Rays per triangle against time.

use super::dynamic::{Dynamic, Point, Rays};
use crate::report::chart::{self, Area, COLORS, Drawn, Line, builder, legend, svg};
use plotters::prelude::*;
use tracer::Error;

/// The name of a scene's figure.
pub fn file(dynamic: &Dynamic) -> String {
    format!("afra_figure_{}.svg", dynamic.scene.file())
}

/// Names of the files and what is in them, for scenes with several sizes.
pub fn all<'a>(dynamics: impl Iterator<Item = &'a Dynamic>) -> Result<Vec<(String, String)>, Error> {
    let drawn = dynamics.filter(|d| !d.points.is_empty()).map(|d| Ok((file(d), svg(|area| figure(d, area))?)));
    drawn.collect()
}

fn figure(dynamic: &Dynamic, area: &Area<'_>) -> Drawn {
    let mut lines = Vec::new();
    for (rays, with) in [(Rays::Path, "with 1 bounce"), (Rays::Eye, "eye rays alone")] {
        for (i, name) in ["DAC", "fast tree", "medium tree"].into_iter().enumerate() {
            let seconds = |p: &Point| if i == 0 { dynamic.total(p, 0, rays) } else { dynamic.best_by(i, p, rays) };
            let at = |p: &Point| (dynamic.rays_per_triangle(p, rays), 1e3 * seconds(p));
            let points = dynamic.points.iter().map(at).filter(|(x, y)| *x > 0.0 && *y > 0.0).collect();
            let (color, dashed) = (COLORS[i], rays == Rays::Eye);
            lines.push(Line { name: format!("{name}, {with}"), color, dashed, points });
        }
    }
    let bounds = |of: fn(&(f64, f64)) -> f64| {
        let values = || lines.iter().flat_map(|line| &line.points).map(of);
        0.8 * values().fold(f64::INFINITY, f64::min)..1.25 * values().fold(0.0, f64::max)
    };
    let (xs, ys) = (bounds(|p| p.0), bounds(|p| p.1));
    let title = format!("Build and trace, one thread, {} ({} triangles)", dynamic.scene, dynamic.triangles);
    let mut chart = builder(area, &title).build_cartesian_2d(xs.log_scale(), ys.log_scale())?;
    let short = |value: &f64| if *value < 1.0 { format!("{value:.2}") } else { format!("{value:.0}") };
    chart
        .configure_mesh()
        .x_desc("rays per triangle")
        .y_desc("CPU time of a frame, ms")
        .x_label_formatter(&short)
        .y_label_formatter(&short)
        .label_style(("sans-serif", 15))
        .light_line_style(RGBColor(235, 235, 235))
        .draw()?;
    chart::lines(&mut chart, &lines)?;
    legend(&mut chart, SeriesLabelPosition::UpperLeft)
}

#[cfg(test)]
mod tests {
    use super::super::scenes::Name;
    use super::*;

    #[test]
    fn a_figure_is_labelled() {
        let point = |n: usize| Point { pixels: [n, 1], rays: [n, n / 2], trace: [[0.001 * n as f64; 2]; 5] };
        let mut dynamic = Dynamic {
            scene: Name::Hairball,
            triangles: 1000,
            level: "avx2".into(),
            builds: [0.001, 0.1, 0.2],
            frame: point(100),
            points: [10, 100, 1000].map(point).into(),
        };
        let figures = all([&dynamic].into_iter()).expect("drawn");
        let (name, text) = &figures[0];
        assert_eq!((figures.len(), name.as_str()), (1, "afra_figure_hairball.svg"));
        assert!(text.starts_with("<svg") && !text.contains("NaN") && !text.contains("inf"));
        for word in ["rays per triangle", "DAC, eye rays alone", "medium tree, with 1 bounce"] {
            assert!(text.contains(word), "no {word}");
        }
        dynamic.points.clear();
        assert!(all([&dynamic].into_iter()).expect("nothing to draw").is_empty());
    }
}
