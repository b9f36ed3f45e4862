//! A rotating laser scanner in the middle of a scene: how far each of its beams reaches, as a table of points.
//!
//!     cargo run --release -p tracer --example lidar -- [SCENE] [POINTS.csv]
//!
//! SCENE is `rings:3` if not given, or a file (.obj, .obj.gz, .obj.zst).

use std::error::Error;
use std::io::Write;
use tracer::Scene;
use tracer::geometry::{HitBatch, Ray, RayBatch};
use tracer::model::Model;
use tracer::progress::Silent;

/// Beams, one above the other, from 15 degrees below the horizon to 15 above; and directions around.
const BEAMS: usize = 64;
const TURNS: usize = 1800;

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let (model, warnings) = Model::open(&args.next().unwrap_or_else(|| "rings:3".into()), &Silent)?;
    warnings.iter().for_each(|warning| eprintln!("{warning}"));
    let scene = Scene::builder().mesh(model.mesh).build()?;
    let bounds = scene.bounds();
    let middle: [f32; 3] = std::array::from_fn(|axis| (bounds.min[axis] + bounds.max[axis]) / 2.0);

    // Beams of unit length: distances are in units of the scene.
    let rays: RayBatch = (0..TURNS * BEAMS)
        .map(|i| {
            let around = std::f32::consts::TAU * (i / BEAMS) as f32 / TURNS as f32;
            let up = (-15.0 + 30.0 * (i % BEAMS) as f32 / (BEAMS - 1) as f32).to_radians();
            Ray::new(middle, [up.cos() * around.cos(), up.cos() * around.sin(), up.sin()])
        })
        .collect();
    let mut hits = HitBatch::new();
    let clock = std::time::Instant::now();
    scene.closest_batch(&rays, &mut hits);
    let seconds = clock.elapsed().as_secs_f64();

    let met: Vec<(Ray, f32)> =
        rays.iter().zip(hits.iter()).filter(|(_, hit)| !hit.is_miss()).map(|(ray, hit)| (ray, hit.t)).collect();
    println!("{} beams in {:.2} ms, {} of them meet something", rays.len(), 1e3 * seconds, met.len());
    if let Some(nearest) = met.iter().map(|&(_, t)| t).reduce(f32::min) {
        println!("nearest {nearest:.3}, on average {:.3}", met.iter().map(|&(_, t)| t).sum::<f32>() / met.len() as f32);
    }
    if let Some(path) = args.next() {
        let mut out = std::io::BufWriter::new(std::fs::File::create(&path)?);
        writeln!(out, "x,y,z,distance")?;
        for (ray, t) in &met {
            let [x, y, z]: [f32; 3] = std::array::from_fn(|axis| ray.org[axis] + t * ray.dir[axis]);
            writeln!(out, "{x},{y},{z},{t}")?;
        }
        out.flush()?;
        println!("{path}: {} points", met.len());
    }
    Ok(())
}
