//! Packets whose rays are put into new order on their way: Algorithm 1.

use super::group::{self, Tree, Waiting};
use super::interval::Bounds;
use super::rays::{Found, Planes, Results, Rows, Sixteen, Sixteen8};
use super::tally::Tally;
use super::{Intervals, Partition};
use crate::geometry::Triangle;
use simd::{Float, Mask};

/// See [`Reordering`](super::Reordering).
#[derive(Debug, Clone, Copy)]
pub(super) struct Options {
    pub(super) threshold: f32,
    pub(super) intervals: Intervals,
    /// Interval tests are for packets of more rays than this.
    pub(super) tested_above: usize,
    pub(super) partition: Partition,
}

/// Rays that are together.
#[derive(Debug, Clone, Copy)]
struct Frame {
    /// Of its sixteens.
    start: usize,
    end: usize,
    /// None where interval tests are off.
    bounds: Option<Bounds>,
    /// Whether its rays are copies, from which hits are to be merged back.
    is_copy: bool,
    /// Whether something was found.
    is_new: bool,
}

/// A node that waits, for rays `first..=last` of a frame.
#[derive(Debug, Clone, Copy)]
struct Entry {
    node: u32,
    /// The node above; none above the root.
    parent: u32,
    frame: u16,
    first: u16,
    last: u16,
    /// Whether all rays may be found to hit at once: not once some were found not to.
    all_hit: bool,
}

/// A traversal with vectors of type `F`, for half of their lanes of type `G`, and memory that it keeps from packet to packet.
pub(super) struct Adaptive<F: Float, G: Float> {
    /// Sixteens of all frames, one behind the other.
    rays: Vec<Sixteen>,
    /// The packet's rays once more.
    rows: Rows,
    /// Where the hit of its first ray goes.
    first_id: u32,
    /// Those that come next into a new frame.
    next: Sixteen8,
    frames: Vec<Frame>,
    stack: Vec<Entry>,
    /// Which rays are active, of each sixteen of the frame.
    active: Vec<u16>,
    whole: Waiting<F>,
    half: Waiting<G>,
}

impl<F: Float, G: Float> Adaptive<F, G> {
    pub(super) fn new() -> Self {
        Self {
            rays: Vec::new(),
            rows: Rows::default(),
            first_id: 0,
            next: Sixteen8::NONE,
            frames: Vec::new(),
            stack: Vec::with_capacity(64),
            active: Vec::new(),
            whole: Waiting::new(),
            half: Waiting::new(),
        }
    }

    /// Where the packet's rays go, before [`Adaptive::traverse`]: the sixteens of one packet.
    #[inline(always)]
    pub(super) fn packet(&mut self, sixteens: usize) -> &mut [Sixteen] {
        if self.rays.len() < sixteens {
            self.grow(2 * sixteens);
        }
        self.active.resize(sixteens.max(self.active.len()), 0);
        &mut self.rays[..sixteens]
    }

    /// The whole packet, whose rays are in [`Adaptive::packet`].
    #[inline(always)]
    pub(super) fn traverse<T: Tally>(
        &mut self,
        tree: Tree,
        sixteens: usize,
        options: &Options,
        results: &mut Results,
        tally: &mut T,
    ) {
        if tree.bvh.nodes.is_empty() {
            return;
        }
        tally.packet();
        self.rows.resize(16 * sixteens);
        for (i, rays) in self.rays[..sixteens].iter().enumerate() {
            rays.write::<F>(&mut self.rows, 16 * i);
        }
        self.first_id = self.rays[0].id.0[0];
        let last = 16 * sixteens - 1;
        let bounds = Bounds::of_many::<F>(&self.rays[..sixteens], None, last + 1 > options.tested_above);
        self.frames.clear();
        self.frames.push(Frame { start: 0, end: sixteens, bounds, is_copy: false, is_new: false });
        self.stack.push(Entry { node: 0, parent: u32::MAX, frame: 0, first: 0, last: last as u16, all_hit: true });
        while let Some(entry) = self.stack.pop() {
            while self.frames.len() > usize::from(entry.frame) + 1 {
                self.end_frame();
            }
            self.visit(tree, entry, options, results, tally);
        }
        self.frames.truncate(1);
    }

