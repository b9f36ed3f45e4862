//! Frusta around sorted packets, breadth first through the tree: Garanzha & Loop 2010.

mod boxes;
mod build;
mod children;
mod depth_first;
mod intersect;
mod leaves;
mod portion;
mod queue;
mod runs;
mod stages;
#[cfg(test)]
mod tests;

pub use stages::Stages;

use super::query::{Any, Closest};
use super::{BitVec, Context, Method};
use crate::Error;
use crate::bvh::{Bvh, OctoBvh};
use crate::clock::Clock;
use crate::geometry::frustum::Space;
use crate::geometry::{HitBatch, RayBatch};
use crate::lanes::Width;
use crate::sort::{RayHash, RaySorter, Reorder};
use portion::Pool;
use runs::Decomposition;
use simd::Level;
use std::time::Duration;

/// In which order frusta go through the tree. Both find the same hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Visit {
    /// All frusta level by level, by queues: the paper's.
    #[default]
    BreadthFirst,
    /// One frustum after the other, by a stack.
    DepthFirst,
}

/// Packets of rays in frusta, which go through the tree instead of them; rays are tested against the leaves that their frustum captured.
///
/// ```
/// use simd::Level;
/// use tracer::bvh::{BuildConfig, Bvh, OctoBvh, OctoConfig};
/// use tracer::geometry::{HitBatch, Ray, RayBatch};
/// use tracer::method::{BreadthFirst, Context, Method, Width};
/// use tracer::{model::Model, progress::Silent};
///
/// # fn main() -> Result<(), tracer::Error> {
/// let (model, _warnings) = Model::open("balls:1", &Silent)?;
/// let bvh = Bvh::build(&model.mesh, &BuildConfig::default(), &Silent)?;
/// let octo = OctoBvh::new(&bvh, &OctoConfig::default())?;
/// let rays: RayBatch = (0..100).map(|i| Ray::new([0.01 * i as f32, 0.0, 5.0], [0.0, 0.0, -1.0])).collect();
/// let mut hits = HitBatch::new();
/// BreadthFirst::new(&bvh, &octo, Level::best(), Width::Auto).closest(&rays, &mut hits, &mut Context::default())?;
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct BreadthFirst<'a> {
    bvh: &'a Bvh,
    tree: &'a OctoBvh,
    space: Space,
    level: Level,
    width: Width,
    /// Blocks of sixteen rays.
    packet: usize,
    queue: usize,
    visit: Visit,
    /// For batches of rays that do not start at one point.
    sort: Option<RayHash>,
    pool: Pool,
}

impl<'a> BreadthFirst<'a> {
    /// Elements of a queue where nothing else is wanted.
    pub const QUEUE: usize = 4 << 20;

    /// Over a binary tree and what was made of it, at a level, with groups of `width` rays in the last stage, and the paper's values of all else.
    /// At emulated levels (serial and scalar) groups have one ray whatever the width, but where work is counted.
    #[must_use]
    pub fn new(bvh: &'a Bvh, tree: &'a OctoBvh, level: Level, width: Width) -> Self {
        let space = Space::new(tree.bounds());
        Self {
            bvh,
            tree,
            space,
            level,
            width,
            packet: 16,
            queue: Self::QUEUE,
            visit: Visit::default(),
            sort: Some(RayHash::new(&space.bounds, Reorder::Hash)),
            pool: Pool::default(),
        }
    }

    /// With packets of at most so many rays ("MaxSize"), of which whole sixteens are taken, one at least: by default 256.
    #[must_use]
    pub fn with_packet(self, rays: usize) -> Self {
        Self { packet: rays.clamp(16, 1 << 15) / 16, ..self }
    }

    /// With queues of at most so many elements for each thread (32 bytes each, taken as they are needed), by default [`BreadthFirst::QUEUE`]. When they do not fit the batch of frusta is split in two, again and
    /// again; for a single frustum queues grow.
    #[must_use]
    pub fn with_queue(self, elements: usize) -> Self {
        Self { queue: elements.clamp(1, 1 << 28), pool: Pool::default(), ..self }
    }

