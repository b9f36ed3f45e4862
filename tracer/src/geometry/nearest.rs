//! The point of a triangle nearest to a point.

use super::Vec3;
use simd::{Float, Mask};

/// The point of a surface that is nearest to some point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// How far it is, in the units of the coordinates.
    pub distance: f32,
    /// Where it is.
    pub point: [f32; 3],
    /// Place of the triangle in the mesh, as in [`Hit`](super::Hit).
    pub primitive: u32,
    /// Barycentric weight of the triangle's second vertex.
    pub u: f32,
    /// Barycentric weight of the triangle's third vertex.
    pub v: f32,
}

/// The nearest point per lane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Foot<F: Float> {
    pub(crate) distance: F,
    pub(crate) point: Vec3<F>,
    pub(crate) u: F,
    pub(crate) v: F,
}

/// The point of a triangle (first vertex, edges) nearest to `p`, of four candidates: the nearest of each side (Ericson 2005, Real-Time
/// Collision Detection, 5.1.2) and the foot on the plane if it is inside (5.1.5, in the form with cross products). Unlike telling apart
/// the seven regions by signs alone, that is right to within rounding for slivers and for points far away as well.
///
/// A function of point and triangle alone, in strict operations. The point found is clamped to the triangle's box, so that on no axis
/// it is nearer to `p`, as computed, than that box or any around it: see [`to_box`].
#[inline(always)]
pub(crate) fn on_triangle<F: Float>(p: Vec3<F>, [v0, e1, e2]: [Vec3<F>; 3]) -> Foot<F> {
    let (zero, one) = (F::splat(0.0), F::splat(1.0));
    // From the vertices a, b, c to the point.
    let (ap, bc) = (p - v0, e2 - e1);
    let bp = ap - e1;

    let (ab_at, ac_at, bc_at) = (on_side(ap, e1), on_side(ap, e2), on_side(bp, bc));
    let (mut u, mut v, mut least) = (ab_at, zero, square(ap - e1.scale(ab_at)));
    let mut consider = |mask: F::Mask, to_u: F, to_v: F, distance: F| {
        let mask = mask & distance.lt(least);
        least = F::select(mask, distance, least);
        u = F::select(mask, to_u, u);
        v = F::select(mask, to_v, v);
    };
    consider(F::Mask::splat(true), zero, ac_at, square(ap - e2.scale(ac_at)));
    consider(F::Mask::splat(true), one - bc_at, bc_at, square(bp - bc.scale(bc_at)));
    // Barycentric weights of the foot on the plane, times the square of the normal.
    let n = e1.cross(e2);
    let (of_a, of_b, of_c) = (n.dot(bc.cross(bp)), n.dot(ap.cross(e2)), n.dot(e1.cross(ap)));
    let all = square(n);
    let in_u = part(of_b / all);
    let in_v = part(of_c / all).min(one - in_u);
    let inside = zero.lt(of_a) & zero.lt(of_b) & zero.lt(of_c);
    consider(inside, in_u, in_v, square(ap - e1.scale(in_u) - e2.scale(in_v)));

    // The box as in `Triangle::bounds`.
    let (to_b, to_c) = (v0 + e1, v0 + e2);
    let (low, high) = (to_b.min(to_c).min(v0), to_c.max(to_b).max(v0));
    let point = (v0 + e1.scale(u) + e2.scale(v)).max(low).min(high);
    Foot { distance: square(p - point).sqrt(), point, u, v }
}

/// Where on a side, from 0 to 1, the point is nearest that is `p` from its start.
#[inline(always)]
fn on_side<F: Float>(p: Vec3<F>, side: Vec3<F>) -> F {
    part(side.dot(p) / square(side))
}

/// Cut to 0 to 1; 0 for what is no number, of sides whose square is none of ordinary size.
#[inline(always)]
fn part<F: Float>(x: F) -> F {
    x.max(F::splat(0.0)).min(F::splat(1.0))
}

#[inline(always)]
fn square<F: Float>(v: Vec3<F>) -> F {
    v.dot(v)
}

