//! Eye rays through random places of pixels.

use super::Config;
use crate::geometry::{RayBatch, RayBlock};
use crate::lanes::{self, Lanes};
use crate::model::{Camera, FrameVectors};
use crate::parallel::{PORTION, portions};
use crate::render::Sampler;
use crate::render::eye::{LANE_X, LANE_Y, z_curve};
use simd::{Block, Float, Vector};

/// A part of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crop {
    /// Column of its first pixel.
    pub x: usize,
    /// Row of its first pixel.
    pub y: usize,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl Crop {
    /// The number of a pixel of [`pixels`] in the part, row by row.
    pub(super) fn place(&self, pixel: u32) -> usize {
        ((pixel >> 16) as usize - self.y) * self.width + (pixel & 0xffff) as usize - self.x
    }
}

/// The pixels of a part in the order of rays: tiles of 4x4 along a Z-curve, pixels along one in each. The row is in the upper sixteen bits of
/// each, the column in the lower ones, counted from the whole picture's corner.
pub(super) fn pixels(crop: &Crop) -> Vec<u32> {
    let tiles = z_curve(crop.width.div_ceil(4), crop.height.div_ceil(4));
    let mut pixels = Vec::with_capacity(crop.width * crop.height);
    for tile in tiles {
        for lane in 0..16 {
            let x = 4 * usize::from(tile[0]) + LANE_X[lane] as usize;
            let y = 4 * usize::from(tile[1]) + LANE_Y[lane] as usize;
            if x < crop.width && y < crop.height {
                pixels.push(((crop.y + y) << 16 | (crop.x + x)) as u32);
            }
        }
    }
    pixels
}

/// A ray through each of these pixels, at a place that depends on the pixel and the sample; of a single sample, through the middle.
pub(super) fn rays(config: &Config, camera: &Camera, pixels: &[u32], sample: u32) -> RayBatch {
    let view = camera.frame_vectors(config.width, config.height);
    let blocks: Vec<Block<u32>> = pixels
        .chunks(16)
        .map(|chunk| {
            let mut block = Block::default();
            block.0[..chunk.len()].copy_from_slice(chunk);
            block
        })
        .collect();
    RayBatch::from_origin(view.origin, pixels.len(), |rays| {
        let generate = |_, pixels: &[Block<u32>], rays: &mut [RayBlock]| {
            let sampler = (config.samples > 1).then(|| Sampler::new(config.seed));
            lanes::run_native(config.level, config.lanes, Generate { view: &view, sampler, sample, pixels, rays });
            Ok(())
        };
        let done = portions(PORTION, &blocks, rays, generate, || (), |(), ()| ());
        debug_assert!(done.is_ok(), "nothing in it can fail");
    })
}

struct Generate<'a> {
    view: &'a FrameVectors,
    sampler: Option<Sampler>,
    sample: u32,
    pixels: &'a [Block<u32>],
    rays: &'a mut [RayBlock],
}

impl Lanes for Generate<'_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let half = F::splat(0.5);
        for (block, chunk) in lanes::chunks::<F>(self.pixels.len()) {
            let pixel = F::Index::load_block(&self.pixels[block], chunk);
            let mut x = F::from_uint(pixel & F::Index::splat(0xffff));
            let mut y = F::from_uint(pixel >> 16);
            if let Some(sampler) = self.sampler {
                let [dx, dy] = sampler.pair::<F>(pixel, self.sample, 0);
                (x, y) = (x + (dx - half), y + (dy - half));
            }
            let rays = &mut self.rays[block];
            for axis in 0..3 {
                let [corner, dx, dy] = [self.view.corner[axis], self.view.dx[axis], self.view.dy[axis]];
                let d = F::splat(corner) + x * F::splat(dx) + y * F::splat(dy);
                d.store_block(&mut rays.dir[axis], chunk);
            }
            F::splat(0.0).store_block(&mut rays.t_min, chunk);
            F::splat(f32::INFINITY).store_block(&mut rays.t_max, chunk);
        }
    }
}
