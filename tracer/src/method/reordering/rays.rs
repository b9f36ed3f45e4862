//! Rays on their way, and where their hits go.

use super::tally::Tally;
use crate::geometry::cull::Cull;
use crate::geometry::moller_trumbore::{self, Candidate};
use crate::geometry::{Hit, HitBlock, Packet, RayBlock, Triangle, Vec3};
use simd::{Block, Float, Mask, Vector};

/// Sixteen rays. A box test of theirs is that of [`Cull`]: `plane * inv + offset` for planes moved outwards by one distance for all.
#[derive(Debug, Clone)]
pub(super) struct Sixteen {
    pub(super) org: [Block<f32>; 3],
    pub(super) dir: [Block<f32>; 3],
    pub(super) inv: [Block<f32>; 3],
    pub(super) offset: [Block<f32>; 3],
    /// Infinite where there is no ray.
    pub(super) t_min: Block<f32>,
    /// How far along each ray a hit matters; minus infinity where none does.
    pub(super) reach: Block<f32>,
    /// What was hit there.
    pub(super) primitive: Block<u32>,
    /// Where the ray's hit goes.
    pub(super) id: Block<u32>,
    /// Where the ray lies in the packet that it was copied from.
    pub(super) from: Block<u32>,
}

/// The rays of a packet as arrays of structures, from which others can be put together by vectors.
#[derive(Debug, Default)]
pub(super) struct Rows {
    /// What box tests need.
    boxes: Vec<[f32; 8]>,
    /// What triangle tests need.
    rays: Vec<[f32; 8]>,
}

/// Sixteen of them.
#[derive(Debug)]
pub(super) struct Sixteen8 {
    boxes: [[f32; 8]; 16],
    rays: [[f32; 8]; 16],
}

impl Rows {
    pub(super) fn resize(&mut self, rays: usize) {
        self.boxes.resize(rays, [0.0; 8]);
        self.rays.resize(rays, [0.0; 8]);
    }
}

impl Sixteen8 {
    pub(super) const NONE: Self = Self { boxes: [[0.0; 8]; 16], rays: [[0.0; 8]; 16] };

    #[inline(always)]
    pub(super) fn set(&mut self, lane: usize, rows: &Rows, row: usize) {
        self.boxes[lane] = rows.boxes[row];
        self.rays[lane] = rows.rays[row];
    }
}

/// What was found out about sixteen rays while they were made ready.
#[derive(Debug, Clone, Copy)]
pub(super) struct Loaded {
    /// Rays that [`Cull`] is for, a bit each.
    pub(super) valid: u16,
    /// Rays that it is not for.
    pub(super) odd: u16,
    /// The distance that boxes grow by.
    pub(super) growth: f32,
}

impl Sixteen {
    /// No rays.
    pub(super) const NONE: Self = {
        let zero = [Block([0.0; 16]); 3];
        Self {
            org: zero,
            dir: zero,
            inv: zero,
            offset: zero,
            t_min: Block([f32::INFINITY; 16]),
            reach: Block([f32::NEG_INFINITY; 16]),
            primitive: Block([Hit::NO_PRIMITIVE; 16]),
            id: Block([0; 16]),
            from: Block([0; 16]),
        }
    };

    /// These rays, whose hits go to `first_id` and the places behind it.
    #[inline(always)]
    pub(super) fn set<F: Float>(&mut self, rays: &RayBlock, largest: f32, first_id: u32) -> Loaded {
        let mut loaded = Loaded { valid: 0, odd: 0, growth: 0.0 };
        let mut growth = F::splat(0.0);
        for chunk in 0..16 / F::LANES {
            let ray = Packet::<F>::load(rays, chunk);
            let (cull, ordinary) = Cull::new(&ray, largest);
            let on = ray.valid & ordinary;
            ray.org.store(&mut self.org, chunk);
            ray.dir.store(&mut self.dir, chunk);
            cull.inv_dir.store(&mut self.inv, chunk);
            cull.offset(&ray).store(&mut self.offset, chunk);
            F::select(on, ray.t_min, F::splat(f32::INFINITY)).store_block(&mut self.t_min, chunk);
            F::select(on, ray.t_max, F::splat(f32::NEG_INFINITY)).store_block(&mut self.reach, chunk);
            growth = growth.max(Cull::growth(&ray, largest));
            loaded.valid |= (on.bitmask() << (chunk * F::LANES)) as u16;
            loaded.odd |= ((ray.valid & !ordinary).bitmask() << (chunk * F::LANES)) as u16;
        }
        self.primitive = Block([Hit::NO_PRIMITIVE; 16]);
        for (lane, id) in self.id.0.iter_mut().enumerate() {
            *id = first_id + lane as u32;
        }
        loaded.growth = growth.reduce_max();
        loaded
    }

