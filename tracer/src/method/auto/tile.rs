//! Up to 256 rays through a wide tree: together as long as they agree, then sixteen at a time, then each alone.

use super::Limits;
use super::bounds::Bounds;
use super::node::{child_size, meet, near_to, planes, size};
use crate::bvh::{Child, WideBvh};
use crate::geometry::cull::{Boxes, Cull};
use crate::geometry::moller_trumbore;
use crate::geometry::slab::{Near, PerRay};
use crate::geometry::{Packet, RayBlock, Triangle, Vec3};
use crate::method::query::Query;
use crate::method::ready::Ready;
use crate::method::walk::{Arity, Walk, entry};
use crate::stats::Count;
use simd::{Block, Float, Mask, Simd, Vector};
use std::hint::black_box;

/// Blocks of sixteen rays in a tile.
pub(super) const BLOCKS: usize = 16;

/// Children of a node.
pub(super) const N: usize = 8;

/// Up to 256 rays, what was found for them, and room to work.
pub(super) struct Tile<Q: Query> {
    pub(super) rays: [Ready; BLOCKS],
    pub(super) found: [Q::Block; BLOCKS],
    /// Starts of the intervals, infinite for rays that are not traced now.
    from: [Block<f32>; BLOCKS],
    bounds: Bounds,
    /// See [`Cull::new`].
    pub(super) largest: f32,
    limits: Limits,
    /// Whether it is known that rays start at one point.
    one_origin: bool,
    stack: Vec<Entry>,
    single_stack: Vec<u64>,
}

/// A child to visit, and who wants to.
#[derive(Debug, Clone, Copy, Default)]
struct Entry {
    /// Distance and child: see [`entry`].
    key: u64,
    /// A bit for each block, or for each ray of a block.
    active: u16,
}

impl<Q: Query> Tile<Q> {
    /// Without rays.
    pub(super) fn new(bvh: &WideBvh<N>, limits: Limits, one_origin: bool) -> Self {
        let depth = bvh.depth;
        Self {
            rays: [const { Ready::NONE }; BLOCKS],
            found: [Q::NOTHING; BLOCKS],
            from: [Block([0.0; 16]); BLOCKS],
            bounds: Bounds::NONE,
            largest: bvh.largest_coordinate(),
            limits,
            one_origin,
            // Each node on the way leaves all but one of its children; a block starts where the tile is.
            stack: vec![Entry::default(); 2 * depth * N + 1],
            single_stack: vec![0; depth * N],
        }
    }

    /// Sixteen rays.
    #[inline(always)]
    pub(super) fn set<F: Float>(&mut self, block: usize, rays: &RayBlock) {
        self.rays[block].set::<F>(rays, self.largest);
    }

    /// Finds the hits of all rays.
    #[inline(always)]
    pub(super) fn trace<S: Simd, C: Count>(&mut self, bvh: &WideBvh<N>, count: &mut C) {
        let mut octants = [None; BLOCKS];
        let mut blocks = 0_u16;
        for (block, (rays, octant)) in self.rays.iter_mut().zip(&mut octants).enumerate() {
            self.found[block] = Q::NOTHING;
            let mut odd = rays.odd;
            rays.valid &= !odd;
            while odd != 0 {
                let lane = odd.trailing_zeros() as usize % 16;
                odd &= odd - 1;
                count.packet();
                let (found, stack) = (&mut self.found[block], &mut self.single_stack);
                Walk::new(bvh, rays, lane).run_odd::<Q, C>(stack, found, count);
                // Done: it meets no box of the others' test, whatever that computes of it.
                rays.reach.0[lane] = f32::NEG_INFINITY;
            }
            if rays.valid != 0 {
                blocks |= 1 << block;
                *octant = rays.common_octant::<S::Float16>();
            }
        }
        if bvh.nodes.is_empty() || blocks == 0 {
            return;
        }
        // For shadow rays over small triangles a tile was measured to lose: up to six times.
        let size = size(&bvh.nodes[0]);
        let agreed = if Q::CLOSEST { self.agree::<S::Float16>(blocks, &octants, size) } else { None };
        if let Some((octant, spread)) = agreed {
            for block in 0..BLOCKS {
                self.begin::<S::Float16>(block);
            }
            self.bounds.set_all::<S::Float16>(&self.rays, blocks);
            count.packet();
            self.tile::<S, C>(bvh, Near::of_octant(octant), blocks, spread, count);
            return;
        }
        while blocks != 0 {
            let block = blocks.trailing_zeros() as usize % BLOCKS;
            blocks &= blocks - 1;
            count.packet();
            self.begin::<S::Float16>(block);
            let rays = &self.rays[block];
            match octants[block] {
                Some(octant)
                    if rays.are_within::<S::Float16>(self.limits.coherent)
                        && (!Q::CLOSEST || rays.scatter::<S::Float16>() <= self.limits.apart * size) =>
                {
                    self.bounds.set::<S::Float16>(block, rays);
                    self.block::<S, C>(bvh, Near::of_octant(octant), Child::node(0), block, 0, count);
                }
                _ if rays.scatter::<S::Float16>() <= self.limits.scatter * size => {
                    self.mixed::<S, C>(bvh, block, count)
                }
                _ => self.singles::<S, C>(bvh, Child::node(0), block, rays.valid, count),
            }
        }
    }

