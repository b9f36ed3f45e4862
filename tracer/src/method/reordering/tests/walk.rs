//! Algorithm 1 and what it is compared with, ray by ray and by recursion.

use super::super::interval::Bounds;
use super::super::rays::{Planes, Sixteen};
use super::super::{Partition, Reordering, Traversal, tally};
use crate::bvh::{Bvh, Node};
use crate::geometry::{Hit, Packet, RayBatch, moller_trumbore};
use crate::stats::Counters;

/// Interval tests that succeeded.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Intervals {
    pub(super) all_hit: u32,
    pub(super) all_miss: u32,
}

/// A ray, in the first lane of sixteen.
#[derive(Clone)]
struct Lone {
    ray: Sixteen,
    hit: Hit,
    id: usize,
}

pub(super) struct Walk<'a> {
    bvh: &'a Bvh,
    method: &'a Reordering<'a>,
    any: bool,
    width: usize,
    depths: Vec<u8>,
    growth: f32,
    rays: Vec<Lone>,
    pub(super) counters: Counters,
    pub(super) intervals: Intervals,
}

/// Rays of a frame that a node is visited by.
#[derive(Clone, Copy)]
struct Visit {
    node: usize,
    parent: Option<usize>,
    first: usize,
    last: usize,
    all_hit: bool,
}

impl<'a> Walk<'a> {
    pub(super) fn new(bvh: &'a Bvh, method: &'a Reordering<'a>, any: bool) -> Self {
        let width = if method.traversal == Traversal::Single { 1 } else { method.width.lanes(method.level) };
        Self {
            bvh,
            method,
            any,
            width,
            depths: tally::depths(bvh),
            growth: 0.0,
            rays: Vec::new(),
            counters: Counters::default(),
            intervals: Intervals::default(),
        }
    }

    pub(super) fn run(&mut self, rays: &RayBatch) -> Vec<Hit> {
        let mut found = Vec::new();
        for packet in rays.blocks().chunks(self.method.packet / 16) {
            (self.rays, self.growth) = (Vec::new(), 0.0);
            for block in packet {
                let mut sixteen = Sixteen::NONE;
                let loaded = sixteen.set::<f32>(block, self.method.largest, 0);
                assert_eq!(loaded.odd, 0, "rays of ordinary size");
                self.growth = self.growth.max(loaded.growth);
                for lane in 0..16 {
                    let (mut ray, id) = (Sixteen::NONE, self.rays.len());
                    copy(&sixteen, lane, &mut ray, 0);
                    self.rays.push(Lone { ray, hit: Hit::MISS, id });
                }
            }
            let all: Vec<usize> = (0..self.rays.len()).collect();
            let root = Visit { node: 0, parent: None, first: 0, last: all.len() - 1, all_hit: true };
            match self.method.traversal {
                Traversal::Single | Traversal::Simd => {
                    for group in all.chunks(self.width) {
                        let group: Vec<usize> = group.iter().copied().filter(|&i| self.is_open(i)).collect();
                        if group.is_empty() {
                            continue;
                        }
                        self.counters.packets += 1;
                        self.counters.reordering.steps += 1;
                        self.boxes(0, 1, group.len());
                        self.group(0, &self.meeting(&group, 0).iter().map(|&(i, _)| i).collect::<Vec<_>>());
                    }
                }
                Traversal::Packet => {
                    self.counters.packets += 1;
                    let bounds = if self.are_many(all.len()) { self.bounds(&all, None) } else { None };
                    self.speculative(&all, root, &bounds);
                }
                Traversal::Adaptive | Traversal::Exact => {
                    self.counters.packets += 1;
                    let bounds = if self.are_many(all.len()) { self.bounds(&all, None) } else { None };
                    self.visit(&mut all.clone(), &bounds, root);
                }
            }
            let mut lone = std::mem::take(&mut self.rays);
            lone.sort_by_key(|lone| lone.id);
            found.extend(lone.into_iter().map(|lone| lone.hit));
        }
        found.truncate(rays.len());
        found
    }

    fn is_open(&self, ray: usize) -> bool {
        self.rays[ray].ray.t_min.0[0] <= self.rays[ray].ray.reach.0[0]
    }

