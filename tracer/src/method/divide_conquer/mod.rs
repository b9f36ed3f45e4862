//! No tree: triangles are divided while rays are traced (Áfra 2012).

mod filter;
mod found;
mod intersect;
mod pack;
mod partition;
mod rays;
mod room;
mod tasks;
#[cfg(test)]
mod tests;
mod traverse;
mod triangles;

use super::{BitVec, Context, Method};
use crate::Error;
use crate::geometry::{Hit, HitBatch, RayBatch};
use crate::lanes::Width;
use rays::Row;
use room::{Room, Rooms};
use simd::Level;
use std::time::Duration;
use traverse::{Done, Query};
pub use triangles::TriangleBoxes;

/// How the rays that meet a box are kept together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Filtering {
    /// The rays are moved (section 3.1).
    #[default]
    Rays,
    /// Their places are, the rays stay (Mora 2011): 1.2 to 2.7 times slower for the rays of a diffuse bounce (`bench afra`).
    Places,
}

/// How the work is divided among the threads of the current rayon pool.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sharing {
    /// Each thread traces a part of the rays and divides all triangles for them (section 4).
    Naive,
    /// The halves of the triangles are tasks, each with a copy of the rays that meet it, so that triangles are divided once. Where there are more rays than
    /// triangles for each thread, to divide them again is cheaper than copies, and it is done as in [`Sharing::Naive`].
    #[default]
    Tasks,
}

/// When triangles are divided no further, and how they are divided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DivideLimits {
    /// As few active rays are intersected with all triangles: 8 in the paper.
    pub few_rays: usize,
    /// As few triangles are intersected with all active rays: 8 in the paper.
    pub few_triangles: usize,
    /// With more active rays than this for each triangle, triangles are divided by the surface area heuristic instead of through the middle. The
    /// paper has found 1 to 2 to be best.
    pub rays_per_triangle: f32,
    /// What a box test costs the surface area heuristic, when a triangle test costs 1. The paper does not name its own.
    pub box_cost: f32,
    /// Rays are not filtered where more than this part of a sample of them meets the box; 1 filters always, as the paper does. A ray that
    /// misses a box misses what it holds as well: to filter `n` rays, of which `p n` go on to two tests, costs less than not to when `1 + 2 p < 2`.
    /// (Nabata and others 2013 sample rays to know where dividing pays.)
    pub filter_below: f32,
}

impl Default for DivideLimits {
    fn default() -> Self {
        Self { few_rays: 8, few_triangles: 8, rays_per_triangle: 1.5, box_cost: 2.0, filter_below: 0.5 }
    }
}

/// Where time was spent, added up over threads.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Phases {
    /// Finding out which rays meet a box, and bringing them to the front.
    pub filter: Duration,
    /// Dividing triangles.
    pub partition: Duration,
    /// Intersecting rays and triangles.
    pub intersect: Duration,
}

/// Divide-and-conquer ray tracing (Áfra 2012): no acceleration structure at all. Many rays are traced together; the triangles are divided into two
/// halves, as a builder would, but only where rays go, and each half is traced with the rays that meet its box.
///
/// Made for scenes that change with each picture, and for batches of very many rays: a batch of few takes almost as long, for all triangles are looked at at least
/// once. All rays of a batch are traced at once, so memory grows with it: see [`DivideConquer::bytes`].
///
/// ```
/// use simd::Level;
/// use tracer::geometry::{HitBatch, Ray, RayBatch};
/// use tracer::method::{Context, DivideConquer, Method, TriangleBoxes, Width};
/// use tracer::{model::Model, progress::Silent};
///
/// # fn main() -> Result<(), tracer::Error> {
/// let (model, _warnings) = Model::open("balls:1", &Silent)?;
/// let rays: RayBatch = (0..1000).map(|i| Ray::new([0.001 * i as f32, 0.0, 5.0], [0.0, 0.0, -1.0])).collect();
/// let mut hits = HitBatch::new();
/// let triangles = TriangleBoxes::new(&model.mesh)?;
/// let method = DivideConquer::new(&triangles, Level::best(), Width::Auto);
/// method.closest(&rays, &mut hits, &mut Context::default())?;
/// assert!(!hits.get(0).is_miss());
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct DivideConquer<'a> {
    triangles: &'a TriangleBoxes,
    level: Level,
    width: Width,
    filtering: Filtering,
    sharing: Sharing,
    limits: DivideLimits,
    rooms: Rooms,
}

