//! Rays of an image, row by row, taken in tiles of 16 x 16 pixels: rays that lie side by side in both directions share more.

use super::tile::Tile;
use crate::geometry::{RayBatch, RayBlock, Vec3};
use crate::method::query::Query;
use simd::{Float, Simd};

/// Rays in a row, if the batch looks like an image: all start at one point, and at equal distances the direction jumps. It is a
/// guess; a wrong one costs time alone.
pub(super) fn row_length(rays: &RayBatch) -> Option<usize> {
    rays.origin()?;
    let direction = |i: usize| {
        let (block, lane) = (&rays.blocks()[i / 16], i % 16);
        [block.dir[0].0[lane], block.dir[1].0[lane], block.dir[2].0[lane]]
    };
    let step = |i: usize, k: usize| {
        let (a, b) = (direction(i), direction(k));
        (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f32>()
    };
    // In a row, neighbours differ by about the same; its end is a jump back, to below where it began.
    let usual = step(0, 1.min(rays.len() - 1));
    let jump = |i: usize| step(i - 1, i) > 64.0 * usual;
    let row = (16..=rays.len() / 2).find(|&i| jump(i))?;
    let is_row = |start: usize| jump(start) && step(start, start - row) < 64.0 * usual;
    let plausible = usual > 0.0 && row < 1 << 20 && (1..rays.len() / row).all(|y| is_row(y * row));
    plausible.then_some(row)
}

/// Runs of four rays of a tile: block, lane, and the number of the first ray among the portion's.
#[inline(always)]
fn runs(row: usize, x: usize) -> impl Iterator<Item = (usize, usize, usize)> {
    (0..64).filter_map(move |run| {
        let (block, quarter) = (run / 4, run % 4);
        let (column, line) = (x + block % 4 * 4, block / 4 * 4 + quarter);
        (column < row).then_some((block, 4 * quarter, line * row + column))
    })
}

/// The tile whose left column is `x`, from a portion of sixteen rows.
#[inline(always)]
pub(super) fn gather<S: Simd, Q: Query>(rays: &[RayBlock], row: usize, x: usize, tile: &mut Tile<Q>) {
    let mut blocks = [const { RayBlock::NONE }; 16];
    for (block, lane, ray) in runs(row, x) {
        let to = &mut blocks[block];
        if row.is_multiple_of(4) {
            if let Some(from) = rays.get(ray / 16) {
                copy::<S::Float4>(from, ray % 16 / 4, to, lane / 4);
            }
        } else {
            for i in 0..4.min(row - ray % row) {
                if let Some(from) = rays.get((ray + i) / 16) {
                    copy::<f32>(from, (ray + i) % 16, to, lane + i);
                }
            }
        }
    }
    for (ready, block) in tile.rays.iter_mut().zip(&blocks) {
        ready.set::<S::Float>(block, tile.largest);
    }
}

#[inline(always)]
fn copy<F: Float>(from: &RayBlock, i: usize, to: &mut RayBlock, k: usize) {
    Vec3::<F>::load(&from.org, i).store(&mut to.org, k);
    Vec3::<F>::load(&from.dir, i).store(&mut to.dir, k);
    F::load_block(&from.t_min, i).store_block(&mut to.t_min, k);
    F::load_block(&from.t_max, i).store_block(&mut to.t_max, k);
}

/// What was found for the tile, to where its rays came from.
#[inline(always)]
pub(super) fn scatter<S: Simd, Q: Query>(tile: &Tile<Q>, row: usize, x: usize, results: &mut [Q::Block]) {
    for (block, lane, ray) in runs(row, x) {
        let from = &tile.found[block];
        if row.is_multiple_of(4) {
            if let Some(to) = results.get_mut(ray / 16) {
                Q::copy::<S::Float4>((from, lane / 4), (to, ray % 16 / 4));
            }
        } else {
            for i in 0..4.min(row - ray % row) {
                if let Some(to) = results.get_mut((ray + i) / 16) {
                    Q::copy::<f32>((from, lane + i), (to, (ray + i) % 16));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::row_length;
    use crate::geometry::{Ray, RayBatch};

    fn picture(width: usize, height: usize, unit: bool) -> RayBatch {
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x as f32, y as f32)));
        pixels
            .map(|(x, y)| {
                let d = [(x + 0.5) / width as f32 - 0.5, (y + 0.5) / width as f32 - 0.5, 0.6];
                let length = if unit { d.iter().map(|d| d * d).sum::<f32>().sqrt() } else { 1.0 };
                Ray::new([1.0, 2.0, 3.0], d.map(|d| d / length))
            })
            .collect()
    }

    #[test]
    fn rows_are_seen() {
        for unit in [false, true] {
            for (width, height) in [(64, 64), (100, 33), (37, 8), (1024, 2)] {
                assert_eq!(row_length(&picture(width, height, unit)), Some(width), "{width} x {height}, {unit}");
            }
        }
    }

    #[test]
    fn what_is_no_picture_is_left_alone() {
        assert_eq!(row_length(&picture(64, 1, false)), None);
        assert_eq!(row_length(&picture(8, 64, false)), None);
        assert_eq!(row_length(&RayBatch::new()), None);
        assert_eq!(row_length(&[Ray::new([0.0; 3], [0.0, 0.0, 1.0]); 100].into_iter().collect()), None);
        let mut random = (0..1000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 8) as f32 / 16_777_216.0 - 0.5);
        let mut next = || random.next().unwrap_or_default();
        let rays: RayBatch = (0..300).map(|_| Ray::new([0.0; 3], [next(), next(), next()])).collect();
        assert_eq!(row_length(&rays), None);
    }
}
