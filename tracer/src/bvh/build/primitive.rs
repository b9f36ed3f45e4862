//! What builders sort: a triangle's box and its id, in eight lanes.

use super::triangle;
use crate::geometry::Aabb;
use crate::geometry::aabb::{min, zip};
use crate::model::Mesh;
use rayon::prelude::*;
use simd::{Halves, Simd, Vector};

/// A box as its lower corner and, from lane 4 on, the negative of its upper one, so that a union is one minimum. Lanes 3 and 7 mean
/// nothing to a box, but are always normal numbers (denormals are slow).
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct Box8(pub(crate) [f32; 8]);

impl Box8 {
    pub(crate) const EMPTY: Self = Self([f32::INFINITY; 8]);

    /// With a number for lanes 3 and 7.
    pub(crate) fn new(b: &Aabb, tag: f32) -> Self {
        Self([b.min[0], b.min[1], b.min[2], tag, -b.max[0], -b.max[1], -b.max[2], tag])
    }

    #[inline(always)]
    pub(crate) fn load<S: Simd>(&self) -> S::Float8 {
        S::Float8::load(&self.0)
    }

    #[inline(always)]
    pub(crate) fn store<S: Simd>(&mut self, b: S::Float8) {
        b.store(&mut self.0);
    }

    #[inline(always)]
    pub(crate) fn union(&self, b: &Self) -> Self {
        Self(zip(self.0, &b.0, min))
    }

    /// Whether it holds nothing.
    pub(crate) fn is_empty(&self) -> bool {
        self.0[0] == f32::INFINITY
    }

    /// Length along an axis.
    #[inline(always)]
    pub(crate) fn extent(&self, axis: usize) -> f32 {
        -self.0[4 + axis] - self.0[axis]
    }

    /// As [`Aabb::half_area`], but infinite for an empty box.
    #[inline(always)]
    pub(crate) fn half_area(&self) -> f32 {
        let (x, y, z) = (self.extent(0), self.extent(1), self.extent(2));
        x * y + y * z + z * x
    }

    pub(crate) fn aabb(&self) -> Aabb {
        let [x, y, z, _, to_x, to_y, to_z, _] = self.0;
        Aabb { min: [x, y, z], max: [-to_x, -to_y, -to_z] }
    }
}

/// A triangle's box, with its id in lanes 3 and 7.
#[derive(Debug, Clone, Copy)]
pub(super) struct Primitive(pub(super) Box8);

impl Primitive {
    /// Added to the id, makes it the bits of a normal float: ids are below 2^28.
    const TAG: u32 = 0x4000_0000;

    pub(super) fn new(b: &Aabb, id: u32) -> Self {
        Self(Box8::new(b, f32::from_bits(id + Self::TAG)))
    }

    #[inline(always)]
    pub(super) fn id(&self) -> u32 {
        self.0.0[3].to_bits() - Self::TAG
    }

    /// Twice the middle of the box along an axis.
    #[inline(always)]
    pub(super) fn center(&self, axis: usize) -> f32 {
        self.0.0[axis] - self.0.0[4 + axis]
    }

    /// [`Primitive::center`] along all axes, and zero.
    #[inline(always)]
    pub(super) fn centers<S: Simd>(&self) -> S::Float4 {
        let b = self.0.load::<S>();
        b.low() - b.high()
    }
}

/// Twice the middle of a box, as a box.
pub(crate) fn centers_of(b: &Box8) -> Box8 {
    let mut centers = *b;
    for axis in 0..3 {
        let center = b.0[axis] - b.0[4 + axis];
        (centers.0[axis], centers.0[4 + axis]) = (center, -center);
    }
    centers
}

/// The box around all.
pub(super) fn union(primitives: &[Primitive]) -> Box8 {
    primitives.iter().fold(Box8::EMPTY, |b, p| b.union(&p.0))
}

/// The box of the centers.
pub(super) fn centers(primitives: &[Primitive]) -> Box8 {
    let mut all = Box8::EMPTY;
    for p in primitives {
        for axis in 0..4 {
            let center = p.center(axis);
            (all.0[axis], all.0[4 + axis]) = (min(all.0[axis], center), min(all.0[4 + axis], -center));
        }
    }
    all
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
    let mut all = simd::vec_in_huge_pages(mesh.triangles.len());
    ids.map(|id| Primitive::new(&bounds(id), id)).collect_into_vec(&mut all);
    all.retain(|p| p.0.0[0] != f32::INFINITY);
    all
}