impl<'a> DivideConquer<'a> {
    /// Over triangles, at a level, with vectors of `width` rays. At the emulated levels (serial and scalar) vectors have one lane whatever the width.
    #[must_use]
    pub fn new(triangles: &'a TriangleBoxes, level: Level, width: Width) -> Self {
        Self {
            triangles,
            level,
            width,
            filtering: Filtering::default(),
            sharing: Sharing::default(),
            limits: DivideLimits::default(),
            rooms: Rooms::default(),
        }
    }

    /// With these limits.
    #[must_use]
    pub fn with_limits(self, limits: DivideLimits) -> Self {
        Self { limits, ..self }
    }

    /// With this way to keep rays together. [`Filtering::Places`] is for measurements: of one thread (with several, rays are moved where halves are tasks), and with
    /// vectors as wide as the level's registers.
    #[must_use]
    pub fn with_filtering(self, filtering: Filtering) -> Self {
        Self { filtering, ..self }
    }

    /// With this way to share work.
    #[must_use]
    pub fn with_sharing(self, sharing: Sharing) -> Self {
        Self { sharing, ..self }
    }

    /// Bytes for a number of rays, triangles and threads as the paper counts them: 32 R + (48 + 4 N) T, stack and hits left out.
    #[must_use]
    pub const fn bytes(rays: usize, triangles: usize, threads: usize) -> usize {
        size_of::<Row>() * rays + (TriangleBoxes::BYTES + size_of::<u32>() * threads) * triangles
    }

    /// As [`Method::closest`], and where time was spent. Looking at the clock makes it a little slower.
    ///
    /// # Errors
    /// As [`Method::closest`].
    pub fn closest_timed(&self, rays: &RayBatch, hits: &mut HitBatch, cx: &mut Context<'_>) -> Result<Phases, Error> {
        self.rooms.with(|room| {
            let done = self.find(rays, room, [false, true], cx)?;
            found::to_blocks(&room.found, hits.resize(rays.len()));
            Ok(done.phases)
        })
    }

    /// Leaves what was found in the room.
    fn find(&self, rays: &RayBatch, room: &mut Room, [any, clock]: [bool; 2], cx: &mut Context) -> Result<Done, Error> {
        let all = self.triangles.all;
        let Room { rows, found, ids, starts, .. } = room;
        let width = self.width.lanes(self.level);
        let [from, last] = rays::load_batch(rays.blocks(), self.level, rows);
        starts.clear();
        if from < last {
            starts.extend(rays.iter().map(|ray| ray.t_min));
        }
        found.clear();
        found.resize(rows.len(), Hit::MISS);
        if rows.is_empty() {
            return Ok(Done::default());
        }
        ids.clear();
        ids.extend_from_slice(&self.triangles.ids);
        let query = Query {
            triangles: self.triangles,
            level: self.level,
            width,
            limits: self.limits,
            filtering: self.filtering,
            from,
            starts,
            any,
            cancel: cx.cancel,
            clock,
        };
        let threads = rayon::current_num_threads();
        let done = if threads == 1 {
            query.run(ids, all, rows, found)
        } else if self.sharing == Sharing::Naive || rows.len() > threads * all.len() {
            tasks::naive(&query, &self.rooms, ids, all, rows, found)
        } else {
            tasks::shared(&query, &self.rooms, ids, all, rows, found)
        };
        cx.check()?;
        if let Some(counters) = &mut cx.counters {
            *counters = *counters + done.counters;
        }
        Ok(done)
    }
}

impl Method for DivideConquer<'_> {
    fn name(&self) -> &'static str {
        "divide-conquer"
    }

    fn source(&self) -> &'static str {
        "Áfra 2012"
    }

    fn memory(&self) -> usize {
        self.rooms.bytes()
    }

    fn closest(&self, rays: &RayBatch, hits: &mut HitBatch, cx: &mut Context<'_>) -> Result<(), Error> {
        self.rooms.with(|room| {
            self.find(rays, room, [false, false], cx)?;
            found::to_blocks(&room.found, hits.resize(rays.len()));
            Ok(())
        })
    }

    fn any(&self, rays: &RayBatch, occluded: &mut BitVec, cx: &mut Context<'_>) -> Result<(), Error> {
        self.rooms.with(|room| {
            self.find(rays, room, [true, false], cx)?;
            found::to_words(&room.found, occluded.resize(rays.len()));
            Ok(())
        })
    }
}
