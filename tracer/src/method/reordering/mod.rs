//! Packets of any rays, put into new order on their way through the tree: Boulos, Wald and Benthin 2008.

use super::{BitVec, Context, Method, Packet};
use crate::Error;
use crate::bvh::Bvh;
use crate::geometry::{HitBatch, RayBatch};
use crate::lanes::Width;
use simd::Level;

/// How rays go through the tree. All find the same hits, on the same tree and by the same rule which child comes first (Wald, Boulos and
/// Shirley 2007): the one that the first active ray reaches first along the axis on which the children lie farthest apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Traversal {
    /// Each ray alone.
    Single,
    /// As many rays together as a vector has lanes, as long as one of them meets the box.
    Simd,
    /// A packet together (Wald, Boulos and Shirley 2007): it goes on where its first active ray does, else an interval test tells whether all miss,
    /// else each ray is asked. In a leaf each is (section 3.1).
    Packet,
    /// Algorithm 1: a packet whose rays are moved into a new one when fewer than the threshold of them are active.
    #[default]
    Adaptive,
    /// The same at every box that some rays miss (section 3.4).
    Exact,
}

/// What interval tests know of a packet (section 4.4).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Intervals {
    /// Its rays from where they enter the box to where they leave it.
    #[default]
    Tight,
    /// Its rays as they were given.
    Loose,
}

/// How rays are moved into a new order (section 4.2).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Partition {
    /// Into a new packet, from which hits are merged back.
    #[default]
    Copy,
    /// Within their packet, the active ones to the front.
    InPlace,
}

/// Ray packets that are reordered on their way (Boulos, Wald and Benthin 2008), and what the paper compares them with.
///
/// ```
/// use simd::Level;
/// use tracer::bvh::{BuildConfig, Bvh};
/// use tracer::geometry::{HitBatch, Ray, RayBatch};
/// use tracer::method::{Context, Method, Reordering, Traversal, Width};
/// use tracer::{model::Model, progress::Silent};
///
/// # fn main() -> Result<(), tracer::Error> {
/// let (model, _warnings) = Model::open("balls:1", &Silent)?;
/// let bvh = Bvh::build(&model.mesh, &BuildConfig::default(), &Silent)?;
/// let rays: RayBatch = (0..100).map(|i| Ray::new([0.01 * i as f32, 0.0, 5.0], [0.0, 0.0, -1.0])).collect();
/// let mut hits = HitBatch::new();
/// let method = Reordering::new(&bvh, Level::best(), Width::Auto, Traversal::Adaptive);
/// method.closest(&rays, &mut hits, &mut Context::default())?;
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct Reordering<'a> {
    bvh: &'a Bvh,
    level: Level,
    width: Width,
    traversal: Traversal,
    packet: usize,
    threshold: f32,
    intervals: Intervals,
    from: usize,
    partition: Partition,
}

impl<'a> Reordering<'a> {
    /// Over a tree, at a level, with vectors of `width` rays (of which [`Traversal::Single`] makes no use), and the paper's values of all
    /// else.
    #[must_use]
    pub fn new(bvh: &'a Bvh, level: Level, width: Width, traversal: Traversal) -> Self {
        Self {
            bvh,
            level,
            width,
            traversal,
            packet: if traversal == Traversal::Packet { 64 } else { 256 },
            threshold: if traversal == Traversal::Exact { 1.0 } else { 0.5 },
            intervals: Intervals::default(),
            from: 2,
            partition: Partition::default(),
        }
    }

    /// With packets of at most so many rays, in sixteens: by default 64 for [`Traversal::Packet`] and 256 for those that reorder.
    #[must_use]
    pub fn with_packet(self, rays: usize) -> Self {
        Self { packet: rays.clamp(16, 1 << 15).next_multiple_of(16), ..self }
    }

    /// Reordering when less than this part of the rays from the first active to the last is active: by default 0.5; 1 for
    /// [`Traversal::Exact`].
    #[must_use]
    pub fn with_threshold(self, threshold: f32) -> Self {
        Self { threshold, ..self }
    }

    /// With these intervals.
    #[must_use]
    pub fn with_intervals(self, intervals: Intervals) -> Self {
        Self { intervals, ..self }
    }

    /// With interval tests of packets of more than `k` times the width in rays: by default 2 (the paper has "a small multiple").
    #[must_use]
    pub fn with_interval_tests_from(self, k: usize) -> Self {
        Self { from: k, ..self }
    }

    /// With this way to move rays.
    #[must_use]
    pub fn with_partition(self, partition: Partition) -> Self {
        Self { partition, ..self }
    }
}

impl Method for Reordering<'_> {
    fn name(&self) -> &'static str {
        match self.traversal {
            Traversal::Single => "boulos-single",
            Traversal::Simd => "boulos-simd",
            Traversal::Packet => "boulos-packet",
            Traversal::Adaptive => "boulos-adaptive",
            Traversal::Exact => "boulos-exact",
        }
    }

    fn source(&self) -> &'static str {
        "Boulos, Wald & Benthin 2008"
    }

    fn memory(&self) -> usize {
        0
    }

    fn closest(&self, rays: &RayBatch, hits: &mut HitBatch, cx: &mut Context<'_>) -> Result<(), Error> {
        Packet::new(self.bvh, self.level, self.width).closest(rays, hits, cx)
    }

    fn any(&self, rays: &RayBatch, occluded: &mut BitVec, cx: &mut Context<'_>) -> Result<(), Error> {
        Packet::new(self.bvh, self.level, self.width).any(rays, occluded, cx)
    }
}
