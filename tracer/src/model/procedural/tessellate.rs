//! Spheres, cones and rectangles as triangles, as the SPD's library cuts them at resolution 4.

use crate::model::Mesh;
use crate::model::vec3::{Vec3, add, cross, length, narrow, normalize, scale, sin_cos, sub};
use std::collections::HashMap;

/// A sphere is a cube blown up, each face cut into `RESOLUTION` x `RESOLUTION` cells by equally spaced great circles.
const RESOLUTION: usize = 4;
/// Triangles of a sphere.
pub(super) const SPHERE_TRIANGLES: u64 = 6 * 2 * (RESOLUTION * RESOLUTION) as u64;
/// Sides of a cone or cylinder.
const SIDES: u32 = 8;
/// Triangles of a cone or cylinder.
pub(super) const CONE_TRIANGLES: u64 = 2 * SIDES as u64;

/// Collects triangles. Vertices and normals are shared within a body and numbered in order of their first use.
pub(super) struct Tessellator {
    pub mesh: Mesh,
    sphere: UnitSphere,
    /// Where the normals that all spheres share begin.
    sphere_normals: Option<u32>,
}

struct UnitSphere {
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl Tessellator {
    /// With room for a known number of triangles.
    pub(super) fn new(triangles: usize) -> Self {
        let mesh = Mesh {
            triangles: Vec::with_capacity(triangles),
            normal_indices: Vec::with_capacity(triangles),
            materials: Vec::with_capacity(triangles),
            ..Mesh::default()
        };
        Self { mesh, sphere: UnitSphere::new(), sphere_normals: None }
    }

    /// A flat rectangle, corners counter-clockwise as seen from its front.
    pub(super) fn rectangle(&mut self, corners: [[f32; 3]; 4], material: u32) {
        let first = next(&self.mesh.positions);
        self.mesh.positions.extend(corners);
        for [a, b] in [[1, 2], [2, 3]] {
            self.triangle([0, a, b].map(|v| first + v), Mesh::FLAT, material);
        }
    }

    pub(super) fn sphere(&mut self, center: Vec3, radius: f64, material: u32) {
        let mesh = &mut self.mesh;
        let normals = *self.sphere_normals.get_or_insert_with(|| {
            let first = next(&mesh.normals);
            mesh.normals.extend(self.sphere.points.iter().map(|&p| narrow(p)));
            first
        });
        let first = next(&mesh.positions);
        mesh.positions.extend(self.sphere.points.iter().map(|&p| narrow(add(center, scale(p, radius)))));
        for t in &self.sphere.triangles {
            mesh.triangles.push(t.map(|v| first + v));
            mesh.normal_indices.push(t.map(|v| normals + v));
            mesh.materials.push(material);
        }
    }

    /// The side of a truncated cone (a cylinder when both radii are the same), without its ends.
    pub(super) fn cone(&mut self, [base, apex]: [Vec3; 2], [base_radius, apex_radius]: [f64; 2], material: u32) {
        let along = sub(apex, base);
        let height = length(along);
        let axis = scale(along, 1.0 / height);
        // The seam lies along axis x Z; any other direction serves when the axis is Z.
        let seam = cross(axis, [0.0, 0.0, 1.0]);
        let seam = if length(seam) > 1e-9 { normalize(seam) } else { [1.0, 0.0, 0.0] };
        let across = cross(axis, seam);
        let radial: [Vec3; SIDES as usize] = std::array::from_fn(|k| {
            let (sin, cos) = sin_cos(360.0 / f64::from(SIDES) * k as f64);
            add(scale(seam, cos), scale(across, sin))
        });
        let normal = |&r: &Vec3| narrow(normalize(add(scale(r, height), scale(axis, base_radius - apex_radius))));
        let (p, n) = (next(&self.mesh.positions), next(&self.mesh.normals));
        self.mesh.normals.extend(radial.iter().map(normal));
        // In order of first use: 0 and 1 below, 1 and 0 above, then 2 below, 2 above, 3 below ...
        let lower = |k: usize| narrow(add(base, scale(radial[k], base_radius)));
        let upper = |k: usize| narrow(add(apex, scale(radial[k], apex_radius)));
        self.mesh.positions.extend([lower(0), lower(1), upper(1), upper(0)]);
        self.mesh.positions.extend((2..SIDES as usize).flat_map(|k| [lower(k), upper(k)]));
        let below = |k: u32| p + if k < 2 { k } else { 2 * k };
        let above = |k: u32| p + if k < 2 { 3 - k } else { 2 * k + 1 };
        for k in 0..SIDES {
            let j = (k + 1) % SIDES;
            self.triangle([below(k), below(j), above(j)], [n + k, n + j, n + j], material);
            self.triangle([below(k), above(j), above(k)], [n + k, n + j, n + k], material);
        }
    }

    fn triangle(&mut self, vertices: [u32; 3], normals: [u32; 3], material: u32) {
        self.mesh.triangles.push(vertices);
        self.mesh.normal_indices.push(normals);
        self.mesh.materials.push(material);
    }
}

impl UnitSphere {
    fn new() -> Self {
        const LAST: usize = RESOLUTION;
        let mut sphere = Self { points: Vec::new(), triangles: Vec::new() };
        let mut numbers = HashMap::new();
        let mut vertex = |grid: [usize; 3]| -> u32 {
            *numbers.entry(grid).or_insert_with(|| {
                sphere.points.push(normalize(grid.map(on_cube)));
                next(&sphere.points) - 1
            })
        };
        for face in 0..6 {
            let (axis, side) = (face / 2, face % 2 * LAST);
            for (i, j) in (0..LAST).flat_map(|i| (0..LAST).map(move |j| (i, j))) {
                // (axis, u, v) turn right-handed, so going from u to v is counter-clockwise seen from the plus side.
                let mut corner = |u: usize, v: usize| {
                    let mut grid = [side; 3];
                    [grid[(axis + 1) % 3], grid[(axis + 2) % 3]] = [u, v];
                    vertex(grid)
                };
                let mut cell = [corner(i, j), 0, 0, 0];
                let (second, last) = if side == 0 { ((i, j + 1), (i + 1, j)) } else { ((i + 1, j), (i, j + 1)) };
                cell[1] = corner(second.0, second.1);
                cell[2] = corner(i + 1, j + 1);
                cell[3] = corner(last.0, last.1);
                sphere.triangles.extend([[cell[0], cell[1], cell[2]], [cell[0], cell[2], cell[3]]]);
            }
        }
        sphere
    }
}

/// Coordinate on the cube [-1, 1] of a grid line: the tangent of angles equally spaced from -45 to 45 degrees.
fn on_cube(line: usize) -> f64 {
    let degrees = 90.0 * line as f64 / RESOLUTION as f64 - 45.0;
    let (sin, cos) = sin_cos(degrees);
    sin / cos
}

/// The number that the next element of a list will have; generators check their size before they begin, so it fits.
pub(super) fn next<T>(list: &[T]) -> u32 {
    list.len() as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::vec3::{dot, wide};

    #[test]
    fn a_sphere_is_closed_round_and_shares_its_vertices() {
        let mut t = Tessellator::new(192);
        let (center, radius) = ([1.0, -2.0, 3.0], 0.5);
        t.sphere(center, radius, 0);
        let m = &t.mesh;
        assert_eq!((m.triangles.len(), m.positions.len(), m.normals.len()), (192, 98, 98));
        assert_eq!(m.triangles.len() as u64, SPHERE_TRIANGLES);
        for (triangle, normals) in m.triangles.iter().zip(&m.normal_indices) {
            for (&v, &n) in triangle.iter().zip(normals) {
                let outward = sub(wide(m.positions[v as usize]), center);
                assert!((length(outward) - radius).abs() < 1e-6);
                assert!(dot(outward, wide(m.normals[n as usize])) > radius * (1.0 - 1e-6), "points outwards");
            }
            let [a, b, c] = triangle.map(|v| wide(m.positions[v as usize]));
            assert!(dot(cross(sub(b, a), sub(c, a)), sub(a, center)) > 0.0, "counter-clockwise from outside");
        }
        assert_eq!(open_edges(m), 0);
        t.sphere([9.0; 3], 2.0, 1);
        assert_eq!((t.mesh.positions.len(), t.mesh.normals.len()), (196, 98), "spheres share their normals");
    }

    #[test]
    fn a_cone_has_two_rims() {
        for axis in [[0.0, 0.0, 2.0], [0.0, 0.0, -1.0], [1.0, 2.0, -3.0]] {
            let mut t = Tessellator::new(16);
            let base = [0.5, 0.25, -4.0];
            t.cone([base, add(base, axis)], [0.5, 0.25], 0);
            let m = &t.mesh;
            assert_eq!((m.triangles.len(), m.positions.len(), m.normals.len()), (16, 16, 8));
            assert_eq!(open_edges(m), 16, "the rims, and no other edge, are open");
            for (triangle, normals) in m.triangles.iter().zip(&m.normal_indices) {
                for (&v, &n) in triangle.iter().zip(normals) {
                    let p = sub(wide(m.positions[v as usize]), base);
                    let h = dot(p, normalize(axis));
                    let radial = sub(p, scale(normalize(axis), h));
                    let radius = if h.abs() < 1e-6 { 0.5 } else { 0.25 };
                    assert!((length(radial) - radius).abs() < 1e-6 && h < length(axis) + 1e-6);
                    // The normal stands on the line from rim to rim.
                    let slant = sub(scale(axis, 1.0), scale(normalize(radial), 0.25));
                    assert!(dot(slant, wide(m.normals[n as usize])).abs() < 1e-6);
                    assert!(dot(radial, wide(m.normals[n as usize])) > 0.0);
                }
            }
        }
    }

    /// Directed edges without their opposite.
    fn open_edges(m: &Mesh) -> usize {
        let edges: std::collections::HashSet<_> =
            m.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
        assert_eq!(edges.len(), 3 * m.triangles.len(), "consistent winding");
        edges.iter().filter(|&&(a, b)| !edges.contains(&(b, a))).count()
    }
}
