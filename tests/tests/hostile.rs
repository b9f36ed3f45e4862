//! Meshes and rays that nobody should send, and somebody will: the same hits by every method at every level, no panic, no end
//! that is not reached.

use simd::Level;
use tests::Random;
use tests::agreement::{Trees, by_brute_force, check, check_watertight};
use tracer::geometry::{Aabb, Hit, HitBatch, Ray, RayBatch};
use tracer::method::BitVec;
use tracer::model::Mesh;
use tracer::{Error, Scene};

/// Numbers for coordinates: finite, of every size.
const COORDINATES: [f32; 20] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    3.0,
    f32::EPSILON,
    1e-3,
    1e6,
    -1e6,
    1e6 + 0.0625,
    1e30,
    -1e30,
    1e-30,
    1e-40,
    -1e-45,
    f32::MIN_POSITIVE,
    1e19,
    f32::MAX,
    f32::MIN,
];

const NOT_NUMBERS: [f32; 4] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -f32::NAN];

/// Kinds of meshes, from tame to wild.
#[derive(Debug, Clone, Copy)]
enum Shape {
    /// Corners anywhere in a cube of this half size.
    Soup(f32),
    /// Corners on a grid of four a side with this distance: shared edges and vertices, flat boxes, degenerate triangles, ties.
    Grid(f32),
    /// All in one axis-aligned plane.
    Flat(usize, f32),
    /// The same triangle again and again.
    Duplicates,
    /// Coordinates of every size.
    Wild,
}

const SHAPES: [Shape; 13] = [
    Shape::Soup(1.0),
    Shape::Soup(1e6),
    Shape::Soup(1e18),
    Shape::Soup(1e30),
    Shape::Soup(1e-20),
    Shape::Soup(1e-38),
    Shape::Grid(1.0),
    Shape::Grid(1e6),
    Shape::Grid(1e30),
    Shape::Flat(0, 1.0),
    Shape::Flat(2, 1e6),
    Shape::Duplicates,
    Shape::Wild,
];

impl Shape {
    fn mesh(self, number: usize, random: &mut Random) -> Mesh {
        let mut mesh = Mesh::default();
        for i in 0..number {
            for corner in 0..3 {
                let p = match self {
                    Self::Soup(size) => {
                        let middle = corner_of_cube(random, size);
                        if i % 2 == 0 { middle } else { near(random, mesh.positions.last(), middle) }
                    }
                    Self::Grid(size) => [0; 3].map(|_| (random.bits() % 4) as f32 * size),
                    Self::Flat(axis, size) => {
                        let mut p = corner_of_cube(random, size);
                        p[axis] = 0.25 * size;
                        p
                    }
                    Self::Duplicates => [[0.0, 0.0, 0.0], [1.0, 0.0, 0.5], [0.0, 1.0, 0.25]][corner],
                    Self::Wild => [0; 3].map(|_| random.pick(&COORDINATES)),
                };
                mesh.positions.push(p);
            }
            let n = 3 * i as u32;
            mesh.triangles.push(if i % 7 == 3 { [n, n + 1, n] } else { [n, n + 1, n + 2] });
            if i % 5 == 0 {
                mesh.triangles.push([n + 2, n, n + 1]);
            }
        }
        mesh
    }
}

fn corner_of_cube(random: &mut Random, size: f32) -> [f32; 3] {
    [0; 3].map(|_| random.between(-size, size))
}

/// A point a thousandth of the way from one to another: small triangles, and slivers.
fn near(random: &mut Random, from: Option<&[f32; 3]>, to: [f32; 3]) -> [f32; 3] {
    let from = from.copied().unwrap_or(to);
    std::array::from_fn(|axis| from[axis] + 1e-3 * random.unit() * (to[axis] - from[axis]))
}

