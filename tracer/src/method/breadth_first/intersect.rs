//! Localized intersection (Garanzha & Loop 2010, section 3.4): packets are taken apart into groups of as many rays as a vector has lanes, and each group
//! goes through the leaves that its frustum captured.

use super::build::Frusta;
use super::leaves::Leaves;
use crate::bvh::{Bvh, OctoBvh, OctoNode};
use crate::geometry::frustum::Space;
use crate::geometry::moller_trumbore;
use crate::geometry::slab::{self, Near, PerRay};
use crate::geometry::{Packet as Rays, RayBlock};
use crate::lanes::Lanes;
use crate::method::packet::found::{Found, Query};
use crate::stats::{Count, Counters};
use simd::{Float, Mask};

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
        for (ends, &end) in self.bases.windows(2).zip(&self.frusta.ends) {
            for block in ends[0] as usize..ends[1] as usize {
                for chunk in 0..16 / F::LANES {
                    self.group::<F>(block, chunk, [first, end as usize]);
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
    fn group<F: Float>(&mut self, block: usize, chunk: usize, frusta: [usize; 2]) {
        let ray = Rays::<F>::load(&self.rays[block], chunk);
        let mut found = Q::Found::new(&ray);
        let [x, y, z] = ray.signs();
        for i in frusta[0]..frusta[1] {
            let leaves = self.leaves.of(i);
            let mut rest = self.frusta.all[i].members.of(&ray, self.space.largest);
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
                self.visit(&ray.only(same), Near::of_octant(octant), leaves, &mut found);
                rest &= !same;
            }
        }
        found.store(&mut self.results[block], chunk);
    }

    /// All leaves of a frustum, in order: rays that miss the box of a leaf, or have a hit before it, are left out.
    #[inline(always)]
    fn visit<F: Float>(&mut self, ray: &Rays<F>, near: Near, leaves: &[u32], found: &mut Q::Found<F>) {
        let rows = self.tree.rows();
        for &leaf in leaves {
            let row = &rows[leaf as usize];
            self.count.box_test();
            let (t_near, t_far) = slab::interval(row, ray, PerRay, near, ray.t_min, found.reach());
            if !t_near.le(t_far).any() {
                continue;
            }
            let (first, number) = OctoNode::of_row(row).triangles();
            for triangle in &self.bvh.triangles[first as usize..(first + number) as usize] {
                self.count.triangle_test();
                if let Some(hit) = moller_trumbore::intersect(triangle, ray, PerRay, near) {
                    self.count.triangle_hit();
                    found.accept(triangle.id, hit);
                }
            }
            if found.complete() {
                return;
            }
        }
    }
}
