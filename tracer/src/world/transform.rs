//! From world to object and back, and how much boxes have to grow so that rounding loses no hit.
//!
//! A ray is transformed in `f64` and rounded to `f32` once, so what an instance is asked differs from the exact ray by rounding, and its
//! hits may lie a little outside the exact box of the instance in the world. Boxes in the world therefore grow: by a part that depends
//! on the instance, which is in its [`bounds`](Transform::bounds), and by one in proportion to the distance of the ray's origin from
//! zero, [`growth`](Transform::growth).
//!
//! That is enough. Let `u = 2^-24`, all norms be largest sums of rows (or largest components), `A, a` the matrix from object to world,
//! `B, b` its inverse as stored, `k = |A| |B| <= 2^20`, `|AB - 1| <= 2^-26`, `L` the largest coordinate of the object's box and `W` that
//! of its box in the world, `s = |B| |org| + |b|`, `D = L + s`. A hit at `t` lies in the ray's computed interval in the object's box,
//! which is padded by 8u (see [`slab`](crate::geometry::slab)).
//! - So `org' + t dir'`, with the rounded ray `org', dir'`, is in the object's box but for `16 u D`: 3 roundings near, 13 with the padding far,
//!   and less than `u D / 2^20` for a direction component that counts as zero, as `t |dir'| <= 1.1 D` and `|dir'| >= 2^-82`.
//! - The rounded ray is off the exact one by `u |org'|` and `u |dir'|` and the roundings in `f64`, `2^-50` times sums of sizes that no
//!   cancelling makes smaller: `t 2^-50 |B| |dir| <= 1.4 k 2^-50 D`. At `t` that makes less than `3 u D + 2^-50 s`.
//! - In the world these `20 u D` are at most `20 u |A| D = 20 u (|A| (L + |b|) + k |org|)`. `AB` not being 1 adds `u (W + |A| L)`.
//! - The test of the box in the world rounds as well, which `4 u (W + |org|)` covers, and `u (W + |org|)` each for writing box and grown
//!   origin as `f32`.
//!
//! All this is less than `32 u (|A| (L + |b|) + W) + 32 u k |org|`, with which boxes grow. Numbers that are no ordinary ones (`t dir'` may
//! underflow) are in a further `2^-60 |A|`, as long as no number is extreme: what [`Transform::new`] refuses, and
//! [`is_ordinary`] tells of rays.

use crate::geometry::{Aabb, Ray};

/// 32 u.
const GROWTH: f64 = 32.0 / (1 << 24) as f64;
const LARGEST_SCALE: f64 = (1_u64 << 40) as f64;
const LARGEST_COORDINATE: f64 = (1_u64 << 60) as f64;

/// Rows of three columns and a translation.
type Rows<T> = [[T; 4]; 3];

/// An affine map and its inverse.
#[derive(Debug, Clone)]
pub(super) struct Transform {
    to_world: Rows<f64>,
    to_object: Rows<f64>,
}

impl Transform {
    /// From the rows of the matrix that takes points of the object to the world.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub(super) fn new(rows: &Rows<f32>) -> Result<Self, String> {
        if !rows.as_flattened().iter().all(|x| x.is_finite()) {
            return Err(format!("its matrix is {rows:?}: every number must be finite"));
        }
        let to_world = rows.map(|row| row.map(f64::from));
        let to_object = inverse(&to_world);
        let (size, inverse_size) = (norm(&to_world), norm(&to_object));
        let product = times(&to_world, &to_object);
        let off =
            (0..3).map(|i| (0..3).map(|k| (product[i][k] - f64::from(i == k)).abs()).sum::<f64>()).fold(0.0, f64::max);
        let is_finite = to_object.as_flattened().iter().all(|x| x.is_finite());
        if !is_finite || size * inverse_size > (1 << 20) as f64 || off > 1.0 / (1 << 27) as f64 {
            return Err(format!("its matrix {rows:?} has no inverse, or nearly none: it must not flatten the object"));
        }
        if size > LARGEST_SCALE || inverse_size > LARGEST_SCALE {
            return Err(format!(
                "its matrix {rows:?} scales by more than 2^40, or less than 2^-40: give coordinates in another unit"
            ));
        }
        Ok(Self { to_world, to_object })
    }

    /// The ray in the object's coordinates; `t` means the same.
    #[inline(always)]
    pub(super) fn ray(&self, ray: &Ray) -> Ray {
        let ([x, y, z], [u, v, w]) = (ray.org, ray.dir);
        let (x, y, z) = (f64::from(x), f64::from(y), f64::from(z));
        let (u, v, w) = (flush(u), flush(v), flush(w));
        let mut object = *ray;
        for (i, [a, b, c, shift]) in self.to_object.iter().enumerate() {
            object.org[i] = (a * x + b * y + c * z + shift) as f32;
            object.dir[i] = (a * u + b * v + c * w) as f32;
        }
        object
    }

    /// The box in the world of a box of the object, as the head of this file has it.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub(super) fn bounds(&self, object: &Aabb) -> Result<Aabb, String> {
        let (mut min, mut max) = ([0.0; 3], [0.0; 3]);
        for (i, [row @ .., shift]) in self.to_world.iter().enumerate() {
            (min[i], max[i]) = (*shift, *shift);
            for (k, factor) in row.iter().enumerate() {
                let (a, b) = (factor * f64::from(object.min[k]), factor * f64::from(object.max[k]));
                min[i] += a.min(b);
                max[i] += a.max(b);
            }
        }
        let largest = |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).fold(0.0, f64::max);
        let of_object = largest(&mut object.min.iter().chain(&object.max).map(|&x| f64::from(x)));
        let of_world = largest(&mut min.iter().chain(&max).copied());
        let of_shift = largest(&mut self.to_object.iter().map(|row| row[3]));
        if [of_object, of_world, of_shift].iter().any(|&x| x > LARGEST_COORDINATE) {
            return Err("its coordinates are more than 2^60: give them in another unit".into());
        }
        let size = norm(&self.to_world);
        let grow = GROWTH * (size * (of_object + of_shift) + of_world) + size / LARGEST_COORDINATE;
        Ok(Aabb { min: min.map(|x| (x - grow) as f32), max: max.map(|x| (x + grow) as f32) })
    }

    /// How much boxes grow for a ray that starts at 1 on the axis on which it is farthest from zero.
    pub(super) fn growth(&self) -> f32 {
        // Rounded up, and the product with the origin as well.
        (GROWTH * norm(&self.to_world) * norm(&self.to_object) * 1.001) as f32
    }
}

