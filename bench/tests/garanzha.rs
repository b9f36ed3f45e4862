//! The report of Garanzha and Loop 2010 in small: it runs, all ways find the same hits, and it writes what it says.

use std::fs;
use std::path::Path;
use std::process::Command;

#[test]
fn a_smoke_run_writes_tables_and_figures() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("garanzha");
    let _ = fs::remove_dir_all(&folder);
    let mut command = Command::new(env!("CARGO_BIN_EXE_bench"));
    let done = command.args(["garanzha", "--quick", "--scene", "fairy", "--output"]).arg(&folder).output();
    let done = done.expect("a program");
    let errors = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{errors}");
    let read = |name: &str| fs::read_to_string(folder.join(name)).expect(name);
    let report = read("garanzha.md");
    assert_eq!(report.trim(), String::from_utf8_lossy(&done.stdout).trim());
    assert!(!report.contains("NOT THE SAME") && report.contains("all ways found the same hits"), "{report}");
    assert!(report.contains("## Table 1") && report.contains("What must be reached"), "{report}");
    assert!(read("garanzha.json").starts_with('{'));
    assert!(read("garanzha_figure12_fairy.svg").contains("<svg"));
}
