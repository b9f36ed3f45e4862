//! What traversals do, whatever the machine: table 4 and figures 6 to 8.

use super::frames::{Asked, Setup, Task, Work, render};
use serde::Serialize;
use simd::Level;
use tracer::Error;
use tracer::geometry::RayBatch;
use tracer::method::{Auto, Context, Intervals, Reordering, Traversal, Width};
use tracer::progress::Progress;
use tracer::render::integrator::Query;
use tracer::stats::{Counters, Depth};

/// The five traversals, in the order of table 4.
pub const TRAVERSALS: [Traversal; 5] =
    [Traversal::Single, Traversal::Simd, Traversal::Packet, Traversal::Adaptive, Traversal::Exact];

/// The widths of figure 7.
pub const WIDTHS: [Width; 3] = [Width::Four, Width::Eight, Width::Sixteen];

/// Counts of the rays of one frame.
#[derive(Debug, Clone, Serialize)]
pub struct Counts {
    /// For each number of bounces.
    pub rays: [u64; 3],
    /// With most bounces: for each of [`WIDTHS`], each of [`TRAVERSALS`].
    pub rows: Vec<CountRow>,
    /// Figure 6.
    pub benefits: Vec<Benefit>,
}

/// What one traversal did, per ray; a test of a group of rays counts once.
#[derive(Debug, Clone, Serialize)]
pub struct CountRow {
    pub traversal: String,
    pub width: usize,
    /// By the lines of table 4: box tests, interval tests, rays reordered, triangle tests, nodes and triangles visited.
    pub per_ray: [f64; 6],
    /// Rays served by a box test; none where nothing was counted.
    pub box_speed_up: Option<f64>,
    /// Rays served by a triangle test.
    pub triangle_speed_up: Option<f64>,
    /// By the depth of the node: the part of the lanes that had a ray to test.
    pub utilization_by_depth: Vec<Option<f64>>,
}

/// Interval tests that are never left out, with so many bounces at most.
#[derive(Debug, Clone, Serialize)]
pub struct Benefit {
    pub intervals: &'static str,
    pub bounces: u32,
    /// By depth: box tests saved per ray, less the interval tests that failed.
    pub by_depth: Vec<f64>,
}

impl Counts {
    /// A row.
    pub fn row(&self, width: Width, traversal: Traversal) -> Option<&CountRow> {
        let at = WIDTHS.iter().position(|&w| w == width)? * TRAVERSALS.len();
        self.rows.get(at + TRAVERSALS.iter().position(|&t| t == traversal)?)
    }
}

impl CountRow {
    fn new(traversal: Traversal, width: usize, counters: &Counters, rays: u64) -> Self {
        let reordering = &counters.reordering;
        let counts = [
            counters.box_tests,
            reordering.interval_tests,
            reordering.reordered,
            counters.triangle_tests,
            reordering.steps,
            reordering.primitives,
        ];
        let utilization =
            |depth: &Depth| quotient(depth.box_rays, depth.box_tests).map(|rays| rays / width.max(1) as f64);
        Self {
            traversal: format!("{traversal:?}"),
            width,
            per_ray: counts.map(|n| quotient(n, rays).unwrap_or(0.0)),
            box_speed_up: quotient(reordering.box_rays(), counters.box_tests),
            triangle_speed_up: quotient(reordering.triangle_rays, counters.triangle_tests),
            utilization_by_depth: reordering.by_depth[..deepest(reordering)].iter().map(utilization).collect(),
        }
    }

    /// The part of the lanes of all box tests that had a ray to test.
    pub fn utilization(&self) -> Option<f64> {
        self.box_speed_up.map(|rays| rays / self.width as f64)
    }
}

/// Depths at which anything was counted.
fn deepest(reordering: &tracer::stats::Reordering) -> usize {
    reordering.by_depth.iter().rposition(|depth| *depth != Depth::default()).map_or(0, |last| last + 1)
}

fn quotient(a: u64, b: u64) -> Option<f64> {
    (b > 0).then(|| a as f64 / b as f64)
}

