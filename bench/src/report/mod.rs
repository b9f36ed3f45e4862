//! What the reports have in common.

pub mod chart;
pub mod clock;
pub mod goals;
pub mod scenes;
pub mod text;

use serde::Serialize;
use std::fs;
use std::path::{Path, PathBuf};
use tracer::Error;
use tracer::output::write_atomically;

/// A folder to write a report into, which is made before the long work, so that it is not in vain.
pub struct Folder(PathBuf);

impl Folder {
    /// The one that was asked for, else where reports belong: those of smoke runs, beside what is built.
    pub fn open(asked: Option<&Path>, quick: bool, name: &str) -> Result<Self, Error> {
        let path = match asked {
            Some(path) => path.into(),
            None if quick => Path::new("target").join(name),
            None => "bench/reports".into(),
        };
        fs::create_dir_all(&path).map_err(|source| Error::Io { action: "create", path: path.clone(), source })?;
        Ok(Self(path))
    }

    /// Prints the report's text and writes `NAME.md`, `NAME.json` and the figures, each whole or not at all.
    pub fn write(
        &self,
        name: &str,
        markdown: String,
        report: &impl Serialize,
        figures: Vec<(String, String)>,
    ) -> Result<(), Error> {
        println!("{markdown}");
        let json = serde_json::to_string_pretty(report);
        let json = json.map_err(|e| Error::Geometry(format!("the report cannot be written as JSON: {e}")))?;
        let texts = [(format!("{name}.md"), markdown), (format!("{name}.json"), json + "\n")];
        for (file, text) in texts.into_iter().chain(figures) {
            write_atomically(&self.0.join(file), |out| out.write_all(text.as_bytes()))?;
        }
        eprintln!("wrote {}", self.0.join(format!("{name}.md")).display());
        Ok(())
    }
}
