//! SPD `rings`: pyramids of dodecahedral rings.

use super::tessellate::Tessellator;
use super::{Builtin, glossy, matt, spd, spd_camera};
use crate::model::Model;
use crate::model::vec3::{Vec3, add, narrow, rotate, scale, sin_cos};

const X: Vec3 = [1.0, 0.0, 0.0];
const Z: Vec3 = [0.0, 0.0, 1.0];
/// Radius of the balls and rods.
const RADIUS: f64 = 0.07412;

/// Interlocking rings (Haines 1987): objects of six pentagons made of rods and balls, one in the first layer, four in the
/// second and so on for `size` layers, before a wall: 5 size (size + 1) (2 size + 1) balls of 192 and rods of 16 triangles, and 2.
/// Size 7: 873,602 triangles.
///
/// # Panics
/// When it would have no objects, or more triangles than a tree holds ([`Builtin::triangles`] tells).
#[must_use]
pub fn rings(size: u32) -> Model {
    let mut t = Tessellator::new(Builtin::Rings.triangles(size).expect("size from 1 to 50"));
    let (sin, cos) = sin_cos(22.5);
    let spacing = 1.0 / sin;
    let wall = spacing * f64::from(size + 1);
    let half = 1.01 * (wall + spacing) * sin / cos;
    // The wall's front looks to the eye, to -y.
    let corner = |x: f64, z: f64| narrow([-1.0 + x * half, wall, 0.5 + z * half]);
    t.rectangle([corner(1.0, 1.0), corner(-1.0, 1.0), corner(-1.0, -1.0), corner(1.0, -1.0)], 0);
    let pentagons = pentagons();
    for d in 0..size {
        for (i, j) in (0..=d).flat_map(|i| (0..=d).map(move |j| (i, j))) {
            let [i, j, d] = [i, j, d].map(f64::from);
            object(&mut t, &pentagons, [2.0 * i - d, spacing * (d + 1.0), 2.0 * j - d]);
        }
    }
    let colors = [
        ("red", [1.0, 0.0, 0.0]),
        ("green", [0.0, 1.0, 0.0]),
        ("blue", [0.0, 0.0, 1.0]),
        ("cyan", [0.0, 1.0, 1.0]),
        ("magenta", [1.0, 0.0, 1.0]),
        ("yellow", [1.0, 1.0, 0.0]),
    ];
    let mut materials = vec![matt("wall", [1.0; 3], 0.0, 1.0)];
    materials.extend(colors.map(|(name, color)| glossy(name, color, [0.0, 0.5, 0.3], 37.0)));
    let s = spacing as f32;
    let lights = [[3.0, -s, 3.0], [-4.0, -s, 1.0], [2.0, -s, -4.0]];
    spd(Builtin::Rings, t, materials, &lights, spd_camera([-1.0, -s, 0.5], [-1.0, 1.0 - s, 0.5]))
}

/// The corners of the six pentagons of an object around the origin.
fn pentagons() -> [[Vec3; 5]; 6] {
    let flat: [Vec3; 5] = std::array::from_fn(|k| rotate(scale(X, 1.0 / (1.0 + RADIUS)), Z, sin_cos(72.0 * k as f64)));
    std::array::from_fn(|p| match p {
        0 => flat,
        _ => flat.map(|v| rotate(rotate(v, X, sin_cos(63.434_949)), Z, sin_cos(72.0 * p as f64 - 36.0))),
    })
}

fn object(t: &mut Tessellator, pentagons: &[[Vec3; 5]; 6], at: Vec3) {
    for (material, corners) in (1..).zip(pentagons) {
        for k in 0..5 {
            let [corner, previous] = [corners[k], corners[(k + 4) % 5]].map(|v| add(v, at));
            t.sphere(corner, RADIUS, material);
            t.cone([previous, corner], [RADIUS; 2], material);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::vec3::{cross, dot, length, normalize, sub};

    /// The six pentagons lie in planes whose normals are those of a dodecahedron: any two at the same angle.
    #[test]
    fn pentagons_of_a_dodecahedron() {
        let normals = pentagons().map(|p| normalize(cross(sub(p[1], p[0]), sub(p[2], p[0]))));
        for (i, a) in normals.iter().enumerate() {
            for b in &normals[..i] {
                assert!((dot(*a, *b).abs() - 0.2_f64.sqrt()).abs() < 1e-6, "{a:?} {b:?}");
            }
        }
        for corner in pentagons().as_flattened() {
            assert!((length(*corner) - 1.0 / (1.0 + RADIUS)).abs() < 1e-12);
        }
    }

    /// Layers stand behind each other up to the wall, which closes the view.
    #[test]
    fn layers_and_wall() {
        let scene = rings(2);
        let spacing = 2.613_126;
        let bounds = scene.mesh.bounds();
        assert!((bounds.max[1] - 3.0 * spacing).abs() < 1e-5, "{bounds:?}");
        assert!((bounds.min[1] - (spacing - 1.0)).abs() < 0.1, "{bounds:?}");
        let objects = &scene.mesh.positions[4..];
        let per_object = 30 * (98 + 16);
        assert_eq!(objects.len(), 5 * per_object);
        let centers = objects.chunks(per_object).map(|o| crate::geometry::Aabb::of_points(o.iter().copied()).center());
        let expected = [(0, 1, 0), (-1, 2, -1), (-1, 2, 1), (1, 2, -1), (1, 2, 1)];
        for (c, (x, layer, z)) in centers.zip(expected) {
            let e = [x as f32, spacing * layer as f32, z as f32];
            assert!((0..3).all(|k| (c[k] - e[k]).abs() < 0.1), "{c:?} {e:?}");
        }
    }
}
