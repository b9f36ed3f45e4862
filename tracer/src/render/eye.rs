//! Eye rays: pass one.

use super::Image;
use crate::geometry::{RayBatch, RayBlock};
use crate::lanes::{self, Lanes, Width};
use crate::model::Camera;
use crate::parallel;
use simd::{Block, Float, Level};

/// Rays from a pinhole camera through the pixels of an image.
///
/// A block of sixteen rays is a tile of 4x4 pixels in Z-order, so that a packet of 4 is 2x2 pixels, of 8 is 4x2 and of 16 is
/// 4x4. Tiles follow each other along a Z-curve as well: neighbours in the batch are neighbours in the image. Lanes outside
/// of the image are rays that hit nothing.
#[derive(Debug, Default)]
pub struct EyeRays {
    rays: RayBatch,
    width: usize,
    height: usize,
    /// Tile of each block.
    tiles: Vec<[u16; 2]>,
}

/// Pixel of each lane inside its tile.
pub(super) const LANE_X: [f32; 16] = [0., 1., 0., 1., 2., 3., 2., 3., 0., 1., 0., 1., 2., 3., 2., 3.];
pub(super) const LANE_Y: [f32; 16] = [0., 0., 1., 1., 0., 0., 1., 1., 2., 2., 3., 3., 2., 2., 3., 3.];

impl EyeRays {
    /// For an image of `width` x `height` pixels, at most 65,535 x 4 each way.
    #[must_use]
    pub fn new(camera: &Camera, width: usize, height: usize, level: Level, lanes: Width) -> Self {
        let tiles = z_curve(width.div_ceil(4), height.div_ceil(4));
        let view = camera.frame_vectors(width, height);
        let rays = RayBatch::from_origin(view.origin, 16 * tiles.len(), |blocks| {
            let generate = |_, tiles: &[[u16; 2]], blocks: &mut [RayBlock]| {
                let view = [view.corner, view.dx, view.dy];
                lanes::run_native(level, lanes, Generate { view, size: [width, height], tiles, blocks });
                Ok(())
            };
            let done = parallel::portions(parallel::PORTION, &tiles, blocks, generate, || (), |(), ()| ());
            debug_assert!(done.is_ok(), "nothing in it can fail");
        });
        Self { rays, width, height, tiles }
    }

    /// The rays: sixteen for each tile.
    #[must_use]
    pub fn rays(&self) -> &RayBatch {
        &self.rays
    }

    /// The rays of the pixels alone, row by row, as most programs make them.
    #[must_use]
    pub fn by_rows(&self) -> RayBatch {
        let mut blocks = vec![0; self.width.div_ceil(4) * self.height.div_ceil(4)];
        for (block, tile) in self.tiles.iter().enumerate() {
            blocks[usize::from(tile[1]) * self.width.div_ceil(4) + usize::from(tile[0])] = block;
        }
        let lane = |x: usize, y: usize| x & 1 | (y & 1) << 1 | (x & 2) << 1 | (y & 2) << 2;
        let pixels = (0..self.height).flat_map(|y| (0..self.width).map(move |x| (x, y)));
        let ray = |(x, y): (usize, usize)| 16 * blocks[y / 4 * self.width.div_ceil(4) + x / 4] + lane(x % 4, y % 4);
        pixels.map(|pixel| self.rays.get(ray(pixel))).collect()
    }

    /// The picture from the colours of all blocks.
    pub(crate) fn to_image(&self, colors: &[[Block<f32>; 3]]) -> Image {
        let mut pixels = vec![[0.0; 3]; self.width * self.height];
        for (tile, color) in self.tiles.iter().zip(colors) {
            for lane in 0..16 {
                let x = 4 * usize::from(tile[0]) + LANE_X[lane] as usize;
                let y = 4 * usize::from(tile[1]) + LANE_Y[lane] as usize;
                if x < self.width && y < self.height {
                    pixels[y * self.width + x] = [color[0].0[lane], color[1].0[lane], color[2].0[lane]];
                }
            }
        }
        Image { width: self.width, height: self.height, pixels }
    }
}

/// The cells of a grid along a Z-curve.
pub(super) fn z_curve(columns: usize, rows: usize) -> Vec<[u16; 2]> {
    let spread = |x: usize| (0..16).fold(0_u32, |z, bit| z | ((x >> bit & 1) as u32) << (2 * bit));
    let mut cells: Vec<_> = (0..rows).flat_map(|y| (0..columns).map(move |x| [x as u16, y as u16])).collect();
    cells.sort_by_cached_key(|&[x, y]| spread(x.into()) | spread(y.into()) << 1);
    cells
}

struct Generate<'a> {
    /// Direction of the first pixel, and the steps to its right and lower neighbours.
    view: [[f32; 3]; 3],
    size: [usize; 2],
    tiles: &'a [[u16; 2]],
    blocks: &'a mut [RayBlock],
}

impl Lanes for Generate<'_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let size = [F::splat(self.size[0] as f32), F::splat(self.size[1] as f32)];
        let (lane_x, lane_y) = (Block(LANE_X), Block(LANE_Y));
        let (zero, infinity) = (F::splat(0.0), F::splat(f32::INFINITY));
        for (block, chunk) in lanes::chunks::<F>(self.tiles.len()) {
            let (tile, block) = (self.tiles[block], &mut self.blocks[block]);
            let x = F::splat(4.0 * f32::from(tile[0])) + F::load_block(&lane_x, chunk);
            let y = F::splat(4.0 * f32::from(tile[1])) + F::load_block(&lane_y, chunk);
            for axis in 0..3 {
                let [corner, dx, dy] = [self.view[0][axis], self.view[1][axis], self.view[2][axis]];
                let d = F::splat(corner) + x * F::splat(dx) + y * F::splat(dy);
                d.store_block(&mut block.dir[axis], chunk);
            }
            let inside = x.lt(size[0]) & y.lt(size[1]);
            zero.store_block(&mut block.t_min, chunk);
            F::select(inside, infinity, -infinity).store_block(&mut block.t_max, chunk);
        }
    }
}
