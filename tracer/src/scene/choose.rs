//! Queries that pass through some of what a ray meets: filters and masks.

use super::Scene;
use crate::Error;
use crate::geometry::{Hit, HitBatch, Ray, RayBatch};
use crate::method::BitVec;
use crate::method::chosen::{self, Accept};
use crate::method::query::{Any, Closest, Query};

impl Scene {
    /// The first hit of a ray that `accept` takes; a triangle whose hit it refuses is passed through, as if it were not there.
    ///
    /// `accept` is asked about some of the hits on the way, in any order, of each triangle at most once. (Embree calls this a filter
    /// function.)
    ///
    /// ```
    /// use tracer::{Scene, geometry::Ray};
    ///
    /// # fn main() -> Result<(), tracer::Error> {
    /// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]];
    /// let scene = Scene::builder().triangles(corners, vec![[0, 1, 2], [3, 4, 5]]).build()?;
    /// let down = Ray::new([0.25, 0.25, 2.0], [0.0, 0.0, -1.0]);
    /// assert_eq!(scene.closest(&down).map(|hit| hit.primitive), Some(1));
    /// // The upper one has a hole in it.
    /// let hit = scene.closest_where(&down, |hit| hit.primitive != 1 || hit.u + hit.v > 0.75);
    /// assert_eq!(hit.map(|hit| hit.primitive), Some(0));
    /// # Ok(())
    /// # }
    /// ```
    #[must_use]
    pub fn closest_where(&self, ray: &Ray, accept: impl Fn(&Hit) -> bool) -> Option<Hit> {
        let hit = chosen::one::<Closest>(&self.bvh, self.level, ray, &accept).get(0);
        (!hit.is_miss()).then_some(hit)
    }

    /// Whether a ray hits anything that `accept` takes: see [`Scene::closest_where`].
    #[must_use]
    pub fn occluded_where(&self, ray: &Ray, accept: impl Fn(&Hit) -> bool) -> bool {
        chosen::one::<Any>(&self.bvh, self.level, ray, &accept) != 0
    }

    /// The first hit of every ray that `accept`, told the number of the ray, takes: see [`Scene::closest_where`], and
    /// [`Scene::closest_batch`] for the rest. Each ray is traced alone, which costs more than a batch without a filter.
    ///
    /// ```
    /// # use tracer::{Scene, geometry::{HitBatch, Ray, RayBatch}};
    /// # fn main() -> Result<(), tracer::Error> {
    /// # let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// # let scene = Scene::builder().triangles(corners, vec![[0, 1, 2]]).build()?;
    /// # let rays: RayBatch = (0..100).map(|i| Ray::new([0.001 * i as f32, 0.25, 2.0], [0.0, 0.0, -1.0])).collect();
    /// // Each ray starts on a triangle, which it shall not hit again.
    /// let origins = vec![0; rays.len()];
    /// let mut hits = HitBatch::new();
    /// scene.closest_batch_where(&rays, &mut hits, |ray, hit| hit.primitive != origins[ray]);
    /// assert!(hits.iter().all(|hit| hit.is_miss()));
    /// # Ok(())
    /// # }
    /// ```
    pub fn closest_batch_where(
        &self,
        rays: &RayBatch,
        hits: &mut HitBatch,
        accept: impl Fn(usize, &Hit) -> bool + Sync,
    ) {
        self.find::<Closest>(rays, hits.resize(rays.len()), &accept);
    }

    /// Whether each ray hits anything that `accept`, told the number of the ray, takes: see [`Scene::closest_batch_where`].
    pub fn occluded_batch_where(
        &self,
        rays: &RayBatch,
        occluded: &mut BitVec,
        accept: impl Fn(usize, &Hit) -> bool + Sync,
    ) {
        self.find::<Any>(rays, occluded.resize(rays.len()), &accept);
    }

    /// The first hit of every ray among what it sees: meshes whose [mask](super::SceneBuilder::mask) has a bit in common with the ray's.
    /// `masks` has one for each ray.
    ///
    /// To have a filter beside masks, ask [`Scene::is_visible`] in the filter.
    ///
    /// # Errors
    /// [`Error::Usage`] when there are not as many masks as rays.
    pub fn closest_batch_masked(&self, rays: &RayBatch, masks: &[u32], hits: &mut HitBatch) -> Result<(), Error> {
        one_for_each(rays, masks)?;
        self.closest_batch_where(rays, hits, |ray, hit| self.is_visible(hit.primitive, masks[ray]));
        Ok(())
    }

