//! Rays of a portion by the model of the material that they hit: "we reorder the shading requests by grouping them by material model using a
//! single linear pass over the shading points" (Boulos 2008, section 4.6).

use super::columns::{ROWS, Rows};
use crate::render::material::{Dielectric, Glossy, Lambertian, Mirror, Model};
use simd::{Float, Integer, Mask, Vector};

/// The model of rays that hit nothing.
pub(super) const NOTHING: u32 = 4;

/// For each model the rows that it has, in vectors.
#[derive(Debug, Clone)]
pub(super) struct Groups {
    rows: [Vec<u32>; 4],
    /// Lanes that are on, for each vector.
    lanes: [Vec<u32>; 4],
}

/// Something to be done with rows of one model at a time.
pub(super) trait Step<F: Float> {
    /// Mark it `#[inline(always)]`.
    fn run<M: Model>(&mut self, rows: Rows<F>);
}

impl Groups {
    pub(super) fn new() -> Self {
        Self { rows: [const { Vec::new() }; 4], lanes: [const { Vec::new() }; 4] }
    }

    /// From the models of the rows. Rows of a model come together if that is wanted, and all lanes have something to do; else
    /// each vector of rows is looked at for each model that it has, as it is.
    #[inline(always)]
    pub(super) fn set<F: Float>(&mut self, models: &[u32; ROWS], len: usize, together: bool) {
        for model in 0..4 {
            let (rows, lanes) = (&mut self.rows[model], &mut self.lanes[model]);
            rows.resize(ROWS + 16, 0);
            lanes.clear();
            let (mut first, mut n) = (0, 0);
            while first < len {
                let on = F::Index::load(&models[first..]).eq(F::Index::splat(model as u32));
                let index = F::Index::splat(1).prefix_sum_exclusive() + F::Index::splat(first as u32);
                if together {
                    n += index.compress_store(on, &mut rows[n..]);
                } else if on.any() {
                    index.store(&mut rows[n..]);
                    lanes.push(on.bitmask());
                    n += F::LANES;
                }
                first += F::LANES;
            }
            if together {
                let vectors = n.div_ceil(F::LANES);
                lanes.extend((0..vectors).map(|i| F::Mask::first_n(n - i * F::LANES).bitmask()));
            }
        }
    }

    /// Takes a step with all rows.
    #[inline(always)]
    pub(super) fn each<F: Float, S: Step<F>>(&self, step: &mut S) {
        self.of_model::<F, Lambertian, S>(0, step);
        self.of_model::<F, Glossy, S>(1, step);
        self.of_model::<F, Mirror, S>(2, step);
        self.of_model::<F, Dielectric, S>(3, step);
    }

    #[inline(always)]
    fn of_model<F: Float, M: Model, S: Step<F>>(&self, model: usize, step: &mut S) {
        for (i, &lanes) in self.lanes[model].iter().enumerate() {
            let index = F::Index::load(&self.rows[model][i * F::LANES..]);
            step.run::<M>(Rows { index, on: F::Mask::from_bitmask(lanes) });
        }
    }
}
