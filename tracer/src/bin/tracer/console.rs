//! What the user sees while work goes on, and Ctrl-C.

use indicatif::{ProgressBar, ProgressStyle};
use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tracer::Error;
use tracer::progress::Progress;

/// Raised by Ctrl-C.
static CANCEL: AtomicBool = AtomicBool::new(false);

/// Standard output and error; a bar for the current stage when standard error is a terminal.
#[derive(Default)]
pub struct Console {
    bar: Mutex<Option<ProgressBar>>,
}

impl Console {
    /// Takes over Ctrl-C: the first asks the work to stop, so that nothing half done is left; the second ends it at once.
    pub fn new() -> Self {
        let handler = || {
            if CANCEL.swap(true, Ordering::Relaxed) {
                std::process::exit(130);
            }
        };
        // Where there are no signals to handle, Ctrl-C does what it always does.
        let _ = ctrlc::set_handler(handler);
        Self::default()
    }

    /// The flag that Ctrl-C raises.
    pub fn cancel(&self) -> &'static AtomicBool {
        &CANCEL
    }

    /// Writes results to standard output. A reader that has gone away (`| head`) is no error.
    pub fn print(&self, text: &str) -> Result<(), Error> {
        self.clear();
        let mut out = io::stdout().lock();
        match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
            Err(source) if source.kind() != io::ErrorKind::BrokenPipe => {
                Err(Error::Io { action: "write", path: PathBuf::from("standard output"), source })
            }
            _ => Ok(()),
        }
    }

    /// The same in JSON.
    pub fn print_json(&self, value: &impl serde::Serialize) -> Result<(), Error> {
        self.print(&json(value)?)
    }

    /// Something the user should know.
    pub fn warn(&self, warning: &str) {
        self.clear();
        let _ = writeln!(io::stderr(), "warning: {warning}");
    }

    /// Something that is good to know.
    pub fn hint(&self, text: &str) {
        self.clear();
        let _ = writeln!(io::stderr(), "note: {text}");
    }

    /// Why it ends here.
    pub fn error(&self, error: &Error) {
        self.clear();
        let _ = writeln!(io::stderr(), "error: {error}");
    }

    /// Takes the bar off the screen.
    pub fn clear(&self) {
        if let Some(bar) = self.bar().take() {
            bar.finish_and_clear();
        }
    }

    fn bar(&self) -> MutexGuard<'_, Option<ProgressBar>> {
        self.bar.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Indented JSON with a newline behind it.
pub fn json(value: &impl serde::Serialize) -> Result<String, Error> {
    let text = serde_json::to_string_pretty(value);
    text.map(|t| t + "\n").map_err(|e| Error::Geometry(format!("the report cannot be written as JSON: {e}")))
}

impl Progress for Console {
    fn stage(&self, name: &str, total: u64) {
        self.clear();
        let (bar, template) = if total == 0 {
            (ProgressBar::new_spinner(), "{prefix:>8} {spinner} {elapsed}")
        } else {
            (ProgressBar::new(total), "{prefix:>8} [{bar:40}] {percent:>3}% {elapsed}, {eta} left {msg}")
        };
        let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
        bar.set_style(style.progress_chars("=> "));
        bar.set_prefix(name.to_owned());
        bar.tick();
        *self.bar() = Some(bar);
    }

    fn resume(&self, n: u64) {
        if let Some(bar) = self.bar().as_ref() {
            bar.set_position(n);
            bar.reset_eta();
        }
    }

    fn advance(&self, n: u64) {
        if let Some(bar) = self.bar().as_ref() {
            bar.inc(n);
        }
    }

    fn note(&self, text: &str) {
        if let Some(bar) = self.bar().as_ref() {
            bar.set_message(text.to_owned());
        }
    }

    fn cancelled(&self) -> bool {
        CANCEL.load(Ordering::Relaxed)
    }
}
