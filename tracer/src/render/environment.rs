//! Light from all around, from a picture: an environment map.

use super::Image;
use super::shade::{word, words3};
use crate::Error;
use crate::geometry::Vec3;
use crate::hash::fnv1a;
use simd::{Float, Vector};
use std::f32::consts::TAU;
use std::f64::consts::PI;
use std::fmt;
use std::str::FromStr;

/// Which axis is up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Up {
    /// As most programs write their files. The middle of a map looks along -z then.
    #[default]
    Y,
    /// As in the built-in scenes. The middle of a map looks along y then.
    Z,
}

impl FromStr for Up {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match name {
            "y" => Ok(Self::Y),
            "z" => Ok(Self::Z),
            _ => Err(format!("unknown axis '{name}'; known: y, z")),
        }
    }
}

impl fmt::Display for Up {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Y => "y",
            Self::Z => "z",
        })
    }
}

/// An environment map: the light that comes from infinitely far away, by direction. Rows are latitudes, the uppermost of them looks up; columns are
/// longitudes that go to the right, all around. Pixels are linear radiance; in between it is interpolated.
///
/// As a light source its directions are chosen as densely as they are bright, by a density that is constant over each pixel (Pharr, Jakob and
/// Humphreys, "Physically Based Rendering", fourth edition, section 12.5).
#[derive(Debug, Clone)]
pub struct Environment {
    width: u32,
    height: u32,
    /// Three words for each pixel.
    radiance: Vec<f32>,
    /// To the right of the middle of the map, up, and towards its middle: unit vectors.
    axes: [[f32; 3]; 3],
    /// The chance that a row above number i is chosen, for i from 0 to `height`.
    rows: Vec<f32>,
    /// For each row, the chance that a column left of number i is chosen, for i from 0 to `width`.
    columns: Vec<f32>,
    /// Two words for each row: density per steradian over the chance of the column; the cosine of the angle to the upward axis at the row's upper
    /// edge. One row more than there are.
    bands: Vec<f32>,
    /// A fourth of the luminance of all directions together: what a surface gets of it, about.
    weight: f64,
    text: String,
}

impl Environment {
    /// Pixels at most, each way.
    pub const MAX_SIDE: usize = 16_384;
    /// Pixels at most.
    pub const MAX_PIXELS: usize = 1 << 27;

    /// From a picture of linear radiance, turned about the upward axis by so many degrees, counter-clockwise as seen from above.
    ///
    /// ```
    /// use tracer::render::{Environment, Image, Up};
    /// let grey = Image { width: 2, height: 1, pixels: vec![[0.5; 3]; 2] };
    /// assert!(Environment::new(&grey, Up::Y, 90.0).is_ok());
    /// ```
    ///
    /// # Errors
    /// [`Error::Geometry`] for a picture without pixels or with too many, with a pixel that is negative or no finite number, or an angle that is none.
    pub fn new(image: &Image, up: Up, degrees: f32) -> Result<Self, Error> {
        let Image { width, height, ref pixels } = *image;
        let side = 1..=Self::MAX_SIDE;
        if !side.contains(&width) || !side.contains(&height) || width * height > Self::MAX_PIXELS {
            let (most, all) = (Self::MAX_SIDE, Self::MAX_PIXELS);
            return Err(Error::Geometry(format!(
                "a map of {width}x{height} pixels: up to {most} each way and {all} together are possible, scale it down"
            )));
        }
        if !degrees.is_finite() {
            return Err(Error::Geometry(format!("a map turned by {degrees} degrees: give a finite number")));
        }
        if pixels.len() != width * height {
            return Err(Error::Geometry(format!("{} pixels for a map of {width}x{height}", pixels.len())));
        }
        if let Some(i) = pixels.iter().position(|p| !p.iter().all(|c| c.is_finite() && *c >= 0.0)) {
            let ([r, g, b], x, y) = (pixels[i], i % width, i / width);
            return Err(Error::Geometry(format!(
                "pixel {x},{y} is ({r}, {g}, {b}): light is a finite number that is not negative, correct the map"
            )));
        }
        let edge = |row: usize| libm::cos(PI * row as f64 / height as f64);
        let (mut rows, mut columns) = (vec![0.0], Vec::with_capacity((width + 1) * height));
        for row in 0..height {
            let weights = smooth(image, row);
            let sum: f64 = weights.iter().sum();
            rows.push(sum * (edge(row) - edge(row + 1)));
            columns.extend(chances(&weights, sum));
        }
        let total: f64 = rows.iter().sum();
        let rows = chances(&rows[1..], total);
        let bands = (0..=height).flat_map(|row| {
            let chance = rows.get(row + 1).map_or(0.0, |next| f64::from(next - rows[row]));
            let density = chance * width as f64 / (2.0 * PI * (edge(row) - edge(row + 1)));
            [if total > 0.0 { density as f32 } else { 0.0 }, edge(row) as f32]
        });
        let radiance: Vec<f32> = pixels.iter().flatten().copied().collect();
        let text = format!(
            "map {:016x} of {width}x{height} pixels, {up} up, turned by {degrees} degrees",
            fnv1a(radiance.iter().map(|c| c.to_bits()))
        );
        Ok(Self {
            width: width as u32,
            height: height as u32,
            axes: axes(up, degrees),
            bands: bands.collect(),
            rows,
            columns,
            weight: total * 2.0 * PI / width as f64 / 4.0,
            radiance,
            text,
        })
    }

