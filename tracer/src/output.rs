//! Writing files so that a failure leaves nothing half done behind.

use crate::Error;
use crate::progress::Progress;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::{Builder, NamedTempFile};

/// Writes a file whole or not at all: `write` fills a temporary in the same folder, which then takes the place of `path`
/// in one step. After any failure (a full disk, an error returned by `write`) the temporary is gone and an older file
/// at `path` is as it was. What is no ordinary file (`/dev/stdout`, a pipe) is written directly.
///
/// # Errors
/// [`Error::Io`] naming `path`, when it cannot be created, written or replaced, or when `write` fails.
pub fn write_atomically(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), Error> {
    stage(path, write)?.commit()
}

/// A file that is written, but not yet at its place; dropping it removes it.
pub(crate) struct Staged {
    path: PathBuf,
    temporary: Option<NamedTempFile>,
}

/// The first half of [`write_atomically`], for files that belong together: stage all, then commit all.
pub(crate) fn stage(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<Staged, Error> {
    let fail = |action| move |source| Error::Io { action, path: path.to_owned(), source };
    // A link is followed, or renaming would replace the link instead of what it leads to.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    match fs::metadata(&target) {
        Ok(m) if m.is_dir() => {
            return Err(fail("create")(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder")));
        }
        Ok(m) if !m.is_file() => {
            let file = File::options().write(true).open(&target).map_err(fail("open"))?;
            buffered(&file, write).map_err(fail("write"))?;
            return Ok(Staged { path: target, temporary: None });
        }
        _ => {}
    }
    let folder = target.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let temporary = temporary(folder).map_err(fail("create"))?;
    buffered(temporary.as_file(), write).map_err(fail("write"))?;
    // Renamed before it is on the disk, it would be empty after a power cut, and the older file gone.
    temporary.as_file().sync_data().map_err(fail("write"))?;
    Ok(Staged { path: target, temporary: Some(temporary) })
}

impl Staged {
    /// Puts the file at its place.
    pub(crate) fn commit(self) -> Result<(), Error> {
        let Self { path, temporary } = self;
        match temporary {
            None => Ok(()),
            Some(t) => match t.persist(&path) {
                Ok(_) => Ok(()),
                Err(e) => Err(Error::Io { action: "create", path, source: e.error }),
            },
        }
    }
}

/// To be called by a writer after item `i` of a list: reports progress now and then, and fails when the work is cancelled.
pub(crate) fn step(progress: &dyn Progress, i: usize) -> io::Result<()> {
    const STEP: usize = 1 << 14;
    if i.is_multiple_of(STEP) {
        progress.advance(if i == 0 { 0 } else { STEP as u64 });
        if progress.cancelled() {
            return Err(io::Error::other("cancelled"));
        }
    }
    Ok(())
}

fn temporary(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(".tracer-");
    // A temporary is private by default; what the user asked for shall be as readable as any file of theirs.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

fn buffered(file: &File, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut out = BufWriter::with_capacity(1 << 16, file);
    write(&mut out)?;
    out.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files(folder: &Path) -> Vec<String> {
        let names = fs::read_dir(folder).expect("a folder").map(|e| e.expect("an entry").file_name());
        names.map(|n| n.to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn replaces_the_file_in_one_step() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.txt");
        fs::write(&path, "old").expect("written");
        write_atomically(&path, |w| {
            w.write_all(b"new")?;
            w.flush()?;
            assert_eq!(fs::read_to_string(&path)?, "old", "the old file stays until the new one is whole");
            Ok(())
        })
        .expect("written");
        assert_eq!(fs::read_to_string(&path).expect("read"), "new");
        assert_eq!(files(folder.path()), ["a.txt"]);
    }

    #[test]
    fn a_failure_leaves_no_trace() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.txt");
        let fail = |w: &mut dyn Write| {
            w.write_all(&[0; 1 << 20])?;
            Err(io::Error::new(io::ErrorKind::StorageFull, "no space left"))
        };
        let message = write_atomically(&path, fail).expect_err("a full disk").to_string();
        assert!(message.contains("cannot write") && message.contains("a.txt"), "{message}");
        assert!(files(folder.path()).is_empty());
        fs::write(&path, "old").expect("written");
        write_atomically(&path, fail).expect_err("a full disk");
        assert_eq!(fs::read_to_string(&path).expect("read"), "old");
        assert_eq!(files(folder.path()), ["a.txt"]);
    }

    #[test]
    fn refuses_a_folder_and_a_missing_folder() {
        let folder = tempfile::tempdir().expect("a folder");
        for path in [folder.path().to_owned(), folder.path().join("none").join("a.txt")] {
            let e = write_atomically(&path, |_| Ok(())).expect_err("no file can be there");
            assert!(e.to_string().contains("cannot create"), "{e}");
        }
        assert!(files(folder.path()).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn readable_as_any_file_and_through_a_link() {
        use std::os::unix::fs::{MetadataExt, symlink};
        let folder = tempfile::tempdir().expect("a folder");
        let [plain, target, link] = ["plain", "target", "link"].map(|n| folder.path().join(n));
        fs::write(&plain, "").expect("written");
        fs::write(&target, "old").expect("written");
        symlink(&target, &link).expect("linked");
        write_atomically(&link, |w| w.write_all(b"new")).expect("written");
        assert_eq!(fs::read_to_string(&target).expect("read"), "new");
        assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
        let mode = |p| fs::metadata(p).expect("there").mode();
        assert_eq!(mode(&target), mode(&plain));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_are_written_directly() {
        write_atomically(Path::new("/dev/null"), |w| w.write_all(b"x")).expect("swallowed");
        let e = write_atomically(Path::new("/dev/full"), |w| w.write_all(b"x")).expect_err("full");
        assert!(matches!(&e, Error::Io { action: "write", .. }), "{e}");
    }
}