    /// What does not change of them, for [`Rows`].
    #[inline(always)]
    pub(super) fn write<F: Float>(&self, rows: &mut Rows, first: usize) {
        for chunk in 0..16 / F::LANES {
            let at = first + chunk * F::LANES;
            let (inv, offset) = (self.inv::<F>(chunk), self.offset::<F>(chunk));
            let (org, dir) = (self.org::<F>(chunk), self.dir::<F>(chunk));
            let (t_min, zero) = (F::load_block(&self.t_min, chunk), F::splat(0.0));
            let columns = [inv.x, inv.y, inv.z, t_min, offset.x, offset.y, offset.z, zero];
            F::store_rows8(columns, &mut rows.boxes[at..at + F::LANES]);
            F::store_rows8([org.x, org.y, org.z, zero, dir.x, dir.y, dir.z, zero], &mut rows.rays[at..at + F::LANES]);
        }
    }

    /// The first `number` of these instead, and no others.
    #[inline(always)]
    pub(super) fn read<F: Float>(&mut self, rows: &Sixteen8, number: usize) {
        let mut chunk = 0;
        while chunk < 16 / F::LANES && chunk * F::LANES < number {
            let at = chunk * F::LANES;
            let [x, y, z, t_min, a, b, c, _] = F::load_rows8(&rows.boxes[at..at + F::LANES]);
            Vec3 { x, y, z }.store(&mut self.inv, chunk);
            Vec3 { x: a, y: b, z: c }.store(&mut self.offset, chunk);
            t_min.store_block(&mut self.t_min, chunk);
            let [x, y, z, _, a, b, c, _] = F::load_rows8(&rows.rays[at..at + F::LANES]);
            Vec3 { x, y, z }.store(&mut self.org, chunk);
            Vec3 { x: a, y: b, z: c }.store(&mut self.dir, chunk);
            chunk += 1;
        }
        for lane in number..16 {
            (self.t_min.0[lane], self.reach.0[lane]) = (f32::INFINITY, f32::NEG_INFINITY);
        }
    }

    /// What changes of a ray, to a lane of other sixteen; `from` is where it lies here.
    #[inline(always)]
    pub(super) fn copy_state(&self, lane: usize, to: &mut Self, to_lane: usize, from: u32) {
        to.reach.0[to_lane] = self.reach.0[lane];
        to.primitive.0[to_lane] = self.primitive.0[lane];
        to.id.0[to_lane] = self.id.0[lane];
        to.from.0[to_lane] = from;
    }

    /// Exchanges two rays.
    #[inline(always)]
    pub(super) fn swap(&mut self, a: usize, b: usize) {
        for axis in 0..3 {
            self.org[axis].0.swap(a, b);
            self.dir[axis].0.swap(a, b);
            self.inv[axis].0.swap(a, b);
            self.offset[axis].0.swap(a, b);
        }
        self.t_min.0.swap(a, b);
        self.reach.0.swap(a, b);
        self.primitive.0.swap(a, b);
        self.id.0.swap(a, b);
        self.from.0.swap(a, b);
    }

    /// [`Sixteen::swap`] with a ray of other sixteen.
    #[inline(always)]
    pub(super) fn swap_with(&mut self, a: usize, other: &mut Self, b: usize) {
        use std::mem::swap;
        for axis in 0..3 {
            swap(&mut self.org[axis].0[a], &mut other.org[axis].0[b]);
            swap(&mut self.dir[axis].0[a], &mut other.dir[axis].0[b]);
            swap(&mut self.inv[axis].0[a], &mut other.inv[axis].0[b]);
            swap(&mut self.offset[axis].0[a], &mut other.offset[axis].0[b]);
        }
        swap(&mut self.t_min.0[a], &mut other.t_min.0[b]);
        swap(&mut self.reach.0[a], &mut other.reach.0[b]);
        swap(&mut self.primitive.0[a], &mut other.primitive.0[b]);
        swap(&mut self.id.0[a], &mut other.id.0[b]);
        swap(&mut self.from.0[a], &mut other.from.0[b]);
    }