/// Counts the rays of one frame by all traversals at all widths, whose numbers are the same at every level.
pub fn count(work: &Work<'_>, task: &Task<'_>) -> Result<Counts, Error> {
    let level = Level::best();
    let of = |traversal, width| Reordering::new(&work.scene.bvh, level, width, traversal);
    let mut methods: Vec<Reordering<'_>> =
        WIDTHS.iter().flat_map(|&width| TRAVERSALS.map(|traversal| of(traversal, width))).collect();
    for intervals in [Intervals::Tight, Intervals::Loose] {
        let adaptive = of(Traversal::Adaptive, Width::Four);
        methods.push(adaptive.with_interval_tests_from(0).with_intervals(intervals));
    }
    let bounces = work.surface.bounces();
    // Of each method, for each number of reflections before.
    let mut counted = vec![vec![Counters::default(); bounces[2] as usize + 1]; methods.len()];
    let mut rays_at = vec![0; bounces[2] as usize + 1];
    task.console.stage("counting:", methods.len() as u64 * 2 * u64::from(bounces[2] + 1));
    let (mut asked, mut result) = (Asked::default(), Ok(()));
    let mut observer = |depth: usize, query: Query, rays: &RayBatch| {
        rays_at[depth] += rays.len() as u64;
        for (method, counted) in methods.iter().zip(&mut counted) {
            let mut cx = Context { counters: Some(Counters::default()), cancel: Some(task.console.cancel()) };
            // Only Ctrl-C makes it fail, which ends the rendering as well.
            if let Err(error) = asked.ask(method, query, rays, &mut cx) {
                result = Err(error);
            }
            counted[depth] = counted[depth] + cx.counters.unwrap_or_default();
            task.console.advance(1);
        }
    };
    let setup = Setup { level, width: Width::Auto };
    let auto = Auto::new(&work.scene.wide, level);
    render(work, &auto, setup, bounces[2], true, task, Some(&mut observer))?;
    result?;
    task.console.clear();

    let up_to = |bounces: u32| 0..=bounces as usize;
    let rays = bounces.map(|bounces| rays_at[up_to(bounces)].iter().sum());
    let total = |method: usize, bounces| {
        counted[method][up_to(bounces)].iter().copied().fold(Counters::default(), std::ops::Add::add)
    };
    let rows = (0..WIDTHS.len() * TRAVERSALS.len()).map(|i| {
        let (width, traversal) = (WIDTHS[i / TRAVERSALS.len()], TRAVERSALS[i % TRAVERSALS.len()]);
        let lanes = if traversal == Traversal::Single { 1 } else { width.lanes(level) };
        CountRow::new(traversal, lanes, &total(i, bounces[2]), rays[2])
    });
    let rows: Vec<CountRow> = rows.collect();
    let mut benefits = Vec::new();
    for (i, &bounces) in bounces.iter().enumerate() {
        for (method, intervals) in [(methods.len() - 2, "tight"), (methods.len() - 1, "loose")] {
            let reordering = total(method, bounces).reordering;
            let per_ray = |depth: &Depth| depth.interval_benefit as f64 / rays[i].max(1) as f64;
            let by_depth = reordering.by_depth[..deepest(&reordering)].iter().map(per_ray).collect();
            benefits.push(Benefit { intervals, bounces, by_depth });
        }
    }
    Ok(Counts { rays, rows, benefits })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_from_counters() {
        let mut counters = Counters { box_tests: 40, triangle_tests: 10, ..Counters::default() };
        counters.reordering.triangle_rays = 25;
        counters.reordering.reordered = 5;
        counters.reordering.by_depth[0] = Depth { box_tests: 10, box_rays: 30, interval_benefit: 0 };
        counters.reordering.by_depth[2] = Depth { box_tests: 30, box_rays: 30, interval_benefit: 0 };
        let row = CountRow::new(Traversal::Adaptive, 4, &counters, 20);
        assert_eq!(row.per_ray, [2.0, 0.0, 0.25, 0.5, 0.0, 0.0]);
        assert_eq!((row.box_speed_up, row.triangle_speed_up), (Some(1.5), Some(2.5)));
        assert_eq!(row.utilization(), Some(0.375));
        assert_eq!(row.utilization_by_depth, [Some(0.75), None, Some(0.25)]);
    }

    /// Nothing counted is not zero.
    #[test]
    fn nothing_counted() {
        let row = CountRow::new(Traversal::Exact, 16, &Counters::default(), 0);
        assert_eq!((row.per_ray, row.utilization(), row.triangle_speed_up), ([0.0; 6], None, None));
        assert!(row.utilization_by_depth.is_empty());
    }
}
