//! Rays of 32 bytes, which are moved (section 3.1), and what they hit.

use crate::geometry::{Packet, RayBlock, Vec3};
use crate::lanes::{self, Lanes, Width};
use rayon::prelude::*;
use simd::{Float, Level, Mask, Simd, Vector};

/// Origin, end of the interval, direction, and the ray's number in the batch, as bits. Cleaned as [`Packet::load`] does.
pub(super) type Row = [f32; 8];

/// Where a row holds the end of its interval.
pub(super) const T_MAX: usize = 3;
/// Where it holds its number.
const ID: usize = 7;

/// A row that nothing hits.
pub(super) const NONE: Row = [0.0, 0.0, 0.0, f32::NEG_INFINITY, 1.0, 1.0, 1.0, 0.0];

/// Number of the ray.
#[inline(always)]
pub(super) fn id(row: &Row) -> usize {
    row[ID].to_bits() as usize
}

#[inline(always)]
pub(super) fn set_id(row: &mut Row, id: usize) {
    row[ID] = f32::from_bits(id as u32);
}

/// Cleans rays and puts them into rows, sixteen for each block, those that hit nothing as [`NONE`]; `first` is the number of the first.
/// Returns the smallest and the largest start of their intervals.
pub(super) struct Load<'a> {
    pub(super) blocks: &'a [RayBlock],
    pub(super) first: usize,
    pub(super) rows: &'a mut [Row],
}

impl Lanes for Load<'_> {
    type Output = [f32; 2];

    #[inline(always)]
    fn run<F: Float>(self) -> [f32; 2] {
        let (mut least, mut most) = (F::splat(f32::INFINITY), F::splat(0.0));
        let mut numbers = F::Index::from_fn(|lane| (self.first + lane) as u32);
        for (i, block) in self.blocks.iter().enumerate() {
            for chunk in 0..16 / F::LANES {
                let ray = Packet::<F>::load(block, chunk);
                let at = 16 * i + chunk * F::LANES;
                let (o, d) = (ray.org, ray.dir);
                F::store_rows8([o.x, o.y, o.z, ray.t_max, d.x, d.y, d.z, F::from_bits(numbers)], &mut self.rows[at..]);
                least = least.min(ray.t_min);
                most = most.max(F::select(ray.valid, ray.t_min, most));
                numbers += F::Index::splat(F::LANES as u32);
            }
        }
        [least.reduce_min(), most.reduce_max()]
    }
}

/// A packet as it is in rows, with intervals from `from` on.
#[inline(always)]
pub(super) fn packet<F: Float>(rows: &[Row], from: F) -> Packet<F> {
    let [x, y, z, t_max, dx, dy, dz, _] = F::load_rows8(rows);
    Packet::of_clean(Vec3 { x, y, z }, Vec3 { x: dx, y: dy, z: dz }, from, t_max)
}

/// Which rays of a packet meet a box, planes `min x y z _ max x y z _`, as any test of a box around or inside of it agrees.
///
/// Not [`slab::interval`](crate::geometry::slab::interval): which plane is the near one is told by the products here, so that the far end is padded
/// once and by more. It is never less than what that test computes: products are monotone, `x * inv * (1 + 8 eps)` is not less than
/// `x * (inv * (1 + 4 eps))` as rounded where neither underflows, and where one does, the difference is below the smallest normal number.
#[inline(always)]
pub(super) fn meets<F: Float>(rows: &[Row], planes: &[f32; 8], from: f32) -> F::Mask {
    let [x, y, z, t_max, dx, dy, dz, _] = F::load_rows8(rows);
    let one = F::splat(1.0);
    let (low, high) = (Vec3::splat([planes[0], planes[1], planes[2]]), Vec3::splat([planes[4], planes[5], planes[6]]));
    let (org, inv) = (Vec3 { x, y, z }, Vec3 { x: one / safe(dx), y: one / safe(dy), z: one / safe(dz) });
    let (a, b) = ((low - org) * inv, (high - org) * inv);
    let (near, far) = (a.min(b), a.max(b));
    let t_near = near.x.max(near.y).max(near.z.max(F::splat(from)));
    let t_far = far.x.min(far.y).min(far.z);
    let t_far = (t_far * F::splat(1.0 + 8.0 * f32::EPSILON) + F::splat(f32::MIN_POSITIVE)).min(t_max);
    t_near.le(t_far)
}

/// The smallest normal number in place of zero: as [`Packet`] takes reciprocals.
#[inline(always)]
fn safe<F: Float>(d: F) -> F {
    let least = F::splat(f32::MIN_POSITIVE);
    F::select(d.eq(F::splat(0.0)), least.copysign(d), d)
}

