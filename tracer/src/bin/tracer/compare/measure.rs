//! The measurement itself.

use super::report::{Paper, Report, Row, Tests};
use crate::args::{self, PictureOptions};
use crate::console::Console;
use crate::machine;
use crate::method::{MethodChoice, Tree, reordered};
use crate::workload::{Built, Workload, median, mrays_per_s, ms};
use cpu_time::ThreadTime;
use rayon::ThreadPool;
use simd::{Isa, Level};
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tracer::Error;
use tracer::geometry::{Aabb, HitBatch};
use tracer::method::{Context, Method, Packet, SlabForm, Width};
use tracer::model::Camera;
use tracer::progress::Progress;
use tracer::render::{EyeRays, Frame, Settings};
use tracer::sort::Reorder;
use tracer::stats::Counters;

/// A row of the comparison.
struct Case {
    name: String,
    method: MethodChoice,
    /// What its rays are sorted by before.
    reorder: Reorder,
    level: Level,
    width: Width,
    one_thread: Vec<Sample>,
    all_threads: Vec<Sample>,
}

/// One frame.
#[derive(Clone, Copy)]
struct Sample {
    /// Eye rays, casting, shading.
    passes: [f64; 3],
    hits: usize,
    hits_hash: u64,
    image_hash: u64,
}

/// What all frames have in common.
struct Task<'a> {
    work: &'a Workload,
    built: &'a Built,
    /// Of packets.
    binary: Tree,
    /// Of the method that is compared.
    tree: Tree,
    bounds: Aabb,
    camera: Camera,
    options: &'a PictureOptions,
    console: &'a Console,
}

/// Measures every level and width of this CPU, by a method after an order of the rays; `pool` has all threads.
pub fn measure(
    work: &Workload,
    built: &Built,
    (method, reorder): (MethodChoice, Reorder),
    options: &PictureOptions,
    repeat: NonZeroUsize,
    pool: &ThreadPool,
    console: &Console,
) -> Result<Report, Error> {
    let load_average = machine::load_average();
    let camera = options.camera.unwrap_or_else(|| work.scene.camera_or_default());
    let bvh = &built.bvh;
    let tree = pool.install(|| method.tree(&work.scene.mesh, || Ok(Arc::clone(bvh))))?;
    let (binary, bounds) = (Tree::Binary(Arc::clone(bvh)), work.scene.mesh.bounds());
    let task = Task { work, built, binary, tree, bounds, camera, options, console };
    let one = args::pool(NonZeroUsize::new(1))?;
    let mut cases = cases(method, reorder);
    console.stage("compare", (cases.len() * (repeat.get() + 1)) as u64);
    for round in 0..=repeat.get() {
        for case in &mut cases {
            let single = one.install(|| task.frame(case, &cpu_time))?;
            let clock = Instant::now();
            let all = pool.install(|| task.frame(case, &|| clock.elapsed()))?;
            // The first round warms up.
            if round > 0 {
                case.one_thread.push(single);
                case.all_threads.push(all);
            }
            console.advance(1);
        }
    }
    let tests = if (method, reorder) == <(MethodChoice, Reorder)>::default() {
        pool.install(|| task.count())?
    } else {
        Vec::new()
    };
    console.clear();
    Ok(task.report(&cases, tests, pool.current_num_threads(), load_average))
}

fn cpu_time() -> Duration {
    ThreadTime::now().as_duration()
}

/// The three serial rows first, which are packets of rays as they come always, then all levels of this CPU.
fn cases(method: MethodChoice, reorder: Reorder) -> Vec<Case> {
    let serial = Level::new(Isa::Serial).map(|l| (l, Width::Four));
    let plain = [(Level::SCALAR, Width::One), (Level::SCALAR, Width::Four)];
    let serial = serial.into_iter().chain(plain).map(|(level, width)| Case::new(MethodChoice::Packet, level, width));
    let mut cases: Vec<Case> = serial.collect();
    for level in Level::available() {
        let widths: &[Width] = match method {
            // Vectors of four are emulated there to be compared with, and nothing else.
            _ if level.isa() == Isa::Serial => &[],
            _ if !method.has_packets() => &[Width::Auto],
            // Emulated, these have one lane at any width.
            _ if method.is_plain_if_emulated() && level.isa() == Isa::Scalar => &[Width::One],
            _ => &[Width::Four, Width::Eight, Width::Sixteen],
        };
        for &width in widths {
            let case = Case::new(method, level, width).after(reorder);
            if cases.iter().all(|other| other.name != case.name) {
                cases.push(case);
            }
        }
    }
    cases
}

