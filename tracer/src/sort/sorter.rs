//! Rays into order and their hits back: the stages one by one, to be timed apart.

use super::{RayHash, RaySort};
use crate::geometry::{HitBatch, HitBlock, RayBatch, RayBlock, Vec3};
use crate::method::BitVec;
use rayon::prelude::*;
use simd::{Float, Level, Simd, Vector, kernel};
use std::sync::atomic::{AtomicU32, Ordering};

/// The vector of `u32` in a level's registers.
type Native<S> = <<S as Simd>::Float as Vector>::Index;

/// Blocks that a thread takes at a time.
const PORTION: usize = 256;
/// How many rays ahead of those that are gathered the memory is asked for.
const AHEAD: usize = 32;

/// Sorts rays and puts results back: first [`RaySorter::order`], then [`RaySorter::gather`], then one that puts back; what is needed is kept from
/// one to the next, and its memory for later batches.
///
/// Rays lie in blocks, structure of arrays: those of one ray are in eight lines of memory. They are gathered by way of rows, a ray in half
/// a line.
#[derive(Debug)]
pub struct RaySorter {
    level: Level,
    hash: RayHash,
    sort: RaySort,
    hashes: Vec<u32>,
    order: Vec<u32>,
    rows: Vec<[f32; 8]>,
    rays: RayBatch,
    /// Where each ray is in the order.
    places: Vec<AtomicU32>,
    hits: Vec<[u32; 4]>,
}

impl RaySorter {
    /// By a hash, at a level.
    #[must_use]
    pub fn new(level: Level, hash: RayHash) -> Self {
        Self {
            level,
            hash,
            sort: RaySort::default(),
            hashes: Vec::new(),
            order: Vec::new(),
            rows: Vec::new(),
            rays: RayBatch::new(),
            places: Vec::new(),
            hits: Vec::new(),
        }
    }

    /// The numbers of the rays in order: by hash, and those of the same hash as they came.
    pub fn order(&mut self, rays: &RayBatch) -> &[u32] {
        self.hash.hash(self.level, rays, &mut self.hashes);
        self.sort.order(self.level, &self.hashes, &mut self.order);
        &self.order
    }

    /// Each hash and the place of its first ray in the order that was found last.
    pub fn cells(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.sort.cells()
    }

    /// How many runs of rays were sorted: see [`RaySort::runs`].
    #[must_use]
    pub fn runs(&self) -> usize {
        self.sort.runs()
    }

    /// The rays in the order that was found last, which must have been theirs.
    ///
    /// # Panics
    /// If they are of another number.
    pub fn gather(&mut self, rays: &RayBatch) -> &RayBatch {
        let Self { level, order, rows, .. } = self;
        let len = rays.len();
        assert!(order.len() == len, "{len} rays in an order of {}", order.len());
        let level = *level;
        rows.resize(16 * rays.blocks().len(), [0.0; 8]);
        let portions = rays.blocks().par_chunks(PORTION).zip(rows.par_chunks_mut(16 * PORTION));
        portions.for_each(|(blocks, rows)| to_rows(level, blocks, rows));
        let blocks = self.rays.resize(len, rays.origin());
        let portions = blocks.par_chunks_mut(PORTION).zip(order.par_chunks(16 * PORTION));
        portions.for_each(|(blocks, order)| gather_rays(level, rows, order, blocks));
        self.rays.turn_off_rest();
        &self.rays
    }