    /// Whether it pays to trace these blocks together: their directions differ little, all point into this octant, and the rays of a block start near
    /// each other (the box around parallel rays from anywhere meets every box: a hundred times the work). With the octant, how far apart rays of one
    /// block start at most, as a sum of sides.
    #[inline(always)]
    fn agree<F: Float>(&self, blocks: u16, octants: &[Option<usize>; BLOCKS], size: f32) -> Option<(usize, f32)> {
        let reference = blocks.trailing_zeros() as usize % BLOCKS;
        let (rays, octant) = (&self.rays[reference], octants[reference]?);
        let lane = rays.valid.trailing_zeros() as usize % 16;
        let (mut spread, mut rest) = (0.0, blocks);
        while rest != 0 {
            let block = rest.trailing_zeros() as usize % BLOCKS;
            rest &= rest - 1;
            let other = &self.rays[block];
            let (first, last) =
                (other.valid.trailing_zeros() as usize % 16, 15 - other.valid.leading_zeros() as usize % 16);
            let scatter = if self.one_origin { 0.0 } else { other.scatter::<F>() };
            let same = octants[block] == Some(octant)
                && rays.cosine_to(lane, other, first) >= self.limits.together
                && rays.cosine_to(lane, other, last) >= self.limits.together
                && scatter <= self.limits.scatter * size;
            if !same {
                return None;
            }
            spread = if scatter > spread { scatter } else { spread };
        }
        (blocks.count_ones() > self.limits.blocks).then_some((octant, spread))
    }

    /// All rays of the block are traced now.
    #[inline(always)]
    fn begin<F: Float>(&mut self, block: usize) {
        let rays = &self.rays[block];
        let on = F::Mask::from_bitmask(u32::from(rays.valid));
        F::select(on, F::load_block(&rays.t_min, 0), F::splat(f32::INFINITY)).store_block(&mut self.from[block], 0);
        self.bounds.reach.0[block] = F::load_block(&rays.reach, 0).reduce_max();
    }

