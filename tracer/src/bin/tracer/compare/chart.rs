//! The comparison as a bar chart for a talk, in SVG.

use super::report::{Report, Row};
use indicatif::HumanCount;
use std::fmt::Write;

const WIDTH: f64 = 1120.0;
const LEFT: f64 = 250.0;
const RIGHT: f64 = 920.0;
const TOP: f64 = 132.0;
const BAR: f64 = 24.0;
const STEP: f64 = 30.0;
const GAP: f64 = 16.0;
/// Room for what stands behind a bar.
const LABEL: f64 = 160.0;
const INK: &str = "#1f2933";
const SOFT: &str = "#52606d";
const PAPER: &str = "#f0b429";
/// Width of the packets and colour of their bars; distinct to the colour-blind too.
const COLORS: [(usize, &str); 4] = [(1, "#9aa5b1"), (4, "#0072b2"), (8, "#009e73"), (16, "#cc5a00")];

/// A bar for each row: speed-up of casting over emulation.
pub fn svg(report: &Report) -> String {
    let paper_max = report.rows.iter().filter_map(|r| Some(r.paper_cast()?[1]));
    let max = report.rows.iter().map(|r| r.cast_speedup).chain(paper_max).fold(1.0, f64::max);
    let tick = [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0].into_iter().find(|t| max / t <= 9.0).unwrap_or(100.0);
    let scale = Scale { end: (max / tick).ceil() * tick, tick };
    let mut body = String::new();
    let bottom = bars(report, &scale, &mut body);
    let height = bottom + 96.0;
    let mut out = String::new();
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" width=\"{WIDTH}\" height=\"{height}\" \
         font-family=\"Helvetica, Arial, 'Liberation Sans', sans-serif\" font-size=\"16\" fill=\"{INK}\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>"
    );
    heading(report, &mut out);
    axis(&scale, bottom, &mut out);
    out += &body;
    footer(report, bottom, &mut out);
    out += "</svg>\n";
    out
}

struct Scale {
    end: f64,
    tick: f64,
}

impl Scale {
    fn x(&self, value: f64) -> f64 {
        LEFT + (RIGHT - LEFT) * value / self.end
    }
}

fn heading(r: &Report, out: &mut String) {
    let (scene, cpu, triangles) = (escape(&r.scene), escape(&r.cpu), HumanCount(r.triangles as u64));
    let shadows = if r.shadows { "eye and shadow rays" } else { "eye rays" };
    let _ = writeln!(
        out,
        "<text x=\"32\" y=\"44\" font-size=\"26\" font-weight=\"bold\">Ray casting: speed-up over emulated float4</text>\n\
         <text x=\"32\" y=\"72\" fill=\"{SOFT}\">{scene}, {triangles} triangles, {}×{} {shadows}, one thread; {cpu}</text>",
        r.width, r.height
    );
    let mut x = 32.0;
    for (width, color) in COLORS {
        let rays = if width == 1 { "1 ray at a time".into() } else { format!("{width} rays") };
        let _ = writeln!(
            out,
            "<rect x=\"{x}\" y=\"88\" width=\"14\" height=\"14\" rx=\"2\" fill=\"{color}\"/>\
             <text x=\"{}\" y=\"101\">{rays}</text>",
            x + 22.0
        );
        x += 44.0 + 8.5 * rays.len() as f64;
    }
    if r.rows.iter().any(|r| r.paper_cast().is_some()) {
        let _ = writeln!(
            out,
            "<rect x=\"{x}\" y=\"88\" width=\"26\" height=\"14\" fill=\"{PAPER}\" fill-opacity=\"0.55\"/>\
             <text x=\"{}\" y=\"101\">as printed in Geimer &amp; Müller 2003</text>",
            x + 34.0
        );
    }
}

