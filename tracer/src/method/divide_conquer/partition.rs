//! Triangles to the two sides of a plane (section 3.2): through the middle of their boxes' centers, or where the surface area heuristic says.

use crate::bvh::build::primitive::Box8;
use simd::{Halves, Simd, Vector, kernel};

/// Some of the triangles: a range of ids, with what is known of their boxes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Range {
    pub(super) first: usize,
    pub(super) end: usize,
    /// Around all boxes.
    pub(super) bounds: Box8,
    /// Around all boxes' centers, times two.
    pub(super) centers: Box8,
}

impl Range {
    /// The same in a slice of its own ids.
    pub(super) fn alone(self) -> Self {
        Self { first: 0, end: self.len(), ..self }
    }

    /// Number of triangles.
    pub(super) fn len(&self) -> usize {
        self.end - self.first
    }

    /// Of the box: `min x y z _ max x y z _`.
    pub(super) fn planes(&self) -> [f32; 8] {
        let b = self.bounds.aabb();
        [b.min[0], b.min[1], b.min[2], 0.0, b.max[0], b.max[1], b.max[2], 0.0]
    }
}

/// How to divide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Way {
    /// Where the middle of the centers is.
    Middle,
    /// Where rays are expected to be done soonest; a box test costs this many triangle tests.
    Sah(f32),
}

/// Bins of the surface area heuristic: as many as the paper has.
const BINS: usize = 32;

/// The surface area heuristic may leave as many triangles as this undivided.
const LARGE_LEAF: u32 = 64;

/// Boxes are asked for so many places ahead: ids are in no order that memory likes.
const AHEAD: usize = 16;

/// Maps centers to bins, along the axis on which they lie farthest apart.
struct Grid {
    axis: usize,
    origin: f32,
    scale: f32,
}

impl Grid {
    /// `None` where centers do not differ.
    fn new(centers: &Box8) -> Option<Self> {
        let (x, y, z) = (centers.extent(0), centers.extent(1), centers.extent(2));
        let axis = if x >= y && x >= z {
            0
        } else if y >= z {
            1
        } else {
            2
        };
        let scale = BINS as f32 / centers.extent(axis);
        // Not for what is too close or too far apart for a finite scale above 0.
        (scale > 0.0 && scale < f32::INFINITY).then_some(Self { axis, origin: centers.0[axis], scale })
    }

    /// Where the center of a box is, in bins.
    #[inline(always)]
    fn place(&self, b: &Box8) -> f32 {
        (b.0[self.axis] - b.0[4 + self.axis] - self.origin) * self.scale
    }
}

kernel! {
    /// Sorts the ids of a range to two sides, and returns both. `None` when they are not to be divided, or cannot be.
    pub(super) fn divide<S>(ids: &mut [u32], boxes: &[Box8], range: &Range, way: Way) -> Option<[Range; 2]> {
        let grid = Grid::new(&range.centers)?;
        let ids = &mut ids[range.first..range.end];
        let plane = match way {
            Way::Middle => BINS as f32 / 2.0,
            Way::Sah(box_cost) => best_plane::<S>(ids, boxes, &grid, &range.bounds, box_cost)?,
        };
        let (below, [left, right]) = move_below::<S>(ids, boxes, &grid, plane);
        if below == 0 || below == ids.len() {
            return None;
        }
        let middle = range.first + below;
        let side = |first, end, [bounds, centers]: [Box8; 2]| Range { first, end, bounds, centers };
        Some([side(range.first, middle, left), side(middle, range.end, right)])
    }
}

/// Boxes and centers of both sides grow on the way.
#[inline(always)]
fn move_below<S: Simd>(ids: &mut [u32], boxes: &[Box8], grid: &Grid, plane: f32) -> (usize, [[Box8; 2]; 2]) {
    let infinity = S::Float8::splat(f32::INFINITY);
    let [mut left, mut left_centers, mut right, mut right_centers] = [infinity; 4];
    let mut below = 0;
    for i in 0..ids.len() {
        if let Some(&later) = ids.get(i + AHEAD) {
            simd::prefetch(boxes, later as usize);
        }
        let id = ids[i];
        let b = &boxes[id as usize];
        let is_below = grid.place(b) < plane;
        let corners = b.load::<S>();
        let center = corners.low() - corners.high();
        let centers = S::Float8::from_halves(center, -center);
        // Of the other side, a box that is empty: no branch to foresee.
        let [to_left, to_right] =
            [[f32::INFINITY, f32::NEG_INFINITY], [f32::NEG_INFINITY, f32::INFINITY]][usize::from(is_below)];
        let (to_left, to_right) = (S::Float8::splat(to_left), S::Float8::splat(to_right));
        left = left.min(corners.max(to_left));
        left_centers = left_centers.min(centers.max(to_left));
        right = right.min(corners.max(to_right));
        right_centers = right_centers.min(centers.max(to_right));
        ids[i] = ids[below];
        ids[below] = id;
        below += usize::from(is_below);
    }
    let mut sides = [[Box8::EMPTY; 2]; 2];
    sides[0][0].store::<S>(left);
    sides[0][1].store::<S>(left_centers);
    sides[1][0].store::<S>(right);
    sides[1][1].store::<S>(right_centers);
    (below, sides)
}

/// The plane between two bins for which the expected cost is least; `None` when not dividing at all costs less.
#[inline(always)]
fn best_plane<S: Simd>(ids: &[u32], boxes: &[Box8], grid: &Grid, bounds: &Box8, box_cost: f32) -> Option<f32> {
    let (mut bins, mut counts) = ([Box8::EMPTY; BINS], [0_u32; BINS]);
    for &id in ids {
        let b = &boxes[id as usize];
        let bin = grid.place(b) as usize % 64;
        // The one on the upper border.
        let bin = if bin < BINS { bin } else { BINS - 1 };
        bins[bin].store::<S>(bins[bin].load::<S>().min(b.load::<S>()));
        counts[bin] += 1;
    }
    let mut costs = [0.0; BINS];
    let (mut all, mut n) = (S::Float8::splat(f32::INFINITY), 0);
    for bin in 0..BINS - 1 {
        all = all.min(bins[bin].load::<S>());
        n += counts[bin];
        costs[bin + 1] = cost::<S>(all, n);
    }
    let (mut best, mut plane) = (f32::INFINITY, 0);
    (all, n) = (S::Float8::splat(f32::INFINITY), 0);
    let total = ids.len() as u32;
    for bin in (1..BINS).rev() {
        all = all.min(bins[bin].load::<S>());
        n += counts[bin];
        let both = costs[bin] + cost::<S>(all, n);
        if n != 0 && n != total && both < best {
            (best, plane) = (both, bin);
        }
    }
    // Many are divided whatever it costs, and where the areas are no numbers.
    let stays = bounds.half_area() * (total as f32 - 2.0 * box_cost);
    if total > LARGE_LEAF && !(plane != 0 && best < stays) {
        return Some(BINS as f32 / 2.0);
    }
    if plane != 0 && best < stays { Some(plane as f32) } else { None }
}

/// Area times number, 0 where there is nothing.
#[inline(always)]
fn cost<S: Simd>(b: S::Float8, n: u32) -> f32 {
    let size = -b.high() - b.low();
    let area = size.lane(0) * (size.lane(1) + size.lane(2)) + size.lane(1) * size.lane(2);
    if n == 0 { 0.0 } else { area * n as f32 }
}
