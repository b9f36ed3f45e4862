//! The triangle test of Möller & Trumbore 1997, and the exact hit made of it.
//!
//! Their three triple products are turned so that one cross product, of origin and direction, serves both barycentric coordinates, and
//! the other, of the edges, is the triangle's alone: 27 operations for each of several rays instead of 36.

use super::slab::{Near, Origin, PerRay, between, choose, interval, mixed};
use super::{Packet, Triangle, TriangleGroup, Vec3};
use simd::{Float, Mask};

/// A hit per lane, in the lanes that `mask` names.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Candidate<F: Float> {
    pub(crate) mask: F::Mask,
    pub(crate) t: F,
    pub(crate) u: F,
    pub(crate) v: F,
}

/// Rays against one triangle: a function of ray and triangle alone, in strict operations, so that every level, width,
/// traversal order and method finds the same bits.
///
/// A hit counts only where the ray's computed interval in the triangle's own box is not empty; its `t` is clamped to that
/// interval. Boxes on the way can then not reject it (see [`super::slab`]). `None` when no lane is hit.
#[inline(always)]
pub(crate) fn intersect<F: Float, O: Origin<F>>(
    triangle: &Triangle,
    ray: &Packet<F>,
    origin: O,
    near: Near,
) -> Option<Candidate<F>> {
    let inside = Inside::of_triangle(triangle, ray, origin)?;
    let infinity = F::splat(f32::INFINITY);
    Some(inside.candidate(ray, interval(&planes(triangle), ray, origin, near, -infinity, infinity)))
}

/// [`intersect`] of two triangles: neither has to wait for the branch on the other. The second is `None` if it is not hit, and so is the first.
#[inline(always)]
pub(crate) fn intersect_two<F: Float, O: Origin<F>>(
    triangles: &[Triangle; 2],
    ray: &Packet<F>,
    origin: O,
    near: Near,
) -> [Option<Candidate<F>>; 2] {
    let (a, b) = (Inside::find(&triangles[0], ray, origin), Inside::find(&triangles[1], ray, origin));
    let mut found = [None, None];
    if (a.mask | b.mask).none() {
        return found;
    }
    let infinity = F::splat(f32::INFINITY);
    if a.mask.any() {
        found[0] = Some(a.candidate(ray, interval(&planes(&triangles[0]), ray, origin, near, -infinity, infinity)));
    }
    if b.mask.any() {
        found[1] = Some(b.candidate(ray, interval(&planes(&triangles[1]), ray, origin, near, -infinity, infinity)));
    }
    found
}

/// [`intersect`] for rays that point into different octants.
#[inline(always)]
pub(crate) fn intersect_mixed<F: Float>(triangle: &Triangle, ray: &Packet<F>) -> Option<Candidate<F>> {
    let inside = Inside::of_triangle(triangle, ray, PerRay)?;
    let p = planes(triangle);
    let infinity = F::splat(f32::INFINITY);
    let planes = [[p[0]], [p[1]], [p[2]], [p[4]], [p[5]], [p[6]]];
    Some(inside.candidate(ray, mixed(&planes, 0, ray, ray.signs(), -infinity, infinity)))
}

/// One ray, the same in every lane, against a triangle per lane; the same bits as [`intersect`].
#[inline(always)]
pub(crate) fn intersect_group<F: Float, const W: usize>(
    triangles: &TriangleGroup<W>,
    ray: &Packet<F>,
) -> Option<Candidate<F>> {
    let [v0, e1, e2] = triangles.corner_and_edges::<F>();
    let inside = Inside::test(ray.dir, ray.org - v0, [e1, e2], e2.cross(e1))?;
    let (low, high) = triangles.planes::<F>();
    // Not by branches on the octant: the next ray points elsewhere.
    let signs = ray.signs();
    let (near, far) = (choose(signs, high, low), choose(signs, low, high));
    let infinity = F::splat(f32::INFINITY);
    Some(inside.candidate(ray, between(near - ray.org, far - ray.org, ray, -infinity, infinity)))
}

