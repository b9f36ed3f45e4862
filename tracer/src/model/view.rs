//! A view for a mesh that comes without one.

use super::vec3::{Vec3, add, dot, narrow, scale, sub, wide};
use super::{Camera, Mesh};

impl Camera {
    /// A view of a mesh of unknown kind: from inside when it is a room, else [`Camera::framing`] from outside.
    ///
    /// It counts as a room when there is free space in its middle, closed in, but not empty: of the six rays along the
    /// axes from the middle of its box at least five meet something, they come at least half the way to the box on average, and
    /// one triangle in a hundred lies within the box of half the size. (The middle of a dragon is too narrow, a sphere is
    /// an empty shell. Which side of a wall is its front says little: files do not agree about it.) The eye then
    /// stands near the end of the longest horizontal ray and looks back through the middle, so that nothing stands
    /// before it. Rooms are wider than high: where y spans more than one and a half times the shortest side of the box,
    /// that side is taken for the height.
    ///
    /// # Panics
    /// When the mesh is not valid (see [`Mesh::validate`]).
    #[must_use]
    pub fn of_mesh(mesh: &Mesh) -> Self {
        inside(mesh).unwrap_or_else(|| Self::framing(&mesh.bounds()))
    }
}

fn inside(mesh: &Mesh) -> Option<Camera> {
    let bounds = mesh.bounds();
    let [min, max] = [bounds.min, bounds.max].map(wide);
    let (center, extent) = (scale(add(min, max), 0.5), sub(max, min));
    let free = free_distances(mesh, center);
    let met = free.as_flattened().iter().filter(|t| t.is_finite()).count();
    let way: f64 = (0..6).map(|i| (free[i / 2][i % 2] / (0.5 * extent[i / 2])).min(1.0)).sum();
    if met < 5 || way < 3.0 || !has_content(mesh, center, extent) {
        return None;
    }
    let shortest = (0..3).min_by(|&a, &b| extent[a].total_cmp(&extent[b]))?;
    let height = if extent[1] > 1.5 * extent[shortest] { shortest } else { 1 };
    let horizontal = (0..6).filter(|i| i / 2 != height).map(|i| (i / 2, i % 2));
    // Where a ray leaves the room there is nothing to stand before.
    let places = horizontal.filter(|&(axis, side)| free[axis][side].is_finite());
    let (axis, side) = places.max_by(|&(a, i), &(b, j)| free[a][i].total_cmp(&free[b][j]))?;
    let mut eye = center;
    eye[axis] += if side == 0 { -0.9 } else { 0.9 } * free[axis][side];
    let mut up = [0.0; 3];
    up[height] = 1.0;
    let camera = Camera { eye: narrow(eye), at: narrow(center), up, fov: 60.0 };
    camera.validate().is_ok().then_some(camera)
}

/// One triangle in a hundred lies within the box of half the size.
fn has_content(mesh: &Mesh, center: Vec3, extent: Vec3) -> bool {
    let within = |p: [f32; 3]| (0..3).all(|k| (f64::from(p[k]) - center[k]).abs() < 0.25 * extent[k]);
    let n = mesh.triangles.len();
    (0..n).filter(|&i| mesh.triangle(i).into_iter().all(within)).count() * 100 >= n
}

/// For each axis, how far one can see from a point to its minus and its plus side; infinitely where there is nothing.
fn free_distances(mesh: &Mesh, from: Vec3) -> [[f64; 2]; 3] {
    let mut free = [[f64::INFINITY; 2]; 3];
    for i in 0..mesh.triangles.len() {
        let corners = mesh.triangle(i).map(|p| sub(wide(p), from));
        for (axis, sides) in free.iter_mut().enumerate() {
            if let Some(t) = crossing(corners, axis) {
                let side = &mut sides[usize::from(t > 0.0)];
                *side = side.min(t.abs());
            }
        }
    }
    free
}

/// Where the axis through the origin crosses a triangle.
fn crossing(corners: [Vec3; 3], axis: usize) -> Option<f64> {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let [a, b, c] = corners;
    // Twice the signed areas of the triangles between the axis and the edges, seen along it.
    let area = |p: Vec3, q: Vec3| p[u] * q[v] - p[v] * q[u];
    let w = [area(b, c), area(c, a), area(a, b)];
    let sum = w[0] + w[1] + w[2];
    let inside = w.iter().all(|&x| x >= 0.0) || w.iter().all(|&x| x <= 0.0);
    (inside && sum != 0.0).then(|| dot(w, [a[axis], b[axis], c[axis]]) / sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;
    use crate::model::procedural::hairball;

    /// Boxes, each given by two corners.
    fn boxes(list: &[[[f32; 3]; 2]]) -> Mesh {
        let mut mesh = Mesh::default();
        for (n, ends) in (0..).zip(list) {
            mesh.positions.extend((0..8).map(|i: usize| std::array::from_fn(|k| ends[i >> k & 1][k])));
            for q in [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]] {
                mesh.triangles.extend([[q[0], q[1], q[2]], [q[0], q[2], q[3]]].map(|t| t.map(|v| 8 * n + v)));
            }
        }
        mesh
    }

    const TABLE: [[f32; 3]; 2] = [[3.0, 1.0, 2.0], [3.5, 1.2, 2.4]];

    #[test]
    fn a_furnished_room_is_seen_from_inside() {
        let mesh = boxes(&[[[0.0; 3], [8.0, 3.0, 5.0]], TABLE]);
        let room = Camera::of_mesh(&mesh);
        room.validate().expect("a sound camera");
        assert_eq!((room.eye[1], room.eye[2], room.at, room.up), (1.5, 2.5, [4.0, 1.5, 2.5], [0.0, 1.0, 0.0]));
        assert!((room.eye[0] - 4.0).abs() > 3.0);
        assert!(mesh.bounds().contains(&Aabb { min: room.eye, max: room.eye }));
    }

    /// A room that is low in z has z for its height.
    #[test]
    fn a_room_may_lie() {
        let room = Camera::of_mesh(&boxes(&[[[0.0; 3], [8.0, 7.0, 3.0]], [[3.0, 3.0, 1.0], [3.5, 3.2, 1.2]]]));
        assert_eq!(room.up, [0.0, 0.0, 1.0]);
        room.validate().expect("a sound camera");
    }

    /// An empty shell, a thing in the middle of a room, things that nothing encloses, a ball of hair.
    #[test]
    fn all_else_is_seen_from_outside() {
        let shell = [[0.0; 3], [8.0, 3.0, 5.0]];
        let full = [[3.0, 1.0, 2.0], [5.0, 2.0, 3.0]];
        for mesh in [boxes(&[shell]), boxes(&[shell, full]), boxes(&[TABLE, [[7.0; 3], [8.0; 3]]]), hairball(50).mesh] {
            assert_eq!(Camera::of_mesh(&mesh), Camera::framing(&mesh.bounds()));
        }
    }
}