    /// Whether a ray's direction is negative on an axis.
    #[inline(always)]
    pub(super) fn is_negative(&self, lane: usize, axis: usize) -> bool {
        self.inv[axis % 3].0[lane % 16] < 0.0
    }

    #[inline(always)]
    pub(super) fn inv<F: Float>(&self, chunk: usize) -> Vec3<F> {
        Vec3::load(&self.inv, chunk)
    }

    #[inline(always)]
    pub(super) fn org<F: Float>(&self, chunk: usize) -> Vec3<F> {
        Vec3::load(&self.org, chunk)
    }

    #[inline(always)]
    pub(super) fn dir<F: Float>(&self, chunk: usize) -> Vec3<F> {
        Vec3::load(&self.dir, chunk)
    }

    #[inline(always)]
    pub(super) fn offset<F: Float>(&self, chunk: usize) -> Vec3<F> {
        Vec3::load(&self.offset, chunk)
    }

    /// The rays of a chunk, made ready for triangles.
    #[inline(always)]
    pub(super) fn packet<F: Float>(&self, chunk: usize) -> Packet<F> {
        let (t_min, reach) = (F::load_block(&self.t_min, chunk), F::load_block(&self.reach, chunk));
        Packet::of_clean(self.org(chunk), self.dir(chunk), t_min, reach)
    }

    /// Where the rays of a chunk enter the box, and where they leave it or nothing matters any more; the box has grown.
    #[inline(always)]
    pub(super) fn interval<F: Float>(&self, chunk: usize, grown: &Planes<F>) -> (F, F) {
        let (inv, offset) = (self.inv::<F>(chunk), self.offset::<F>(chunk));
        let (low, high) = (at(grown.low, inv, offset), at(grown.high, inv, offset));
        let (near, far) = (low.min(high), low.max(high));
        let t_near = near.x.max(near.y).max(near.z.max(F::load_block(&self.t_min, chunk)));
        let t_far = far.x.min(far.y).min(far.z.min(F::load_block(&self.reach, chunk)));
        (t_near, t_far)
    }
}

#[inline(always)]
fn at<F: Float>(plane: Vec3<F>, inv: Vec3<F>, add: Vec3<F>) -> Vec3<F> {
    Vec3 { x: plane.x.mul_add(inv.x, add.x), y: plane.y.mul_add(inv.y, add.y), z: plane.z.mul_add(inv.z, add.z) }
}

/// A box that has grown, in every lane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Planes<F> {
    low: Vec3<F>,
    high: Vec3<F>,
}

impl<F: Float> Planes<F> {
    #[inline(always)]
    pub(super) fn new(planes: &[f32; 8], growth: f32) -> Self {
        Self {
            low: Vec3::splat([planes[0] - growth, planes[1] - growth, planes[2] - growth]),
            high: Vec3::splat([planes[4] + growth, planes[5] + growth, planes[6] + growth]),
        }
    }
}

/// Where hits go.
pub(super) enum Results<'a> {
    Closest(&'a mut [HitBlock]),
    Any(&'a mut [u16]),
}

impl Results<'_> {
    #[inline(always)]
    pub(super) fn is_any(&self) -> bool {
        matches!(self, Self::Any(_))
    }

    /// The hit of one ray.
    #[inline(always)]
    pub(super) fn put(&mut self, id: u32, hit: &Hit) {
        let (block, lane) = ((id / 16) as usize, (id % 16) as usize);
        match self {
            Self::Closest(blocks) => {
                let block = &mut blocks[block];
                block.t.0[lane] = hit.t;
                block.u.0[lane] = hit.u;
                block.v.0[lane] = hit.v;
                block.primitive.0[lane] = hit.primitive;
            }
            Self::Any(words) => words[block] |= 1 << lane,
        }
    }
}

/// What the rays of a chunk have hit so far.
#[derive(Debug, Clone, Copy)]
pub(super) struct Found<F: Float> {
    /// How far along each ray a hit matters.
    pub(super) reach: F,
    u: F,
    v: F,
    pub(super) primitive: F::Index,
    new: F::Mask,
}

