//! Trees whose triangles moved: the same nodes with other boxes (Wald, Boulos and Shirley 2007, "Ray tracing deformable scenes using
//! dynamic bounding volume hierarchies").

use super::build::triangle;
use super::{Bvh, Child, WideBvh};
use crate::Error;
use crate::geometry::{Aabb, Hit, Triangle};
use crate::model::Mesh;
use rayon::prelude::*;

impl Bvh {
    /// Puts the triangles of `mesh`, whose vertices moved, in the place of those that the tree was built over: much faster than building, with
    /// the hits of a tree that is built anew, bit for bit. How fast rays find them depends on how far vertices moved against each other;
    /// [`Bvh::stats`] tells how good the tree still is.
    ///
    /// A triangle that has become [degenerate](Triangle::is_degenerate) stays as a point that nothing hits, and comes back when it is
    /// none in a later `mesh`.
    ///
    /// ```
    /// use tracer::bvh::{BuildConfig, Bvh};
    /// use tracer::{model::Model, progress::Silent};
    ///
    /// # fn main() -> Result<(), tracer::Error> {
    /// let (mut model, _warnings) = Model::open("balls:1", &Silent)?;
    /// let mut bvh = Bvh::build(&model.mesh, &BuildConfig::default(), &Silent)?;
    /// model.mesh.positions.iter_mut().for_each(|p| p[2] += 0.1 * p[0]);
    /// bvh.refit(&model.mesh)?;
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`Error::Geometry`], and the tree stays as it was: as [`Mesh::validate`] has it; when `mesh` lacks triangles of the tree; when it has one that
    /// the tree does not hold because it was degenerate when the tree was built, or was not there. Build the tree again then.
    pub fn refit(&mut self, mesh: &Mesh) -> Result<(), Error> {
        mesh.validate()?;
        check(mesh.triangles.len(), &|id| triangle(mesh, id), self.triangles.iter().map(|t| t.id))?;
        self.triangles.par_iter_mut().for_each(|t| *t = hittable_or_point(triangle(mesh, t.id)));
        for i in (0..self.nodes.len()).rev() {
            self.nodes[i] = self.nodes[i].with_bounds(&self.held(i));
        }
        Ok(())
    }

    /// The box around what is in a node, whose children have theirs.
    pub(super) fn held(&self, i: usize) -> Aabb {
        let (first, count) = self.nodes[i].triangles();
        if count > 0 {
            let triangles = &self.triangles[first as usize..][..count as usize];
            return triangles.iter().fold(Aabb::EMPTY, |b, t| b.union(&t.bounds()));
        }
        let (mut bounds, mut child, end) = (Aabb::EMPTY, i + 1, self.nodes[i].skip() as usize);
        while child < end {
            bounds = bounds.union(&self.nodes[child].bounds());
            child = self.nodes[child].skip() as usize;
        }
        bounds
    }
}

impl<const N: usize> WideBvh<N> {
    /// As [`Bvh::refit`].
    ///
    /// # Errors
    /// As [`Bvh::refit`].
    pub fn refit(&mut self, mesh: &Mesh) -> Result<(), Error> {
        mesh.validate()?;
        self.refit_to(mesh.triangles.len(), |id| triangle(mesh, id))
    }

    /// [`WideBvh::refit`] to `number` triangles of finite vertices.
    pub(crate) fn refit_to(&mut self, number: usize, triangle: impl Fn(u32) -> Triangle + Sync) -> Result<(), Error> {
        let ids = self.groups.iter().flat_map(|group| group.id).filter(|&id| id != Hit::NO_PRIMITIVE);
        check(number, &triangle, ids)?;
        self.groups.par_iter_mut().for_each(|group| {
            for (lane, id) in group.id.into_iter().enumerate().filter(|&(_, id)| id != Hit::NO_PRIMITIVE) {
                group.set(lane, &hittable_or_point(triangle(id)));
            }
        });
        for i in (0..self.nodes.len()).rev() {
            for slot in 0..N {
                let child = self.nodes[i].children[slot];
                if child != Child::NONE {
                    let bounds = self.held(child);
                    self.nodes[i].set(slot, &bounds, child);
                }
            }
        }
        Ok(())
    }