    /// Bytes held.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let words = self.hashes.capacity() + self.order.capacity() + self.places.capacity();
        let rows = size_of::<[f32; 8]>() * self.rows.capacity() + size_of::<[u32; 4]>() * self.hits.capacity();
        self.sort.bytes() + size_of::<u32>() * words + rows + size_of_val(self.rays.blocks())
    }

    /// The rays that were gathered last.
    #[must_use]
    pub fn rays(&self) -> &RayBatch {
        &self.rays
    }

    /// Writes the hits of the gathered rays, `sorted`, to `hits` in the order that the rays came in.
    ///
    /// # Panics
    /// If they are of another number.
    pub fn put_hits_back(&mut self, sorted: &HitBatch, hits: &mut HitBatch) {
        let len = self.order.len();
        assert!(sorted.len() == len, "{} hits in an order of {len}", sorted.len());
        self.find_places();
        let (level, places) = (self.level, &self.places[..len]);
        self.hits.resize(16 * sorted.blocks().len(), [0; 4]);
        let portions = sorted.blocks().par_chunks(PORTION).zip(self.hits.par_chunks_mut(16 * PORTION));
        portions.for_each(|(blocks, rows)| to_hit_rows(level, blocks, rows));
        let rows = &self.hits[..];
        let portions = hits.resize(len).par_chunks_mut(PORTION).zip(places.par_chunks(16 * PORTION));
        portions.for_each(|(blocks, places)| gather_hits(level, rows, places, blocks));
    }

    /// The same with one bit for each ray.
    ///
    /// # Panics
    /// If they are of another number.
    pub fn put_bits_back(&mut self, sorted: &BitVec, bits: &mut BitVec) {
        let len = self.order.len();
        assert!(sorted.len() == len, "{} bits in an order of {len}", sorted.len());
        let words = bits.resize(len);
        words.fill(0);
        // The bits of a million rays lie in the cache.
        for (place, &ray) in self.order.iter().enumerate() {
            words[ray as usize / 16] |= u16::from(sorted.get(place)) << (ray % 16);
        }
    }

    /// Turns the order round.
    fn find_places(&mut self) {
        if self.places.len() < self.order.len() {
            self.places.resize_with(self.order.len(), AtomicU32::default);
        }
        let places = &self.places[..];
        self.order.par_chunks(16 * PORTION).enumerate().for_each(|(i, order)| {
            for (place, &ray) in (i * 16 * PORTION..).zip(order) {
                places[ray as usize].store(place as u32, Ordering::Relaxed);
            }
        });
    }
}

kernel! {
    fn to_rows<S>(blocks: &[RayBlock], rows: &mut [[f32; 8]]) {
        let lanes = S::Float::LANES;
        for (block, rows) in blocks.iter().zip(rows.as_chunks_mut::<16>().0) {
            for chunk in 0..16 / lanes {
                let (o, d) = (Vec3::<S::Float>::load(&block.org, chunk), Vec3::load(&block.dir, chunk));
                let t_min = S::Float::load_block(&block.t_min, chunk);
                let t_max = S::Float::load_block(&block.t_max, chunk);
                S::Float::store_rows8([o.x, o.y, o.z, t_min, d.x, d.y, d.z, t_max], &mut rows[chunk * lanes..]);
            }
        }
    }
}

kernel! {
    /// The rows of an order as blocks; what the last block lacks is as it was.
    fn gather_rays<S>(rows: &[[f32; 8]], order: &[u32], blocks: &mut [RayBlock]) {
        let lanes = S::Float::LANES;
        let mut sixteen = [[0.0; 8]; 16];
        for (i, (block, these)) in blocks.iter_mut().zip(order.chunks(16)).enumerate() {
            for (row, &ray) in sixteen.iter_mut().zip(these) {
                *row = rows[ray as usize];
            }
            for &ray in order.iter().skip(16 * i + AHEAD).take(16) {
                simd::prefetch(rows, ray as usize);
            }
            for chunk in 0..16 / lanes {
                let [x, y, z, t_min, dx, dy, dz, t_max] = S::Float::load_rows8(&sixteen[chunk * lanes..]);
                Vec3 { x, y, z }.store(&mut block.org, chunk);
                Vec3 { x: dx, y: dy, z: dz }.store(&mut block.dir, chunk);
                t_min.store_block(&mut block.t_min, chunk);
                t_max.store_block(&mut block.t_max, chunk);
            }
        }
    }
}

kernel! {
    fn to_hit_rows<S>(blocks: &[HitBlock], rows: &mut [[u32; 4]]) {
        let lanes = S::Float::LANES;
        for (block, rows) in blocks.iter().zip(rows.as_chunks_mut::<16>().0) {
            for chunk in 0..16 / lanes {
                let t = S::Float::load_block(&block.t, chunk).to_bits();
                let u = S::Float::load_block(&block.u, chunk).to_bits();
                let v = S::Float::load_block(&block.v, chunk).to_bits();
                let primitive = Native::<S>::load_block(&block.primitive, chunk);
                Native::<S>::store_rows4([t, u, v, primitive], &mut rows[chunk * lanes..]);
            }
        }
    }
}

