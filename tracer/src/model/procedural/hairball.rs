//! A ball of curly hair: thin, entangled geometry, hard for boxes.

use super::tessellate::next;
use super::{Builtin, glossy};
use crate::model::vec3::{Vec3, add, cross, dot, narrow, normalize, perpendicular, scale, sin_cos, sub};
use crate::model::{Camera, Light, Mesh, Model};

/// Segments of a strand.
const SEGMENTS: u32 = 80;
/// Sides of a strand.
const SIDES: u32 = 3;
/// Triangles of a strand.
pub(super) const STRAND_TRIANGLES: u64 = 2 * (SEGMENTS * SIDES) as u64;
/// Radius of the ball that the strands grow from.
const BALL: f64 = 1.0;
/// Length of a segment.
const STEP: f64 = 0.07;
/// Radius of a strand at its root; it ends at a fifth of it.
const THICKNESS: f64 = 0.012;

/// `size` curly strands on a ball, three-sided tubes of 80 segments: 480 triangles each, 2,880,000 at size 6000. A stand-in for
/// Laine's Hairball, made from a fixed seed: a strand is the same in every size that has it.
///
/// # Panics
/// When it would have no strands, or more triangles than a tree holds ([`Builtin::triangles`] tells).
#[must_use]
pub fn hairball(size: u32) -> Model {
    let triangles = Builtin::Hairball.triangles(size).expect("size from 1 to 559240");
    let mut mesh = Mesh { triangles: Vec::with_capacity(triangles), ..Mesh::default() };
    let vertices = size as usize * ((SEGMENTS + 1) * SIDES) as usize;
    mesh.positions.reserve_exact(vertices);
    mesh.normals.reserve_exact(vertices);
    for strand in 0..size {
        grow(&mut mesh, &mut SplitMix64(u64::from(strand) << 32));
    }
    mesh.normal_indices.clone_from(&mesh.triangles);
    let intensity = [0.5_f32.sqrt(); 3];
    Model {
        name: Builtin::Hairball.name().into(),
        mesh,
        materials: vec![glossy("hair", [0.62, 0.40, 0.22], [0.1, 0.9, 0.3], 20.0)],
        lights: [[6.0, 9.0, 8.0], [-9.0, 3.0, 6.0]].map(|position| Light { position, intensity }).into(),
        camera: Some(Camera { eye: [0.0, 0.0, 7.0], at: [0.0; 3], up: [0.0, 1.0, 0.0], fov: 90.0 }),
        ambient: 1.0,
        background: Model::SKY,
    }
}

/// Adds one strand: it grows outwards along a path that wanders at random, and winds around that path.
fn grow(mesh: &mut Mesh, random: &mut SplitMix64) {
    let root = random.direction();
    let mut heading = root;
    let mut center = scale(root, BALL);
    let mut u = perpendicular(root);
    let mut side = u;
    let (curl, turn) = (random.between(0.6, 1.4), random.between(18.0, 40.0));
    let start = random.between(0.0, 360.0);
    let first = next(&mesh.positions);
    for i in 0..=SEGMENTS {
        heading = normalize(add(add(heading, scale(random.direction(), 0.12)), scale(root, 0.02)));
        // Both frames, of the winding and of the ring, follow the path without twist.
        u = normalize(sub(u, scale(heading, dot(u, heading))));
        let (sin, cos) = sin_cos(start + turn * f64::from(i));
        let winding = add(scale(u, cos), scale(cross(heading, u), sin));
        let along = normalize(add(heading, scale(winding, curl)));
        side = normalize(sub(side, scale(along, dot(side, along))));
        let across = cross(along, side);
        let radius = THICKNESS * (1.0 - 0.8 * f64::from(i) / f64::from(SEGMENTS));
        for k in 0..SIDES {
            let (sin, cos) = sin_cos(120.0 * f64::from(k));
            let normal = add(scale(side, cos), scale(across, sin));
            mesh.positions.push(narrow(add(center, scale(normal, radius))));
            mesh.normals.push(narrow(normal));
        }
        center = add(center, scale(along, STEP));
    }
    for i in 0..SEGMENTS {
        for k in 0..SIDES {
            let lower = first + i * SIDES;
            let [a, b] = [lower + k, lower + (k + 1) % SIDES];
            mesh.triangles.extend([[a, b, b + SIDES], [a, b + SIDES, a + SIDES]]);
        }
    }
}

/// Steele, Lea & Flood, "Fast Splittable Pseudorandom Number Generators", 2014.
struct SplitMix64(u64);

impl SplitMix64 {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        let unit = (self.next() >> 11) as f64 / (1_u64 << 53) as f64;
        low + (high - low) * unit
    }

    /// A unit vector, uniform over the sphere.
    fn direction(&mut self) -> Vec3 {
        let z = self.between(-1.0, 1.0);
        let (sin, cos) = sin_cos(self.between(0.0, 360.0));
        let r = (1.0 - z * z).sqrt();
        [r * cos, r * sin, z]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::vec3::{length, wide};

    /// The reference output of the generator for seed 1234567.
    #[test]
    fn the_generator_is_splitmix64() {
        let mut r = SplitMix64(1_234_567);
        assert_eq!([r.next(), r.next()], [6_457_827_717_110_365_317, 3_203_168_211_198_807_973]);
    }

    #[test]
    fn strands_leave_the_ball_and_stay_the_same() {
        let (small, large) = (hairball(20), hairball(40));
        assert_eq!(large.mesh.positions[..small.mesh.positions.len()], small.mesh.positions);
        let rings = ((SEGMENTS + 1) * SIDES) as usize;
        for strand in large.mesh.positions.chunks(rings) {
            let distance = |p: &[f32; 3]| length(wide(*p));
            assert!((distance(&strand[0]) - BALL).abs() <= THICKNESS);
            assert!(distance(&strand[rings - 1]) > 1.5 * BALL, "a strand grows outwards");
            for p in strand {
                assert!(distance(p) < 6.5, "the view holds all of it");
            }
        }
    }
}
