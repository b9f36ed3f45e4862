//! The real scenes: that they load whole, and what is in them.

use tests::real_scene;
use tracer::geometry::Aabb;
use tracer::model::{Mesh, Model, obj};
use tracer::progress::Silent;

/// Loads a scene without a warning; none when it is not there.
fn load(name: &str) -> Option<Model> {
    let path = real_scene(name)?;
    let (scene, warnings) = obj::read(&path, &Silent).unwrap_or_else(|e| panic!("{e}"));
    assert!(warnings.is_empty(), "{warnings:?}");
    scene.validate().expect("what is read is valid");
    assert_eq!(scene.name, name);
    Some(scene)
}

fn material_of(scene: &Model, triangle: usize) -> &str {
    &scene.materials[scene.mesh.material(triangle) as usize].name
}

fn inside(scene: &Model) -> bool {
    let camera = scene.camera_or_default();
    camera.validate().expect("a sound camera");
    scene.mesh.bounds().contains(&Aabb { min: camera.eye, max: camera.eye })
}

#[test]
fn conference() {
    let Some(scene) = load("conference") else { return };
    assert_eq!(scene.mesh.triangles.len(), 283_142);
    assert_eq!(scene.mesh.positions.len(), 170_503);
    assert!(scene.mesh.normals.is_empty());
    assert_eq!(scene.materials.len(), 41);
    assert_eq!(material_of(&scene, 0), "alpha_mat");
    let arm = scene.materials.iter().find(|m| m.name == "arm_mat").expect("its library has it");
    assert_eq!((arm.diffuse, arm.specular, arm.shininess), ([0.48, 0.236, 0.121], [0.05; 3], 200.0));
    assert!(inside(&scene), "a room is seen from inside");
    assert_eq!(scene.camera_or_default().up, [0.0, 0.0, 1.0], "its height is along z");
}

#[test]
fn crytek_sponza() {
    let Some(scene) = load("crytek_sponza") else { return };
    let mesh = &scene.mesh;
    assert_eq!(mesh.triangles.len(), 262_205);
    assert_eq!(mesh.normal_indices.len(), 262_205);
    let square = |n: &[f32; 3]| n.iter().map(|x| x * x).sum::<f32>();
    assert!(mesh.normals.iter().all(|n| (square(n) - 1.0).abs() < 1e-5));
    assert!(mesh.normal_indices.iter().filter(|n| **n == Mesh::FLAT).count() < 100);
    assert_eq!(material_of(&scene, 0), "Material__25");
    assert!(inside(&scene), "the atrium is seen from inside");
}

#[test]
fn country_kitchen() {
    let Some(scene) = load("country_kitchen") else { return };
    assert_eq!(scene.mesh.triangles.len(), 1_443_107);
    assert_eq!(scene.mesh.positions.len(), 729_874);
    assert_eq!(material_of(&scene, 0), "BlindEnds");
    assert!(inside(&scene), "a room is seen from inside");
}
