//! Effective overlap: how much of the scene lies in boxes that do not hold it (Aila, Karras and Laine 2013, "On quality metrics of
//! bounding volume hierarchies", section 4).

use super::{Bvh, Node};
use crate::Error;
use crate::geometry::{Aabb, Triangle};
use crate::progress::Progress;
use rayon::prelude::*;

type Point = [f64; 3];

/// Triangles between two reports of progress.
const PORTION: usize = 1024;

impl Bvh {
    /// The effective overlap of the tree, in the units of [`BvhStats::sah_cost`](super::BvhStats::sah_cost): the sum over all nodes of the area of
    /// the triangles that lie in the node's box, borders included, but not in its subtree, times the tests that entering the
    /// node costs (a box test for each child, or a test for each triangle), over the area of all triangles. Rays end on triangles, and there
    /// they enter all of these nodes for nothing: of two trees with the same SAH cost the one with less overlap is faster. 0 for an empty tree.
    ///
    /// Triangles are clipped to boxes one by one, in parallel: this takes longer than building most trees. Progress is a stage `"overlap"`, in
    /// triangles. The result does not depend on the number of threads.
    ///
    /// ```
    /// use tracer::bvh::{BuildConfig, Bvh};
    /// use tracer::{model::Model, progress::Silent};
    ///
    /// # fn main() -> Result<(), tracer::Error> {
    /// let (model, _warnings) = Model::open("balls:1", &Silent)?;
    /// let overlap = |config| Bvh::build(&model.mesh, &config, &Silent)?.epo_cost(&Silent);
    /// assert!(overlap(BuildConfig::high())? < overlap(BuildConfig::fast())?);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`Error::Cancelled`], when `progress` says so.
    pub fn epo_cost(&self, progress: &dyn Progress) -> Result<f64, Error> {
        progress.stage("overlap", self.triangles.len() as u64);
        let nodes = Nodes::new(&self.nodes);
        let portion = |(i, triangles): (usize, &[Triangle])| {
            progress.check()?;
            let mut sums = (0.0, 0.0);
            for (k, triangle) in triangles.iter().enumerate() {
                let corners = corners(triangle);
                sums.0 += nodes.overlap(i * PORTION + k, &corners, &triangle.bounds());
                sums.1 += area(&corners);
            }
            progress.advance(triangles.len() as u64);
            Ok(sums)
        };
        let portions: Vec<(f64, f64)> =
            self.triangles.par_chunks(PORTION).enumerate().map(portion).collect::<Result<_, Error>>()?;
        let (overlap, total) = portions.iter().fold((0.0, 0.0), |sum, p| (sum.0 + p.0, sum.1 + p.1));
        Ok(if total > 0.0 { overlap / total } else { 0.0 })
    }
}

struct Nodes<'a> {
    nodes: &'a [Node],
    /// Number of triangles before each node, and of all.
    before: Vec<usize>,
    /// What entering each node costs.
    costs: Vec<f64>,
}

impl<'a> Nodes<'a> {
    fn new(nodes: &'a [Node]) -> Self {
        let mut before = vec![0];
        let mut costs = Vec::with_capacity(nodes.len());
        for (i, node) in nodes.iter().enumerate() {
            let count = node.triangles().1;
            before.push(before[i] + count as usize);
            let (mut tests, mut child) = (count, i + 1);
            while count == 0 && child < node.skip() as usize {
                tests += 1;
                child = nodes[child].skip() as usize;
            }
            costs.push(f64::from(tests));
        }
        Self { nodes, before, costs }
    }

    /// Area times costs of the triangle at `place` in all nodes that do not hold it.
    fn overlap(&self, place: usize, corners: &[Point; 3], bounds: &Aabb) -> f64 {
        let (mut sum, mut i) = (0.0, 0);
        while let Some(node) = self.nodes.get(i) {
            let skip = node.skip() as usize;
            let is_inside = (self.before[i]..self.before[skip]).contains(&place);
            if !is_inside {
                let inside = area_inside(corners, bounds, &node.bounds());
                if inside == 0.0 {
                    i = skip;
                    continue;
                }
                sum += self.costs[i] * inside;
            }
            i += 1;
        }
        sum
    }
}

