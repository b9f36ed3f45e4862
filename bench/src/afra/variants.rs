//! What the method could have been, and how it scales.

use super::inside::always;
use super::race::{Rival, Spent, Task, Threads, race};
use super::scenes::{Name, Scene};
use serde::Serialize;
use simd::Level;
use tracer::Error;
use tracer::geometry::RayBatch;
use tracer::method::{DivideConquer, DivideLimits, Filtering, Sharing, Single, Width};
use tracer::progress::Progress;

/// One scene.
#[derive(Debug, Clone, Serialize)]
pub struct Variants {
    pub scene: Name,
    /// On one thread.
    pub rows: Vec<Row>,
    pub scaling: Vec<Scaling>,
}

/// CPU seconds for the eye rays and those of the first bounce.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    pub name: String,
    pub seconds: [f64; 2],
}

/// A picture with one bounce on one and on all threads.
#[derive(Debug, Clone, Serialize)]
pub struct Scaling {
    pub name: String,
    /// Of one thread.
    pub one: Spent,
    /// Of all.
    pub all: Spent,
}

impl Scaling {
    /// How many times faster all threads are.
    pub fn speed_up(&self) -> f64 {
        self.one.seconds / self.all.seconds
    }

    /// How many times more all threads do.
    pub fn work(&self) -> f64 {
        self.all.cpu / self.one.cpu
    }
}

/// Names of variants that goals look for.
pub const DEFAULT: &str = "default";
pub const PLACES: &str = "places moved";
pub const ALWAYS: &str = "filtering always";
pub const PLACES_ALWAYS: &str = "filtering always, places moved";
pub const TASKS: &str = "DAC, halves shared (default)";
pub const MBVH8: &str = "MBVH8";

impl Variants {
    /// How many times the second variant's rays of a bounce take as long as the first's.
    pub fn ratio(&self, [of, to]: [&str; 2], batch: usize) -> Option<f64> {
        let seconds = |name| Some(self.rows.iter().find(|row| row.name == name)?.seconds[batch]);
        Some(seconds(to)? / seconds(of)?)
    }

    pub fn scaling(&self, name: &str) -> Option<&Scaling> {
        self.scaling.iter().find(|scaling| scaling.name == name)
    }
}

/// Of a picture with one bounce.
pub fn measure(scene: &Scene, rays: &[RayBatch], level: Level, task: &Task<'_>) -> Result<Variants, Error> {
    let of = |width| DivideConquer::new(&scene.boxes, level, width);
    let auto = || of(Width::Auto);
    let ratio = |rays_per_triangle| DivideLimits { rays_per_triangle, ..DivideLimits::default() };
    let mut rivals = vec![
        Rival::new(DEFAULT, auto()),
        Rival::new(PLACES, auto().with_filtering(Filtering::Places)),
        Rival::new(ALWAYS, auto().with_limits(always())),
        Rival::new(PLACES_ALWAYS, auto().with_limits(always()).with_filtering(Filtering::Places)),
        Rival::new("middle splits alone", auto().with_limits(ratio(f32::INFINITY))),
        Rival::new("SAH splits alone", auto().with_limits(ratio(0.0))),
    ];
    for width in [Width::Four, Width::Eight, Width::Sixteen] {
        rivals.push(Rival::new(format!("width {width}"), of(width)));
    }
    task.console.stage(&format!("{}: variants", scene.name), (2 * task.repeat * rivals.len()) as u64);
    let eye = race(&rivals, &rays[0], Threads::One, task.repeat, task)?;
    let bounce = race(&rivals, &rays[1], Threads::One, task.repeat, task)?;
    let rows = rivals.iter().enumerate();
    let rows = rows.map(|(i, r)| Row { name: r.name.clone(), seconds: [eye[i].seconds, bounce[i].seconds] });
    let (rows, scaling) = (rows.collect(), scaling(scene, &rays[..2], level, task)?);
    task.console.clear();
    Ok(Variants { scene: scene.name, rows, scaling })
}

fn scaling(scene: &Scene, rays: &[RayBatch], level: Level, task: &Task<'_>) -> Result<Vec<Scaling>, Error> {
    let dac = |sharing| DivideConquer::new(&scene.boxes, level, Width::Auto).with_sharing(sharing);
    let rivals = [
        Rival::new(TASKS, dac(Sharing::Tasks)),
        Rival::new("DAC, naive", dac(Sharing::Naive)),
        Rival::new(MBVH8, Single::new(&scene.eight, level)),
    ];
    let mut sums = [const { [Spent { seconds: 0.0, cpu: 0.0 }; 2] }; 3];
    task.console.stage(&format!("{}: threads", scene.name), (4 * task.repeat * rivals.len()) as u64);
    for batch in rays {
        for (which, threads) in [Threads::One, Threads::All].into_iter().enumerate() {
            for (sums, spent) in sums.iter_mut().zip(race(&rivals, batch, threads, task.repeat, task)?) {
                sums[which].seconds += spent.seconds;
                sums[which].cpu += spent.cpu;
            }
        }
    }
    let scaling = rivals.iter().zip(sums).map(|(r, [one, all])| Scaling { name: r.name.clone(), one, all });
    Ok(scaling.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios() {
        let row = |name: &str, seconds| Row { name: name.into(), seconds };
        let [one, all] = [[4.0, 4.0], [2.0, 5.0]].map(|[seconds, cpu]| Spent { seconds, cpu });
        let variants = Variants {
            scene: Name::Hairball,
            rows: vec![row(DEFAULT, [1.0, 2.0]), row(PLACES, [3.0, 8.0])],
            scaling: vec![Scaling { name: MBVH8.into(), one, all }],
        };
        assert_eq!(variants.ratio([DEFAULT, PLACES], 1), Some(4.0));
        assert_eq!(variants.ratio([DEFAULT, ALWAYS], 1), None);
        let scaling = variants.scaling(MBVH8).expect("it is there");
        assert_eq!((scaling.speed_up(), scaling.work()), (2.0, 1.25));
    }
}
