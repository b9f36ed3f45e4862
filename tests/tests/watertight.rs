//! Closed surfaces shot at from inside, at random and exactly at edges and vertices: with the watertight test no ray gets out.

use simd::Level;
use std::collections::HashMap;
use tests::Random;
use tests::agreement::check_watertight;
use tracer::geometry::{HitBatch, Ray, RayBatch};
use tracer::method::{Context, Method};
use tracer::model::Mesh;
use tracer::{Error, Scene};

/// A surface around the points of a box, which has every point in sight or not, but never an opening.
struct Closed {
    name: &'static str,
    mesh: Mesh,
    /// Middle and half size of a box inside.
    inside: ([f32; 3], f32),
}

fn normalize(p: [f64; 3]) -> [f64; 3] {
    let length = p.iter().map(|x| x * x).sum::<f64>().sqrt();
    p.map(|x| x / length)
}

/// An octahedron whose triangles are cut into four again and again, its vertices moved to the unit sphere.
fn sphere(rounds: usize) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let mut points: Vec<[f64; 3]> = Vec::new();
    for axis in 0..3 {
        for sign in [1.0, -1.0] {
            let mut p = [0.0; 3];
            p[axis] = sign;
            points.push(p);
        }
    }
    let mut triangles: Vec<[u32; 3]> = (0..8).map(|i: u32| [i & 1, 2 + (i >> 1 & 1), 4 + (i >> 2 & 1)]).collect();
    for _ in 0..rounds {
        let mut middles = HashMap::new();
        let mut next = Vec::new();
        for [a, b, c] in triangles {
            let mut middle = |a: u32, b: u32| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    let (p, q) = (points[a as usize], points[b as usize]);
                    points.push(normalize([p[0] + q[0], p[1] + q[1], p[2] + q[2]]));
                    points.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            next.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = next;
    }
    (points, triangles)
}

/// A cube whose edges are cut into many pieces (a power of two, for faces to have the same points on their edge); each face is a fan of slivers around a point next to one of its corners.
fn slivers(pieces: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let mut index = HashMap::new();
    let mut vertex = |p: [f32; 3]| {
        *index.entry(p.map(f32::to_bits)).or_insert_with(|| {
            mesh.positions.push(p);
            mesh.positions.len() as u32 - 1
        })
    };
    let mut triangles = Vec::new();
    for (axis, side) in (0..3).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
        let point = |a: f32, b: f32| {
            let mut p = [0.0; 3];
            (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (side, a, b);
            p
        };
        let step = |i: u32| i as f32 / pieces as f32 * 2.0 - 1.0;
        let mut rim: Vec<u32> = Vec::new();
        for i in 0..pieces {
            rim.push(vertex(point(step(i), -1.0)));
        }
        for i in 0..pieces {
            rim.push(vertex(point(1.0, step(i))));
        }
        for i in 0..pieces {
            rim.push(vertex(point(-step(i), 1.0)));
        }
        for i in 0..pieces {
            rim.push(vertex(point(-1.0, -step(i))));
        }
        let hub = vertex(point(0.97, 0.93));
        for (i, &a) in rim.iter().enumerate() {
            triangles.push([a, rim[(i + 1) % rim.len()], hub]);
        }
    }
    mesh.triangles = triangles;
    mesh
}

fn surfaces() -> Vec<Closed> {
    let (points, triangles) = sphere(6);
    let mesh = |f: &dyn Fn([f64; 3]) -> [f64; 3]| Mesh {
        positions: points.iter().map(|&p| f(p).map(|x| x as f32)).collect(),
        triangles: triangles.clone(),
        ..Mesh::default()
    };
    let blob = |p: [f64; 3]| {
        let [x, y, z] = p.map(|x| x * 9.0);
        let r = 1.0 + 0.2 * x.sin() * y.cos() + 0.1 * (3.0 * z).sin() * (2.0 * x).cos() + 0.05 * (7.0 * y).sin();
        p.map(|x| x * r)
    };
    vec![
        Closed { name: "sphere", mesh: mesh(&|p| p), inside: ([0.0; 3], 0.5) },
        Closed {
            name: "sphere far from zero",
            mesh: mesh(&|p| [p[0] + 1000.0, p[1] - 300.0, p[2] + 0.1]),
            inside: ([1000.0, -300.0, 0.1], 0.5),
        },
        Closed { name: "blob", mesh: mesh(&blob), inside: ([0.0; 3], 0.3) },
        Closed { name: "tiny blob", mesh: mesh(&|p| blob(p).map(|x| 1e-12 * x)), inside: ([0.0; 3], 3e-13) },
        Closed { name: "huge blob", mesh: mesh(&|p| blob(p).map(|x| 1e12 * x)), inside: ([0.0; 3], 3e11) },
        Closed { name: "slivers", mesh: slivers(1024), inside: ([0.0; 3], 0.9) },
    ]
}

