//! Shadow rays by the part of the lamp where they end (section 3.1): those to different parts share no frustum.

use tracer::Error;
use tracer::geometry::RayBatch;
use tracer::method::BitVec;

/// A square lamp in `side` x `side` parts, for rays as [`Scene::shadows`](super::scenes::Scene::shadows) makes them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Strata {
    /// Rays of a point.
    samples: usize,
    /// Cells of the samples' grid each way.
    cells: usize,
    /// Parts each way.
    side: usize,
}

impl Strata {
    /// As many parts as are asked for, or as there are samples if they are fewer; both are squares.
    pub fn new(samples: usize, parts: usize) -> Self {
        let cells = samples.isqrt().max(1);
        Self { samples: cells * cells, cells, side: parts.isqrt().clamp(1, cells) }
    }

    /// The part of the lamp to which a ray goes.
    fn of(self, ray: usize) -> usize {
        let (sample, cells, side) = (ray % self.samples, self.cells, self.side);
        sample / cells * side / cells * side + sample % cells * side / cells
    }

    /// Asks for the rays of each part by themselves, and puts the bits where their rays were. Rays in the order of the parts are what a renderer would
    /// make in the first place: they come to `ask` made.
    pub fn each(
        self,
        rays: &RayBatch,
        mut ask: impl FnMut(&RayBatch, &mut BitVec) -> Result<(), Error>,
    ) -> Result<Vec<u16>, Error> {
        let mut words = vec![0; rays.len().div_ceil(16)];
        for part in 0..self.side * self.side {
            let numbers: Vec<usize> = (0..rays.len()).filter(|&ray| self.of(ray) == part).collect();
            let mut bits = BitVec::new();
            ask(&numbers.iter().map(|&ray| rays.get(ray)).collect(), &mut bits)?;
            for (i, ray) in numbers.into_iter().enumerate() {
                words[ray / 16] |= u16::from(bits.get(i)) << (ray % 16);
            }
        }
        Ok(words)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quadrants_of_a_grid_of_four_by_four() {
        let of = |parts| (0..16).map(|ray| Strata::new(16, parts).of(ray)).collect::<Vec<_>>();
        assert_eq!(of(4), [0, 0, 1, 1, 0, 0, 1, 1, 2, 2, 3, 3, 2, 2, 3, 3]);
        assert_eq!(of(16), (0..16).collect::<Vec<_>>());
        assert_eq!(of(1), [0; 16]);
        assert_eq!(Strata::new(1, 16).of(5), 0, "no more parts than samples");
        assert_eq!(Strata::new(4, 4).of(7), 3, "the last ray of the second point");
    }
}
