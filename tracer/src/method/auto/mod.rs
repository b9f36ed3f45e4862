//! Rays of any kind, in any order: what they have in common is seen, not asked for.

mod bounds;
mod image;
mod node;
mod tile;

use super::query::{Any, Closest, Query};
use super::{BitVec, Context, Method, PORTION, in_portions};
use crate::Error;
use crate::bvh::WideBvh;
use crate::geometry::{HitBatch, RayBatch, RayBlock};
use crate::lanes::is_serial;
use crate::stats::{Count, Counters, NoCount};
use simd::{Kernel, Level, Simd};
use tile::{BLOCKS, Tile};

/// When rays part. Whatever the limits, the hits are the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Blocks of sixteen rays are traced together if their directions differ by less: the cosine of the angle.
    pub together: f32,
    /// The rays of a block are traced with one box around them if their directions differ by less: the cosine of the angle.
    pub coherent: f32,
    /// Where as many blocks or fewer go on together, each goes on alone.
    pub blocks: u32,
    /// Where as many rays of a coherent block or fewer go on, each goes on alone.
    pub rays: u32,
    /// The same for the closest hits of a block that is not coherent.
    pub mixed_closest: u32,
    /// The same for whether such a block hits anything.
    pub mixed_any: u32,
    /// Rays that are not coherent are traced alone from the start if the box around the origins of a block is larger than this
    /// part of the scene (sums of the sides), and blocks are not traced together if that of one of them is.
    pub scatter: f32,
    /// The same for the closest hits of coherent blocks.
    pub apart: f32,
}

impl Default for Limits {
    /// What was fastest.
    fn default() -> Self {
        Self {
            together: 0.97,
            coherent: 0.9,
            blocks: 3,
            rays: 4,
            mixed_closest: 10,
            mixed_any: 4,
            scatter: 0.05,
            apart: 0.15,
        }
    }
}

/// Any rays through a [`WideBvh`]: 256 together while they agree (for closest hits), 16 while those do, the others alone.
///
/// A batch of rays that looks like an image (one origin, rows of equal length) is traced in tiles of 16 x 16 pixels.
#[derive(Debug, Clone, Copy)]
pub struct Auto<'a> {
    bvh: &'a WideBvh<8>,
    level: Level,
    limits: Limits,
}

impl<'a> Auto<'a> {
    /// Over a tree, at a level.
    #[must_use]
    pub fn new(bvh: &'a WideBvh<8>, level: Level) -> Self {
        Self { bvh, level, limits: Limits::default() }
    }

    /// With other limits.
    #[must_use]
    pub fn with_limits(self, limits: Limits) -> Self {
        Self { limits, ..self }
    }

    fn find<Q: Query>(&self, rays: &RayBatch, results: &mut [Q::Block], cx: &mut Context<'_>) -> Result<(), Error> {
        let row = image::row_length(rays);
        // Sixteen rows of an image are as many blocks as a row has rays.
        in_portions(row.unwrap_or(PORTION), rays, results, cx, |count, rays, results| {
            let Self { bvh, limits, .. } = *self;
            if count {
                // The work is the same at every level.
                Level::run_native(Trace::<Q, _> { bvh, limits, row, rays, results, count: Counters::default() })
            } else {
                self.level.run(Trace::<Q, _> { bvh, limits, row, rays, results, count: NoCount })
            }
        })
    }
}

impl Method for Auto<'_> {
    fn name(&self) -> &'static str {
        "auto"
    }

    fn source(&self) -> &'static str {
        "Boulos, Wald and Benthin 2008, section 3; Wald, Benthin and Boulos 2008"
    }

    fn memory(&self) -> usize {
        0
    }

    fn closest(&self, rays: &RayBatch, hits: &mut HitBatch, cx: &mut Context<'_>) -> Result<(), Error> {
        self.find::<Closest>(rays, hits.resize(rays.len()), cx)
    }

    fn any(&self, rays: &RayBatch, occluded: &mut BitVec, cx: &mut Context<'_>) -> Result<(), Error> {
        self.find::<Any>(rays, occluded.resize(rays.len()), cx)
    }
}

/// A portion of rays through the tree.
struct Trace<'a, Q: Query, C> {
    bvh: &'a WideBvh<8>,
    limits: Limits,
    /// How many rays a row of an image has.
    row: Option<usize>,
    rays: &'a [RayBlock],
    results: &'a mut [Q::Block],
    count: C,
}

impl<Q: Query, C: Count> Kernel for Trace<'_, Q, C> {
    type Output = Counters;

    #[inline(always)]
    fn run<S: Simd>(mut self) -> Counters {
        if const { is_serial::<S>() } {
            return Level::SCALAR.run(self);
        }
        let mut tile = Tile::<Q>::new(self.bvh, self.limits, self.row.is_some());
        let tiles = self.row.map_or(self.rays.len().div_ceil(BLOCKS), |row| row.div_ceil(16));
        if self.row.is_some() {
            self.results.fill(Q::NOTHING);
        }
        for number in 0..tiles {
            match self.row {
                Some(row) => image::gather::<S, Q>(self.rays, row, 16 * number, &mut tile),
                None => {
                    let rays = &self.rays[number * BLOCKS..];
                    for block in 0..BLOCKS {
                        tile.set::<S::Float>(block, rays.get(block).unwrap_or(&RayBlock::NONE));
                    }
                }
            }
            tile.trace::<S, C>(self.bvh, &mut self.count);
            match self.row {
                Some(row) => image::scatter::<S, Q>(&tile, row, 16 * number, self.results),
                None => {
                    for (to, from) in self.results[number * BLOCKS..].iter_mut().zip(&tile.found) {
                        to.clone_from(from);
                    }
                }
            }
        }
        self.count.total()
    }
}