    /// All blocks of the mask from the root on; the origins of a block differ by `spread` at most.
    #[inline(always)]
    fn tile<S: Simd, C: Count>(&mut self, bvh: &WideBvh<N>, octant: Near, blocks: u16, spread: f32, count: &mut C) {
        let upper = octant.upper();
        let all = self.bounds.of_all::<S::Float8>(blocks, octant);
        let each = self.bounds.per_block::<S::Float16>(octant);
        let mut free = 0;
        let (mut child, mut active) = (Child::node(0), blocks);
        loop {
            if child.is_leaf() {
                self.leaf::<S::Float16, C>(bvh, octant, child, active, count);
            } else if active.count_ones() <= self.limits.blocks {
                let mut rest = active;
                while rest != 0 {
                    let block = rest.trailing_zeros() as usize % BLOCKS;
                    rest &= rest - 1;
                    self.block::<S, C>(bvh, octant, child, block, free, count);
                }
            } else {
                let Some(node) = bvh.nodes.get(child.index()) else { break };
                count.box_test();
                let reach = S::Float16::load_block(&self.bounds.reach, 0);
                let (t_near, mask) = meet(node, upper, &all, reach.reduce_max());
                assert!(free + N <= self.stack.len(), "the stack has room for the children of every node on the way");
                let (bottom, t_near, mut rest) = (free, t_near.to_block(), mask.bitmask());
                while rest != 0 {
                    let i = rest.trailing_zeros() as usize % N;
                    rest &= rest - 1;
                    let (near, far) = planes(node, upper, i);
                    let (from, to) = each.between(near, far, reach);
                    let mut active = active & from.le(to).bitmask() as u16;
                    // Triangles cost more than a box: who comes to a leaf has to meet it. And the box around a block's origins meets
                    // all smaller boxes near its rays, down to the leaves: up to five times the work.
                    if node.children[i].is_leaf() || child_size(node, i) < spread {
                        active = self.meeting::<S::Float16>(active, near, far);
                    }
                    if active != 0 {
                        push::<Q>(bvh, &mut self.stack, bottom, &mut free, t_near.0[i], node.children[i], active);
                    }
                }
            }
            loop {
                if free == 0 {
                    return;
                }
                free -= 1;
                let Entry { key, active: wanted } = self.stack[free];
                child = Child::from_bits(key as u32);
                let t_near = S::Float16::splat(Q::distance(key));
                active = wanted & t_near.le(S::Float16::load_block(&self.bounds.reach, 0)).bitmask() as u16;
                if active != 0 {
                    break;
                }
            }
        }
    }

    /// Those of the blocks with a ray that meets the box.
    #[inline(always)]
    fn meeting<F: Float>(&self, blocks: u16, near: Vec3<F>, far: Vec3<F>) -> u16 {
        let (mut meeting, mut rest) = (0, blocks);
        while rest != 0 {
            let block = rest.trailing_zeros() as usize % BLOCKS;
            rest &= rest - 1;
            let rays = &self.rays[block];
            let boxes = Cull::<F>::load(&rays.cull, 0);
            let start = F::load_block(&self.from[block], 0);
            let (from, to) = boxes.interval(near, far, start, F::load_block(&rays.reach, 0));
            meeting |= u16::from(from.le(to).any()) << block;
        }
        meeting
    }

    /// The rays of one block from `child` on, all into one octant; the stack is free from `bottom` on.
    #[inline(always)]
    fn block<S: Simd, C: Count>(
        &mut self,
        bvh: &WideBvh<N>,
        octant: Near,
        mut child: Child,
        block: usize,
        bottom: usize,
        count: &mut C,
    ) {
        let upper = octant.upper();
        let all = self.bounds.of_block::<S::Float8>(block, octant);
        let mut free = bottom;
        let mut active = u16::MAX;
        loop {
            if child.is_leaf() {
                self.block_leaf::<S, C>(bvh, octant, child, block, count);
            } else if active.count_ones() <= self.limits.rays {
                self.singles::<S, C>(bvh, child, block, active, count);
            } else {
                let Some(node) = bvh.nodes.get(child.index()) else { break };
                count.box_test();
                let (t_near, mask) = meet(node, upper, &all, self.bounds.reach.0[block]);
                // As in `mixed`.
                let rays = &self.rays[black_box(block) % BLOCKS];
                let boxes = Cull::<S::Float16>::load(&rays.cull, 0);
                let (start, reach) =
                    (S::Float16::load_block(&self.from[block], 0), S::Float16::load_block(&rays.reach, 0));
                assert!(free + N <= self.stack.len(), "the stack has room for the children of every node on the way");
                let (at, t_near, mut rest) = (free, t_near.to_block(), mask.bitmask());
                while rest != 0 {
                    let i = rest.trailing_zeros() as usize % N;
                    rest &= rest - 1;
                    let (near, far) = planes::<S::Float16>(node, upper, i);
                    let (from, to) = boxes.interval(near, far, start, reach);
                    let active = from.le(to).bitmask() as u16;
                    if active != 0 {
                        push::<Q>(bvh, &mut self.stack, at, &mut free, t_near.0[i], node.children[i], active);
                    }
                }
            }
            loop {
                if free == bottom {
                    return;
                }
                free -= 1;
                let entry = self.stack[free];
                (child, active) = (Child::from_bits(entry.key as u32), entry.active & Q::open(&self.found[block]));
                if active != 0 && Q::distance(entry.key) <= self.bounds.reach.0[block] {
                    break;
                }
            }
        }
    }