/// How far the point of a box nearest to `p` is.
///
/// Never more than what [`on_triangle`] computes for a triangle in the box, without any margin: on each axis, a plane of the box lies
/// between `p` and the triangle's point or at it (or the box reaches over `p`, and the difference here is 0), and rounded subtraction,
/// multiplication, addition and square root are monotone: `a <= b` gives `fl(a) <= fl(b)`, in the same order of operations.
#[inline(always)]
pub(crate) fn to_box<F: Float>(p: Vec3<F>, low: Vec3<F>, high: Vec3<F>) -> F {
    square((low - p).max(p - high).max(Vec3::splat([0.0; 3]))).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Triangle;
    use crate::scene::random::Random;

    fn vec3([x, y, z]: [f32; 3]) -> Vec3<f32> {
        Vec3 { x, y, z }
    }

    fn foot(p: [f32; 3], t: &Triangle) -> Foot<f32> {
        on_triangle(vec3(p), [t.v0, t.e1, t.e2].map(vec3))
    }

    /// In `f64`, another way: the foot on the plane if it is inside, else the nearest point of the three sides.
    fn distance(p: [f32; 3], t: &Triangle) -> f64 {
        let [p, v0, e1, e2] = [p, t.v0, t.e1, t.e2].map(|v| v.map(f64::from));
        let sub = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let along = |a: [f64; 3], s: f64, b: [f64; 3]| [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
        let length = |a: [f64; 3]| dot(a, a).sqrt();
        let side = |from: [f64; 3], edge: [f64; 3]| {
            let s = (dot(sub(p, from), edge) / dot(edge, edge)).clamp(0.0, 1.0);
            length(sub(p, along(from, s, edge)))
        };
        let sides = side(v0, e1).min(side(v0, e2)).min(side(along(v0, 1.0, e1), sub(e2, e1)));
        let (q, g11, g12, g22) = (sub(p, v0), dot(e1, e1), dot(e1, e2), dot(e2, e2));
        let det = g11 * g22 - g12 * g12;
        let u = (g22 * dot(e1, q) - g12 * dot(e2, q)) / det;
        let v = (g11 * dot(e2, q) - g12 * dot(e1, q)) / det;
        if u >= 0.0 && v >= 0.0 && u + v <= 1.0 {
            sides.min(length(sub(q, along(along([0.0; 3], u, e1), v, e2))))
        } else {
            sides
        }
    }

    #[test]
    fn all_seven_regions() {
        let t = Triangle::new([[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], 0, 0);
        for (p, point, u, v, distance) in [
            ([1.0, 1.0, 3.0], [1.0, 1.0, 0.0], 0.25, 0.25, 3.0),
            ([1.0, 1.0, 0.0], [1.0, 1.0, 0.0], 0.25, 0.25, 0.0),
            ([-3.0, -4.0, 0.0], [0.0; 3], 0.0, 0.0, 5.0),
            ([7.0, -4.0, 0.0], [4.0, 0.0, 0.0], 1.0, 0.0, 5.0),
            ([-4.0, 7.0, 0.0], [0.0, 4.0, 0.0], 0.0, 1.0, 5.0),
            ([1.0, -3.0, -4.0], [1.0, 0.0, 0.0], 0.25, 0.0, 5.0),
            ([-3.0, 1.0, 4.0], [0.0, 1.0, 0.0], 0.0, 0.25, 5.0),
            ([5.0, 5.0, 0.0], [2.0, 2.0, 0.0], 0.5, 0.5, 18_f32.sqrt()),
            ([4.0, 0.0, 2.0], [4.0, 0.0, 0.0], 1.0, 0.0, 2.0),
        ] {
            let foot = foot(p, &t);
            let found = ([foot.point.x, foot.point.y, foot.point.z], foot.u, foot.v, foot.distance);
            assert_eq!(found, (point, u, v, distance), "{p:?}");
        }
    }

    /// As exact as the coordinates are, however far the point is; and never nearer than the box.
    #[test]
    fn random_points_and_triangles() {
        let mut random = Random(1);
        let mut worst = 0.0_f64;
        for i in 0..200_000 {
            let size = [1.0, 1e-3, 10.0][i % 3];
            let at = random.point(1.0);
            // Every fifth a sliver.
            let (along, thin) = (random.point(size), if i % 5 == 0 { 1e-6 } else { 1.0 });
            let mut corner = || {
                let (d, s) = (random.point(size * thin), random.between(-1.0, 1.0));
                [0, 1, 2].map(|k| at[k] + d[k] + if thin < 1.0 { s * along[k] } else { 0.0 })
            };
            let t = Triangle::new([corner(), corner(), corner()], 0, 0);
            if t.is_degenerate() {
                continue;
            }
            let p = random.point([1.0, 3.0, 1000.0, 1e6][i % 4]);
            let (foot, exact) = (foot(p, &t), distance(p, &t));
            let scale = p.iter().chain(&t.v0).chain(&t.e1).chain(&t.e2).fold(0.0_f32, |a, x| a.max(x.abs()));
            worst = worst.max((f64::from(foot.distance) - exact).abs() / f64::from(scale));
            let bounds = t.bounds();
            assert!(to_box(vec3(p), vec3(bounds.min), vec3(bounds.max)) <= foot.distance, "{p:?} {t:?}");
            assert!(foot.u >= 0.0 && foot.v >= 0.0 && foot.u + foot.v <= 1.0 + f32::EPSILON);
        }
        println!(
            "worst error: {:.1} units in the last place of the largest coordinate",
            worst / f64::from(f32::EPSILON)
        );
        assert!(worst < 8.0 * f64::from(f32::EPSILON), "{worst:e}");
    }

    /// Also where a side lies in a face of the box and the point above it, so that rounding has no room.
    #[test]
    fn the_box_is_never_farther_than_the_triangle() {
        let mut random = Random(3);
        let mut equal = 0;
        for _ in 0..100_000 {
            let (mut b, mut c) = (random.point(1.0), random.point(1.0));
            b[2] = random.between(0.5, 1.0);
            c[2] = b[2];
            let t = Triangle::new([random.point(0.5), b, c], 0, 0);
            let s = random.between(0.0, 1.0);
            let p = [b[0] + s * (c[0] - b[0]), b[1] + s * (c[1] - b[1]), b[2] + random.between(0.0, 1e-3)];
            let (distance, bounds) = (foot(p, &t).distance, t.bounds());
            let of_box = to_box(vec3(p), vec3(bounds.min), vec3(bounds.max));
            assert!(of_box <= distance, "{p:?} {t:?}: {of_box}, {distance}");
            equal += u32::from(of_box == distance);
        }
        assert!(equal > 1000, "{equal}");
    }

    #[test]
    fn extreme_numbers_give_weights() {
        let mut random = Random(2);
        for i in 0..20_000 {
            let size = [1e-30, 1e-22, 1e19, 1e37][i % 4];
            let t = Triangle::new([random.point(size), random.point(size), random.point(size)], 0, 0);
            let p = random.point([1.0, 1e-25, 1e25, 3e38][i / 4 % 4]);
            let (foot, bounds) = (foot(p, &t), t.bounds());
            assert!((0.0..=1.0).contains(&foot.u) && (0.0..=1.0).contains(&foot.v) && foot.distance >= 0.0);
            assert!(to_box(vec3(p), vec3(bounds.min), vec3(bounds.max)) <= foot.distance);
        }
    }
}