/// A ray that has to do with the mesh, or with nothing.
fn ray(mesh: &Mesh, random: &mut Random) -> Ray {
    let Aabb { min, max } = mesh.bounds();
    let vertex = |random: &mut Random| mesh.positions[random.bits() as usize % mesh.positions.len()];
    let inside =
        |random: &mut Random| std::array::from_fn(|i| min[i] + random.unit() * (0.5 * max[i] - 0.5 * min[i]) * 2.0);
    let axis = |random: &mut Random| {
        let mut d = [0; 3].map(|_| random.pick(&[0.0, -0.0]));
        d[random.bits() as usize % 3] = random.pick(&[1.0, -1.0, 1e-3, -1e30, 1e-40, f32::MAX]);
        d
    };
    let org: [f32; 3] = match random.bits() % 4 {
        0 => vertex(random),
        // On the planes of boxes.
        1 => [vertex(random)[0], vertex(random)[1], vertex(random)[2]],
        2 => inside(random),
        _ => [min, max][random.bits() as usize % 2],
    };
    let to: [f32; 3] = if random.bits().is_multiple_of(2) { vertex(random) } else { middle(mesh, random) };
    let toward: [f32; 3] = std::array::from_fn(|i| to[i] - org[i]);
    let dir = match random.bits() % 8 {
        0 => axis(random),
        1 => toward.map(|d| d * random.pick(&[1e-42, 1e-30, 1e-10, 1e10, 1e30])),
        2 => [0; 3].map(|_| random.pick(&COORDINATES)),
        3 => corner_of_cube(random, 1.0),
        _ => toward,
    };
    let (t_min, t_max) = match random.bits() % 10 {
        0 => (0.5, 1.5),
        1 => (1.0, 1.0),
        2 => (2.0, 1.0),
        3 => (-5.0, random.pick(&[-0.0, 0.0, 1e-45, f32::MAX])),
        4 => (f32::NEG_INFINITY, f32::INFINITY),
        5 => (random.pick(&[f32::INFINITY, 1e30, 1e-45]), f32::INFINITY),
        _ => (0.0, f32::INFINITY),
    };
    let mut ray = Ray { org, t_min, dir, t_max };
    if random.bits().is_multiple_of(16) {
        let number = random.pick(&NOT_NUMBERS);
        match random.bits() % 8 {
            i @ 0..3 => ray.org[i as usize] = number,
            i @ 3..6 => ray.dir[i as usize - 3] = number,
            6 => ray.t_min = number,
            _ => ray.t_max = number,
        }
    }
    ray
}

/// The middle of a triangle, or of one of its edges.
fn middle(mesh: &Mesh, random: &mut Random) -> [f32; 3] {
    let [a, b, c] = mesh.triangle(random.bits() as usize % mesh.triangles.len());
    let third = if random.bits().is_multiple_of(2) { c } else { a };
    std::array::from_fn(|i| a[i] * 0.25 + b[i] * 0.5 + third[i] * 0.25)
}

/// Rays as they come from an eye, so that methods trace many together; some of them spoilt.
fn bundle(mesh: &Mesh, random: &mut Random, width: usize, height: usize) -> RayBatch {
    let first = ray(mesh, random);
    let to: [f32; 3] = std::array::from_fn(|axis| middle(mesh, random)[axis] - first.org[axis]);
    let size = to.iter().fold(0.0_f32, |a, b| a.max(b.abs())) * random.pick(&[1e-6, 1e-3, 0.1, 0.5]);
    let axis = random.bits() as usize % 3;
    let spoil = random.bits().is_multiple_of(2);
    (0..width * height)
        .map(|i| {
            let mut dir = to;
            dir[axis] += size * ((i % width) as f32 / width as f32 - 0.5);
            dir[(axis + 1) % 3] += size * ((i / width) as f32 / height as f32 - 0.5);
            let normal = Ray { org: first.org, dir, ..Ray::new([0.0; 3], [1.0; 3]) };
            if spoil && random.bits().is_multiple_of(32) { ray(mesh, random) } else { normal }
        })
        .collect()
}

