//! The watertight triangle test of Woop, Benthin and Wald 2013 ("Watertight Ray/Triangle Intersection", Journal of Computer Graphics
//! Techniques 2(1)): a ray cannot slip through between triangles that share an edge or a vertex.
//!
//! The ray is sheared into an axis; what it does to a vertex depends on that vertex and the ray alone, so neighbours see the vertices
//! that they share in the same place of the plane. On which side of an edge the ray passes is a difference of two products: rounding is
//! monotone, so its sign is right unless it is zero, and then `f64` has the products exactly. So for every edge
//! both neighbours decide alike: the hits are those of a plane figure without gaps, its borders included.
//!
//! # Boxes
//!
//! That figure is not quite where the triangles are. With `u = EPSILON / 2`, and `D` the largest |vertex - origin| of any coordinate, a
//! sheared coordinate `x - s z` has errors of `u D` in `x`, `u D` in `z` (the shear `s` is at most 1), `u D` from the rounding of `s`,
//! `u D` from that of the product and `2 u D` from that of the difference: `3 EPSILON D`. The ray
//! passes no farther than that from a point of the triangle on two axes, and reaches its very coordinate on the third. So boxes that are
//! wider by `4 EPSILON D` all around are met by the ray, whatever the origin is, and then rounding in the box test is
//! what [`Packet::PAD`] covers. The widening is put into the origins of the near and the far planes, which
//! takes no time; their rounding adds `EPSILON` times the largest coordinate of the origin.
//!
//! Distances are clamped to the interval that the ray has in the triangle's own widened box. As in [`super::slab`] no box around it
//! can then reject a hit that counts: hits do not depend on the tree.

use super::slab::{Near, between};
use super::{Aabb, Hit, Packet, Vec3};
use crate::geometry::moller_trumbore::Candidate;
use simd::{Block, Float, Mask};

/// Triangles in a group.
const W: usize = 4;

/// Four triangles by their vertices as given: a vertex that triangles share is the same in all of them.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct VertexGroup {
    /// By vertex, then coordinate.
    vertices: [[[f32; W]; 3]; 3],
    pub(crate) id: [u32; W],
    /// Lanes with a triangle, a bit each.
    used: u32,
}

impl VertexGroup {
    /// Of the triangles with these ids, [`Hit::NO_PRIMITIVE`] where there is none.
    pub(crate) fn new(id: [u32; W], triangle: impl Fn(u32) -> [[f32; 3]; 3]) -> Self {
        let mut group = Self { vertices: [[[0.0; W]; 3]; 3], id, used: 0 };
        for lane in (0..W).filter(|&lane| id[lane] != Hit::NO_PRIMITIVE) {
            group.used |= 1 << lane;
            for (to, from) in group.vertices.iter_mut().zip(triangle(id[lane])) {
                for axis in 0..3 {
                    to[axis][lane] = from[axis];
                }
            }
        }
        group
    }

    /// Vertex `i` of each, its coordinates in the order of `axes`.
    #[inline(always)]
    fn vertex<F: Float>(&self, i: usize, axes: [usize; 3]) -> Vec3<F> {
        const { assert!(F::LANES == W, "a lane for each triangle") }
        let v = &self.vertices[i];
        Vec3 { x: F::load(&v[axes[0] % 3]), y: F::load(&v[axes[1] % 3]), z: F::load(&v[axes[2] % 3]) }
    }
}

/// A ray as the test needs it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sheared {
    pub(crate) ray: Packet<f32>,
    pub(crate) near: Near,
    /// Axes in an order that has the one along which the ray is fastest last.
    axes: [usize; 3],
    /// Slopes of the ray over the last of the axes.
    slope: [f32; 2],
    /// Origins for the near and the far planes of boxes.
    near_org: Vec3<f32>,
    far_org: Vec3<f32>,
}

