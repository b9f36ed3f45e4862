//! Packets of any rays, put into new order on their way through the tree: Boulos, Wald and Benthin 2008.

mod adaptive;
mod group;
mod interval;
mod order;
mod rays;
mod speculative;
mod tally;
#[cfg(test)]
mod tests;

use super::{BitVec, Context, Method, PORTION, in_portions, packet};
use crate::Error;
use crate::bvh::Bvh;
use crate::geometry::{HitBatch, HitBlock, RayBatch, RayBlock};
use crate::lanes::Width;
use crate::stats::Counters;
use adaptive::{Adaptive, Options};
use group::{Tree, Waiting};
use order::Order;
use rays::Results;
use simd::{Float, Isa, Kernel, Level, Simd};
use speculative::Speculative;
use tally::{Off, On, Tally};

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
    /// Algorithm 1: a packet whose rays are moved into a new one when fewer than the threshold of them are active. As soon as the active ones fit one
    /// vector they go on as in [`Traversal::Simd`], above the threshold too.
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
    order: Order,
    /// The largest coordinate of all boxes.
    largest: f32,
}

impl<'a> Reordering<'a> {
    /// Over a tree, at a level, with vectors of `width` rays (of which [`Traversal::Single`] makes no use), and the paper's values of all
    /// else. At the emulated levels (serial and scalar) vectors have one lane whatever the width, but where work is counted: counters are those
    /// of the width at any level, times are not.
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
            order: Order::new(bvh),
            largest: bvh.nodes.first().map_or(0.0, |root| {
                root.planes()[..3].iter().chain(&root.planes()[4..7]).fold(0.0, |most, x| x.abs().max(most))
            }),
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
        "Boulos, Wald & Benthin 2008, section 4"
    }

    fn memory(&self) -> usize {
        self.order.bytes()
    }

    fn closest(&self, rays: &RayBatch, hits: &mut HitBatch, cx: &mut Context<'_>) -> Result<(), Error> {
        let depths = self.depths(cx);
        in_portions(self.portion(), rays, hits.resize(rays.len()), cx, |_, rays, hits| {
            hits.fill(HitBlock::MISS);
            self.trace(rays, Results::Closest(hits), depths.as_deref())
        })
    }

    fn any(&self, rays: &RayBatch, occluded: &mut BitVec, cx: &mut Context<'_>) -> Result<(), Error> {
        let depths = self.depths(cx);
        in_portions(self.portion(), rays, occluded.resize(rays.len()), cx, |_, rays, words| {
            words.fill(0);
            self.trace(rays, Results::Any(words), depths.as_deref())
        })
    }
}

impl Reordering<'_> {
    /// Sixteens in a portion: whole packets.
    fn portion(&self) -> usize {
        (4 * PORTION).next_multiple_of(self.packet / 16)
    }

    /// How deep nodes lie, if that is to be counted.
    fn depths(&self, cx: &Context<'_>) -> Option<Vec<u8>> {
        cx.counters.as_ref().map(|_| tally::depths(self.bvh))
    }

    fn trace(&self, rays: &[RayBlock], results: Results, depths: Option<&[u8]>) -> Counters {
        match self.traversal {
            Traversal::Single | Traversal::Simd => self.trace_by::<GROUPS>(rays, results, depths),
            Traversal::Packet => self.trace_by::<SPECULATIVE>(rays, results, depths),
            Traversal::Adaptive | Traversal::Exact => self.trace_by::<ADAPTIVE>(rays, results, depths),
        }
    }

    fn trace_by<const WAY: usize>(&self, rays: &[RayBlock], results: Results, depths: Option<&[u8]>) -> Counters {
        let width = if self.traversal == Traversal::Single { 1 } else { self.width.lanes(self.level) };
        if let Some(depths) = depths {
            // The work is the same at every level, but for boxes that roundings decide about.
            let tally = On { counters: Counters::default(), depths };
            let trace = Trace::<_, WAY> { method: self, rays, results, tally };
            match width {
                1 => plain(trace),
                4 => Level::run_native(Four(trace)),
                8 => Level::run_native(Eight(trace)),
                _ => Level::run_native(Sixteen(trace)),
            }
        } else {
            let trace = Trace::<_, WAY> { method: self, rays, results, tally: Off };
            match width {
                1 => plain(trace),
                4 => self.level.run(Four(trace)),
                8 => self.level.run(Eight(trace)),
                _ => self.level.run(Sixteen(trace)),
            }
        }
    }
}

