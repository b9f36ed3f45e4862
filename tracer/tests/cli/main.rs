//! The command, run as a user runs it.

mod bad_input;
mod batches;
mod checkpoint;
mod environment;
mod interrupt;
mod pictures;
mod reports;
mod scenes;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// A unit square at z = 0, cut into two triangles; a larger one at z = -1.
const SQUARES: &str = "\
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
f 1 2 3 4
v -1 -1 -1
v 2 -1 -1
v 2 2 -1
v -1 2 -1
f 5 6 7 8
";

/// An empty folder to run the command in.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a folder"))
    }

    fn with(name: &str, content: impl AsRef<[u8]>) -> Self {
        let folder = Self::new();
        folder.write(name, content);
        folder
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path().join(name), content).expect("written");
    }

    fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    fn text(&self, name: &str) -> String {
        String::from_utf8(self.read(name)).expect("UTF-8")
    }

    /// All names in it, hidden ones too.
    fn files(&self) -> Vec<String> {
        let names = fs::read_dir(self.path()).expect("a folder").map(|e| e.expect("an entry").file_name());
        let mut names: Vec<String> = names.map(|n| n.to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// The command with these arguments, separated by blanks.
    fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_tracer"));
        command.current_dir(self.path()).env_remove("SIMD_LEVEL").args(arguments.split_whitespace());
        command
    }

    /// Runs it; it has to succeed. What it prints.
    fn run(&self, arguments: &str) -> String {
        let (out, code, err) = parts(&self.command(arguments).output().expect("started"));
        assert_eq!(code, Some(0), "tracer {arguments}: {err}");
        out
    }

    fn json(&self, arguments: &str) -> serde_json::Value {
        let out = self.run(arguments);
        serde_json::from_str(&out).unwrap_or_else(|e| panic!("tracer {arguments}: {e}: {out}"))
    }

    /// Runs it; it has to fail with this code, one line that has all `words`, and no new file.
    fn fails(&self, arguments: &str, expected: i32, words: &[&str]) {
        let before = self.files();
        let (out, code, err) = parts(&self.command(arguments).output().expect("started"));
        let what = format!("tracer {arguments}: {code:?}, {err}");
        assert_eq!((code, out.as_str()), (Some(expected), ""), "{what}");
        assert!(err.starts_with("error: ") && !err.contains("panicked"), "{what}");
        for word in words {
            assert!(err.contains(word), "{what}: lacks {word:?}");
        }
        assert_eq!(self.files(), before, "{what}");
        // What clap says goes on with a hint at --help.
        assert!(err.lines().count() == 1 || err.contains("--help"), "{what}");
    }
}

/// Standard output, exit code, standard error.
fn parts(output: &Output) -> (String, Option<i32>, String) {
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("UTF-8");
    (text(&output.stdout), output.status.code(), text(&output.stderr))
}

/// Names of the levels of this CPU.
fn levels() -> Vec<String> {
    simd::Level::available().map(|l| l.to_string()).collect()
}
