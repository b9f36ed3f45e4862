//! The hit of a ray and a triangle, and of a ray and all triangles, in plain `f32` and without any tree: written a second time,
//! from the definition in the documentation, as the yardstick for every method.

use tracer::geometry::{Hit, Ray, Triangle};
use tracer::model::Mesh;

type Vec3 = [f32; 3];

fn dot(a: Vec3, b: Vec3) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The ray as the documentation of [`Ray`] says it counts; `None` if it can hit nothing.
fn clean(ray: &Ray) -> Option<Ray> {
    let dir = ray.dir.map(|d| if d.abs() < f32::MIN_POSITIVE { 0.0_f32.copysign(d) } else { d });
    let finite = ray.org.iter().chain(&dir).all(|x| x.is_finite());
    let t_min = if ray.t_min > 0.0 { ray.t_min } else { 0.0 };
    (finite && dir != [0.0; 3] && ray.t_min <= ray.t_max).then_some(Ray { dir, t_min, ..*ray })
}

/// Möller & Trumbore 1997, its distance clamped to the ray's interval in the triangle's box.
fn hit(ray: &Ray, triangle: &Triangle) -> Option<Hit> {
    let &Triangle { v0, e1, e2, .. } = triangle;
    let from_v0 = sub(ray.org, v0);
    let (normal, moment) = (cross(e2, e1), cross(from_v0, ray.dir));
    let det = dot(ray.dir, normal);
    let sign = 1.0_f32.copysign(det);
    let (u, v) = (sign * dot(e2, moment), 0.0 - sign * dot(e1, moment));
    let det = det.abs();
    if !(det.is_normal() && u >= 0.0 && v >= 0.0 && u + v <= det) {
        return None;
    }
    let inv = 1.0 / det;

    let (mut near, mut far) = (f32::NEG_INFINITY, f32::INFINITY);
    for axis in 0..3 {
        let vertices = [v0[axis], v0[axis] + e1[axis], v0[axis] + e2[axis]];
        let low = vertices.into_iter().fold(f32::INFINITY, f32::min);
        let high = vertices.into_iter().fold(f32::NEG_INFINITY, f32::max);
        let d = ray.dir[axis];
        let inv = 1.0 / if d == 0.0 { f32::MIN_POSITIVE.copysign(d) } else { d };
        let (enter, leave) = if inv < 0.0 { (high, low) } else { (low, high) };
        near = near.max((enter - ray.org[axis]) * inv);
        far = far.min((leave - ray.org[axis]) * (inv * (1.0 + 4.0 * f32::EPSILON)));
    }
    if near > far {
        return None;
    }
    let t = (-sign * dot(from_v0, normal) * inv).max(near).min(far) + 0.0;
    (ray.t_min <= t && t <= ray.t_max).then_some(Hit { t, u: u * inv, v: v * inv, primitive: triangle.id })
}

/// The triangles of a mesh that can be hit.
#[must_use]
pub fn triangles(mesh: &Mesh) -> Vec<Triangle> {
    let all = (0..mesh.triangles.len()).map(|i| Triangle::new(mesh.triangle(i), i as u32, mesh.material(i)));
    all.filter(|t| !t.is_degenerate()).collect()
}

/// The first hit; the lower primitive among equally distant ones.
#[must_use]
pub fn closest(ray: &Ray, triangles: &[Triangle]) -> Hit {
    let Some(ray) = clean(ray) else { return Hit::MISS };
    let hits = triangles.iter().filter_map(|t| hit(&ray, t));
    hits.fold(Hit::MISS, |best, h| if (h.t, h.primitive) < (best.t, best.primitive) { h } else { best })
}
