//! A view for a mesh that comes without one.

use super::vec3::{Vec3, add, cross, dot, narrow, scale, sub, wide};
use super::{Camera, Mesh};

impl Camera {
    /// A view of a mesh of unknown kind: from inside when it is a room, else [`Camera::framing`] from outside.
    ///
    /// It counts as a room when of the six rays along the axes from the middle of its box at least four meet, as their first
    /// triangle, the front side of one (counter-clockwise), so far away that it can be a wall: more than half the way to
    /// the box. (The middle of a solid body sees back sides; among furniture it sees near things.) The eye then
    /// stands near the end of the longest free horizontal ray and looks back through the middle, so that nothing stands close
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

/// Six directions: -x, +x, -y, +y, -z, +z.
fn axis_ray(i: usize) -> Vec3 {
    std::array::from_fn(|k| if k != i / 2 { 0.0 } else if i % 2 == 0 { -1.0 } else { 1.0 })
}

fn inside(mesh: &Mesh) -> Option<Camera> {
    let bounds = mesh.bounds();
    let [min, max] = [bounds.min, bounds.max].map(wide);
    let (center, extent) = (scale(add(min, max), 0.5), sub(max, min));
    let seen = first_hits(mesh, center);
    let wall = |i: usize| seen[i].is_some_and(|(t, front)| front && t > 0.25 * extent[i / 2]);
    if (0..6).filter(|&i| wall(i)).count() < 4 {
        return None;
    }
    let shortest = (0..3).min_by(|&a, &b| extent[a].total_cmp(&extent[b]))?;
    let height = if extent[1] > 1.5 * extent[shortest] { shortest } else { 1 };
    // Where a horizontal ray leaves the room it is not a place to stand.
    let free = |i: &usize| seen[*i].map_or(0.0, |(t, _)| t);
    let stand = (0..6).filter(|i| i / 2 != height && wall(*i)).max_by(|a, b| free(a).total_cmp(&free(b)))?;
    let eye = add(center, scale(axis_ray(stand), 0.9 * free(&stand)));
    let up = narrow(axis_ray(2 * height + 1));
    Some(Camera { eye: narrow(eye), at: narrow(center), up, fov: 60.0 })
}

/// For each of the axis rays from a point: distance of the nearest triangle, and whether its front is seen.
fn first_hits(mesh: &Mesh, from: Vec3) -> [Option<(f64, bool)>; 6] {
    let mut hits = [None; 6];
    for i in 0..mesh.triangles.len() {
        let corners = mesh.triangle(i).map(|p| sub(wide(p), from));
        for (axis, pair) in hits.as_chunks_mut::<2>().0.iter_mut().enumerate() {
            let Some((t, front_from_plus)) = crossing(corners, axis) else { continue };
            let hit = &mut pair[usize::from(t > 0.0)];
            if hit.is_none_or(|(nearest, _)| t.abs() < nearest) {
                // Looking towards +axis one sees a front whose normal points to -axis, and the other way round.
                *hit = Some((t.abs(), front_from_plus != (t > 0.0)));
            }
        }
    }
    hits
}

/// Where the axis through the origin crosses a triangle (in its coordinate), and whether the triangle's front faces
/// the plus side.
fn crossing(corners: [Vec3; 3], axis: usize) -> Option<(f64, bool)> {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let [a, b, c] = corners;
    // Twice the signed areas of the triangles between the axis and the edges, seen along it.
    let area = |p: Vec3, q: Vec3| p[u] * q[v] - p[v] * q[u];
    let w = [area(b, c), area(c, a), area(a, b)];
    let inside = w.iter().all(|&x| x >= 0.0) || w.iter().all(|&x| x <= 0.0);
    let normal = cross(sub(b, a), sub(c, a))[axis];
    if !inside || normal == 0.0 {
        return None;
    }
    Some((dot(w, [a[axis], b[axis], c[axis]]) / (w[0] + w[1] + w[2]), normal > 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;

    /// A box from `min` to `max` whose faces look outwards, or inwards.
    fn block(min: [f32; 3], max: [f32; 3], inwards: bool) -> Mesh {
        let positions = (0..8).map(|i| std::array::from_fn(|k| if i >> k & 1 == 0 { min[k] } else { max[k] })).collect();
        let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let mut triangles: Vec<[u32; 3]> = quads.iter().flat_map(|q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
        if inwards {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        Mesh { positions, triangles, ..Mesh::default() }
    }

    #[test]
    fn looks_at_a_body_from_outside_and_at_a_room_from_inside() {
        let (min, max) = ([0.0, 0.0, 0.0], [8.0, 3.0, 5.0]);
        let bounds = Aabb { min, max };
        let body = Camera::of_mesh(&block(min, max, false));
        assert_eq!(body, Camera::framing(&bounds));
        let room = Camera::of_mesh(&block(min, max, true));
        assert_eq!((room.eye[1], room.eye[2], room.up), (1.5, 2.5, [0.0, 1.0, 0.0]));
        assert!((room.eye[0] - 4.0).abs() > 3.0 && bounds.contains(&Aabb { min: room.eye, max: room.eye }));
        room.validate().expect("a sound camera");
    }

    /// A room that is low in z has z for its height.
    #[test]
    fn a_room_may_lie() {
        let room = Camera::of_mesh(&block([0.0; 3], [30.0, 20.0, 8.0], true));
        assert_eq!(room.up, [0.0, 0.0, 1.0]);
        room.validate().expect("a sound camera");
    }

    /// Something in the middle of the room hides the walls: the view from outside it is.
    #[test]
    fn a_full_room_is_seen_from_outside() {
        let mut mesh = block([-5.0; 3], [5.0; 3], true);
        let body = block([-1.0; 3], [1.0; 3], false);
        mesh.triangles.extend(body.triangles.iter().map(|t| t.map(|v| v + 8)));
        mesh.positions.extend(body.positions);
        assert_eq!(Camera::of_mesh(&mesh), Camera::framing(&mesh.bounds()));
    }
}