/// As [`Triangle::bounds`] has them.
fn corners(t: &Triangle) -> [Point; 3] {
    let at = |e: [f32; 3]| [0, 1, 2].map(|axis| f64::from(t.v0[axis] + e[axis]));
    [at([0.0; 3]), at(t.e1), at(t.e2)]
}

/// Area of a triangle, whose box is `bounds`, inside of a box.
fn area_inside(corners: &[Point; 3], bounds: &Aabb, node: &Aabb) -> f64 {
    let is_apart = (0..3).any(|axis| bounds.max[axis] < node.min[axis] || node.max[axis] < bounds.min[axis]);
    if is_apart {
        return 0.0;
    }
    let (mut polygon, mut clipped) = (Polygon::new(corners), Polygon::default());
    for axis in 0..3 {
        if bounds.min[axis] < node.min[axis] {
            polygon.clip(axis, f64::from(node.min[axis]), 1.0, &mut clipped);
            std::mem::swap(&mut polygon, &mut clipped);
        }
        if node.max[axis] < bounds.max[axis] {
            polygon.clip(axis, f64::from(node.max[axis]), -1.0, &mut clipped);
            std::mem::swap(&mut polygon, &mut clipped);
        }
    }
    area(polygon.points())
}

/// Convex. Each of the six planes that a triangle is clipped to adds one corner at most.
#[derive(Default)]
struct Polygon {
    corners: [Point; 9],
    len: usize,
}

impl Polygon {
    fn new(corners: &[Point; 3]) -> Self {
        let mut polygon = Self::default();
        corners.iter().for_each(|&p| polygon.push(p));
        polygon
    }

    fn points(&self) -> &[Point] {
        &self.corners[..self.len]
    }

    fn push(&mut self, p: Point) {
        // Rounding could make a sliver's border cross a plane more than twice: what there is no room for has no area.
        if let Some(corner) = self.corners.get_mut(self.len) {
            *corner = p;
            self.len += 1;
        }
    }

    /// Keeps what is above a plane (`side` 1) or below it (-1), borders included (Sutherland and Hodgman 1974).
    fn clip(&self, axis: usize, plane: f64, side: f64, clipped: &mut Self) {
        clipped.len = 0;
        let points = self.points();
        let Some(mut a) = points.last() else { return };
        for b in points {
            let (from_a, from_b) = (side * (a[axis] - plane), side * (b[axis] - plane));
            if (from_a < 0.0) != (from_b < 0.0) {
                let s = from_a / (from_a - from_b);
                let mut p = [0, 1, 2].map(|k| a[k] + s * (b[k] - a[k]));
                p[axis] = plane;
                clipped.push(p);
            }
            if from_b >= 0.0 {
                clipped.push(*b);
            }
            a = b;
        }
    }
}

