//! Localized intersection (Garanzha & Loop 2010, section 3.4): packets are taken apart into groups of as many rays as a vector has lanes, and each group
//! goes through the leaves that its frustum captured.

use super::boxes::{Boxes, Sixteen};
use super::build::Frusta;
use super::leaves::Leaves;
use super::runs::Runs;
use crate::bvh::{Bvh, OctoBvh, OctoNode};
use crate::geometry::frustum::{Frustum, Space};
use crate::geometry::moller_trumbore::{self, Candidate};
use crate::geometry::slab::{self, Near, PerRay};
use crate::geometry::{Packet as Rays, RayBlock, Triangle, Vec3};
use crate::lanes::Lanes;
use crate::method::found::Found;
use crate::method::query::Query;
use crate::stats::{Count, Counters};
use simd::{Float, Mask};
use std::ops::Range;

/// A portion of rays, packet by packet, against the leaves of their frusta.
pub(super) struct Intersect<'a, Q: Query, C> {
    pub(super) bvh: &'a Bvh,
    pub(super) tree: &'a OctoBvh,
    pub(super) space: &'a Space,
    pub(super) rays: &'a [RayBlock],
    pub(super) results: &'a mut [Q::Block],
    pub(super) runs: Runs<'a>,
    /// Which of them.
    pub(super) which: Range<usize>,
    pub(super) frusta: &'a Frusta,
    pub(super) leaves: &'a Leaves,
    pub(super) count: C,
}

impl<Q: Query, C: Count> Lanes for Intersect<'_, Q, C> {
    type Output = Counters;

    #[inline(always)]
    fn run<F: Float>(mut self) -> Counters {
        let ends = &self.frusta.ends;
        let mut first = self.which.start.checked_sub(1).map_or(0, |before| ends[before] as usize);
        let mut boxes = Boxes::default();
        for run in self.which.clone() {
            let end = ends[run];
            let blocks = self.runs.blocks(run);
            boxes.clear();
            for frustum in first..end as usize {
                if F::LANES > 1 {
                    boxes.add::<F>((self.bvh, self.tree), self.leaves.of(frustum));
                }
            }
            for block in blocks[0] as usize..blocks[1] as usize {
                for chunk in 0..16 / F::LANES {
                    self.group::<F>(block, chunk, [first, end as usize], &boxes);
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
        for i in frusta[0]..frusta[1] {
            let (leaves, frustum) = (self.leaves.of(i), &self.frusta.all[i]);
            let mut rest = frustum.members.of(&ray, chunk, self.space.largest);
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
                    let part = frustum.part(&ray, same, self.space);
                    self.visit(part, (&ray, same), near, boxes.of(i - frusta[0]), &mut found);
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
        boxes: &[Sixteen],
        found: &mut Q::Found<F>,
    ) {
        for sixteen in boxes {
            for chunk in 0..16 / F::LANES {
                self.count.box_test();
                let (low, high) = (Vec3::load(&sixteen.low, chunk), Vec3::load(&sixteen.high, chunk));
                let mut met = part.meets::<F>(low, high).bitmask();
                if met == 0 {
                    continue;
                }
                let mut any = false;
                while met != 0 {
                    let leaf = sixteen.nodes[(chunk * F::LANES + met.trailing_zeros() as usize) % 16];
                    met &= met - 1;
                    any |= self.leaf(leaf, ray, near, found);
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
            let triangles = &self.bvh.triangles[first as usize..(first + number) as usize];
            let (pairs, rest) = triangles.as_chunks::<2>();
            for pair in pairs {
                self.count.triangle_test();
                self.count.triangle_test();
                let [a, b] = moller_trumbore::intersect_two(pair, ray, PerRay, near);
                any |= self.accept(&pair[0], a, found);
                any |= self.accept(&pair[1], b, found);
            }
            for triangle in rest {
                self.count.triangle_test();
                let hit = moller_trumbore::intersect(triangle, ray, PerRay, near);
                any |= self.accept(triangle, hit, found);
            }
        }
        any
    }

    #[inline(always)]
    fn accept<F: Float>(&mut self, triangle: &Triangle, hit: Option<Candidate<F>>, found: &mut Q::Found<F>) -> bool {
        let Some(hit) = hit else { return false };
        self.count.triangle_hit();
        found.accept(triangle.id, hit);
        true
    }
}
