//! Light from environment maps: the same bits at every level and width, by every method, on any number of threads; and as much of it as theory says.

use simd::Level;
use std::f64::consts::PI;
use tracer::bvh::{BuildConfig, Bvh, CollapseConfig};
use tracer::method::{Auto, Context, Method, Packet, Single, Width};
use tracer::model::{Camera, Light, Material, Mesh, Model, Reflection, builtin};
use tracer::progress::Silent;
use tracer::render::integrator::{self, Config, Identity, Integrator, Means, Path, Rendering};
use tracer::render::{Environment, Image, Scenery, Up};

fn image(width: usize, height: usize, light: impl Fn(usize, usize) -> [f32; 3]) -> Image {
    Image { width, height, pixels: (0..width * height).map(|i| light(i % width, i / width)).collect() }
}

fn map(image: &Image, up: Up, degrees: f32) -> Environment {
    Environment::new(image, up, degrees).expect("a map")
}

/// Half of it bright, all of it of some colour, and a small sun so many times as bright as usual.
fn sky(sun: f32) -> Image {
    image(32, 16, |x, y| match (x, y) {
        (9, 3) => [9.0 * sun, 8.0 * sun, 6.0 * sun],
        (_, 0..8) => [0.3, 0.4 + 0.01 * x as f32, 0.9],
        _ => [0.2, 0.1 + 0.02 * y as f32, 0.05],
    })
}

fn render_by(model: &Model, scenery: &Scenery, config: &Config, method: &dyn Method) -> Rendering {
    let means = Means { method, cx: &mut Context::default(), observer: None, progress: &Silent };
    integrator::render(model, scenery, model.camera_or_default(), config, means).expect("not cancelled")
}

fn render(model: &Model, scenery: &Scenery, config: &Config) -> Rendering {
    model.validate().expect("sound");
    let bvh = Bvh::build(&model.mesh, &BuildConfig::default(), &Silent).expect("a tree");
    let tree = bvh.collapse::<8>(&CollapseConfig::default());
    render_by(model, scenery, config, &Auto::new(&tree, Level::best()))
}

/// Mean of the green channel over the picture, and its standard deviation.
fn mean(r: &Rendering) -> (f64, f64) {
    let n = r.image.pixels.len() as f64;
    let sum: f64 = r.image.pixels.iter().map(|p| f64::from(p[1])).sum();
    let variance: f64 = r.variance.iter().map(|&v| f64::from(v)).sum();
    (sum / n, variance.sqrt() / n)
}

fn path(bounces: u32, mis: bool) -> Integrator {
    Integrator::Path(Path { bounces, mis, ..Path::default() })
}

/// The balls, of all kinds of surfaces, with a lamp among them.
fn balls() -> Model {
    let mut model = builtin("balls:1").expect("a name").expect("a size");
    let n = model.mesh.triangles.len();
    model.mesh.materials = (0..n).map(|i| if i < 2 { 0 } else { 1 + (i / 97 % 5) as u32 }).collect();
    let surface = |reflection| Material {
        specular: [0.2; 3],
        shininess: 40.0,
        reflection,
        ..Material::matt("ball", [0.2, 0.5, 0.4])
    };
    model.materials = vec![
        Material::grey("ground"),
        surface(Reflection::Lambertian),
        surface(Reflection::Glossy),
        surface(Reflection::Mirror),
        surface(Reflection::Dielectric),
        Material { emission: [3.0, 2.0, 1.0], ..Material::grey("lamp") },
    ];
    model
}

const ALL: [Integrator; 3] = [
    Integrator::Path(Path { bounces: 4, roulette: true, mis: true, coat_alone: false }),
    Integrator::Path(Path { bounces: 3, roulette: false, mis: false, coat_alone: false }),
    Integrator::Whitted { bounces: 4 },
];

/// Hashes of the three pictures, the same on every machine.
const HASHES: [u64; 3] = [0x2ecf_717c_b51a_0683, 0x87dc_de87_e690_fa75, 0x655e_2df6_6e5e_efdd];

