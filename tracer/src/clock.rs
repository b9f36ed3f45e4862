//! The clock on the wall, where there is one.

use std::time::{Duration, Instant};

/// A moment. WebAssembly in a browser has no clock that the standard library could read: no time passes there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Clock(Option<Instant>);

impl Clock {
    /// Now.
    pub(crate) fn now() -> Self {
        let is_there = !cfg!(all(target_family = "wasm", target_os = "unknown"));
        Self(is_there.then(Instant::now))
    }

    /// What has passed since.
    pub(crate) fn elapsed(self) -> Duration {
        self.0.map_or(Duration::ZERO, |start| start.elapsed())
    }

    /// What has passed since, and now.
    pub(crate) fn lap(&mut self) -> Duration {
        let now = Self::now();
        let passed = self.0.zip(now.0).map_or(Duration::ZERO, |(start, now)| now - start);
        *self = now;
        passed
    }
}
