//! Is the emulation that speed-ups are measured against an honest one? Compares, on the same rays in one run,
//!
//! - the fenced emulation (`--level serial`) of a normal build, and
//! - plain emulation (`--level scalar`) of a build with both `-C no-vectorize-slp` and `-C no-vectorize-loops`,
//!
//! four lanes wide, one thread, by CPU time, in turn. The first should not be slower than the second by more than 10 %.
//!
//! ```text
//! cargo run --release -p bench --bin serial-baseline [SCENE] [ROUNDS]
//! ```

use std::path::Path;
use std::process::Command;

const UNVECTORIZED: &str = "-C no-vectorize-slp -C no-vectorize-loops";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let scene = arguments.next().unwrap_or_else(|| "balls".into());
    let rounds: usize = arguments.next().map_or(Ok(7), |n| n.parse())?;

    build("target", "")?;
    build("target/unvectorized", UNVECTORIZED)?;
    let mut times = [Vec::new(), Vec::new()];
    for round in 0..rounds {
        times[0].push(cast("target", "serial", &scene)?);
        times[1].push(cast("target/unvectorized", "scalar", &scene)?);
        eprintln!("round {}: fenced {:.1} ms, unvectorized {:.1} ms", round + 1, times[0][round], times[1][round]);
    }
    let [fenced, unvectorized] = times.map(median);
    println!("{scene}, casting, median of {rounds} rounds: fenced {fenced:.1} ms, unvectorized {unvectorized:.1} ms");
    println!("fenced / unvectorized = {:.3}", fenced / unvectorized);
    Ok(())
}

fn build(target: &str, flags: &str) -> Result<(), Box<dyn std::error::Error>> {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["build", "--release", "-p", "tracer", "--target-dir", target]);
    if !flags.is_empty() {
        cargo.env("RUSTFLAGS", flags);
    }
    if cargo.status()?.success() { Ok(()) } else { Err(format!("the build with flags '{flags}' failed").into()) }
}

/// Milliseconds of CPU time of the casting pass.
fn cast(target: &str, level: &str, scene: &str) -> Result<f64, Box<dyn std::error::Error>> {
    let picture = Path::new(target).join("serial-baseline.png");
    let output = Command::new(Path::new(target).join("release/tracer"))
        .args(["render", scene, "--level", level, "--width", "4", "--threads", "1", "--json", "-o"])
        .arg(&picture)
        .output()?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into());
    }
    let report: serde_json::Value = serde_json::from_slice(&output.stdout)?;
    report["cast_ms"].as_f64().ok_or_else(|| format!("no cast_ms in {report}").into())
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
