//! The pinhole camera.

use super::vec3::{Vec3, add, cross, dot, length, narrow, normalize, perpendicular, scale, sub, wide};
use crate::Error;
use crate::geometry::Aabb;
use std::fmt;
use std::str::FromStr;

/// A pinhole camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Position.
    pub eye: [f32; 3],
    /// Point looked at.
    pub at: [f32; 3],
    /// Roughly upwards.
    pub up: [f32; 3],
    /// Full vertical angle of view, in degrees.
    pub fov: f32,
}

/// Eye rays of an image: pixel (x, y), counted from the top left, is seen along `corner + x * dx + y * dy` (not of unit
/// length) from `origin`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameVectors {
    /// Where all rays begin: the eye.
    pub origin: [f32; 3],
    /// Direction through the centre of pixel (0, 0).
    pub corner: [f32; 3],
    /// Step of the direction to the next pixel on the right.
    pub dx: [f32; 3],
    /// Step of the direction to the next pixel below.
    pub dy: [f32; 3],
}

impl Camera {
    /// The vertical angle of views that name none, in degrees (that of the SPD scenes).
    pub const DEFAULT_FOV: f32 = 45.0;
    /// The upward direction of views that name none.
    pub const DEFAULT_UP: [f32; 3] = [0.0, 1.0, 0.0];

    /// A three-quarter view from outside, from the right, above and in front (+z), with y upwards. The whole box is in the
    /// picture, and as large as it can be with a small margin, if the picture is at least as wide as it is high.
    #[must_use]
    pub fn framing(bounds: &Aabb) -> Self {
        let [min, max] = [bounds.min, bounds.max].map(wide);
        let center = scale(add(min, max), 0.5);
        let half = scale(sub(max, min), 0.5);
        let back = normalize([0.55, 0.4, 1.0]);
        let right = normalize(cross(wide(Self::DEFAULT_UP), back));
        let up = cross(back, right);
        let tan = half_tan(Self::DEFAULT_FOV);
        // A corner is in the picture when the eye is so far back that it lies within the two pairs of side planes.
        let corners = (0..8).map(|i| std::array::from_fn(|k| if i >> k & 1 == 0 { -half[k] } else { half[k] }));
        let needed = |c: Vec3| dot(c, back) + dot(c, right).abs().max(dot(c, up).abs()) / tan;
        let distance = 1.05 * corners.map(needed).fold(0.0, f64::max);
        // A box without extent still needs an eye that is somewhere else, after rounding too.
        let distance = if distance > 0.0 { distance } else { 1.0 + 0.01 * length(center) };
        let eye = add(center, scale(back, distance));
        Self { eye: narrow(eye), at: narrow(center), up: Self::DEFAULT_UP, fov: Self::DEFAULT_FOV }
    }

    /// Checks that it looks somewhere: finite numbers, `eye` apart from `at`, `up` not along the view, an angle of more
    /// than 0 and less than 180 degrees.
    ///
    /// # Errors
    /// [`Error::Usage`] saying which of these fails.
    pub fn validate(&self) -> Result<(), Error> {
        for (what, v) in [("eye", self.eye), ("at", self.at), ("up", self.up)] {
            if !v.iter().all(|c| c.is_finite()) {
                return usage(format!("{what} {v:?} must be three finite numbers"));
            }
        }
        if !(self.fov > 0.0 && self.fov < 180.0) {
            return usage(format!("the angle of view is {}, it must lie between 0 and 180 degrees", self.fov));
        }
        if self.eye == self.at {
            return usage(format!("eye and at are both {}, they must differ", Commas(self.eye)));
        }
        if self.up == [0.0; 3] {
            return usage("up is 0,0,0, it must point somewhere".into());
        }
        if self.side().is_none() {
            let [up, view] = [wide(self.up), self.view()].map(|v| Commas(narrow(v)));
            return usage(format!("up {up} is parallel to the view {view}, give another up"));
        }
        Ok(())
    }

    /// The eye rays of an image: square pixels, [`Camera::fov`] spans its whole height (from the upper edge of the topmost
    /// pixels to the lower edge of the lowest ones), and the middle of the image looks along a unit vector to `at`.
    /// Computed in `f64` and rounded once. An `up` along the view is replaced by another; a camera that fails
    /// [`Camera::validate`] otherwise, or an image without pixels, gives numbers without meaning.
    #[must_use]
    pub fn frame_vectors(&self, width: usize, height: usize) -> FrameVectors {
        let forward = normalize(self.view());
        let right = self.side().unwrap_or_else(|| perpendicular(forward));
        let down = cross(forward, right);
        let [w, h] = [width, height].map(|n| n as f64);
        let pixel = 2.0 * half_tan(self.fov) / h;
        let [dx, dy] = [right, down].map(|v| scale(v, pixel));
        let corner = sub(forward, add(scale(dx, 0.5 * (w - 1.0)), scale(dy, 0.5 * (h - 1.0))));
        FrameVectors { origin: self.eye, corner: narrow(corner), dx: narrow(dx), dy: narrow(dy) }
    }

