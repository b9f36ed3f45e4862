//! A portion of packets through all stages, and all portions on all threads.

use super::build::{Build, Frusta};
use super::depth_first;
use super::intersect::Intersect;
use super::leaves::Leaves;
use super::queue::Queues;
use super::runs::Runs;
use super::{BreadthFirst, Stages, Visit};
use crate::Error;
use crate::clock::Clock;
use crate::geometry::RayBlock;
use crate::lanes;
use crate::method::query::Query;
use crate::method::{Context, packet};
use crate::sort::RaySorter;
use crate::stats::{Counters, NoCount};
use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};

/// Blocks of rays in a portion, a few more or less.
const BLOCKS: usize = 1024;

/// Some packets, and where their results go.
struct Portion<'a, B> {
    rays: &'a [RayBlock],
    runs: Runs<'a>,
    results: &'a mut [B],
}

/// Memory that is kept from one portion to the next: each thread takes what is free.
#[derive(Debug, Default)]
pub(super) struct Pool {
    free: Mutex<Vec<Scratch>>,
    sorters: Mutex<Vec<RaySorter>>,
}

impl Pool {
    fn take(&self) -> Option<Scratch> {
        self.free.lock().unwrap_or_else(PoisonError::into_inner).pop()
    }

    fn give_back(&self, scratch: Scratch) {
        self.free.lock().unwrap_or_else(PoisonError::into_inner).push(scratch);
    }

    pub(super) fn sorter(&self) -> Option<RaySorter> {
        self.sorters.lock().unwrap_or_else(PoisonError::into_inner).pop()
    }

    pub(super) fn give_back_sorter(&self, sorter: RaySorter) {
        self.sorters.lock().unwrap_or_else(PoisonError::into_inner).push(sorter);
    }

    /// Bytes held.
    pub(super) fn bytes(&self) -> usize {
        let scratch = self.free.lock().unwrap_or_else(PoisonError::into_inner);
        let sorters = self.sorters.lock().unwrap_or_else(PoisonError::into_inner);
        let portions = scratch.iter().map(|s| s.frusta.bytes() + s.queues.bytes() + s.leaves.bytes());
        portions.chain(sorters.iter().map(RaySorter::bytes)).sum()
    }
}

/// A clone begins with no memory: it may want other queues.
impl Clone for Pool {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// What the stages of a portion hand on.
#[derive(Debug)]
struct Scratch {
    frusta: Frusta,
    queues: Queues,
    leaves: Leaves,
}

impl Scratch {
    fn new(method: &BreadthFirst) -> Self {
        let queue = if method.visit == Visit::BreadthFirst { method.queue } else { 1 };
        Self { frusta: Frusta::default(), queues: Queues::with_capacity(queue), leaves: Leaves::default() }
    }
}

impl BreadthFirst<'_> {
    /// Traces the packets of these runs on all threads.
    pub(super) fn trace<Q: Query>(
        &self,
        rays: &[RayBlock],
        runs: Runs<'_>,
        mut results: &mut [Q::Block],
        cx: &mut Context<'_>,
    ) -> Result<Stages, Error> {
        let mut portions = Vec::new();
        let mut first = 0;
        while first < runs.len() {
            let mut last = first + 1;
            while last < runs.len() && ((runs.blocks(last)[1] - runs.blocks(first)[0]) as usize) <= BLOCKS {
                last += 1;
            }
            let part = runs.part(first, last);
            let [begin, end] = part.all_blocks();
            let (this, rest) = results.split_at_mut(end - begin);
            portions.push(Portion { rays: &rays[begin..end], runs: part, results: this });
            (results, first) = (rest, last);
        }
        let count = cx.counters.is_some();
        let run = |portion: Portion<Q::Block>| {
            cx.check()?;
            let mut scratch = self.pool.take().unwrap_or_else(|| Scratch::new(self));
            let done = self.portion::<Q>(portion, &mut scratch, count);
            self.pool.give_back(scratch);
            Ok(done)
        };
        let zero = || (Stages::default(), Counters::default());
        let add = |a: (Stages, Counters), b: (Stages, Counters)| Ok((a.0 + b.0, a.1 + b.1));
        let (stages, counters) = if rayon::current_num_threads() == 1 {
            portions.into_iter().try_fold(zero(), |sum, portion| add(sum, run(portion)?))?
        } else {
            portions.into_par_iter().map(run).try_reduce(zero, add)?
        };
        if let Some(counted) = &mut cx.counters {
            *counted = *counted + counters;
        }
        Ok(stages)
    }

    fn portion<Q: Query>(&self, portion: Portion<Q::Block>, scratch: &mut Scratch, count: bool) -> (Stages, Counters) {
        let Self { bvh, tree, ref space, level, .. } = *self;
        let Portion { rays, runs, results } = portion;
        let Scratch { frusta, queues, leaves } = scratch;
        if tree.is_empty() {
            results.fill(Q::NOTHING);
            return (Stages::default(), Counters::default());
        }
        let (mut counters, mut visited) = (Counters::default(), crate::stats::Frusta::default());
        let (mut stages, mut clock) = (Stages::default(), Clock::now());
        lanes::run_long(level, self.width, Build { rays, runs, space, frusta });
        stages.frusta = clock.lap();
        let (frusta, width) = (&*frusta, self.width.lanes(level));
        let mut begin = 0;
        // The packets all of whose frusta are through.
        let mut intersect = |captured: &mut Leaves, done: usize| {
            stages.traversal += clock.lap();
            let end = frusta.ends.partition_point(|&end| end as usize <= done);
            if end > begin {
                let (which, leaves, results) = (begin..end, &*captured, &mut *results);
                if count {
                    let count = Counters::default();
                    let job = Intersect::<Q, _> { bvh, tree, space, rays, results, runs, which, frusta, leaves, count };
                    // The work is the same at every level.
                    counters = counters + lanes::run_once(width, job);
                } else {
                    let count = NoCount;
                    let job = Intersect::<Q, _> { bvh, tree, space, rays, results, runs, which, frusta, leaves, count };
                    lanes::run_plain_if_emulated(level, width, job);
                }
                counters.frusta.leaves += captured.forget(frusta.ends[end - 1] as usize) as u64;
                begin = end;
            }
            stages.intersection += clock.lap();
        };
        let counted = if count { Some(&mut visited) } else { None };
        match self.visit {
            Visit::BreadthFirst => queues.traverse(level, tree, &frusta.all, leaves, counted, &mut intersect),
            Visit::DepthFirst => depth_first::traverse(level, tree, &frusta.all, leaves, counted, &mut intersect),
        }
        intersect(leaves, frusta.all.len());
        if count {
            visited.frusta = frusta.all.len() as u64;
            counters.frusta = counters.frusta + visited;
        }
        for &(block, odd) in &frusta.odd {
            self.odd::<Q>(&rays[block as usize], odd, &mut results[block as usize]);
        }
        stages.intersection += clock.elapsed();
        (stages, counters)
    }

    /// Rays that frusta are not for, one by one: rare.
    #[cold]
    fn odd<Q: Query>(&self, rays: &RayBlock, odd: u16, result: &mut Q::Block) {
        for lane in (0..16).filter(|lane| odd >> lane & 1 != 0) {
            let hit = packet::closest(self.bvh, &rays.get(lane));
            if !hit.is_miss() {
                Q::store(result, lane, &hit);
            }
        }
    }
}
