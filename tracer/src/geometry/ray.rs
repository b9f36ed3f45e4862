//! Rays: one, a batch in structure-of-arrays blocks, and a packet as kernels see it.

use super::Vec3;
use simd::{Block, Float, Mask};

/// A ray and the interval of it that counts, both ends included. `t` is in units of the direction's length, which need not be 1.
///
/// What unusual numbers mean, on every level alike:
/// - a direction component below `f32::MIN_POSITIVE` in magnitude (zero, denormal) is zero of its sign;
/// - directions shorter than about 1e-30 lose accuracy, for a box sees the smallest normal number where a component is zero; a triangle
///   is not hit where the determinant (its edges' cross product times the direction) is no normal number, overflown say;
/// - `t_min` below 0 is 0; an empty interval hits nothing; `t_max` may be infinite;
/// - a ray hits nothing if its origin or direction has a NaN or infinite component, if all of its direction is zero, or if
///   an end of the interval is NaN.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Ray {
    /// Origin.
    pub org: [f32; 3],
    /// Smallest `t` that counts.
    pub t_min: f32,
    /// Direction, of any length.
    pub dir: [f32; 3],
    /// Largest `t` that counts.
    pub t_max: f32,
}

impl Ray {
    /// All of the ray from `t = 0` on.
    #[must_use]
    pub const fn new(org: [f32; 3], dir: [f32; 3]) -> Self {
        Self { org, t_min: 0.0, dir, t_max: f32::INFINITY }
    }

    /// A ray that hits nothing: fills the last block of a batch.
    const NONE: Self = Self { org: [0.0; 3], t_min: f32::INFINITY, dir: [1.0; 3], t_max: f32::NEG_INFINITY };
}

/// Sixteen rays.
#[derive(Debug, Clone)]
#[repr(C)]
pub struct RayBlock {
    /// Origins, by coordinate.
    pub org: [Block<f32>; 3],
    /// Directions, by coordinate.
    pub dir: [Block<f32>; 3],
    /// Interval starts.
    pub t_min: Block<f32>,
    /// Interval ends.
    pub t_max: Block<f32>,
}

impl RayBlock {
    /// Sixteen rays that hit nothing.
    pub const NONE: Self = Self {
        org: [Block([Ray::NONE.org[0]; 16]); 3],
        dir: [Block([Ray::NONE.dir[0]; 16]); 3],
        t_min: Block([Ray::NONE.t_min; 16]),
        t_max: Block([Ray::NONE.t_max; 16]),
    };

    /// Puts a ray into a lane.
    #[inline]
    pub(crate) fn set(&mut self, lane: usize, ray: &Ray) {
        for axis in 0..3 {
            self.org[axis].0[lane] = ray.org[axis];
            self.dir[axis].0[lane] = ray.dir[axis];
        }
        self.t_min.0[lane] = ray.t_min;
        self.t_max.0[lane] = ray.t_max;
    }

    /// The ray of a lane.
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> Ray {
        Ray {
            org: [self.org[0].0[lane], self.org[1].0[lane], self.org[2].0[lane]],
            t_min: self.t_min.0[lane],
            dir: [self.dir[0].0[lane], self.dir[1].0[lane], self.dir[2].0[lane]],
            t_max: self.t_max.0[lane],
        }
    }
}

/// Any number of rays in blocks of sixteen, structure of arrays.
///
/// It remembers whether all rays start at one point, as eye rays and shadow rays to a point light do: methods use that.
#[derive(Debug, Clone, Default)]
pub struct RayBatch {
    blocks: Vec<RayBlock>,
    len: usize,
    origin: Option<[f32; 3]>,
}

impl RayBatch {
    /// No rays.
    #[must_use]
    pub const fn new() -> Self {
        Self { blocks: Vec::new(), len: 0, origin: None }
    }