    fn view(&self) -> Vec3 {
        sub(wide(self.at), wide(self.eye))
    }

    /// The unit vector to the right; none when `up` is parallel to the view to within the precision of `f32`.
    fn side(&self) -> Option<Vec3> {
        let (forward, up) = (normalize(self.view()), normalize(wide(self.up)));
        let side = cross(forward, up);
        (length(side) > 1e-6).then(|| normalize(side))
    }
}

fn half_tan(degrees: f32) -> f64 {
    libm::tan(0.5 * f64::from(degrees).to_radians())
}

fn usage<T>(message: String) -> Result<T, Error> {
    Err(Error::Usage(format!("camera: {message}")))
}

/// Three numbers as the command line writes them.
struct Commas([f32; 3]);

impl fmt::Display for Commas {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.0;
        write!(f, "{x},{y},{z}")
    }
}

/// `eye/at/up/fov`, as [`Camera::from_str`] reads it.
impl fmt::Display for Camera {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}/{}/{}", Commas(self.eye), Commas(self.at), Commas(self.up), self.fov)
    }
}

/// Reads `ex,ey,ez/ax,ay,az/ux,uy,uz/fov`. `up` and `fov` may be left out (`eye/at`, `eye/at/up`, `eye/at//fov`): then they
/// are 0,1,0 (0,0,1 when the view itself is vertical) and 45.
impl FromStr for Camera {
    type Err = Error;

    fn from_str(text: &str) -> Result<Self, Error> {
        let parts: Vec<&str> = text.split('/').map(str::trim).collect();
        if !(2..=4).contains(&parts.len()) {
            return usage(format!("{text:?} has {} parts, expected {FORMAT}", parts.len()));
        }
        let given = |i: usize| parts.get(i).copied().filter(|p| !p.is_empty());
        let mut camera = Self {
            eye: point("eye", parts[0])?,
            at: point("at", parts[1])?,
            up: given(2).map_or(Ok(Self::DEFAULT_UP), |p| point("up", p))?,
            fov: given(3).map_or(Ok(Self::DEFAULT_FOV), |p| number("fov", p))?,
        };
        if given(2).is_none() && camera.side().is_none() {
            camera.up = [0.0, 0.0, 1.0];
        }
        camera.validate()?;
        Ok(camera)
    }
}

const FORMAT: &str = "eye/at/up/fov, for example 2.1,1.3,1.7/0,0,0/0,0,1/45";

fn point(what: &str, text: &str) -> Result<[f32; 3], Error> {
    let numbers = text.split(',').map(|n| number(what, n)).collect::<Result<Vec<_>, _>>()?;
    match numbers.try_into() {
        Ok(p) => Ok(p),
        Err(n) => usage(format!("{what} {text:?} has {} numbers instead of 3, expected {FORMAT}", n.len())),
    }
}

