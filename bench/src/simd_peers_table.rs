//! Prints what the benchmark `simd_peers` measured as a table in Markdown: kernels and contestants, the medians over the rounds
//! that `bench/simd_peers.sh` ran, and how many times as long as the intrinsics of that level it took. With `--crates`, also the
//! lines of each crate and the seconds of a clean release build with one job.
//!
//! ```text
//! bench/simd_peers.sh
//! ```

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

/// In the order of the benchmark, with the elements of a run.
const KERNELS: [(&str, usize); 8] = [
    ("slab", 1024),
    ("triangle", 1024),
    ("mandelbrot", 256 * 64),
    ("dot", 4096),
    ("transpose", 8 * 1024),
    ("compress", 4096),
    ("sin_cos", 4096),
    ("gather", 4096),
];

/// Directories of Criterion and the level whose intrinsics they are compared with.
const CONTESTANTS: [(&str, &str, &str); 17] = [
    ("intrinsics", "avx512", "avx512"),
    ("simd", "avx512", "avx512"),
    ("pulp", "avx512", "avx512"),
    ("fearless_simd", "avx512", "avx512"),
    ("wide", "avx512 build", "avx512"),
    ("plain", "avx512", "avx512"),
    ("intrinsics", "avx2", "avx2"),
    ("simd", "avx2", "avx2"),
    ("pulp", "avx2", "avx2"),
    ("fearless_simd", "avx2", "avx2"),
    ("wide", "avx2 build", "avx2"),
    ("plain", "avx2", "avx2"),
    ("simd", "sse4.2", "avx2"),
    ("fearless_simd", "sse4.2", "avx2"),
    ("wide", "sse4.2 build", "avx2"),
    ("wide", "sse2 build", "avx2"),
    ("plain", "baseline", "avx2"),
];

fn main() -> Result<(), Box<dyn Error>> {
    let target = Path::new(env!("CARGO_MANIFEST_DIR")).join("../target");
    let medians = medians(&target.join("criterion"))?;
    println!("Elements per ns; in brackets the time relative to the intrinsics of the level (below AVX2: of AVX2).\n");
    println!("| | {} |", KERNELS.map(|(kernel, _)| kernel).join(" | "));
    println!("|---|{}", "---|".repeat(KERNELS.len()));
    for (who, level, limit) in CONTESTANTS {
        let cells = KERNELS.map(|(kernel, elements)| {
            let of = |who: &str, level: &str| medians.get(&[kernel, who, level].map(String::from)).copied();
            of(who, level).map(|ns| {
                let rate = format!("{:.2}", elements as f64 / ns);
                let ratio = of("intrinsics", limit).filter(|_| who != "intrinsics");
                ratio.map_or(rate.clone(), |limit| format!("{rate} ({:.2})", ns / limit))
            })
        });
        if cells.iter().any(Option::is_some) {
            let cells = cells.map(|cell| cell.unwrap_or_else(|| "–".into()));
            println!("| {who} {level} | {} |", cells.join(" | "));
        }
    }
    if std::env::args().any(|argument| argument == "--crates") {
        println!("\n| crate | version | lines in src | clean release build, one job |\n|---|---|---|---|");
        for name in ["simd", "wide", "pulp", "fearless_simd"] {
            let (version, lines, seconds) = crate_costs(name, &target)?;
            println!("| {name} | {version} | {lines} | {seconds:.1} s |");
        }
    }
    Ok(())
}

/// Nanoseconds, by kernel, contestant and level: the median over the rounds.
fn medians(criterion: &Path) -> Result<BTreeMap<[String; 3], f64>, Box<dyn Error>> {
    let name = |path: &Path| path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let mut medians = BTreeMap::new();
    for (kernel, _) in KERNELS {
        for who in directories(&criterion.join(kernel))? {
            for level in directories(&who)? {
                let mut rounds = Vec::new();
                for round in directories(&level)?.into_iter().filter(|path| name(path).starts_with("round")) {
                    let estimates = fs::read_to_string(round.join("estimates.json"))?;
                    let estimates: serde_json::Value = serde_json::from_str(&estimates)?;
                    rounds.push(estimates["median"]["point_estimate"].as_f64().ok_or("no median in estimates.json")?);
                }
                rounds.sort_by(f64::total_cmp);
                if let Some(&median) = rounds.get(rounds.len() / 2) {
                    medians.insert([kernel.to_owned(), name(&who), name(&level)], median);
                }
            }
        }
    }
    Ok(medians)
}