/// Rays from inside: at random, at a vertex, at a point of an edge, and along an axis at a vertex.
fn rays(closed: &Closed, number: usize, seed: u64) -> RayBatch {
    let mut random = Random(seed);
    let (middle, size) = closed.inside;
    (0..number)
        .map(|i| {
            let org: [f32; 3] = std::array::from_fn(|axis| middle[axis] + random.between(-size, size));
            let triangle = closed.mesh.triangle((random.bits() % closed.mesh.triangles.len() as u64) as usize);
            let [a, b] = [triangle[0], triangle[1 + i / 4 % 2]];
            let anywhere = random.unit();
            let along = random.pick(&[0.5, anywhere, 0.25, 1e-3]);
            let to = |p: [f32; 3]| std::array::from_fn(|axis| p[axis] - org[axis]);
            match i % 4 {
                0 => Ray::new(org, [0; 3].map(|_| random.between(-1.0, 1.0))),
                1 => Ray::new(org, to(a)),
                2 => Ray::new(org, to(std::array::from_fn(|axis| a[axis] + along * (b[axis] - a[axis])))),
                _ => {
                    let axis = random.bits() as usize % 3;
                    let mut from = a;
                    from[axis] = middle[axis];
                    let inside = (0..3).all(|k| (from[k] - middle[k]).abs() <= size);
                    let mut dir = [0.0; 3];
                    dir[axis] = random.pick(&[1.0, -1.0]);
                    Ray::new(if inside { from } else { org }, dir)
                }
            }
        })
        .collect()
}

fn closest(method: &dyn Method, rays: &RayBatch) -> HitBatch {
    let mut hits = HitBatch::new();
    method.closest(rays, &mut hits, &mut Context::default()).expect("not cancelled");
    hits
}

/// How many of each kind of ray hit nothing.
fn leaks(method: &dyn Method, rays: &RayBatch) -> [usize; 4] {
    let mut leaks = [0; 4];
    for (i, _) in closest(method, rays).iter().enumerate().filter(|(_, hit)| hit.is_miss()) {
        leaks[i % 4] += 1;
    }
    leaks
}

fn add(a: [usize; 4], b: [usize; 4]) -> [usize; 4] {
    std::array::from_fn(|i| a[i] + b[i])
}

/// Shoots batches of rays in each surface, and prints how many got out of the watertight scene (none) and of the usual one: at random,
/// aimed at a vertex, at an edge, along an axis at a vertex.
fn shoot(batches: u64, number: usize) {
    let (mut all, mut usual_leaks) = (0, [0; 4]);
    for closed in surfaces() {
        let watertight = Scene::builder().mesh(closed.mesh.clone()).watertight(true).build().expect("a valid mesh");
        let usual = Scene::builder().mesh(closed.mesh.clone()).build().expect("a valid mesh");
        let method = watertight.watertight().expect("asked for");
        let (mut ours, mut theirs) = ([0; 4], [0; 4]);
        for seed in 0..batches {
            let rays = rays(&closed, number, seed);
            ours = add(ours, leaks(&method, &rays));
            theirs = add(theirs, leaks(&usual.method(), &rays));
        }
        let shot = number * batches as usize;
        println!("{}: {shot} rays, leaks: watertight {ours:?}, usual {theirs:?}", closed.name);
        assert_eq!(ours, [0; 4], "{}: leaks", closed.name);
        all += shot;
        usual_leaks = add(usual_leaks, theirs);
    }
    println!("{all} rays, leaks: watertight none, usual {usual_leaks:?}");
    assert!(usual_leaks[1] > 0 && usual_leaks[2] > 0, "if the usual test leaked nothing, this would prove nothing");
}

#[test]
fn no_ray_in_a_million_gets_out() {
    shoot(1, 1_000_000 / 6 + 1);
}

/// Minutes in release.
#[test]
#[ignore = "four minutes: with a release build, when boxes or the watertight test change"]
fn no_ray_in_a_hundred_million_gets_out() {
    shoot(50, 100_000_000 / 6 / 50 + 1);
}