/// Meshes and rays from the seeds of these rounds, all methods at all levels.
fn hostile_rounds(rounds: std::ops::Range<u64>) {
    let levels: Vec<Level> = Level::available().collect();
    let (mut rays_in_all, mut found) = (0, 0);
    for round in rounds {
        let mut random = Random(1000 + round);
        let shape = SHAPES[round as usize % SHAPES.len()];
        let number = random.pick(&[1, 2, 5, 40, 120]);
        let mesh = shape.mesh(number, &mut random);
        let trees = [Trees::binned(&mesh), Trees::insertion(&mesh)];
        let single: RayBatch = (0..200).map(|_| ray(&mesh, &mut random)).collect();
        let (picture, strip) = (bundle(&mesh, &mut random, 24, 17), bundle(&mesh, &mut random, 16, 16));
        for (kind, rays) in [("rays", single), ("picture", picture), ("bundle", strip)] {
            let expected = by_brute_force(&mesh, &rays);
            for trees in &trees {
                check(&format!("round {round}, {shape:?} of {number}, {kind}"), trees, &levels, &rays, &expected);
            }
            check_watertight(&format!("round {round}, {shape:?} of {number}, {kind}"), &mesh, &levels, &rays);
            rays_in_all += rays.len();
            found += expected.iter().filter(|hit| !hit.is_miss()).count();
        }
    }
    println!("{rays_in_all} rays, {found} hit: no differing bit");
    assert!(found > rays_in_all / 10, "{found} of {rays_in_all} hit");
}

#[test]
fn every_method_finds_the_same_in_hostile_scenes() {
    hostile_rounds(0..104);
}

/// Some minutes in release.
#[test]
#[ignore = "minutes: with a release build, when geometry or a method changes"]
fn every_method_finds_the_same_in_many_hostile_scenes() {
    hostile_rounds(104..2_000);
}

/// The reciprocal of a determinant that overflows is 0: such a triangle was hit, and where, was not a number.
#[test]
fn a_determinant_that_overflows_is_no_hit() {
    let far = 2.0_f32.powi(40);
    let scene = Scene::builder().triangles(vec![[0.0; 3], [far, 0.0, 0.0], [0.0, far, 0.0]], vec![[0, 1, 2]]);
    let scene = scene.build().expect("a valid mesh");
    let down = |length: f32| Ray::new([0.25 * far, 0.25 * far, far], [0.0, 0.0, -length]);
    let hit = scene.closest(&down(1.0)).expect("a determinant of 1e24");
    assert_eq!((hit.u, hit.v, hit.t), (0.25, 0.25, far));
    assert_eq!(scene.closest(&down(1e15)), None, "a determinant of 1e39");
    assert!(!scene.occluded(&down(1e15)));
}

