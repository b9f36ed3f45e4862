//! Pictures with secondary rays: the same bits at every level and width, by every method, on any number of threads; and light where theory
//! says how much there is.

use simd::Level;
use std::sync::Arc;
use std::time::Duration;
use tracer::bvh::{BuildConfig, Bvh, CollapseConfig};
use tracer::method::{Auto, Context, Method, Order, Packet, Single, Width};
use tracer::model::{Camera, Light, Material, Mesh, Model, Reflection, Texture, builtin};
use tracer::progress::Silent;
use tracer::render::integrator::{self, Config, Crop, Film, Identity, Integrator, Means, Path, Query, Rendering};
use tracer::render::{Frame, Scenery, Settings, Surfaces};

/// A scene of quadrilaterals.
struct Quads {
    mesh: Mesh,
    materials: Vec<Material>,
}

impl Quads {
    fn new() -> Self {
        Self { mesh: Mesh::default(), materials: Vec::new() }
    }

    /// A parallelogram, counter-clockwise from its front.
    fn add(&mut self, corner: [f32; 3], e1: [f32; 3], e2: [f32; 3], material: Material) {
        let first = self.mesh.positions.len() as u32;
        let at = |s: f32, t: f32| std::array::from_fn(|k| corner[k] + s * e1[k] + t * e2[k]);
        self.mesh.positions.extend([at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]);
        self.mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        self.mesh.materials.extend([self.materials.len() as u32; 2]);
        self.materials.push(material);
    }

    /// The six walls of the cube from -1 to 1.
    fn room(&mut self, material: impl Fn(usize) -> Material) {
        for wall in 0..6 {
            let (axis, side) = (wall / 2, (wall % 2) as f32 * 2.0 - 1.0);
            let (mut corner, mut e1, mut e2) = ([-1.0; 3], [0.0; 3], [0.0; 3]);
            corner[axis] = side;
            e1[(axis + 1) % 3] = 2.0;
            e2[(axis + 2) % 3] = 2.0;
            self.add(corner, e1, e2, material(wall));
        }
    }

    fn model(self) -> Model {
        let Self { mesh, materials } = self;
        let camera = Camera { eye: [0.1, -0.9, 0.2], at: [0.0, 1.0, 0.0], up: [0.0, 0.0, 1.0], fov: 80.0 };
        let (lights, name) = (vec![], "quads".into());
        Model { name, mesh, materials, lights, camera: Some(camera), ambient: 0.0, background: [0.0; 3] }
    }
}

/// A room with a lamp, balls of every material in it and a point light.
fn mixed() -> Model {
    let wall = |i: usize| match i {
        0 => Material::matt("red", [0.7, 0.1, 0.1]),
        1 => {
            Material { specular: [0.04; 3], shininess: 30.0, reflection: Reflection::Glossy, ..Material::grey("satin") }
        }
        _ => Material::grey("wall"),
    };
    let mut quads = Quads::new();
    quads.room(wall);
    let lamp = Material { emission: [12.0, 11.0, 9.0], ..Material::matt("lamp", [0.0; 3]) };
    quads.add([-0.3, -0.3, 0.6], [0.0, 0.6, 0.0], [0.6, 0.0, 0.0], lamp);
    let mut model = quads.model();
    let ball = builtin("balls:0").expect("a name").expect("a size").mesh;
    // Before these come the two triangles of the ground.
    let triangles = 2..ball.triangles.len();
    for (i, reflection) in
        [Reflection::Lambertian, Reflection::Glossy, Reflection::Mirror, Reflection::Dielectric].into_iter().enumerate()
    {
        let place = [-0.6 + 0.4 * i as f32, 0.3 - 0.2 * (i % 2) as f32, -0.7];
        let vertices = model.mesh.positions.len() as u32;
        let normals = model.mesh.normals.len() as u32;
        model.mesh.normal_indices.resize(model.mesh.triangles.len(), Mesh::FLAT);
        model.mesh.positions.extend(ball.positions.iter().map(|p| [0, 1, 2].map(|k| place[k] + 0.35 * p[k])));
        model.mesh.normals.extend(&ball.normals);
        let third = ball.triangles[triangles.clone()].iter().map(|t| t.map(|v| v + vertices));
        model.mesh.triangles.extend(third);
        let normal_indices = ball.normal_indices[triangles.clone()].iter().map(|t| t.map(|n| n + normals));
        model.mesh.normal_indices.extend(normal_indices);
        model.mesh.materials.resize(model.mesh.triangles.len(), model.materials.len() as u32);
        let specular = if reflection == Reflection::Mirror { [0.8; 3] } else { [0.1; 3] };
        let surface = Material { specular, shininess: 50.0, reflection, ..Material::matt("ball", [0.15, 0.5, 0.3]) };
        model.materials.push(surface);
    }
    model.lights = vec![Light { position: [0.8, -0.8, 0.8], intensity: [0.3; 3] }];
    model
}

