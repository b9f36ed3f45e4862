//! Queries for the nearest point of the surface.

use super::Scene;
use crate::geometry::Nearest;
use crate::method::nearest;

impl Scene {
    /// The point of the surface that is nearest to `point`, no farther away than `max_distance` (which may be infinite), in the units of
    /// the coordinates; of equally near triangles the one with the lower number. Degenerate triangles do not count.
    ///
    /// `None` if nothing is as near, if a coordinate of the point is not finite, or if `max_distance` is negative or NaN.
    ///
    /// The bits are the same at every level. The distance is right to within a few units in the last place of the largest of the point's
    /// and the triangle's coordinates, as long as its square is a number of ordinary size: distances above 1.8e19 are infinite.
    ///
    /// Candidates are those of Ericson 2005, Real-Time Collision Detection, 5.1.2 and 5.1.5.
    ///
    /// ```
    /// # fn main() -> Result<(), tracer::Error> {
    /// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let scene = tracer::Scene::builder().triangles(corners, vec![[0, 1, 2]]).build()?;
    /// let nearest = scene.nearest([0.5, -3.0, 4.0], f32::INFINITY).expect("there is a triangle");
    /// assert_eq!((nearest.distance, nearest.point, nearest.primitive), (5.0, [0.5, 0.0, 0.0], 0));
    /// assert_eq!(scene.nearest([0.5, -3.0, 4.0], 4.9), None);
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn nearest(&self, point: [f32; 3], max_distance: f32) -> Option<Nearest> {
        self.nearest_where(point, max_distance, |_| true)
    }

    /// [`Scene::nearest`] among the triangles whose nearest point `accept` takes. (With a mask: ask [`Scene::is_visible`] in it.)
    #[must_use]
    pub fn nearest_where(
        &self,
        point: [f32; 3],
        max_distance: f32,
        accept: impl Fn(&Nearest) -> bool,
    ) -> Option<Nearest> {
        nearest::one(&self.bvh, self.level, point, max_distance, &accept)
    }

    /// [`Scene::nearest`] of every point, in their order, on all threads of the current rayon pool. `nearest` keeps its memory from one
    /// call to the next. Points that lie close together are best neighbours in the batch.
    pub fn nearest_batch(&self, points: &[[f32; 3]], max_distance: f32, nearest: &mut Vec<Option<Nearest>>) {
        self.nearest_batch_where(points, max_distance, nearest, |_, _| true);
    }

    /// [`Scene::nearest_where`] of every point; `accept` is told the number of the point.
    pub fn nearest_batch_where(
        &self,
        points: &[[f32; 3]],
        max_distance: f32,
        nearest: &mut Vec<Option<Nearest>>,
        accept: impl Fn(usize, &Nearest) -> bool + Sync,
    ) {
        nearest.resize(points.len(), None);
        nearest::batch(&self.bvh, self.level, points, max_distance, nearest, &accept);
    }
}

#[cfg(test)]
mod tests {
    use super::super::random::{Random, soup};
    use super::*;
    use crate::geometry::nearest::on_triangle;
    use crate::geometry::{Triangle, Vec3};
    use crate::model::Mesh;
    use simd::Level;

    /// By a loop over all triangles.
    fn brute(mesh: &Mesh, point: [f32; 3], max_distance: f32, accept: impl Fn(&Nearest) -> bool) -> Option<Nearest> {
        let vec3 = |[x, y, z]: [f32; 3]| Vec3::<f32> { x, y, z };
        let all = (0..mesh.triangles.len()).map(|i| Triangle::new(mesh.triangle(i), i as u32, 0));
        let feet = all.filter(|t| !t.is_degenerate()).map(|t| {
            let foot = on_triangle(vec3(point), [t.v0, t.e1, t.e2].map(vec3));
            let at = [foot.point.x, foot.point.y, foot.point.z];
            Nearest { distance: foot.distance, point: at, primitive: t.id, u: foot.u, v: foot.v }
        });
        feet.filter(|n| n.distance <= max_distance && accept(n))
            .reduce(|a, b| if (b.distance, b.primitive) < (a.distance, a.primitive) { b } else { a })
    }