/// Rays inside of their triangles. `u` and `minus_v` are times the determinant's size, `distance` times the determinant.
struct Inside<F: Float> {
    mask: F::Mask,
    u: F,
    minus_v: F,
    distance: F,
    det: F,
}

impl<F: Float> Inside<F> {
    #[inline(always)]
    fn of_triangle<O: Origin<F>>(triangle: &Triangle, ray: &Packet<F>, origin: O) -> Option<Self> {
        let inside = Self::find(triangle, ray, origin);
        if inside.mask.none() { None } else { Some(inside) }
    }

    #[inline(always)]
    fn find<O: Origin<F>>(triangle: &Triangle, ray: &Packet<F>, origin: O) -> Self {
        let lanes = |[x, y, z]: [f32; 3]| Vec3::<f32> { x, y, z };
        let normal = lanes(triangle.e2).cross(lanes(triangle.e1));
        let edges = [Vec3::splat(triangle.e1), Vec3::splat(triangle.e2)];
        Self::of(ray.dir, origin.seen_from(ray, triangle.v0), edges, Vec3::splat([normal.x, normal.y, normal.z]))
    }

    /// `None` when no lane is hit: the division is left to those that are.
    #[inline(always)]
    fn test(dir: Vec3<F>, o: Vec3<F>, edges: [Vec3<F>; 2], normal: Vec3<F>) -> Option<Self> {
        let inside = Self::of(dir, o, edges, normal);
        if inside.mask.none() { None } else { Some(inside) }
    }

    /// From `o = origin - v0` and `normal = e2 x e1`.
    #[inline(always)]
    fn of(dir: Vec3<F>, o: Vec3<F>, [e1, e2]: [Vec3<F>; 2], normal: Vec3<F>) -> Self {
        let det = dir.dot(normal);
        let moment = o.cross(dir);
        let u = e2.dot(moment).mul_sign(det);
        let minus_v = e1.dot(moment).mul_sign(det);
        let size = det.abs();
        let zero = F::splat(0.0);
        // A determinant that is not a normal number has no finite reciprocal.
        let mask = zero.le(u) & minus_v.le(zero) & (u - minus_v).le(size) & F::splat(f32::MIN_POSITIVE).le(size);
        Self { mask, u, minus_v, distance: -o.dot(normal), det }
    }

    /// The hit, given the ray's interval in the triangle's box.
    #[inline(always)]
    fn candidate(self, ray: &Packet<F>, (box_near, box_far): (F, F)) -> Candidate<F> {
        let inv = F::splat(1.0) / self.det.abs();
        // Adding 0 turns -0, which depends on the order of comparisons, into 0.
        let t = (self.distance.mul_sign(self.det) * inv).max(box_near).min(box_far) + F::splat(0.0);
        // The reciprocal of an infinite determinant is 0, and infinity times that no number.
        let mask = self.mask & F::splat(0.0).lt(inv) & box_near.le(box_far) & ray.t_min.le(t) & t.le(ray.t_max);
        Candidate { mask, t, u: self.u * inv, v: (F::splat(0.0) - self.minus_v) * inv }
    }
}

/// [`Triangle::bounds`] in the order of [`Node::planes`](crate::bvh::Node::planes).
#[inline(always)]
fn planes(triangle: &Triangle) -> [f32; 8] {
    let mut planes = [0.0; 8];
    for axis in 0..3 {
        let a = triangle.v0[axis];
        let (b, c) = (a + triangle.e1[axis], a + triangle.e2[axis]);
        let (low, high) = if b < c { (b, c) } else { (c, b) };
        planes[axis] = if low < a { low } else { a };
        planes[axis + 4] = if high > a { high } else { a };
    }
    planes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_are_the_bounds() {
        let t = Triangle::new([[0.1, -0.2, 3.0], [1e8, 0.25, -1.0], [-7.0, 0.3, 3.0]], 0, 0);
        let (p, b) = (planes(&t), t.bounds());
        assert_eq!(([p[0], p[1], p[2]], [p[4], p[5], p[6]]), (b.min, b.max));
    }
}