impl<F: Float> Found<F> {
    #[inline(always)]
    pub(super) fn load(rays: &Sixteen, chunk: usize) -> Self {
        let zero = F::splat(0.0);
        Self {
            reach: F::load_block(&rays.reach, chunk),
            u: zero,
            v: zero,
            primitive: F::Index::load_block(&rays.primitive, chunk),
            new: F::Mask::splat(false),
        }
    }

    /// A leaf's triangles; `bits` are the rays that meet its box.
    #[inline(always)]
    pub(super) fn leaf<T: Tally>(
        &mut self,
        triangles: &[Triangle],
        rays: &Packet<F>,
        bits: u32,
        any: bool,
        tally: &mut T,
    ) {
        for triangle in triangles {
            tally.triangle(bits.count_ones());
            let rays = Packet { t_max: self.reach, ..*rays };
            if let Some(hit) = moller_trumbore::intersect_mixed(triangle, &rays) {
                if T::ON && hit.mask.any() {
                    tally.triangle_hit();
                }
                self.accept(triangle.id, hit, any);
            }
        }
    }

    #[inline(always)]
    fn accept(&mut self, primitive: u32, hit: Candidate<F>, any: bool) {
        let primitive = F::Index::splat(primitive);
        // At equal distance the lower id wins, whatever order the leaves are visited in.
        let mask = hit.mask & (hit.t.lt(self.reach) | (hit.t.eq(self.reach) & primitive.lt(self.primitive)));
        let reach = if any { F::splat(f32::NEG_INFINITY) } else { hit.t };
        self.reach = F::select(mask, reach, self.reach);
        self.u = F::select(mask, hit.u, self.u);
        self.v = F::select(mask, hit.v, self.v);
        self.primitive = F::Index::select(mask, primitive, self.primitive);
        self.new |= mask;
    }

    /// No further hit matters.
    #[inline(always)]
    pub(super) fn is_complete(&self) -> bool {
        self.reach.eq(F::splat(f32::NEG_INFINITY)).all()
    }

    /// Writes what is new to the rays and to the results; whether there was something.
    #[inline(always)]
    pub(super) fn store(&self, rays: &mut Sixteen, chunk: usize, results: &mut Results) -> bool {
        let mut bits = self.new.bitmask();
        if bits == 0 {
            return false;
        }
        self.reach.store_block(&mut rays.reach, chunk);
        self.primitive.store_block(&mut rays.primitive, chunk);
        let first = rays.id.0[chunk * F::LANES] as usize;
        if bits.count_ones() > 2 && are_together::<F>(rays, chunk) {
            self.store_together(first / 16, first % 16 / F::LANES, results);
            return true;
        }
        let (t, u, v, primitive) =
            (self.reach.to_block(), self.u.to_block(), self.v.to_block(), self.primitive.to_block());
        while bits != 0 {
            let i = bits.trailing_zeros() as usize % 16;
            bits &= bits - 1;
            let hit = Hit { t: t.0[i], u: u.0[i], v: v.0[i], primitive: primitive.0[i] };
            results.put(rays.id.0[(chunk * F::LANES + i) % 16], &hit);
        }
        true
    }

    #[inline(always)]
    fn store_together(&self, block: usize, chunk: usize, results: &mut Results) {
        match results {
            Results::Closest(blocks) => {
                let block = &mut blocks[block];
                F::select(self.new, self.reach, F::load_block(&block.t, chunk)).store_block(&mut block.t, chunk);
                F::select(self.new, self.u, F::load_block(&block.u, chunk)).store_block(&mut block.u, chunk);
                F::select(self.new, self.v, F::load_block(&block.v, chunk)).store_block(&mut block.v, chunk);
                let old = F::Index::load_block(&block.primitive, chunk);
                F::Index::select(self.new, self.primitive, old).store_block(&mut block.primitive, chunk);
            }
            Results::Any(words) => words[block] |= (self.new.bitmask() << (chunk * F::LANES)) as u16,
        }
    }
}

/// Whether the results of a chunk lie side by side, as those of rays do that were not moved.
#[inline(always)]
fn are_together<F: Float>(rays: &Sixteen, chunk: usize) -> bool {
    let ids = F::Index::load_block(&rays.id, chunk);
    let first = rays.id.0[chunk * F::LANES];
    (first as usize).is_multiple_of(F::LANES)
        && (ids - F::Index::splat(first)).eq(F::Index::load_block(&PLACES, 0)).all()
}

const PLACES: Block<u32> = Block([0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15]);
