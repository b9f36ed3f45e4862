//! The traversal: filter, then divide or intersect.

use super::filter::{Filter, Sample};
use super::intersect::Intersect;
use super::partition::{Range, Way, divide};
use super::rays::{Active, ByPlace, InPlace, Row};
use super::triangles::TriangleBoxes;
use super::{DivideLimits, Filtering, Phases};
use crate::clock::Clock;
use crate::geometry::{Hit, Triangle};
use crate::lanes::{self, Width};
use crate::stats::Counters;
use simd::Level;
use std::ops::Add;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// What is the same for all steps.
#[derive(Clone, Copy)]
pub(super) struct Query<'a> {
    pub(super) triangles: &'a TriangleBoxes,
    pub(super) level: Level,
    /// Rays in a vector.
    pub(super) width: usize,
    pub(super) limits: DivideLimits,
    pub(super) filtering: Filtering,
    /// No ray starts before.
    pub(super) from: f32,
    /// Where each ray starts; empty when all start at `from`.
    pub(super) starts: &'a [f32],
    pub(super) any: bool,
    pub(super) cancel: Option<&'a AtomicBool>,
    pub(super) clock: bool,
}

impl Query<'_> {
    /// Finds the hits of all rays with the triangles of a range, whose ids it sorts.
    pub(super) fn run(&self, ids: &mut [u32], range: Range, rows: &mut [Row], found: &mut [Hit]) -> Done {
        let (query, len) = (*self, rows.len());
        let traversal = Traversal { query, ids, found, stack: Vec::new(), leaf: Vec::new(), done: Done::default() };
        match self.filtering {
            Filtering::Rays => traversal.run(range, &mut InPlace(rows), len),
            Filtering::Places => {
                let mut places: Vec<u32> = (0..len as u32).collect();
                traversal.run(range, &mut ByPlace { places: &mut places, rows }, len)
            }
        }
    }

    pub(super) fn is_cancelled(&self) -> bool {
        self.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// How to divide triangles for so many rays.
    pub(super) fn way(&self, triangles: usize, rays: usize) -> Way {
        let DivideLimits { rays_per_triangle, box_cost, .. } = self.limits;
        if rays as f32 > rays_per_triangle * triangles as f32 { Way::Sah(box_cost) } else { Way::Middle }
    }
}

/// Triangles to be looked at, with the rays before the given place.
struct Step {
    range: Range,
    rays: usize,
}

/// What was done, and how long it took if that was asked for.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Done {
    pub(super) counters: Counters,
    pub(super) phases: Phases,
}

impl Add for Done {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        let phases = Phases {
            filter: self.phases.filter + o.phases.filter,
            partition: self.phases.partition + o.phases.partition,
            intersect: self.phases.intersect + o.phases.intersect,
        };
        Self { counters: self.counters + o.counters, phases }
    }
}

struct Traversal<'a> {
    query: Query<'a>,
    ids: &'a mut [u32],
    found: &'a mut [Hit],
    stack: Vec<Step>,
    leaf: Vec<Triangle>,
    done: Done,
}

impl Traversal<'_> {
    fn run<A: Active>(mut self, range: Range, rays: &mut A, len: usize) -> Done {
        let Query { limits, level, .. } = self.query;
        self.stack.push(Step { range, rays: len });
        while let Some(Step { range, rays: of }) = self.stack.pop() {
            if self.query.is_cancelled() {
                break;
            }
            let active = self.filter(&range, rays, of);
            if active == 0 {
                continue;
            }
            if active <= limits.few_rays || range.len() <= limits.few_triangles {
                self.intersect(&range, rays, active);
                continue;
            }
            let start = self.start();
            let way = self.query.way(range.len(), active);
            let sides = divide(level, self.ids, &self.query.triangles.boxes, &range, way);
            self.stop(start, |phases, time| phases.partition += time);
            let Some(sides) = sides else {
                self.intersect(&range, rays, active);
                continue;
            };
            let [near, far] = in_order(sides, rays.first());
            self.stack.push(Step { range: far, rays: active });
            self.stack.push(Step { range: near, rays: active });
        }
        self.done
    }

    fn filter<A: Active>(&mut self, range: &Range, rays: &mut A, len: usize) -> usize {
        let start = self.start();
        let planes = range.planes();
        let Query { level, from, limits, .. } = self.query;
        let lanes = self.lanes::<A>();
        let sampled = len >= Sample::<A>::LEAST && range.len() > 4 * limits.few_triangles && limits.filter_below < 1.0;
        let active = if sampled
            && lanes::run_simd_native(level, Sample { rays: &*rays, len, planes, from }) > limits.filter_below
        {
            self.done.counters.box_tests += Sample::<A>::tests(level.isa().lanes());
            len
        } else {
            self.done.counters.box_tests += len.div_ceil(lanes) as u64;
            let job = Filter { rays, len, planes, from };
            if const { A::ANY_WIDTH } { lanes::run_simd(level, lanes, job) } else { lanes::run_simd_native(level, job) }
        };
        self.stop(start, |phases, time| phases.filter += time);
        active
    }

    fn intersect<A: Active>(&mut self, range: &Range, rays: &mut A, len: usize) {
        let start = self.start();
        let Query { triangles, level, from, starts, any, .. } = self.query;
        let lanes = self.lanes::<A>();
        self.leaf.clear();
        self.leaf.extend(self.ids[range.first..range.end].iter().map(|&id| triangles.get(id)));
        let job = Intersect { rays, len, triangles: &self.leaf, from, starts, found: &mut *self.found, any };
        self.done.counters.triangle_hits += if const { A::ANY_WIDTH } {
            lanes::run_plain_if_emulated(level, lanes, job)
        } else {
            lanes::run_long(level, Width::Auto, job)
        };
        self.done.counters.triangle_tests += (len.div_ceil(lanes) * self.leaf.len()) as u64;
        self.stop(start, |phases, time| phases.intersect += time);
    }

    /// Rays in a vector.
    fn lanes<A: Active>(&self) -> usize {
        if A::ANY_WIDTH { self.query.width } else { self.query.level.isa().lanes() }
    }

    fn start(&self) -> Option<Clock> {
        if self.query.clock { Some(Clock::now()) } else { None }
    }

    fn stop(&mut self, start: Option<Clock>, add: impl FnOnce(&mut Phases, Duration)) {
        if let Some(start) = start {
            add(&mut self.done.phases, start.elapsed());
        }
    }
}

/// The half that the first active ray comes to first, on the axis on which they lie farthest apart (Wald, Boulos and Shirley 2007).
pub(super) fn in_order([left, right]: [Range; 2], first: &Row) -> [Range; 2] {
    let middle = |r: &Range, axis: usize| r.bounds.0[axis] - r.bounds.0[4 + axis];
    let apart = |axis: usize| middle(&right, axis) - middle(&left, axis);
    let mut widest = 0;
    for axis in 1..3 {
        if apart(axis).abs() > apart(widest).abs() {
            widest = axis;
        }
    }
    let is_right_first = (first[4 + widest] < 0.0) != (apart(widest) < 0.0);
    if is_right_first { [right, left] } else { [left, right] }
}
