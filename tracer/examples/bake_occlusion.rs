//! Ambient occlusion for each vertex: how much of the sky above it is open, as grey vertex colours of a PLY file.
//!
//!     cargo run --release -p tracer --example bake_occlusion -- [SCENE] [OUT.ply] [RAYS]
//!
//! SCENE is `rings:2` if not given, or a file (.obj, .obj.gz, .obj.zst); RAYS a vertex, 64 if not given.

use std::error::Error;
use std::io::Write;
use tracer::Scene;
use tracer::geometry::{Ray, RayBatch};
use tracer::method::BitVec;
use tracer::model::{Mesh, Model};
use tracer::progress::Silent;

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let (model, warnings) = Model::open(&args.next().unwrap_or_else(|| "rings:2".into()), &Silent)?;
    warnings.iter().for_each(|warning| eprintln!("{warning}"));
    let path = args.next().unwrap_or_else(|| "occlusion.ply".into());
    let number: usize = args.next().map_or(Ok(64), |n| n.parse())?;
    let (mesh, normals) = (&model.mesh, vertex_normals(&model.mesh));
    let scene = Scene::builder().mesh(mesh.clone()).build()?;
    let bounds = scene.bounds();
    let size = (0..3).map(|axis| bounds.max[axis] - bounds.min[axis]).fold(0.0, f32::max);

    let clock = std::time::Instant::now();
    let mut open = vec![0_u8; mesh.positions.len()];
    let (mut rays, mut occluded) = (RayBatch::new(), BitVec::new());
    // A few vertices at a time: their rays stay in the cache.
    for first in (0..open.len()).step_by(1024) {
        let last = open.len().min(first + 1024);
        rays.clear();
        for (position, &normal) in mesh.positions[first..last].iter().zip(&normals[first..last]) {
            let org: [f32; 3] = std::array::from_fn(|axis| position[axis] + 1e-4 * size * normal[axis]);
            rays.extend((0..number).map(|i| Ray { t_max: 0.2 * size, ..Ray::new(org, about(normal, i, number)) }));
        }
        scene.occluded_batch(&rays, &mut occluded);
        for (i, open) in open[first..last].iter_mut().enumerate() {
            let free = (i * number..(i + 1) * number).filter(|&ray| !occluded.get(ray)).count();
            *open = (255 * free / number.max(1)) as u8;
        }
    }
    let rays = open.len() * number;
    let seconds = clock.elapsed().as_secs_f64();
    println!(
        "{rays} rays from {} vertices in {:.1} ms: {:.1} Mrays/s",
        open.len(),
        1e3 * seconds,
        rays as f64 / seconds / 1e6
    );
    write_ply(&path, mesh, &open)?;
    println!("{path}: {} vertices, {} triangles", open.len(), mesh.triangles.len());
    Ok(())
}

/// The mean of the normals of the triangles at each vertex, weighted by their areas; up where there is none.
fn vertex_normals(mesh: &Mesh) -> Vec<[f32; 3]> {
    let mut normals = vec![[0.0_f32; 3]; mesh.positions.len()];
    for (i, corners) in mesh.triangles.iter().enumerate() {
        let [a, b, c] = mesh.triangle(i);
        let (u, v): ([f32; 3], [f32; 3]) = (std::array::from_fn(|k| b[k] - a[k]), std::array::from_fn(|k| c[k] - a[k]));
        let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        for &corner in corners {
            (0..3).for_each(|k| normals[corner as usize][k] += n[k]);
        }
    }
    for n in &mut normals {
        let length = n.iter().map(|x| x * x).sum::<f32>().sqrt();
        *n = if length > 0.0 { n.map(|x| x / length) } else { [0.0, 0.0, 1.0] };
    }
    normals
}

/// Direction `i` of `number` around a normal, the denser the closer to it (cosine), along a spiral of the golden angle.
fn about(normal: [f32; 3], i: usize, number: usize) -> [f32; 3] {
    let radius = ((i as f32 + 0.5) / number as f32).sqrt();
    let (angle, height) = (2.399_963 * i as f32, (1.0 - radius * radius).sqrt());
    let [x, y, z] = normal;
    // A frame around the normal (Duff et al. 2017).
    let sign = 1.0_f32.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    let (u, v) = ([1.0 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y]);
    std::array::from_fn(|k| radius * (angle.cos() * u[k] + angle.sin() * v[k]) + height * normal[k])
}

fn write_ply(path: &str, mesh: &Mesh, grey: &[u8]) -> std::io::Result<()> {
    let mut out = std::io::BufWriter::new(std::fs::File::create(path)?);
    writeln!(out, "ply\nformat ascii 1.0\nelement vertex {}", grey.len())?;
    writeln!(out, "property float x\nproperty float y\nproperty float z")?;
    writeln!(out, "property uchar red\nproperty uchar green\nproperty uchar blue")?;
    writeln!(out, "element face {}\nproperty list uchar uint vertex_indices\nend_header", mesh.triangles.len())?;
    for ([x, y, z], g) in mesh.positions.iter().zip(grey) {
        writeln!(out, "{x} {y} {z} {g} {g} {g}")?;
    }
    for [a, b, c] in &mesh.triangles {
        writeln!(out, "3 {a} {b} {c}")?;
    }
    out.flush()
}
