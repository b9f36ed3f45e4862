//! README says how many `unsafe` blocks the crate has; this counts them.

use std::fs;
use std::path::Path;

/// Blocks in a folder's Rust sources: comments and functions that are unsafe to call are not counted.
fn unsafe_blocks(folder: &Path) -> usize {
    let mut sum = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sum += unsafe_blocks(&path);
        } else {
            let source = fs::read_to_string(&path).unwrap();
            let code = source.lines().map(|line| line.split("//").next().unwrap_or_default());
            sum += code.filter(|line| line.contains("unsafe {") || line.contains("unsafe impl")).count();
        }
    }
    sum
}

#[test]
fn readme_counts_them() {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let Ok(readme) = fs::read_to_string(package.join("../README.md")) else {
        println!("skipped: README.md is not beside the package");
        return;
    };
    // One of them is the macro around instructions on registers.
    let stated = format!("The crate has {} `unsafe` blocks", unsafe_blocks(&package.join("src")) - 1);
    assert!(readme.replace('\n', " ").contains(&stated), "README.md does not say: {stated}");
}
