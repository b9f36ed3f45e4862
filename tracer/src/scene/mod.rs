//! What is rendered: meshes, materials, lights, a camera; readers, writers and procedural scenes.

mod camera;
mod light;
mod material;
mod mesh;

pub use camera::Camera;
pub use light::Light;
pub use material::Material;
pub use mesh::Mesh;

/// A mesh with all that is needed for a picture of it.
#[derive(Debug, Clone)]
pub struct Scene {
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
    /// Linear RGB seen by rays that hit nothing.
    pub background: [f32; 3],
}
