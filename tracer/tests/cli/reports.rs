//! `tracer compare`, `tracer info`, help.

use crate::{Folder, SQUARES, levels, parts};
use std::process::Stdio;

/// Levels but serial, of which there is a row of its own: emulated float4.
fn compared() -> usize {
    levels().len() - usize::from(simd::Level::new(simd::Isa::Serial).is_some())
}

/// That row, a plain one and three widths at each level.
fn packet_rows() -> usize {
    levels().len() - compared() + 1 + 3 * compared()
}

#[test]
fn the_comparison_as_json() {
    let folder = Folder::new();
    let report = folder.json("compare balls:1 --size 64x48 --repeat 1 --format json");
    assert_eq!(report["all_identical"], true);
    assert_eq!((&report["scene"], &report["triangles"]), (&"balls".into(), &1922.into()));
    let rows = report["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), packet_rows());
    for row in rows {
        assert_eq!((&row["hits_hash"], &row["identical"]), (&rows[0]["hits_hash"], &true.into()), "{row}");
        assert_eq!(row["image_hash"], rows[0]["image_hash"], "{row}");
        for key in ["eye_ms", "cast_ms", "shade_ms", "total_ms", "mrays_per_s", "cast_speedup", "all_threads_total_ms"]
        {
            assert!(row[key].as_f64().is_some_and(|n| n > 0.0), "{key} of {row}");
        }
        // The paper's SSE: 5.2 to 6.1. AltiVec: 8 to 11.
        let paper = match (row["level"].as_str(), row["width"].as_u64()) {
            (Some("sse2" | "sse4.2"), Some(4)) => Some((5.2, 3.9)),
            (Some("neon"), Some(4)) => Some((8.0, 8.1)),
            _ => None,
        };
        assert_eq!(
            (row["paper_cast_min"].as_f64(), row["paper_total_max"].as_f64()),
            (paper.map(|p| p.0), paper.map(|p| p.1))
        );
    }
    if simd::Level::new(simd::Isa::Serial).is_some() {
        let names: Vec<_> = rows[..3].iter().map(|r| r["name"].as_str().expect("a name")).collect();
        assert_eq!(names, ["emulated float4", "f32, one lane", "float4 as LLVM likes"]);
    }
    assert_eq!(rows[0]["cast_speedup"], 1.0);
    let tests = report["tests"].as_array().expect("tests");
    let boxes: Vec<f64> = tests.iter().map(|t| t["box_tests_per_ray"].as_f64().expect("a number")).collect();
    assert!(boxes.len() == 4 && boxes.is_sorted_by(|a, b| a > b), "wider packets share tests: {boxes:?}");
}

#[test]
fn every_method_finds_the_same() {
    let folder = Folder::new();
    let packet = folder.json("render balls:1 --size 64x48 --shadows --json");
    assert_eq!(packet["method"], "packet");
    for method in
        ["ordered", "single4", "single8", "single16", "boulos-adaptive", "breadth-first", "divide-conquer", "auto"]
    {
        let other = folder.json(&format!("render balls:1 --size 64x48 --shadows --json --method {method}"));
        assert_eq!(other["method"], method);
        assert_eq!(
            (&other["hits_hash"], &other["image_hash"]),
            (&packet["hits_hash"], &packet["image_hash"]),
            "{method}"
        );
        let report = folder.json(&format!("compare balls:1 --size 64x48 --repeat 1 --format json --method {method}"));
        assert_eq!(report["all_identical"], true, "{method}");
        let rows = report["rows"].as_array().expect("rows");
        let named = rows.iter().filter(|row| row["name"].as_str().is_some_and(|name| name.contains(method))).count();
        let expected = match method {
            "ordered" => 3 * compared(),
            // Plain Rust has one lane.
            "boulos-adaptive" | "breadth-first" | "divide-conquer" => 1 + 3 * (compared() - 1),
            _ => compared(),
        };
        assert_eq!(named, expected, "{method}");
        assert_eq!(rows[0]["hits_hash"], packet["hits_hash"], "{method}");
    }
}

#[test]
fn every_order_of_rays_finds_the_same() {
    let folder = Folder::new();
    let plain = folder.json("render balls:1 --size 64x48 --shadows --json");
    assert_eq!(plain["reorder"], "none");
    let path = folder.json("render balls:1 --size 32x24 --integrator path --json");
    for order in ["hash", "origin", "direction"] {
        let other = folder.json(&format!("render balls:1 --size 64x48 --shadows --json --reorder {order}"));
        assert_eq!(other["reorder"], order);
        assert_eq!((&other["hits_hash"], &other["image_hash"]), (&plain["hits_hash"], &plain["image_hash"]), "{order}");
        let other = folder.json(&format!("render balls:1 --size 32x24 --integrator path --json --reorder {order}"));
        assert_eq!(other["image_hash"], path["image_hash"], "{order}");
    }
    let report = folder.json("compare balls:1 --size 64x48 --repeat 1 --format json --method auto --reorder hash");
    assert_eq!(report["all_identical"], true);
    let rows = report["rows"].as_array().expect("rows");
    let sorted =
        rows.iter().filter(|row| row["name"].as_str().is_some_and(|name| name.ends_with("auto, sorted by hash")));
    assert_eq!(sorted.count(), compared());
    folder.fails("render balls:1 --reorder size", 2, &["unknown order 'size'; known: none, hash, origin, direction"]);
}

#[test]
fn the_comparison_in_all_formats() {
    let folder = Folder::with("a_&_b.obj", SQUARES);
    let compare = |more: &str| folder.run(&format!("compare a_&_b.obj --size 24x24 --repeat 1 --threads 2 {more}"));
    let rows = packet_rows();

    let table = compare("");
    assert!(table.contains("All rows found the same bits") && table.contains("f32, one lane"), "{table}");
    assert!(table.lines().filter(|l| l.trim_end().ends_with("yes")).count() == rows, "{table}");

    compare("-o speed.md");
    let markdown = folder.text("speed.md");
    let lines: Vec<&str> = markdown.lines().filter(|l| l.starts_with('|')).collect();
    assert_eq!(lines.len(), (2 + rows) + (2 + 4), "{markdown}");
    let columns = |line: &str| line.matches('|').count();
    assert!(lines[..2 + rows].iter().all(|l| columns(l) == 16), "{markdown}");

    compare("-o speed.csv");
    let text = folder.read("speed.csv");
    let mut csv = csv::Reader::from_reader(&text[..]);
    let headers = csv.headers().expect("names").clone();
    let all: Vec<csv::StringRecord> = csv.records().map(|r| r.expect("a row")).collect();
    let column = |name: &str| headers.iter().position(|h| h == name).expect("a column");
    assert_eq!(all.len(), rows);
    assert!(all.iter().all(|r| &r[column("identical")] == "true" && r[column("total_ms")].parse::<f64>().is_ok()));

    compare("-o speed.svg");
    let svg = folder.text("speed.svg");
    assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n") && svg.contains("a_&amp;_b"), "{svg}");
    assert_eq!(svg.matches("Mrays/s").count(), rows);
    balanced(&svg);
    assert_eq!(folder.files(), ["a_&_b.obj", "speed.csv", "speed.md", "speed.svg"]);
}

/// Every element is closed, in order, and no number is missing.
fn balanced(svg: &str) {
    let mut open = Vec::new();
    for tag in svg.split('<').skip(1).map(|t| t.split('>').next().unwrap_or_default()) {
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name));
        } else if !tag.ends_with('/') {
            open.push(tag.split_whitespace().next().unwrap_or_default());
        }
    }
    assert!(open.is_empty(), "{open:?}");
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
}

