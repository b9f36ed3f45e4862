//! Ways to find out which points are in shadow, on the same rays in turn.

use super::scenes::Scene;
use super::strata::Strata;
use crate::report::clock::{median, timed};
use serde::Serialize;
use simd::Level;
use tracer::Error;
use tracer::bvh::OctoBvh;
use tracer::geometry::{HitBatch, RayBatch};
use tracer::method::{Auto, BitVec, BreadthFirst, Context, Method, Packet, Single, Stages, Visit, Width};
use tracer::sort::{RayHash, RaySorter, Reorder};
use tracer::stats::{Counters, Frusta};

/// What is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Query {
    /// Whether anything is hit.
    Any,
    /// What is hit first.
    Closest,
}

/// A way to be measured.
pub enum Way<'a> {
    /// A method as it is.
    Plain(Box<dyn Method + 'a>),
    /// A method whose rays are sorted before; the sorter keeps its memory from batch to batch, as frusta do.
    Sorted(Box<dyn Method + 'a>, Box<RaySorter>),
    /// By frusta, with times of the stages.
    Frusta(BreadthFirst<'a>),
    /// The same, rays to each part of the lamp by themselves.
    Strata(BreadthFirst<'a>, Strata),
}

/// What it took, in seconds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Times {
    /// Sorting rays and putting results back.
    pub sort: f64,
    /// Frusta around packets.
    pub frusta: f64,
    /// Frusta through the tree.
    pub traversal: f64,
    /// Rays against triangles, or all that a method does.
    pub intersection: f64,
}

impl Times {
    pub fn all(&self) -> f64 {
        self.sort + self.not_sort()
    }

    pub fn not_sort(&self) -> f64 {
        self.frusta + self.traversal + self.intersection
    }

    /// Of stages that were measured by the clock on the wall, so that they sum up to the CPU time of all.
    fn of(stages: Stages, seconds: f64) -> Self {
        let stages = [stages.sort, stages.frusta, stages.traversal, stages.intersection].map(|time| time.as_secs_f64());
        let all: f64 = stages.iter().sum();
        let [sort, frusta, traversal, intersection] =
            stages.map(|time| if all > 0.0 { time * seconds / all } else { 0.0 });
        Self { sort, frusta, traversal, intersection }
    }

    fn add(&mut self, o: &Self) {
        self.sort += o.sort;
        self.frusta += o.frusta;
        self.traversal += o.traversal;
        self.intersection += o.intersection;
    }

    /// The median of each stage.
    fn median(rounds: &[Self]) -> Self {
        let of = |stage: fn(&Self) -> f64| median(&rounds.iter().map(stage).collect::<Vec<_>>());
        Self {
            sort: of(|t| t.sort),
            frusta: of(|t| t.frusta),
            traversal: of(|t| t.traversal),
            intersection: of(|t| t.intersection),
        }
    }
}

/// A way with its name and its times, one for each round.
pub struct Racer<'a> {
    pub name: String,
    pub way: Way<'a>,
    rounds: Vec<Times>,
}

/// What was found of it.
#[derive(Debug, Clone, Serialize)]
pub struct Found {
    pub name: String,
    pub times: Times,
}

impl<'a> Racer<'a> {
    pub fn new(name: &str, way: Way<'a>) -> Self {
        Self { name: name.to_owned(), way, rounds: Vec::new() }
    }

    /// The median of its rounds.
    pub fn found(&self) -> Found {
        Found { name: self.name.clone(), times: Times::median(&self.rounds) }
    }

    /// Frusta over a tree of a scene.
    pub fn frusta(scene: &'a Scene, tree: &'a OctoBvh, hash: RayHash, packet: usize, visit: Visit) -> BreadthFirst<'a> {
        let method = BreadthFirst::new(&scene.bvh, tree, Level::best(), Width::Auto);
        method.with_sort(Some(hash)).with_packet(packet).with_visit(visit)
    }

    /// Asks; the answer as a hash.
    fn ask(&mut self, query: Query, rays: &RayBatch, cx: &mut Context<'_>) -> Result<(Times, u64), Error> {
        let (mut hits, mut bits) = (HitBatch::new(), BitVec::new());
        let times = match &mut self.way {
            Way::Plain(method) => {
                Times { intersection: find(&**method, query, rays, &mut hits, &mut bits, cx)?, ..Times::default() }
            }
            Way::Sorted(method, sorter) => {
                let ((), before) = timed(|| {
                    sorter.order(rays);
                    sorter.gather(rays);
                });
                let (mut sorted_hits, mut sorted_bits) = (HitBatch::new(), BitVec::new());
                let intersection = find(&**method, query, sorter.rays(), &mut sorted_hits, &mut sorted_bits, cx)?;
                let ((), after) = timed(|| match query {
                    Query::Any => sorter.put_bits_back(&sorted_bits, &mut bits),
                    Query::Closest => sorter.put_hits_back(&sorted_hits, &mut hits),
                });
                Times { sort: before + after, intersection, ..Times::default() }
            }
            Way::Frusta(method) => {
                let (stages, seconds) = timed(|| match query {
                    Query::Any => method.any_in_stages(rays, &mut bits, cx),
                    Query::Closest => method.closest_in_stages(rays, &mut hits, cx),
                });
                Times::of(stages?, seconds)
            }
            Way::Strata(method, strata) => {
                let mut times = Times::default();
                let words = strata.each(rays, |rays, bits| {
                    let (stages, seconds) = timed(|| method.any_in_stages(rays, bits, cx));
                    times.add(&Times::of(stages?, seconds));
                    Ok(())
                })?;
                return Ok((times, hash_of(rays.len(), &words)));
            }
        };
        let hash = match query {
            Query::Closest => hits.hash(),
            Query::Any => hash_of(bits.len(), bits.words()),
        };
        Ok((times, hash))
    }
}