/// No split plane tells the triangles apart: trees still end, and rays too.
#[test]
fn a_hundred_thousand_equal_centroids() {
    let mut mesh = Mesh::default();
    for i in 0..100_000_u32 {
        // Half are the same triangle, the others larger and larger ones with the same middle of their boxes.
        let size = if i % 2 == 0 { 1.0 } else { 1.0 + (i % 1000) as f32 };
        mesh.positions.extend([[-size, -size, 0.0], [size, -size, 0.0], [0.0, size, 0.0]]);
        mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    let rays: RayBatch = (0..40)
        .map(|i| Ray::new([i as f32 * 20.0 - 300.0, 0.5, 1.0], [0.0, 0.0, if i % 4 == 3 { 1.0 } else { -1.0 }]))
        .collect();
    let expected = by_brute_force(&mesh, &rays);
    assert!(expected.iter().any(|hit| !hit.is_miss()) && expected.iter().any(Hit::is_miss));
    for trees in [Trees::binned(&mesh), Trees::insertion(&mesh)] {
        check("equal centroids", &trees, &[Level::SCALAR, Level::best()], &rays, &expected);
    }
}

/// Intervals: both ends count, an empty one and one of NaN hit nothing.
#[test]
fn ends_of_intervals() {
    let mesh = Mesh {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    let (nan, inf) = (f32::NAN, f32::INFINITY);
    let cases = [
        (2.0, 2.0, true),
        (0.0, 2.0, true),
        (2.0, inf, true),
        (-inf, inf, true),
        (2.0_f32.next_up(), inf, false),
        (0.0, 2.0_f32.next_down(), false),
        (3.0, 1.0, false),
        (inf, -inf, false),
        (inf, inf, false),
        (nan, inf, false),
        (0.0, nan, false),
        (-3.0, -1.0, false),
    ];
    let ray = |t_min, t_max| Ray { t_min, t_max, ..Ray::new([0.25, 0.25, 2.0], [0.0, 0.0, -1.0]) };
    let rays: RayBatch = cases.iter().map(|&(t_min, t_max, _)| ray(t_min, t_max)).collect();
    let expected = by_brute_force(&mesh, &rays);
    for (hit, case) in expected.iter().zip(cases) {
        assert_eq!(!hit.is_miss(), case.2, "{case:?}");
    }
    let levels: Vec<Level> = Level::available().collect();
    check("ends of intervals", &Trees::binned(&mesh), &levels, &rays, &expected);
}

/// Directions of no length hit nothing; denormal components count as zero.
#[test]
fn directions_without_length() {
    let mesh = Mesh {
        positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    let cases = [
        ([0.0, 0.0, 0.0], false),
        ([-0.0, 0.0, -0.0], false),
        ([0.0, 0.0, -1e-40], false),
        ([1e-40, -1e-45, -1.0], true),
        ([0.0, 0.0, -1e-30], true),
        ([0.0, 0.0, f32::MIN / 4.0], true),
        ([0.0, 0.0, f32::NEG_INFINITY], false),
        ([f32::NAN, 0.0, -1.0], false),
    ];
    let rays: RayBatch = cases.iter().map(|&(dir, _)| Ray::new([0.25, 0.25, 2.0], dir)).collect();
    let expected = by_brute_force(&mesh, &rays);
    for (hit, case) in expected.iter().zip(cases) {
        assert_eq!(!hit.is_miss(), case.1, "{case:?}");
    }
    let levels: Vec<Level> = Level::available().collect();
    check("directions", &Trees::binned(&mesh), &levels, &rays, &expected);
}

/// A scene whose triangles are all degenerate has no tree, and is otherwise as any other.
#[test]
fn nothing_that_can_be_hit() {
    let scene = Scene::builder().triangles(vec![[0.0; 3], [1.0; 3]], vec![[0, 1, 0], [1, 1, 1]]).build();
    let scene = scene.expect("degenerate is allowed");
    let rays: RayBatch = (0..100).map(|i| Ray::new([0.0; 3], [1.0, i as f32 * 0.01, 1.0])).collect();
    let (mut hits, mut occluded) = (HitBatch::new(), BitVec::new());
    scene.closest_batch(&rays, &mut hits);
    scene.occluded_batch(&rays, &mut occluded);
    assert!(hits.len() == 100 && hits.iter().all(|hit| hit.is_miss()) && occluded.count_ones() == 0);
    assert!(scene.closest(&rays.get(0)).is_none() && !scene.occluded(&rays.get(0)));
}

/// What cannot be traced is an error before anything is built.
#[test]
fn meshes_that_are_refused() {
    let good = || (vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
    for number in NOT_NUMBERS {
        for at in 0..9 {
            let (mut positions, triangles) = good();
            positions[at / 3][at % 3] = number;
            let result = Scene::builder().triangles(positions, triangles).build();
            assert!(matches!(result, Err(Error::Geometry(_))), "{number} at {at}");
        }
    }
    for index in [3, 1 << 31, u32::MAX] {
        let (positions, _) = good();
        let result = Scene::builder().triangles(positions, vec![[0, 1, index]]).build();
        assert!(matches!(result, Err(Error::Geometry(_))), "{index}");
    }
    for (positions, triangles) in [(vec![], vec![]), (good().0, vec![]), (vec![], good().1)] {
        assert!(matches!(Scene::builder().triangles(positions, triangles).build(), Err(Error::Geometry(_))));
    }
}

/// A batch that was emptied is as a new one: what it remembers of its rays was once a reason to look at them.
#[test]
fn a_cleared_batch() {
    let scene = Scene::builder().triangles(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
    let scene = scene.build().expect("a valid mesh");
    let ray = Ray::new([0.25, 0.25, 2.0], [0.0, 0.0, -1.0]);
    let mut rays: RayBatch = [ray; 40].into_iter().collect();
    let (mut hits, mut occluded) = (HitBatch::new(), BitVec::new());
    scene.closest_batch(&rays, &mut hits);
    assert!(hits.len() == 40 && !hits.get(39).is_miss());
    rays.clear();
    assert_eq!(rays.origin(), None);
    scene.closest_batch(&rays, &mut hits);
    scene.occluded_batch(&rays, &mut occluded);
    assert!(hits.is_empty() && occluded.is_empty());
    rays.extend([ray]);
    scene.closest_batch(&rays, &mut hits);
    assert!(hits.len() == 1 && !hits.get(0).is_miss());
}
