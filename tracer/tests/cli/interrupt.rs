//! Ctrl-C leaves nothing half done.
#![cfg(unix)]

use crate::{Folder, parts};
use std::cell::Cell;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Runs a long work, presses Ctrl-C as soon as `ready` says so. What it says to that.
fn interrupt(folder: &Folder, arguments: &str, ready: impl Fn(Duration) -> bool) -> String {
    let mut command = folder.command(arguments);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("started");
    let start = Instant::now();
    while !ready(start.elapsed()) {
        assert!(child.try_wait().expect("a child").is_none(), "{arguments}: ended too early");
        sleep(Duration::from_millis(5));
    }
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    assert!(sent.success());
    let output = child.wait_with_output().expect("ended");
    let (out, code, err) = parts(&output);
    assert_eq!((out.as_str(), code), ("", Some(130)), "{arguments}: {err}");
    err
}

#[test]
fn while_a_file_is_written() {
    let folder = Folder::new();
    for name in ["big.obj", "big.ply"] {
        let written = |time| {
            assert!(time < Duration::from_secs(60), "nothing is written");
            !folder.files().is_empty()
        };
        let said = interrupt(&folder, &format!("generate hairball --size 4000 -o {name}"), written);
        assert_eq!(said, "error: cancelled\n");
        assert!(folder.files().is_empty(), "{:?}", folder.files());
    }
}

#[test]
fn while_it_traces() {
    let folder = Folder::new();
    let soon = |time| time > Duration::from_millis(700);
    let said = interrupt(&folder, "compare balls:1 --repeat 100000 -o out.json", soon);
    assert_eq!(said, "error: cancelled\n");
    assert!(folder.files().is_empty());
}

/// What is done is kept; gone on with, it becomes the picture made at once.
#[test]
fn while_it_renders_with_a_checkpoint() {
    let folder = Folder::new();
    let command = "render balls:2 --integrator path --size 40x30 --threads 1 -o out.png --checkpoint film";
    let begun = Cell::new(None);
    let soon = |time| {
        if begun.get().is_none() && !folder.files().is_empty() {
            begun.set(Some(time));
        }
        begun.get().is_some_and(|begun| time > begun + Duration::from_millis(1000))
    };
    let said = interrupt(&folder, &format!("{command} --samples 1000000"), soon);
    assert_eq!(folder.files(), ["film"]);
    assert!(said.starts_with("note: ") && said.contains("of 1000000 samples are in film"), "{said}");
    assert!(said.ends_with("error: cancelled\n") && said.lines().count() == 2, "{said}");
    let report = folder.json(&format!("{command} --samples 1000000 --time-limit 0 --json"));
    let samples = report["samples"].as_u64().expect("a number");
    assert!(samples > 0 && report["samples_before"].as_u64().is_some_and(|n| n + 1 >= samples), "{report}");
    let (some, more) = (samples.max(2), samples + 3);
    for samples in [some, more] {
        folder.run(&format!("{command} --samples {samples}"));
        let resumed = folder.read("out.png");
        folder.run(&format!("{} --samples {samples}", command.replace(" --checkpoint film", "")));
        assert!(folder.read("out.png") == resumed, "{samples} samples");
    }
}
