//! Frusta around sorted packets, breadth first through the tree: Garanzha & Loop 2010.

mod boxes;
mod build;
mod children;
mod depth_first;
mod intersect;
mod leaves;
mod portion;
mod queue;
mod stages;
#[cfg(test)]
mod tests;

pub use stages::Stages;

use super::packet::found::{Any, Closest, Query};
use super::{BitVec, Context, Method};
use crate::Error;
use crate::bvh::{Bvh, OctoBvh};
use crate::geometry::frustum::Space;
use crate::geometry::{HitBatch, RayBatch};
use crate::lanes::Width;
use portion::Pool;
use simd::Level;

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
        Self { bvh, tree, space, level, width, packet: 16, queue: Self::QUEUE, visit: Visit::default(), pool: Pool::default() }
    }

    /// With packets of at most so many rays ("MaxSize"), in sixteens: by default 256.
    #[must_use]
    pub fn with_packet(self, rays: usize) -> Self {
        Self { packet: rays.clamp(16, 1 << 15).div_ceil(16), ..self }
    }

    /// With queues of so many elements for each thread, by default [`BreadthFirst::QUEUE`]. When they do not fit the batch of frusta is split in two, again and
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
        self.find::<Closest>(rays, hits.resize(rays.len()), cx)
    }

    /// As [`Method::any`], and how long each stage took.
    ///
    /// # Errors
    /// [`Error::Cancelled`] when the context's flag was raised; `occluded` is then of no use.
    pub fn any_in_stages(
        &self,
        rays: &RayBatch,
        occluded: &mut BitVec,
        cx: &mut Context<'_>,
    ) -> Result<Stages, Error> {
        self.find::<Any>(rays, occluded.resize(rays.len()), cx)
    }

    fn find<Q: Query>(
        &self,
        rays: &RayBatch,
        results: &mut [Q::Block],
        cx: &mut Context<'_>,
    ) -> Result<Stages, Error> {
        let blocks = rays.blocks();
        let mut bases: Vec<u32> = (0..blocks.len() as u32).step_by(self.packet).collect();
        bases.push(blocks.len() as u32);
        self.trace::<Q>(blocks, &bases, results, cx)
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