    fn nodes(&self) -> &'a [Node] {
        &self.bvh.nodes
    }

    fn are_many(&self, rays: usize) -> bool {
        rays > self.method.from * self.width
    }

    fn bounds(&self, rays: &[usize], into: Option<usize>) -> Option<Bounds> {
        let mut sixteens = vec![Sixteen::NONE; rays.len().div_ceil(16)];
        for (k, &i) in rays.iter().enumerate() {
            copy(&self.rays[i].ray, 0, &mut sixteens[k / 16], k % 16);
        }
        let planes = into.map(|node| Planes::<f32>::new(self.nodes()[node].planes(), self.growth));
        Bounds::of_many(&sixteens, planes.as_ref(), true)
    }

    /// The box test of packets: where the ray enters the box, if it does.
    fn met(&self, ray: usize, node: usize) -> Option<f32> {
        let (p, r) = (self.nodes()[node].planes(), &self.rays[ray].ray);
        let (mut near, mut far) = (r.t_min.0[0], r.reach.0[0]);
        for axis in 0..3 {
            let (inv, offset) = (r.inv[axis].0[0], r.offset[axis].0[0]);
            let a = (p[axis] - self.growth) * inv + offset;
            let b = (p[axis + 4] + self.growth) * inv + offset;
            (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
        }
        (near <= far).then_some(near)
    }

    /// The box test of groups, rounded otherwise, for some rays.
    fn meeting(&self, rays: &[usize], node: usize) -> Vec<(usize, f32)> {
        let p = self.nodes()[node].planes();
        let meets = |&ray: &usize| {
            let r = &self.rays[ray].ray;
            let (mut near, mut far) = (r.t_min.0[0], r.reach.0[0]);
            for axis in 0..3 {
                let (inv, offset) = (r.inv[axis].0[0], r.offset[axis].0[0]);
                let widen = inv * self.growth;
                let (a, b) = (p[axis] * inv + (offset - widen), p[axis + 4] * inv + (offset + widen));
                (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
            }
            (near <= far).then_some((ray, near))
        };
        rays.iter().filter_map(meets).collect()
    }

    fn boxes(&mut self, node: usize, tests: usize, rays: usize) {
        self.counters.box_tests += tests as u64;
        let depth = &mut self.counters.reordering.by_depth[usize::from(self.depths[node])];
        depth.box_tests += tests as u64;
        depth.box_rays += rays as u64;
    }

    fn tested(&mut self, node: usize, benefit: Option<usize>) {
        self.counters.reordering.interval_tests += 1;
        let depth = &mut self.counters.reordering.by_depth[usize::from(self.depths[node])];
        depth.interval_benefit += benefit.map_or(-1, |n| n as i64);
    }

    /// The children, the one first that comes first for a ray.
    fn children(&self, node: usize, ray: usize) -> Vec<usize> {
        let (nodes, mut children, mut child) = (self.nodes(), Vec::new(), node + 1);
        while child < nodes[node].skip() as usize {
            children.push(child);
            child = nodes[child].skip() as usize;
        }
        let &[a, b] = &children[..] else {
            children.reverse();
            return children;
        };
        let (p, q) = (nodes[a].bounds(), nodes[b].bounds());
        let apart = |axis: usize| (q.min[axis] + q.max[axis]) - (p.min[axis] + p.max[axis]);
        let mut axis = 0;
        for other in 1..3 {
            if apart(other).abs() > apart(axis).abs() {
                axis = other;
            }
        }
        let is_first_nearer = (apart(axis) < 0.0) == (self.rays[ray].ray.inv[axis].0[0] < 0.0);
        if is_first_nearer { vec![a, b] } else { vec![b, a] }
    }

    fn leaf(&mut self, node: usize, rays: &[usize]) {
        let (first, number) = self.nodes()[node].triangles();
        for triangle in &self.bvh.triangles[first as usize..(first + number) as usize] {
            self.counters.triangle_tests += 1;
            self.counters.reordering.triangle_rays += rays.len() as u64;
            let mut is_hit = false;
            for &i in rays {
                let lone = &mut self.rays[i];
                let ray: Packet<f32> = lone.ray.packet(0);
                let Some(hit) = moller_trumbore::intersect_mixed(triangle, &ray).filter(|hit| hit.mask) else {
                    continue;
                };
                is_hit = true;
                if (hit.t, triangle.id) < (lone.ray.reach.0[0], lone.hit.primitive) {
                    lone.hit = Hit { t: hit.t, u: hit.u, v: hit.v, primitive: triangle.id };
                    lone.ray.reach.0[0] = if self.any { f32::NEG_INFINITY } else { hit.t };
                }
            }
            self.counters.triangle_hits += u64::from(is_hit);
        }
    }

    /// Rays in one vector at a node that they meet.
    fn group(&mut self, node: usize, rays: &[usize]) {
        if rays.is_empty() {
            return;
        }
        let (_, number) = self.nodes()[node].triangles();
        if number > 0 {
            self.counters.reordering.primitives += u64::from(number);
            return self.leaf(node, rays);
        }
        let children = self.children(node, rays[0]);
        // All boxes are tested before anything in them is.
        let met: Vec<_> = children.iter().map(|&child| self.meeting(rays, child)).collect();
        for &child in &children {
            self.counters.reordering.steps += 1;
            self.boxes(child, 1, rays.len());
        }
        for (&child, met) in children.iter().zip(met) {
            let before = |&(i, near): &(usize, f32)| (near <= self.rays[i].ray.reach.0[0]).then_some(i);
            let still: Vec<usize> = met.iter().filter_map(before).collect();
            self.group(child, &still);
        }
    }

    fn visit(&mut self, frame: &mut Vec<usize>, bounds: &Option<Bounds>, visit: Visit) {
        let Visit { node, mut first, mut last, .. } = visit;
        self.counters.reordering.steps += 1;
        let planes = self.nodes()[node].planes();
        let mut is_active = vec![true; frame.len()];
        if let Some(known) = bounds {
            let rays = last - first + 1;
            if visit.all_hit {
                let all = known.all_hit(planes);
                self.tested(node, all.then_some(rays));
                if all {
                    self.intervals.all_hit += 1;
                    // Those that met the node above; bounds do not know of what was found since.
                    let wrong = |&&i: &&usize| {
                        let above = visit.parent.is_none_or(|parent| self.met(i, parent).is_some());
                        above && self.rays[i].hit.is_miss() && self.is_open(i) && self.met(i, node).is_none()
                    };
                    assert_eq!(frame[first..=last].iter().find(wrong), None, "all hit");
                    return self.go_on(frame, bounds, visit, &is_active);
                }
            }
            let none = known.all_miss(planes, self.growth);
            self.tested(node, none.then_some(rays));
            if none {
                self.intervals.all_miss += 1;
                assert!(frame[first..=last].iter().all(|&i| self.met(i, node).is_none()), "all miss");
                return;
            }
        }
        let above = |&&i: &&usize| match visit.parent {
            Some(parent) => self.met(i, parent).is_some(),
            None => self.is_open(i),
        };
        let rays = frame[first..=last].iter().filter(above).count();
        self.boxes(node, last / self.width - first / self.width + 1, rays);
        for (k, is_active) in is_active.iter_mut().enumerate() {
            *is_active = (first..=last).contains(&k) && self.met(frame[k], node).is_some();
        }
        let active: Vec<usize> = (first..=last).filter(|&k| is_active[k]).collect();
        let (Some(&from), Some(&to)) = (active.first(), active.last()) else { return };
        (first, last) = (from, to);
        let rays: Vec<usize> = active.iter().map(|&k| frame[k]).collect();
        let here = Visit { first, last, ..visit };
        if first / self.width == last / self.width || active.len() <= self.width {
            if first / self.width != last / self.width {
                self.counters.reordering.reordered += active.len() as u64;
            }
            self.group(node, &rays);
        } else if active.len() as f32 >= self.method.threshold * (last - first + 1) as f32 {
            self.go_on(frame, bounds, Visit { all_hit: false, ..here }, &is_active);
        } else {
            self.counters.reordering.reordered += active.len() as u64;
            let tight = self.method.intervals == crate::method::Intervals::Tight;
            let are_many = self.are_many(active.len());
            let into = tight.then_some(node);
            if self.method.partition == Partition::InPlace {
                let mut n = first;
                for k in active {
                    frame.swap(n, k);
                    n += 1;
                }
                let last = n - 1;
                let around = first / 16 * 16..(last / 16 * 16 + 16).min(frame.len());
                let bounds = if are_many { self.bounds(&frame[around], into) } else { None };
                let is_active = vec![true; frame.len()];
                self.go_on(frame, &bounds, Visit { last, all_hit: true, ..here }, &is_active);
            } else {
                let bounds = if are_many { self.bounds(&rays, into) } else { None };
                let (is_active, here) = (vec![true; rays.len()], Visit { first: 0, last: rays.len() - 1, ..here });
                self.go_on(&mut rays.clone(), &bounds, Visit { all_hit: true, ..here }, &is_active);
            }
        }
    }

    fn go_on(&mut self, frame: &mut Vec<usize>, bounds: &Option<Bounds>, visit: Visit, is_active: &[bool]) {
        let Visit { node, first, last, .. } = visit;
        let (_, number) = self.nodes()[node].triangles();
        if number > 0 {
            self.counters.reordering.primitives += u64::from(number);
            for group in first / self.width..=last / self.width {
                let lanes = group * self.width..(group + 1) * self.width;
                let lanes = lanes.filter(|&k| (first..=last).contains(&k) && is_active[k]);
                let rays: Vec<usize> = lanes.map(|k| frame[k]).collect();
                if !rays.is_empty() {
                    self.leaf(node, &rays);
                }
            }
            return;
        }
        for child in self.children(node, frame[first]) {
            self.visit(frame, bounds, Visit { node: child, parent: Some(node), ..visit });
        }
    }

    fn speculative(&mut self, all: &[usize], visit: Visit, bounds: &Option<Bounds>) {
        let Visit { node, parent, first, .. } = visit;
        self.counters.reordering.steps += 1;
        let groups: Vec<&[usize]> = all.chunks(self.width).collect();
        let ask = |walk: &mut Self, group: usize| {
            let above = groups[group].iter().filter(|&&i| match parent {
                Some(parent) => walk.met(i, parent).is_some(),
                None => walk.is_open(i),
            });
            let rays = above.count();
            walk.boxes(node, 1, rays);
            groups[group].iter().copied().filter(|&i| walk.met(i, node).is_some()).collect::<Vec<_>>()
        };
        let mut group = first / self.width;
        let mut rays = ask(self, group);
        if rays.is_empty() {
            if let Some(bounds) = bounds {
                let none = bounds.all_miss(self.nodes()[node].planes(), self.growth);
                self.tested(node, none.then_some(all.len() - first));
                if none {
                    self.intervals.all_miss += 1;
                    assert!(all.iter().all(|&i| self.met(i, node).is_none()), "all miss");
                    return;
                }
            }
            while rays.is_empty() && group + 1 < groups.len() {
                group += 1;
                rays = ask(self, group);
            }
        }
        let Some(&leader) = rays.first() else { return };
        let (_, number) = self.nodes()[node].triangles();
        if number == 0 {
            for child in self.children(node, leader) {
                self.speculative(all, Visit { node: child, parent: Some(node), first: leader, ..visit }, bounds);
            }
            return;
        }
        self.counters.reordering.primitives += u64::from(number);
        loop {
            if !rays.is_empty() {
                self.leaf(node, &rays);
            }
            group += 1;
            if group == groups.len() {
                return;
            }
            rays = ask(self, group);
        }
    }
}

fn copy(from: &Sixteen, lane: usize, to: &mut Sixteen, to_lane: usize) {
    for axis in 0..3 {
        to.org[axis].0[to_lane] = from.org[axis].0[lane];
        to.dir[axis].0[to_lane] = from.dir[axis].0[lane];
        to.inv[axis].0[to_lane] = from.inv[axis].0[lane];
        to.offset[axis].0[to_lane] = from.offset[axis].0[lane];
    }
    to.t_min.0[to_lane] = from.t_min.0[lane];
    to.reach.0[to_lane] = from.reach.0[lane];
}
