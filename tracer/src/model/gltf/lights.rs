//! Lights and the camera.

use super::graph::{Affine, Graph};
use super::{Notes, named};
use crate::geometry::Aabb;
use crate::model::vec3::{add, length, narrow, normalize, scale, sub, wide};
use crate::model::{Camera, Light};
use gltf::camera::Projection;
use gltf::khr_lights_punctual::Kind;
use std::f64::consts::PI;

/// How far away, in radii of the scene, what is infinitely far stands here.
const FAR: f64 = 100.0;

/// All lights of a scene that fills this box. An irradiance of pi is an intensity of one.
pub(super) fn lights(graph: &Graph<'_>, bounds: &Aabb, notes: &mut Notes<'_>) -> Vec<Light> {
    let center = scale(add(wide(bounds.min), wide(bounds.max)), 0.5);
    let radius = 0.5 * length(sub(wide(bounds.max), wide(bounds.min)));
    let mut lights = Vec::new();
    for (node, place) in &graph.0 {
        let Some(light) = node.light() else { continue };
        let what = named("light", light.index(), light.name());
        let origin = place.0[3];
        let from_center = length(sub(origin, center)).max(1e-3 * radius);
        let (position, distance) = match light.kind() {
            Kind::Directional => (add(center, scale(axis(place, 2), FAR * radius)), 1.0),
            Kind::Point => {
                notes.warn(&format!(
                    "{what}: its light does not fall off here, it is everywhere as in the middle of the scene"
                ));
                (origin, from_center)
            }
            Kind::Spot { .. } => {
                notes.warn(&format!(
                    "{what}: spot lights are not supported, it shines to all sides and does not fall off"
                ));
                (origin, from_center)
            }
        };
        let irradiance = f64::from(light.intensity()) / (distance * distance);
        let intensity = light.color().map(|c| (f64::from(c) * irradiance / PI) as f32);
        let light = Light { position: narrow(position), intensity };
        if light.position.iter().chain(&light.intensity).all(|x| x.is_finite()) && intensity.iter().all(|&c| c >= 0.0) {
            lights.push(light);
        } else {
            notes.warn(&format!("{what}: its place or intensity is not acceptable ({light:?}): passed over"));
        }
    }
    lights
}

/// The first perspective camera.
pub(super) fn camera(graph: &Graph<'_>, notes: &mut Notes<'_>) -> Option<Camera> {
    for (node, place) in &graph.0 {
        let Some(camera) = node.camera() else { continue };
        let what = named("camera", camera.index(), camera.name());
        let Projection::Perspective(perspective) = camera.projection() else {
            notes.warn(&format!("{what}: only perspective cameras are supported, passed over"));
            continue;
        };
        let eye = place.0[3];
        let camera = Camera {
            eye: narrow(eye),
            at: narrow(sub(eye, scale(axis(place, 2), ahead(eye)))),
            up: narrow(axis(place, 1)),
            fov: f64::from(perspective.yfov()).to_degrees() as f32,
        };
        match camera.validate() {
            Ok(()) => return Some(camera),
            Err(e) => notes.warn(&format!("{what}: {e}: passed over")),
        }
    }
    None
}

/// How far ahead a camera looks: so that the direction survives rounding.
fn ahead(eye: [f64; 3]) -> f64 {
    1.0 + length(eye)
}

/// The direction of an axis of a node.
fn axis(place: &Affine, k: usize) -> [f64; 3] {
    normalize(place.0[k])
}
