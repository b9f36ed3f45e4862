//! Conversions to and from the types of other crates, each behind the feature of its name.
//!
//! - `bytemuck`: [`Block`](crate::Block) is plain data: `bytemuck::cast_slice` sees blocks as bytes, numbers or vectors.
//! - `wide`, `pulp`: `From` and `Into` between a [`Block`](crate::Block) and the vectors that fill it, as `[f32x4; 4]`,
//!   `[f32x8; 2]` or `f32x16`, also of `i32` and `u32`. The bits stay as they are.
//! - `glam`: module `glam`, vectors of points from slices of `Vec3` and `Vec4` and back.
//!
//! Whole slices of `wide` and `pulp` vectors are plain data too: `bytemuck::cast_slice::<Block<f32>, wide::f32x8>(blocks)` copies
//! nothing. The vector types of this crate cannot be named and so have no conversions: go through slices, arrays and blocks.

#[cfg(feature = "bytemuck")]
mod plain_data {
    use crate::Block;
    use bytemuck::{Pod, Zeroable};

    macro_rules! plain_data {
        ($($Lane:ty),*) => {$(
            // SAFETY: sixteen numbers, for which zero is a value.
            unsafe impl Zeroable for Block<$Lane> {}
            // SAFETY: sixteen numbers of four bytes, any bits of which are a value, without padding: 64 bytes, aligned to 64.
            unsafe impl Pod for Block<$Lane> {}
        )*};
    }
    plain_data!(f32, i32, u32);
}

/// `From` both ways between blocks and vectors of plain data that fill them.
#[cfg(any(feature = "wide", feature = "pulp"))]
macro_rules! fill_blocks {
    ($($Lane:ty: $($Vectors:ty),*;)*) => {$($(
        impl From<$Vectors> for crate::Block<$Lane> {
            #[inline(always)]
            fn from(vectors: $Vectors) -> Self {
                bytemuck::must_cast(vectors)
            }
        }
        impl From<crate::Block<$Lane>> for $Vectors {
            #[inline(always)]
            fn from(block: crate::Block<$Lane>) -> Self {
                bytemuck::must_cast(block)
            }
        }
    )*)*};
}

#[cfg(feature = "wide")]
fill_blocks! {
    f32: [wide::f32x4; 4], [wide::f32x8; 2], wide::f32x16;
    i32: [wide::i32x4; 4], [wide::i32x8; 2], wide::i32x16;
    u32: [wide::u32x4; 4], [wide::u32x8; 2], wide::u32x16;
}

#[cfg(feature = "pulp")]
fill_blocks! {
    f32: [pulp::f32x4; 4], [pulp::f32x8; 2], pulp::f32x16;
    i32: [pulp::i32x4; 4], [pulp::i32x8; 2], pulp::i32x16;
    u32: [pulp::u32x4; 4], [pulp::u32x8; 2], pulp::u32x16;
}

/// Vectors of points, one vector per coordinate, from slices of glam's points and back.
///
/// ```
/// use glam::Vec3;
/// use simd::interop::glam::{load3, store3};
/// use simd::{Float, Level, Vector, math};
///
/// simd::kernel! {
///     /// Moves all points up. Works on whole vectors: the number of points is a multiple of 16.
///     fn lift<S>(points: &mut [Vec3], height: f32) {
///         for points in points.chunks_exact_mut(S::Float::LANES) {
///             let [x, y, z] = load3::<S::Float>(points);
///             store3([x, y + S::Float::splat(height), z], points);
///         }
///     }
/// }
///
/// let mut points = [Vec3::new(1.0, 2.0, 3.0); 32];
/// lift(Level::best(), &mut points, 0.5);
/// assert_eq!(points, [Vec3::new(1.0, 2.5, 3.0); 32]);
/// ```
#[cfg(feature = "glam")]
pub mod glam {
    use crate::Float;
    use glam::{Vec3, Vec4};

    /// The points as rows of numbers, without copying, as [`Vector::load_rows4`](crate::Vector::load_rows4) takes them.
    #[must_use]
    #[inline(always)]
    pub fn rows4(points: &[Vec4]) -> &[[f32; 4]] {
        bytemuck::must_cast_slice(points)
    }

    /// The points as rows of numbers, as [`Vector::store_rows4`](crate::Vector::store_rows4) takes them.
    #[must_use]
    #[inline(always)]
    pub fn rows4_mut(points: &mut [Vec4]) -> &mut [[f32; 4]] {
        bytemuck::must_cast_slice_mut(points)
    }

    /// The points as rows of numbers, without copying.
    #[must_use]
    #[inline(always)]
    pub fn rows3(points: &[Vec3]) -> &[[f32; 3]] {
        bytemuck::must_cast_slice(points)
    }

    /// The points as rows of numbers.
    #[must_use]
    #[inline(always)]
    pub fn rows3_mut(points: &mut [Vec3]) -> &mut [[f32; 3]] {
        bytemuck::must_cast_slice_mut(points)
    }

    /// The x, y, z and w of the first [`Vector::LANES`](crate::Vector::LANES) points.
    ///
    /// # Panics
    /// If there are fewer points.
    #[must_use]
    #[inline(always)]
    pub fn load4<F: Float>(points: &[Vec4]) -> [F; 4] {
        F::load_rows4(rows4(points))
    }

    /// The inverse of [`load4`].
    ///
    /// # Panics
    /// If there are fewer than [`Vector::LANES`](crate::Vector::LANES) points.
    #[inline(always)]
    pub fn store4<F: Float>(xyzw: [F; 4], points: &mut [Vec4]) {
        F::store_rows4(xyzw, rows4_mut(points));
    }

    /// The x, y and z of the first [`Vector::LANES`](crate::Vector::LANES) points.
    ///
    /// # Panics
    /// If there are fewer points.
    #[must_use]
    #[inline(always)]
    pub fn load3<F: Float>(points: &[Vec3]) -> [F; 3] {
        let rows = &rows3(points)[..F::LANES];
        [F::from_fn(|i| rows[i][0]), F::from_fn(|i| rows[i][1]), F::from_fn(|i| rows[i][2])]
    }

    /// The inverse of [`load3`].
    ///
    /// # Panics
    /// If there are fewer than [`Vector::LANES`](crate::Vector::LANES) points.
    #[inline(always)]
    pub fn store3<F: Float>([x, y, z]: [F; 3], points: &mut [Vec3]) {
        let (x, y, z) = (x.to_block().0, y.to_block().0, z.to_block().0);
        for (i, row) in rows3_mut(&mut points[..F::LANES]).iter_mut().enumerate() {
            *row = [x[i], y[i], z[i]];
        }
    }
}