    /// A fourth of the luminance of all directions together; zero for a black map, of which no direction can be chosen.
    pub(super) fn weight(&self) -> f64 {
        self.weight
    }

    /// What tells it from others.
    pub(super) fn text(&self) -> &str {
        &self.text
    }

    /// What comes from a direction (of any length), and how densely [`Environment::sample`] chooses it, per steradian.
    #[inline(always)]
    pub(super) fn seen<F: Float>(&self, direction: Vec3<F>, mask: F::Mask) -> (Vec3<F>, F) {
        let [right, up, forward] = self.axes;
        let x = direction.dot(Vec3::splat(right));
        let y = direction.dot(Vec3::splat(up));
        let z = direction.dot(Vec3::splat(forward));
        let (width, height) = (F::splat(self.width as f32), F::splat(self.height as f32));
        let across = (simd::math::atan2(x, z) * F::splat(1.0 / TAU) + F::splat(0.5)) * width;
        let down = simd::math::atan2((x * x + z * z).sqrt(), y) * F::splat(2.0 / TAU) * height;

        // Between the middles of four pixels; all around, but not over the poles.
        let (half, zero, one) = (F::splat(0.5), F::splat(0.0), F::splat(1.0));
        let (most, rows) = (F::Index::splat(self.width - 1), F::Index::splat(self.height - 1));
        let left = (across - half).floor();
        let fraction = across - half - left;
        let left = F::select(left.lt(zero), left + width, left).to_uint().min(most);
        let right = F::Index::select(left.lt(most), left + F::Index::splat(1), F::Index::splat(0));
        let row = (down - half).max(zero);
        let above = row.floor().to_uint().min(rows);
        let below = (above + F::Index::splat(1)).min(rows);
        let upper = self.between(above, left, right, fraction, mask);
        let lower = self.between(below, left, right, fraction, mask);
        let radiance = mix(upper, lower, (row - row.floor()).min(one));

        let (row, column) = (down.to_uint().min(rows), across.to_uint().min(most));
        (radiance, self.density(row, column, mask))
    }

    #[inline(always)]
    fn between<F: Float>(&self, row: F::Index, left: F::Index, right: F::Index, fraction: F, mask: F::Mask) -> Vec3<F> {
        let first = row * F::Index::splat(self.width);
        let a = words3::<F>(&self.radiance, first + left, 3, 0, mask);
        mix(a, words3(&self.radiance, first + right, 3, 0, mask), fraction)
    }

    #[inline(always)]
    fn density<F: Float>(&self, row: F::Index, column: F::Index, mask: F::Mask) -> F {
        let at = row * F::Index::splat(self.width + 1) + column;
        let [before, after]: [F; 2] = [word(&self.columns, at, 1, 0, mask), word(&self.columns, at, 1, 1, mask)];
        (after - before) * word::<F>(&self.bands, row, 2, 0, mask)
    }

    /// A direction, chosen by a point of the unit square: a unit vector, and how densely it is chosen, per steradian. The map must not be black.
    #[inline(always)]
    pub(super) fn sample<F: Float>(&self, point: [F; 2], mask: F::Mask) -> (Vec3<F>, F) {
        let (row, below) = choose::<F>(&self.rows, F::Index::splat(0), self.height, point[1], mask);
        let first = row * F::Index::splat(self.width + 1);
        let (column, along) = choose::<F>(&self.columns, first, self.width, point[0], mask);

        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let (top, bottom): (F, F) = (word(&self.bands, row, 2, 1, mask), word(&self.bands, row, 2, 3, mask));
        let y = top + (bottom - top) * below;
        let radius = ((one - y) * (one + y)).max(zero).sqrt();
        let turn = (F::from_uint(column) + along) * F::splat(1.0 / self.width as f32) - F::splat(0.5);
        let (sin, cos) = simd::math::sin_cos(turn * F::splat(TAU));
        let [right, up, forward] = self.axes;
        let direction = Vec3::<F>::splat(right).scale(sin * radius)
            + Vec3::splat(up).scale(y)
            + Vec3::splat(forward).scale(cos * radius);
        (direction, self.density(row, column, mask))
    }
}