/// Of the bits of a number of rays.
fn hash_of(len: usize, words: &[u16]) -> u64 {
    words.iter().fold(len as u64, |hash, &word| hash.wrapping_mul(0x100_0000_01b3) ^ u64::from(word))
}

/// The seconds that a method takes.
fn find(
    method: &dyn Method,
    query: Query,
    rays: &RayBatch,
    hits: &mut HitBatch,
    bits: &mut BitVec,
    cx: &mut Context<'_>,
) -> Result<f64, Error> {
    let (done, seconds) = timed(|| match query {
        Query::Any => method.any(rays, bits, cx),
        Query::Closest => method.closest(rays, hits, cx),
    });
    done.map(|()| seconds)
}

/// The methods that frusta are compared with: single rays and the fastest, as rays come and sorted.
pub fn rivals<'a>(scene: &'a Scene, hash: RayHash) -> Vec<Racer<'a>> {
    let level = Level::best();
    let wide = || Box::new(Single::new(&scene.wide, level));
    vec![
        Racer::new("wide", Way::Plain(wide())),
        Racer::new("wide, sorted", Way::Sorted(wide(), Box::new(RaySorter::new(level, hash)))),
        Racer::new("auto", Way::Plain(Box::new(Auto::new(&scene.wide, level)))),
        Racer::new("packet", Way::Plain(Box::new(Packet::new(&scene.bvh, level, Width::Auto)))),
    ]
}

/// The frusta in their variants.
pub fn frusta(scene: &Scene) -> Vec<Racer<'_>> {
    let hash = RayHash::new(&scene.bounds, Reorder::Origin);
    let of = |tree, visit| Way::Frusta(Racer::frusta(scene, tree, hash, 256, visit));
    vec![
        Racer::new("frusta, breadth first", of(&scene.octo, Visit::BreadthFirst)),
        Racer::new("frusta, two children a node", of(&scene.halves, Visit::BreadthFirst)),
        Racer::new("frusta, depth first", of(&scene.octo, Visit::DepthFirst)),
    ]
}

/// Frusta for each of 4 and of 16 parts of the lamp, for so many shadow rays a point.
pub fn strata(scene: &Scene, samples: usize) -> Vec<Racer<'_>> {
    let hash = RayHash::new(&scene.bounds, Reorder::Origin);
    let of = |parts| {
        let method = Racer::frusta(scene, &scene.octo, hash, 256, Visit::BreadthFirst);
        Racer::new(&format!("frusta, lamp in {parts}"), Way::Strata(method, Strata::new(samples, parts)))
    };
    vec![of(4), of(16)]
}

/// Times all on each batch in turn, another one first in each round; all must find the same.
pub fn race(
    racers: &mut [Racer<'_>],
    query: Query,
    batches: &[RayBatch],
    repeat: usize,
    cx: &mut Context<'_>,
) -> Result<(), Error> {
    for racer in &mut *racers {
        racer.rounds = vec![Times::default(); repeat];
    }
    let n = racers.len();
    for rays in batches {
        let mut expected = None;
        // The first round warms up.
        for round in 0..=repeat {
            for i in 0..n {
                let racer = &mut racers[(i + round) % n];
                let (times, found) = racer.ask(query, rays, cx)?;
                if *expected.get_or_insert(found) != found {
                    let name = &racer.name;
                    return Err(Error::Geometry(format!("{name} found other hits than the others: that is a fault")));
                }
                if let Some(sum) = round.checked_sub(1).map(|round| &mut racer.rounds[round]) {
                    sum.add(&times);
                }
            }
        }
    }
    Ok(())
}

/// What frusta count on some rays.
pub fn count(method: &BreadthFirst<'_>, rays: &RayBatch, cx: &mut Context<'_>) -> Result<Frusta, Error> {
    let mut counting = Context { counters: Some(Counters::default()), cancel: cx.cancel };
    method.any(rays, &mut BitVec::new(), &mut counting)?;
    Ok(counting.counters.unwrap_or_default().frusta)
}
