//! Hits are exact by construction: every level, width, number of threads, builder and form of the slab test finds the same
//! bits, and they are those of a loop over all triangles.

use simd::{Isa, Level};
use tests::{Random, brute_force, real_scene};
use tracer::bvh::{BuildConfig, Bvh, CollapseConfig};
use tracer::geometry::{Aabb, Hit, HitBatch, Ray, RayBatch, Triangle};
use tracer::method::{Auto, BitVec, Context, Method, Order, Packet, SharedOrigin, Single, SlabForm, Width};
use tracer::model::{Mesh, Model, builtin};
use tracer::progress::Silent;
use tracer::render::{EyeRays, Frame, Settings, Surfaces};

const WIDTHS: [Width; 4] = [Width::One, Width::Four, Width::Eight, Width::Sixteen];

fn closest(method: &dyn Method, rays: &RayBatch) -> HitBatch {
    let mut hits = HitBatch::new();
    method.closest(rays, &mut hits, &mut Context::default()).expect("not cancelled");
    hits
}

fn any(method: &dyn Method, rays: &RayBatch) -> BitVec {
    let mut occluded = BitVec::new();
    method.any(rays, &mut occluded, &mut Context::default()).expect("not cancelled");
    occluded
}

fn bits(hit: Hit) -> [u32; 4] {
    [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive]
}

fn assert_same(hits: &HitBatch, expected: &HitBatch, rays: &RayBatch, what: &str) {
    assert_eq!(hits.len(), expected.len(), "{what}");
    for (i, (hit, expected)) in hits.iter().zip(expected.iter()).enumerate() {
        assert_eq!(bits(hit), bits(expected), "{what}: ray {i} {:?}: {hit:?}, expected {expected:?}", rays.get(i));
    }
}

fn check_method(method: &dyn Method, rays: &RayBatch, expected: &HitBatch, what: &str) {
    assert_same(&closest(method, rays), expected, rays, what);
    let occluded = any(method, rays);
    for (i, hit) in expected.iter().enumerate() {
        assert_eq!(occluded.get(i), !hit.is_miss(), "{what}: any, ray {i} {:?}", rays.get(i));
    }
}

/// All levels x widths x forms of the box test, and single rays through wide trees, then thread counts, against the single-ray walk; that against brute force on `checked`
/// rays spread over the batch. Returns how many rays hit.
fn check(name: &str, mesh: &Mesh, trees: &[(&str, Bvh)], rays: &RayBatch, checked: usize) -> usize {
    let expected = closest(&Packet::new(&trees[0].1, Level::SCALAR, Width::One), rays);
    let triangles: Vec<Triangle> = brute_force::triangles(mesh);
    let step = (rays.len() / checked).max(1);
    for i in (0..rays.len()).step_by(step) {
        let brute = brute_force::closest(&rays.get(i), &triangles);
        assert_eq!(bits(expected.get(i)), bits(brute), "{name}: ray {i} {:?}, brute force {brute:?}", rays.get(i));
    }
    for (tree, bvh) in trees {
        for level in Level::available() {
            for width in WIDTHS {
                for (form, shared) in [
                    (SlabForm::Exact, SharedOrigin::Never),
                    (SlabForm::Exact, SharedOrigin::Always),
                    (SlabForm::Conservative, SharedOrigin::Auto),
                ] {
                    let what =
                        format!("{name}, {tree} tree, {level}, width {width}, {form:?}, shared origin {shared:?}");
                    let method = Packet::new(bvh, level, width).with_form(form).with_shared_origin(shared);
                    check_method(&method, rays, &expected, &what);
                }
                let method = Packet::new(bvh, level, width).with_order(Order::NearFirst);
                check_method(
                    &method,
                    rays,
                    &expected,
                    &format!("{name}, {tree} tree, {level}, width {width}, near first"),
                );
            }
        }
        let config = CollapseConfig::default();
        let (four, eight, sixteen) = (bvh.collapse(&config), bvh.collapse(&config), bvh.collapse(&config));
        for level in Level::available() {
            let what = |n: usize| format!("{name}, {tree} tree of {n} children, {level}, single rays");
            check_method(&Single::<4>::new(&four, level), rays, &expected, &what(4));
            check_method(&Single::<8>::new(&eight, level), rays, &expected, &what(8));
            check_method(&Single::<16>::new(&sixteen, level), rays, &expected, &what(16));
            check_method(&Auto::new(&eight, level), rays, &expected, &format!("{name}, {tree} tree, {level}, auto"));
        }
    }
    // WebAssembly has none.
    let threads: &[usize] = if cfg!(target_family = "wasm") { &[] } else { &[2, 3] };
    for &threads in threads {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let hits = pool.install(|| closest(&Packet::new(&trees[0].1, Level::best(), Width::Auto), rays));
        assert_same(&hits, &expected, rays, &format!("{name}, {threads} threads"));
    }
    let hits = expected.iter().filter(|h| !h.is_miss()).count();
    println!(
        "{name}: {} rays, {hits} hit, {} against brute force: no differing bit",
        rays.len(),
        rays.len().div_ceil(step)
    );
    hits
}

