//! The paper's scenes, or what is nearest to them, with its three kinds of surface and its lamp.

use super::paper;
use crate::console::Console;
use crate::report::scenes::{self, View};
use clap::ValueEnum;
use serde::Serialize;
use std::fmt;
use tracer::Error;
use tracer::bvh::{BuildConfig, Bvh, CollapseConfig, WideBvh, build::binned};
use tracer::model::{Camera, Material, Mesh, Model, Reflection};
use tracer::progress::Progress;
use tracer::render::Scenery;

/// A scene of the paper, in the order of its tables.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize)]
pub enum Name {
    /// Crytek's Sponza in place of Dabrovic's
    Sponza,
    /// A stand-in: the built-in tree on its field
    Fairy,
    /// The conference room
    Conference,
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Sponza => "Sponza",
            Self::Fairy => "Fairy (stand-in)",
            Self::Conference => "Conference",
        })
    }
}

/// What all surfaces of a scene are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Surface {
    /// Mirrors.
    Specular,
    /// A matt ground under a glossy coat, whose lobe alone is followed.
    Glossy,
    /// Matt.
    Diffuse,
}

impl Surface {
    /// The exponent of the coat's lobe: the paper has that of Boulos 2007, which it does not name.
    pub const SHININESS: f32 = 100.0;

    /// Reflections at most, from few to many.
    pub fn bounces(self) -> [u32; 3] {
        paper::table(self).bounces
    }

    /// Grey, so that no path ends because nothing is left of its light.
    fn material(self) -> Material {
        let (reflection, diffuse, specular) = match self {
            Self::Specular => (Reflection::Mirror, 0.1, 0.8),
            Self::Glossy => (Reflection::Glossy, 0.5, 0.2),
            Self::Diffuse => (Reflection::Lambertian, 0.7, 0.0),
        };
        let matt = Material::matt("surface", [diffuse; 3]);
        Material { specular: [specular; 3], shininess: Self::SHININESS, reflection, ..matt }
    }
}

/// A horizontal rectangle that shines: `up` is the axis of its height, 1 or 2; the corners have the other two coordinates.
struct Lamp {
    up: usize,
    height: f32,
    from: [f32; 2],
    to: [f32; 2],
}

/// A scene ready to be traced.
pub struct Scene {
    pub name: Name,
    /// What it is, for the report.
    pub what: String,
    pub model: Model,
    pub camera: Camera,
    pub bvh: Bvh,
    /// The same tree with 8 children a node, for single rays beside the paper's methods.
    pub wide: WideBvh<8>,
}

impl Scene {
    /// What a box test costs, when a triangle test costs 1, for the tree to have the paper's part of triangle tests: 6.0 to 46.6 box tests a single
    /// ray (table 4). By the usual cost of 1 leaves are larger, and it is twice that.
    pub const BOX_COST: f32 = 0.25;

    /// Reads it and builds its tree; none when its file is missing, which is said on standard output.
    pub fn open(name: Name, box_cost: f32, console: &Console) -> Result<Option<Self>, Error> {
        console.stage(&format!("{name}: reading"), 0);
        let (view, lamp) = match name {
            // Above the opening of the roof, which stays open around it.
            Name::Sponza => {
                (scenes::sponza(console)?, Lamp { up: 1, height: 140.0, from: [-60.0, -25.0], to: [50.0, 18.0] })
            }
            Name::Fairy => (scenes::fairy()?, Lamp { up: 2, height: 8.0, from: [-4.0, -4.0], to: [4.0, 4.0] }),
            // Almost the full ceiling, which is at 8.9.
            Name::Conference => {
                (scenes::conference(console)?, Lamp { up: 2, height: 8.8, from: [1.0, 1.0], to: [34.5, 21.0] })
            }
        };
        let Some(view) = view else { return Ok(None) };
        let what = view.describe();
        let View { mut model, camera, .. } = view;
        hang(&lamp, &mut model.mesh);
        model.lights.clear();
        let config = binned::Config { traversal_cost: box_cost, ..binned::Config::default() };
        let bvh = Bvh::build(&model.mesh, &BuildConfig::Binned(config), console)?;
        let wide = bvh.collapse(&CollapseConfig::default());
        console.clear();
        Ok(Some(Self { name, what, model, camera, bvh, wide }))
    }

    /// Makes all surfaces of one kind, the lamp as well.
    pub fn paint(&mut self, surface: Surface) -> Result<Scenery, Error> {
        let surface = surface.material();
        self.model.materials = vec![surface.clone(), Material { emission: [10.0; 3], ..surface }];
        self.model.validate()?;
        Ok(Scenery::new(&self.model, &self.camera))
    }
}

/// Adds the lamp's two triangles, which are of material 1; all others are of material 0.
fn hang(lamp: &Lamp, mesh: &mut Mesh) {
    let first = mesh.positions.len() as u32;
    let corner = |u, v| if lamp.up == 1 { [u, lamp.height, v] } else { [u, v, lamp.height] };
    let [[u0, v0], [u1, v1]] = [lamp.from, lamp.to];
    mesh.positions.extend([corner(u0, v0), corner(u1, v0), corner(u1, v1), corner(u0, v1)]);
    mesh.materials = vec![0; mesh.triangles.len()];
    mesh.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|i: u32| first + i)));
    mesh.materials.extend([1, 1]);
    if !mesh.normal_indices.is_empty() {
        mesh.normal_indices.extend([Mesh::FLAT; 2]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tracer::model::builtin;

    /// Flat at its height, its corners those given, with materials for all.
    #[test]
    fn lamps_hang_level() {
        for (up, expected) in [(1, [[1.0, 9.0, 2.0], [3.0, 9.0, 4.0]]), (2, [[1.0, 2.0, 9.0], [3.0, 4.0, 9.0]])] {
            let mut mesh = builtin("balls:0").expect("a name").expect("a size").mesh;
            let triangles = mesh.triangles.len();
            hang(&Lamp { up, height: 9.0, from: [1.0, 2.0], to: [3.0, 4.0] }, &mut mesh);
            mesh.validate().expect("sound");
            assert_eq!((mesh.triangles.len(), mesh.material(triangles - 1)), (triangles + 2, 0));
            let [first, second] = [0, 1].map(|i| mesh.triangle(triangles + i));
            assert_eq!([first[0], first[2]], expected);
            assert_eq!([second[0], second[1]], expected);
            assert_eq!((mesh.material(triangles), mesh.material(triangles + 1)), (1, 1));
        }
    }

    /// Mirrors reflect no more than comes in, and nothing ends a path by being black.
    #[test]
    fn surfaces() {
        for surface in [Surface::Specular, Surface::Glossy, Surface::Diffuse] {
            let material = surface.material();
            assert!(material.diffuse[0] > 0.0 && material.diffuse[0] + material.specular[0] <= 1.0);
        }
    }
}
