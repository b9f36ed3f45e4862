//! Stanford PLY: what is read of it, and how it is written.
//!
//! Read are the positions `x y z` and the normals `nx ny nz` of the element `vertex`, and the lists `vertex_indices` (or `vertex_index`)
//! of the element `face`, in all three formats: `ascii`, `binary_little_endian`, `binary_big_endian`. Polygons are cut into fans, as
//! those of an OBJ ([`super::obj`]). Other properties (colours among them) and elements are passed over.

mod body;
mod header;
mod write;

pub use write::write;

use super::{Mesh, Model, decompress};
use crate::Error;
use crate::bvh::Node;
use crate::progress::Progress;
use body::Body;
use header::{Element, Form, Header};
use std::path::Path;

/// Reads a `.ply`, `.ply.gz` or `.ply.zst` file. The scene is light grey, without lights and camera; with it come warnings for the user,
/// such as elements that are passed over. A triangle with a normal of length zero at some corner is flat.
///
/// # Errors
/// [`Error::Io`] when the file cannot be read; [`Error::Data`] when its content is not acceptable, with the line, or in the message the
/// byte of a binary file; [`Error::Cancelled`].
pub fn read(path: &Path, progress: &dyn Progress) -> Result<(Model, Vec<String>), Error> {
    let bytes = decompress::read(path, progress)?;
    let (mesh, warnings) = parse(&bytes, path, progress)?;
    Ok((Model::of_mesh(path, mesh), warnings))
}

fn parse(bytes: &[u8], path: &Path, progress: &dyn Progress) -> Result<(Mesh, Vec<String>), Error> {
    let header = Header::parse(bytes, path)?;
    let mut warnings = Vec::new();
    let mut reader =
        Reader { body: Body::new(bytes, &header, path), mesh: Mesh::default(), vertices: header.vertices()?, progress };
    progress.stage("parse", bytes.len() as u64);
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => reader.vertices(element)?,
            "face" => reader.faces(element)?,
            name => {
                reader.skip(element)?;
                let file = path.display();
                warnings.push(format!("{file}: {} elements {name:?} are passed over", element.count));
            }
        }
    }
    let mut mesh = reader.mesh;
    if mesh.triangles.is_empty() {
        return Err(header.error(format!(
            "there are {} vertices, but no faces: clouds of points cannot be rendered, make a mesh of them",
            mesh.positions.len()
        )));
    }
    if !mesh.normals.is_empty() {
        mesh.normal_indices = mesh.triangles.clone();
        mesh.unit_normals();
    }
    Ok((mesh, warnings))
}

struct Reader<'a> {
    body: Body<'a>,
    mesh: Mesh,
    /// Number that the header announces: faces may come first.
    vertices: usize,
    progress: &'a dyn Progress,
}

impl Reader<'_> {
    fn vertices(&mut self, element: &Element) -> Result<(), Error> {
        const NAMES: [&str; 6] = ["x", "y", "z", "nx", "ny", "nz"];
        let places = NAMES.map(|name| element.scalar(name));
        if places[..3].contains(&None) {
            return self.body.fail("the vertices have no x, y and z in the header: there is nothing to see");
        }
        let smooth = !places[3..].contains(&None);
        let places = &places[..if smooth { 6 } else { 3 }];
        self.mesh.positions.reserve(self.body.at_most(element.count));
        let mut row = vec![0.0; element.properties.len()];
        for i in 0..element.count {
            self.body.begin(element, i)?;
            for (property, value) in element.properties.iter().zip(&mut row) {
                match property.form {
                    Form::Scalar(kind) => *value = self.body.number(kind)?,
                    Form::List { .. } => self.body.skip(property)?,
                }
            }
            let mut values = [0.0_f32; 6];
            for ((name, place), value) in NAMES.iter().zip(places).zip(&mut values) {
                // Doubles are rounded; what is too large for a float is infinite then.
                *value = row[place.unwrap_or_default()] as f32;
                if !value.is_finite() {
                    return self.body.fail(format!("{name} of vertex {i} is {value}, it must be a finite number"));
                }
            }
            self.body.end()?;
            let [x, y, z, nx, ny, nz] = values;
            self.mesh.positions.push([x, y, z]);
            if smooth {
                self.mesh.normals.push([nx, ny, nz]);
            }
            self.step(i)?;
        }
        Ok(())
    }

    fn faces(&mut self, element: &Element) -> Result<(), Error> {
        let Some(place) = element.list("vertex_indices").or_else(|| element.list("vertex_index")) else {
            return self.body.fail("the faces have no list vertex_indices in the header: there is nothing to see");
        };
        self.mesh.triangles.reserve(self.body.at_most(element.count));
        for i in 0..element.count {
            self.body.begin(element, i)?;
            for (number, property) in element.properties.iter().enumerate() {
                match property.form {
                    Form::List { len, item } if number == place => {
                        let len = self.body.len(len)?;
                        self.fan(i, len, item)?;
                    }
                    _ => self.body.skip(property)?,
                }
            }
            self.body.end()?;
            self.step(i)?;
        }
        Ok(())
    }

    /// The triangles of a polygon: 0 1 2, 0 2 3, 0 3 4 ...
    fn fan(&mut self, face: usize, len: usize, item: header::Kind) -> Result<(), Error> {
        if len < 3 {
            return self
                .body
                .fail(format!("face {face} has {len} vertices, it needs at least 3: remove or complete it"));
        }
        let (mut first, mut last) = (0, 0);
        for corner in 0..len {
            let index = self.body.number(item)?;
            if !(0.0..self.vertices as f64).contains(&index) {
                let n = self.vertices;
                return self.body.fail(format!("face {face} uses vertex {index}, but there are {n} (counted from 0)"));
            }
            let index = index as u32;
            match corner {
                0 => first = index,
                1 => {}
                _ => self.mesh.triangles.push([first, last, index]),
            }
            last = index;
        }
        if self.mesh.triangles.len() > Node::MAX_TRIANGLES {
            return self.body.fail(format!("more than {} triangles: split the scene", Node::MAX_TRIANGLES));
        }
        Ok(())
    }

    fn skip(&mut self, element: &Element) -> Result<(), Error> {
        for i in 0..element.count {
            self.body.begin(element, i)?;
            for property in &element.properties {
                self.body.skip(property)?;
            }
            self.body.end()?;
            self.step(i)?;
        }
        Ok(())
    }

    fn step(&mut self, i: usize) -> Result<(), Error> {
        if i.is_multiple_of(1 << 14) {
            self.progress.advance(self.body.untold());
            self.progress.check()?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
