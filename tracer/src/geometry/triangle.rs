//! The 48-byte triangle of Geimer & Müller 2003, section 3.2.

use super::Aabb;
use super::aabb::{max, min, zip};

/// One vertex and two edges in 16-byte blocks, the fourth word of each used.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C, align(16))]
pub struct Triangle {
    /// First vertex.
    pub v0: [f32; 3],
    /// Primitive id: the triangle's place in the mesh.
    pub id: u32,
    /// Second vertex minus first.
    pub e1: [f32; 3],
    /// Material index of the mesh.
    pub material: u32,
    /// Third vertex minus first.
    pub e2: [f32; 3],
    /// Geometry the triangle belongs to: 0 in a scene of one mesh.
    pub geometry: u32,
}

impl Triangle {
    /// From three vertices.
    #[inline]
    #[must_use]
    pub fn new([v0, v1, v2]: [[f32; 3]; 3], id: u32, material: u32) -> Self {
        let (e1, e2) = (zip(v1, &v0, |a, b| a - b), zip(v2, &v0, |a, b| a - b));
        Self { v0, id, e1, material, e2, geometry: 0 }
    }

    /// The box that traversal and the exact hit test agree on: of `v0`, `v0 + e1` and `v0 + e2` as the stored
    /// numbers round, which can differ from the given vertices in the last bit.
    #[inline]
    #[must_use]
    pub fn bounds(&self) -> Aabb {
        let (v1, v2) = (zip(self.v0, &self.e1, |a, b| a + b), zip(self.v0, &self.e2, |a, b| a + b));
        let min = zip(zip(self.v0, &v1, min), &v2, min);
        let max = zip(zip(self.v0, &v1, max), &v2, max);
        Aabb { min, max }
    }

    /// True when it is a point, which nothing hits: what [refitting](crate::bvh::Bvh::refit) leaves of a degenerate triangle.
    #[inline]
    #[must_use]
    pub fn is_point(&self) -> bool {
        self.e1 == [0.0; 3] && self.e2 == [0.0; 3]
    }

    /// True when no ray can meaningfully hit it: its sides are parallel to within the precision of `f32`
    /// (|e1 x e2| <= 2^-23 |e1| |e2|), a side has no length, or an edge or the box overflows.
    #[inline]
    #[must_use]
    pub fn is_degenerate(&self) -> bool {
        // Written so that NaN and infinity count as degenerate. `v0 + e1` can overflow even where `e1` did not: the
        // difference of the largest number and a small one may have been rounded up.
        !((self.is_far_from_parallel() || self.is_not_parallel()) && self.bounds().is_finite())
    }

    /// Never true where [`Triangle::is_not_parallel`] is not, true for almost every triangle, and cheaper. The cross product is wrong by
    /// no more than 2^-20 |e1| |e2| where no product underflows, and what underflows is far below the square root of 1e-20.
    #[inline(always)]
    fn is_far_from_parallel(&self) -> bool {
        let (a, b) = (&self.e1, &self.e2);
        let (x, y, z) = (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
        let cross = x * x + y * y + z * z;
        let squares = (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) * (b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
        cross > 1e-20 && cross > 1e-6 * squares
    }

    #[cold]
    fn is_not_parallel(&self) -> bool {
        let [a, b] = [self.e1, self.e2].map(|e| e.map(f64::from));
        let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let square = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>();
        let eps = f64::from(f32::EPSILON);
        square(cross) > eps * eps * square(a) * square(b)
    }
}

#[cfg(test)]
mod tests {
    use super::Triangle;

    fn degenerate(vertices: [[f32; 3]; 3]) -> bool {
        Triangle::new(vertices, 0, 0).is_degenerate()
    }

    #[test]
    fn bounds_hold_the_stored_vertices() {
        // 1e8 - 1 rounds to 1e8, so the stored second vertex is 1e8 + 1, rounded to 1e8.
        let t = Triangle::new([[1.0, 0.0, 0.0], [1e8, 0.0, 3.0], [-2.0, 4.0, 0.0]], 0, 0);
        let b = t.bounds();
        assert_eq!(b.min, [-2.0, 0.0, 0.0]);
        assert_eq!(b.max, [1.0 + t.e1[0], 4.0, 3.0]);
    }

    #[test]
    fn slivers_points_and_overflow_are_degenerate() {
        let o = [0.0; 3];
        assert!(!degenerate([o, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]));
        assert!(!degenerate([o, [1e-20, 0.0, 0.0], [0.0, 1e-20, 0.0]]), "small is not degenerate");
        assert!(!degenerate([o, [1e30, 0.0, 0.0], [0.0, 1e30, 0.0]]), "large is not degenerate");
        assert!(!degenerate([o, [1.0, 0.0, 0.0], [1.0, 1e-6, 0.0]]));
        assert!(degenerate([o, [1.0, 0.0, 0.0], [1.0, 1e-8, 0.0]]));
        assert!(degenerate([o, [1.0, 2.0, 3.0], [2.0, 4.0, 6.0]]));
        assert!(degenerate([o, o, [1.0, 0.0, 0.0]]));
        assert!(degenerate([o; 3]));
        assert!(degenerate([[f32::MIN, 0.0, 0.0], [f32::MAX, 0.0, 0.0], [0.0, 1.0, 0.0]]), "an edge overflows");
        assert!(degenerate([[f32::NAN, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]));
        assert!(degenerate([[f32::INFINITY, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]));
    }

    #[test]
    fn a_box_that_rounds_to_infinity_is_degenerate() {
        let ulp = f32::MAX - f32::MAX.next_down();
        let t = Triangle::new([[1.5 * ulp, 0.0, 0.0], [f32::MAX, 0.0, 0.0], [0.0, f32::MAX, 0.0]], 0, 0);
        assert!(t.e1[0].is_finite() && t.bounds().max[0].is_infinite());
        assert!(t.is_degenerate());
    }
}