impl Case {
    fn new(method: MethodChoice, level: Level, width: Width) -> Self {
        let n = width.lanes(level);
        let upper = level.isa().name().to_uppercase();
        let name = match (method, level.isa()) {
            (MethodChoice::Packet, _) if n == 1 => "f32, one lane".into(),
            (MethodChoice::Packet, Isa::Serial) => format!("emulated float{n}"),
            (MethodChoice::Packet, Isa::Scalar) => format!("float{n} as LLVM likes"),
            (MethodChoice::Packet, _) => format!("{upper} float{n}"),
            _ if method.has_packets() && n == 1 => format!("{upper} {}, one lane", method.name()),
            _ if method.has_packets() => format!("{upper} {}, float{n}", method.name()),
            _ => format!("{upper} {}", method.name()),
        };
        let reorder = Reorder::None;
        Self { name, method, reorder, level, width, one_thread: Vec::new(), all_threads: Vec::new() }
    }

    fn after(self, reorder: Reorder) -> Self {
        match reorder {
            Reorder::None => self,
            _ => Self { name: format!("{}, sorted by {reorder}", self.name), reorder, ..self },
        }
    }
}

impl Task<'_> {
    /// Renders one frame on the current pool; `now` is the clock.
    fn frame(&self, case: &Case, now: &dyn Fn() -> Duration) -> Result<Sample, Error> {
        let mut cx = Context { counters: None, cancel: Some(self.console.cancel()) };
        // The rows in emulation need no other tree.
        let tree = if case.method == MethodChoice::Packet { &self.binary } else { &self.tree };
        let method = case.method.over(tree, case.level, case.width, SlabForm::Exact);
        let method = reordered(method, &self.bounds, case.level, case.reorder);
        let mut frame = Frame::new(&self.work.scene, &self.work.surfaces, self.camera, self.settings(case));
        let start = now();
        frame.eye_rays();
        let eye = now();
        frame.cast(&*method, &mut cx)?;
        let cast = now();
        let image = frame.shade(&cx)?;
        let end = now();
        Ok(Sample {
            passes: [eye - start, cast - eye, end - cast].map(ms),
            hits: frame.hits().iter().filter(|h| !h.is_miss()).count(),
            hits_hash: frame.hits().hash(),
            image_hash: image.hash(),
        })
    }

    fn settings(&self, case: &Case) -> Settings {
        let (size, shadows) = (self.options.size, self.options.shadows);
        Settings { width: size.width, height: size.height, level: case.level, lanes: case.width, shadows }
    }

    /// Counts the work of the eye rays, at each width.
    fn count(&self) -> Result<Vec<Tests>, Error> {
        let level = Level::best();
        let size = self.options.size;
        let eye = EyeRays::new(&self.camera, size.width, size.height, level, Width::Auto);
        let counts = |width| {
            let mut cx = Context { counters: Some(Counters::default()), cancel: Some(self.console.cancel()) };
            Packet::new(&self.built.bvh, level, width).closest(eye.rays(), &mut HitBatch::new(), &mut cx)?;
            let counters = cx.counters.unwrap_or_default();
            let per_ray = |n: u64| n as f64 / size.pixels() as f64;
            Ok([per_ray(counters.box_tests), per_ray(counters.triangle_tests)])
        };
        let single = counts(Width::One)?;
        let ratio = |a: f64, b: f64| if b > 0.0 { a / b } else { 1.0 };
        let tests = |width: Width| {
            let (n, [boxes, triangles]) = (width.lanes(level), counts(width)?);
            Ok(Tests {
                width: n,
                box_tests_per_ray: boxes,
                triangle_tests_per_ray: triangles,
                box_utilization: ratio(single[0], n as f64 * boxes),
                triangle_utilization: ratio(single[1], n as f64 * triangles),
            })
        };
        [Width::One, Width::Four, Width::Eight, Width::Sixteen].into_iter().map(tests).collect()
    }

    fn report(&self, cases: &[Case], tests: Vec<Tests>, threads: usize, load_average: Option<f64>) -> Report {
        let (scene, size, shadows) = (&self.work.scene, self.options.size, self.options.shadows);
        let baseline = cases.first().and_then(|c| c.one_thread.first().copied());
        let hits = baseline.map_or(0, |b| b.hits);
        let lights = scene.lights_or_headlight(&self.camera).len();
        let rays = size.pixels() + if shadows { hits * lights } else { 0 };
        let mut rows: Vec<Row> = cases.iter().map(|case| row(case, baseline, rays)).collect();
        let [cast, total] = rows.first().map_or([0.0; 2], |r| [r.cast_ms, r.total_ms]);
        for row in &mut rows {
            row.cast_speedup = cast / row.cast_ms;
            row.total_speedup = total / row.total_ms;
        }
        let (levels, missing) = machine::levels();
        let repeat = cases.first().map_or(0, |c| c.one_thread.len());
        Report {
            scene: scene.name.clone(),
            triangles: scene.mesh.triangles.len(),
            build: self.built.name,
            width: size.width,
            height: size.height,
            camera: self.camera.to_string(),
            shadows,
            cpu: machine::cpu(),
            threads,
            levels,
            missing,
            load_average,
            repeat,
            measurement: format!(
                "CPU time of one thread, all rows in turn in each round, medians (rounds: {repeat} after one to warm up); \
                 all {threads} threads: likewise, but time on the clock"
            ),
            rays,
            all_identical: rows.iter().all(|r| r.identical),
            rows,
            tests,
        }
    }
}