#[test]
fn what_the_machine_has() {
    let folder = Folder::new();
    let out = folder.run("info");
    assert!(out.contains("CPU") && out.contains(&levels().join(" ")) && out.contains("node 32 bytes"), "{out}");
    let report = folder.json("info --json");
    assert_eq!(report["level"], simd::Level::best().to_string());
    assert_eq!(
        (&report["node_bytes"], &report["triangle_bytes"], &report["scene"]),
        (&32.into(), &48.into(), &().into())
    );

    let scene = folder.json("info balls:1 --json")["scene"].clone();
    assert_eq!((&scene["triangles"], &scene["build"]), (&1922.into(), &"medium".into()));
    assert!(scene["bytes_per_triangle"].as_f64().is_some_and(|b| b > 48.0 && b < 130.0), "{scene}");
    let insertion = folder.json("info balls:1 --json --build insertion")["scene"].clone();
    assert!(insertion["sah_cost"].as_f64() > scene["sah_cost"].as_f64(), "{insertion} {scene}");
    let of = |build: &str| folder.json(&format!("info balls:1 --json --build {build}"))["scene"].clone();
    let cost = |build: &str| of(build)["sah_cost"].as_f64().expect("a cost");
    assert!(cost("high") < cost("medium"));
    let overlap = |build: &str| folder.json(&format!("info balls:1 --json --epo --build {build}"))["scene"].clone();
    assert!(overlap("high")["epo_cost"].as_f64() < overlap("fast")["epo_cost"].as_f64());
    assert!(scene["epo_cost"].is_null() && folder.run("info balls:1 --epo").contains("EPO cost"));
    let (wide, peak) = (scene["wide_bytes"].as_u64().expect("bytes"), scene["peak_bytes"].as_u64().expect("bytes"));
    assert!(scene["wide_bytes_per_triangle"].as_f64().is_some_and(|b| (b - wide as f64 / 1922.0).abs() < 1e-6));
    assert!(wide > 1922 * 40 && wide < peak && peak < 1922 * 500, "{scene}");
    let names = ["binned", "fast", "high"].map(|build| of(build)["build"].as_str().map(String::from));
    assert_eq!(names, ["medium", "fast", "high"].map(|name| Some(name.into())));
    assert!(folder.run("info rings:1").contains("6,242"));
    assert!(folder.files().is_empty());
}

