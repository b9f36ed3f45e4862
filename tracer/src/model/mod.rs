//! What is rendered: meshes, materials, lights, a camera; readers, writers and procedural scenes.

mod camera;
mod decompress;
#[cfg(feature = "gltf")]
pub mod gltf;
mod light;
mod material;
mod mesh;
pub mod obj;
pub mod ply;
pub mod procedural;
mod texture;
mod vec3;
mod view;

pub use camera::{Camera, FrameVectors};
pub use light::Light;
pub use material::{Material, Reflection};
pub use mesh::Mesh;
pub use procedural::{Builtin, builtin};
pub(crate) use texture::LINEAR;
pub use texture::Texture;

use crate::Error;
use crate::progress::Progress;
use std::path::Path;
use std::sync::Arc;

/// A mesh with all that is needed for a picture of it.
#[derive(Debug, Clone)]
pub struct Model {
    /// Name for reports: the file's stem or the built-in's name.
    pub name: String,
    /// The triangles.
    pub mesh: Mesh,
    /// Materials that the mesh's triangles name by index; never empty.
    pub materials: Vec<Material>,
    /// Point lights; empty means a headlight at the eye.
    pub lights: Vec<Light>,
    /// The scene's own view, if it has one.
    pub camera: Option<Camera>,
    /// Intensity of the ambient light, which is white.
    pub ambient: f32,
    /// Linear RGB seen by rays that hit nothing.
    pub background: [f32; 3],
}

impl Model {
    /// The background of the SPD's scenes, and of those that have none of their own.
    pub const SKY: [f32; 3] = [0.078, 0.361, 0.753];

    /// The scene that a user names: a built-in one ([`builtin`]: `balls`, `rings:3` ...) or a file (`.obj`: [`obj::read`], `.ply`:
    /// [`ply::read`], `.gltf` and `.glb` with the feature `gltf`: [`gltf::read`]; all of them as `.gz` and `.zst` too; a file called like a
    /// built-in is `./balls`). With it come warnings for the user.
    ///
    /// # Errors
    /// [`Error::Usage`] for an impossible size of a built-in or a file of unknown kind; [`Error::Io`] and [`Error::Data`] for a
    /// file that cannot be read or used; [`Error::Cancelled`].
    pub fn open(spec: &str, progress: &dyn Progress) -> Result<(Self, Vec<String>), Error> {
        if let Some(scene) = builtin(spec) {
            return Ok((scene?, Vec::new()));
        }
        let path = Path::new(spec);
        let name = spec.to_ascii_lowercase();
        let unpacked = [".gz", ".zst"].iter().find_map(|end| name.strip_suffix(end)).unwrap_or(&name);
        match unpacked.rsplit_once('.').map(|(_, kind)| kind) {
            Some("obj") => obj::read(path, progress),
            Some("ply") => ply::read(path, progress),
            #[cfg(feature = "gltf")]
            Some("gltf" | "glb") => gltf::read(path, progress),
            #[cfg(not(feature = "gltf"))]
            Some("gltf" | "glb") => Err(Error::Usage(format!("{spec}: glTF needs the feature gltf of this crate"))),
            _ => Err(Error::Usage(format!(
                "{spec}: not a scene: give a file that ends in .obj, .ply, .gltf or .glb (or .obj.gz, .obj.zst ...), or one of the built-in scenes {} \
                 (with a size after a colon, if you like: balls:3)",
                Builtin::ALL.map(Builtin::name).join(", ")
            ))),
        }
    }

    /// A mesh from a file: all of it light grey, without lights and camera.
    pub(crate) fn of_mesh(path: &Path, mesh: Mesh) -> Self {
        let name = stem(path).unwrap_or_default();
        // Many exporters write an ambient coefficient of 1 for everything: at full light it would wash the picture out.
        let ambient = 0.1;
        let materials = vec![Material::grey("default")];
        Self { name, mesh, materials, lights: Vec::new(), camera: None, ambient, background: Self::SKY }
    }

    /// Writes the mesh as the name of the file says: `.obj` with its `.mtl` ([`obj::write`]) or `.ply` ([`ply::write`]).
    ///
    /// # Errors
    /// [`Error::Usage`] for another kind of file, else those of the two writers.
    pub fn write(&self, path: &Path, progress: &dyn Progress) -> Result<(), Error> {
        match path.extension().map(|e| e.to_ascii_lowercase()).as_ref().and_then(|e| e.to_str()) {
            Some("obj") => obj::write(self, path, progress),
            Some("ply") => ply::write(&self.mesh, path, progress),
            _ => Err(Error::Usage(format!("{}: give a file that ends in .obj or .ply", path.display()))),
        }
    }

