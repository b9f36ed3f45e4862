//! What builders sort: a triangle's box and its id, in two 16-byte blocks that the compiler turns into vectors.

use super::triangle;
use crate::geometry::Aabb;
use crate::geometry::aabb::{max, min, zip};
use crate::model::Mesh;
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
        Self { min: zip(self.min, &b.min, min), max: zip(self.max, &b.max, max) }
    }

    /// As [`Aabb::half_area`], but infinite for an empty box.
    #[inline(always)]
    pub(super) fn half_area(&self) -> f32 {
        let e = zip(self.max, &self.min, |a, b| a - b);
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

    /// Twice the middle of the box along an axis.
    #[inline(always)]
    pub(super) fn center(&self, axis: usize) -> f32 {
        self.0.min[axis] + self.0.max[axis]
    }
}

/// The box around all.
pub(super) fn union(primitives: &[Primitive]) -> Box4 {
    primitives.iter().fold(Box4::EMPTY, |b, p| b.union(&p.0))
}

/// The box of the centers.
pub(super) fn centers(primitives: &[Primitive]) -> Box4 {
    primitives.iter().fold(Box4::EMPTY, |b, p| {
        let center = zip(p.0.min, &p.0.max, |a, b| a + b);
        b.union(&Box4 { min: center, max: center })
    })
}

/// All triangles that are not degenerate, in the order of the mesh.
pub(super) fn primitives(mesh: &Mesh) -> Vec<Primitive> {
    primitives_by(mesh, |id| {
        let t = triangle(mesh, id);
        if t.is_degenerate() { Aabb::EMPTY } else { t.bounds() }
    })
}

/// All triangles whose vertices differ, slivers among them, in boxes around the vertices as given and as stored.
pub(super) fn slivers_too(mesh: &Mesh) -> Vec<Primitive> {
    primitives_by(mesh, |id| {
        let (vertices @ [a, b, c], stored) = (mesh.triangle(id as usize), triangle(mesh, id).bounds());
        let differ = a != b && b != c && c != a;
        if differ && stored.is_finite() { stored.union(&Aabb::of_points(vertices)) } else { Aabb::EMPTY }
    })
}

fn primitives_by(mesh: &Mesh, bounds: impl Fn(u32) -> Aabb + Sync) -> Vec<Primitive> {
    // Marks those without a box first and removes them then, since only a parallel iterator of known length writes in place.
    let ids = (0..mesh.triangles.len() as u32).into_par_iter();
    let mut all: Vec<Primitive> = ids.map(|id| Primitive::new(&bounds(id), id)).collect();
    all.retain(|p| p.0.min[0] != f32::INFINITY);
    all
}
