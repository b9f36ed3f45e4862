//! Axis-aligned boxes.

/// `f` of the components of both. (`array::from_fn` is not always inlined, and builders do this a lot.)
#[inline(always)]
pub(crate) fn zip<const N: usize>(mut a: [f32; N], b: &[f32; N], f: impl Fn(f32, f32) -> f32) -> [f32; N] {
    for i in 0..N {
        a[i] = f(a[i], b[i]);
    }
    a
}

/// The smaller and the larger. Not `f32::min`: that leaves the sign of a zero to the platform.
#[inline(always)]
pub(crate) fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// See [`min`].
#[inline(always)]
pub(crate) fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// An axis-aligned box; empty when `min > max`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Lower corner.
    pub min: [f32; 3],
    /// Upper corner.
    pub max: [f32; 3],
}

impl Aabb {
    /// The box that holds nothing: the neutral element of [`Aabb::union`].
    pub const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    /// The smallest box around `points`.
    #[inline]
    #[must_use]
    pub fn of_points(points: impl IntoIterator<Item = [f32; 3]>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| b.union(&Self { min: p, max: p }))
    }

    /// The smallest box around both, exactly. A NaN in `other` makes the result NaN; one in `self` is dropped.
    #[inline]
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        Self { min: zip(self.min, &other.min, min), max: zip(self.max, &other.max, max) }
    }

    /// Half the surface area (the constant factor cancels in every cost); 0 for an empty box.
    #[inline]
    #[must_use]
    pub fn half_area(&self) -> f32 {
        let [x, y, z] = self.extent();
        if x < 0.0 { 0.0 } else { x * y + y * z + z * x }
    }

    /// As [`Aabb::half_area`], without overflow and with the small differences between large boxes.
    #[inline]
    #[must_use]
    pub fn half_area_f64(&self) -> f64 {
        let [x, y, z] = std::array::from_fn(|i| f64::from(self.max[i]) - f64::from(self.min[i]));
        if x < 0.0 { 0.0 } else { x * y + y * z + z * x }
    }

    /// Edge lengths (negative when empty).
    #[inline]
    #[must_use]
    pub fn extent(&self) -> [f32; 3] {
        zip(self.max, &self.min, |a, b| a - b)
    }

    /// The middle.
    #[inline]
    #[must_use]
    pub fn center(&self) -> [f32; 3] {
        std::array::from_fn(|i| 0.5 * self.min[i] + 0.5 * self.max[i])
    }

    /// True when `other` lies inside, borders included.
    #[inline]
    #[must_use]
    pub fn contains(&self, other: &Self) -> bool {
        (0..3).all(|i| self.min[i] <= other.min[i] && other.max[i] <= self.max[i])
    }

    /// True when every coordinate is a finite number.
    #[inline]
    #[must_use]
    pub fn is_finite(&self) -> bool {
        // Zero times a number is zero unless that is infinite or none: no branches.
        let zero = zip(zip(self.min, &[0.0; 3], |x, y| x * y), &self.max, |x, y| x + y * 0.0);
        zero[0] + zero[1] + zero[2] == 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::Aabb;

    #[test]
    fn union_is_exact_and_empty_is_neutral() {
        let a = Aabb { min: [0.0, 1.0, -2.0], max: [0.1, 1.0, 3.0] };
        let b = Aabb { min: [-1.0, 2.0, -1.0], max: [0.0, 5.0, f32::MAX] };
        assert_eq!(a.union(&b), Aabb { min: [-1.0, 1.0, -2.0], max: [0.1, 5.0, f32::MAX] });
        assert_eq!(a.union(&Aabb::EMPTY), a);
        assert_eq!(Aabb::EMPTY.union(&a), a);
        assert!(a.union(&b).contains(&a) && a.union(&b).contains(&b) && !a.contains(&b));
    }

    #[test]
    fn area_of_flat_and_empty_boxes() {
        assert_eq!(Aabb::EMPTY.half_area(), 0.0);
        assert_eq!(Aabb { min: [1.0; 3], max: [2.0, 3.0, 1.0] }.half_area(), 2.0);
        assert_eq!(Aabb { min: [0.0; 3], max: [1.0, 2.0, 3.0] }.half_area(), 11.0);
    }

    #[test]
    fn the_center_of_the_largest_box_is_finite() {
        let all = Aabb { min: [f32::MIN; 3], max: [f32::MAX; 3] };
        assert_eq!(all.center(), [0.0; 3]);
        assert!(all.is_finite() && !Aabb::EMPTY.is_finite());
    }
}
