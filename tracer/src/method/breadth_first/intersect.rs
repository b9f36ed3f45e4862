//! Localized intersection (Garanzha & Loop 2010, section 3.4): packets are taken apart into groups of as many rays as a vector has lanes, and each group
//! goes through the leaves that its frustum captured.

use super::build::Frusta;
use super::leaves::Leaves;
use crate::bvh::{Bvh, OctoBvh, OctoNode};
use crate::geometry::frustum::{Frustum, Space};
use crate::geometry::moller_trumbore;
use crate::geometry::slab::{self, Near, PerRay};
use crate::geometry::{Packet as Rays, RayBlock, Vec3};
use crate::lanes::Lanes;
use crate::method::packet::found::{Found, Query};
use crate::stats::{Count, Counters};
use simd::{Block, Float, Mask, Vector};

/// A portion of rays, packet by packet, against the leaves of their frusta.
pub(super) struct Intersect<'a, Q: Query, C> {
    pub(super) bvh: &'a Bvh,
    pub(super) tree: &'a OctoBvh,
    pub(super) space: &'a Space,
    pub(super) rays: &'a [RayBlock],
    pub(super) results: &'a mut [Q::Block],
    /// First block of each packet, and the end of the last.
    pub(super) bases: &'a [u32],
    pub(super) frusta: &'a Frusta,
    pub(super) leaves: &'a Leaves,
    pub(super) count: C,
}

impl<Q: Query, C: Count> Lanes for Intersect<'_, Q, C> {
    type Output = Counters;

    #[inline(always)]
    fn run<F: Float>(mut self) -> Counters {
        let mut first = 0;
        let mut boxes = Boxes::default();
        for (ends, &end) in self.bases.windows(2).zip(&self.frusta.ends) {
            let frusta = [first, end as usize];
            boxes.fill::<F>(self.tree, self.leaves, frusta);
            for block in ends[0] as usize..ends[1] as usize {
                for chunk in 0..16 / F::LANES {
                    self.group::<F>(block, chunk, frusta, &boxes);
                }
            }
            first = end as usize;
        }
        self.count.total()
    }
}