    /// Whether each ray hits anything that it sees: see [`Scene::closest_batch_masked`].
    ///
    /// # Errors
    /// [`Error::Usage`] when there are not as many masks as rays.
    pub fn occluded_batch_masked(&self, rays: &RayBatch, masks: &[u32], occluded: &mut BitVec) -> Result<(), Error> {
        one_for_each(rays, masks)?;
        self.occluded_batch_where(rays, occluded, |ray, hit| self.is_visible(hit.primitive, masks[ray]));
        Ok(())
    }

    /// Whether a ray with this mask sees a primitive: the mask of its mesh has a bit in common with the ray's. (For one ray:
    /// `scene.closest_where(&ray, |hit| scene.is_visible(hit.primitive, mask))`.)
    #[must_use]
    #[inline]
    pub fn is_visible(&self, primitive: u32, mask: u32) -> bool {
        // Most scenes have one mesh.
        let mesh = if self.first.len() <= 1 { 0 } else { self.locate(primitive).0 };
        self.masks.get(mesh).is_none_or(|of_mesh| of_mesh & mask != 0)
    }

    fn find<Q: Query>(&self, rays: &RayBatch, results: &mut [Q::Block], accept: &Accept) {
        chosen::batch::<Q>(&self.bvh, self.level, rays, results, accept);
    }
}

/// # Errors
/// [`Error::Usage`] when there are not as many masks as rays.
pub(crate) fn one_for_each(rays: &RayBatch, masks: &[u32]) -> Result<(), Error> {
    if masks.len() == rays.len() {
        return Ok(());
    }
    Err(Error::Usage(format!("there are {} masks for {} rays: give one for each ray", masks.len(), rays.len())))
}

#[cfg(test)]
mod tests {
    use super::super::random::{Random, hits_of, rays, soup};
    use super::*;
    use crate::model::Mesh;
    use simd::Level;

    /// The first of the hits that are taken, the lower primitive at equal distance.
    fn first(hits: &[Hit], accept: impl Fn(&Hit) -> bool) -> Hit {
        let taken = hits.iter().filter(|hit| accept(hit));
        taken.fold(Hit::MISS, |a, b| if (b.t, b.primitive) < (a.t, a.primitive) { *b } else { a })
    }

    /// Some triangles whole, of some a part, differently for each ray.
    fn takes(ray: usize, hit: &Hit) -> bool {
        match (hit.primitive as usize + ray) % 4 {
            0 => false,
            1 => hit.u > 0.3,
            2 => hit.t < 2.0,
            _ => true,
        }
    }

    #[test]
    fn filters_find_what_a_loop_over_all_triangles_finds() {
        let mut random = Random(1);
        let (mut refused, mut hit) = (0, 0);
        for n in [1, 7, 60, 900] {
            let mesh = soup(&mut random, n, 0.6);
            let rays = rays(&mut random, &mesh, 333);
            let all: Vec<Vec<Hit>> = rays.iter().map(|ray| hits_of(&mesh, &ray)).collect();
            for level in Level::available() {
                let scene = Scene::builder().mesh(mesh.clone()).level(level).build().expect("a valid mesh");
                let (mut hits, mut occluded) = (HitBatch::new(), BitVec::new());
                scene.closest_batch_where(&rays, &mut hits, takes);
                scene.occluded_batch_where(&rays, &mut occluded, takes);
                for (i, ray) in rays.iter().enumerate() {
                    let expected = first(&all[i], |hit| takes(i, hit));
                    assert_eq!(hits.get(i), expected, "{level}, {n} triangles, ray {i}");
                    assert_eq!(occluded.get(i), !expected.is_miss(), "{level}, {n} triangles, ray {i}");
                    assert_eq!(scene.closest_where(&ray, |hit| takes(i, hit)).unwrap_or(Hit::MISS), expected);
                    assert_eq!(scene.occluded_where(&ray, |hit| takes(i, hit)), !expected.is_miss());
                    assert_eq!(scene.closest_where(&ray, |_| true), scene.closest(&ray));
                    refused += usize::from(expected != first(&all[i], |_| true));
                    hit += usize::from(!expected.is_miss());
                }
            }
        }
        assert!(refused > 500 && hit > 500, "{refused} rays whose first hit is refused, {hit} that hit");
    }

