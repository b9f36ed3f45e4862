//! Progress on the terminal, and Ctrl-C.

use indicatif::{ProgressBar, ProgressStyle};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tracer::progress::Progress;

/// Raised by Ctrl-C.
static CANCEL: AtomicBool = AtomicBool::new(false);

/// A bar for the current stage when standard error is a terminal.
#[derive(Default)]
pub struct Console {
    bar: Mutex<Option<ProgressBar>>,
}

impl Console {
    /// Takes over Ctrl-C: the first asks the work to stop, the second ends it at once.
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

impl Progress for Console {
    fn stage(&self, name: &str, total: u64) {
        self.clear();
        let (bar, template) = if total == 0 {
            (ProgressBar::new_spinner(), "{prefix} {spinner} {elapsed}")
        } else {
            (ProgressBar::new(total), "{prefix} [{bar:30}] {percent:>3}% {elapsed}, {eta} left")
        };
        let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
        bar.set_style(style.progress_chars("=> "));
        bar.set_prefix(name.to_owned());
        bar.tick();
        *self.bar() = Some(bar);
    }

    fn advance(&self, n: u64) {
        if let Some(bar) = self.bar().as_ref() {
            bar.inc(n);
        }
    }

    fn cancelled(&self) -> bool {
        CANCEL.load(Ordering::Relaxed)
    }
}
