//! Table 1: million rays per second, trees built before.

use super::race::{Rival, Task, Threads, race};
use super::scenes::{Name, Scene};
use serde::Serialize;
use simd::Level;
use tracer::Error;
use tracer::geometry::RayBatch;
use tracer::method::{DivideConquer, Single, Width};
use tracer::progress::Progress;

/// A method of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Kind {
    Dac,
    Mbvh4,
    Mbvh8,
    Mbvh16,
}

impl Kind {
    pub const ALL: [Self; 4] = [Self::Dac, Self::Mbvh4, Self::Mbvh8, Self::Mbvh16];

    /// As the paper calls it.
    pub fn title(self) -> &'static str {
        match self {
            Self::Dac => "DAC",
            Self::Mbvh4 => "MBVH4",
            Self::Mbvh8 => "MBVH8",
            Self::Mbvh16 => "MBVH16",
        }
    }

    fn rival(self, scene: &Scene, level: Level) -> Rival<'_> {
        let name = format!("{} at {level}", self.title());
        match self {
            Self::Dac => Rival::new(name, DivideConquer::new(&scene.boxes, level, Width::Auto)),
            Self::Mbvh4 => Rival::new(name, Single::new(&scene.four, level)),
            Self::Mbvh8 => Rival::new(name, Single::new(&scene.eight, level)),
            Self::Mbvh16 => Rival::new(name, Single::new(&scene.sixteen, level)),
        }
    }
}

/// One scene's part of the table.
#[derive(Debug, Clone, Serialize)]
pub struct Speeds {
    pub scene: Name,
    /// By the number of bounces before.
    pub rays: Vec<usize>,
    /// For each level, each of [`Kind::ALL`].
    pub rows: Vec<Row>,
}

/// A line of it.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    pub kind: Kind,
    pub level: String,
    /// Million rays per second: with 1 bounce by one and all threads, with 8 bounces by one and all.
    pub mrays: [f64; 4],
}

impl Speeds {
    /// At the best level, which is the last.
    pub fn best(&self, kind: Kind) -> Option<&Row> {
        self.rows.iter().rfind(|row| row.kind == kind)
    }
}

/// Bounces of the two halves of the table.
pub const BOUNCES: [usize; 2] = [1, 8];

/// All rows at all levels. Later bounces, which are many, have a third of the rounds.
pub fn measure(scene: &Scene, rays: &[RayBatch], levels: &[Level], task: &Task<'_>) -> Result<Speeds, Error> {
    let rounds = |depth: usize| if depth <= BOUNCES[0] { task.repeat } else { task.repeat.div_ceil(3) };
    let rivals = levels.iter().flat_map(|&level| Kind::ALL.map(|kind| kind.rival(scene, level)));
    let rivals: Vec<Rival<'_>> = rivals.collect();
    let all = (0..rays.len()).map(|depth| 2 * rounds(depth) * rivals.len()).sum::<usize>();
    task.console.stage(&format!("{}: rays per second", scene.name), all as u64);
    // Of each rival, by the columns of the table.
    let mut seconds = vec![[0.0; 4]; rivals.len()];
    for (depth, batch) in rays.iter().enumerate() {
        for (which, threads) in [Threads::One, Threads::All].into_iter().enumerate() {
            let spent = race(&rivals, batch, threads, rounds(depth), task)?;
            for (seconds, spent) in seconds.iter_mut().zip(spent) {
                for (half, &bounces) in BOUNCES.iter().enumerate() {
                    if depth <= bounces {
                        seconds[2 * half + which] += spent.seconds;
                    }
                }
            }
        }
    }
    task.console.clear();
    let rays: Vec<usize> = rays.iter().map(RayBatch::len).collect();
    let rows = seconds.iter().enumerate().map(|(i, seconds)| Row {
        kind: Kind::ALL[i % Kind::ALL.len()],
        level: levels[i / Kind::ALL.len()].to_string(),
        mrays: std::array::from_fn(|column| mrays(&rays, BOUNCES[column / 2], seconds[column])),
    });
    Ok(Speeds { scene: scene.name, rows: rows.collect(), rays })
}

fn mrays(rays: &[usize], bounces: usize, seconds: f64) -> f64 {
    1e-6 * rays.iter().take(bounces + 1).sum::<usize>() as f64 / seconds
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_up_to_a_bounce() {
        assert_eq!(mrays(&[3_000_000, 1_000_000, 500_000], 1, 2.0), 2.0);
        assert_eq!(mrays(&[3_000_000, 1_000_000, 500_000], 8, 0.5), 9.0);
    }
}
