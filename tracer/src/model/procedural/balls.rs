//! SPD `balls`: the sphereflake.

use super::tessellate::Tessellator;
use super::{Builtin, glossy, matt, spd, spd_camera};
use crate::model::Model;
use crate::model::vec3::{Vec3, add, normalize, rotate, scale, sin_cos};

/// The sphereflake (Haines 1987): a sphere with nine smaller ones on it, each with nine on it, and so on `size` times,
/// over a floor: (9^(size + 1) - 1) / 8 spheres of 192 triangles each, and 2. Size 4: 1,417,154 triangles.
///
/// # Panics
/// When it would have more triangles than a tree holds ([`Builtin::triangles`] tells).
#[must_use]
pub fn balls(size: u32) -> Model {
    let mut t = Tessellator::new(Builtin::Balls.triangles(size).expect("size from 0 to 6"));
    let z = -0.5;
    t.rectangle([[12.0, 12.0, z], [-12.0, 12.0, z], [-12.0, -12.0, z], [12.0, -12.0, z]], 0);
    grow(&mut t, &directions(), [0.0; 3], 0.5, [0.0, 0.0, 1.0], size);
    let materials =
        vec![matt("floor", [1.0, 0.75, 0.33], 0.2, 0.8), glossy("balls", [1.0, 0.9, 0.7], [0.0, 0.5, 0.5], 37.0)];
    let lights = [[4.0, 3.0, 2.0], [1.0, -4.0, 4.0], [-3.0, 1.0, 5.0]];
    spd(Builtin::Balls, t, materials, &lights, spd_camera([2.1, 1.3, 1.7], [0.0; 3]))
}

/// The unit vectors from a sphere with axis +z to its nine children.
fn directions() -> [Vec3; 9] {
    let a = 0.5_f64.sqrt();
    let tilt_axis = [a, -a, 0.0];
    // asin(2 / sqrt 6)
    let tilt = ((2.0 / 3.0_f64).sqrt(), (1.0 / 3.0_f64).sqrt());
    let three = [[a, a, 0.0], [a, 0.0, -a], [0.0, a, -a]].map(|d| rotate(d, tilt_axis, tilt));
    std::array::from_fn(|i| rotate(three[i % 3], [0.0, 0.0, 1.0], sin_cos(120.0 * (i / 3) as f64)))
}

fn grow(t: &mut Tessellator, directions: &[Vec3; 9], center: Vec3, radius: f64, axis: Vec3, levels: u32) {
    t.sphere(center, radius, 1);
    if levels == 0 {
        return;
    }
    for &d in directions {
        let d = normalize(carry(d, axis));
        grow(t, directions, add(center, scale(d, radius * 4.0 / 3.0)), radius / 3.0, d, levels - 1);
    }
}

/// `d` under the smallest rotation that carries +z to `axis`; for -z, which many do, half a turn about y.
fn carry(d: Vec3, axis: Vec3) -> Vec3 {
    let [x, y, z] = axis;
    let sin = (x * x + y * y).sqrt();
    if sin > 1e-9 {
        rotate(d, [-y / sin, x / sin, 0.0], (sin, z))
    } else if z > 0.0 {
        d
    } else {
        [-d[0], d[1], -d[2]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::vec3::{dot, length, sub, wide};

    /// Centre and radius of each sphere, from its vertices.
    fn spheres(scene: &Model) -> Vec<(Vec3, f64)> {
        let of = |points: &[[f32; 3]]| {
            let center = scale(points.iter().fold([0.0; 3], |s, &p| add(s, wide(p))), 1.0 / points.len() as f64);
            (center, length(sub(wide(points[0]), center)))
        };
        scene.mesh.positions[4..].chunks(98).map(of).collect()
    }

    #[test]
    fn children_are_where_the_definition_has_them() {
        let s = spheres(&balls(1));
        assert_eq!(s.len(), 10);
        let a = 0.5_f64.sqrt();
        let expected = [
            [0.408_248, 0.408_248, 0.816_497],
            [0.965_926, 0.258_819, 0.0],
            [0.258_819, 0.965_926, 0.0],
            [-0.557_678, 0.149_429, 0.816_497],
            [-a, a, 0.0],
            [-0.965_926, -0.258_819, 0.0],
            [0.149_429, -0.557_678, 0.816_497],
            [-0.258_819, -0.965_926, 0.0],
            [a, -a, 0.0],
        ];
        for ((center, radius), d) in s[1..].iter().zip(expected) {
            assert!(length(sub(*center, scale(d, 2.0 / 3.0))) < 2e-6, "{center:?}, expected along {d:?}");
            assert!((radius - 0.5 / 3.0).abs() < 1e-6);
        }
        assert!(length(sub(s[1].0, [0.272_166, 0.272_166, 0.544_331])) < 1e-6);
    }

    /// Every sphere touches its parent, and none grows towards its grandparent.
    #[test]
    fn the_flake_touches_and_grows_outwards() {
        /// Checks the subtree at the head of the list and returns what comes after it.
        fn subtree(list: &[(Vec3, f64)], axis: Vec3, levels: u32) -> &[(Vec3, f64)] {
            let ((center, radius), mut rest) = (list[0], &list[1..]);
            for _ in 0..if levels > 0 { 9 } else { 0 } {
                let (child, child_radius) = rest[0];
                let d = sub(child, center);
                assert!((length(d) - radius - child_radius).abs() < 1e-6, "{child:?} touches {center:?}");
                assert!(dot(d, axis) > -1e-6, "{child:?} grows outwards");
                rest = subtree(rest, d, levels - 1);
            }
            rest
        }
        let s = spheres(&balls(3));
        assert_eq!(s.len(), 820);
        assert!(subtree(&s, [0.0, 0.0, 1.0], 3).is_empty());
    }
}
