//! Three vectors of lanes: points and directions of a packet of rays.

use simd::{Block, Float};
use std::ops::{Add, Mul, Sub};

/// A point or direction per lane.
#[derive(Debug, Clone, Copy)]
pub struct Vec3<F> {
    /// First coordinate.
    pub x: F,
    /// Second coordinate.
    pub y: F,
    /// Third coordinate.
    pub z: F,
}

impl<F: Float> Vec3<F> {
    /// The same point in every lane.
    #[inline(always)]
    pub fn splat([x, y, z]: [f32; 3]) -> Self {
        Self { x: F::splat(x), y: F::splat(y), z: F::splat(z) }
    }

    /// Group `chunk` of each of three blocks: see [`Vector::load_block`](simd::Vector::load_block).
    #[inline(always)]
    pub fn load(blocks: &[Block<f32>; 3], chunk: usize) -> Self {
        Self {
            x: F::load_block(&blocks[0], chunk),
            y: F::load_block(&blocks[1], chunk),
            z: F::load_block(&blocks[2], chunk),
        }
    }

    /// The inverse of [`Vec3::load`].
    #[inline(always)]
    pub fn store(self, blocks: &mut [Block<f32>; 3], chunk: usize) {
        self.x.store_block(&mut blocks[0], chunk);
        self.y.store_block(&mut blocks[1], chunk);
        self.z.store_block(&mut blocks[2], chunk);
    }

    /// `x x' + y y' + z z'`, rounded in this order, never fused.
    #[inline(always)]
    pub fn dot(self, o: Self) -> F {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    /// Cross product, each product rounded, never fused.
    #[inline(always)]
    pub fn cross(self, o: Self) -> Self {
        Self { x: self.y * o.z - self.z * o.y, y: self.z * o.x - self.x * o.z, z: self.x * o.y - self.y * o.x }
    }

    /// The smaller of each coordinate: see [`Vector::min`](simd::Vector::min).
    #[inline(always)]
    pub fn min(self, o: Self) -> Self {
        Self { x: self.x.min(o.x), y: self.y.min(o.y), z: self.z.min(o.z) }
    }

    /// The larger of each coordinate: see [`Vector::max`](simd::Vector::max).
    #[inline(always)]
    pub fn max(self, o: Self) -> Self {
        Self { x: self.x.max(o.x), y: self.y.max(o.y), z: self.z.max(o.z) }
    }

    /// Each coordinate times the lane's number.
    #[inline(always)]
    pub fn scale(self, s: F) -> Self {
        Self { x: self.x * s, y: self.y * s, z: self.z * s }
    }

    /// Scaled to length 1 (NaN for length 0).
    #[inline(always)]
    pub fn normalize(self) -> Self {
        self.scale(F::splat(1.0) / self.dot(self).sqrt())
    }

    /// Lane-wise choice.
    #[inline(always)]
    pub fn select(mask: F::Mask, a: Self, b: Self) -> Self {
        Self { x: F::select(mask, a.x, b.x), y: F::select(mask, a.y, b.y), z: F::select(mask, a.z, b.z) }
    }
}

impl<F: Float> Add for Vec3<F> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self { x: self.x + o.x, y: self.y + o.y, z: self.z + o.z }
    }
}

impl<F: Float> Sub for Vec3<F> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self { x: self.x - o.x, y: self.y - o.y, z: self.z - o.z }
    }
}

impl<F: Float> Mul for Vec3<F> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Self { x: self.x * o.x, y: self.y * o.y, z: self.z * o.z }
    }
}