fn directories(path: &Path) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let entries =
        fs::read_dir(path).map_err(|error| format!("{}: {error}; run bench/simd_peers.sh first", path.display()))?;
    let paths: Vec<_> = entries.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>()?;
    Ok(paths.into_iter().filter(|path| path.is_dir()).collect())
}

/// Version, lines of code, and seconds of a build with its dependencies.
fn crate_costs(name: &str, target: &Path) -> Result<(String, usize, f64), Box<dyn Error>> {
    let metadata = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--locked"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .stderr(Stdio::inherit())
        .output()?;
    let metadata: serde_json::Value = serde_json::from_slice(&metadata.stdout)?;
    let packages = metadata["packages"].as_array().ok_or("no packages in the metadata")?;
    let package = packages.iter().find(|package| package["name"] == name).ok_or("a crate is not in the metadata")?;
    let version = package["version"].as_str().ok_or("no version in the metadata")?;
    let manifest = Path::new(package["manifest_path"].as_str().ok_or("no path in the metadata")?);
    let source = manifest.with_file_name("src");

    // A directory of its own, so that nothing is there already.
    let scratch = target.join("simd-peers-table").join(name);
    if scratch.exists() {
        fs::remove_dir_all(&scratch)?;
    }
    // And a package that depends on nothing else, at the version and path that are measured.
    fs::create_dir_all(scratch.join("src"))?;
    fs::write(scratch.join("src/lib.rs"), "")?;
    let path = manifest.with_file_name("");
    let features = if name == "pulp" { "\"x86-v4\"" } else { "" };
    let dependency = format!("{name} = {{ path = {path:?}, features = [{features}] }}");
    let package = "[package]\nname = \"scratch\"\nedition = \"2024\"\n[workspace]\n[dependencies]\n";
    fs::write(scratch.join("Cargo.toml"), format!("{package}{dependency}\n"))?;
    fs::copy(target.with_file_name("Cargo.lock"), scratch.join("Cargo.lock"))?;
    let clock = Instant::now();
    let status = Command::new(env!("CARGO"))
        .args(["build", "--quiet", "--release", "--jobs", "1", "--target-dir", "target"])
        .current_dir(&scratch)
        .status()?;
    let seconds = clock.elapsed().as_secs_f64();
    fs::remove_dir_all(&scratch)?;
    if !status.success() {
        return Err(format!("the build of {name} failed").into());
    }
    Ok((version.to_owned(), lines(&source)?, seconds))
}

/// Lines of Rust that are neither blank nor comments.
fn lines(directory: &Path) -> std::io::Result<usize> {
    let mut sum = 0;
    for entry in fs::read_dir(directory)? {
        let path = entry?.path();
        if path.is_dir() {
            sum += lines(&path)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            sum += code_lines(&fs::read_to_string(path)?);
        }
    }
    Ok(sum)
}

fn code_lines(source: &str) -> usize {
    let mut in_comment = false;
    let is_code = |line: &&str| {
        let line = line.trim();
        if in_comment || line.starts_with("/*") {
            in_comment = !line.contains("*/");
            return false;
        }
        // What `#[doc = "..."]` says is a comment too.
        !(line.is_empty() || line.starts_with("//") || line.starts_with("#[doc"))
    };
    source.lines().filter(is_code).count()
}

#[cfg(test)]
mod tests {
    #[test]
    fn comments_are_no_code() {
        let source = "//! About.\n\n/* more\nof it */\nfn f() {\n    // nothing\n    g(); // here\n}\n#[doc = \"x\"]\n";
        assert_eq!(super::code_lines(source), 3);
    }
}