/// Zero for what counts as zero: see [`Ray`].
#[inline(always)]
fn flush(d: f32) -> f64 {
    if d.abs() < f32::MIN_POSITIVE { 0.0 } else { f64::from(d) }
}

/// Whether all of this holds for a ray; for others no box is asked.
#[inline(always)]
pub(super) fn is_ordinary(ray: &Ray) -> bool {
    let (org, dir) = (f64::from(largest(&ray.org)), f64::from(largest(&ray.dir)));
    org <= LARGEST_COORDINATE && (1.0 / LARGEST_SCALE..=LARGEST_SCALE).contains(&dir)
}

/// The largest size of a coordinate.
#[inline(always)]
pub(super) fn largest(v: &[f32; 3]) -> f32 {
    v[0].abs().max(v[1].abs()).max(v[2].abs())
}

/// By cofactors; not finite if there is none.
fn inverse(m: &Rows<f64>) -> Rows<f64> {
    let cofactor = |i: usize, k: usize| {
        let (i1, i2, k1, k2) = ((i + 1) % 3, (i + 2) % 3, (k + 1) % 3, (k + 2) % 3);
        m[i1][k1] * m[i2][k2] - m[i1][k2] * m[i2][k1]
    };
    let det = m[0][0] * cofactor(0, 0) + m[0][1] * cofactor(0, 1) + m[0][2] * cofactor(0, 2);
    let mut inverse = [[0.0; 4]; 3];
    for (k, row) in inverse.iter_mut().enumerate() {
        let [x, y, z] = [0, 1, 2].map(|i| cofactor(i, k) / det);
        *row = [x, y, z, -(x * m[0][3] + y * m[1][3] + z * m[2][3])];
    }
    inverse
}

/// The largest sum of a row, without translation.
fn norm(m: &Rows<f64>) -> f64 {
    m.iter().map(|row| row[..3].iter().map(|x| x.abs()).sum()).fold(0.0, f64::max)
}

/// The product, without translation.
fn times(a: &Rows<f64>, b: &Rows<f64>) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|k| a[i][0] * b[0][k] + a[i][1] * b[1][k] + a[i][2] * b[2][k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_and_boxes_go_where_the_matrix_says() {
        // A quarter turn about z, twice as large, moved.
        let t = Transform::new(&[[0.0, -2.0, 0.0, 10.0], [2.0, 0.0, 0.0, 20.0], [0.0, 0.0, 2.0, 30.0]]).expect("sound");
        let ray = Ray { t_min: 1.0, t_max: 5.0, ..Ray::new([8.0, 22.0, 30.0], [0.0, 4.0, 1e-40]) };
        let object = t.ray(&ray);
        assert_eq!((object.org, object.dir, object.t_min, object.t_max), ([1.0, 1.0, 0.0], [2.0, 0.0, 0.0], 1.0, 5.0));
        let b = t.bounds(&Aabb { min: [0.0; 3], max: [1.0, 2.0, 3.0] }).expect("not large");
        let (exact_min, exact_max) = ([6.0, 20.0, 30.0], [10.0, 22.0, 36.0]);
        for k in 0..3 {
            assert!(b.min[k] < exact_min[k] && b.min[k] > exact_min[k] - 1e-3, "{b:?}");
            assert!(b.max[k] > exact_max[k] && b.max[k] < exact_max[k] + 1e-3, "{b:?}");
        }
    }

    #[test]
    fn what_has_no_inverse_is_refused() {
        let diagonal = |x: f32, y: f32, z: f32| [[x, 0.0, 0.0, 1.0], [0.0, y, 0.0, 1.0], [0.0, 0.0, z, 1.0]];
        for (rows, reason) in [
            (diagonal(1.0, f32::NAN, 1.0), "must be finite"),
            ([[1.0, 0.0, 0.0, f32::INFINITY], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]], "must be finite"),
            (diagonal(1.0, 0.0, 1.0), "no inverse"),
            ([[1.0, 2.0, 3.0, 0.0], [2.0, 4.0, 6.0, 0.0], [0.0, 0.0, 1.0, 0.0]], "no inverse"),
            (diagonal(1.0, 1e-7, 1.0), "nearly none"),
            (diagonal(1e15, 1e15, 1e15), "another unit"),
            (diagonal(1e-15, 1e-15, 1e-15), "another unit"),
            (diagonal(1e-38, 1e-38, 1e-38), "another unit"),
        ] {
            let e = Transform::new(&rows).expect_err(reason);
            assert!(e.contains(reason), "{e}");
        }
        for rows in [diagonal(-1.0, 1.0, 1.0), diagonal(1e4, 1.0, 1.0), diagonal(1e9, 1e9, -1e9)] {
            Transform::new(&rows).expect("invertible");
        }
        let e =
            Transform::new(&diagonal(1.0, 1.0, 1.0)).expect("sound").bounds(&Aabb { min: [0.0; 3], max: [1e30; 3] });
        assert!(e.expect_err("too large").contains("2^60"));
    }
}
