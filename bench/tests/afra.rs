//! The report of Áfra 2012 in small: it runs, its methods agree, and it writes what it says.

use std::fs;
use std::path::Path;
use std::process::Command;

#[test]
fn a_smoke_run_writes_tables_and_figures() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("afra");
    let _ = fs::remove_dir_all(&folder);
    let mut command = Command::new(env!("CARGO_BIN_EXE_bench"));
    let done = command.args(["afra", "--quick", "--output"]).arg(&folder).output().expect("a program");
    let errors = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{errors}");
    let read = |name: &str| fs::read_to_string(folder.join(name)).expect(name);
    let report = read("afra.md");
    assert!(String::from_utf8_lossy(&done.stdout).trim().ends_with(report.trim()));
    for part in
        ["## Table 1", "paper: MBVH8", "## With building", "## Phases", "## Memory", "## Threads", "What must be"]
    {
        assert!(report.contains(part), "no {part}: {report}");
    }
    assert!(report.contains("the same hits in every batch") && !report.contains("NaN"), "{report}");
    assert!(read("afra.json").starts_with('{'));
    assert!(read("afra_figure_hairball.svg").contains("<svg"));
    if report.contains("Conference: scene not found") {
        println!("conference: scene not found, its table and figure are skipped");
        return;
    }
    assert!(read("afra_figure_conference.svg").contains("<svg"));
}
