//! Writing OBJ and MTL.

use super::mtl;
use crate::Error;
use crate::model::{Material, Mesh, Model};
use crate::output::{stage, step};
use crate::progress::Progress;
use std::collections::HashSet;
use std::io::{self, Write};
use std::path::Path;

/// Writes a scene's mesh and materials as `.obj` with an `.mtl` of the same stem beside it; lights and camera have no place in
/// them, textures and their coordinates are left out. Both files appear whole or not at all. Reading them back ([`super::read`]) gives the same triangles under the
/// same ids, all numbers with the same bits; vertices come back in order of first use, unused ones not at all. Material
/// names are made unique, without blanks at their ends.
///
/// # Errors
/// [`Error::Geometry`] when the scene is not valid ([`Model::validate`]), [`Error::Io`] when a file cannot be written,
/// [`Error::Cancelled`].
pub fn write(scene: &Model, path: &Path, progress: &dyn Progress) -> Result<(), Error> {
    scene.validate()?;
    let names = unique_names(&scene.materials);
    let library = path.with_extension("mtl");
    let mtl = stage(&library, |out| mtl::write(&scene.materials, &names, out))?;
    let library = library.file_name().unwrap_or_default().to_string_lossy();
    let obj = stage(path, |out| write_obj(&scene.mesh, &library, &names, out, progress));
    progress.check()?;
    let obj = obj?;
    mtl.commit()?;
    obj.commit()
}

fn write_obj(
    mesh: &Mesh,
    library: &str,
    names: &[String],
    out: &mut dyn Write,
    progress: &dyn Progress,
) -> io::Result<()> {
    let total = mesh.positions.len() + mesh.normals.len() + mesh.triangles.len();
    progress.stage("write", total as u64);
    writeln!(out, "# {} triangles\nmtllib {library}", mesh.triangles.len())?;
    for (keyword, list) in [("v", &mesh.positions), ("vn", &mesh.normals)] {
        for (i, [x, y, z]) in list.iter().enumerate() {
            // Display prints the shortest text that reads back as the same number.
            writeln!(out, "{keyword} {x} {y} {z}")?;
            step(progress, i)?;
        }
    }
    let mut current = None;
    for (i, t) in mesh.triangles.iter().enumerate() {
        let material = mesh.material(i) as usize;
        if current.replace(material) != Some(material) {
            writeln!(out, "usemtl {}", names[material])?;
        }
        let [a, b, c] = t.map(|v| u64::from(v) + 1);
        match mesh.normal_indices.get(i) {
            Some(n) if *n != Mesh::FLAT => {
                let [na, nb, nc] = n.map(|n| u64::from(n) + 1);
                writeln!(out, "f {a}//{na} {b}//{nb} {c}//{nc}")?;
            }
            _ => writeln!(out, "f {a} {b} {c}")?,
        }
        step(progress, i)?;
    }
    Ok(())
}

/// Names that a file can hold: in one line, not empty, each once.
fn unique_names(materials: &[Material]) -> Vec<String> {
    let mut taken = HashSet::new();
    let mut unique = |(i, m): (usize, &Material)| {
        let clean = m.name.replace(|c: char| c.is_control() || c == '\\', "_");
        let base = if clean.trim().is_empty() { "material" } else { clean.trim() };
        let mut name = base.to_owned();
        for n in i.. {
            if taken.insert(name.clone()) {
                break;
            }
            name = format!("{base}_{n}");
        }
        name
    };
    materials.iter().enumerate().map(&mut unique).collect()
}