    /// With frusta in this order through the tree.
    #[must_use]
    pub fn with_visit(self, visit: Visit) -> Self {
        Self { visit, pool: Pool::default(), ..self }
    }

    /// With rays sorted by this hash, and packets of rays of one cell, if the rays do not all start at one point; or never, so that packets are what comes
    /// one after the other. By default the paper's cells and [`Reorder::Hash`]. Rays that start at one point are taken as they come: eye rays along a Z-curve,
    /// say.
    #[must_use]
    pub fn with_sort(self, hash: Option<RayHash>) -> Self {
        let hash = hash.filter(|hash| hash.key() != Reorder::None);
        Self { sort: hash, pool: Pool::default(), ..self }
    }

    /// As [`Method::closest`], and how long each stage took.
    ///
    /// # Errors
    /// [`Error::Cancelled`] when the context's flag was raised; `hits` is then of no use.
    pub fn closest_in_stages(
        &self,
        rays: &RayBatch,
        hits: &mut HitBatch,
        cx: &mut Context<'_>,
    ) -> Result<Stages, Error> {
        let Some((mut sorter, packets, begin)) = self.sorted(rays) else {
            return self.trace::<Closest>(rays.blocks(), self.packets(rays).runs(), hits.resize(rays.len()), cx);
        };
        let mut found = HitBatch::new();
        let to = found.resize(rays.len());
        let mut stages = self.trace::<Closest>(sorter.rays().blocks(), packets.runs(), to, cx)?;
        let end = Clock::now();
        sorter.put_hits_back(&found, hits);
        stages.sort += begin + end.elapsed();
        self.pool.give_back_sorter(sorter);
        Ok(stages)
    }

    /// As [`Method::any`], and how long each stage took.
    ///
    /// # Errors
    /// [`Error::Cancelled`] when the context's flag was raised; `occluded` is then of no use.
    pub fn any_in_stages(&self, rays: &RayBatch, occluded: &mut BitVec, cx: &mut Context<'_>) -> Result<Stages, Error> {
        let Some((mut sorter, packets, begin)) = self.sorted(rays) else {
            return self.trace::<Any>(rays.blocks(), self.packets(rays).runs(), occluded.resize(rays.len()), cx);
        };
        let mut found = BitVec::new();
        let to = found.resize(rays.len());
        let mut stages = self.trace::<Any>(sorter.rays().blocks(), packets.runs(), to, cx)?;
        let end = Clock::now();
        sorter.put_bits_back(&found, occluded);
        stages.sort += begin + end.elapsed();
        self.pool.give_back_sorter(sorter);
        Ok(stages)
    }

    /// What comes one after the other.
    fn packets(&self, rays: &RayBatch) -> Decomposition {
        Decomposition::regular(rays.blocks().len(), self.packet)
    }

    /// Sorts the rays if they shall be: with their packets, and how long it took.
    fn sorted(&self, rays: &RayBatch) -> Option<(RaySorter, Decomposition, Duration)> {
        let hash = self.sort.filter(|_| !rays.is_empty() && rays.origin().is_none())?;
        let begin = Clock::now();
        let mut sorter = self.pool.sorter().unwrap_or_else(|| RaySorter::new(self.level, hash));
        sorter.order(rays);
        sorter.gather(rays);
        let starts = sorter.cells().map(|(_, start)| start);
        let packets = Decomposition::of_cells(starts, rays.blocks().len(), self.packet);
        Some((sorter, packets, begin.elapsed()))
    }
}

impl Method for BreadthFirst<'_> {
    fn name(&self) -> &'static str {
        "breadth-first"
    }

    fn source(&self) -> &'static str {
        "Garanzha & Loop 2010, section 3"
    }

    fn memory(&self) -> usize {
        self.pool.bytes()
    }

    fn closest(&self, rays: &RayBatch, hits: &mut HitBatch, cx: &mut Context<'_>) -> Result<(), Error> {
        self.closest_in_stages(rays, hits, cx).map(|_| ())
    }

    fn any(&self, rays: &RayBatch, occluded: &mut BitVec, cx: &mut Context<'_>) -> Result<(), Error> {
        self.any_in_stages(rays, occluded, cx).map(|_| ())
    }
}