    #[inline(always)]
    fn visit<T: Tally>(
        &mut self,
        tree: Tree,
        mut entry: Entry,
        options: &Options,
        results: &mut Results,
        tally: &mut T,
    ) {
        tally.visit();
        let at = entry.node as usize;
        let node = &tree.bvh.nodes[at];
        let frame = self.frames[usize::from(entry.frame)];
        if let Some(bounds) = &frame.bounds {
            let rays = u32::from(entry.last - entry.first) + 1;
            if entry.all_hit {
                let all = bounds.all_hit(node.planes());
                tally.intervals(at, all.then_some(rays));
                if all {
                    self.activate_all(entry);
                    return self.go_on(tree, entry, results, tally);
                }
            }
            let none = bounds.all_miss(node.planes(), tree.growth);
            tally.intervals(at, none.then_some(rays));
            if none {
                return;
            }
        }
        let Some((active, first, last)) = self.sweep(tree, entry, tally) else { return };
        (entry.first, entry.last) = (first as u16, last as u16);
        let rays = last - first + 1;
        let is_low = (active as f32) < options.threshold * rays as f32;
        let in_place = first / F::LANES == last / F::LANES;
        if in_place || active <= F::LANES {
            // One ray remains, or a group: where it lies, or copied together.
            let place = if in_place {
                let (word, chunk) = (u32::from(self.active[first / 16]), first % 16 / F::LANES);
                (frame.start + first / 16, chunk, word >> (chunk * F::LANES) & lowest(F::LANES))
            } else {
                tally.reordered(active as u32);
                (self.copy(entry, active), 0, lowest(active))
            };
            if self.group(tree, at, place, results, tally) {
                self.frames[usize::from(entry.frame)].is_new = true;
                if !in_place {
                    merge(&mut self.rays, frame.start, place.0, place.0 + 1);
                }
            }
        } else if !is_low {
            entry.all_hit = false;
            self.go_on(tree, entry, results, tally);
        } else {
            tally.reordered(active as u32);
            let is_copy = options.partition == Partition::Copy;
            let (start, end) = if is_copy {
                let start = self.copy(entry, active);
                entry.first = 0;
                (start, start + active.div_ceil(16))
            } else {
                self.move_to_front(entry);
                (frame.start, frame.end)
            };
            entry.last = entry.first + active as u16 - 1;
            entry.frame = self.frames.len() as u16;
            entry.all_hit = true;
            let planes = Planes::new(node.planes(), tree.growth);
            let into = if options.intervals == Intervals::Tight { Some(&planes) } else { None };
            let rays = start + usize::from(entry.first) / 16..start + usize::from(entry.last) / 16 + 1;
            let bounds = Bounds::of_many::<F>(&self.rays[rays], into, active > options.tested_above);
            self.frames.push(Frame { start, end, bounds, is_copy, is_new: false });
            self.activate_all(entry);
            self.go_on(tree, entry, results, tally);
        }
    }

    /// Rays that are few enough for one vector: sixteen, chunk and bits; whether something was found.
    #[inline(always)]
    fn group<T: Tally>(
        &mut self,
        tree: Tree,
        at: usize,
        (sixteen, chunk, bits): (usize, usize, u32),
        results: &mut Results,
        tally: &mut T,
    ) -> bool {
        let rays = &mut self.rays[sixteen];
        if G::LANES < F::LANES {
            // Where they are in one half of it, half a vector will do.
            let (low, high) = (bits & lowest(G::LANES), bits >> G::LANES);
            if low == 0 || high == 0 {
                let chunk = F::LANES / G::LANES * chunk + usize::from(low == 0);
                return group::traverse(tree, rays, chunk, (at, low | high), &mut self.half, results, tally);
            }
        }
        group::traverse(tree, rays, chunk, (at, bits), &mut self.whole, results, tally)
    }

