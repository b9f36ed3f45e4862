//! A portion of packets through all stages, and all portions on all threads.

use super::build::{Build, Frusta};
use super::depth_first;
use super::intersect::Intersect;
use super::leaves::Leaves;
use super::queue::Queues;
use super::{BreadthFirst, Stages, Visit};
use crate::Error;
use crate::geometry::RayBlock;
use crate::lanes;
use crate::method::packet::found::Query;
use crate::method::{Context, packet};
use crate::stats::{Counters, NoCount};
use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Packets in a portion.
const PACKETS: usize = 64;

/// Some packets, and where their results go.
struct Portion<'a, B> {
    rays: &'a [RayBlock],
    /// First block of each packet, and the end of the last, from the beginning of the portion.
    bases: Vec<u32>,
    results: &'a mut [B],
}

/// Memory that is kept from one portion to the next: each thread takes what is free.
#[derive(Debug, Default)]
pub(super) struct Pool(Mutex<Vec<Scratch>>);

impl Pool {
    fn take(&self) -> Option<Scratch> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).pop()
    }

    fn give_back(&self, scratch: Scratch) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(scratch);
    }

    /// Bytes of memory, used or not.
    pub(super) fn bytes(&self) -> usize {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).iter().map(|scratch| scratch.queues.bytes()).sum()
    }
}

/// A clone begins with no memory: it may want other queues.
impl Clone for Pool {
    fn clone(&self) -> Self {
        Self::default()
    }
}

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
    /// Traces packets, each of which is the blocks between two of `bases`, on all threads.
    pub(super) fn trace<Q: Query>(
        &self,
        rays: &[RayBlock],
        bases: &[u32],
        mut results: &mut [Q::Block],
        cx: &mut Context<'_>,
    ) -> Result<Stages, Error> {
        let mut portions = Vec::new();
        let mut first = 0;
        while first + 1 < bases.len() {
            let last = (first + PACKETS).min(bases.len() - 1);
            let (begin, end) = (bases[first] as usize, bases[last] as usize);
            let (this, rest) = results.split_at_mut(end - begin);
            let bases = bases[first..=last].iter().map(|base| base - begin as u32).collect();
            portions.push(Portion { rays: &rays[begin..end], bases, results: this });
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

    fn portion<Q: Query>(
        &self,
        portion: Portion<Q::Block>,
        scratch: &mut Scratch,
        count: bool,
    ) -> (Stages, Counters) {
        let Self { bvh, tree, ref space, level, .. } = *self;
        let Portion { rays, ref bases, results } = portion;
        let Scratch { frusta, queues, leaves } = scratch;
        if tree.is_empty() {
            results.fill(Q::NOTHING);
            return (Stages::default(), Counters::default());
        }
        let mut counters = Counters::default();
        let begin = Instant::now();
        lanes::run_long(level, self.width, Build { rays, bases, space, frusta });
        let built = Instant::now();
        let counted = if count { Some(&mut counters.frusta) } else { None };
        match self.visit {
            Visit::BreadthFirst => queues.traverse(level, tree, &frusta.all, leaves, counted),
            Visit::DepthFirst => depth_first::traverse(level, tree, &frusta.all, leaves, counted),
        }
        let traversed = Instant::now();
        let width = self.width.lanes(level);
        if count {
            counters.frusta.frusta = frusta.all.len() as u64;
            counters.frusta.leaves = leaves.nodes.len() as u64;
            let (frusta, leaves, count) = (&*frusta, &*leaves, Counters::default());
            // The work is the same at every level.
            let job = Intersect::<Q, _> { bvh, tree, space, rays, results, bases, frusta, leaves, count };
            counters = counters + lanes::run_scalar(width, job);
        } else {
            let (frusta, leaves, count) = (&*frusta, &*leaves, NoCount);
            let job = Intersect::<Q, _> { bvh, tree, space, rays, results, bases, frusta, leaves, count };
            lanes::run_plain_if_emulated(level, width, job);
        }
        for &(block, odd) in &frusta.odd {
            self.odd::<Q>(&rays[block as usize], odd, &mut results[block as usize]);
        }
        let stages = Stages {
            frusta: built - begin,
            traversal: traversed - built,
            intersection: traversed.elapsed(),
            ..Stages::default()
        };
        (stages, counters)
    }

    /// Rays that frusta are not for, one by one: rare.
    #[cold]
    fn odd<Q: Query>(&self, rays: &RayBlock, odd: u16, result: &mut Q::Block) {
        for lane in (0..16).filter(|lane| odd >> lane & 1 != 0) {
            let hit = packet::closest(self.bvh, &rays.get(lane));
            if !hit.is_miss() {
                Q::put(result, lane, &hit);
            }
        }
    }
}