    /// Number of rays.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.len
    }

    /// True when there are none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The point where all rays start, if it is one and the same.
    #[must_use]
    pub const fn origin(&self) -> Option<[f32; 3]> {
        self.origin
    }

    /// The rays, sixteen at a time; the last block is filled with rays that hit nothing.
    #[must_use]
    pub fn blocks(&self) -> &[RayBlock] {
        &self.blocks
    }

    /// Appends a ray.
    #[inline]
    pub fn push(&mut self, ray: Ray) {
        let lane = self.len % 16;
        if lane == 0 {
            self.blocks.push(RayBlock::NONE);
        }
        if let Some(block) = self.blocks.last_mut() {
            block.set(lane, &ray);
        }
        self.origin = match self.origin {
            _ if self.len == 0 => Some(ray.org),
            Some(origin) if same_bits(origin, ray.org) => Some(origin),
            _ => None,
        };
        self.len += 1;
    }

    /// Appends rays that lie in arrays, one for each number: origins, directions, starts and ends of intervals.
    ///
    /// # Panics
    /// If the arrays differ in length.
    pub fn extend_from_arrays(&mut self, org: [&[f32]; 3], dir: [&[f32]; 3], t_min: &[f32], t_max: &[f32]) {
        let len = t_min.len();
        assert!(
            org.iter().chain(&dir).all(|v| v.len() == len) && t_max.len() == len,
            "arrays of one length: {len} starts, {} ends",
            t_max.len()
        );
        self.blocks.reserve(len.div_ceil(16));
        let mut i = 0;
        // Ray by ray up to the end of the last block, then block by block.
        while i < len {
            if !self.len.is_multiple_of(16) || len - i < 16 {
                let at = |v: [&[f32]; 3]| [v[0][i], v[1][i], v[2][i]];
                self.push(Ray { org: at(org), t_min: t_min[i], dir: at(dir), t_max: t_max[i] });
                i += 1;
                continue;
            }
            let sixteen = |v: &[f32]| Block(v[i..].first_chunk().copied().unwrap_or([0.0; 16]));
            let columns = |v: [&[f32]; 3]| [sixteen(v[0]), sixteen(v[1]), sixteen(v[2])];
            let org = columns(org);
            let first = [org[0].0[0], org[1].0[0], org[2].0[0]];
            let same = |axis: usize| org[axis].0.iter().fold(0, |d, x| d | (x.to_bits() ^ first[axis].to_bits())) == 0;
            let origin = if self.len == 0 { Some(first) } else { self.origin };
            self.origin = origin.filter(|&o| same_bits(o, first) && same(0) && same(1) && same(2));
            self.blocks.push(RayBlock { org, dir: columns(dir), t_min: sixteen(t_min), t_max: sixteen(t_max) });
            self.len += 16;
            i += 16;
        }
    }

    /// Removes all rays and keeps the memory.
    pub fn clear(&mut self) {
        self.blocks.clear();
        self.len = 0;
        self.origin = None;
    }

    /// Ray number `i`.
    ///
    /// # Panics
    /// If `i >= len()`.
    #[must_use]
    pub fn get(&self, i: usize) -> Ray {
        assert!(i < self.len, "ray {i} of {}", self.len);
        self.blocks[i / 16].get(i % 16)
    }

    /// The rays in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Ray> + '_ {
        (0..self.len).map(|i| self.get(i))
    }

    /// `len` places to write rays to, of which it is known whether they start at one point: what they held is left. Lanes past `len` are to be turned off
    /// afterwards, by [`RayBatch::turn_off_rest`].
    pub(crate) fn resize(&mut self, len: usize, origin: Option<[f32; 3]>) -> &mut [RayBlock] {
        (self.len, self.origin) = (len, origin);
        self.blocks.resize(len.div_ceil(16), RayBlock::NONE);
        &mut self.blocks
    }

    /// Makes the lanes past the last ray rays that hit nothing.
    pub(crate) fn turn_off_rest(&mut self) {
        let used = (self.len + 15) % 16 + 1;
        for lane in if self.len > 0 { used..16 } else { 0..0 } {
            if let Some(last) = self.blocks.last_mut() {
                last.set(lane, &Ray::NONE);
            }
        }
    }

    /// A batch of `len` rays from one point, whose blocks `fill` will write: the number of the block and the block.
    ///
    /// `fill` sets directions and intervals; origins are set already. Lanes past `len` are turned off afterwards.
    pub(crate) fn from_origin(origin: [f32; 3], len: usize, fill: impl FnOnce(&mut [RayBlock])) -> Self {
        let mut block = RayBlock::NONE;
        block.org = origin.map(|x| Block([x; 16]));
        let mut blocks = vec![block; len.div_ceil(16)];
        fill(&mut blocks);
        if let Some(last) = blocks.last_mut() {
            for lane in (len - 1) % 16 + 1..16 {
                last.t_min.0[lane] = Ray::NONE.t_min;
                last.t_max.0[lane] = Ray::NONE.t_max;
            }
        }
        Self { blocks, len, origin: (len > 0).then_some(origin) }
    }
}

impl FromIterator<Ray> for RayBatch {
    fn from_iter<I: IntoIterator<Item = Ray>>(rays: I) -> Self {
        let mut batch = Self::new();
        batch.extend(rays);
        batch
    }
}

impl Extend<Ray> for RayBatch {
    fn extend<I: IntoIterator<Item = Ray>>(&mut self, rays: I) {
        rays.into_iter().for_each(|ray| self.push(ray));
    }
}

#[inline(always)]
fn same_bits([a, b, c]: [f32; 3], [x, y, z]: [f32; 3]) -> bool {
    a.to_bits() == x.to_bits() && b.to_bits() == y.to_bits() && c.to_bits() == z.to_bits()
}

/// A ray per lane, made ready for traversal: cleaned as [`Ray`] says, with reciprocals.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Packet<F: Float> {
    pub(crate) org: Vec3<F>,
    pub(crate) dir: Vec3<F>,
    /// 1 / direction, finite: zero components count as the smallest normal number of their sign.
    pub(crate) inv_dir: Vec3<F>,
    /// [`Packet::inv_dir`] times [`Packet::PAD`], for the far ends of intervals.
    pub(crate) inv_dir_far: Vec3<F>,
    pub(crate) t_min: F,
    pub(crate) t_max: F,
    /// Lanes whose ray can hit something.
    pub(crate) valid: F::Mask,
}