/// Where the usual test is sure of itself, it finds the same triangle at the same place.
#[test]
fn agrees_with_the_usual_test_on_random_rays() {
    // Of the tiny one the usual test has the determinant in few bits, or not at all.
    for closed in surfaces().into_iter().filter(|closed| closed.name != "tiny blob") {
        let watertight = Scene::builder().mesh(closed.mesh.clone()).watertight(true).build().expect("a valid mesh");
        let usual = Scene::builder().mesh(closed.mesh.clone()).build().expect("a valid mesh");
        let rays: RayBatch = rays(&closed, 40_000, 99).iter().step_by(4).collect();
        let (mut a, mut b, mut same, mut both) = (HitBatch::new(), HitBatch::new(), 0, 0);
        watertight.closest_batch(&rays, &mut a);
        usual.closest_batch(&rays, &mut b);
        let tolerance = if closed.name == "slivers" { 1e-4 } else { 1e-5 };
        let size = closed.inside.1 / closed.inside.0.map(f32::abs).into_iter().fold(closed.inside.1, f32::max);
        for (i, (a, b)) in a.iter().zip(b.iter()).enumerate().filter(|(_, (_, b))| !b.is_miss()) {
            both += 1;
            same += usize::from(a.primitive == b.primitive);
            // Vertices far from zero are coarse.
            let near = |x: f32, y: f32, scale: f32| (x - y).abs() <= scale * tolerance / size;
            assert!(near(a.t, b.t, b.t.abs()), "{}, ray {i}: {a:?} {b:?}", closed.name);
            if a.primitive == b.primitive && closed.name.ends_with("blob") {
                assert!(near(a.u, b.u, 100.0) && near(a.v, b.v, 100.0), "{}, ray {i}: {a:?} {b:?}", closed.name);
            }
        }
        println!("{}: {both} rays hit, {same} the same triangle", closed.name);
        assert!(both as f32 >= 0.999 * rays.len() as f32 && same as f32 >= 0.99 * both as f32);
    }
}

/// Every level, every tree, one ray or a batch.
#[test]
fn the_same_bits_everywhere() {
    let levels: Vec<Level> = Level::available().collect();
    for closed in surfaces() {
        let rays = rays(&closed, 2000, 7);
        check_watertight(closed.name, &closed.mesh, &levels, &rays);
    }
}

/// A triangle between three points of a line, as cutting an edge leaves them, has no area, but rounding shears its points apart: its
/// neighbours do not cover what it covers then.
#[test]
fn a_triangle_without_area_keeps_its_place() {
    let [a, b, m] = [[-0.7, -0.3, 1.0], [0.8, 0.4, 1.0], [0.05, 0.05, 1.0]];
    let positions = vec![a, b, m, [-1.0, 3.0, 1.0], [1.0, -3.0, 1.0]];
    // Above the line one triangle from end to end, below it two; between them the one without area.
    let triangles = vec![[0, 1, 3], [0, 2, 4], [2, 1, 4], [0, 1, 2]];
    let scene = Scene::builder().triangles(positions, triangles).watertight(true).build().expect("a valid mesh");
    let mut random = Random(5);
    for i in 0..20_000 {
        let org = [random.between(-0.1, 0.1), random.between(-0.1, 0.1), random.between(-1.0, 0.5)];
        let (p, along) = (if i % 2 == 0 { a } else { m }, random.unit());
        let dir = std::array::from_fn(|k| p[k] + along * 0.99 * (b[k] - p[k]) - org[k]);
        assert!(scene.occluded(&Ray::new(org, dir)), "{org:?} {dir:?}");
    }
}

/// Two halves of a floor that meet in a long straight line: rounding far away turns the line a little, out of both boxes.
#[test]
fn long_edges_along_boxes() {
    let x = [-5.0, 0.1, 5.0].map(|x| [[x, 0.0, -1000.0], [x, 0.0, 1000.0]]);
    let triangles = vec![[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 5]];
    let scene = Scene::builder().triangles(x.as_flattened().to_vec(), triangles).watertight(true).build();
    let scene = scene.expect("a valid mesh");
    let mut random = Random(21);
    for _ in 0..100_000 {
        let org = [random.between(-1.0, 1.0), random.between(0.1, 1.0), random.between(-1.0, 1.0)];
        let to = [0.1 + random.between(-2e-5, 2e-5), 0.0, org[2] + random.between(1.5, 8.0)];
        let ray = Ray::new(org, std::array::from_fn(|k| to[k] - org[k]));
        assert!(scene.occluded(&ray), "{ray:?}");
    }
}

/// From far away at the middle of a surface: the farther, the wider the boxes.
#[test]
fn origins_may_be_far_away() {
    let (points, triangles) = sphere(5);
    let positions: Vec<[f32; 3]> = points.iter().map(|p| p.map(|x| x as f32)).collect();
    let mesh = Mesh { positions, triangles, ..Mesh::default() };
    let scene = Scene::builder().mesh(mesh.clone()).watertight(true).build().expect("a valid mesh");
    let mut random = Random(11);
    for distance in [2.0, 1e2, 1e4, 1e6] {
        for _ in 0..20_000 {
            let vertex = mesh.positions[random.bits() as usize % mesh.positions.len()];
            let org: [f32; 3] = std::array::from_fn(|k| distance * vertex[k] + random.between(-0.3, 0.3));
            let ray = Ray::new(org, std::array::from_fn(|k| vertex[k] - org[k]));
            assert!(scene.occluded(&ray), "from {distance}: {ray:?}");
        }
    }
}

#[test]
fn a_watertight_scene_cannot_be_saved() {
    let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let scene = Scene::builder().triangles(corners, vec![[0, 1, 2]]).watertight(true).build().expect("a valid mesh");
    let path = std::env::temp_dir().join("no-such-folder").join("a.scene");
    assert!(matches!(scene.save(&path), Err(Error::Usage(_))));
}
