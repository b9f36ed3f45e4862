//! Directions in the frame of a surface.

use crate::geometry::Vec3;
use simd::Float;

/// Three unit vectors at right angles, the last of them given (Duff and others 2017, "Building an Orthonormal Basis, Revisited", Journal of
/// Computer Graphics Techniques 6(1)).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame<F: Float> {
    x: Vec3<F>,
    y: Vec3<F>,
    z: Vec3<F>,
}

impl<F: Float> Frame<F> {
    /// Around a unit vector.
    #[inline(always)]
    pub(crate) fn around(z: Vec3<F>) -> Self {
        let one = F::splat(1.0);
        let sign = one.copysign(z.z);
        let a = -one / (sign + z.z);
        let b = z.x * z.y * a;
        Self {
            x: Vec3 { x: one + sign * z.x * z.x * a, y: sign * b, z: -sign * z.x },
            y: Vec3 { x: b, y: sign + z.y * z.y * a, z: -z.y },
            z,
        }
    }

    /// Into the frame.
    #[inline(always)]
    pub(crate) fn local(&self, v: Vec3<F>) -> Vec3<F> {
        Vec3 { x: self.x.dot(v), y: self.y.dot(v), z: self.z.dot(v) }
    }

    /// Out of the frame.
    #[inline(always)]
    pub(crate) fn world(&self, v: Vec3<F>) -> Vec3<F> {
        self.x.scale(v.x) + self.y.scale(v.y) + self.z.scale(v.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_angles_and_unit_lengths() {
        let close = |a: f32, b: f32| assert!((a - b).abs() < 1e-6, "{a}, not {b}");
        for (x, y, z) in [(0., 0., 1.), (0., 0., -1.), (1., 0., 0.), (0., -1., 0.), (0.6, 0.0, -0.8), (1e-4, 0., -1.)] {
            let frame = Frame::<f32>::around(Vec3 { x, y, z }.normalize());
            for v in [frame.x, frame.y, frame.z] {
                close(v.dot(v), 1.0);
            }
            for (v, w) in [(frame.x, frame.y), (frame.y, frame.z), (frame.z, frame.x)] {
                close(v.dot(w), 0.0);
            }
            let v = Vec3 { x: 0.3, y: -0.5, z: 2.0 };
            let back = frame.world(frame.local(v));
            close(back.x, v.x);
            close(back.y, v.y);
            close(back.z, v.z);
        }
    }
}
