//! The comparison as tables: for a terminal, in Markdown, as CSV.

use super::report::{Report, Row};
use crate::info::list;
use comfy_table::{CellAlignment, ContentLineStyle, LineStyle, Table, TableStyle, presets};
use indicatif::HumanCount;
use std::fmt::Write;
use tracer::Error;

/// Columns apart, a line below their names.
const PLAIN: TableStyle = TableStyle::new()
    .header_lines(ContentLineStyle::none().junction(' '))
    .header_separator(LineStyle::none().fill('-').junction('-'))
    .content_lines(ContentLineStyle::none().junction(' '));

/// For a terminal.
pub fn table(report: &Report) -> String {
    let mut text = String::new();
    for (name, value) in facts(report) {
        let _ = writeln!(text, "{name:<12} {value}");
    }
    write_tables(&mut text, report, PLAIN);
    for note in notes(report) {
        let _ = writeln!(text, "{note}");
    }
    text
}

/// The same in Markdown.
pub fn markdown(report: &Report) -> String {
    let mut text = String::new();
    for (name, value) in facts(report) {
        let _ = writeln!(text, "- {name}: {value}");
    }
    write_tables(&mut text, report, presets::ASCII_MARKDOWN);
    for note in notes(report) {
        let _ = writeln!(text, "{note}\n");
    }
    text
}

fn write_tables(text: &mut String, report: &Report, style: TableStyle) {
    let _ = write!(text, "\n{}\n\n", rows(report, style));
    if !report.tests.is_empty() {
        let _ = write!(text, "{}\n\n", tests(report, style));
    }
}

/// A line of names, then a line for each row.
pub fn csv(report: &Report) -> Result<String, Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let written = report.rows.iter().try_for_each(|row| writer.serialize(row));
    let bytes = written.map_err(|e| e.to_string()).and_then(|()| writer.into_inner().map_err(|e| e.to_string()));
    let text = bytes.and_then(|b| String::from_utf8(b).map_err(|e| e.to_string()));
    text.map_err(|e| Error::Geometry(format!("the report cannot be written as CSV: {e}")))
}

/// What was measured, where and how.
fn facts(r: &Report) -> [(&'static str, String); 6] {
    let shadows = if r.shadows { "eye and shadow rays" } else { "eye rays without shadows" };
    let load = r.load_average.map_or(String::new(), |l| format!("; load average {l:.2} when it began"));
    let triangles = HumanCount(r.triangles as u64);
    [
        ("scene", format!("{}, {triangles} triangles, {} tree", r.scene, r.build)),
        ("picture", format!("{}x{}, {shadows}, Phong shading; camera {}", r.width, r.height, r.camera)),
        ("CPU", format!("{}, {} threads{load}", r.cpu, r.threads)),
        ("levels", format!("{}; missing: {}", list(&r.levels), list(&r.missing))),
        ("measured", r.measurement.clone()),
        ("paper", "Geimer & Müller 2003: SSE on a Xeon 3.06 GHz, AltiVec on a G4 1 GHz".into()),
    ]
}

fn rows(report: &Report, style: TableStyle) -> String {
    let threads = report.threads;
    let mut header: Vec<String> =
        ["", "rays", "eye ms", "cast ms", "shade ms", "total ms", "Mrays/s", "cast x", "paper", "total x", "paper"]
            .map(String::from)
            .into();
    header.extend([format!("{threads} threads: cast ms"), "total ms".into(), "x".into(), "identical".into()]);
    let mut table = Table::new();
    table.load_style(style).set_header(header);
    table.add_rows(report.rows.iter().map(cells));
    aligned(table)
}

fn cells(r: &Row) -> Vec<String> {
    let time = |ms: f64| format!("{ms:.2}");
    let range = |range: Option<[f64; 2]>| range.map_or("-".into(), |[a, b]| format!("{a}-{b}"));
    vec![
        r.name.clone(),
        r.width.to_string(),
        time(r.eye_ms),
        time(r.cast_ms),
        time(r.shade_ms),
        time(r.total_ms),
        format!("{:.2}", r.mrays_per_s),
        format!("{:.2}", r.cast_speedup),
        range(r.paper_cast()),
        format!("{:.2}", r.total_speedup),
        range(r.paper_total()),
        time(r.all_threads_cast_ms),
        time(r.all_threads_total_ms),
        format!("{:.2}", r.all_threads_speedup),
        if r.identical { "yes" } else { "NO" }.into(),
    ]
}

fn tests(report: &Report, style: TableStyle) -> String {
    let mut table = Table::new();
    table.load_style(style);
    table.set_header(["eye rays", "box tests/ray", "triangle tests/ray", "lanes at work: box", "triangle"]);
    table.add_rows(report.tests.iter().map(|t| {
        let percent = |part: f64| format!("{:.0} %", 100.0 * part);
        [
            format!("packets of {}", t.width),
            format!("{:.2}", t.box_tests_per_ray),
            format!("{:.2}", t.triangle_tests_per_ray),
            percent(t.box_utilization),
            percent(t.triangle_utilization),
        ]
    }));
    aligned(table)
}

/// Numbers to the right.
fn aligned(mut table: Table) -> String {
    if table.style() == PLAIN {
        for column in table.column_iter_mut() {
            column.set_padding((0, 1));
        }
    }
    table.column_iter_mut().skip(1).for_each(|c| c.set_cell_alignment(CellAlignment::Right));
    table.trim_fmt()
}

/// What the tables leave open.
fn notes(report: &Report) -> Vec<String> {
    let mut notes = vec![
        "Times are of one thread unless the column says otherwise; x over emulated float4 (with all threads: over one \
         thread). A packet's test counts once."
            .to_owned(),
    ];
    match report.rows.first() {
        Some(r) if report.all_identical => notes.push(format!(
            "All rows found the same bits, with one thread and with {}: hits {}, image {}.",
            report.threads, r.hits_hash, r.image_hash
        )),
        _ => notes.extend(report.rows.iter().map(|r| {
            let same = if r.identical { "identical" } else { "NOT IDENTICAL" };
            format!("{}: hits {}, image {}: {same}", r.name, r.hits_hash, r.image_hash)
        })),
    }
    notes
}