#[inline(always)]
fn mix<F: Float>(a: Vec3<F>, b: Vec3<F>, fraction: F) -> Vec3<F> {
    a + (b + a.scale(F::splat(-1.0))).scale(fraction)
}

/// The last of `n` intervals whose start is not above `x`, and how far `x` is in it: by halving. Starts are in the table from `first` on.
#[inline(always)]
fn choose<F: Float>(starts: &[f32], first: F::Index, n: u32, x: F, mask: F::Mask) -> (F::Index, F) {
    let mut found = F::Index::splat(0);
    let mut step = n.next_power_of_two();
    while step > 1 {
        step /= 2;
        let next = found + F::Index::splat(step);
        let there = mask & next.lt(F::Index::splat(n));
        let start = F::gather_masked(starts, first + next, there, F::splat(f32::INFINITY));
        found = F::Index::select(start.le(x), next, found);
    }
    let at = first + found;
    let (start, end): (F, F) = (word(starts, at, 1, 0, mask), word(starts, at, 1, 1, mask));
    let fraction = (x - start) / (end - start);
    (found, fraction.max(F::splat(0.0)).min(F::splat(1.0)))
}

/// To the right, up and forward: of the map as it lies in the scene.
fn axes(up: Up, degrees: f32) -> [[f32; 3]; 3] {
    let angle = f64::from(degrees % 360.0).to_radians();
    let (sin, cos) = (libm::sin(angle) as f32, libm::cos(angle) as f32);
    match up {
        Up::Y => [[cos, 0.0, -sin], [0.0, 1.0, 0.0], [-sin, 0.0, -cos]],
        Up::Z => [[cos, sin, 0.0], [0.0, 0.0, 1.0], [-sin, cos, 0.0]],
    }
}

/// Sums of the first weights over that of all, from 0 to 1; even where there is no weight.
fn chances(weights: &[f64], total: f64) -> Vec<f32> {
    let mut sum = 0.0;
    let mut chances = vec![0.0];
    for (i, weight) in weights.iter().enumerate() {
        sum += weight;
        chances.push(if total > 0.0 { sum / total } else { (i + 1) as f64 / weights.len() as f64 } as f32);
    }
    if let Some(last) = chances.last_mut() {
        *last = 1.0;
    }
    chances
}