/// Area of a convex polygon; 0 for fewer than three corners.
fn area(points: &[Point]) -> f64 {
    let Some((first, rest)) = points.split_first() else { return 0.0 };
    let mut sum = [0.0; 3];
    for pair in rest.windows(2) {
        let [a, b] = [0, 1].map(|k: usize| [0, 1, 2].map(|axis| pair[k][axis] - first[axis]));
        let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        (0..3).for_each(|axis| sum[axis] += cross[axis]);
    }
    0.5 * sum.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::BuildConfig;
    use crate::model::Mesh;
    use crate::progress::Silent;

    /// A root above a leaf for each triangle.
    fn two_leaves(corners: [[[f32; 3]; 3]; 2]) -> Bvh {
        let triangles: Vec<_> = corners.into_iter().zip(0..).map(|(c, id)| Triangle::new(c, id, 0)).collect();
        let [a, b] = [0, 1].map(|i: usize| triangles[i].bounds());
        let nodes = vec![Node::inner(&a.union(&b), 3), Node::leaf(&a, 2, 0, 1), Node::leaf(&b, 3, 1, 1)];
        Bvh { nodes, triangles }
    }

    #[test]
    fn computed_by_hand() {
        let cost = |corners| two_leaves(corners).epo_cost(&Silent).expect("not cancelled");
        let a = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        // A square of area 1 of the second lies in the first's box; of the first only a corner in that of the second. Both have area 2.
        assert_eq!(cost([a, [[3.0, 1.0, 0.0], [1.0, 1.0, 0.0], [1.0, 3.0, 0.0]]]), 0.25);
        // All of the second, of area 1/2.
        assert_eq!(cost([a, [[2.0, 2.0, 0.0], [1.0, 2.0, 0.0], [2.0, 1.0, 0.0]]]), 0.2);
        // Boxes that overlap where no triangle is.
        assert_eq!(cost([a, [[3.0, 1.5, 0.0], [1.5, 3.0, 0.0], [3.0, 3.0, 0.0]]]), 0.0);
        // Apart.
        assert_eq!(cost([a, a.map(|[x, y, _]| [x, y, 1.0])]), 0.0);
    }

    #[test]
    fn entering_costs_a_test_for_each_child_or_triangle() {
        // Three leaves and a node above two of them, and one triangle, of half of the area, that lies in all of their boxes.
        let big = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
        let triangles: Vec<_> =
            [big, big, big, big].into_iter().zip(0..).map(|(c, id)| Triangle::new(c, id, 0)).collect();
        let b = triangles[0].bounds();
        let nodes = vec![
            Node::inner(&b, 5),
            Node::inner(&b, 4),
            Node::leaf(&b, 3, 0, 1),
            Node::leaf(&b, 4, 1, 2),
            Node::leaf(&b, 5, 3, 1),
        ];
        let bvh = Bvh { nodes, triangles };
        bvh.validate().expect("a tree that is well-formed");
        // The first lies in a leaf of two and one of one, the next two in two leaves of one, the last in an inner node with its leaves.
        let expected = (3.0 + 2.0 * 2.0 + 2.0 + 1.0 + 2.0) / 4.0;
        assert_eq!(bvh.epo_cost(&Silent).expect("not cancelled"), expected);
        assert_eq!(Bvh { nodes: vec![], triangles: vec![] }.epo_cost(&Silent).expect("not cancelled"), 0.0);
    }

    /// Against points strewn over the triangles, each looked for in every box.
    #[test]
    fn agrees_with_random_points() {
        let mut state = 3_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / 16_777_216.0
        };
        let positions = (0..62).map(|_| [(); 3].map(|()| random() as f32)).collect();
        let mesh = Mesh { positions, triangles: (0..60).map(|i| [i, i + 1, i + 2]).collect(), ..Mesh::default() };
        for config in [BuildConfig::fast(), BuildConfig::medium(), BuildConfig::insertion(0)] {
            let bvh = Bvh::build(&mesh, &config, &Silent).expect("a valid mesh");
            let nodes = Nodes::new(&bvh.nodes);
            let (mut sum, mut total) = (0.0, 0.0);
            for (place, triangle) in bvh.triangles.iter().enumerate() {
                let [a, b, c] = corners(triangle);
                const POINTS: usize = 2000;
                let weight = area(&[a, b, c]) / POINTS as f64;
                total += area(&[a, b, c]);
                for _ in 0..POINTS {
                    let (u, v) = (random(), random());
                    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                    let p = [0, 1, 2].map(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]));
                    for (i, node) in bvh.nodes.iter().enumerate() {
                        let Aabb { min, max } = node.bounds();
                        let is_inside = (0..3).all(|k| f64::from(min[k]) <= p[k] && p[k] <= f64::from(max[k]));
                        if is_inside && !(nodes.before[i]..nodes.before[node.skip() as usize]).contains(&place) {
                            sum += nodes.costs[i] * weight;
                        }
                    }
                }
            }
            let (found, expected) = (bvh.epo_cost(&Silent).expect("not cancelled"), sum / total);
            assert!(found > 5.0 && (found / expected - 1.0).abs() < 0.01, "{config:?}: {found}, {expected}");
        }
    }
}
