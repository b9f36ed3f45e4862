//! Wavefront OBJ with its MTL: what is read of it, and how it is written.
//!
//! Read are `v`, `vn`, `vt`, `f`, `usemtl` and `mtllib`, and of the library `newmtl`, `Ka`, `Kd`, `Ks`, `Ns`, `Ke`, `Ni`, `Tf`, `illum` and `map_Kd`. Polygons are cut into fans
//! (0 1 2, 0 2 3, 0 3 4 ...). The triangle with id `i` is the `i`-th of the file, whatever objects, groups and materials
//! it belongs to, degenerate ones included; points, lines and curves are passed over, and texture coordinates where nothing has a texture. A face may
//! only name vertices above it. Vertices are numbered in the order in which faces first use them.
//!
//! `tobj` parses. Before it does, the module `tidy` goes over the text for what `tobj` does not do: errors with a line number,
//! triangles without normals among others, comments behind numbers, continued lines, `l` that is no polygon.

mod mtl;
mod textures;
mod tidy;
mod write;

pub use write::write;

use super::{Material, Mesh, Model, decompress};
use crate::Error;
use crate::progress::Progress;
use std::collections::HashMap;
use std::io::{self, BufRead, Read};
use std::path::Path;
use tidy::Outline;

/// Reads an `.obj`, `.obj.gz` or `.obj.zst` file and the material libraries it names. With the scene (without lights and
/// camera) come warnings for the user, such as a library that is not there.
///
/// Triangles without `usemtl`, and materials that are in no library, are light grey. Normals are made unit vectors; a
/// triangle with a normal of length zero, or without one at some corner, is flat.
///
/// # Errors
/// [`Error::Io`] when a file cannot be read (a missing library is a warning), [`Error::Data`] with the line when its content is
/// not acceptable: see the module's text; [`Error::Cancelled`].
pub fn read(path: &Path, progress: &dyn Progress) -> Result<(Model, Vec<String>), Error> {
    let mut text = decompress::read(path, progress)?;
    let outline = tidy::tidy(&mut text, path, progress)?;
    let mut warnings = Vec::new();
    let library = mtl::read(path, &outline, &mut warnings)?;
    let textured = library.iter().flatten().any(|m| m.texture.is_some());
    match outline.bad_uv {
        Some(line) if textured => {
            let message = "a texture coordinate has two finite numbers: correct it, or remove the textures".into();
            return Err(Error::Data { path: path.to_owned(), line: Some(line), message });
        }
        _ if textured => {}
        _ => tidy::without_uvs(&mut text),
    }
    let mut mesh = parse(&text, path, progress)?;
    drop(text);
    finish_normals(&mut mesh, &outline);
    finish_uvs(&mut mesh, &outline);
    let materials = assign_materials(&mut mesh, &outline, library, path, &mut warnings);
    Ok((Model { materials, ..Model::of_mesh(path, mesh) }, warnings))
}

/// Lets `tobj` read the tidied text. Nothing in it opens a new model, so there is one, with all faces in file order.
fn parse(text: &[u8], path: &Path, progress: &dyn Progress) -> Result<Mesh, Error> {
    progress.stage("parse", text.len() as u64);
    let options = tobj::LoadOptions { triangulate: true, ..Default::default() };
    let no_library = |_: &Path| Err(tobj::LoadError::OpenFileFailed);
    let mut source = Watched { text, progress, untold: 0, cancelled: false };
    let result = tobj::load_obj_buf(&mut source, &options, no_library);
    progress.check()?;
    let data = |message| Error::Data { path: path.to_owned(), line: None, message };
    let (models, _) = result.map_err(|e| data(format!("not acceptable as OBJ: {e}")))?;
    let [model] = models.try_into().map_err(|_| data("not acceptable as OBJ: no single model".into()))?;
    let m = model.mesh;
    Ok(Mesh {
        positions: m.positions.as_chunks().0.to_vec(),
        triangles: m.indices.as_chunks().0.to_vec(),
        normals: m.normals.as_chunks().0.to_vec(),
        normal_indices: m.normal_indices.as_chunks().0.to_vec(),
        uvs: m.texcoords.as_chunks().0.to_vec(),
        uv_indices: m.texcoord_indices.as_chunks().0.to_vec(),
        materials: Vec::new(),
    })
}