fn axis(scale: &Scale, bottom: f64, out: &mut String) {
    let ticks = (scale.end / scale.tick).round() as usize;
    for value in (0..=ticks).map(|i| i as f64 * scale.tick) {
        let (x, y) = (scale.x(value), bottom + 22.0);
        let color = if value == 0.0 { SOFT } else { "#e4e7eb" };
        let _ = writeln!(
            out,
            "<line x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{}\" y2=\"{bottom}\" stroke=\"{color}\"/>\
             <text x=\"{x:.1}\" y=\"{y}\" text-anchor=\"middle\" fill=\"{SOFT}\">{value}×</text>",
            TOP - 8.0
        );
    }
}

/// Draws all bars, grouped by level; returns where they end.
fn bars(report: &Report, scale: &Scale, out: &mut String) -> f64 {
    let mut groups: Vec<(&str, Vec<&Row>)> = Vec::new();
    for row in &report.rows {
        match groups.iter_mut().find(|g| g.0 == row.level) {
            Some(group) => group.1.push(row),
            None => groups.push((row.level, vec![row])),
        }
    }
    let mut y = TOP;
    for (level, rows) in groups {
        let name = match level {
            "serial" => "emulation".to_owned(),
            "scalar" => "plain Rust".to_owned(),
            other => other.to_uppercase(),
        };
        let (x, middle) = (LEFT - 52.0, y + 0.5 * (STEP * (rows.len() - 1) as f64 + BAR) + 6.0);
        let _ = writeln!(
            out,
            "<text x=\"{x}\" y=\"{middle}\" font-size=\"18\" font-weight=\"bold\" text-anchor=\"end\">{name}</text>"
        );
        for row in rows {
            bar(row, scale, y, out);
            y += STEP;
        }
        y += GAP;
    }
    y - GAP + STEP - BAR
}

fn bar(row: &Row, scale: &Scale, y: f64, out: &mut String) {
    let end = scale.x(row.cast_speedup);
    let color = COLORS.iter().find(|c| c.0 == row.width).map_or(INK, |c| c.1);
    let text_y = y + 0.5 * BAR + 6.0;
    let _ = writeln!(
        out,
        "<text x=\"{}\" y=\"{text_y}\" text-anchor=\"end\" fill=\"{SOFT}\">{}</text>\
         <rect x=\"{LEFT}\" y=\"{y}\" width=\"{:.1}\" height=\"{BAR}\" rx=\"2\" fill=\"{color}\"/>",
        LEFT - 12.0,
        row.width,
        end - LEFT
    );
    let mut label = end;
    if let Some([low, high]) = row.paper_cast() {
        let (low, high) = (scale.x(low), scale.x(high));
        // Behind the band where there is no room before it.
        if end + LABEL > low {
            label = label.max(high);
        }
        let _ = writeln!(
            out,
            "<rect x=\"{low:.1}\" y=\"{}\" width=\"{:.1}\" height=\"{}\" fill=\"{PAPER}\" fill-opacity=\"0.55\"/>",
            y - 3.0,
            high - low,
            BAR + 6.0
        );
    }
    let _ = writeln!(
        out,
        "<text x=\"{:.1}\" y=\"{text_y}\"><tspan font-weight=\"bold\">{:.1}×</tspan>\
         <tspan dx=\"10\" fill=\"{SOFT}\">{:.2} Mrays/s</tspan></text>",
        label + 10.0,
        row.cast_speedup,
        row.mrays_per_s
    );
}

fn footer(r: &Report, bottom: f64, out: &mut String) {
    let identical = if r.all_identical {
        "Every bar found the same hits and the same picture, bit for bit."
    } else {
        "NOT ALL ROWS ARE IDENTICAL: see the table."
    };
    let _ = writeln!(
        out,
        "<text x=\"32\" y=\"{}\" font-size=\"15\">{identical}</text>\n\
         <text x=\"32\" y=\"{}\" font-size=\"13\" fill=\"{SOFT}\">CPU time of one thread, median of {} rounds.</text>",
        bottom + 56.0,
        bottom + 78.0,
        r.repeat
    );
}

/// Text as XML has it.
fn escape(text: &str) -> String {
    let printable = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect::<String>();
    printable.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_break_the_markup() {
        assert_eq!(escape("a<b> & \"c\"\n"), "a&lt;b&gt; &amp; &quot;c&quot; ");
    }
}
