//! A forest: one tree stored once and seen four hundred times, sphereflakes among them, and spheres that are no triangles.
//!
//!     cargo run --release -p tracer --example instances -- [OUT.png]

use std::error::Error;
use std::sync::Arc;
use tracer::geometry::{Aabb, Hit, Ray, RayBatch};
use tracer::{Primitives, Scene, World, WorldHit, method::BitVec, model::builtin};

const SIZE: usize = 512;

/// Their centers.
struct Spheres(Vec<[f32; 3]>);

const RADIUS: f32 = 0.3;

impl Primitives for Spheres {
    fn count(&self) -> usize {
        self.0.len()
    }
    fn bounds(&self, i: usize) -> Aabb {
        Aabb { min: self.0[i].map(|x| x - 1.01 * RADIUS), max: self.0[i].map(|x| x + 1.01 * RADIUS) }
    }
    fn closest(&self, i: usize, ray: &Ray) -> Option<Hit> {
        let o: [f32; 3] = std::array::from_fn(|k| ray.org[k] - self.0[i][k]);
        let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let (a, b) = (dot(ray.dir, ray.dir), dot(o, ray.dir));
        let root = (b * b - a * (dot(o, o) - RADIUS * RADIUS)).sqrt(); // NaN where there is none
        let t = [(-b - root) / a, (-b + root) / a].into_iter().find(|t| (ray.t_min..=ray.t_max).contains(t))?;
        Some(Hit { t, u: 0.0, v: 0.0, primitive: i as u32 })
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "instances.png".into());
    // Without the ground, which comes first.
    let scene =
        |name| builtin(name).expect("built in").map(|model| (model.mesh.positions, model.mesh.triangles[2..].to_vec()));
    let ((tree, branches), (balls, parts)) = (scene("tree:7")?, scene("balls:3")?);
    let tree = Arc::new(Scene::builder().triangles(tree, branches).build()?);
    let balls = Arc::new(Scene::builder().triangles(balls, parts).build()?);
    let ground = vec![[-99.0, -99.0, 0.0], [99.0, -99.0, 0.0], [0.0, 199.0, 0.0]];
    let ground = Arc::new(Scene::builder().triangles(ground, vec![[0, 1, 2]]).build()?);
    let spheres = (0..300).map(|i| [(i * 37 % 100) as f32 * 0.6 - 30.0, (i * 61 % 97) as f32 * 0.6 - 29.0, RADIUS]);

    let mut builder = World::builder().instance(ground, World::IDENTITY);
    builder = builder.primitives(Arc::new(Spheres(spheres.collect())), World::IDENTITY);
    for i in 0..400 {
        let (angle, size, is_tree) = (i as f32 * 2.4, 0.8 + 0.05 * (i * 7 % 13) as f32, i % 9 != 4);
        let (x, y, z) = ((i % 20) as f32 * 3.0 - 28.0, (i / 20) as f32 * 3.0 - 28.0, if is_tree { 0.0 } else { size });
        let (s, c) = (size * angle.sin(), size * angle.cos());
        let turned = [[c, -s, 0.0, x + s], [s, c, 0.0, y + c], [0.0, 0.0, size, z]];
        builder = builder.instance(if is_tree { tree.clone() } else { balls.clone() }, turned);
    }
    let world = builder.build()?;

    let side = |i: usize| (i as f32 + 0.5) / SIZE as f32 - 0.5;
    let rays = (0..SIZE * SIZE).map(|i| Ray::new([0.0, -42.0, 9.0], [side(i % SIZE), 1.0, -0.2 - side(i / SIZE)]));
    let rays: RayBatch = rays.collect();
    let (mut hits, mut dark, clock) = (Vec::new(), BitVec::new(), std::time::Instant::now());
    world.closest_batch(&rays, &mut hits);
    let to_sun = |(ray, found): (Ray, &WorldHit)| {
        let t = if found.is_miss() { 0.0 } else { 0.9999 * found.hit.t };
        Ray::new(std::array::from_fn(|k| ray.org[k] + t * ray.dir[k]), [-0.5, -0.6, 1.0])
    };
    world.occluded_batch(&rays.iter().zip(&hits).map(to_sun).collect(), &mut dark);
    println!(
        "{} instances, {} rays in {:.0} ms",
        world.instances(),
        2 * rays.len(),
        1e3 * clock.elapsed().as_secs_f64()
    );

    let color = |(i, found): (usize, &WorldHit)| {
        // Ground, spheres, all others; the sky.
        let color = [[90, 110, 60], [220, 60, 40], [70, 160, 60], [120, 170, 230_u8]];
        let color = color[if found.is_miss() { 3 } else { found.instance.min(2) as usize }];
        if dark.get(i) && !found.is_miss() { color.map(|c| c / 3) } else { color }
    };
    let pixels: Vec<u8> = hits.iter().enumerate().flat_map(color).collect();
    let mut encoder = png::Encoder::new(std::fs::File::create(&path)?, SIZE as u32, SIZE as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header()?.write_image_data(&pixels)?;
    Ok(())
}