    #[test]
    fn nearest_points_are_those_of_a_loop_over_all_triangles() {
        let mut random = Random(5);
        let mut found = 0;
        for n in [1, 7, 60, 900] {
            let mesh = soup(&mut random, n, 0.4);
            let points: Vec<[f32; 3]> = (0..200)
                .map(|i| match i % 5 {
                    0 => mesh.positions[random.bits() as usize % mesh.positions.len()],
                    1 => random.point(30.0),
                    2 => random.point(0.1),
                    _ => random.point(1.5),
                })
                .collect();
            let takes = |i: usize, n: &Nearest| !(n.primitive as usize + i).is_multiple_of(3) && n.u < 0.9;
            for level in Level::available() {
                let scene = Scene::builder().mesh(mesh.clone()).level(level).build().expect("a valid mesh");
                for max_distance in [f32::INFINITY, 0.3, 0.0] {
                    let (mut nearest, mut chosen) = (Vec::new(), Vec::new());
                    scene.nearest_batch(&points, max_distance, &mut nearest);
                    scene.nearest_batch_where(&points, max_distance, &mut chosen, takes);
                    for (i, &point) in points.iter().enumerate() {
                        let expected = brute(&mesh, point, max_distance, |_| true);
                        assert_eq!(nearest[i], expected, "{level}, {n} triangles, point {i}");
                        assert_eq!(scene.nearest(point, max_distance), expected, "{level}, {n} triangles, point {i}");
                        let expected = brute(&mesh, point, max_distance, |n| takes(i, n));
                        assert_eq!(chosen[i], expected, "{level}, {n} triangles, point {i}, filtered");
                        assert_eq!(scene.nearest_where(point, max_distance, |n| takes(i, n)), expected);
                        found += usize::from(expected.is_some());
                    }
                }
            }
        }
        assert!(found > 1000, "{found}");
    }

    #[test]
    fn unusual_questions() {
        let mut random = Random(6);
        let mesh = soup(&mut random, 50, 0.4);
        let scene = Scene::builder().mesh(mesh.clone()).build().expect("a valid mesh");
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for axis in 0..3 {
                let mut point = [0.0; 3];
                point[axis] = bad;
                assert_eq!(scene.nearest(point, f32::INFINITY), None);
            }
        }
        for none in [f32::NAN, -1.0, f32::NEG_INFINITY] {
            assert_eq!(scene.nearest([0.0; 3], none), None);
        }
        assert!(scene.nearest([0.0; 3], f32::MAX).is_some());
        // On a vertex: at no distance, also when none is allowed.
        let on = scene.nearest(mesh.positions[3], 0.0).expect("the vertex");
        assert_eq!((on.distance, on.point, on.primitive), (0.0, mesh.positions[3], 1));
        // Farther than the square can say.
        assert_eq!(
            scene.nearest([1e30, 0.0, 0.0], f32::INFINITY).map(|n| (n.distance, n.primitive)),
            Some((f32::INFINITY, 0))
        );
        assert_eq!(scene.nearest([1e30, 0.0, 0.0], f32::MAX), None);
        // Nothing but a point and a line.
        let flat = vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
        let empty =
            Scene::builder().triangles(flat, vec![[0, 0, 0], [0, 1, 2]]).build().expect("degenerate, but valid");
        assert_eq!(empty.nearest([0.0; 3], f32::INFINITY), None);
    }

    #[test]
    fn nearest_among_what_is_visible() {
        let mut random = Random(7);
        let meshes: Vec<Mesh> = (0..2).map(|_| soup(&mut random, 40, 0.4)).collect();
        let scene = Scene::builder().mesh(meshes[0].clone()).mask(0b01).mesh(meshes[1].clone()).mask(0b10).build();
        let scene = scene.expect("valid meshes");
        for _ in 0..100 {
            let point = random.point(1.5);
            let seen = scene.nearest_where(point, 9.0, |n| scene.is_visible(n.primitive, 0b10)).expect("near enough");
            let alone = brute(&meshes[1], point, 9.0, |_| true).expect("near enough");
            assert_eq!(
                (seen.distance, seen.point, seen.primitive),
                (alone.distance, alone.point, alone.primitive + 40)
            );
        }
    }
}