#[test]
fn same_bits_by_every_means() {
    let model = balls();
    let scenery = Scenery::in_environment(&model, map(&sky(100.0), Up::Z, 33.0));
    let bvh = Bvh::build(&model.mesh, &BuildConfig::default(), &Silent).expect("a tree");
    let config = CollapseConfig::default();
    let (four, eight) = (bvh.collapse::<4>(&config), bvh.collapse::<8>(&config));
    let found = ALL.map(|integrator| {
        let usual = Config { integrator, samples: 2, seed: 3, ..Config::new(37, 22) };
        let expected = render_by(&model, &scenery, &usual, &Single::new(&four, Level::SCALAR)).image.hash();
        let check = |what: &str, config: &Config, method: &dyn Method| {
            let image = render_by(&model, &scenery, config, method).image;
            assert_eq!(image.hash(), expected, "{integrator:?}, {what}: {:#018x}", image.hash());
            assert!(image.pixels.as_flattened().iter().all(|c| c.is_finite() && *c >= 0.0));
        };
        for level in Level::available() {
            for lanes in [Width::Auto, Width::One] {
                for group_shading in [true, false] {
                    let config = Config { level, lanes, group_shading, ..usual };
                    check(&format!("{level}, {lanes}, {group_shading}"), &config, &Auto::new(&eight, level));
                }
            }
            check("packets", &usual, &Packet::new(&bvh, level, Width::Auto));
        }
        for (threads, batch) in [(1, 1 << 20), (5, 1 << 20), (2, 1), (2, 100)] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            let method = Auto::new(&eight, Level::best());
            pool.install(|| check(&format!("{threads} threads, {batch}"), &Config { batch, ..usual }, &method));
        }
        expected
    });
    assert_eq!(found, HASHES, "other pictures than before: {found:#018x?}");
}

/// A map of one colour is that colour.
#[test]
fn furnace() {
    let mut model = builtin("balls:0").expect("a name").expect("a size");
    // Without the ground.
    model.mesh.triangles.drain(..2);
    model.mesh.normal_indices.clear();
    model.mesh.materials.clear();
    model.lights.clear();
    model.camera = Some(Camera { eye: [0.0, -8.0, 0.0], at: [0.0; 3], up: [0.0, 0.0, 1.0], fov: 3.0 });
    let grey = image(16, 8, |_, _| [1.0; 3]);
    for (reflection, diffuse, specular, exact) in [
        (Reflection::Lambertian, 0.8, 0.0, Some(0.8)),
        (Reflection::Mirror, 0.0, 0.9, Some(0.9)),
        (Reflection::Dielectric, 0.0, 0.0, Some(1.0)),
        (Reflection::Glossy, 0.6, 0.3, None),
    ] {
        let surface =
            Material { specular: [specular; 3], shininess: 20.0, reflection, ..Material::matt("ball", [diffuse; 3]) };
        model.materials = vec![surface];
        let by_map = Scenery::in_environment(&model, map(&grey, Up::Z, 0.0));
        // Lit by one colour alone: a light that is none keeps the one at the eye away.
        model.lights = vec![Light { position: [0.0; 3], intensity: [0.0; 3] }];
        let by_color = Scenery::new(&model, &model.camera_or_default()).with_environment([1.0; 3]);
        model.lights.clear();
        for mis in [false, true] {
            let config = Config { integrator: path(40, mis), samples: 64, ..Config::new(16, 16) };
            let (one, sigma) = mean(&render(&model, &by_map, &config));
            let (other, sigma_of_other) = mean(&render(&model, &by_color, &config));
            let both = (sigma * sigma + sigma_of_other * sigma_of_other).sqrt();
            assert!((one - other).abs() < 4.0 * both + 1e-3, "{reflection:?} {mis}: {one} +- {sigma}, not {other}");
            assert!(both < 0.03, "{both}");
            if let Some(exact) = exact {
                assert!((one - exact).abs() < 4.0 * sigma + 1e-3, "{reflection:?} {mis}: {one}, not {exact}");
            }
        }
    }
}

/// A wall through the origin that faces along an axis, seen from near.
fn wall(axis: usize) -> Model {
    let (mut e1, mut e2, mut eye) = ([0.0; 3], [0.0; 3], [0.3; 3]);
    e1[(axis + 1) % 3] = 10.0;
    e2[(axis + 2) % 3] = 10.0;
    eye[axis] = 3.0;
    let corner = [0, 1, 2].map(|k| -0.5 * (e1[k] + e2[k]));
    let at = |s: f32, t: f32| [0, 1, 2].map(|k| corner[k] + s * e1[k] + t * e2[k]);
    let positions = vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
    let mesh = Mesh { positions, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() };
    let camera = Camera { eye, at: [0.0; 3], up: Camera::DEFAULT_UP, fov: 0.1 };
    let (name, camera, background) = ("wall".into(), Some(camera), [9.0; 3]);
    Model {
        name,
        mesh,
        materials: vec![Material::matt("wall", [0.6; 3])],
        lights: vec![],
        camera,
        ambient: 0.0,
        background,
    }
}