fn path(path: Path) -> Integrator {
    Integrator::Path(path)
}

fn render_by(model: &Model, config: &Config, method: &dyn Method) -> Rendering {
    render_in(model, &Scenery::new(model, &model.camera_or_default()), config, method)
}

fn render_in(model: &Model, scenery: &Scenery, config: &Config, method: &dyn Method) -> Rendering {
    let camera = model.camera_or_default();
    let means = Means { method, cx: &mut Context::default(), observer: None, progress: &Silent };
    integrator::render(model, scenery, camera, config, means).expect("not cancelled")
}

fn render(model: &Model, config: &Config) -> Rendering {
    model.validate().expect("sound");
    let bvh = Bvh::build(&model.mesh, &BuildConfig::default(), &Silent).expect("a tree");
    let tree = bvh.collapse::<8>(&CollapseConfig::default());
    render_by(model, config, &Auto::new(&tree, Level::best()))
}

/// Mean of the green channel over the picture, and its standard deviation.
fn mean(r: &Rendering) -> (f64, f64) {
    let n = r.image.pixels.len() as f64;
    let sum: f64 = r.image.pixels.iter().map(|p| f64::from(p[1])).sum();
    let variance: f64 = r.variance.iter().map(|&v| f64::from(v)).sum();
    (sum / n, variance.sqrt() / n)
}

const ALL: [Integrator; 4] = [
    Integrator::Path(Path { bounces: 4, roulette: true, mis: true, coat_alone: false }),
    Integrator::Path(Path { bounces: 3, roulette: false, mis: false, coat_alone: true }),
    Integrator::Whitted { bounces: 4 },
    Integrator::AmbientOcclusion { distance: 0.5 },
];

/// Hashes of the four pictures, the same on every machine.
const HASHES: [u64; 4] = [0xfa49_87c7_12f9_4ad1, 0x7f62_a07e_2998_4dce, 0xa035_e1f2_f21d_1329, 0x71b1_bfe8_265e_e478];

/// Hashes of the first and the third picture with textures.
const TEXTURED: [u64; 2] = [0xbb8c_1fcf_c5b3_b20d, 0xdcb9_bdec_0fb4_c197];

#[test]
fn same_bits_by_every_means() {
    let found = same_bits(&mixed(), &ALL);
    assert_eq!(found, HASHES, "other pictures than before: {found:#018x?}");
}

/// Textures on walls, on a glossy and on a mirroring ball; the ceiling and a ball have none.
fn textured() -> Model {
    let mut model = mixed();
    let mesh = &mut model.mesh;
    mesh.uvs = mesh.positions.iter().map(|p| [1.7 * p[0] + p[2] + 0.2, 0.9 * p[1] - 2.0 * p[2]]).collect();
    mesh.uv_indices = mesh.triangles.clone();
    mesh.uv_indices[3] = Mesh::FLAT;
    let image = |name: &str, width: usize, height: usize| {
        let byte = |i: usize, k: usize| ((i + 1) * (37 + 50 * k) % 256) as u8;
        let pixels: Vec<_> = (0..width * height).map(|i| [0, 1, 2].map(|k| byte(i, k))).collect();
        Some(Arc::new(Texture::new(name, width, height, &pixels).expect("an image")))
    };
    let (large, small) = (image("large", 13, 7), image("small", 1, 2));
    for (i, material) in model.materials.iter_mut().enumerate() {
        if i != 5 && material.emission == [0.0; 3] && material.reflection != Reflection::Dielectric {
            material.texture.clone_from(if i % 3 == 0 { &small } else { &large });
            material.texture_on_specular = material.reflection == Reflection::Mirror;
        }
    }
    model
}

