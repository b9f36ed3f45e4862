//! Scenes made by rule: three of the standard procedural databases (Haines, "A Proposal for Standard Graphics Environments",
//! IEEE CG&A, November 1987), tessellated as in Geimer & Müller 2003, and a ball of hair.

mod balls;
mod hairball;
mod rings;
mod tessellate;
mod tree;

pub use balls::balls;
pub use hairball::hairball;
pub use rings::rings;
pub use tree::tree;

use super::{Camera, Light, Material, Model, Reflection};
use crate::Error;
use crate::bvh::Node;
use tessellate::{CONE_TRIANGLES, SPHERE_TRIANGLES, Tessellator};

/// The scenes that need no file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Builtin {
    /// [`balls`]
    Balls,
    /// [`rings`]
    Rings,
    /// [`tree`]
    Tree,
    /// [`hairball`]
    Hairball,
}

impl Builtin {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Balls, Self::Rings, Self::Tree, Self::Hairball];

    /// Its name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Balls => "balls",
            Self::Rings => "rings",
            Self::Tree => "tree",
            Self::Hairball => "hairball",
        }
    }

    /// The size that the papers use.
    #[must_use]
    pub fn default_size(self) -> u32 {
        match self {
            Self::Balls => 4,
            Self::Rings => 7,
            Self::Tree => 12,
            Self::Hairball => 6000,
        }
    }

    /// Number of triangles at a size; none when the size is below the least or the triangles are more than a tree
    /// holds ([`Node::MAX_TRIANGLES`]).
    #[must_use]
    pub fn triangles(self, size: u32) -> Option<usize> {
        const BALL_AND_STICK: u64 = SPHERE_TRIANGLES + CONE_TRIANGLES;
        let n = u64::from(size);
        let count = match self {
            Self::Balls => 9_u64.checked_pow(size.checked_add(1)?)?.checked_sub(1)? / 8,
            // 5 n (n + 1) (2 n + 1): a product that overflows is too large anyway.
            Self::Rings => (5 * n).checked_mul(n + 1)?.checked_mul(2 * n + 1)?,
            Self::Tree => 2_u64.checked_pow(size.checked_add(1)?)?.checked_sub(1)?,
            Self::Hairball => n,
        };
        let (each, others) = match self {
            Self::Balls => (SPHERE_TRIANGLES, 2),
            Self::Rings | Self::Tree => (BALL_AND_STICK, 2),
            Self::Hairball => (hairball::STRAND_TRIANGLES, 0),
        };
        let triangles = usize::try_from(count.checked_mul(each)?.checked_add(others)?).ok()?;
        (count > 0 && triangles <= Node::MAX_TRIANGLES).then_some(triangles)
    }

    /// Makes the scene.
    ///
    /// # Errors
    /// [`Error::Usage`] when [`Builtin::triangles`] has no number for this size.
    pub fn scene(self, size: u32) -> Result<Model, Error> {
        if self.triangles(size).is_none() {
            return self.wrong_size(&size.to_string());
        }
        Ok(match self {
            Self::Balls => balls(size),
            Self::Rings => rings(size),
            Self::Tree => tree(size),
            Self::Hairball => hairball(size),
        })
    }

    fn wrong_size<T>(self, size: &str) -> Result<T, Error> {
        let name = self.name();
        // Counts grow with the size, and the least size is 0 or 1.
        let possible = |s: &u32| self.triangles(*s).is_some();
        let least = if possible(&0) { 0 } else { 1 };
        let (mut most, mut too_much) = (least, u32::MAX);
        while too_much - most > 1 {
            let middle = most + (too_much - most) / 2;
            *(if possible(&middle) { &mut most } else { &mut too_much }) = middle;
        }
        Err(Error::Usage(format!(
            "{name}:{size}: the size must be a whole number from {least} to {most}, for example {name}:{}",
            self.default_size()
        )))
    }
}

/// The built-in scene that `spec` names: `balls`, `rings`, `tree` or `hairball`, with `:size` after it or of
/// [`Builtin::default_size`]. None when it names none.
#[must_use]
pub fn builtin(spec: &str) -> Option<Result<Model, Error>> {
    let (name, size) = spec.split_once(':').map_or((spec, None), |(n, s)| (n, Some(s)));
    let which = Builtin::ALL.into_iter().find(|b| b.name() == name)?;
    Some(match size.map(|s| (s, s.parse())) {
        None => which.scene(which.default_size()),
        Some((_, Ok(size))) => which.scene(size),
        Some((text, Err(_))) => which.wrong_size(text),
    })
}

/// A scene with the customs of the SPD: its sky, lights of equal intensity 1 / sqrt(number of lights).
fn spd(which: Builtin, made: Tessellator, materials: Vec<Material>, lights: &[[f32; 3]], camera: Camera) -> Model {
    let intensity = 1.0 / (lights.len() as f32).sqrt();
    Model {
        name: which.name().into(),
        mesh: made.mesh,
        materials,
        lights: lights.iter().map(|&position| Light { position, intensity: [intensity; 3] }).collect(),
        camera: Some(camera),
        ambient: 1.0,
        background: Model::SKY,
    }
}

/// A view of the SPD: z upwards, 45 degrees.
fn spd_camera(eye: [f32; 3], at: [f32; 3]) -> Camera {
    Camera { eye, at, up: [0.0, 0.0, 1.0], fov: 45.0 }
}

