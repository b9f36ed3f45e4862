//! Scenes that change with each picture: the time to build counts. And at how many rays per triangle a tree begins to pay.

use super::race::{Anew, Rival, Spent, Task, Threads, race};
use super::scenes::{Name, Scene};
use crate::report::clock::median;
use serde::Serialize;
use simd::Level;
use std::array::from_fn;
use tracer::Error;
use tracer::bvh::{BuildConfig, CollapseConfig, WideBvh};
use tracer::geometry::RayBatch;
use tracer::method::{Auto, Single, TriangleBoxes};
use tracer::progress::{Progress, Silent};

/// Who is compared: divide and conquer first, then trees by the two builders, each with two methods.
pub const RIVALS: [&str; 5] = ["DAC", "fast, MBVH8", "fast, auto", "medium, MBVH8", "medium, auto"];

/// What a rival takes of [`Contest::builds`].
const BUILD: [usize; 5] = [0, 1, 1, 2, 2];

/// One scene.
#[derive(Debug, Clone, Serialize)]
pub struct Dynamic {
    pub scene: Name,
    pub triangles: usize,
    pub level: String,
    /// CPU seconds to take boxes, to build by the fast and by the medium builder.
    pub builds: [f64; 3],
    /// At the size of the table.
    pub frame: Point,
    /// By ascending size.
    pub points: Vec<Point>,
}

/// A picture of one size.
#[derive(Debug, Clone, Serialize)]
pub struct Point {
    pub pixels: [usize; 2],
    /// Eye rays and those of the first bounce.
    pub rays: [usize; 2],
    /// CPU seconds of [`RIVALS`] for these.
    pub trace: [[f64; 2]; 5],
}

/// Rays that are traced after building: those of the eye alone, or with those of one bounce.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rays {
    Eye,
    Path,
}

impl Rays {
    fn sum<T: Copy + std::ops::Add<Output = T>>(self, [eye, bounce]: [T; 2]) -> T {
        if self == Self::Eye { eye } else { eye + bounce }
    }
}

impl Dynamic {
    /// CPU seconds of a rival to build and to trace.
    pub fn total(&self, point: &Point, rival: usize, rays: Rays) -> f64 {
        self.builds[BUILD[rival]] + rays.sum(point.trace[rival])
    }

    /// The best of the trees.
    pub fn best_tree(&self, point: &Point, rays: Rays) -> f64 {
        (1..RIVALS.len()).map(|rival| self.total(point, rival, rays)).fold(f64::INFINITY, f64::min)
    }

    /// The best with the tree of a builder: 1 fast, 2 medium.
    pub fn best_by(&self, builder: usize, point: &Point, rays: Rays) -> f64 {
        let by = (0..RIVALS.len()).filter(|&rival| BUILD[rival] == builder);
        by.map(|rival| self.total(point, rival, rays)).fold(f64::INFINITY, f64::min)
    }

    pub fn rays_per_triangle(&self, point: &Point, rays: Rays) -> f64 {
        rays.sum(point.rays) as f64 / self.triangles as f64
    }

    /// Where divide and conquer takes as long as the best of the trees.
    pub fn crossover(&self, rays: Rays) -> Crossover {
        let at = |point: &Point| {
            let ratio = self.total(point, 0, rays) / self.best_tree(point, rays);
            [self.rays_per_triangle(point, rays), ratio]
        };
        Crossover::of(&self.points.iter().map(at).collect::<Vec<_>>())
    }
}

/// Where a ratio becomes more than one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Crossover {
    /// It is below before, and above behind.
    At(f64),
    /// Below from the first place to the last.
    Below([f64; 2]),
    /// Above at the last place, and at all from the given on, with no place below before.
    Above([f64; 2]),
    /// More than one change, or none to tell of.
    Unclear,
}

impl Crossover {
    /// From places and ratios, both on logarithmic scales.
    fn of(points: &[[f64; 2]]) -> Self {
        let (Some(&[first, _]), Some(&[last, _])) = (points.first(), points.last()) else { return Self::Unclear };
        let below = points.iter().take_while(|[_, ratio]| *ratio < 1.0).count();
        if points[below..].iter().any(|[_, ratio]| *ratio < 1.0) {
            return Self::Unclear;
        }
        if below == points.len() {
            return Self::Below([first, last]);
        }
        if below == 0 {
            return Self::Above([first, last]);
        }
        let [[x0, y0], [x1, y1]] = [points[below - 1], points[below]].map(|point| point.map(f64::ln));
        Self::At((x0 - y0 * (x1 - x0) / (y1 - y0)).exp())
    }
}

/// What is built, and how long it took.
struct Contest<'a> {
    name: Name,
    boxes: &'a TriangleBoxes,
    trees: [WideBvh<8>; 2],
    builds: [f64; 3],
    level: Level,
}

impl<'a> Contest<'a> {
    fn new(scene: &'a Scene, level: Level, task: &Task<'_>) -> Result<Self, Error> {
        let mesh = &scene.model.mesh;
        task.console.stage(&format!("{}: building", scene.name), 3 * task.repeat as u64);
        let mut times = [const { Vec::new() }; 3];
        let mut trees = None;
        for _ in 0..task.repeat {
            let (boxes, spent) = task.run(Threads::One, || TriangleBoxes::new(mesh));
            boxes?;
            times[0].push(spent.seconds);
            let tree = |config: BuildConfig, times: &mut Vec<f64>| {
                task.console.check()?;
                let collapse = CollapseConfig::default();
                let build = || WideBvh::<8>::build(mesh, &config, &collapse, &Silent);
                let (tree, Spent { seconds, .. }) = task.run(Threads::One, build);
                times.push(seconds);
                task.console.advance(1);
                tree
            };
            // The trees of the round before are gone by now.
            drop(trees.take());
            trees = Some([tree(BuildConfig::fast(), &mut times[1])?, tree(BuildConfig::medium(), &mut times[2])?]);
        }
        task.console.clear();
        let trees = trees.ok_or_else(|| Error::Usage("no round, nothing to measure".into()))?;
        Ok(Self { name: scene.name, boxes: &scene.boxes, trees, builds: from_fn(|i| median(&times[i])), level })
    }