/// Unit normals, and no normals where the file gives none: `tobj` makes some up.
fn finish_normals(mesh: &mut Mesh, outline: &Outline) {
    if mesh.normal_indices.is_empty() {
        return;
    }
    for run in &outline.flat {
        mesh.normal_indices[run.clone()].fill(Mesh::FLAT);
    }
    mesh.unit_normals();
}

/// No texture coordinates where the file gives none.
fn finish_uvs(mesh: &mut Mesh, outline: &Outline) {
    if mesh.uv_indices.is_empty() {
        return;
    }
    for run in &outline.bare {
        mesh.uv_indices[run.clone()].fill(Mesh::FLAT);
    }
    if mesh.uv_indices.iter().all(|t| *t == Mesh::FLAT) {
        (mesh.uvs, mesh.uv_indices) = (Vec::new(), Vec::new());
    }
}

/// Gives each triangle its material; those that no library has are made up.
fn assign_materials(
    mesh: &mut Mesh,
    outline: &Outline,
    library: Option<Vec<Material>>,
    path: &Path,
    warnings: &mut Vec<String>,
) -> Vec<Material> {
    if outline.libraries.is_empty() && !outline.names.is_empty() {
        let file = path.display();
        warnings.push(format!("{file}: uses materials, but names no library (mtllib): all surfaces are light grey"));
    }
    let complain = library.is_some();
    let mut materials = library.unwrap_or_default();
    // When a name is there twice, the last counts.
    let known: HashMap<String, usize> = materials.iter().enumerate().map(|(i, m)| (m.name.clone(), i)).collect();
    let mut numbers = Vec::new();
    for (line, name) in &outline.names {
        numbers.push(known.get(name).copied().unwrap_or_else(|| {
            if complain {
                let file = path.display();
                warnings.push(format!("{file}:{line}: no library has the material {name:?}: it is light grey"));
            }
            materials.push(Material::grey(name));
            materials.len() - 1
        }));
    }
    let mut runs: Vec<(usize, usize)> = outline.runs.iter().map(|&(first, name)| (first, numbers[name])).collect();
    if runs.first().is_none_or(|&(first, _)| first > 0) {
        materials.push(Material::grey("default"));
        runs.insert(0, (0, materials.len() - 1));
    }
    if runs.iter().any(|&(_, material)| material != 0) {
        let ends = runs.iter().skip(1).map(|&(first, _)| first).chain([mesh.triangles.len()]);
        for (&(_, material), end) in runs.iter().zip(ends) {
            mesh.materials.resize(end, u32::try_from(material).unwrap_or_default());
        }
    }
    materials
}

/// Text in memory that tells now and then how far it has been read, and fails when the work is cancelled.
struct Watched<'a> {
    text: &'a [u8],
    progress: &'a dyn Progress,
    untold: u64,
    cancelled: bool,
}

impl Read for Watched<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = self.fill_buf()?.read(buffer)?;
        self.consume(n);
        Ok(n)
    }
}

impl BufRead for Watched<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if self.cancelled { Err(io::Error::other("cancelled")) } else { Ok(self.text) }
    }

    fn consume(&mut self, n: usize) {
        self.text = &self.text[n..];
        self.untold += n as u64;
        if self.untold > 1 << 20 || self.text.is_empty() {
            self.progress.advance(std::mem::take(&mut self.untold));
            self.cancelled = self.progress.cancelled();
        }
    }
}

#[cfg(test)]
mod tests;
