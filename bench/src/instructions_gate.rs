//! Compares counts of instructions, as the benchmark `instructions` prints them, with the accepted ones in
//! `bench/instructions.txt`. Fails if a kernel takes over 2 % more; says so if it takes over 2 % fewer. Another compiler makes other
//! code: then it is 10 %. `bench/instructions.sh` runs both.
//!
//! ```text
//! instructions-gate COUNTS.json [--accept]
//! ```

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::process::{Command, ExitCode};

const ACCEPTED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/instructions.txt");
const ACCEPT: &str = "bench/instructions.sh --accept";

/// By kernel and level.
type Counts = BTreeMap<(String, String), u64>;

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let (accept, paths): (Vec<_>, Vec<_>) = std::env::args().skip(1).partition(|argument| argument == "--accept");
    let [path] = &paths[..] else { return Err("usage: instructions-gate COUNTS.json [--accept]".into()) };
    let counts = counted(&fs::read_to_string(path)?)?;
    let compiler = compiler()?;
    if !accept.is_empty() {
        fs::write(ACCEPTED, format(&compiler, &counts))?;
        println!("accepted {} counts", counts.len());
        return Ok(ExitCode::SUCCESS);
    }

    let text = fs::read_to_string(ACCEPTED).map_err(|error| format!("{ACCEPTED}: {error}; to make it: {ACCEPT}"))?;
    let (by, accepted) = parse(&text)?;
    let limit = if by == compiler { 2.0 } else { 10.0 };
    if by != compiler {
        println!("The counts were accepted with {by}; this is {compiler}. More than {limit} % matters.\n");
    }
    let (table, verdict) = compare(&accepted, &counts, limit);
    println!("{table}");
    match verdict {
        Verdict::Same => println!("Nothing differs by more than {limit} %."),
        Verdict::Fewer => println!("Fewer instructions than accepted. To accept them: {ACCEPT}"),
        Verdict::Different => {
            println!("FAILED: more instructions than accepted, or other kernels. If it has to be: {ACCEPT}")
        }
    }
    Ok(if verdict == Verdict::Different { ExitCode::FAILURE } else { ExitCode::SUCCESS })
}

/// What gungraun prints: a line of JSON per benchmark.
fn counted(lines: &str) -> Result<Counts, Box<dyn Error>> {
    let count = |line| {
        let report: serde_json::Value = serde_json::from_str(line)?;
        let name = |key: &str| report[key].as_str().map(str::to_owned).ok_or(format!("no {key} in {report}"));
        let instructions = report.pointer("/profiles/0/data/total/metrics/Ir/values/new");
        let instructions = instructions.and_then(serde_json::Value::as_u64).ok_or("no instructions in a report")?;
        Ok(((name("function_name")?, name("id")?.replace('_', ".")), instructions))
    };
    lines.lines().map(count).collect()
}

fn compiler() -> Result<String, Box<dyn Error>> {
    let output = Command::new("rustc").arg("-V").output()?;
    Ok(String::from_utf8(output.stdout)?.trim().to_owned())
}

fn format(compiler: &str, counts: &Counts) -> String {
    let lines = counts.iter().map(|((kernel, level), count)| format!("{kernel} {level} {count}\n"));
    format!("# Kernel, level, instructions. Written by `{ACCEPT}` with\n{compiler}\n{}", lines.collect::<String>())
}

/// The compiler and the counts.
fn parse(text: &str) -> Result<(&str, Counts), Box<dyn Error>> {
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let compiler = lines.next().ok_or("no compiler in the accepted counts")?;
    let count = |line: &str| match line.split(' ').collect::<Vec<_>>()[..] {
        [kernel, level, count] => Ok(((kernel.to_owned(), level.to_owned()), count.parse()?)),
        _ => Err(format!("not a count: '{line}'").into()),
    };
    Ok((compiler, lines.map(count).collect::<Result<_, Box<dyn Error>>>()?))
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Verdict {
    Same,
    Fewer,
    Different,
}

/// A table, and the gravest of its lines. `limit` is in percent.
fn compare(accepted: &Counts, counts: &Counts, limit: f64) -> (String, Verdict) {
    let mut table = format!("{:<12}{:<8}{:>10}{:>10}\n", "kernel", "level", "accepted", "now");
    let mut worst = Verdict::Same;
    // In the order of both: a count is in either, or in both.
    let names: std::collections::BTreeSet<_> = accepted.keys().chain(counts.keys()).collect();
    for name in names {
        let of = |counts: &Counts| counts.get(name).map_or("-".into(), u64::to_string);
        let (verdict, remark) = match (accepted.get(name), counts.get(name)) {
            (Some(&old), Some(&new)) => {
                let change = 100.0 * (new as f64 - old as f64) / old as f64;
                let (verdict, remark) = match change {
                    _ if change > limit => (Verdict::Different, "MORE"),
                    _ if change < -limit => (Verdict::Fewer, "fewer"),
                    _ => (Verdict::Same, ""),
                };
                (verdict, format!("{change:>+8.1} %  {remark}"))
            }
            (None, _) => (Verdict::Different, "            NOT ACCEPTED".into()),
            (_, None) => (Verdict::Different, "            NOT COUNTED".into()),
        };
        worst = worst.max(verdict);
        let line = format!("{:<12}{:<8}{:>10}{:>10}{remark}", name.0, name.1, of(accepted), of(counts));
        table += &format!("{}\n", line.trim_end());
    }
    (table, worst)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(counts: &[(&str, u64)]) -> Counts {
        counts.iter().map(|(kernel, n)| ((kernel.to_string(), "sse4.2".to_owned()), *n)).collect()
    }

    #[test]
    fn accepted_counts_are_read_as_written() {
        let written = counts(&[("slab", 12), ("dot", 7)]);
        let text = format("rustc 1.95.0", &written);
        assert_eq!(parse(&text).unwrap(), ("rustc 1.95.0", written));
        assert!(parse("rustc 1.95.0\nslab 12").is_err());
    }

    #[test]
    fn counts_are_read_from_reports() {
        let report = r#"{"function_name": "slab", "id": "sse4_2",
            "profiles": [{"data": {"total": {"metrics": {"Ir": {"values": {"new": 12, "old": 11}}}}}}]}"#;
        assert_eq!(counted(&report.replace('\n', " ")).unwrap(), counts(&[("slab", 12)]));
        assert!(counted(r#"{"function_name": "slab", "id": "avx2"}"#).is_err());
    }

    #[test]
    fn more_instructions_fail() {
        let accepted = counts(&[("dot", 1000), ("slab", 1000)]);
        let verdict = |dot, limit| compare(&accepted, &counts(&[("dot", dot), ("slab", 1000)]), limit).1;
        assert_eq!(verdict(1020, 2.0), Verdict::Same);
        assert_eq!(verdict(1021, 2.0), Verdict::Different);
        assert_eq!(verdict(1021, 10.0), Verdict::Same);
        assert_eq!(verdict(979, 2.0), Verdict::Fewer);
        for other in [&[("dot", 1000)][..], &[("dot", 1000), ("slab", 1000), ("sin_cos", 1000)]] {
            assert_eq!(compare(&accepted, &counts(other), 2.0).1, Verdict::Different);
        }
    }
}