impl Sheared {
    /// `bounds` are around all vertices of the scene.
    #[inline(always)]
    pub(crate) fn new(ray: Packet<f32>, octant: usize, bounds: &Aabb) -> Self {
        let (org, dir) = ([ray.org.x, ray.org.y, ray.org.z], [ray.dir.x, ray.dir.y, ray.dir.z]);
        let [x, y, z] = [dir[0].abs(), dir[1].abs(), dir[2].abs()];
        let last = if x >= y && x >= z { 0 } else { 2 - usize::from(y > z) };
        let axes = [(last + 1) % 3, (last + 2) % 3, last];
        let (mut distance, mut size) = (0.0_f32, 0.0_f32);
        for ((&x, &low), &high) in org.iter().zip(&bounds.min).zip(&bounds.max) {
            distance = distance.max(high - x).max(x - low);
            size = size.max(x.abs());
        }
        let wider = f32::EPSILON * (4.0 * distance + size);
        let near = Near::of_octant(octant);
        let (lower, upper) = (moved(ray.org, -wider), moved(ray.org, wider));
        Self {
            ray,
            near,
            axes,
            slope: [dir[axes[0]] / dir[last], dir[axes[1]] / dir[last]],
            near_org: near.choose(upper, lower),
            far_org: near.choose(lower, upper),
        }
    }

    /// In every lane.
    #[inline(always)]
    pub(crate) fn splat<F: Float>(&self) -> Lanes<F> {
        let all = |v: Vec3<f32>| Vec3::splat([v.x, v.y, v.z]);
        Lanes { ray: self.ray.splat(), near_org: all(self.near_org), far_org: all(self.far_org) }
    }
}

/// All coordinates farther by `by`, and finite: the infinite box of a child that is none shall stay infinitely far.
#[inline(always)]
fn moved(v: Vec3<f32>, by: f32) -> Vec3<f32> {
    let finite = |x: f32| (x + by).clamp(f32::MIN, f32::MAX);
    Vec3 { x: finite(v.x), y: finite(v.y), z: finite(v.z) }
}

/// What box tests need of a [`Sheared`] ray, the same in every lane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lanes<F: Float> {
    ray: Packet<F>,
    near_org: Vec3<F>,
    far_org: Vec3<F>,
}

impl<F: Float> Lanes<F> {
    /// The interval that the ray has in each of the widened boxes, cut by `from` and `to`.
    #[inline(always)]
    pub(crate) fn interval(&self, near: Vec3<F>, far: Vec3<F>, from: F, to: F) -> (F, F) {
        between(near - self.near_org, far - self.far_org, &self.ray, from, to)
    }
}

/// The hits of a ray with four triangles up to a distance of `reach`.
#[inline(always)]
pub(crate) fn intersect<F: Float>(
    group: &VertexGroup,
    sheared: &Sheared,
    lanes: &Lanes<F>,
    reach: f32,
) -> Option<Candidate<F>> {
    let (ray, axes, zero) = (&sheared.ray, sheared.axes, F::splat(0.0));
    let o = [ray.org.x, ray.org.y, ray.org.z];
    let org = Vec3::splat([o[axes[0] % 3], o[axes[1] % 3], o[axes[2] % 3]]);
    let slope = [F::splat(sheared.slope[0]), F::splat(sheared.slope[1])];
    let a = shear(group.vertex(0, axes) - org, slope);
    let b = shear(group.vertex(1, axes) - org, slope);
    let c = shear(group.vertex(2, axes) - org, slope);
    // On which side of each edge the ray passes: the weights of the vertices opposite.
    let (wa, wb, wc) = (c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x);
    let outside = (wa.lt(zero) | wb.lt(zero) | wc.lt(zero)) & (wa.gt(zero) | wb.gt(zero) | wc.gt(zero));
    let bits = !outside.bitmask() & group.used;
    if bits == 0 {
        return None;
    }
    let det = wa + wb + wc;
    let inv = F::splat(1.0) / det;
    let (u, v) = (wb * inv, wc * inv);
    let dir = [ray.dir.x, ray.dir.y, ray.dir.z][axes[2] % 3];
    let t = (wa * inv * a.z + u * b.z + v * c.z) / F::splat(dir);
    // Safely between what is too small for a reciprocal and what is too large. No NaN passes.
    let size = det.abs();
    let sure = wa.ne(zero) & wb.ne(zero) & wc.ne(zero) & F::splat(1e-30).lt(size) & size.lt(F::splat(1e30));
    let doubtful = bits & !sure.bitmask();
    let (mut found, mut t, mut u, mut v) = (bits & !doubtful, t, u, v);
    if doubtful != 0 {
        let mut hits = [t.to_block(), u.to_block(), v.to_block()];
        found |= in_f64(doubtful, &[blocks(a), blocks(b), blocks(c)], dir, &mut hits);
        [t, u, v] = [F::load_block(&hits[0], 0), F::load_block(&hits[1], 0), F::load_block(&hits[2], 0)];
    }
    let (box_near, box_far) = own_boxes(group, sheared.near, lanes);
    let t = t.max(box_near).min(box_far) + zero;
    let mask = F::Mask::from_bitmask(found) & box_near.le(box_far) & lanes.ray.t_min.le(t) & t.le(F::splat(reach));
    Some(Candidate { mask, t, u, v })
}

