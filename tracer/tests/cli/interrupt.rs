//! Ctrl-C leaves nothing half done.
#![cfg(unix)]

use crate::{Folder, parts};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Runs a long work, presses Ctrl-C as soon as `ready` says so.
fn interrupt(folder: &Folder, arguments: &str, ready: impl Fn(Duration) -> bool) {
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
    assert_eq!(parts(&output), (String::new(), Some(130), "error: cancelled\n".into()), "{arguments}");
}

#[test]
fn while_a_file_is_written() {
    let folder = Folder::new();
    for name in ["big.obj", "big.ply"] {
        let written = |time| {
            assert!(time < Duration::from_secs(60), "nothing is written");
            !folder.files().is_empty()
        };
        interrupt(&folder, &format!("generate hairball --size 4000 -o {name}"), written);
        assert!(folder.files().is_empty(), "{:?}", folder.files());
    }
}

#[test]
fn while_it_traces() {
    let folder = Folder::new();
    let soon = |time| time > Duration::from_millis(700);
    interrupt(&folder, "compare balls:1 --repeat 100000 -o out.json", soon);
    assert!(folder.files().is_empty());
}
