//! Rays that go on and rays to lights, one after the other, with what belongs to them.

use crate::geometry::{RayBatch, Vec3};
use simd::{Float, Mask, Vector};
use std::ops::Range;

/// Lists of equal length that grow by the lanes that are on.
#[derive(Debug, Clone)]
pub(super) struct Lists<const N: usize> {
    floats: [Vec<f32>; N],
    /// Place of the ray's pixel in the wave.
    pub(super) slots: Vec<u32>,
    len: usize,
}

impl<const N: usize> Lists<N> {
    pub(super) fn new() -> Self {
        Self { floats: [const { Vec::new() }; N], slots: Vec::new(), len: 0 }
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    pub(super) fn is_empty(&self) -> bool {
        self.len == 0
    }

    pub(super) fn list(&self, number: usize) -> &[f32] {
        &self.floats[number][..self.len]
    }

    /// Makes room for as many rows more.
    pub(super) fn reserve(&mut self, rows: usize) {
        // Whole vectors are written.
        self.floats.iter_mut().for_each(|list| list.resize(self.len + rows + 16, 0.0));
        self.slots.resize(self.len + rows + 16, 0);
    }

    /// Appends the lanes that are on, for which there is room.
    #[inline(always)]
    pub(super) fn push<F: Float>(&mut self, on: F::Mask, values: [F; N], slots: F::Index) {
        for (list, value) in self.floats.iter_mut().zip(values) {
            value.compress_store(on, &mut list[self.len..]);
        }
        slots.compress_store(on, &mut self.slots[self.len..]);
        self.len += on.count();
    }

    /// Forgets all rows and keeps the memory.
    pub(super) fn clear(&mut self) {
        self.len = 0;
    }

    /// Appends some rows of another.
    pub(super) fn append(&mut self, other: &Self, rows: Range<usize>) {
        for i in 0..N {
            self.floats[i].truncate(self.len);
            self.floats[i].extend_from_slice(&other.list(i)[rows.clone()]);
        }
        self.slots.truncate(self.len);
        self.slots.extend_from_slice(&other.slots[rows.clone()]);
        self.len += rows.len();
    }
}

impl Lists<10> {
    /// What belongs to eye rays: all of the light is theirs, and what shines is found by chance alone. (The rays themselves are not in it.)
    pub(super) fn of_eye(len: usize) -> Self {
        let mut lists = Self::new();
        lists.reserve(len);
        lists.len = len;
        for number in THROUGHPUT..THROUGHPUT + 3 {
            lists.floats[number].fill(1.0);
        }
        lists.floats[DENSITY].fill(f32::INFINITY);
        lists.slots.iter_mut().zip(0..).for_each(|(slot, i)| *slot = i);
        lists
    }
}

/// Origin 0..3, direction 3..6, throughput 6..9, density 9.
pub(super) type Paths = Lists<10>;
pub(super) const THROUGHPUT: usize = 6;
pub(super) const DENSITY: usize = 9;

/// Origin 0..3, direction 3..6, what comes along it if nothing is in between 6..9, the end of the interval 9.
pub(super) type Shadows = Lists<10>;
pub(super) const CONTRIBUTION: usize = 6;
pub(super) const END: usize = 9;

/// Fills a batch with the rays of such lists, from 0 to the end of each interval.
pub(super) fn fill(batch: &mut RayBatch, lists: &Lists<10>, starts: &mut Vec<f32>, ends: &[f32]) {
    batch.clear();
    starts.resize(lists.len().max(starts.len()), 0.0);
    let three = |first| [lists.list(first), lists.list(first + 1), lists.list(first + 2)];
    batch.extend_from_arrays(three(0), three(3), &starts[..lists.len()], ends);
}

/// The columns of vectors and numbers, side by side.
#[inline(always)]
pub(super) fn ten<F: Float>(a: Vec3<F>, b: Vec3<F>, c: Vec3<F>, last: F) -> [F; 10] {
    [a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, last]
}