#[test]
fn same_bits_with_textures() {
    let model = textured();
    let found = same_bits(&model, &[ALL[0], ALL[2]]);
    assert_eq!(found, TEXTURED, "other pictures than before: {found:#018x?}");

    let bvh = Bvh::build(&model.mesh, &BuildConfig::default(), &Silent).expect("a tree");
    let surfaces = Surfaces::new(&model);
    let camera = model.camera_or_default();
    let picture = |level, lanes| {
        let settings = Settings { width: 37, height: 22, level, lanes, shadows: true };
        let method = Packet::new(&bvh, level, Width::Auto);
        let image = tracer::render::render(&model, &surfaces, camera, settings, &method, &mut Context::default());
        image.expect("not cancelled").hash()
    };
    let expected = picture(Level::SCALAR, Width::One);
    for level in Level::available() {
        assert_eq!(picture(level, Width::Auto), expected, "{level}");
    }
    let plain = Model { materials: mixed().materials, ..model.clone() };
    assert_ne!(render(&plain, &Config::new(37, 22)).image.hash(), render(&model, &Config::new(37, 22)).image.hash());
}

/// An image of one colour is that colour.
#[test]
fn an_image_of_one_colour() {
    let of = |model: &Model| render(model, &Config { integrator: ALL[0], samples: 4, ..Config::new(30, 20) }).image;
    let mut model = textured();
    // Together with its diffuse colour no more than all light, which would be scaled down.
    model.materials.iter_mut().filter(|m| m.texture_on_specular).for_each(|m| m.specular = [0.4; 3]);
    let image = Arc::new(Texture::new("grey", 2, 2, &[[188; 3]; 4]).expect("an image"));
    let grey = ((188.0 / 255.0 + 0.055) / 1.055_f64).powf(2.4) as f32;
    let mut plain = model.clone();
    model.mesh.uv_indices[3] = model.mesh.triangles[3];
    for (textured, plain) in model.materials.iter_mut().zip(&mut plain.materials) {
        if textured.texture.replace(image.clone()).is_some() {
            plain.diffuse = plain.diffuse.map(|c| c * grey);
            if plain.texture_on_specular {
                plain.specular = plain.specular.map(|c| c * grey);
            }
        } else {
            textured.texture = None;
        }
        plain.texture = None;
    }
    for (a, b) in of(&model).pixels.as_flattened().iter().zip(of(&plain).pixels.as_flattened()) {
        assert!((a - b).abs() < 1e-4 * b.max(1e-2), "{a} {b}");
    }
}

fn same_bits(model: &Model, integrators: &[Integrator]) -> Vec<u64> {
    model.validate().expect("sound");
    let bvh = Bvh::build(&model.mesh, &BuildConfig::default(), &Silent).expect("a tree");
    let config = CollapseConfig::default();
    let (four, eight) = (bvh.collapse::<4>(&config), bvh.collapse::<8>(&config));
    let pictures = integrators.iter().map(|&integrator| {
        let usual = Config { integrator, samples: 2, seed: 3, ..Config::new(37, 22) };
        let expected = render_by(model, &usual, &Single::new(&four, Level::SCALAR)).image.hash();
        let check = |what: &str, config: &Config, method: &dyn Method| {
            let rendering = render_by(model, config, method);
            let hash = rendering.image.hash();
            assert_eq!(hash, expected, "{integrator:?}, {what}: {hash:#018x}");
            assert!(rendering.image.pixels.as_flattened().iter().all(|c| c.is_finite() && *c >= 0.0));
        };
        for level in Level::available() {
            for lanes in [Width::Auto, Width::One] {
                for group_shading in [true, false] {
                    let config = Config { level, lanes, group_shading, ..usual };
                    let method = Auto::new(&eight, level);
                    check(&format!("{level}, {lanes} lanes, grouped {group_shading}"), &config, &method);
                }
            }
            for width in [Width::One, Width::Four, Width::Eight, Width::Sixteen] {
                let packet = Packet::new(&bvh, level, width);
                check(&format!("packets of {width} at {level}"), &usual, &packet);
                check(&format!("ordered, {width}"), &usual, &packet.with_order(Order::NearFirst));
            }
            check("single rays", &usual, &Single::new(&four, level));
        }
        for threads in [1, 2, 5] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let method = Auto::new(&eight, Level::best());
            pool.install(|| check(&format!("{threads} threads"), &usual, &method));
        }
        for batch in [1, 100] {
            check(&format!("batches of {batch}"), &Config { batch, ..usual }, &Auto::new(&eight, Level::best()));
        }
        expected
    });
    pictures.collect()
}

