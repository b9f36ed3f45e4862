//! What a picture took.

use crate::clock::Clock;
use crate::geometry::RayBatch;
use crate::method::Context;
use std::time::Duration;

/// Where the time went, and how many rays there were.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Times {
    /// Making eye rays.
    pub generation: Duration,
    /// Finding hits.
    pub traversal: Duration,
    /// Shading: what is done with hits, rays that come of them among it.
    pub shading: Duration,
    /// For each number of reflections before, from 0.
    pub bounces: Vec<Bounce>,
}

/// Rays after a number of reflections.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Bounce {
    /// Whose first hit was asked for.
    pub closest: u64,
    /// Of which was asked whether they hit anything.
    pub any: u64,
}

impl Times {
    /// All rays.
    #[must_use]
    pub fn rays(&self) -> u64 {
        self.bounces.iter().map(|b| b.closest + b.any).sum()
    }

    /// All the time.
    #[must_use]
    pub fn total(&self) -> Duration {
        self.generation + self.traversal + self.shading
    }

    pub(super) fn bounce(&mut self, depth: usize) -> &mut Bounce {
        self.bounces.resize(self.bounces.len().max(depth + 1), Bounce::default());
        &mut self.bounces[depth]
    }
}

/// Does something and adds the time.
pub(super) fn timed<T>(sum: &mut Duration, work: impl FnOnce() -> T) -> T {
    let start = Clock::now();
    let result = work();
    *sum += start.elapsed();
    result
}

/// What is told of the rays of each bounce, before they are traced.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Query {
    /// The first hit is asked for.
    Closest,
    /// Whether there is any hit.
    Any,
}

/// Told of rays: see [`Means::observer`].
pub type Observer<'a> = dyn FnMut(usize, Query, &RayBatch) + 'a;

/// What a picture is made with beside its scene: how hits are found, and who looks on.
pub struct Means<'a, 'b> {
    /// Finds the hits; every method, the same picture.
    pub method: &'a dyn crate::method::Method,
    /// Counters of the method, and a flag that cancels.
    pub cx: &'a mut Context<'b>,
    /// Told of each batch of rays with the number of reflections before; to measure with.
    pub observer: Option<&'a mut Observer<'b>>,
    /// Told of units that are done: pixels times samples.
    pub progress: &'a dyn crate::progress::Progress,
}
