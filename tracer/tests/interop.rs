//! Conversions to and from other crates' types, both ways.

#![allow(unused_imports, reason = "each feature uses its part")]

use tracer::Scene;
use tracer::geometry::{Aabb, Ray};
use tracer::model::Mesh;

#[cfg(feature = "glam")]
#[test]
fn glam() {
    use glam::{Affine3A, Quat, Vec3};
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
    let mesh = Mesh::from((&corners[..], &[[0, 1, 2]][..]));
    let scene = Scene::builder().mesh(mesh).build().expect("a valid mesh");
    let (org, dir) = (Vec3::new(0.25, 0.25, 2.0), Vec3::new(-0.0, 0.0, -1.0));
    let ray = Ray::from((org, dir));
    assert_eq!(scene.closest(&ray).map(|hit| (hit.t, hit.primitive)), Some((2.0, 0)));
    assert_eq!((ray.t_min, ray.t_max), (0.0, f32::INFINITY));
    let back: (Vec3, Vec3) = ray.into();
    assert_eq!(back, (org, dir));
    let bounds: (Vec3, Vec3) = scene.bounds().into();
    assert_eq!(bounds, (Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0)));
    assert_eq!(Aabb::from(bounds), scene.bounds());

    let turn = Affine3A::from_scale_rotation_translation(Vec3::new(1.0, 2.0, 3.0), Quat::from_rotation_x(0.5), dir);
    let rows = tracer::interop::glam::rows(&turn);
    let p = [0.3, -0.7, 1.1_f32];
    for (row, expected) in rows.iter().zip(turn.transform_point3(p.into()).to_array()) {
        let sum: f32 = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
        assert!((sum - expected).abs() < 1e-6, "{rows:?}");
    }
    assert_eq!(tracer::interop::glam::from_rows(&rows), turn);
}

#[cfg(feature = "mint")]
#[test]
fn mint() {
    use mint::{Point3, RowMatrix3x4, Vector3};
    let corners: [Point3<f32>; 3] = [[0.0, 0.0, 0.0].into(), [1.0, 0.0, 0.0].into(), [0.0, 1.0, 0.0].into()];
    let mesh = Mesh::from((&corners[..], &[[0, 1, 2]][..]));
    let scene = Scene::builder().mesh(mesh).build().expect("a valid mesh");
    let (org, dir) = (Point3::from([0.25, 0.25, 2.0]), Vector3::from([0.0, 0.0, -1.0]));
    let ray = Ray::from((org, dir));
    assert_eq!(scene.closest(&ray).map(|hit| (hit.t, hit.primitive)), Some((2.0, 0)));
    let back: (Point3<f32>, Vector3<f32>) = ray.into();
    assert_eq!(back, (org, dir));
    let bounds: (Point3<f32>, Point3<f32>) = scene.bounds().into();
    assert_eq!(bounds.1, Point3::from([1.0, 1.0, 0.0]));
    assert_eq!(Aabb::from(bounds), scene.bounds());

    let rows = [[1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0], [9.0, 10.0, 11.0, 12.0_f32]];
    assert_eq!(<[[f32; 4]; 3]>::from(RowMatrix3x4::from(rows)), rows);
}
