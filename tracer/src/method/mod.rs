//! Ways of finding hits, all behind [`Method`]: rays in, hits out, the same bits from every one of them.

mod auto;
mod breadth_first;
pub(crate) mod chosen;
mod divide_conquer;
mod found;
pub(crate) mod nearest;
mod packet;
pub(crate) mod query;
mod ready;
mod reordering;
pub(crate) mod search;
mod single;
mod sorted;
mod walk;
mod watertight;

pub use crate::lanes::Width;
pub use auto::{Auto, Limits};
pub use breadth_first::{BreadthFirst, Stages, Visit};
pub use divide_conquer::{DivideConquer, DivideLimits, Filtering, Phases, Sharing, TriangleBoxes};
pub use packet::{Order, Packet, SharedOrigin, SlabForm};
pub use reordering::{Intervals, Partition, Reordering, Traversal};
pub use single::Single;
pub use sorted::Sorted;
pub use walk::{Arity, Wide};
pub(crate) use watertight::Vertices;
pub use watertight::Watertight;

use crate::Error;
use crate::geometry::{HitBatch, RayBatch, RayBlock};
use crate::parallel::{PORTION, portions};
use crate::stats::Counters;
use std::ops::Add;
use std::sync::atomic::{AtomicBool, Ordering};

/// A way of finding hits.
pub trait Method: Send + Sync {
    /// Short name, as reports show it.
    fn name(&self) -> &'static str;

    /// The paper and section it comes from.
    fn source(&self) -> &'static str;

    /// Bytes it holds beside the tree it was given.
    fn memory(&self) -> usize;

    /// The first hit of every ray.
    ///
    /// # Errors
    /// [`Error::Cancelled`] when the context's flag was raised; `hits` is then of no use.
    fn closest(&self, rays: &RayBatch, hits: &mut HitBatch, cx: &mut Context<'_>) -> Result<(), Error>;

    /// Whether each ray hits anything at all.
    ///
    /// # Errors
    /// [`Error::Cancelled`] when the context's flag was raised; `occluded` is then of no use.
    fn any(&self, rays: &RayBatch, occluded: &mut BitVec, cx: &mut Context<'_>) -> Result<(), Error>;
}

/// Behind a box, so that a method can be chosen at run time where another holds it.
impl<M: Method + ?Sized> Method for Box<M> {
    fn name(&self) -> &'static str {
        (**self).name()
    }

    fn source(&self) -> &'static str {
        (**self).source()
    }

    fn memory(&self) -> usize {
        (**self).memory()
    }

    fn closest(&self, rays: &RayBatch, hits: &mut HitBatch, cx: &mut Context<'_>) -> Result<(), Error> {
        (**self).closest(rays, hits, cx)
    }

    fn any(&self, rays: &RayBatch, occluded: &mut BitVec, cx: &mut Context<'_>) -> Result<(), Error> {
        (**self).any(rays, occluded, cx)
    }
}

/// What a query is given beside its rays: whether to count, and a flag to stop it.
#[derive(Debug, Default)]
pub struct Context<'a> {
    /// Work done so far is added here; `None` compiles counting away.
    pub counters: Option<Counters>,
    /// Raised from another thread to stop early.
    pub cancel: Option<&'a AtomicBool>,
}

impl Context<'_> {
    /// # Errors
    /// [`Error::Cancelled`] when the flag is up.
    pub fn check(&self) -> Result<(), Error> {
        let cancelled = self.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed));
        if cancelled { Err(Error::Cancelled) } else { Ok(()) }
    }
}

/// Runs a kernel on portions of `size` blocks of rays, on all threads; whether to count is its first argument, and what it counted is added to the
/// context's.
fn in_portions<B: Send>(
    size: usize,
    rays: &RayBatch,
    results: &mut [B],
    cx: &mut Context<'_>,
    kernel: impl Fn(bool, &[RayBlock], &mut [B]) -> Counters + Sync,
) -> Result<(), Error> {
    let count = cx.counters.is_some();
    let portion = |_, rays: &[RayBlock], results: &mut [B]| {
        cx.check()?;
        Ok(kernel(count, rays, results))
    };
    let done = portions(size, rays.blocks(), results, portion, Counters::default, Counters::add)?;
    if let Some(counters) = &mut cx.counters {
        *counters = counters.add(done);
    }
    Ok(())
}

/// One bit per ray, sixteen to a word as rays are sixteen to a block.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct BitVec {
    words: Vec<u16>,
    len: usize,
}

impl BitVec {
    /// No bits yet; methods make it as long as their rays.
    #[must_use]
    pub const fn new() -> Self {
        Self { words: Vec::new(), len: 0 }
    }

    /// Number of bits.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.len
    }

    /// True when there are none.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Bit `i`.
    ///
    /// # Panics
    /// If `i >= len()`.
    #[must_use]
    pub fn get(&self, i: usize) -> bool {
        assert!(i < self.len, "bit {i} of {}", self.len);
        self.words[i / 16] >> (i % 16) & 1 != 0
    }

    /// Number of ones.
    #[must_use]
    pub fn count_ones(&self) -> usize {
        self.words.iter().map(|w| w.count_ones() as usize).sum()
    }

    /// The bits of each block of rays; those past [`BitVec::len`] are zero.
    #[must_use]
    pub fn words(&self) -> &[u16] {
        &self.words
    }

    pub(crate) fn resize(&mut self, len: usize) -> &mut [u16] {
        self.len = len;
        self.words.resize(len.div_ceil(16), 0);
        &mut self.words
    }
}