#[inline(always)]
fn shear<F: Float>(v: Vec3<F>, slope: [F; 2]) -> Vec3<F> {
    Vec3 { x: v.x - slope[0] * v.z, y: v.y - slope[1] * v.z, z: v.z }
}

/// The intervals of the ray in the triangles' boxes.
#[inline(always)]
fn own_boxes<F: Float>(group: &VertexGroup, near: Near, lanes: &Lanes<F>) -> (F, F) {
    const XYZ: [usize; 3] = [0, 1, 2];
    let [a, b, c] = [group.vertex::<F>(0, XYZ), group.vertex(1, XYZ), group.vertex(2, XYZ)];
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let infinity = F::splat(f32::INFINITY);
    lanes.interval(near.choose(low, high), near.choose(high, low), -infinity, infinity)
}

/// The test of some lanes where `f32` does not suffice: which are hit, and where. Products are exact.
#[inline(never)]
fn in_f64(mut lanes: u32, [a, b, c]: &[[Block<f32>; 3]; 3], dir: f32, hits: &mut [Block<f32>; 3]) -> u32 {
    let mut found = 0;
    while lanes != 0 {
        let lane = lanes.trailing_zeros() as usize % W;
        lanes &= lanes - 1;
        let at = |v: &[Block<f32>; 3]| [f64::from(v[0].0[lane]), f64::from(v[1].0[lane]), f64::from(v[2].0[lane])];
        let (a, b, c) = (at(a), at(b), at(c));
        let (wa, wb, wc) = (c[0] * b[1] - c[1] * b[0], a[0] * c[1] - a[1] * c[0], b[0] * a[1] - b[1] * a[0]);
        let inside = (wa >= 0.0 && wb >= 0.0 && wc >= 0.0) || (wa <= 0.0 && wb <= 0.0 && wc <= 0.0);
        let det = wa + wb + wc;
        // Seen from the edge there is no triangle: its neighbours meet there.
        if !inside || det == 0.0 {
            continue;
        }
        found |= 1 << lane;
        // Adding 0 turns -0 into 0.
        let (u, v) = (wb / det + 0.0, wc / det + 0.0);
        hits[0].0[lane] = ((wa / det * a[2] + u * b[2] + v * c[2]) / f64::from(dir)) as f32;
        hits[1].0[lane] = u as f32;
        hits[2].0[lane] = v as f32;
    }
    found
}

#[inline(always)]
fn blocks<F: Float>(v: Vec3<F>) -> [Block<f32>; 3] {
    [v.x.to_block(), v.y.to_block(), v.z.to_block()]
}
