//! Progress and cancellation of long work, without a word about how it is shown.

use crate::Error;
use std::sync::atomic::{AtomicBool, Ordering};

/// Told how far long work has come; asked whether to go on. All methods are called from any thread.
pub trait Progress: Sync {
    /// A new stage begins: its name and its number of units (0: unknown).
    fn stage(&self, _name: &str, _total: u64) {}
    /// `n` units of the stage were done before, by earlier work: they count, but say nothing about the speed.
    fn resume(&self, _n: u64) {}
    /// `n` more units of the stage are done.
    fn advance(&self, _n: u64) {}
    /// How it goes, in a few words to be shown beside: a rate, say.
    fn note(&self, _text: &str) {}
    /// True when the work shall stop early with [`Error::Cancelled`].
    fn cancelled(&self) -> bool {
        false
    }
    /// [`Error::Cancelled`] if the work shall stop.
    ///
    /// # Errors
    /// [`Error::Cancelled`], when [`Progress::cancelled`] says so.
    fn check(&self) -> Result<(), Error> {
        if self.cancelled() { Err(Error::Cancelled) } else { Ok(()) }
    }
}

/// No display, never cancelled.
#[derive(Debug, Clone, Copy, Default)]
pub struct Silent;
impl Progress for Silent {}

/// A flag that another thread (a Ctrl-C handler) sets to cancel; shows nothing.
impl Progress for AtomicBool {
    fn cancelled(&self) -> bool {
        self.load(Ordering::Relaxed)
    }
}