    /// The children of a node that the rays meet, or its triangles.
    #[inline(always)]
    fn go_on<T: Tally>(&mut self, tree: Tree, entry: Entry, results: &mut Results, tally: &mut T) {
        let (at, frame) = (entry.node as usize, usize::from(entry.frame));
        let start = self.frames[frame].start;
        let (nodes, node) = (&tree.bvh.nodes[..], &tree.bvh.nodes[at]);
        let (first, number) = node.triangles();
        if number > 0 {
            tally.primitives(number);
            let triangles = &tree.bvh.triangles[first as usize..(first + number) as usize];
            self.frames[frame].is_new |= self.leaf(triangles, start, entry, results, tally);
        } else if let Some(children) = tree.order.of(at) {
            let ray = usize::from(entry.first);
            let is_negative = self.rays[start + ray / 16].is_negative(ray % 16, children.axis);
            let (near, far) = children.near_and_far(at, is_negative);
            self.stack.push(Entry { node: far as u32, parent: entry.node, ..entry });
            self.stack.push(Entry { node: near as u32, parent: entry.node, ..entry });
        } else {
            // Where a builder made more children they come last stored first.
            let mut child = entry.node + 1;
            while child < node.skip() {
                self.stack.push(Entry { node: child, parent: entry.node, ..entry });
                child = nodes[child as usize].skip();
            }
        }
    }

    /// Active rays against triangles; whether something was found.
    #[inline(always)]
    fn leaf<T: Tally>(
        &mut self,
        triangles: &[Triangle],
        start: usize,
        entry: Entry,
        results: &mut Results,
        tally: &mut T,
    ) -> bool {
        let (any, mut is_new) = (results.is_any(), false);
        for i in usize::from(entry.first) / 16..=usize::from(entry.last) / 16 {
            let (active, rays) = (u32::from(self.active[i]), &mut self.rays[start + i]);
            for chunk in 0..16 / F::LANES {
                let bits = active >> (chunk * F::LANES) & lowest(F::LANES);
                if bits == 0 {
                    continue;
                }
                let mut found = Found::<F>::load(rays, chunk);
                found.leaf(triangles, &rays.packet(chunk), bits, any, tally);
                is_new |= found.store(rays, chunk, results);
            }
        }
        is_new
    }

    /// Finds out which rays meet the node's box: their number, the first and the last, if there are any.
    #[inline(always)]
    fn sweep<T: Tally>(&mut self, tree: Tree, entry: Entry, tally: &mut T) -> Option<(usize, usize, usize)> {
        let nodes = &tree.bvh.nodes[..];
        let start = self.frames[usize::from(entry.frame)].start;
        let (first, last) = (usize::from(entry.first), usize::from(entry.last));
        let planes = Planes::<F>::new(nodes[entry.node as usize].planes(), tree.growth);
        let (mut active, mut from, mut to) = (0, usize::MAX, 0);
        for i in first / 16..=last / 16 {
            let (rays, mut word) = (&self.rays[start + i], 0);
            for chunk in 0..16 / F::LANES {
                let (t_near, t_far) = rays.interval(chunk, &planes);
                word |= t_near.le(t_far).bitmask() << (chunk * F::LANES);
            }
            let word = word & within(i, first, last);
            self.active[i] = word as u16;
            if word != 0 {
                active += word.count_ones() as usize;
                from = from.min(16 * i + word.trailing_zeros() as usize);
                to = 16 * i + 31 - word.leading_zeros() as usize;
            }
        }
        if T::ON {
            let above = nodes.get(entry.parent as usize).map(|node| Planes::<F>::new(node.planes(), tree.growth));
            let rays = (first / 16..=last / 16).map(|i| {
                let met = met(&self.rays[start + i], above.as_ref()) & within(i, first, last);
                met.count_ones()
            });
            let tests = last / F::LANES - first / F::LANES + 1;
            tally.boxes(entry.node as usize, tests as u32, rays.sum());
        }
        (active > 0).then_some((active, from, to))
    }

    /// As if all had met the box.
    #[inline(always)]
    fn activate_all(&mut self, entry: Entry) {
        let (first, last) = (usize::from(entry.first), usize::from(entry.last));
        for i in first / 16..=last / 16 {
            self.active[i] = within(i, first, last) as u16;
        }
    }