/// [`Traversal::Single`] and [`Traversal::Simd`].
const GROUPS: usize = 0;
/// [`Traversal::Packet`].
const SPECULATIVE: usize = 1;
/// [`Traversal::Adaptive`] and [`Traversal::Exact`].
const ADAPTIVE: usize = 2;

/// A portion of rays through the tree.
struct Trace<'a, T, const WAY: usize> {
    method: &'a Reordering<'a>,
    rays: &'a [RayBlock],
    results: Results<'a>,
    tally: T,
}

// A kernel for each width and way: one of all would take the compiler several times as long.
struct Four<T>(T);
struct Eight<T>(T);
struct Sixteen<T>(T);

impl<T: Tally, const WAY: usize> Kernel for Four<Trace<'_, T, WAY>> {
    type Output = Counters;

    #[inline(always)]
    fn run<S: Simd>(self) -> Counters {
        if is_emulated::<S, T>() { plain(self.0) } else { self.0.run::<S::Float4, S::Float4>() }
    }
}

impl<T: Tally, const WAY: usize> Kernel for Eight<Trace<'_, T, WAY>> {
    type Output = Counters;

    #[inline(always)]
    fn run<S: Simd>(self) -> Counters {
        if is_emulated::<S, T>() { plain(self.0) } else { self.0.run::<S::Float8, S::Float8>() }
    }
}

impl<T: Tally, const WAY: usize> Kernel for Sixteen<Trace<'_, T, WAY>> {
    type Output = Counters;

    #[inline(always)]
    fn run<S: Simd>(self) -> Counters {
        if is_emulated::<S, T>() { plain(self.0) } else { self.0.run::<S::Float16, S::Float8>() }
    }
}

/// At emulated levels vectors of one lane do, unless their work is counted: others become many times as much code. The bits are the same.
const fn is_emulated<S: Simd, T: Tally>() -> bool {
    !T::ON && matches!(S::LEVEL.isa(), Isa::Serial | Isa::Scalar)
}

#[inline(never)]
fn plain<T: Tally, const WAY: usize>(trace: Trace<'_, T, WAY>) -> Counters {
    trace.run::<f32, f32>()
}

impl<T: Tally, const WAY: usize> Trace<'_, T, WAY> {
    /// With vectors of type `F`, and of type `G` for few rays.
    #[inline(always)]
    fn run<F: Float, G: Float>(mut self) -> Counters {
        let Self { method, rays, .. } = self;
        let (sixteens, tested_above) = (method.packet / 16, method.from * F::LANES);
        let Reordering { threshold, intervals, partition, .. } = *method;
        let options = Options { threshold, intervals, tested_above, partition };
        let mut adaptive = Adaptive::<F, G>::new();
        let (mut speculative, mut waiting) = (Speculative::new(), Waiting::<F>::new());
        for (i, blocks) in rays.chunks(sixteens).enumerate() {
            let packet = adaptive.packet(blocks.len());
            let mut growth = 0.0_f32;
            for (k, (block, to)) in blocks.iter().zip(&mut *packet).enumerate() {
                let number = i * sixteens + k;
                let loaded = to.set::<F>(block, method.largest, 16 * number as u32);
                growth = growth.max(loaded.growth);
                if loaded.odd != 0 {
                    odd(method.bvh, block, (number, loaded.odd), &mut self.results, &mut self.tally);
                }
            }
            let tree = Tree { bvh: method.bvh, order: &method.order, growth };
            let (results, tally) = (&mut self.results, &mut self.tally);
            if WAY == GROUPS {
                for sixteen in packet {
                    for chunk in 0..16 / F::LANES {
                        group::from_root(tree, sixteen, chunk, &mut waiting, results, tally);
                    }
                }
            } else if WAY == SPECULATIVE {
                speculative.traverse::<F, T>(tree, packet, tested_above, results, tally);
            } else {
                adaptive.traverse(tree, blocks.len(), &options, results, tally);
            }
        }
        self.tally.total()
    }
}

/// Rays that the cheap box test is not for, one by one: rare.
#[cold]
#[inline(never)]
fn odd<T: Tally>(bvh: &Bvh, block: &RayBlock, (number, odd): (usize, u16), results: &mut Results, tally: &mut T) {
    for lane in (0..16).filter(|lane| odd >> lane & 1 != 0) {
        tally.packet();
        let hit = packet::closest(bvh, &block.get(lane));
        if !hit.is_miss() {
            results.put((16 * number + lane) as u32, &hit);
        }
    }
}