fn number(what: &str, text: &str) -> Result<f32, Error> {
    match text.trim().parse() {
        Ok(n) => Ok(n),
        Err(_) => usage(format!("{what}: {text:?} is not a number, expected {FORMAT}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: [f32; 3], b: [f32; 3]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6)
    }

    #[test]
    fn parses_and_prints() {
        let c: Camera = "2.1, 1.3,1.7/0,0,-1e-1/0,0,1/60.5".parse().expect("well formed");
        assert_eq!(c, Camera { eye: [2.1, 1.3, 1.7], at: [0.0, 0.0, -0.1], up: [0.0, 0.0, 1.0], fov: 60.5 });
        assert_eq!(c.to_string().parse::<Camera>().expect("its own text"), c);
        let short: Camera = "0,0,5/0,0,0".parse().expect("eye and at");
        assert_eq!((short.up, short.fov), (Camera::DEFAULT_UP, Camera::DEFAULT_FOV));
        let down: Camera = "0,5,0/0,0,0//30".parse().expect("up left out");
        assert_eq!((down.up, down.fov), ([0.0, 0.0, 1.0], 30.0));
    }

    #[test]
    fn refuses_with_a_reason() {
        for (text, reason) in [
            ("", "has 1 parts"),
            ("0,0,0", "has 1 parts"),
            ("1,0,0/0,0,0/0,1,0/45/9", "has 5 parts"),
            ("1,0/0,0,0", "eye \"1,0\" has 2 numbers instead of 3"),
            ("1,0,0/0,0,0,4", "at \"0,0,0,4\" has 4 numbers"),
            ("1,x,0/0,0,0", "eye: \"x\" is not a number"),
            ("1,0,0//0,1,0", "at: \"\" is not a number"),
            ("1,0,0/0,0,0/0,1,0/wide", "fov: \"wide\" is not a number"),
            ("1,0,NaN/0,0,0", "eye"),
            ("1,0,0/0,1e99,0", "must be three finite numbers"),
            ("1,2,3/1,2,3", "eye and at are both 1,2,3"),
            ("1,0,0/0,0,0/0,0,0", "up is 0,0,0"),
            ("0,3,0/0,0,0/0,-2,0", "parallel"),
            ("1,0,0/0,0,0/0,1,0/0", "between 0 and 180"),
            ("1,0,0/0,0,0/0,1,0/180", "between 0 and 180"),
            ("1,0,0/0,0,0/0,1,0/NaN", "between 0 and 180"),
        ] {
            let message = text.parse::<Camera>().expect_err(text).to_string();
            assert!(message.contains(reason), "{text:?}: {message:?} should contain {reason:?}");
        }
    }

    /// A camera at the origin looking down -z with a right angle: the picture's edges are at slope 1.
    #[test]
    fn frame_vectors_span_the_image() {
        let c = Camera { eye: [0.0; 3], at: [0.0, 0.0, -7.0], up: [0.0, 3.0, 1.0], fov: 90.0 };
        let r = c.frame_vectors(4, 2);
        let at = |x: f32, y: f32| std::array::from_fn(|i| r.corner[i] + x * r.dx[i] + y * r.dy[i]);
        assert!(near(at(0.0, 0.0), [-1.5, 0.5, -1.0]), "centre of the top left pixel");
        assert!(near(at(3.0, 1.0), [1.5, -0.5, -1.0]), "centre of the bottom right pixel");
        assert!(near(at(1.5, 0.5), [0.0, 0.0, -1.0]), "the middle looks at `at`");
        assert!(near(at(-0.5, -0.5), [-2.0, 1.0, -1.0]), "the picture's corner");
        assert_eq!(r.origin, c.eye);
        assert!(near(c.frame_vectors(1, 1).corner, [0.0, 0.0, -1.0]));
    }

    #[test]
    fn frame_vectors_survive_an_up_along_the_view() {
        let c = Camera { eye: [0.0, 1.0, 0.0], at: [0.0; 3], up: [0.0, 1.0, 0.0], fov: 60.0 };
        let r = c.frame_vectors(8, 8);
        assert!([r.corner, r.dx, r.dy].iter().flatten().all(|x| x.is_finite()));
        assert!(dot(wide(r.dx), wide(r.dy)).abs() < 1e-9 && r.dx != [0.0; 3]);
    }

    /// Every corner of the box projects into the picture, and one of them close to its edge.
    #[test]
    fn framing_fills_the_picture() {
        for (min, max) in [
            ([-1.0; 3], [1.0; 3]),
            ([5.0, 0.0, -3.0], [305.0, 126.0, 184.0]),
            ([0.0; 3], [1e-3, 50.0, 0.0]),
            ([1e6, 1e6, 1e6], [1.001e6, 1.001e6, 1.001e6]),
        ] {
            let bounds = Aabb { min, max };
            let c = Camera::framing(&bounds);
            c.validate().expect("a sound camera");
            let (forward, right) = (normalize(c.view()), c.side().expect("not along y"));
            let up = cross(right, forward);
            let seen = (0..8).map(|i| std::array::from_fn(|k| if i >> k & 1 == 0 { min[k] } else { max[k] }));
            let edge = seen.map(|p: [f32; 3]| {
                let v = sub(wide(p), wide(c.eye));
                dot(v, right).abs().max(dot(v, up).abs()) / dot(v, forward) / half_tan(c.fov)
            });
            let edge = edge.fold(0.0, f64::max);
            assert!((0.8..1.0).contains(&edge), "{bounds:?}: the box reaches to {edge} of the picture");
        }
    }

    #[test]
    fn framing_a_single_point() {
        for p in [[0.0; 3], [1e9, -1e9, 0.0]] {
            Camera::framing(&Aabb { min: p, max: p }).validate().expect("a sound camera");
        }
    }
}