fn levels_line() {
    let names = |run: bool| {
        let levels = Isa::ALL.into_iter().filter(|&isa| Level::new(isa).is_some() == run);
        levels.map(Isa::name).collect::<Vec<_>>().join(", ")
    };
    println!("levels run: {}; levels missing on this CPU: {}", names(true), names(false));
}

/// A tree from every builder.
fn trees(mesh: &Mesh) -> Vec<(&'static str, Bvh)> {
    let configs = [
        ("medium", BuildConfig::medium()),
        ("fast", BuildConfig::fast()),
        ("high", BuildConfig::high()),
        ("insertion", BuildConfig::insertion(7)),
    ];
    configs.map(|(name, config)| (name, Bvh::build(mesh, &config, &Silent).expect("a valid mesh"))).into()
}

/// Rays from everywhere to everywhere; some axis-parallel, some starting on a vertex, some with unusual numbers.
fn incoherent(mesh: &Mesh, number: usize, seed: u64) -> RayBatch {
    let Aabb { min, max } = mesh.bounds();
    let mut random = Random(seed);
    let inside = |random: &mut Random| std::array::from_fn(|i| random.between(min[i], max[i]));
    (0..number)
        .map(|i| {
            let org: [f32; 3] = inside(&mut random);
            let to: [f32; 3] = inside(&mut random);
            let dir = std::array::from_fn(|k| to[k] - org[k]);
            let vertex = mesh.positions[random.bits() as usize % mesh.positions.len()];
            match i % 8 {
                0 => Ray::new(vertex, dir),
                1 => Ray::new(org, std::array::from_fn(|k| vertex[k] - org[k])),
                2 => {
                    Ray::new(org, random.pick(&[[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [-0.0, 0.0, 1.0], [0.0, 1.0, -1.0]]))
                }
                3 => Ray { t_min: random.unit(), t_max: random.between(0.0, 1.5), ..Ray::new(org, dir) },
                4 => Ray::new(org, dir.map(|d| d * 1e-3)),
                5 => unusual(&mut random, Ray::new(org, dir)),
                _ => Ray::new(org, dir),
            }
        })
        .collect()
}

/// One number of the ray replaced by a special one.
fn unusual(random: &mut Random, mut ray: Ray) -> Ray {
    let specials = [0.0, -0.0, 1e-40, -1e-42, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, 1e-30, -1.0];
    let special = random.pick(&specials);
    match random.bits() % 8 {
        axis @ 0..3 => ray.org[axis as usize] = special,
        axis @ 3..6 => ray.dir[axis as usize - 3] = special,
        6 => ray.t_min = special,
        _ => ray.t_max = special,
    }
    ray
}

fn eye_rays(scene: &Model, size: usize) -> EyeRays {
    EyeRays::new(&scene.camera_or_default(), size, size, Level::best(), Width::Auto)
}

fn check_scene(name: &str, scene: &Model, size: usize, number: usize, checked: usize) {
    levels_line();
    let trees = trees(&scene.mesh);
    let eye = eye_rays(scene, size);
    assert!(eye.rays().origin().is_some());
    assert!(check(&format!("{name}, eye rays"), &scene.mesh, &trees, eye.rays(), checked) > 0);
    check_pictures(name, scene);
    let rays = incoherent(&scene.mesh, number, 1);
    assert!(check(&format!("{name}, incoherent rays"), &scene.mesh, &trees, &rays, checked) > 0);
}

/// Rays as others generate them, by [`Auto`]: pictures row by row, of widths that blocks of sixteen and tiles do and do not
/// divide, and from what they hit to a light.
fn check_pictures(name: &str, scene: &Model) {
    let binned = Bvh::build(&scene.mesh, &BuildConfig::default(), &Silent).expect("a valid mesh");
    let wide = binned.collapse(&CollapseConfig::default());
    let Aabb { min, max } = scene.mesh.bounds();
    let light: [f32; 3] = std::array::from_fn(|axis| min[axis] + [0.4, 0.55, 0.9][axis] * (max[axis] - min[axis]));
    for (width, height) in [(64, 48), (100, 33), (75, 40)] {
        let eye = EyeRays::new(&scene.camera_or_default(), width, height, Level::best(), Width::Auto);
        let pixels = eye.by_rows();
        let reference = Packet::new(&binned, Level::SCALAR, Width::One);
        let hits = closest(&reference, &pixels);
        let shadow: RayBatch = (pixels.iter().zip(hits.iter()).filter(|(_, hit)| !hit.is_miss()))
            .map(|(ray, hit)| {
                let org: [f32; 3] = std::array::from_fn(|axis| ray.org[axis] + hit.t * ray.dir[axis]);
                let dir = std::array::from_fn(|axis| light[axis] - org[axis]);
                Ray { t_min: 1e-4, t_max: 0.999, ..Ray::new(org, dir) }
            })
            .collect();
        let shadow_hits = closest(&reference, &shadow);
        for level in Level::available() {
            let auto = Auto::new(&wide, level);
            check_method(&auto, &pixels, &hits, &format!("{name}, {width} x {height} pixels, {level}"));
            check_method(&auto, &shadow, &shadow_hits, &format!("{name}, {width} x {height} shadow rays, {level}"));
        }
    }
}

fn check_builtin(spec: &str) {
    let scene = builtin(spec).expect("a built-in scene").expect("a possible size");
    check_scene(spec, &scene, 64, 4_000, 1_000);
}

#[test]
fn balls_are_exact() {
    check_builtin("balls:2");
}

#[test]
fn rings_are_exact() {
    check_builtin("rings:2");
}

#[test]
fn trees_are_exact() {
    check_builtin("tree:5");
}

fn check_real(name: &str) {
    let Some(path) = real_scene(name) else { return };
    let (scene, _) = Model::open(&path.to_string_lossy(), &Silent).expect("a readable scene");
    check_scene(name, &scene, 64, 2_000, 50);
}

#[test]
fn conference_is_exact() {
    check_real("conference");
}

#[test]
fn crytek_sponza_is_exact() {
    check_real("crytek_sponza");
}

/// Flat boxes, shared edges, duplicates, degenerate triangles and huge coordinates: where a box test or a tie goes wrong first.
#[test]
fn awkward_meshes_are_exact() {
    let mut random = Random(3);
    for round in 0..40 {
        let scale = random.pick(&[1.0, 1e-3, 1e3, 1e6]);
        let grid = |random: &mut Random| (random.bits() % 4) as f32 * scale;
        let mut mesh = Mesh::default();
        for i in 0..60 {
            let flat = grid(&mut random);
            let axis = (random.bits() % 3) as usize;
            for _ in 0..3 {
                let mut p: [f32; 3] = std::array::from_fn(|_| grid(&mut random));
                if i % 2 == 0 {
                    p[axis] = flat;
                }
                mesh.positions.push(p);
            }
            mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
            if i % 5 == 0 {
                mesh.triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
            }
        }
        let trees = trees(&mesh);
        let rays = incoherent(&mesh, 200, round);
        check(&format!("awkward mesh {round}"), &mesh, &trees, &rays, 200);
    }
}

/// The wall that a ray parallel to it lies in, an origin on a slab, a zero direction component: no NaN and no lost hit.
#[test]
fn flat_floor_is_hit_straight_and_slanted() {
    let mesh = Mesh {
        positions: vec![[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    };
    let bvh = Bvh::build(&mesh, &BuildConfig::default(), &Silent).expect("a valid mesh");
    let rays: RayBatch = [
        Ray::new([0.25, 1.0, -0.5], [0.0, -1.0, 0.0]),
        Ray::new([0.25, 1.0, -0.5], [-0.0, -2.0, -0.0]),
        Ray::new([0.0, 3.0, 0.0], [0.1, -3.0, 0.1]),
        // In the plane of the floor: its determinant is zero.
        Ray::new([-2.0, 0.0, 0.0], [1.0, 0.0, 0.0]),
        // Along the diagonal that both triangles share: the lower id wins.
        Ray::new([0.5, 1.0, 0.5], [0.0, -1.0, 0.0]),
        Ray::new([0.25, -1.0, -0.5], [0.0, -1.0, 0.0]),
    ]
    .into_iter()
    .collect();
    for level in Level::available() {
        for width in WIDTHS {
            let hits = closest(&Packet::new(&bvh, level, width), &rays);
            let found: Vec<_> = hits.iter().map(|h| (h.t, h.primitive)).collect();
            let miss = (f32::INFINITY, Hit::NO_PRIMITIVE);
            assert_eq!(found, [(1.0, 0), (0.5, 0), (1.0, 0), miss, (1.0, 0), miss], "{level}, width {width}");
        }
    }
}

/// The same numbers on every processor: what a picture of a small scene hashes to, hits and colours.
#[test]
fn golden_picture_is_the_same_on_every_machine() {
    let scene = builtin("balls:2").expect("a built-in scene").expect("a possible size");
    let bvh = Bvh::build(&scene.mesh, &BuildConfig::default(), &Silent).expect("a valid mesh");
    let surfaces = Surfaces::new(&scene);
    for level in Level::available() {
        let settings = Settings { width: 64, height: 48, level, lanes: Width::Auto, shadows: true };
        let mut frame = Frame::new(&scene, &surfaces, scene.camera_or_default(), settings);
        let mut cx = Context::default();
        frame.eye_rays();
        frame.cast(&Packet::new(&bvh, level, Width::Auto), &mut cx).expect("not cancelled");
        let image = frame.shade(&cx).expect("not cancelled");
        assert_eq!((frame.hits().hash(), image.hash()), (0x9f19_534b_a7fe_9741, 0x564f_2a5b_7686_371a), "{level}");
    }
}

#[test]
fn no_rays_and_no_tree_are_fine() {
    let bvh = Bvh { nodes: Vec::new(), triangles: Vec::new() };
    let method = Packet::new(&bvh, Level::best(), Width::Auto);
    assert!(closest(&method, &RayBatch::new()).is_empty());
    let one: RayBatch = [Ray::new([0.0; 3], [1.0, 0.0, 0.0])].into_iter().collect();
    assert_eq!(closest(&method, &one).get(0), Hit::MISS);
    assert_eq!(any(&method, &one).count_ones(), 0);
    let wide = bvh.collapse(&CollapseConfig::default());
    let method = Single::<8>::new(&wide, Level::best());
    assert!(closest(&method, &RayBatch::new()).is_empty());
    assert_eq!(closest(&method, &one).get(0), Hit::MISS);
    assert_eq!(any(&method, &one).count_ones(), 0);
}

#[test]
fn a_raised_flag_cancels() {
    let scene = builtin("balls:1").expect("a built-in scene").expect("a possible size");
    let bvh = Bvh::build(&scene.mesh, &BuildConfig::default(), &Silent).expect("a valid mesh");
    let flag = std::sync::atomic::AtomicBool::new(true);
    let mut cx = Context { cancel: Some(&flag), ..Context::default() };
    let eye = eye_rays(&scene, 32);
    let result = Packet::new(&bvh, Level::best(), Width::Auto).closest(eye.rays(), &mut HitBatch::new(), &mut cx);
    assert!(matches!(result, Err(tracer::Error::Cancelled)));
}