impl<F: Float> Packet<F> {
    /// At least 1 + 2 gamma(3): what the far end of a slab interval must be padded by so that rounding cannot make a ray miss
    /// a box it meets (Ize 2013, section 3.3); 4 ulp, one of them for the rounding of [`Packet::inv_dir_far`].
    pub(crate) const PAD: f32 = 1.0 + 4.0 * f32::EPSILON;

    /// Lanes `chunk * LANES ..` of a block.
    #[inline(always)]
    pub(crate) fn load(block: &RayBlock, chunk: usize) -> Self {
        let (t_min, t_max) = (F::load_block(&block.t_min, chunk), F::load_block(&block.t_max, chunk));
        Self::new(Vec3::load(&block.org, chunk), Vec3::load(&block.dir, chunk), t_min, t_max)
    }

    /// Cleans rays and makes them ready.
    #[inline(always)]
    fn new(org: Vec3<F>, dir: Vec3<F>, t_min: F, t_max: F) -> Self {
        let zero = F::splat(0.0);

        let dir = Vec3 { x: flush(dir.x), y: flush(dir.y), z: flush(dir.z) };
        let moves = dir.x.ne(zero) | dir.y.ne(zero) | dir.z.ne(zero);
        let valid = finite(org) & finite(dir) & moves & t_min.le(t_max);

        let dir = Vec3::select(valid, dir, Vec3::splat(Ray::NONE.dir));
        let inv_dir = Vec3 { x: reciprocal(dir.x), y: reciprocal(dir.y), z: reciprocal(dir.z) };
        Self {
            org: Vec3::select(valid, org, Vec3::splat(Ray::NONE.org)),
            dir,
            inv_dir,
            inv_dir_far: inv_dir.scale(F::splat(Self::PAD)),
            t_min: F::select(valid, t_min.max(zero), F::splat(Ray::NONE.t_min)),
            t_max: F::select(valid, t_max, F::splat(Ray::NONE.t_max)),
            valid,
        }
    }

    /// Of rays that were cleaned before, all of them valid.
    #[inline(always)]
    pub(crate) fn of_clean(org: Vec3<F>, dir: Vec3<F>, t_min: F, t_max: F) -> Self {
        let inv_dir = Vec3 { x: reciprocal(dir.x), y: reciprocal(dir.y), z: reciprocal(dir.z) };
        let inv_dir_far = inv_dir.scale(F::splat(Self::PAD));
        Self { org, dir, inv_dir, inv_dir_far, t_min, t_max, valid: F::Mask::splat(true) }
    }

    /// Signs of the directions: per axis, which lanes are negative.
    #[inline(always)]
    pub(crate) fn signs(&self) -> [F::Mask; 3] {
        let zero = F::splat(0.0);
        [self.inv_dir.x.lt(zero), self.inv_dir.y.lt(zero), self.inv_dir.z.lt(zero)]
    }

    /// The packet with only the lanes of `mask` on.
    #[inline(always)]
    pub(crate) fn only(&self, mask: F::Mask) -> Self {
        Self { t_min: F::select(mask, self.t_min, F::splat(Ray::NONE.t_min)), ..*self }
    }
}

impl Packet<f32> {
    /// One ray.
    #[inline(always)]
    pub(crate) fn of(ray: &Ray) -> Self {
        let vec3 = |[x, y, z]: [f32; 3]| Vec3 { x, y, z };
        Self::new(vec3(ray.org), vec3(ray.dir), ray.t_min, ray.t_max)
    }

    /// The ray in every lane.
    #[inline(always)]
    pub(crate) fn splat<F: Float>(&self) -> Packet<F> {
        let all = |v: Vec3<f32>| Vec3::splat([v.x, v.y, v.z]);
        Packet {
            org: all(self.org),
            dir: all(self.dir),
            inv_dir: all(self.inv_dir),
            inv_dir_far: all(self.inv_dir_far),
            t_min: F::splat(self.t_min),
            t_max: F::splat(self.t_max),
            valid: F::Mask::splat(self.valid),
        }
    }
}

/// Zero of the same sign for what is below the smallest normal number.
#[inline(always)]
fn flush<F: Float>(d: F) -> F {
    F::select(d.abs().lt(F::splat(f32::MIN_POSITIVE)), F::splat(0.0).copysign(d), d)
}

#[inline(always)]
fn finite<F: Float>(v: Vec3<F>) -> F::Mask {
    let infinity = F::splat(f32::INFINITY);
    v.x.abs().lt(infinity) & v.y.abs().lt(infinity) & v.z.abs().lt(infinity)
}

/// 1 / d, with the smallest normal number in place of zero: 0 * inf never appears in a box test.
#[inline(always)]
fn reciprocal<F: Float>(d: F) -> F {
    let tiny = F::splat(f32::MIN_POSITIVE).copysign(d);
    F::splat(1.0) / F::select(d.eq(F::splat(0.0)), tiny, d)
}
