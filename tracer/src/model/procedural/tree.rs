//! SPD `tree`: a tree that forks in two.

use super::tessellate::Tessellator;
use super::{Builtin, matt, spd, spd_camera};
use crate::model::Model;
use crate::model::vec3::{Vec3, add, rotate, scale, sin_cos};

/// Radius of the trunk at the ground.
const TRUNK: f64 = 0.15;
/// What is left of the radius at the end of a branch.
const TAPER: f64 = 0.67;
/// Of the two branches at a fork: angles of the turns about x and then z, scale of the length.
const FORK: [(f64, f64, f64); 2] = [(40.0, 90.0, 0.65), (25.0, 230.0, 0.70)];

/// A tree on a field (Haines 1987) that forks `size` times: 2^(size + 1) - 1 branches, each a cone of 16 triangles and a
/// sphere of 192 at its tip, and 2 triangles. Size 12: 1,703,730 triangles.
///
/// # Panics
/// When it would have more triangles than a tree holds ([`Builtin::triangles`] tells).
#[must_use]
pub fn tree(size: u32) -> Model {
    let mut t = Tessellator::new(Builtin::Tree.triangles(size).expect("size from 0 to 19"));
    t.rectangle([[50.0, 50.0, 0.0], [-50.0, 50.0, 0.0], [-50.0, -50.0, 0.0], [50.0, -50.0, 0.0]], 0);
    let root = Frame { origin: [0.0; 3], axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] };
    branch(&mut t, &root, TRUNK, size);
    let materials = vec![matt("field", [0.2, 0.7, 0.2], 0.0, 1.0), matt("bark", [0.55, 0.4, 0.2], 0.0, 1.0)];
    let lights = [
        [-5.0, 5.0, 50.0],
        [30.0, -30.0, 30.0],
        [-40.0, -30.0, 20.0],
        [10.0, 30.0, 40.0],
        [-30.0, 40.0, 10.0],
        [50.0, 25.0, 20.0],
        [-10.0, -60.0, 30.0],
    ];
    spd(Builtin::Tree, t, materials, &lights, spd_camera([4.5, 0.4, 2.0], [0.0, 0.0, 1.5]))
}

/// Where a branch stands: images of the local origin and of the three unit vectors.
struct Frame {
    origin: Vec3,
    axes: [Vec3; 3],
}

impl Frame {
    fn vector(&self, v: Vec3) -> Vec3 {
        add(add(scale(self.axes[0], v[0]), scale(self.axes[1], v[1])), scale(self.axes[2], v[2]))
    }

    fn tip(&self) -> Vec3 {
        add(self.origin, self.axes[2])
    }

    /// The frame of a child: turned about x, then about z, shrunk, and moved to the tip; all in this frame.
    fn child(&self, (about_x, about_z, shrink): (f64, f64, f64)) -> Self {
        let turned = |v| rotate(rotate(v, [1.0, 0.0, 0.0], sin_cos(about_x)), [0.0, 0.0, 1.0], sin_cos(about_z));
        let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        Self { origin: self.tip(), axes: unit.map(|v| self.vector(scale(turned(v), shrink))) }
    }
}

fn branch(t: &mut Tessellator, frame: &Frame, radius: f64, forks: u32) {
    let tip = frame.tip();
    t.cone([frame.origin, tip], [radius, radius * TAPER], 1);
    t.sphere(tip, radius * TAPER, 1);
    if forks > 0 {
        for fork in FORK {
            branch(t, &frame.child(fork), radius * TAPER, forks - 1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::vec3::{length, sub, wide};

    /// The first fork, worked out by hand: z turned by 40 degrees about x is (0, -sin 40, cos 40), and by 90 degrees about
    /// z then (sin 40, 0, cos 40).
    #[test]
    fn the_first_fork() {
        let scene = tree(1);
        let branches: Vec<_> = scene.mesh.positions[4..].chunks(16 + 98).collect();
        assert_eq!(branches.len(), 3);
        let center = |points: &[[f32; 3]]| {
            scale(points.iter().fold([0.0; 3], |s, &p| add(s, wide(p))), 1.0 / points.len() as f64)
        };
        let tips = [
            [0.0, 0.0, 1.0],
            [0.65 * 0.642_787_6, 0.0, 1.0 + 0.65 * 0.766_044_4],
            // z turned by 25 about x: (0, -.4226, .9063); by 230 about z: -(-.4226) sin 230 = -.3237, -.4226 cos 230 = .2717
            [0.7 * -0.323_744_4, 0.7 * 0.271_653_8, 1.0 + 0.7 * 0.906_307_8],
        ];
        for (b, tip) in branches.iter().zip(tips) {
            assert!(length(sub(center(&b[16..]), tip)) < 1e-6, "{:?} {tip:?}", center(&b[16..]));
        }
        let radius = |b: &[[f32; 3]]| length(sub(wide(b[16]), center(&b[16..])));
        assert!((radius(branches[0]) - 0.15 * 0.67).abs() < 1e-6);
        assert!((radius(branches[1]) - 0.15 * 0.67 * 0.67).abs() < 1e-6);
    }
}
