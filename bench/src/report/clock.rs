//! CPU time of the one thread that measures: what else runs on the machine disturbs it less than it disturbs a clock on the wall. And
//! that clock, where several threads measure.

use cpu_time::{ProcessTime, ThreadTime};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;
use tracer::Error;
use tracer::geometry::{HitBatch, RayBatch};
use tracer::method::{BitVec, Context, Method};

/// Does something, and returns the seconds it took.
pub fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = ThreadTime::now();
    let result = work();
    (result, start.elapsed().as_secs_f64())
}

/// Does something on several threads, and returns the seconds it took, and the CPU seconds of all threads.
pub fn timed_on_all<T>(work: impl FnOnce() -> T) -> (T, [f64; 2]) {
    let (wall, cpu) = (Instant::now(), ProcessTime::now());
    let result = work();
    (result, [wall.elapsed().as_secs_f64(), cpu.elapsed().as_secs_f64()])
}

/// The middle of a number of measurements; the mean of the middle two when their number is even.
pub fn median(times: &[f64]) -> f64 {
    let mut times = times.to_vec();
    times.sort_by(f64::total_cmp);
    let n = times.len();
    if n == 0 { 0.0 } else { 0.5 * (times[(n - 1) / 2] + times[n / 2]) }
}

/// A method that sums up its time.
pub struct Timed<'a> {
    method: &'a dyn Method,
    nanoseconds: AtomicU64,
}

impl<'a> Timed<'a> {
    pub fn new(method: &'a dyn Method) -> Self {
        Self { method, nanoseconds: AtomicU64::new(0) }
    }

    /// All its time so far.
    pub fn seconds(&self) -> f64 {
        1e-9 * self.nanoseconds.load(Ordering::Relaxed) as f64
    }

    fn add<T>(&self, work: impl FnOnce() -> T) -> T {
        let (result, seconds) = timed(work);
        self.nanoseconds.fetch_add((1e9 * seconds) as u64, Ordering::Relaxed);
        result
    }
}

impl Method for Timed<'_> {
    fn name(&self) -> &'static str {
        self.method.name()
    }

    fn source(&self) -> &'static str {
        self.method.source()
    }

    fn memory(&self) -> usize {
        self.method.memory()
    }

    fn closest(&self, rays: &RayBatch, hits: &mut HitBatch, cx: &mut Context<'_>) -> Result<(), Error> {
        self.add(|| self.method.closest(rays, hits, cx))
    }

    fn any(&self, rays: &RayBatch, occluded: &mut BitVec, cx: &mut Context<'_>) -> Result<(), Error> {
        self.add(|| self.method.any(rays, occluded, cx))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median(&[]), 0.0);
        assert_eq!(median(&[3.0, 1.0, 50.0]), 3.0);
        assert_eq!(median(&[4.0, 1.0, 2.0, 9.0]), 3.0);
    }
}