/// The mean of the interpolated luminance over each pixel of a row: an eighth of it is its neighbour's on each side, so that it is zero only where nothing
/// comes from.
fn smooth(image: &Image, row: usize) -> Vec<f64> {
    let Image { width, height, ref pixels } = *image;
    let luminance = |[r, g, b]: [f32; 3]| 0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b);
    let down = |x: usize| {
        let at = |y: usize| luminance(pixels[y * width + x]);
        (at(row.saturating_sub(1)) + 6.0 * at(row) + at((row + 1).min(height - 1))) / 8.0
    };
    let column: Vec<f64> = (0..width).map(down).collect();
    let across = |x: usize| (column[(x + width - 1) % width] + 6.0 * column[x] + column[(x + 1) % width]) / 8.0;
    (0..width).map(across).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(width: usize, height: usize, light: impl Fn(usize, usize) -> f32) -> Image {
        let pixels = (0..width * height).map(|i| [light(i % width, i / width); 3]).collect();
        Image { width, height, pixels }
    }

    fn seen(map: &Environment, [x, y, z]: [f32; 3]) -> f32 {
        map.seen::<f32>(Vec3 { x, y, z }, true).0.x
    }

    /// The middle of the map is in front, its right half to the right, its uppermost row up, and it turns to the left.
    #[test]
    fn directions() {
        let map = image(64, 32, |x, y| (100 * x + y) as f32);
        let pixel = |x: f32, y: f32| 100.0 * x + y;
        for (up, degrees, front, right, top) in [
            (Up::Y, 0.0, [0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
            (Up::Z, 0.0, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
            (Up::Y, 90.0, [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]),
            (Up::Z, -270.0, [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
        ] {
            let map = Environment::new(&map, up, degrees).expect("sound");
            let close = |direction, expected: f32| {
                let light = seen(&map, direction);
                assert!((light - expected).abs() < 0.01, "{up} {degrees} {direction:?}: {light}, not {expected}");
            };
            close(front, pixel(31.5, 15.5));
            close(right.map(|c| 7.0 * c), pixel(47.5, 15.5));
            close([0, 1, 2].map(|k| front[k] + top[k]), pixel(31.5, 7.5));
            close(top, pixel(31.5, 0.0));
            // Across the seam, between the last column and the first.
            let seam = seen(&map, [0, 1, 2].map(|k| -front[k]));
            assert!((seam - pixel(31.5, 15.5)).abs() < 1.0, "{up} {degrees}: {seam}");
        }
    }

    /// Directions are chosen as often as the density says, which is about the luminance; its integral is 1.
    #[test]
    fn chosen_by_brightness() {
        let light = |sun: f32| {
            move |x: usize, y: usize| if (x, y) == (3, 2) { sun } else { 0.2 + ((x * 7 + y * 3) % 5) as f32 }
        };
        for (width, height) in [(16, 8), (13, 7), (1, 1), (1, 5), (5, 1)] {
            let map = Environment::new(&image(width, height, light(50.0)), Up::Z, 30.0).expect("sound");
            let n = 200;
            let (mut solid_angle, mut flux) = (0.0, 0.0);
            for i in 0..n * n {
                let point = [(i % n) as f32 + 0.5, (i / n) as f32 + 0.5].map(|c| c / n as f32);
                let (direction, density) = map.sample::<f32>(point, true);
                assert!((direction.dot(direction) - 1.0).abs() < 1e-5);
                let (radiance, again) = map.seen::<f32>(direction, true);
                assert!(density > 0.0 && radiance.x > 0.0);
                // At the edges of pixels rounding may tell another one.
                if again == density {
                    solid_angle += 1.0 / f64::from(density);
                }
                flux += f64::from(radiance.x / density);
            }
            let count = f64::from(n * n);
            // Pixels that are brighter have fewer steradians for each point.
            assert!((solid_angle / count - 4.0 * PI).abs() < 1.0, "{width}x{height}: {}", solid_angle / count);
            let flux = flux / count;
            assert!((flux / (4.0 * map.weight()) - 1.0).abs() < 0.1, "{flux}, not {}", 4.0 * map.weight());
        }
        let sun = Environment::new(&image(16, 8, light(5000.0)), Up::Y, 0.0).expect("sound");
        let bright = |i: u32| {
            let point = [(i % 50) as f32 / 50.0, (i / 50) as f32 / 50.0];
            sun.seen::<f32>(sun.sample::<f32>(point, true).0, true).0.x > 50.0
        };
        // The outer halves of its neighbours, an eighth each way, are chosen with it but are dark.
        let count = (0..2500).filter(|&i| bright(i)).count();
        assert!(count > 1700, "{count}");
    }

    #[test]
    fn one_light_from_everywhere() {
        let map = Environment::new(&image(8, 4, |_, _| 0.3), Up::Y, 10.0).expect("sound");
        assert!((map.weight() - PI * 0.3).abs() < 1e-6);
        for direction in [[1.0, 2.0, 3.0], [-1.0, 0.0, 1e-9], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [0.0; 3]] {
            assert_eq!(seen(&map, direction), 0.3);
        }
        let (_, density) = map.seen::<f32>(Vec3 { x: 0.3, y: 0.2, z: 0.1 }, true);
        assert!((f64::from(density) - 0.25 / PI).abs() < 1e-6);
        assert!(seen(&map, [f32::NAN; 3]).is_nan());
    }

    #[test]
    fn what_is_no_light_is_refused() {
        let fails = |image: &Image, degrees, reason: &str| {
            let e = Environment::new(image, Up::Y, degrees).expect_err(reason).to_string();
            assert!(e.contains(reason), "{e}");
        };
        for bad in [f32::NAN, f32::INFINITY, -0.5] {
            fails(&image(5, 3, |x, y| if (x, y) == (4, 1) { bad } else { 1.0 }), 0.0, "pixel 4,1 is");
        }
        fails(&image(0, 0, |_, _| 1.0), 0.0, "0x0 pixels");
        fails(&Image { width: 3, height: 1, pixels: vec![] }, 0.0, "0 pixels for a map of 3x1");
        fails(&Image { width: 1 << 15, height: 1, pixels: vec![] }, 0.0, "32768x1 pixels");
        fails(&Image { width: 1 << 14, height: 1 << 14, pixels: vec![] }, 0.0, "scale it down");
        fails(&image(1, 1, |_, _| 1.0), f32::NAN, "NaN degrees");
        let black = Environment::new(&image(4, 2, |_, _| 0.0), Up::Y, 0.0).expect("dark");
        assert_eq!((black.weight(), seen(&black, [1.0; 3])), (0.0, 0.0));
    }
}
