//! Writing PLY.

use crate::Error;
use crate::model::Mesh;
use crate::output::{stage, step};
use crate::progress::Progress;
use std::io::{self, Write};
use std::path::Path;

/// Writes positions and triangles as binary little-endian `.ply`: `x y z` as float, `vertex_indices` as lists of three
/// int, triangles in the order of their ids. (PLY has no room for the mesh's separate normals and its materials.) The file
/// appears whole or not at all.
///
/// # Errors
/// [`Error::Geometry`] when the mesh is not valid ([`Mesh::validate`]) or has more vertices than an int counts, [`Error::Io`] when
/// the file cannot be written, [`Error::Cancelled`].
pub fn write(mesh: &Mesh, path: &Path, progress: &dyn Progress) -> Result<(), Error> {
    mesh.validate()?;
    if i32::try_from(mesh.positions.len()).is_err() {
        let n = mesh.positions.len();
        return Err(Error::Geometry(format!(
            "the mesh has {n} vertices, .ply files hold 2147483647 at most: split it"
        )));
    }
    let staged = stage(path, |out| write_ply(mesh, out, progress));
    progress.check()?;
    staged?.commit()
}

fn write_ply(mesh: &Mesh, out: &mut dyn Write, progress: &dyn Progress) -> io::Result<()> {
    let (vertices, faces) = (mesh.positions.len(), mesh.triangles.len());
    progress.stage("write", (vertices + faces) as u64);
    writeln!(out, "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}")?;
    writeln!(out, "property float x\nproperty float y\nproperty float z")?;
    writeln!(out, "element face {faces}\nproperty list uchar int vertex_indices\nend_header")?;
    for (i, p) in mesh.positions.iter().enumerate() {
        out.write_all(p.map(f32::to_le_bytes).as_flattened())?;
        step(progress, i)?;
    }
    for (i, t) in mesh.triangles.iter().enumerate() {
        out.write_all(&[3])?;
        out.write_all(t.map(u32::to_le_bytes).as_flattened())?;
        step(progress, i)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;
    use std::sync::atomic::AtomicBool;

    #[test]
    fn header_and_bytes() {
        let mesh = Mesh {
            positions: vec![[0.0, 1.5, -2.0], [1.0, 0.0, 0.0], [0.0, 1.0, 1e-30], [7.0; 3]],
            triangles: vec![[0, 1, 2], [3, 2, 1]],
            ..Mesh::default()
        };
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.ply");
        write(&mesh, &path, &Silent).expect("written");
        let bytes = std::fs::read(&path).expect("read");
        let header = "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
                      property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n";
        let (head, body) = bytes.split_at(header.len());
        assert_eq!(str::from_utf8(head), Ok(header));
        let (points, faces) = body.split_at(4 * 12);
        let word = |b: &[u8]| u32::from_le_bytes(b.try_into().expect("four bytes"));
        let read: Vec<f32> = points.chunks(4).map(|b| f32::from_bits(word(b))).collect();
        assert_eq!(read, mesh.positions.as_flattened());
        assert_eq!(faces.len(), 2 * 13);
        for (face, triangle) in faces.chunks(13).zip(&mesh.triangles) {
            assert_eq!(face[0], 3);
            assert_eq!(face[1..].chunks(4).map(word).collect::<Vec<_>>(), triangle);
        }
    }

    #[test]
    fn nothing_is_left_of_a_cancelled_or_impossible_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.ply");
        let mesh = Mesh { positions: vec![[0.0; 3]], triangles: vec![[0; 3]], ..Mesh::default() };
        assert!(matches!(write(&mesh, &path, &AtomicBool::new(true)), Err(Error::Cancelled)));
        assert!(matches!(write(&Mesh::default(), &path, &Silent), Err(Error::Geometry(_))));
        assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
    }
}