    /// Rays of one block that point anywhere, from the root on.
    #[inline(always)]
    fn mixed<S: Simd, C: Count>(&mut self, bvh: &WideBvh<N>, block: usize, count: &mut C) {
        let ray = self.rays[block].packet::<S::Float16>(&self.from[block]);
        let limit = if Q::CLOSEST { self.limits.mixed_closest } else { self.limits.mixed_any };
        let infinity = S::Float16::splat(f32::INFINITY);
        // Rays that ask for any hit are often short.
        let extent = if Q::CLOSEST { [[0.0; 2]; 3] } else { self.rays[block].extent::<S::Float16>() };
        let mut free = 0;
        let (mut child, mut active) = (Child::node(0), self.rays[block].valid);
        loop {
            if active.count_ones() <= limit {
                self.singles::<S, C>(bvh, child, block, active, count);
            } else if child.is_leaf() {
                self.mixed_leaf::<S::Float16, C>(bvh, child, block, &ray, count);
            } else {
                let Some(node) = bvh.nodes.get(child.index()) else { break };
                count.box_test();
                assert!(free + N <= self.stack.len(), "the stack has room for the children of every node on the way");
                // Loaded anew for each node, from where the compiler cannot know: kept in between, all of it would be spilled by the
                // loops for single rays and read again for each child.
                let rays = &self.rays[black_box(block) % BLOCKS];
                let boxes = Cull::<S::Float16>::load(&rays.cull, 0).mixed();
                let (start, reach) = (
                    S::Float16::load_block(&self.from[black_box(block) % BLOCKS], 0),
                    S::Float16::load_block(&rays.reach, 0),
                );
                let bottom = free;
                let reachable = if Q::CLOSEST { 0 } else { near_to::<S::Float8>(node, black_box(&extent)) };
                for i in 0..N {
                    if node.children[i] == Child::NONE {
                        break;
                    }
                    if !Q::CLOSEST && reachable >> i & 1 == 0 {
                        continue;
                    }
                    let (low, high) = planes(node, [0; 3], i);
                    let (t_near, t_far) = boxes.interval(low, high, start, reach);
                    let meets = t_near.le(t_far);
                    if meets.any() {
                        let nearest =
                            if Q::CLOSEST { S::Float16::select(meets, t_near, infinity).reduce_min() } else { 0.0 };
                        let active = meets.bitmask() as u16;
                        push::<Q>(bvh, &mut self.stack, bottom, &mut free, nearest, node.children[i], active);
                    }
                }
            }
            loop {
                if free == 0 {
                    return;
                }
                free -= 1;
                let entry = self.stack[free];
                (child, active) = (Child::from_bits(entry.key as u32), entry.active & Q::open(&self.found[block]));
                if active != 0 && Q::distance(entry.key) <= self.bounds.reach.0[block] {
                    break;
                }
            }
        }
    }

    #[inline(always)]
    fn mixed_leaf<F: Float, C: Count>(
        &mut self,
        bvh: &WideBvh<N>,
        leaf: Child,
        block: usize,
        ray: &Packet<F>,
        count: &mut C,
    ) {
        let mut any = false;
        let (first, end) = leaf.groups();
        for group in &bvh.groups[first..end] {
            for lane in 0..group.id.len() {
                let Some(triangle) = group.triangle(lane) else { break };
                count.triangle_test();
                let rays = &mut self.rays[block];
                let ray = Packet { t_max: F::load_block(&rays.reach, 0), ..*ray };
                if let Some(hit) = moller_trumbore::intersect_mixed(&triangle, &ray) {
                    count.triangle_hit();
                    Q::accept(&mut self.found[block], &mut rays.reach, 0, triangle.id, hit);
                    any = true;
                }
            }
        }
        if any {
            self.update_reach::<F>(block);
        }
    }