/// Medians of a case's samples; speed-ups are left for the caller.
fn row(case: &Case, baseline: Option<Sample>, rays: usize) -> Row {
    let times = |samples: &[Sample], pass: fn(&Sample) -> f64| median(samples.iter().map(pass).collect());
    let total = |s: &Sample| s.passes.iter().sum();
    let (one, all) = (&case.one_thread, &case.all_threads);
    let (cast_ms, total_ms) = (times(one, |s| s.passes[1]), times(one, total));
    let all_threads_total_ms = times(all, total);
    let hashes = |s: &Sample| [s.hits_hash, s.image_hash];
    let identical = one.iter().chain(all).all(|s| baseline.is_some_and(|b| hashes(s) == hashes(&b)));
    // Of a sample that differs, if there is one.
    let differs = |s: &&Sample| baseline.is_some_and(|b| hashes(s) != hashes(&b));
    let shown = one.iter().chain(all).find(differs).or(one.first()).map_or([0; 2], hashes);
    let width = case.width.lanes(case.level);
    let paper = Paper::of(case.level.isa(), width).filter(|_| (case.method, case.reorder) == Default::default());
    Row {
        name: case.name.clone(),
        level: case.level.isa().name(),
        width,
        eye_ms: times(one, |s| s.passes[0]),
        cast_ms,
        shade_ms: times(one, |s| s.passes[2]),
        total_ms,
        mrays_per_s: mrays_per_s(rays, cast_ms),
        cast_speedup: 0.0,
        total_speedup: 0.0,
        paper_cast_min: paper.map(|p| p.cast[0]),
        paper_cast_max: paper.map(|p| p.cast[1]),
        paper_total_min: paper.map(|p| p.total[0]),
        paper_total_max: paper.map(|p| p.total[1]),
        all_threads_cast_ms: times(all, |s| s.passes[1]),
        all_threads_total_ms,
        all_threads_speedup: total_ms / all_threads_total_ms,
        hits_hash: format!("{:016x}", shown[0]),
        image_hash: format!("{:016x}", shown[1]),
        identical,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(times: [f64; 3], hash: u64) -> Sample {
        Sample { passes: times, hits: 1, hits_hash: hash, image_hash: 7 }
    }

    fn case(one_thread: Vec<Sample>, all_threads: Vec<Sample>) -> Case {
        Case { one_thread, all_threads, ..Case::new(MethodChoice::Packet, Level::SCALAR, Width::Four) }
    }

    #[test]
    fn serial_rows_come_first_and_none_twice() {
        let cases = cases(MethodChoice::Packet, Reorder::None);
        let names: Vec<&str> = cases.iter().map(|c| c.name.as_str()).collect();
        if Level::new(Isa::Serial).is_some() {
            assert_eq!(names[..3], ["emulated float4", "f32, one lane", "float4 as LLVM likes"]);
        }
        let mut unique = names.clone();
        unique.sort_unstable();
        unique.dedup();
        assert_eq!(unique.len(), names.len(), "{names:?}");
        let serial = usize::from(Level::new(Isa::Serial).is_some());
        assert_eq!(cases.len(), 1 + serial + 3 * (Level::available().count() - serial));
        // Methods that are not of the paper that emulation is compared with.
        let others = super::cases(MethodChoice::BoulosSimd, Reorder::None);
        let names: Vec<&str> = others.iter().skip(2 + serial).map(|c| c.name.as_str()).collect();
        assert_eq!(names[0], "SCALAR boulos-simd, one lane");
        assert!(names.iter().all(|name| !name.starts_with("SERIAL")), "{names:?}");
    }

    #[test]
    fn rows_are_medians_of_each_pass() {
        let samples = vec![sample([1.0, 9.0, 3.0], 5), sample([2.0, 7.0, 1.0], 5), sample([3.0, 8.0, 2.0], 5)];
        let all = vec![sample([1.0, 2.0, 2.0], 5)];
        let row = row(&case(samples.clone(), all), Some(samples[0]), 8000);
        assert_eq!([row.eye_ms, row.cast_ms, row.shade_ms, row.total_ms], [2.0, 8.0, 2.0, 13.0]);
        assert_eq!((row.mrays_per_s, row.all_threads_total_ms, row.all_threads_speedup), (1.0, 5.0, 13.0 / 5.0));
        assert!(row.identical);
    }

    #[test]
    fn one_differing_frame_is_enough() {
        let (good, bad) = (sample([1.0; 3], 5), sample([1.0; 3], 6));
        for case in [case(vec![good, bad], vec![good]), case(vec![good, good], vec![bad])] {
            let row = row(&case, Some(good), 1);
            assert!(!row.identical);
            assert_eq!(row.hits_hash, format!("{:016x}", 6));
        }
    }
}
