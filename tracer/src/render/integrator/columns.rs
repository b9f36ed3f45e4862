//! Numbers of a portion of rays between the steps of its shading, a column for each.

use crate::geometry::Vec3;
use simd::Float;

/// Rays of a portion.
pub(super) const ROWS: usize = 1024;

/// `N` columns of [`ROWS`] numbers.
#[derive(Debug, Clone)]
pub(super) struct Columns<const N: usize>(Vec<f32>);

impl<const N: usize> Columns<N> {
    pub(super) fn new() -> Self {
        Self(vec![0.0; N * ROWS])
    }

    #[inline(always)]
    pub(super) fn column(&self, number: usize) -> &[f32] {
        &self.0[number * ROWS..][..ROWS]
    }

    #[inline(always)]
    fn column_mut(&mut self, number: usize) -> &mut [f32] {
        &mut self.0[number * ROWS..][..ROWS]
    }

    /// `F::LANES` rows from `first` on.
    #[inline(always)]
    pub(super) fn load<F: Float>(&self, number: usize, first: usize) -> F {
        F::load(&self.column(number)[first..])
    }

    /// Three columns of them.
    #[inline(always)]
    pub(super) fn load3<F: Float>(&self, number: usize, first: usize) -> Vec3<F> {
        Vec3 { x: self.load(number, first), y: self.load(number + 1, first), z: self.load(number + 2, first) }
    }

    #[inline(always)]
    pub(super) fn store<F: Float>(&mut self, number: usize, first: usize, x: F) {
        x.store(&mut self.column_mut(number)[first..]);
    }

    #[inline(always)]
    pub(super) fn store3<F: Float>(&mut self, number: usize, first: usize, v: Vec3<F>) {
        self.store(number, first, v.x);
        self.store(number + 1, first, v.y);
        self.store(number + 2, first, v.z);
    }

    /// The rows of the lanes that are on.
    #[inline(always)]
    pub(super) fn get<F: Float>(&self, number: usize, rows: Rows<F>) -> F {
        rows.of(self.column(number))
    }

    #[inline(always)]
    pub(super) fn get3<F: Float>(&self, number: usize, rows: Rows<F>) -> Vec3<F> {
        Vec3 { x: self.get(number, rows), y: self.get(number + 1, rows), z: self.get(number + 2, rows) }
    }

    #[inline(always)]
    pub(super) fn set<F: Float>(&mut self, number: usize, rows: Rows<F>, x: F) {
        x.scatter_masked(self.column_mut(number), rows.index, rows.on);
    }

    #[inline(always)]
    pub(super) fn set3<F: Float>(&mut self, number: usize, rows: Rows<F>, v: Vec3<F>) {
        self.set(number, rows, v.x);
        self.set(number + 1, rows, v.y);
        self.set(number + 2, rows, v.z);
    }
}

/// A row for each lane that is on.
#[derive(Clone, Copy)]
pub(super) struct Rows<F: Float> {
    pub(super) index: F::Index,
    pub(super) on: F::Mask,
}

impl<F: Float> Rows<F> {
    /// Of a list that is as long as the portion.
    #[inline(always)]
    pub(super) fn of(self, column: &[f32]) -> F {
        F::gather_masked(column, self.index, self.on, F::splat(0.0))
    }
}