/// The rays that are looked at, the active ones first.
pub(super) trait Active {
    /// Whether vectors are of any width: else of that of the level's registers.
    const ANY_WIDTH: bool;

    /// `n` rays from place `at` on and [`NONE`] behind them, as many as lanes.
    fn load<'a, F: Float>(&'a self, at: usize, n: usize, buffer: &'a mut [Row; 16]) -> &'a [Row];

    /// Exchanges the rays at two places.
    fn swap<S: Simd>(&mut self, i: usize, j: usize);

    /// The ray at this place ends here.
    fn shorten(&mut self, at: usize, t_max: f32);

    /// The first ray.
    fn first(&self) -> &Row;
}

/// Room for [`Active::load`].
pub(super) const BUFFER: [Row; 16] = [NONE; 16];

/// The rays themselves are moved.
pub(super) struct InPlace<'a>(pub(super) &'a mut [Row]);

impl Active for InPlace<'_> {
    const ANY_WIDTH: bool = true;

    #[inline(always)]
    fn load<'a, F: Float>(&'a self, at: usize, n: usize, buffer: &'a mut [Row; 16]) -> &'a [Row] {
        load::<F>(self.0, at, n, buffer)
    }

    #[inline(always)]
    fn swap<S: Simd>(&mut self, i: usize, j: usize) {
        let (a, b) = (S::Float8::load(&self.0[i]), S::Float8::load(&self.0[j]));
        b.store(&mut self.0[i]);
        a.store(&mut self.0[j]);
    }

    #[inline(always)]
    fn shorten(&mut self, at: usize, t_max: f32) {
        self.0[at][T_MAX] = t_max;
    }

    fn first(&self) -> &Row {
        &self.0[0]
    }
}

/// See [`Active::load`].
#[inline(always)]
pub(super) fn load<'a, F: Float>(rows: &'a [Row], at: usize, n: usize, buffer: &'a mut [Row; 16]) -> &'a [Row] {
    if n == F::LANES {
        return &rows[at..at + F::LANES];
    }
    *buffer = BUFFER;
    buffer[..n].copy_from_slice(&rows[at..at + n]);
    buffer
}

/// How many rays ahead the memory of those that are looked at by their place is asked for, as the paper does.
const AHEAD: usize = 32;

/// Their places are (Mora 2011), which the paper compares with.
pub(super) struct ByPlace<'a> {
    pub(super) places: &'a mut [u32],
    pub(super) rows: &'a mut [Row],
}

impl Active for ByPlace<'_> {
    const ANY_WIDTH: bool = false;

    #[inline(always)]
    fn load<'a, F: Float>(&'a self, at: usize, n: usize, buffer: &'a mut [Row; 16]) -> &'a [Row] {
        if n < F::LANES {
            *buffer = BUFFER;
        }
        for &place in self.places.iter().skip(at + AHEAD).take(n) {
            simd::prefetch(self.rows, place as usize);
        }
        for (to, place) in buffer.iter_mut().zip(&self.places[at..at + n]) {
            *to = self.rows[*place as usize];
        }
        buffer
    }

    #[inline(always)]
    fn swap<S: Simd>(&mut self, i: usize, j: usize) {
        self.places.swap(i, j);
    }

    #[inline(always)]
    fn shorten(&mut self, at: usize, t_max: f32) {
        self.rows[self.places[at] as usize][T_MAX] = t_max;
    }

    fn first(&self) -> &Row {
        &self.rows[self.places[0] as usize]
    }
}

/// The lanes of a mask that are on, of the first `n`.
#[inline(always)]
pub(super) fn bits<F: Float>(mask: F::Mask, n: usize) -> u32 {
    mask.bitmask() & ((1_u64 << n) - 1) as u32
}

/// Blocks that one thread loads at a time.
const PORTION: usize = 1024;

/// Puts a batch into rows, sixteen for each block. Returns the smallest and the largest start of the intervals.
pub(super) fn load_batch(blocks: &[RayBlock], level: Level, rows: &mut Vec<Row>) -> [f32; 2] {
    rows.resize(16 * blocks.len(), NONE);
    let portions = blocks.par_chunks(PORTION).zip(rows.par_chunks_mut(16 * PORTION)).enumerate();
    let loaded = portions
        .map(|(i, (blocks, rows))| lanes::run_long(level, Width::Auto, Load { blocks, first: 16 * PORTION * i, rows }));
    loaded.reduce(|| [f32::INFINITY, 0.0], |a, b| [a[0].min(b[0]), a[1].max(b[1])])
}