kernel! {
    /// The hits at places; what the last block lacks are misses.
    fn gather_hits<S>(rows: &[[u32; 4]], places: &[AtomicU32], blocks: &mut [HitBlock]) {
        let lanes = S::Float::LANES;
        for (i, (block, these)) in blocks.iter_mut().zip(places.chunks(16)).enumerate() {
            let mut sixteen = [[f32::INFINITY.to_bits(), 0, 0, u32::MAX]; 16];
            for (row, place) in sixteen.iter_mut().zip(these) {
                *row = rows[place.load(Ordering::Relaxed) as usize];
            }
            for place in places.iter().skip(16 * i + AHEAD).take(16) {
                simd::prefetch(rows, place.load(Ordering::Relaxed) as usize);
            }
            for chunk in 0..16 / lanes {
                let [t, u, v, primitive] = Native::<S>::load_rows4(&sixteen[chunk * lanes..]);
                S::Float::from_bits(t).store_block(&mut block.t, chunk);
                S::Float::from_bits(u).store_block(&mut block.u, chunk);
                S::Float::from_bits(v).store_block(&mut block.v, chunk);
                primitive.store_block(&mut block.primitive, chunk);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Aabb, Hit, Ray};
    use crate::sort::{Reorder, test};

    const BOX: Aabb = Aabb { min: [0.0; 3], max: [1.0; 3] };

    fn rays(len: usize) -> RayBatch {
        let numbers: Vec<f32> = test::random(8 * len, 3).iter().map(|&x| (x >> 8) as f32 / (1 << 24) as f32).collect();
        let ray = |x: &[f32]| Ray { org: [x[0], x[1], x[2]], t_min: x[3], dir: [x[4], x[5], x[6] - 0.5], t_max: x[7] };
        numbers.chunks(8).map(ray).collect()
    }

    #[test]
    fn there_and_back() {
        test::everywhere(|| {
            for level in Level::available() {
                let mut sorter = RaySorter::new(level, RayHash::new(&BOX, Reorder::Hash));
                // The larger first: what is kept of it must not show.
                for len in [5000, 4099, 33, 16, 1, 0] {
                    let rays = rays(len);
                    let order = sorter.order(&rays).to_vec();
                    let sorted = sorter.gather(&rays);
                    let expected = order.iter().map(|&i| rays.get(i as usize));
                    assert!(sorted.len() == len && sorted.iter().eq(expected), "{level}, {len}");
                    let rest =
                        sorted.blocks().last().map_or(0, |block| (0..16).filter(|&i| block.get(i).t_max < 0.0).count());
                    assert_eq!(rest, len.next_multiple_of(16) - len, "{level}, {len}");

                    // Hits that tell their ray's place in the order.
                    let (mut hits, mut back) = (HitBatch::new(), HitBatch::new());
                    let hit = |place: u32| Hit { t: place as f32, u: 0.5, v: -0.0, primitive: place };
                    for (i, block) in hits.resize(len).iter_mut().enumerate() {
                        for lane in 0..16 {
                            let Hit { t, u, v, primitive } = hit((16 * i + lane) as u32);
                            (block.t.0[lane], block.u.0[lane], block.v.0[lane]) = (t, u, v);
                            block.primitive.0[lane] = primitive;
                        }
                    }
                    sorter.put_hits_back(&hits, &mut back);
                    assert_eq!(back.len(), len);
                    for (place, &ray) in order.iter().enumerate() {
                        let (found, expected) = (back.get(ray as usize), hit(place as u32));
                        assert!(found == expected && found.v.is_sign_negative(), "{level}, {len}, {place}: {found:?}");
                    }

                    let (mut bits, mut back) = (BitVec::new(), BitVec::new());
                    for (i, word) in bits.resize(len).iter_mut().enumerate() {
                        *word = (0x5a36_u16).rotate_left(i as u32);
                    }
                    sorter.put_bits_back(&bits, &mut back);
                    assert!(order.iter().enumerate().all(|(i, &ray)| back.get(ray as usize) == bits.get(i)));
                }
            }
        });
    }

    #[test]
    fn rays_of_one_origin_stay_so() {
        let rays: RayBatch = (0..100).map(|i| Ray::new([0.5; 3], [1.0, i as f32, -0.5])).collect();
        let mut sorter = RaySorter::new(Level::best(), RayHash::new(&BOX, Reorder::Direction));
        sorter.order(&rays);
        assert_eq!(sorter.gather(&rays).origin(), Some([0.5; 3]));
    }
}