    fn point(&self, pixels: [usize; 2], rays: [&RayBatch; 2], rounds: usize, task: &Task<'_>) -> Result<Point, Error> {
        let Self { boxes, level, .. } = *self;
        let [fast, medium] = &self.trees;
        let rivals = [
            Rival::new(RIVALS[0], Anew { boxes, level }),
            Rival::new(RIVALS[1], Single::new(fast, level)),
            Rival::new(RIVALS[2], Auto::new(fast, level)),
            Rival::new(RIVALS[3], Single::new(medium, level)),
            Rival::new(RIVALS[4], Auto::new(medium, level)),
        ];
        let [w, h] = pixels;
        task.console.stage(&format!("{}: building and tracing {w}x{h}", self.name), (2 * rounds * rivals.len()) as u64);
        let eye = race(&rivals, rays[0], Threads::One, rounds, task)?;
        let bounce = race(&rivals, rays[1], Threads::One, rounds, task)?;
        task.console.clear();
        let trace = from_fn(|i| [eye[i].seconds, bounce[i].seconds]);
        Ok(Point { pixels, rays: rays.map(RayBatch::len), trace })
    }
}

/// A frame of the table's size, and (unless the scene is only a row of the table) smaller and larger ones.
pub fn measure(scene: &Scene, rays: &[RayBatch], level: Level, task: &Task<'_>) -> Result<Dynamic, Error> {
    let contest = Contest::new(scene, level, task)?;
    let [eye, bounce] = [0, 1].map(|depth| &rays[depth]);
    let frame = contest.point(task.size, [eye, bounce], task.repeat, task)?;
    let triangles = scene.model.mesh.triangles.len();
    let mut points = Vec::new();
    if scene.name != Name::Fairy {
        for pixels in sizes(triangles, if task.quick { 1 << 13 } else { MOST_PIXELS }) {
            let rays = scene.rays(pixels, 1, task)?;
            let many = rays.iter().map(RayBatch::len).sum::<usize>() > MANY_RAYS;
            points.push(contest.point(pixels, [&rays[0], &rays[1]], if many { 1 } else { task.repeat }, task)?);
        }
    }
    let (builds, level) = (contest.builds, level.to_string());
    Ok(Dynamic { scene: scene.name, triangles, level, builds, frame, points })
}

/// Pixels of the largest picture.
const MOST_PIXELS: usize = 3_000_000;
/// So many are traced once: one round is long enough.
const MANY_RAYS: usize = 1_000_000;

/// Pictures of 4:3 for 1/64, 1/32 ... 8 rays per triangle, two for each pixel; those with too many pixels left out.
fn sizes(triangles: usize, most: usize) -> Vec<[usize; 2]> {
    let size = |k: i32| {
        let pixels = 0.5 * 2.0_f64.powi(k) * triangles as f64;
        let width = (pixels * 4.0 / 3.0).sqrt();
        [width, 0.75 * width].map(|side| side.round().max(1.0) as usize)
    };
    (-6..=3).map(size).filter(|[w, h]| w * h <= most).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossovers() {
        let of = |ratios: &[f64]| {
            let points = ratios.iter().enumerate().map(|(i, &ratio)| [4.0_f64.powi(i as i32), ratio]);
            Crossover::of(&points.collect::<Vec<_>>())
        };
        assert_eq!(of(&[0.5, 0.9]), Crossover::Below([1.0, 4.0]));
        assert_eq!(of(&[1.5, 1.0]), Crossover::Above([1.0, 4.0]));
        assert_eq!((of(&[0.5, 2.0, 0.5]), of(&[])), (Crossover::Unclear, Crossover::Unclear));
        assert_eq!(of(&[2.0, 0.5, 2.0]), Crossover::Unclear);
        let Crossover::At(x) = of(&[0.25, 0.5, 2.0, 4.0]) else { panic!("it is between 4 and 16") };
        assert!((x - 8.0).abs() < 1e-9, "{x}");
    }

    #[test]
    fn sizes_ascend_and_end() {
        let all = sizes(283_142, MOST_PIXELS);
        assert_eq!(all.len(), 10);
        assert!(all.is_sorted() && sizes(2_880_000, MOST_PIXELS).len() < 10);
        let [w, h] = all[9];
        assert!(((2 * w * h) as f64 / 283_142.0 - 8.0).abs() < 0.1, "{w} x {h}");
    }

    /// A tree's time to build counts for both of its methods.
    #[test]
    fn totals() {
        let trace = [[1.0, 2.0], [0.5, 0.5], [0.25, 0.25], [0.1, 0.2], [0.1, 0.1]];
        let frame = Point { pixels: [10, 1], rays: [10, 5], trace };
        let (scene, level) = (Name::Fairy, String::new());
        let d = Dynamic { scene, triangles: 10, level, builds: [0.5, 1.0, 4.0], frame, points: Vec::new() };
        assert_eq!((d.total(&d.frame, 0, Rays::Eye), d.total(&d.frame, 0, Rays::Path)), (1.5, 3.5));
        assert_eq!((d.best_tree(&d.frame, Rays::Eye), d.best_by(2, &d.frame, Rays::Path)), (1.25, 4.2));
        assert_eq!(d.rays_per_triangle(&d.frame, Rays::Path), 1.5);
    }
}