    #[test]
    fn nothing_is_asked_twice_or_of_rays_that_are_not_there() {
        let mut random = Random(2);
        let mesh = soup(&mut random, 500, 0.6);
        let rays = rays(&mut random, &mesh, 37);
        let scene = Scene::builder().mesh(mesh).build().expect("a valid mesh");
        let asked = std::sync::Mutex::new(Vec::new());
        scene.closest_batch_where(&rays, &mut HitBatch::new(), |ray, hit| {
            asked.lock().expect("no panic").push((ray, hit.primitive));
            false
        });
        let mut asked = asked.into_inner().expect("no panic");
        asked.sort_unstable();
        let all: Vec<(usize, u32)> = rays
            .iter()
            .enumerate()
            .flat_map(|(i, ray)| hits_of(&scene_mesh(&scene), &ray).into_iter().map(move |hit| (i, hit.primitive)))
            .collect();
        assert_eq!(asked, all, "where all is refused, all is asked about");
    }

    /// The triangles of a scene again.
    fn scene_mesh(scene: &Scene) -> Mesh {
        let mut triangles: Vec<_> =
            scene.bvh.groups.iter().flat_map(|group| (0..4).filter_map(|lane| group.triangle(lane))).collect();
        triangles.sort_unstable_by_key(|t| t.id);
        let at = |v: [f32; 3], e: [f32; 3]| [v[0] + e[0], v[1] + e[1], v[2] + e[2]];
        let positions: Vec<_> = triangles.iter().flat_map(|t| [t.v0, at(t.v0, t.e1), at(t.v0, t.e2)]).collect();
        let corners = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Mesh { positions, triangles: corners, ..Mesh::default() }
    }

    #[test]
    fn rays_see_meshes_with_a_bit_in_common() {
        let mut random = Random(3);
        let meshes: Vec<Mesh> = (0..5).map(|_| soup(&mut random, 80, 0.6)).collect();
        let of_mesh = [0b001, 0b010, 0b110, u32::MAX, 0];
        let rays = rays(&mut random, &meshes[0], 300);
        let masks: Vec<u32> = (0..300).map(|i| [0b001, 0b100, 0b011, u32::MAX, 0, 1 << 31][i % 6]).collect();
        for level in Level::available() {
            let mut builder = Scene::builder().level(level);
            for (mesh, mask) in meshes.iter().zip(of_mesh) {
                builder = builder.mesh(mesh.clone());
                // Without a mask: all bits.
                builder = if mask == u32::MAX { builder } else { builder.mask(mask) };
            }
            let scene = builder.build().expect("valid meshes");
            let (mut hits, mut occluded, mut both) = (HitBatch::new(), BitVec::new(), HitBatch::new());
            scene.closest_batch_masked(&rays, &masks, &mut hits).expect("a mask for each");
            scene.occluded_batch_masked(&rays, &masks, &mut occluded).expect("a mask for each");
            scene.closest_batch_where(&rays, &mut both, |i, hit| {
                scene.is_visible(hit.primitive, masks[i]) && takes(i, hit)
            });
            let mut seen = 0;
            for (i, ray) in rays.iter().enumerate() {
                let all: Vec<Hit> = (0..5)
                    .flat_map(|m| hits_of(&meshes[m], &ray).into_iter().map(move |hit| (m, hit)))
                    .filter(|(m, _)| of_mesh[*m] & masks[i] != 0)
                    .map(|(m, hit)| Hit { primitive: hit.primitive + 80 * m as u32, ..hit })
                    .collect();
                let expected = first(&all, |_| true);
                assert_eq!(hits.get(i), expected, "{level}, ray {i}");
                assert_eq!(occluded.get(i), !expected.is_miss(), "{level}, ray {i}");
                assert_eq!(both.get(i), first(&all, |hit| takes(i, hit)), "{level}, ray {i}");
                seen += usize::from(!expected.is_miss());
            }
            assert!(seen > 50, "{seen}");
            let e = scene.closest_batch_masked(&rays, &masks[1..], &mut hits).expect_err("one is missing");
            assert!(e.to_string().contains("299 masks for 300 rays"), "{e}");
            assert!(scene.occluded_batch_masked(&rays, &[], &mut occluded).is_err());
        }
    }
}
