//! Triangles side by side, one to a lane, for a single ray against all of them at once.

use super::{Triangle, Vec3};
use crate::geometry::Hit;
use simd::Float;

/// `W` triangles as structure of arrays: the leaf of a wide tree.
///
/// Lanes past the last triangle hold one without extent, which no ray hits.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(32))]
pub struct TriangleGroup<const W: usize> {
    /// First vertices, by coordinate.
    pub v0: [[f32; W]; 3],
    /// Second vertices minus first.
    pub e1: [[f32; W]; 3],
    /// Third vertices minus first.
    pub e2: [[f32; W]; 3],
    /// Primitive ids; [`Hit::NO_PRIMITIVE`] in lanes without a triangle.
    pub id: [u32; W],
}

impl<const W: usize> TriangleGroup<W> {
    pub(crate) const EMPTY: Self =
        Self { v0: [[0.0; W]; 3], e1: [[0.0; W]; 3], e2: [[0.0; W]; 3], id: [Hit::NO_PRIMITIVE; W] };

    /// Of at most `W` triangles.
    ///
    /// # Panics
    /// If there are more.
    #[must_use]
    pub fn new(triangles: &[Triangle]) -> Self {
        assert!(triangles.len() <= W, "{} triangles in {W} lanes", triangles.len());
        let mut group = Self::EMPTY;
        triangles.iter().enumerate().for_each(|(lane, t)| group.set(lane, t));
        group
    }

    /// Puts a triangle into a lane.
    #[inline]
    pub(crate) fn set(&mut self, lane: usize, t: &Triangle) {
        for axis in 0..3 {
            self.v0[axis][lane] = t.v0[axis];
            self.e1[axis][lane] = t.e1[axis];
            self.e2[axis][lane] = t.e2[axis];
        }
        self.id[lane] = t.id;
    }

    /// The triangle of a lane, if there is one; material and geometry are not known here.
    #[inline(always)]
    pub(crate) fn triangle(&self, lane: usize) -> Option<Triangle> {
        let at = |v: &[[f32; W]; 3]| [v[0][lane], v[1][lane], v[2][lane]];
        let id = self.id[lane];
        let (v0, e1, e2) = (at(&self.v0), at(&self.e1), at(&self.e2));
        (id != Hit::NO_PRIMITIVE).then_some(Triangle { v0, id, e1, material: 0, e2, geometry: 0 })
    }

    /// Lower and upper planes of each triangle's box.
    #[inline(always)]
    pub(crate) fn planes<F: Float>(&self) -> (Vec3<F>, Vec3<F>) {
        let [v0, e1, e2] = self.corner_and_edges::<F>();
        // As in `Triangle::bounds`.
        let (b, c) = (v0 + e1, v0 + e2);
        (b.min(c).min(v0), c.max(b).max(v0))
    }

    /// `v0`, `e1`, `e2` as vectors of `W` lanes.
    #[inline(always)]
    pub(crate) fn corner_and_edges<F: Float>(&self) -> [Vec3<F>; 3] {
        const { assert!(F::LANES == W, "a vector for all triangles") }
        [load(&self.v0), load(&self.e1), load(&self.e2)]
    }
}

#[inline(always)]
fn load<F: Float, const W: usize>(v: &[[f32; W]; 3]) -> Vec3<F> {
    Vec3 { x: F::load(&v[0]), y: F::load(&v[1]), z: F::load(&v[2]) }
}