    /// Copies the active rays behind all frames; where.
    #[inline(always)]
    fn copy(&mut self, entry: Entry, active: usize) -> usize {
        let start = self.frames[usize::from(entry.frame)].start;
        let to = self.frames.last().map_or(0, |frame| frame.end);
        let sixteens = active.div_ceil(16);
        if self.rays.len() < to + sixteens {
            self.grow(to + sixteens);
        }
        let first_id = self.first_id as usize;
        let (before, behind) = self.rays.split_at_mut(to);
        let mut n = 0;
        for i in usize::from(entry.first) / 16..=usize::from(entry.last) / 16 {
            let (from, mut bits) = (&before[start + i], self.active[i]);
            while bits != 0 {
                let lane = bits.trailing_zeros() as usize;
                bits &= bits - 1;
                from.copy_state(lane, &mut behind[n / 16], n % 16, (16 * i + lane) as u32);
                self.next.set(n % 16, &self.rows, from.id.0[lane] as usize - first_id);
                n += 1;
                if n % 16 == 0 {
                    behind[n / 16 - 1].read::<F>(&self.next, 16);
                }
            }
        }
        if n % 16 != 0 {
            behind[n / 16].read::<F>(&self.next, n % 16);
        }
        to
    }

    #[cold]
    #[inline(never)]
    fn grow(&mut self, sixteens: usize) {
        self.rays.resize(sixteens.next_power_of_two(), Sixteen::NONE);
    }

    /// Swaps active rays with those before them that are not.
    #[inline(always)]
    fn move_to_front(&mut self, entry: Entry) {
        let start = self.frames[usize::from(entry.frame)].start;
        let mut n = usize::from(entry.first);
        for i in usize::from(entry.first)..=usize::from(entry.last) {
            if self.active[i / 16] >> (i % 16) & 1 != 0 {
                if i != n {
                    let (a, b) = (start + n / 16, start + i / 16);
                    if a == b {
                        self.rays[a].swap(n % 16, i % 16);
                    } else {
                        let (before, behind) = self.rays.split_at_mut(b);
                        before[a].swap_with(n % 16, &mut behind[0], i % 16);
                    }
                }
                n += 1;
            }
        }
    }

    /// Ends the last frame.
    #[inline(always)]
    fn end_frame(&mut self) {
        let Some(frame) = self.frames.pop() else { return };
        let Some(above) = self.frames.last_mut() else { return };
        if frame.is_new {
            above.is_new = true;
            if frame.is_copy {
                merge(&mut self.rays, above.start, frame.start, frame.end);
            }
        }
    }
}

/// Hits of copied rays, back to where they were copied from.
#[inline(always)]
fn merge(rays: &mut [Sixteen], start: usize, copied: usize, end: usize) {
    let (before, behind) = rays.split_at_mut(copied);
    for sixteen in &behind[..end - copied] {
        for lane in 0..16 {
            if sixteen.t_min.0[lane] < f32::INFINITY {
                let from = sixteen.from.0[lane] as usize;
                let to = &mut before[start + from / 16];
                to.reach.0[from % 16] = sixteen.reach.0[lane];
                to.primitive.0[from % 16] = sixteen.primitive.0[lane];
            }
        }
    }
}

/// Rays that meet a box, or all where there is none.
#[inline(always)]
fn met<F: Float>(rays: &Sixteen, planes: Option<&Planes<F>>) -> u32 {
    let mut word = 0;
    for chunk in 0..16 / F::LANES {
        let meets = match planes {
            Some(planes) => {
                let (t_near, t_far) = rays.interval(chunk, planes);
                t_near.le(t_far)
            }
            None => F::load_block(&rays.t_min, chunk).le(F::load_block(&rays.reach, chunk)),
        };
        word |= meets.bitmask() << (chunk * F::LANES);
    }
    word
}

/// The lowest `n` bits, at most 16.
#[inline(always)]
fn lowest(n: usize) -> u32 {
    (1 << n) - 1
}

/// Rays `first..=last`, as bits of sixteen number `i`.
#[inline(always)]
fn within(i: usize, first: usize, last: usize) -> u32 {
    let from = if i == first / 16 { lowest(first % 16) } else { 0 };
    let to = if i == last / 16 { lowest(last % 16 + 1) } else { lowest(16) };
    to & !from
}