/// One bright pixel: its radiance times its solid angle times the cosine, wherever the map is turned to.
#[test]
fn light_of_a_small_sun() {
    let (width, height, radiance) = (256, 128, 40_000.0_f32);
    let (x, y) = (160, 40);
    let sun = image(width, height, |column, row| if (column, row) == (x, y) { [radiance; 3] } else { [0.0; 3] });
    let (theta, phi) = ((y as f64 + 0.5) / height as f64 * PI, ((x as f64 + 0.5) / width as f64 - 0.5) * 2.0 * PI);
    let solid_angle = theta.sin() * (PI / height as f64) * (2.0 * PI / width as f64);
    for (up, degrees) in [(Up::Y, 0.0), (Up::Z, 0.0), (Up::Y, 200.0), (Up::Z, -130.0)] {
        // To the right of where the middle of the map looks, which turns to the left.
        let turned = phi - f64::from(degrees).to_radians();
        let [right, forward] = [theta.sin() * turned.sin(), theta.sin() * turned.cos()];
        let to_sun = match up {
            Up::Y => [right, theta.cos(), -forward],
            Up::Z => [right, forward, theta.cos()],
        };
        for (axis, cosine) in to_sun.into_iter().enumerate() {
            let model = wall(axis);
            let scenery = Scenery::in_environment(&model, map(&sun, up, degrees));
            let irradiance = f64::from(radiance) * solid_angle * f64::max(0.0, cosine);
            let expected = 0.6 / PI * irradiance;
            for integrator in [path(1, false), path(1, true), Integrator::Whitted { bounces: 1 }] {
                let config = Config { integrator, samples: 64, ..Config::new(8, 8) };
                let (mean, sigma) = mean(&render(&model, &scenery, &config));
                let off = (mean - expected).abs();
                assert!(
                    off <= 4.0 * sigma + 1e-3 * expected,
                    "{up} {degrees} {axis}: {mean} +- {sigma}, not {expected}"
                );
                assert!(sigma <= 0.03 * expected);
            }
        }
    }
}

/// Light adds up: of a lamp and a map, which share the choice of a light, as of each alone; by both ways of finding it.
#[test]
fn lamps_and_maps_together() {
    let mut model = balls();
    // On a mirror lamps are highlights.
    model.materials[3].reflection = Reflection::Lambertian;
    model.lights = vec![Light { position: [3.0, 2.0, 4.0], intensity: [0.5; 3] }];
    let mut lampless = model.clone();
    lampless.lights.clear();
    lampless.materials.iter_mut().for_each(|m| m.emission = [0.0; 3]);
    let black = image(4, 2, |_, _| [0.0; 3]);
    let config = |mis| Config { integrator: path(4, mis), samples: 256, ..Config::new(24, 18) };
    let both = Scenery::in_environment(&model, map(&sky(6.0), Up::Z, 0.0));
    let lamps = Scenery::in_environment(&model, map(&black, Up::Z, 0.0));
    let around = Scenery::in_environment(&lampless, map(&sky(6.0), Up::Z, 0.0));
    for mis in [false, true] {
        let (sum, sigma) = mean(&render(&model, &both, &config(mis)));
        let (one, of_one) = mean(&render(&model, &lamps, &config(true)));
        let (other, of_other) = mean(&render(&lampless, &around, &config(true)));
        let sigma = (sigma * sigma + of_one * of_one + of_other * of_other).sqrt();
        assert!((sum - one - other).abs() < 4.0 * sigma, "{mis}: {sum} +- {sigma}, not {one} + {other}");
        assert!(sigma < 0.02 * sum && one > 0.05 * sum && other > 0.05 * sum, "{sigma} {sum} {one} {other}");
    }
}

#[test]
fn black_maps_and_identities() {
    let mut model = wall(2);
    let black = image(4, 2, |_, _| [0.0; 3]);
    for integrator in ALL {
        let scenery = Scenery::in_environment(&model, map(&black, Up::Y, 0.0));
        let config = Config { integrator, samples: 2, ..Config::new(8, 8) };
        assert!(render(&model, &scenery, &config).image.pixels.iter().all(|p| *p == [0.0; 3]));
    }
    model.camera = None;
    let camera = model.camera_or_default();
    let of =
        |environment| Identity::new(&model, &Scenery::in_environment(&model, environment), &camera, &Config::new(8, 8));
    let usual = of(map(&sky(100.0), Up::Y, 0.0));
    assert_eq!(usual, of(map(&sky(100.0), Up::Y, 0.0)));
    for other in [map(&black, Up::Y, 0.0), map(&sky(100.0), Up::Z, 0.0), map(&sky(100.0), Up::Y, 1.0)] {
        assert_ne!(usual, of(other));
    }
    assert_ne!(usual, Identity::new(&model, &Scenery::new(&model, &camera), &camera, &Config::new(8, 8)));
}
