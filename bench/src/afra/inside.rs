//! Where the time goes, and how much memory it takes.

use super::race::{Task, Threads};
use super::scenes::{Name, Scene};
use serde::Serialize;
use simd::Level;
use tracer::Error;
use tracer::geometry::{HitBatch, RayBatch};
use tracer::method::{Context, DivideConquer, DivideLimits, Method, Sharing, Width};
use tracer::progress::Progress;

/// One scene.
#[derive(Debug, Clone, Serialize)]
pub struct Inside {
    pub scene: Name,
    /// Seconds of filtering, intersecting and partitioning in the shortest round: as by default, and filtering always, as in the paper.
    pub phases: [[f64; 3]; 2],
    pub memory: Memory,
}

/// Bytes for the largest batch.
#[derive(Debug, Clone, Serialize)]
pub struct Memory {
    pub rays: usize,
    pub triangles: usize,
    pub threads: usize,
    /// Boxes, complements and ids, which all batches share.
    pub boxes: usize,
    /// What the method holds beside them, with hits: on one thread, on all by halves of the triangles, on all naively.
    pub method: [usize; 3],
    /// Trees of 4, 8 and 16 children a node.
    pub trees: [usize; 3],
}

/// The ways whose phases are compared.
pub const WAYS: [&str; 2] = ["filtering where it pays (default)", "filtering always (the paper)"];

/// Filters before each division, as the paper does.
pub fn always() -> DivideLimits {
    DivideLimits { filter_below: 1.0, ..DivideLimits::default() }
}

/// Of a picture with one bounce.
pub fn measure(scene: &Scene, rays: &[RayBatch], level: Level, task: &Task<'_>) -> Result<Inside, Error> {
    let rays = &rays[..2];
    task.console.stage(&format!("{}: phases and memory", scene.name), 0);
    let method = || DivideConquer::new(&scene.boxes, level, Width::Auto);
    let mut hits = HitBatch::new();
    let mut phases = [[0.0; 3]; 2];
    let mut held = [0; 3];
    for (phases, limits) in phases.iter_mut().zip([DivideLimits::default(), always()]) {
        let method = method().with_limits(limits);
        let mut shortest = f64::INFINITY;
        for _ in 0..task.repeat {
            let mut round = [0.0; 3];
            for batch in rays {
                let mut cx = Context { counters: None, cancel: Some(task.console.cancel()) };
                let (done, _) = task.run(Threads::One, || method.closest_timed(batch, &mut hits, &mut cx));
                let done = done?;
                for (sum, time) in round.iter_mut().zip([done.filter, done.intersect, done.partition]) {
                    *sum += time.as_secs_f64();
                }
            }
            // The clock on the wall is the method's own: what else runs makes rounds longer.
            let all = round.iter().sum();
            if all < shortest {
                (shortest, *phases) = (all, round);
            }
        }
        held[0] = held[0].max(method.memory());
    }
    for (held, sharing) in held[1..].iter_mut().zip([Sharing::Tasks, Sharing::Naive]) {
        let method = method().with_sharing(sharing);
        let mut cx = Context { counters: None, cancel: Some(task.console.cancel()) };
        let (done, _) = task.run(Threads::All, || method.closest(&rays[0], &mut hits, &mut cx));
        done?;
        *held = method.memory();
    }
    task.console.clear();
    let memory = Memory {
        rays: rays[0].len(),
        triangles: scene.model.mesh.triangles.len(),
        threads: task.threads(),
        boxes: scene.boxes.memory(),
        method: held,
        trees: [scene.four.bytes(), scene.eight.bytes(), scene.sixteen.bytes()],
    };
    Ok(Inside { scene: scene.name, phases, memory })
}