/// The environment forces a level; an option wins over it.
#[test]
fn forced_levels() {
    let folder = Folder::new();
    let info = |level: &str, arguments: &str| {
        let (out, code, err) = parts(&folder.command(arguments).env("SIMD_LEVEL", level).output().expect("started"));
        assert_eq!(code, Some(0), "{err}");
        let report: serde_json::Value = serde_json::from_str(&out).expect("JSON");
        (report["level"].as_str().expect("a level").to_owned(), report["why"].as_str().expect("a reason").to_owned())
    };
    let best = simd::Level::best().to_string();
    let of_env = ("scalar".into(), "asked for by SIMD_LEVEL".into());
    assert_eq!(info("scalar", "info --json"), of_env);
    assert_eq!(info("scalar", "info --json --level auto"), (best.clone(), "the fastest of this CPU".into()));
    assert_eq!(info("scalar", &format!("info --json --level {best}")), (best.clone(), "asked for by --level".into()));
    assert_eq!(info("auto", "info --json").0, best);
    assert_eq!(info("", "info --json").0, best);
    for arguments in ["info", "render balls:0 --size 8x8", "trace balls:0 --rays r --hits h"] {
        let output = folder.command(arguments).env("SIMD_LEVEL", "sse5").output().expect("started");
        let (_, code, err) = parts(&output);
        assert_eq!(code, Some(2), "{err}");
        assert!(err.starts_with("error: SIMD_LEVEL: unknown level 'sse5'; known: auto, "), "{err}");
    }
    assert!(folder.files().is_empty());
}

#[test]
fn help_is_grouped_and_has_examples() {
    let folder = Folder::new();
    for command in ["", "render ", "compare ", "info ", "trace ", "generate "] {
        let help = folder.run(&format!("{command}--help"));
        assert!(help.contains("Usage:") && help.contains("Examples:\n  tracer"), "{help}");
    }
    let help = folder.run("render --help");
    for heading in ["Picture:\n", "Tree:\n", "Tracing:\n"] {
        assert!(help.contains(heading), "{help}");
    }
}

/// A reader that goes away (`| head`) is nothing to complain about.
#[test]
fn a_closed_pipe_is_no_error() {
    let folder = Folder::new();
    for arguments in ["info balls:1", "--help", "compare balls:0 --size 8x8 --repeat 1"] {
        let mut child =
            folder.command(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("started");
        drop(child.stdout.take());
        let (_, code, err) = parts(&child.wait_with_output().expect("ended"));
        assert_eq!((code, err.as_str()), (Some(0), ""), "{arguments}");
    }
}
