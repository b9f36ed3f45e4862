//! Charts in SVG.

use plotters::coord::ranged1d::Ranged;
use plotters::coord::types::RangedCoordf64;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use tracer::Error;

/// Of a picture, in pixels.
pub const SIZE: (u32, u32) = (960, 560);
/// Distinct to the colour-blind too.
pub const COLORS: [RGBColor; 3] = [RGBColor(0, 114, 178), RGBColor(204, 90, 0), RGBColor(0, 158, 115)];

pub type Area<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
pub type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;
/// With axes of any kind.
pub type ChartOf<'a, 'b, X, Y> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<X, Y>>;
/// With two plain axes.
pub type Chart<'a, 'b> = ChartOf<'a, 'b, RangedCoordf64, RangedCoordf64>;

/// The text of a picture.
pub fn svg(draw: impl FnOnce(&Area<'_>) -> Drawn) -> Result<String, Error> {
    let mut text = String::new();
    let area = SVGBackend::with_string(&mut text, SIZE).into_drawing_area();
    let drawn = area.fill(&WHITE).and_then(|()| draw(&area)).and_then(|()| area.present());
    drop(area);
    drawn.map_err(|e| Error::Geometry(format!("the figure cannot be drawn: {e}")))?;
    Ok(text)
}

/// A line of a chart.
pub struct Line {
    pub name: String,
    pub color: RGBColor,
    pub dashed: bool,
    pub points: Vec<(f64, f64)>,
}

/// Draws lines, with their names for the legend.
pub fn lines<'a, X, Y>(chart: &mut ChartOf<'a, '_, X, Y>, lines: &[Line]) -> Drawn
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    for line in lines {
        let style = line.color.stroke_width(2);
        let legend = move |(x, y)| PathElement::new([(x, y), (x + 22, y)], style);
        let points = line.points.iter().copied();
        if line.dashed {
            chart
                .draw_series(DashedLineSeries::new(points, 6, 4, style))?
                .label(&line.name)
                .legend(move |(x, y)| DashedPathElement::new([(x, y), (x + 22, y)], 6, 4, style));
        } else {
            chart.draw_series(LineSeries::new(points, style))?.label(&line.name).legend(legend);
        }
    }
    Ok(())
}

/// A chart with its title, and room for axes.
pub fn builder<'a, 'b>(area: &'a Area<'b>, title: &str) -> ChartBuilder<'a, 'b, SVGBackend<'b>> {
    let mut builder = ChartBuilder::on(area);
    builder.caption(title, ("sans-serif", 20)).margin(14).x_label_area_size(44).y_label_area_size(64);
    builder
}

/// The box with the names of what was drawn.
pub fn legend<'a, 'b: 'a, X, Y>(chart: &mut ChartOf<'a, 'b, X, Y>, position: SeriesLabelPosition) -> Drawn
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    chart
        .configure_series_labels()
        .position(position)
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(200, 200, 200))
        .label_font(("sans-serif", 15))
        .draw()
}