/// Interrupted again and again, kept in a file each time, with other batches: the bits of a picture made at once.
#[test]
fn resumed_pictures_are_the_same() {
    let model = mixed();
    let bvh = Bvh::build(&model.mesh, &BuildConfig::default(), &Silent).expect("a tree");
    let method = Packet::new(&bvh, Level::best(), Width::Auto);
    let camera = model.camera_or_default();
    let scenery = Scenery::new(&model, &camera);
    let folder = std::env::temp_dir().join(format!("tracer-checkpoint-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("film");
    let crop = Some(Crop { x: 3, y: 2, width: 30, height: 19 });
    for integrator in ALL {
        let config = Config { integrator, samples: 5, seed: 9, crop, count_rays: true, ..Config::new(37, 22) };
        let whole = render_in(&model, &scenery, &config, &method);
        let identity = Identity::new(&model, &scenery, &camera, &config);
        Film::new(&config).save(&path, &identity).expect("written");
        let mut interruptions = 0;
        let again = loop {
            let mut film = Film::load(&path, &identity, &config).expect("its own");
            let before = film.done();
            let config = Config { batch: [100, 1000, 37][interruptions % 3], ..config };
            let means = Means { method: &method, cx: &mut Context::default(), observer: None, progress: &Silent };
            let mut after = |film: &Film| match film.done() < before + 700 {
                true => Ok(()),
                false => Err(tracer::Error::Cancelled),
            };
            match integrator::resume(&scenery, camera, &config, means, &mut film, &mut after) {
                Ok(rendering) => break rendering,
                Err(e) => assert!(matches!(e, tracer::Error::Cancelled), "{e}"),
            }
            film.save(&path, &identity).expect("written");
            interruptions += 1;
        };
        assert!(interruptions >= 3, "{interruptions}");
        assert_eq!(again.image.hash(), whole.image.hash(), "{integrator:?}");
        assert_eq!((again.samples, again.variance, again.rays), (5, whole.variance, whole.rays), "{integrator:?}");
    }
    std::fs::remove_dir_all(&folder).expect("removed");
}

/// Rays of each pixel: all that were traced, and those of a part are those of the whole.
#[test]
fn rays_of_each_pixel() {
    let model = mixed();
    for integrator in ALL {
        let config = Config { integrator, samples: 3, count_rays: true, ..Config::new(37, 22) };
        let whole = render(&model, &config);
        assert_eq!(whole.rays.iter().map(|&n| u64::from(n)).sum::<u64>(), whole.times.rays());
        assert!(whole.rays.iter().all(|&n| n >= 3));
        let crop = Some(Crop { x: 5, y: 6, width: 7, height: 8 });
        let part = render(&model, &Config { crop, batch: 13, ..config });
        for (i, &rays) in part.rays.iter().enumerate() {
            assert_eq!(rays, whole.rays[(6 + i / 7) * 37 + 5 + i % 7], "{integrator:?}");
        }
        assert!(render(&model, &Config { count_rays: false, ..config }).rays.is_empty());
    }
}

/// A part of a picture is just that, and another seed another picture.
#[test]
fn crops_and_seeds() {
    let model = mixed();
    let config = Config { samples: 3, ..Config::new(40, 30) };
    let whole = render(&model, &config).image;
    let crop = Crop { x: 7, y: 11, width: 21, height: 13 };
    let part = render(&model, &Config { crop: Some(crop), ..config }).image;
    assert_eq!((part.width, part.height), (21, 13));
    for y in 0..13 {
        for x in 0..21 {
            assert_eq!(part.pixels[y * 21 + x], whole.pixels[(y + 11) * 40 + x + 7]);
        }
    }
    assert_ne!(render(&model, &Config { seed: 1, ..config }).image.hash(), whole.hash());
}

/// Several rays of a pixel at once, and several lights: their light is added up in the same order, whichever rays of other pixels are around them.
#[test]
fn parts_of_glass() {
    let mut model = mixed();
    model.lights.push(Light { position: [-0.7, -0.8, 0.5], intensity: [0.2, 0.3, 0.1] });
    for material in model.materials.iter_mut().filter(|m| m.name == "ball") {
        material.reflection = Reflection::Dielectric;
    }
    let config = Config { integrator: Integrator::Whitted { bounces: 5 }, samples: 2, ..Config::new(90, 70) };
    let whole = render(&model, &config).image;
    let crop = Crop { x: 7, y: 11, width: 71, height: 53 };
    for batch in [1 << 20, 1500, 37] {
        let part = render(&model, &Config { crop: Some(crop), batch, ..config }).image;
        for (y, row) in part.pixels.chunks(71).enumerate() {
            assert_eq!(row, &whole.pixels[(y + 11) * 90 + 7..][..71], "row {y}, batches of {batch}");
        }
    }
}

/// A limit of time ends it after a whole sample.
#[test]
fn time_limit() {
    let model = mixed();
    let config = Config { samples: u32::MAX, time_limit: Some(Duration::from_millis(30)), ..Config::new(16, 12) };
    let rendering = render(&model, &config);
    assert!(rendering.samples > 1 && rendering.samples < u32::MAX);
    let again = render(&model, &Config { samples: rendering.samples, time_limit: None, ..config });
    assert_eq!(again.image.hash(), rendering.image.hash());
}

/// In a room whose walls shine and reflect alike everything is as bright: 1 + r + r^2 + ... up to the light of the last hit.
#[test]
fn white_room() {
    let mut quads = Quads::new();
    let albedo = 0.5;
    quads.room(|_| Material { emission: [1.0; 3], ..Material::matt("wall", [albedo; 3]) });
    let model = quads.model();
    for (bounces, roulette, mis) in
        [(0, false, false), (1, false, false), (4, false, false), (1, false, true), (4, false, true), (30, true, true)]
    {
        let integrator = path(Path { bounces, roulette, mis, coat_alone: false });
        let rendering = render(&model, &Config { integrator, samples: 256, ..Config::new(24, 24) });
        let expected: f64 = (0..bounces + 2).map(|k| f64::from(albedo).powi(k as i32)).sum();
        let (mean, sigma) = mean(&rendering);
        let off = (mean - expected).abs();
        assert!(
            off < 4.0 * sigma + 2e-5 && sigma < 0.01 * expected,
            "{bounces} {roulette} {mis}: {mean} +- {sigma}, not {expected}"
        );
    }
}

/// A ball in light from all around: matt, as bright as its albedo; of glass, invisible; no surface brighter than the light.
#[test]
fn furnace() {
    let mut model = builtin("balls:0").expect("a name").expect("a size");
    // Without the ground.
    model.mesh.triangles.drain(..2);
    model.mesh.normal_indices.clear();
    model.mesh.materials.clear();
    model.lights.clear();
    model.background = [1.0; 3];
    let camera = Camera { eye: [0.0, -8.0, 0.0], at: [0.0; 3], up: [0.0, 0.0, 1.0], fov: 3.0 };
    model.camera = Some(camera);
    let dark = vec![Light { position: [0.0; 3], intensity: [0.0; 3] }];
    model.lights = dark;
    let mut with = |reflection, diffuse: f32, specular: f32| {
        let surface =
            Material { specular: [specular; 3], shininess: 20.0, reflection, ..Material::matt("ball", [diffuse; 3]) };
        model.materials = vec![surface];
        let integrator = path(Path { bounces: 40, ..Path::default() });
        mean(&render(&model, &Config { integrator, samples: 64, ..Config::new(16, 16) }))
    };
    let (matt, _) = with(Reflection::Lambertian, 0.8, 0.0);
    assert!((matt - 0.8).abs() < 1e-5, "{matt}");
    let (mirror, _) = with(Reflection::Mirror, 0.0, 0.9);
    assert!((mirror - 0.9).abs() < 1e-5, "{mirror}");
    let (glass, _) = with(Reflection::Dielectric, 0.0, 0.0);
    // A few paths never leave it.
    assert!((glass - 1.0).abs() < 1e-3, "{glass}");
    for specular in [0.04, 0.5, 1.0] {
        let (glossy, sigma) = with(Reflection::Glossy, 1.0, specular);
        assert!(glossy < 1.0 + 4.0 * sigma && glossy > 0.8, "{specular}: {glossy} +- {sigma}");
    }
}

/// Under the middle of a square lamp: its radiance times the albedo times the form factor (Howell, A Catalog of Radiation Heat Transfer
/// Configuration Factors, B-3).
#[test]
fn light_of_a_square_lamp() {
    let mut quads = Quads::new();
    quads.add([-5.0, -5.0, 0.0], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0], Material::matt("floor", [0.6; 3]));
    let lamp = Material { emission: [3.0; 3], ..Material::matt("lamp", [0.0; 3]) };
    quads.add([-0.5, -0.5, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], lamp);
    let mut model = quads.model();
    model.camera = Some(Camera { eye: [2.0, 0.0, 0.8], at: [0.0; 3], up: [0.0, 0.0, 1.0], fov: 0.1 });
    let x = 0.5_f64;
    let side = (1.0 + x * x).sqrt();
    let factor = 4.0 / std::f64::consts::TAU * 2.0 * (x / side * (x / side).atan());
    let expected = 3.0 * 0.6 * factor;
    for (mis, whitted) in [(false, false), (true, false), (false, true)] {
        let by_path = path(Path { bounces: 1, mis, ..Path::default() });
        let integrator = if whitted { Integrator::Whitted { bounces: 1 } } else { by_path };
        let (mean, sigma) = mean(&render(&model, &Config { integrator, samples: 256, ..Config::new(8, 8) }));
        assert!((mean - expected).abs() < 4.0 * sigma + 1e-4, "{mean} +- {sigma}, not {expected}");
        assert!(sigma < 0.01 * expected);
    }
}

/// Light found by choosing lights alone, by both ways weighted, and with paths that end by chance: the same mean.
#[test]
fn all_ways_agree() {
    let mut model = mixed();
    // A mirror sees lamps as highlights: what both ways see differs by design.
    model.materials.iter_mut().for_each(|m| m.shininess = 10.0);
    let means = [(false, false), (true, false), (true, true)].map(|(mis, roulette)| {
        let integrator = path(Path { bounces: 6, roulette, mis, coat_alone: false });
        mean(&render(&model, &Config { integrator, samples: 256, ..Config::new(32, 24) }))
    });
    for (other, sigma) in &means[1..] {
        let both = (sigma * sigma + means[0].1 * means[0].1).sqrt();
        assert!((other - means[0].0).abs() < 4.0 * both, "{means:?}");
        assert!(both < 0.02 * other);
    }
}

/// Matt surfaces under point lights look as in the picture of three passes.
#[test]
fn whitted_is_the_picture_of_three_passes_where_all_is_matt() {
    let mut model = builtin("balls:1").expect("a name").expect("a size");
    model.materials.iter_mut().for_each(|m| (m.specular, m.reflection) = ([0.0; 3], Reflection::Lambertian));
    let bvh = Bvh::build(&model.mesh, &BuildConfig::default(), &Silent).expect("a tree");
    let method = Packet::new(&bvh, Level::best(), Width::Auto);
    let integrator = Integrator::Whitted { bounces: 3 };
    let whitted = render_by(&model, &Config { integrator, ..Config::new(64, 64) }, &method).image;
    let settings = Settings { width: 64, height: 64, level: Level::best(), lanes: Width::Auto, shadows: true };
    let surfaces = Surfaces::new(&model);
    let mut frame = Frame::new(&model, &surfaces, model.camera_or_default(), settings);
    let mut cx = Context::default();
    frame.eye_rays();
    frame.cast(&method, &mut cx).expect("not cancelled");
    let eye = frame.shade(&cx).expect("not cancelled");
    let close = |(a, b): (&f32, &f32)| (a - b).abs() < 1e-4;
    let pairs = whitted.pixels.as_flattened().iter().zip(eye.pixels.as_flattened());
    let same = pairs.filter(|&pair| close(pair)).count();
    // Edges of shadows and of the balls' smooth normals may fall otherwise.
    assert!(same > 3 * 64 * 64 * 98 / 100, "{same} of {}", 3 * 64 * 64);

    let eye_again = Config { integrator: Integrator::Eye { shadows: true }, ..Config::new(64, 64) };
    assert_eq!(render_by(&model, &eye_again, &method).image.hash(), eye.hash());
}

#[test]
fn ambient_occlusion_of_a_plane_and_of_a_room() {
    let config =
        |distance| Config { integrator: Integrator::AmbientOcclusion { distance }, samples: 4, ..Config::new(20, 20) };
    let mut plane = Quads::new();
    plane.add([-5.0, 0.5, -5.0], [10.0, 0.0, 0.0], [0.0, 0.0, 10.0], Material::grey("wall"));
    let plane = plane.model();
    assert!(render(&plane, &config(f32::INFINITY)).image.pixels.iter().all(|p| *p == [1.0; 3]));
    let mut room = Quads::new();
    room.room(|_| Material::grey("wall"));
    let room = room.model();
    assert!(render(&room, &config(f32::INFINITY)).image.pixels.iter().all(|p| *p == [0.0; 3]));
    let (near, _) = mean(&render(&room, &config(0.1)));
    assert!(near > 0.8 && near < 1.0, "{near}");
}

/// Two bounces are one level of eye rays, two of reflected rays and three of shadow rays; whoever looks on sees them all.
#[test]
fn rays_of_each_bounce() {
    let mut quads = Quads::new();
    quads.room(|i| Material { emission: [if i == 5 { 1.0 } else { 0.0 }; 3], ..Material::grey("wall") });
    let model = quads.model();
    let bvh = Bvh::build(&model.mesh, &BuildConfig::default(), &Silent).expect("a tree");
    let method = Packet::new(&bvh, Level::best(), Width::Auto);
    let camera = model.camera_or_default();
    let scenery = Scenery::new(&model, &camera);
    let config = Config { samples: 2, ..Config::new(30, 20) };
    let mut seen = Vec::new();
    let mut observer = |depth: usize, query: Query, rays: &tracer::geometry::RayBatch| {
        seen.push((depth, query == Query::Any, rays.len() as u64));
    };
    let means =
        Means { method: &method, cx: &mut Context::default(), observer: Some(&mut observer), progress: &Silent };
    let times = integrator::render(&model, &scenery, camera, &config, means).expect("not cancelled").times;
    assert_eq!(times.bounces.len(), 3);
    for (depth, bounce) in times.bounces.iter().enumerate() {
        let of = |any| seen.iter().filter(|s| s.0 == depth && s.1 == any).map(|s| s.2).sum::<u64>();
        assert_eq!((of(false), of(true)), (bounce.closest, bounce.any), "{seen:?}");
        // No ray is lost in a closed room, and but those to lights below the horizon all are asked for.
        assert!(bounce.closest >= 1199 && bounce.any > 600, "{times:?}");
    }
    assert_eq!(times.bounces[0].closest, 1200);
    assert!(times.traversal.as_nanos() > 0 && times.shading.as_nanos() > 0 && times.rays() > 5000);
}

#[test]
fn what_makes_no_sense_is_refused() {
    let model = mixed();
    let bvh = Bvh::build(&model.mesh, &BuildConfig::default(), &Silent).expect("a tree");
    let method = Packet::new(&bvh, Level::best(), Width::Auto);
    let camera = model.camera_or_default();
    let scenery = Scenery::new(&model, &camera);
    let usual = Config::new(10, 10);
    let eye = Config { integrator: Integrator::Eye { shadows: true }, ..usual };
    let counted = Config { count_rays: true, ..usual };
    for (config, film, reason) in [
        (eye, usual, "made at once"),
        (usual, Config::new(11, 10), "another picture"),
        (counted, usual, "does not count rays"),
    ] {
        let means = Means { method: &method, cx: &mut Context::default(), observer: None, progress: &Silent };
        let mut film = Film::new(&film);
        let error = integrator::resume(&scenery, camera, &config, means, &mut film, &mut |_| Ok(())).expect_err(reason);
        assert!(error.to_string().contains(reason), "{error}");
    }
    let crop = |x, y, width, height| Some(Crop { x, y, width, height });
    for (config, reason) in [
        (Config { samples: 0, ..usual }, "at least one sample"),
        (Config { width: 0, ..usual }, "0x10 pixels"),
        (Config { height: 65_536, ..usual }, "10x65536 pixels"),
        (Config { crop: crop(0, 0, 11, 1), ..usual }, "0,0,11,1 is not inside"),
        (Config { crop: crop(usize::MAX, 0, 2, 1), ..usual }, "is not inside"),
        (Config { crop: crop(0, 0, 0, 1), ..usual }, "is not inside"),
        (Config { integrator: Integrator::Eye { shadows: true }, samples: 2, ..usual }, "one sample"),
        (Config { integrator: path(Path { mis: true, coat_alone: true, ..Path::default() }), ..usual }, "choose one"),
        (Config { integrator: Integrator::AmbientOcclusion { distance: -1.0 }, ..usual }, "above 0"),
        (Config { integrator: Integrator::AmbientOcclusion { distance: f32::NAN }, ..usual }, "above 0"),
    ] {
        let means = Means { method: &method, cx: &mut Context::default(), observer: None, progress: &Silent };
        let error = integrator::render(&model, &scenery, camera, &config, means).expect_err(reason);
        assert!(error.to_string().contains(reason), "{error}");
    }
}
