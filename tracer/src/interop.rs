//! Conversions to and from the types of other crates, each behind the feature of its name. Bits stay as they are.
//!
//! - `glam`: a [`Ray`] is made `From` its origin and direction, an [`Aabb`] from its corners, a [`Mesh`] from slices of positions and
//!   triangles, and back (rays and boxes); module `glam` has affine transforms as rows.
//! - `mint`: the same of `Point3` and `Vector3`. Its matrices are rows already: `<[[f32; 4]; 3]>::from(row_matrix_3x4)`.
//!
//! What other crates keep as `[f32; 3]`, or turn into that, needs no conversion: it is what this one takes.

use crate::geometry::{Aabb, Ray};
use crate::model::Mesh;

/// Between our types and pairs of points, or a point and a vector.
macro_rules! convert {
    ($Point:ty, $Vector:ty) => {
        /// Origin and direction, of any length; all of the ray from `t = 0` on.
        impl From<($Point, $Vector)> for Ray {
            fn from((org, dir): ($Point, $Vector)) -> Self {
                Self::new(org.into(), dir.into())
            }
        }

        /// Origin and direction.
        impl From<Ray> for ($Point, $Vector) {
            fn from(ray: Ray) -> Self {
                (ray.org.into(), ray.dir.into())
            }
        }

        /// Lower and upper corner.
        impl From<($Point, $Point)> for Aabb {
            fn from((min, max): ($Point, $Point)) -> Self {
                Self { min: min.into(), max: max.into() }
            }
        }

        /// Lower and upper corner.
        impl From<Aabb> for ($Point, $Point) {
            fn from(bounds: Aabb) -> Self {
                (bounds.min.into(), bounds.max.into())
            }
        }

        /// Positions, and three of them for each triangle; without normals and materials.
        impl From<(&[$Point], &[[u32; 3]])> for Mesh {
            fn from((positions, triangles): (&[$Point], &[[u32; 3]])) -> Self {
                let positions = positions.iter().map(|&p| p.into()).collect();
                Self { positions, triangles: triangles.to_vec(), ..Self::default() }
            }
        }
    };
}

#[cfg(feature = "glam")]
convert!(::glam::Vec3, ::glam::Vec3);
#[cfg(feature = "mint")]
convert!(::mint::Point3<f32>, ::mint::Vector3<f32>);

/// Affine transforms of glam.
#[cfg(feature = "glam")]
pub mod glam {
    use glam::Affine3A;

    /// The rows of a transform: `rows[i]` times `(x, y, z, 1)` is coordinate `i` of the point transformed.
    ///
    /// ```
    /// use glam::{Affine3A, Vec3};
    ///
    /// let rows = tracer::interop::glam::rows(&Affine3A::from_translation(Vec3::new(1.0, 2.0, 3.0)));
    /// assert_eq!(rows, [[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 2.0], [0.0, 0.0, 1.0, 3.0]]);
    /// ```
    #[must_use]
    pub fn rows(transform: &Affine3A) -> [[f32; 4]; 3] {
        let [x, y, z, w] = transform.to_cols_array_2d();
        [[x[0], y[0], z[0], w[0]], [x[1], y[1], z[1], w[1]], [x[2], y[2], z[2], w[2]]]
    }

    /// The inverse of [`rows`].
    #[must_use]
    pub fn from_rows([a, b, c]: &[[f32; 4]; 3]) -> Affine3A {
        let column = |i: usize| [a[i], b[i], c[i]];
        Affine3A::from_cols_array_2d(&[column(0), column(1), column(2), column(3)])
    }
}
