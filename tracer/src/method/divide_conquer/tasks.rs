//! Several threads.

use super::filter::Copy;
use super::found::is_better;
use super::partition::{Range, divide};
use super::rays::{NONE, Row, T_MAX, id, set_id};
use super::room::{Room, Rooms};
use super::traverse::{Done, Query, in_order};
use crate::geometry::Hit;
use crate::lanes;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, PoisonError};

/// Each thread a part of the rays, and all triangles (section 4).
pub(super) fn naive(
    query: &Query,
    rooms: &Rooms,
    ids: &[u32],
    all: Range,
    rows: &mut [Row],
    found: &mut [Hit],
) -> Done {
    let size = rows.len().div_ceil(rayon::current_num_threads()).next_multiple_of(16);
    let parts = rows.par_chunks_mut(size).zip(found.par_chunks_mut(size)).enumerate();
    let done = parts.map(|(i, (rows, found))| {
        let first = size * i;
        for row in &mut *rows {
            set_id(row, id(row) - first);
        }
        let starts = if query.starts.is_empty() { &[] } else { &query.starts[first..] };
        rooms.with(|room| {
            room.ids.clear();
            room.ids.extend_from_slice(ids);
            Query { starts, ..*query }.run(&mut room.ids, all, rows, found)
        })
    });
    done.reduce(Done::default, |a, b| a + b)
}

/// The halves of the triangles are tasks, until there are several for each thread. Each has a copy of the rays that meet it, which end where others have
/// found a hit till then: so it does not go far beyond the first hit, although both halves may be traced at once.
pub(super) fn shared(
    query: &Query,
    rooms: &Rooms,
    ids: &mut [u32],
    all: Range,
    rows: &[Row],
    found: &mut [Hit],
) -> Done {
    let ends = rows.par_iter().map(|row| AtomicU32::new(row[T_MAX].to_bits())).collect();
    let size = found.len().div_ceil(STRIPES).max(1);
    let stripes = found.chunks_mut(size).map(Mutex::new).collect();
    let tasks = TASKS * rayon::current_num_threads();
    let (most, depth) = (all.len() / tasks, tasks.ilog2() + UNEVEN);
    let shared = Shared { query, ends, stripes, size, most, rooms };
    // Not filtered: most rays of a batch meet the box of all.
    shared.halves(ids, &all, rows, depth).unwrap_or_else(|| shared.task(ids, all, rows, false, 0))
}

/// Tasks for each thread, if they were of one size.
const TASKS: usize = 8;
/// So many times more than it would take halves of one size, triangles are divided into tasks: each time rays are copied, and the copies wait.
const UNEVEN: u32 = 4;
/// Fewer rays are not worth a task of their own.
const FEW_RAYS: usize = 1 << 13;
/// Parts of the hits that are locked one by one.
const STRIPES: usize = 64;

/// Rays copied at a time.
const PART: usize = 1 << 12;

struct Shared<'a> {
    query: &'a Query<'a>,
    /// Where rays end, as bits.
    ends: Vec<AtomicU32>,
    stripes: Vec<Mutex<&'a mut [Hit]>>,
    /// Hits in a stripe.
    size: usize,
    /// Triangles that one task traces.
    most: usize,
    rooms: &'a Rooms,
}

impl Shared<'_> {
    /// Some triangles, whose ids these are, and rays that may meet them and may have become shorter; `depth` times at most they are divided into tasks.
    fn task(&self, ids: &mut [u32], range: Range, rays: &[Row], shorter: bool, depth: u32) -> Done {
        self.rooms.with(|room| self.task_in(room, ids, range, (rays, shorter), depth))
    }

    fn task_in(
        &self,
        room: &mut Room,
        ids: &mut [u32],
        range: Range,
        (rays, shorter): (&[Row], bool),
        depth: u32,
    ) -> Done {
        let Query { level, width: lanes, from, .. } = *self.query;
        let (ends, planes) = (if shorter { &*self.ends } else { &[] }, range.planes());
        // Most rays may miss: room is taken as it is needed.
        let mut active = 0;
        for part in rays.chunks(PART) {
            if room.rows.len() < active + part.len() {
                room.rows.resize(active + part.len(), NONE);
            }
            let to = &mut room.rows[active..active + part.len()];
            active += lanes::run_simd_native(level, Copy { rows: part, to, ends, planes, from });
        }
        let mut done = Done::default();
        done.counters.box_tests += rays.len().div_ceil(lanes) as u64;
        if active == 0 || self.query.is_cancelled() {
            return done;
        }
        if range.len() > self.most
            && active >= FEW_RAYS
            && depth > 0
            && let Some(of_halves) = self.halves(ids, &range, &room.rows[..active], depth)
        {
            return done + of_halves;
        }
        done + self.trace(room, ids, range, active)
    }

    /// Divides the triangles, if they can be, and traces both halves.
    fn halves(&self, ids: &mut [u32], range: &Range, rows: &[Row], depth: u32) -> Option<Done> {
        let Query { triangles, level, .. } = *self.query;
        let sides @ [left, _] = divide(level, ids, &triangles.boxes, range, self.query.way(range.len(), rows.len()))?;
        let [near, far] = in_order(sides, &rows[0]);
        let (of_left, of_right) = ids.split_at_mut(left.len());
        let is_left_near = near.first == left.first;
        let (of_near, of_far) = if is_left_near { (of_left, of_right) } else { (of_right, of_left) };
        let (a, b) = rayon::join(
            || self.task(of_near, near.alone(), rows, false, depth - 1),
            || self.task(of_far, far.alone(), rows, true, depth - 1),
        );
        Some(a + b)
    }

    /// The first `active` rays.
    fn trace(&self, room: &mut Room, ids: &mut [u32], range: Range, active: usize) -> Done {
        let Room { rows, numbers, starts, found, .. } = room;
        let rows = &mut rows[..active];
        // Hits are kept by numbers of this task's own.
        numbers.clear();
        numbers.extend(rows.iter().map(|row| id(row) as u32));
        for (i, row) in rows.iter_mut().enumerate() {
            set_id(row, i);
        }
        starts.clear();
        if !self.query.starts.is_empty() {
            starts.extend(numbers.iter().map(|&number| self.query.starts[number as usize]));
        }
        found.clear();
        found.resize(active, Hit::MISS);
        let done = Query { starts, ..*self.query }.run(ids, range, rows, found);
        self.merge(numbers, found);
        done
    }

    /// Numbers are in ascending order, as all copies were made in order: memory is gone through once, and each stripe locked once.
    fn merge(&self, numbers: &[u32], found: &[Hit]) {
        let (mut numbers, mut found) = (numbers, found);
        while let Some(&first) = numbers.first() {
            let stripe = first as usize / self.size;
            let begin = stripe * self.size;
            let n = numbers.partition_point(|&number| (number as usize) < begin + self.size);
            // What a thread that panicked has left is whole.
            let mut best = self.stripes[stripe].lock().unwrap_or_else(PoisonError::into_inner);
            for (&number, hit) in numbers[..n].iter().zip(&found[..n]).filter(|(_, hit)| !hit.is_miss()) {
                let best = &mut best[number as usize - begin];
                if is_better(hit, best) {
                    *best = *hit;
                    let end = if self.query.any { f32::NEG_INFINITY } else { hit.t };
                    self.ends[number as usize].store(end.to_bits(), Ordering::Relaxed);
                }
            }
            (numbers, found) = (&numbers[n..], &found[n..]);
        }
    }
}
