//! What reports of pictures have in common.

use crate::workload::{Structure, Workload};
use indicatif::{HumanBytes, HumanCount};
use serde::Serialize;
use std::path::PathBuf;
use tracer::model::Camera;

/// Of what a picture is.
#[derive(Serialize)]
pub struct Subject {
    scene: String,
    triangles: usize,
    nodes: usize,
    build: &'static str,
    load_ms: f64,
    build_ms: f64,
    pub width: usize,
    pub height: usize,
    camera: String,
}

impl Subject {
    pub fn new(work: &Workload, structure: &Structure, camera: &Camera, [width, height]: [usize; 2]) -> Self {
        Self {
            scene: work.scene.name.clone(),
            triangles: work.scene.mesh.triangles.len(),
            nodes: structure.nodes,
            build: structure.build,
            load_ms: work.load_ms,
            build_ms: structure.build_ms,
            width,
            height,
            camera: camera.to_string(),
        }
    }

    /// Three lines.
    pub fn text(&self) -> String {
        let Self { scene, load_ms, build, build_ms, camera, .. } = self;
        let [triangles, nodes] = [self.triangles, self.nodes].map(|n| HumanCount(n as u64));
        let tree = match self.nodes {
            0 => format!("none, triangles taken apart in {build_ms:.0} ms"),
            _ => format!("{build}, {nodes} nodes, built in {build_ms:.0} ms"),
        };
        format!(
            "\
scene     {scene}, {triangles} triangles, read in {load_ms:.0} ms
tree      {tree}
camera    {camera}
"
        )
    }
}

/// The file that came of it.
#[derive(Serialize)]
pub struct Written {
    pub output: PathBuf,
    pub output_bytes: usize,
}

impl Written {
    /// A line.
    pub fn text(&self) -> String {
        format!("wrote     {}, {}\n", self.output.display(), HumanBytes(self.output_bytes as u64))
    }
}