    /// The box around what is in a child, whose own children have theirs.
    pub(super) fn held(&self, child: Child) -> Aabb {
        let mut bounds = Aabb::EMPTY;
        if child.is_leaf() {
            let (first, end) = child.groups();
            for group in &self.groups[first..end] {
                let triangles = (0..Self::GROUP).filter_map(|lane| group.triangle(lane));
                bounds = triangles.fold(bounds, |b, t| b.union(&t.bounds()));
            }
        } else {
            let node = &self.nodes[child.index()];
            for slot in (0..N).filter(|&slot| node.children[slot] != Child::NONE) {
                bounds = bounds.union(&node.bounds(slot));
            }
        }
        bounds
    }
}

/// A point that nothing hits in the place of a degenerate triangle.
fn hittable_or_point(t: Triangle) -> Triangle {
    if t.is_degenerate() { Triangle { e1: [0.0; 3], e2: [0.0; 3], ..t } } else { t }
}

/// A tree that holds `ids` can take the triangles from 0 to `number`.
fn check(
    number: usize,
    triangle: &(impl Fn(u32) -> Triangle + Sync),
    ids: impl Iterator<Item = u32>,
) -> Result<(), Error> {
    let mut is_held = vec![false; number];
    for id in ids {
        let Some(is_held) = is_held.get_mut(id as usize) else {
            return Err(Error::Geometry(format!(
                "the tree holds triangle {id}, but there are {number} (counted from 0): build the tree again"
            )));
        };
        *is_held = true;
    }
    let missing = |&id: &u32| !is_held[id as usize] && !triangle(id).is_degenerate();
    match (0..number as u32).into_par_iter().find_first(missing) {
        Some(id) => Err(Error::Geometry(format!(
            "triangle {id} is not in the tree, for it was degenerate or not there when the tree was built: build the tree again"
        ))),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{BuildConfig, CollapseConfig};
    use crate::geometry::{HitBatch, Ray, RayBatch};
    use crate::method::{Auto, Context, Method, Packet, Single, Width};
    use crate::progress::Silent;
    use simd::Level;

    struct Random(u64);

    impl Random {
        /// In -1 to 1.
        fn next(&mut self) -> f32 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 40) as f32 / 8_388_608.0 - 1.0
        }

        fn point(&mut self, size: f32) -> [f32; 3] {
            [(); 3].map(|()| size * self.next())
        }
    }

    /// A strip of triangles that share vertices, anywhere.
    fn strip(n: u32, random: &mut Random) -> Mesh {
        let positions = (0..n + 2).map(|_| random.point(1.0)).collect();
        Mesh { positions, triangles: (0..n).map(|i| [i, i + 1, i + 2]).collect(), ..Mesh::default() }
    }

    fn rays(random: &mut Random) -> RayBatch {
        (0..500).map(|_| Ray::new(random.point(2.0), random.point(1.0))).collect()
    }

    fn hash(method: &dyn Method, rays: &RayBatch) -> u64 {
        let mut hits = HitBatch::new();
        method.closest(rays, &mut hits, &mut Context::default()).expect("not cancelled");
        hits.hash()
    }

    fn check_refit<const N: usize>(binary: &Bvh, wide: &mut WideBvh<N>, mesh: &Mesh)
    where
        crate::method::Arity<N>: crate::method::Wide,
    {
        wide.refit(mesh).expect("the same triangles");
        wide.validate().expect("a tree that is well-formed");
        let rays = rays(&mut Random(99));
        for level in Level::available() {
            let expected = hash(&Packet::new(binary, level, Width::Auto), &rays);
            assert_eq!(hash(&Single::new(wide, level), &rays), expected, "{level}, {N} children");
        }
    }

    /// Vertices move at random, a little or a lot, sometimes onto each other: hits are always those of a tree built anew.
    #[test]
    fn hits_are_those_of_a_new_tree() {
        let mut random = Random(5);
        for config in [BuildConfig::fast(), BuildConfig::medium(), BuildConfig::high(), BuildConfig::insertion(1)] {
            let mut mesh = strip(300, &mut random);
            let mut bvh = Bvh::build(&mesh, &config, &Silent).expect("a valid mesh");
            let collapse = CollapseConfig::default();
            let (mut four, mut eight, mut sixteen) =
                (bvh.collapse::<4>(&collapse), bvh.collapse::<8>(&collapse), bvh.collapse::<16>(&collapse));
            for step in 0..6 {
                let size = [1e-6, 0.01, 3.0][step % 3];
                for p in &mut mesh.positions {
                    let by = random.point(size);
                    (0..3).for_each(|axis| p[axis] += by[axis]);
                }
                let collapsed = step % 2 == 1;
                let still = mesh.positions[31];
                if collapsed {
                    mesh.positions[30] = still;
                }
                bvh.refit(&mesh).expect("the same triangles");
                bvh.validate().expect("a tree that is well-formed");
                let new = Bvh::build(&mesh, &config, &Silent).expect("a valid mesh");
                assert_eq!(bvh.triangles.len() - new.triangles.len(), if collapsed { 2 } else { 0 });
                check_refit(&new, &mut four, &mesh);
                check_refit(&new, &mut eight, &mesh);
                check_refit(&new, &mut sixteen, &mesh);
                let rays = rays(&mut random);
                for level in Level::available() {
                    let expected = hash(&Packet::new(&new, level, Width::Auto), &rays);
                    assert_eq!(hash(&Packet::new(&bvh, level, Width::Auto), &rays), expected, "{level}");
                    assert_eq!(hash(&Auto::new(&eight, level), &rays), expected, "{level}");
                }
            }
        }
    }

    #[test]
    fn what_the_tree_lacks_is_an_error_and_changes_nothing() {
        let mut mesh = strip(20, &mut Random(1));
        let moved = mesh.positions[4];
        mesh.positions[4] = mesh.positions[3];
        let mut bvh = Bvh::build(&mesh, &BuildConfig::default(), &Silent).expect("a valid mesh");
        let mut wide = bvh.collapse::<8>(&CollapseConfig::default());
        assert_eq!(bvh.triangles.len(), 18);
        let before = (bvh.triangles.clone(), wide.groups.clone());
        let mut fails = |mesh: &Mesh, reason: &str| {
            for e in [bvh.refit(mesh), wide.refit(mesh)].map(|result| result.expect_err(reason)) {
                assert!(matches!(&e, Error::Geometry(message) if message.contains(reason)), "{e}");
            }
            assert!(before == (bvh.triangles.clone(), wide.groups.clone()));
        };
        let mut grown = mesh.clone();
        grown.positions[4] = moved;
        fails(&grown, "triangle 2 is not in the tree");
        let mut shorter = mesh.clone();
        shorter.triangles.truncate(15);
        fails(&shorter, "the tree holds triangle");
        let mut longer = mesh.clone();
        longer.triangles.push([0, 1, 2]);
        fails(&longer, "triangle 20 is not in the tree");
        mesh.positions[0][0] = f32::NAN;
        fails(&mesh, "vertex 0 is (NaN");
    }

    /// Even when all of it has become points, the tree comes back.
    #[test]
    fn degenerate_and_back() {
        let mesh = strip(50, &mut Random(2));
        let mut wide = Bvh::build(&mesh, &BuildConfig::default(), &Silent)
            .expect("valid")
            .collapse::<8>(&CollapseConfig::default());
        let rays = rays(&mut Random(3));
        let before = hash(&Auto::new(&wide, Level::best()), &rays);
        let mut flat = mesh.clone();
        flat.positions.iter_mut().for_each(|p| *p = [f32::MAX, 0.0, 1e-40]);
        wide.refit(&flat).expect("the same triangles");
        wide.validate().expect("a tree that is well-formed");
        let mut hits = HitBatch::new();
        Auto::new(&wide, Level::best()).closest(&rays, &mut hits, &mut Context::default()).expect("not cancelled");
        assert!(hits.iter().all(|hit| hit.is_miss()));
        wide.refit(&mesh).expect("the same triangles");
        assert_eq!(hash(&Auto::new(&wide, Level::best()), &rays), before);
    }
}
