//! Whether rays that are sorted first are traced faster by more than it costs.

use super::median_ms;
use super::scene::Scene;
use crate::report::clock::timed;
use serde::Serialize;
use simd::Level;
use tracer::Error;
use tracer::geometry::{HitBatch, RayBatch};
use tracer::method::{Auto, Context, Method, Single};
use tracer::sort::{RayHash, RaySorter, Reorder};

/// Milliseconds for all rays.
#[derive(Debug, Clone, Serialize)]
pub struct ReorderTimes {
    pub scene: String,
    pub rays: String,
    pub method: &'static str,
    pub by: &'static str,
    /// Side of a cell, of the scene's diagonal.
    pub cell: f32,
    /// Rays in a run that is sorted as one.
    pub run: f64,
    /// Hashes and sort.
    pub order: f64,
    /// Rays into that order.
    pub gather: f64,
    /// Their hits.
    pub trace: f64,
    /// Hits into the order of the rays.
    pub back: f64,
    /// The hits of the rays as they are.
    pub unsorted: f64,
    /// Whether the hits are the same.
    pub same: bool,
}

impl ReorderTimes {
    /// All that sorted rays take.
    pub fn charged(&self) -> f64 {
        self.order + self.gather + self.trace + self.back
    }
}

/// What rays are sorted by.
const KEYS: [(Reorder, f32); 4] = [
    (Reorder::Origin, RayHash::CELL),
    (Reorder::Hash, RayHash::CELL),
    (Reorder::Hash, 1.0 / 64.0),
    (Reorder::Direction, RayHash::CELL),
];

/// Times methods on rays in batches of a size, unsorted and sorted.
pub fn measure(scene: &Scene, rays: &RayBatch, batch: usize, repeat: usize) -> Result<Vec<ReorderTimes>, Error> {
    let level = Level::best();
    let all: Vec<_> = rays.iter().collect();
    let batches: Vec<RayBatch> = all.chunks(batch.max(1)).map(|rays| rays.iter().copied().collect()).collect();
    let methods: [(&str, Box<dyn Method>); 2] =
        [("wide", Box::new(Single::new(&scene.wide, level))), ("auto", Box::new(Auto::new(&scene.wide, level)))];
    let mut table = Vec::new();
    for (name, method) in &methods {
        let mut unsorted = Vec::new();
        let mut stages = KEYS.map(|_| Stages::default());
        let mut hits = HitBatch::new();
        for round in 0..=repeat {
            let mut seconds = 0.0;
            let mut expected = Vec::new();
            for rays in &batches {
                let (done, time) = timed(|| method.closest(rays, &mut hits, &mut Context::default()));
                done?;
                seconds += time;
                expected.push(hits.hash());
            }
            // The first round warms up.
            if round == 0 {
                continue;
            }
            unsorted.push(seconds);
            for ((by, cell), stages) in KEYS.into_iter().zip(&mut stages) {
                let sorter = RaySorter::new(level, RayHash::with_cell(&scene.bounds, by, cell));
                stages.round(sorter, &**method, &batches, &expected)?;
            }
        }
        for ((by, cell), stages) in KEYS.into_iter().zip(stages) {
            let [order, gather, trace, back] = stages.seconds.map(median_ms);
            let rays = format!("{} in {}", rays.len(), batches.len());
            let (unsorted, run) = (median_ms(unsorted.clone()), all.len() as f64 / stages.runs.max(1) as f64);
            let (scene, by, same) = (scene.name.clone(), by.name(), !stages.different);
            let method = *name;
            table.push(ReorderTimes { scene, rays, method, by, cell, run, order, gather, trace, back, unsorted, same });
        }
    }
    Ok(table)
}

/// Seconds of each round, by stage: order, gather, trace, back.
#[derive(Default)]
struct Stages {
    seconds: [Vec<f64>; 4],
    runs: usize,
    different: bool,
}

impl Stages {
    fn round(
        &mut self,
        mut sorter: RaySorter,
        method: &dyn Method,
        batches: &[RayBatch],
        expected: &[u64],
    ) -> Result<(), Error> {
        let (mut sum, mut hits, mut back) = ([0.0; 4], HitBatch::new(), HitBatch::new());
        self.runs = 0;
        // Memory is touched before the clock runs: a renderer has it from earlier batches.
        if let Some(first) = batches.first() {
            sorter.order(first);
            sorter.gather(first);
            method.closest(sorter.rays(), &mut hits, &mut Context::default())?;
            sorter.put_hits_back(&hits, &mut back);
        }
        for (rays, expected) in batches.iter().zip(expected) {
            sum[0] += timed(|| sorter.order(rays).len()).1;
            sum[1] += timed(|| sorter.gather(rays).len()).1;
            let (done, time) = timed(|| method.closest(sorter.rays(), &mut hits, &mut Context::default()));
            done?;
            sum[2] += time;
            sum[3] += timed(|| sorter.put_hits_back(&hits, &mut back)).1;
            self.runs += sorter.runs();
            self.different |= back.hash() != *expected;
        }
        self.seconds.iter_mut().zip(sum).for_each(|(seconds, sum)| seconds.push(sum));
        Ok(())
    }
}
