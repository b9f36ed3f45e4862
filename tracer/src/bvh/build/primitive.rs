//! What builders sort: a triangle's box and its id, in two 16-byte blocks that the compiler turns into vectors.

use super::triangle;
use crate::geometry::Aabb;
use crate::scene::Mesh;
use rayon::prelude::*;

/// A box padded to four lanes. The fourth means nothing to a box, but is always a normal number (denormals are slow).
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(super) struct Box4 {
    pub(super) min: [f32; 4],
    pub(super) max: [f32; 4],
}

impl Box4 {
    pub(super) const EMPTY: Self = Self { min: [f32::INFINITY; 4], max: [f32::NEG_INFINITY; 4] };

    #[inline(always)]
    pub(super) fn union(&self, b: &Self) -> Self {
        let min = |a: f32, b: f32| if a < b { a } else { b };
        let max = |a: f32, b: f32| if a > b { a } else { b };
        Self {
            min: std::array::from_fn(|i| min(self.min[i], b.min[i])),
            max: std::array::from_fn(|i| max(self.max[i], b.max[i])),
        }
    }

    #[inline(always)]
    pub(super) fn grow(&mut self, p: [f32; 4]) {
        *self = self.union(&Self { min: p, max: p });
    }

    /// As [`Aabb::half_area`], but infinite for an empty box.
    #[inline(always)]
    pub(super) fn half_area(&self) -> f32 {
        let e: [f32; 4] = std::array::from_fn(|i| self.max[i] - self.min[i]);
        e[0] * e[1] + e[1] * e[2] + e[2] * e[0]
    }

    pub(super) fn aabb(&self) -> Aabb {
        let xyz = |[x, y, z, _]: [f32; 4]| [x, y, z];
        Aabb { min: xyz(self.min), max: xyz(self.max) }
    }
}

/// A triangle's box, with its id in the fourth lane of `min`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Primitive(pub(super) Box4);

impl Primitive {
    /// Added to the id, makes it the bits of a normal float: ids are below 2^28.
    const TAG: u32 = 0x4000_0000;

    pub(super) fn new(b: &Aabb, id: u32) -> Self {
        let pad = |[x, y, z]: [f32; 3]| [x, y, z, f32::from_bits(id + Self::TAG)];
        Self(Box4 { min: pad(b.min), max: pad(b.max) })
    }

    #[inline(always)]
    pub(super) fn id(&self) -> u32 {
        self.0.min[3].to_bits() - Self::TAG
    }

    /// Half the middle of the box, so that not even the difference of two of them overflows.
    #[inline(always)]
    pub(super) fn center(&self) -> [f32; 4] {
        std::array::from_fn(|i| 0.25 * self.0.min[i] + 0.25 * self.0.max[i])
    }
}

/// All triangles that are not degenerate, in the order of the mesh.
pub(super) fn primitives(mesh: &Mesh) -> Vec<Primitive> {
    (0..mesh.triangles.len() as u32)
        .into_par_iter()
        .filter_map(|id| {
            let t = triangle(mesh, id);
            (!t.is_degenerate()).then(|| Primitive::new(&t.bounds(), id))
        })
        .collect()
}
