//! The little vector algebra that cameras and generators need: `f64`, so that rounding to `f32` once at the end is all
//! the error there is, and `libm` for the functions that differ between platforms.

pub(super) type Vec3 = [f64; 3];

pub(super) fn wide(a: [f32; 3]) -> Vec3 {
    a.map(f64::from)
}

pub(super) fn narrow(a: Vec3) -> [f32; 3] {
    a.map(|x| x as f32)
}

pub(super) fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(super) fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn scale(a: Vec3, s: f64) -> Vec3 {
    a.map(|x| x * s)
}

pub(super) fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn length(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// The unit vector along `a`; NaN when `a` is zero.
pub(super) fn normalize(a: Vec3) -> Vec3 {
    scale(a, 1.0 / length(a))
}

/// A unit vector perpendicular to the unit vector `a`.
pub(super) fn perpendicular(a: Vec3) -> Vec3 {
    let across = if a[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    normalize(cross(a, across))
}

/// `(sin, cos)` of an angle in degrees.
pub(super) fn sin_cos(degrees: f64) -> (f64, f64) {
    libm::sincos(degrees.to_radians())
}

/// `a` turned counter-clockwise about the unit vector `axis` (Rodrigues), given the angle's sine and cosine.
pub(super) fn rotate(a: Vec3, axis: Vec3, (sin, cos): (f64, f64)) -> Vec3 {
    let along = scale(axis, dot(axis, a) * (1.0 - cos));
    add(add(scale(a, cos), scale(cross(axis, a), sin)), along)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_counter_clockwise() {
        let near = |a: Vec3, b: Vec3| length(sub(a, b)) < 1e-15;
        let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for (a, axis, b) in [(x, z, y), (y, x, z), (z, y, x), (z, z, z)] {
            assert!(near(rotate(a, axis, sin_cos(90.0)), b));
        }
        let axis = normalize([1.0, 1.0, 1.0]);
        assert!(near(rotate(x, axis, sin_cos(120.0)), y));
        assert!(dot(perpendicular(axis), axis).abs() < 1e-15);
        assert!(perpendicular(x)[0] == 0.0 && (length(perpendicular(x)) - 1.0).abs() < 1e-15);
    }
}