/// A matt surface.
fn matt(name: &str, color: [f32; 3], ambient: f32, diffuse: f32) -> Material {
    glossy(name, color, [ambient, diffuse, 0.0], 60.0)
}

/// A surface in the terms of the SPD: the colour's share in ambient and diffuse light, the strength of a white highlight
/// and the angle in degrees at which the highlight falls to half. (Mirroring is not part of the Phong model here.)
fn glossy(name: &str, color: [f32; 3], [ambient, diffuse, highlight]: [f32; 3], angle: f64) -> Material {
    let cos = libm::cos(angle.to_radians());
    Material {
        ambient: color.map(|c| c * ambient),
        specular: [highlight; 3],
        shininess: (libm::log(0.5) / libm::log(cos)) as f32,
        reflection: if highlight > 0.0 { Reflection::Glossy } else { Reflection::Lambertian },
        ..Material::matt(name, color.map(|c| c * diffuse))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::vec3::{cross, dot, length, sub, wide};

    /// The sizes of the paper's table and the least ones; what is announced is what is made.
    #[test]
    fn numbers_of_triangles() {
        for (which, size, expected) in [
            (Builtin::Balls, 4, 1_417_154),
            (Builtin::Balls, 0, 194),
            (Builtin::Balls, 2, 91 * 192 + 2),
            (Builtin::Rings, 7, 873_602),
            (Builtin::Rings, 1, 30 * 208 + 2),
            (Builtin::Tree, 12, 1_703_730),
            (Builtin::Tree, 11, 851_762),
            (Builtin::Tree, 0, 210),
            (Builtin::Hairball, 1, 480),
        ] {
            let scene = which.scene(size).expect("a possible size");
            assert_eq!(scene.mesh.triangles.len(), expected, "{which:?} {size}");
            assert_eq!(which.triangles(size), Some(expected));
            scene.validate().expect("sound");
        }
        assert_eq!(Builtin::Hairball.triangles(Builtin::Hairball.default_size()), Some(2_880_000));
    }

    /// Normals have unit length and look to the side from which the triangle's corners run counter-clockwise; no vertex
    /// lies there without use, and none twice within a sphere or a cone.
    #[test]
    fn normals_and_winding() {
        for which in Builtin::ALL {
            let mesh = which.scene(if which == Builtin::Hairball { 50 } else { 2 }).expect("a possible size").mesh;
            for n in &mesh.normals {
                assert!((length(wide(*n)) - 1.0).abs() < 1e-6, "{which:?}: {n:?}");
            }
            let mut used = vec![false; mesh.positions.len()];
            for (i, normals) in mesh.normal_indices.iter().enumerate() {
                mesh.triangles[i].iter().for_each(|&v| used[v as usize] = true);
                if *normals == crate::model::Mesh::FLAT {
                    continue;
                }
                let [a, b, c] = mesh.triangle(i).map(wide);
                let facing = cross(sub(b, a), sub(c, a));
                for &n in normals {
                    assert!(dot(facing, wide(mesh.normals[n as usize])) > 0.0, "{which:?}, triangle {i}");
                }
            }
            assert!(used.iter().all(|&u| u), "{which:?}");
        }
    }

    #[test]
    fn every_scene_has_its_view_and_lights() {
        for (which, lights) in [(Builtin::Balls, 3), (Builtin::Rings, 3), (Builtin::Tree, 7), (Builtin::Hairball, 2)] {
            let scene = which.scene(1).expect("a possible size");
            scene.camera.expect("a view").validate().expect("sound");
            assert_eq!(scene.lights.len(), lights);
            for light in &scene.lights {
                let power: f32 = scene.lights.len() as f32 * light.intensity[0] * light.intensity[0];
                assert!((power - 1.0).abs() < 1e-6);
            }
            assert_eq!((scene.name.as_str(), scene.background), (which.name(), Model::SKY));
        }
    }

    /// A highlight is half as strong at its angle.
    #[test]
    fn highlight_angle() {
        let m = glossy("", [1.0; 3], [0.0, 0.5, 0.5], 37.0);
        let at = libm::pow(libm::cos(37_f64.to_radians()), f64::from(m.shininess));
        assert!((at - 0.5).abs() < 1e-6, "{m:?}");
    }

    #[test]
    fn names_and_sizes() {
        assert!(builtin("bunny.obj").is_none() && builtin("Balls").is_none() && builtin("").is_none());
        assert_eq!(builtin("balls:1").expect("a name").expect("a size").mesh.triangles.len(), 10 * 192 + 2);
        for (spec, range) in [
            ("balls:", "from 0 to 6, for example balls:4"),
            ("balls:7", "from 0 to 6"),
            ("balls:-1", "from 0 to 6"),
            ("balls:4294967295", "from 0 to 6"),
            ("balls:99999999999999999999", "from 0 to 6"),
            ("rings:0", "from 1 to 50, for example rings:7"),
            ("rings:4294967295", "from 1 to 50"),
            ("tree:12.5", "from 0 to 19, for example tree:12"),
            ("tree:63", "from 0 to 19"),
            ("hairball:0", "from 1 to 559240, for example hairball:6000"),
            ("hairball:559241", "from 1 to 559240"),
        ] {
            let message = builtin(spec).expect("a name").expect_err(spec).to_string();
            assert!(message.starts_with(spec) && message.contains(range), "{message}");
        }
    }
}