impl<Q: Query, C: Count> Intersect<'_, Q, C> {
    /// A group of rays, and the frusta of their packet.
    #[inline(always)]
    fn group<F: Float>(&mut self, block: usize, chunk: usize, frusta: [usize; 2], boxes: &Boxes) {
        let ray = Rays::<F>::load(&self.rays[block], chunk);
        let mut found = Q::Found::new(&ray);
        let [x, y, z] = ray.signs();
        let mut end = 0;
        for i in frusta[0]..frusta[1] {
            let (leaves, frustum) = (self.leaves.of(i), &self.frusta.all[i]);
            let begin = end;
            end += leaves.len().div_ceil(16);
            let boxes = &boxes.0[begin..end];
            let mut rest = frustum.members.of(&ray, self.space.largest);
            if leaves.is_empty() || rest.none() {
                continue;
            }
            self.count.group(rest.count());
            // One pass for each octant that directions point into: nearly always one in all.
            while let Some(lane) = rest.first() {
                let sign = |mask: F::Mask| (mask.bitmask() >> lane & 1) as usize;
                let octant = sign(x) | sign(y) << 1 | sign(z) << 2;
                let splat = |bit: usize| F::Mask::splat(octant >> bit & 1 != 0);
                let same = rest & !((x ^ splat(0)) | (y ^ splat(1)) | (z ^ splat(2)));
                self.count.packet();
                let (ray, near) = (ray.only(same), Near::of_octant(octant));
                if F::LANES == 1 {
                    for &leaf in leaves {
                        self.leaf(leaf, &ray, near, &mut found);
                        if found.complete() {
                            break;
                        }
                    }
                } else {
                    self.visit(frustum.part(&ray, same, self.space), (&ray, same), near, (leaves, boxes), &mut found);
                }
                rest &= !same;
            }
        }
        found.store(&mut self.results[block], chunk);
    }

    /// The leaves of a frustum, in order, that the part of it around the group meets before the last of the hits found so far.
    #[inline(always)]
    fn visit<F: Float>(
        &mut self,
        mut part: Frustum,
        (ray, on): (&Rays<F>, F::Mask),
        near: Near,
        (leaves, boxes): (&[u32], &[Box16]),
        found: &mut Q::Found<F>,
    ) {
        for (leaves, boxes) in leaves.chunks(16).zip(boxes) {
            for chunk in 0..16 / F::LANES {
                let low = Vec3 {
                    x: F::load_block(&boxes[0], chunk),
                    y: F::load_block(&boxes[1], chunk),
                    z: F::load_block(&boxes[2], chunk),
                };
                let high = Vec3 {
                    x: F::load_block(&boxes[3], chunk),
                    y: F::load_block(&boxes[4], chunk),
                    z: F::load_block(&boxes[5], chunk),
                };
                self.count.box_test();
                let mut met = part.meets(low, high).bitmask();
                if met == 0 {
                    continue;
                }
                let mut any = false;
                while met != 0 {
                    let i = met.trailing_zeros() as usize;
                    met &= met - 1;
                    any |= self.leaf(leaves[chunk * F::LANES + i], ray, near, found);
                }
                if any {
                    if found.complete() {
                        return;
                    }
                    part.shorten(ray, on, found.reach());
                }
            }
        }
    }

    /// A leaf: rays that miss its box, or have a hit before it, are left out. Whether a triangle was hit.
    #[inline(always)]
    fn leaf<F: Float>(&mut self, leaf: u32, ray: &Rays<F>, near: Near, found: &mut Q::Found<F>) -> bool {
        let row = &self.tree.rows()[leaf as usize];
        self.count.box_test();
        let (t_near, t_far) = slab::interval(row, ray, PerRay, near, ray.t_min, found.reach());
        let mut any = false;
        if t_near.le(t_far).any() {
            let (first, number) = OctoNode::of_row(row).triangles();
            for triangle in &self.bvh.triangles[first as usize..(first + number) as usize] {
                self.count.triangle_test();
                if let Some(hit) = moller_trumbore::intersect(triangle, ray, PerRay, near) {
                    self.count.triangle_hit();
                    found.accept(triangle.id, hit);
                    any = true;
                }
            }
        }
        any
    }
}

/// Lower and upper planes of sixteen boxes.
type Box16 = [Block<f32>; 6];

/// The boxes of the leaves of some frusta, those of each from a new sixteen on.
#[derive(Default)]
struct Boxes(Vec<Box16>);

impl Boxes {
    #[inline(always)]
    fn fill<F: Float>(&mut self, tree: &OctoBvh, leaves: &Leaves, frusta: [usize; 2]) {
        self.0.clear();
        if F::LANES == 1 {
            // Of no use.
            let blocks = leaves.ranges[frusta[0]..frusta[1]].iter().map(|[begin, end]| (end - begin).div_ceil(16));
            self.0.resize(blocks.sum::<u32>() as usize, [Block([0.0; 16]); 6]);
            return;
        }
        const NOTHING: [f32; 8] = {
            let (low, high) = (f32::INFINITY, f32::NEG_INFINITY);
            [low, low, low, 0.0, high, high, high, 0.0]
        };
        let rows = tree.rows();
        for i in frusta[0]..frusta[1] {
            for leaves in leaves.of(i).chunks(16) {
                let mut sixteen = [NOTHING; 16];
                for (to, &leaf) in sixteen.iter_mut().zip(leaves) {
                    *to = rows[leaf as usize];
                }
                let mut block = [Block([0.0; 16]); 6];
                for chunk in 0..16 / F::LANES {
                    let [a, b, c, _, d, e, f, _] = F::load_rows8(&sixteen[chunk * F::LANES..]);
                    for (column, to) in [a, b, c, d, e, f].into_iter().zip(&mut block) {
                        column.store_block(to, chunk);
                    }
                }
                self.0.push(block);
            }
        }
    }
}