    /// Checks the mesh ([`Mesh::validate`]), that the materials it names are there, and that their textures are not too large together.
    ///
    /// # Errors
    /// [`Error::Geometry`] with the number of the first vertex or triangle at fault and what to do.
    pub fn validate(&self) -> Result<(), Error> {
        self.mesh.validate()?;
        let texels: usize = self.textures().iter().map(|t| t.texels().len()).sum();
        if texels > Texture::MAX_TEXELS {
            let most = Texture::MAX_TEXELS;
            return Err(Error::Geometry(format!(
                "the textures have {texels} pixels, {most} is the most: make them smaller"
            )));
        }
        let n = self.materials.len();
        let all_first = if self.mesh.materials.is_empty() { &[0][..] } else { &self.mesh.materials };
        match all_first.iter().position(|&m| m as usize >= n) {
            None => Ok(()),
            Some(i) => Err(Error::Geometry(format!(
                "triangle {i} has material {}, but there are {n} (counted from 0): add the material or correct the index",
                all_first[i]
            ))),
        }
    }

    /// All textures of its materials, each once.
    pub(crate) fn textures(&self) -> Vec<&Arc<Texture>> {
        let mut textures: Vec<&Arc<Texture>> = Vec::new();
        for texture in self.materials.iter().filter_map(|m| m.texture.as_ref()) {
            if !textures.iter().any(|t| Arc::ptr_eq(t, texture)) {
                textures.push(texture);
            }
        }
        textures
    }

    /// The scene's own view, else one that shows all of it: [`Camera::of_mesh`].
    ///
    /// # Panics
    /// When the mesh is not valid (see [`Mesh::validate`]).
    #[must_use]
    pub fn camera_or_default(&self) -> Camera {
        self.camera.unwrap_or_else(|| Camera::of_mesh(&self.mesh))
    }

    /// The scene's lights, else a white one of intensity 1 at the eye.
    #[must_use]
    pub fn lights_or_headlight(&self, camera: &Camera) -> Vec<Light> {
        if self.lights.is_empty() {
            vec![Light { position: camera.eye, intensity: [1.0; 3] }]
        } else {
            self.lights.clone()
        }
    }
}

/// The file's name without its ending, `.gz` or `.zst` included.
fn stem(path: &Path) -> Option<String> {
    let inner = match path.extension()?.to_ascii_lowercase().to_str() {
        Some("gz" | "zst") => Path::new(path.file_stem()?),
        _ => path,
    };
    Some(inner.file_stem()?.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;

    #[test]
    fn opens_what_is_named() {
        let (scene, warnings) = Model::open("balls:0", &Silent).expect("a built-in");
        assert_eq!((scene.mesh.triangles.len(), warnings.len()), (194, 0));
        for (spec, reason) in [
            ("scene.blend", "ends in .obj, .ply, .gltf or .glb"),
            ("bals", "balls, rings, tree, hairball"),
            ("", "not a scene"),
            ("balls:x", "whole number from 0 to 6"),
            ("there/is/none.OBJ", "cannot open there/is/none.OBJ"),
            ("none.ply.Gz", "cannot open none.ply.Gz"),
            ("none.blend.gz", "not a scene"),
        ] {
            let e = Model::open(spec, &Silent).expect_err(spec);
            assert!(e.to_string().contains(reason), "{e}");
            assert_eq!(matches!(e, Error::Usage(_)), !e.to_string().starts_with("cannot open"));
        }
    }

    #[test]
    fn a_headlight_where_there_are_no_lights() {
        let mut scene = builtin("balls:0").expect("a name").expect("a size");
        let camera = scene.camera_or_default();
        assert_eq!(scene.lights_or_headlight(&camera), scene.lights);
        scene.lights.clear();
        let headlight = Light { position: camera.eye, intensity: [1.0; 3] };
        assert_eq!(scene.lights_or_headlight(&camera), [headlight]);
    }

    #[test]
    fn materials_are_there() {
        let mut scene = builtin("balls:0").expect("a name").expect("a size");
        scene.validate().expect("sound");
        scene.materials.pop();
        assert!(scene.validate().expect_err("no material 1").to_string().contains("triangle 2 has material 1"));
        scene.mesh.materials.clear();
        scene.validate().expect("all use material 0");
        scene.materials.clear();
        scene.validate().expect_err("no material 0");
    }
}