    /// Some rays of a block, each alone, from `child` on.
    #[inline(always)]
    fn singles<S: Simd, C: Count>(
        &mut self,
        bvh: &WideBvh<N>,
        child: Child,
        block: usize,
        mut rest: u16,
        count: &mut C,
    ) {
        let rays = &mut self.rays[block];
        while rest != 0 {
            let lane = rest.trailing_zeros() as usize % 16;
            rest &= rest - 1;
            let (found, stack) = (&mut self.found[block], &mut self.single_stack);
            let walk = Walk::new(bvh, rays, lane);
            if child.is_leaf() {
                rays.reach.0[lane] = walk.leaf_only::<S, Q, C>(child, found, count);
                continue;
            }
            rays.reach.0[lane] = walk.run::<Arity<N>, S, Q, C>(child, stack, found, count);
        }
        if Q::CLOSEST {
            self.update_reach::<S::Float16>(block);
        }
    }

    /// The triangles of a leaf whose boxes any ray of one block may meet, for that block.
    #[inline(always)]
    fn block_leaf<S: Simd, C: Count>(
        &mut self,
        bvh: &WideBvh<N>,
        near: Near,
        leaf: Child,
        block: usize,
        count: &mut C,
    ) {
        let mut hits = 0;
        // As in `mixed`.
        let block = black_box(block) % BLOCKS;
        let (all, reach) =
            (self.bounds.of_block::<S::Float4>(block, near), S::Float4::splat(self.bounds.reach.0[block]));
        let (first, end) = leaf.groups();
        for group in &bvh.groups[first..end] {
            let (low, high) = group.planes::<S::Float4>();
            let (from, to) = all.between(near.choose(low, high), near.choose(high, low), reach);
            let mut meeting = from.le(to).bitmask();
            while meeting != 0 {
                let lane = meeting.trailing_zeros() as usize % WideBvh::<N>::GROUP;
                meeting &= meeting - 1;
                let Some(triangle) = group.triangle(lane) else { break };
                hits |= self.triangle::<S::Float16, C>(&triangle, near, 1 << block, count);
            }
        }
        if hits != 0 {
            self.update_reach::<S::Float16>(block);
        }
    }

    /// The triangles of a leaf, for the rays of some blocks.
    #[inline(always)]
    fn leaf<F: Float, C: Count>(&mut self, bvh: &WideBvh<N>, near: Near, leaf: Child, blocks: u16, count: &mut C) {
        let mut hit_blocks = 0;
        let (first, end) = leaf.groups();
        for group in &bvh.groups[first..end] {
            for lane in 0..group.id.len() {
                let Some(triangle) = group.triangle(lane) else { break };
                hit_blocks |= self.triangle::<F, C>(&triangle, near, blocks, count);
            }
        }
        while hit_blocks != 0 {
            let block = hit_blocks.trailing_zeros() as usize % BLOCKS;
            hit_blocks &= hit_blocks - 1;
            self.update_reach::<F>(block);
        }
    }

    /// A triangle, for the rays of some blocks; returns which of these hit it.
    #[inline(always)]
    fn triangle<F: Float, C: Count>(&mut self, triangle: &Triangle, near: Near, blocks: u16, count: &mut C) -> u16 {
        let (mut hits, mut rest) = (0, blocks);
        while rest != 0 {
            let block = rest.trailing_zeros() as usize % BLOCKS;
            rest &= rest - 1;
            count.triangle_test();
            let rays = &mut self.rays[block];
            let ray = rays.packet::<F>(&self.from[block]);
            if let Some(hit) = moller_trumbore::intersect(triangle, &ray, PerRay, near) {
                count.triangle_hit();
                Q::accept(&mut self.found[block], &mut rays.reach, 0, triangle.id, hit);
                hits |= 1 << block;
            }
        }
        hits
    }

    #[inline(always)]
    fn update_reach<F: Float>(&mut self, block: usize) {
        let rays = &self.rays[block];
        self.bounds.reach.0[block] = F::load_block(&rays.reach, 0).reduce_max();
    }
}

/// A child goes to the stack: below those nearer that came there since `bottom`, above the farther.
#[inline(always)]
fn push<Q: Query>(
    bvh: &WideBvh<N>,
    stack: &mut [Entry],
    bottom: usize,
    free: &mut usize,
    t_near: f32,
    child: Child,
    active: u16,
) {
    bvh.prefetch(child);
    let key = entry(t_near, child);
    let mut at = *free;
    while Q::CLOSEST && at > bottom && stack[at - 1].key < key {
        stack[at] = stack[at - 1];
        at -= 1;
    }
    stack[at] = Entry { key, active };
    *free += 1;
}
