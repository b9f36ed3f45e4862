//! What can go wrong with a user's input, and where it did.

use std::path::PathBuf;

/// Any failure of this crate. Every message says what failed, where, and where it helps, what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be opened, read or written.
    #[error("cannot {action} {}: {source}", path.display())]
    Io {
        /// What was tried: `"open"`, `"read"`, `"write"`, `"create"`.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// The operating system's reason.
        source: std::io::Error,
    },
    /// A file was read, but what it holds is not acceptable.
    #[error("{}{}: {message}", path.display(), line.map(|l| format!(":{l}")).unwrap_or_default())]
    Data {
        /// The file.
        path: PathBuf,
        /// Line (text files, from 1) where the trouble is, when one can be named.
        line: Option<usize>,
        /// What is wrong and what to do.
        message: String,
    },
    /// Geometry handed in by the caller is not acceptable (a NaN coordinate, an index out of range, no triangles).
    #[error("{0}")]
    Geometry(String),
    /// What was asked for makes no sense (an unknown scene, a camera that looks nowhere): a matter of usage, not of data.
    #[error("{0}")]
    Usage(String),
    /// The caller asked for the work to stop.
    #[error("cancelled")]
    Cancelled,
}
