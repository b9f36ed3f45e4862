//! glTF 2.0: what is read of it.
//!
//! Read are `.gltf` files, with buffers beside or inside of them, and `.glb` files: the meshes of the default scene (or of the first one), placed by the
//! transforms of its nodes. Triangles may be indexed or not, in lists, strips and fans, quantized (`KHR_mesh_quantization`) and sparse. The
//! triangles come node by node, each before its children, in the order of the file; a mesh that several nodes show is there several times.
//! Vertices are numbered in the order in which triangles first use them.
//!
//! - Materials become [`Material`](super::Material)s: see the module `materials` for which becomes what. Textures of their base colour are
//!   read (PNG and JPEG, inside or beside the file); of those of metalness, roughness, transmission and emission the mean is taken.
//! - The first perspective camera of the scene is the model's.
//! - Lights (`KHR_lights_punctual`) become [`Light`](super::Light)s, which shine equally bright on what is far and what is near: one that falls off shines
//!   everywhere as it does in the middle of the scene.
//!
//! There are warnings for what is passed over: skins, morph targets, vertex colours, points, lines, extensions of materials.

mod accessor;
mod buffers;
mod document;
mod graph;
mod images;
mod lights;
mod materials;
mod primitive;

use super::{Model, decompress};
use crate::Error;
use crate::progress::Progress;
use buffers::Buffers;
use graph::Graph;
use images::Images;
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Reads a `.gltf` or `.glb` file and the buffers it names. With the scene come warnings for the user, about what is passed over.
///
/// # Errors
/// [`Error::Io`] when the file cannot be read; [`Error::Data`] when its content is not acceptable, with the mesh, node or buffer at fault, or the line
/// of the JSON; [`Error::Cancelled`].
pub fn read(path: &Path, progress: &dyn Progress) -> Result<(Model, Vec<String>), Error> {
    let bytes = decompress::read(path, progress)?;
    let mut notes = Notes::new(path);
    let (document, blob) = document::parse(bytes, &mut notes)?;
    let buffers = Buffers::read(&document, blob, path, progress)?;
    let graph = Graph::walk(&document, &mut notes)?;
    let mut mesh = graph.mesh(&document, &buffers, &mut notes, progress)?;
    mesh.unit_normals();
    let images = Images { document: &document, buffers: &buffers, path, progress, known: HashMap::new(), texels: 0 };
    let materials = materials::read(&document, images, &mut notes);
    if materials.iter().all(|m| m.texture.is_none()) {
        (mesh.uvs, mesh.uv_indices) = (Vec::new(), Vec::new());
    }
    progress.check()?;
    let lights = lights::lights(&graph, &mesh.bounds(), &mut notes);
    let camera = lights::camera(&graph, &mut notes);
    Ok((Model { materials, lights, camera, ..Model::of_mesh(path, mesh) }, notes.warnings))
}

/// What is said about a file.
struct Notes<'a> {
    path: &'a Path,
    warnings: Vec<String>,
    told: HashSet<String>,
}

impl<'a> Notes<'a> {
    fn new(path: &'a Path) -> Self {
        Self { path, warnings: Vec::new(), told: HashSet::new() }
    }

    /// A warning, the first time.
    fn warn(&mut self, message: &str) {
        let message = format!("{}: {message}", self.path.display());
        if self.told.insert(message.clone()) {
            self.warnings.push(message);
        }
    }

    fn error(&self, message: impl Into<String>) -> Error {
        Error::Data { path: self.path.to_owned(), line: None, message: message.into() }
    }
}

/// What a thing of the file is called in messages. (A name may be as long as the file.)
fn named(kind: &str, index: usize, name: Option<&str>) -> String {
    match name {
        Some(name) => format!("{kind} {index} {:?}", name.chars().take(60).collect::<String>()),
        None => format!("{kind} {index}"),
    }
}

#[cfg(test)]
mod tests;
