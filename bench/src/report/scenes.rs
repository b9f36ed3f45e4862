//! The papers' scenes, or what is nearest to them, each with a view of it.

use crate::console::Console;
use tracer::Error;
use tracer::model::{Camera, Model, builtin, obj};

/// A scene, how it is seen, and what it is.
pub struct View {
    pub model: Model,
    pub camera: Camera,
    pub label: &'static str,
}

impl View {
    /// A line for the report.
    pub fn describe(&self) -> String {
        format!("{} triangles, {}; camera {}", self.model.mesh.triangles.len(), self.label, self.camera)
    }
}

/// The conference room; none when its file is missing, which is said on standard output.
pub fn conference(console: &Console) -> Result<Option<View>, Error> {
    let Some(model) = file("conference", console)? else { return Ok(None) };
    let camera = view([6.9742, 8.7685, 4.6396], [0.7818, 0.5406, -0.3107], [0.0, 0.0, 1.0], 73.74);
    let label = "the LBL conference room (Anat Grynberg and Greg Ward), as the paper's of 282 k";
    Ok(Some(View { model, camera, label }))
}

/// Crytek's Sponza; none when its file is missing.
pub fn sponza(console: &Console) -> Result<Option<View>, Error> {
    let Some(model) = file("crytek_sponza", console)? else { return Ok(None) };
    let camera = view([-60.96, 86.0, 10.16], [0.826, -0.438, -0.356], [0.0, 1.0, 0.0], 43.6);
    Ok(Some(View { model, camera, label: "Crytek's atrium in place of Dabrovic's of 76 k" }))
}

/// In place of the Fairy Forest.
pub fn fairy() -> Result<Option<View>, Error> {
    let camera = view([4.5, 0.4, 2.0], [-4.5, -0.4, -0.5], [0.0, 0.0, 1.0], 45.0);
    let label = "a stand-in for the paper's Fairy of 174 k, which is not to be had: the built-in scene tree:9, open and of uneven depth";
    Ok(Some(View { model: made("tree:9")?, camera, label }))
}

/// In place of Laine's Hairball: all of it, or few of its hairs.
pub fn hairball(small: bool) -> Result<Option<View>, Error> {
    let (name, label) = if small {
        ("hairball:100", "a few hairs of the built-in hairball")
    } else {
        ("hairball", "the built-in hairball, a stand-in for Samuli Laine's of 2.88 M")
    };
    let model = made(name)?;
    Ok(Some(View { camera: model.camera_or_default(), model, label }))
}

fn file(name: &str, console: &Console) -> Result<Option<Model>, Error> {
    tests::real_scene(name).map(|path| Ok(obj::read(&path, console)?.0)).transpose()
}

fn made(name: &str) -> Result<Model, Error> {
    builtin(name).unwrap_or_else(|| Err(Error::Usage(format!("there is no built-in scene {name}"))))
}

fn view(eye: [f32; 3], forward: [f32; 3], up: [f32; 3], fov: f32) -> Camera {
    Camera { eye, at: [eye[0] + forward[0], eye[1] + forward[1], eye[2] + forward[2]], up, fov }
}
