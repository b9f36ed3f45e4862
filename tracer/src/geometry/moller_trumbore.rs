//! The triangle test of Möller & Trumbore 1997, and the exact hit made of it.

use super::slab::{Near, Origin, interval};
use super::{Packet, Triangle, Vec3};
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
    let (e1, e2) = (Vec3::splat(triangle.e1), Vec3::splat(triangle.e2));
    let (from_v0, q, distance) = origin.triangle_terms(ray, triangle);
    let p = ray.dir.cross(e2);
    // Everything times the determinant's sign; the division is left to packets that hit.
    let det = e1.dot(p);
    let u = from_v0.dot(p).mul_sign(det);
    let v = ray.dir.dot(q).mul_sign(det);
    let size = det.abs();
    let zero = F::splat(0.0);
    // A determinant that is not a normal number has no finite reciprocal.
    let inside = zero.le(u) & zero.le(v) & (u + v).le(size) & F::splat(f32::MIN_POSITIVE).le(size);
    if inside.none() {
        return None;
    }

    let infinity = F::splat(f32::INFINITY);
    let (box_near, box_far) = interval(&planes(triangle), ray, origin, near, -infinity, infinity);
    let inv = F::splat(1.0) / size;
    // Adding 0 turns -0, which depends on the order of comparisons, into 0.
    let t = (distance.mul_sign(det) * inv).max(box_near).min(box_far) + zero;
    let mask = inside & box_near.le(box_far) & ray.t_min.le(t) & t.le(ray.t_max);
    Some(Candidate { mask, t, u: u * inv, v: v * inv })
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
