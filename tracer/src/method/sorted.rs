//! Rays put into order before they are traced (Garanzha and Loop 2010, section 3.1).

use super::{BitVec, Context, Method};
use crate::Error;
use crate::geometry::{Aabb, HitBatch, RayBatch};
use crate::sort::{RayHash, RaySorter, Reorder};
use simd::Level;
use std::fmt;
use std::sync::{Mutex, PoisonError};

/// A method that is given its rays sorted; the hits come back in the order of the rays. Whatever the rays, they are sorted, those that are in good order
/// already too.
///
/// ```
/// use simd::Level;
/// use tracer::bvh::{BuildConfig, Bvh, CollapseConfig};
/// use tracer::geometry::{HitBatch, Ray, RayBatch};
/// use tracer::method::{Context, Method, Single, Sorted};
/// use tracer::{model::Model, progress::Silent, sort::Reorder};
///
/// # fn main() -> Result<(), tracer::Error> {
/// let (model, _warnings) = Model::open("balls:1", &Silent)?;
/// let tree = Bvh::build(&model.mesh, &BuildConfig::default(), &Silent)?.collapse::<8>(&CollapseConfig::default());
/// let rays: RayBatch = (0..100).map(|i| Ray::new([0.01 * i as f32, 0.0, 5.0], [0.0, 0.0, -1.0])).collect();
/// let (mut hits, mut same) = (HitBatch::new(), HitBatch::new());
/// let single = Single::new(&tree, Level::best());
/// single.closest(&rays, &mut hits, &mut Context::default())?;
/// let sorted = Sorted::new(single, Level::best(), &model.mesh.bounds(), Reorder::Hash);
/// sorted.closest(&rays, &mut same, &mut Context::default())?;
/// assert_eq!(hits.hash(), same.hash());
/// # Ok(())
/// # }
/// ```
pub struct Sorted<M> {
    method: M,
    level: Level,
    hash: RayHash,
    /// For each query that runs at the same time; used again by later ones.
    memory: Mutex<Vec<Memory>>,
}

struct Memory {
    sorter: RaySorter,
    hits: HitBatch,
    occluded: BitVec,
}

impl<M: Method> Sorted<M> {
    /// Before a method, in a scene's box; what sorts runs at a level. With [`Reorder::None`] the method is asked as if it stood alone.
    #[must_use]
    pub fn new(method: M, level: Level, bounds: &Aabb, by: Reorder) -> Self {
        Self::by_hash(method, level, RayHash::new(bounds, by))
    }

    /// By a hash of the caller's.
    #[must_use]
    pub const fn by_hash(method: M, level: Level, hash: RayHash) -> Self {
        Self { method, level, hash, memory: Mutex::new(Vec::new()) }
    }

    /// Orders the rays and gathers them; what `job` finds is its own business.
    fn with_sorted<R>(
        &self,
        rays: &RayBatch,
        cx: &mut Context<'_>,
        job: impl FnOnce(&mut Memory, &mut Context<'_>) -> Result<R, Error>,
    ) -> Result<R, Error> {
        let kept = self.memory.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut memory = kept.unwrap_or_else(|| Memory {
            sorter: RaySorter::new(self.level, self.hash),
            hits: HitBatch::new(),
            occluded: BitVec::new(),
        });
        memory.sorter.order(rays);
        cx.check()?;
        memory.sorter.gather(rays);
        let result = job(&mut memory, cx);
        self.memory.lock().unwrap_or_else(PoisonError::into_inner).push(memory);
        result
    }
}

impl<M: Method> Method for Sorted<M> {
    fn name(&self) -> &'static str {
        "sorted"
    }

    fn source(&self) -> &'static str {
        "Garanzha and Loop 2010, section 3.1"
    }

    fn memory(&self) -> usize {
        let memory = self.memory.lock().unwrap_or_else(PoisonError::into_inner);
        let bytes = |m: &Memory| m.sorter.bytes() + size_of_val(m.hits.blocks()) + size_of_val(m.occluded.words());
        self.method.memory() + memory.iter().map(bytes).sum::<usize>()
    }

    fn closest(&self, rays: &RayBatch, hits: &mut HitBatch, cx: &mut Context<'_>) -> Result<(), Error> {
        if self.hash.key() == Reorder::None {
            return self.method.closest(rays, hits, cx);
        }
        self.with_sorted(rays, cx, |memory, cx| {
            self.method.closest(memory.sorter.rays(), &mut memory.hits, cx)?;
            memory.sorter.put_hits_back(&memory.hits, hits);
            Ok(())
        })
    }

    fn any(&self, rays: &RayBatch, occluded: &mut BitVec, cx: &mut Context<'_>) -> Result<(), Error> {
        if self.hash.key() == Reorder::None {
            return self.method.any(rays, occluded, cx);
        }
        self.with_sorted(rays, cx, |memory, cx| {
            self.method.any(memory.sorter.rays(), &mut memory.occluded, cx)?;
            memory.sorter.put_bits_back(&memory.occluded, occluded);
            Ok(())
        })
    }
}

impl<M: fmt::Debug> fmt::Debug for Sorted<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Sorted").field("method", &self.method).field("hash", &self.hash).finish_non_exhaustive()
    }
}
