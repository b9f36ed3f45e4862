//! A mesh and rays: every method at every level finds what the loop over all triangles finds.
#![no_main]

use arbitrary::Arbitrary;
use fuzz::{AnyRay, Number, one_thread};
use libfuzzer_sys::fuzz_target;
use simd::Level;
use tests::agreement::{Trees, by_brute_force, check};
use tracer::geometry::{Ray, RayBatch};
use tracer::model::Mesh;

#[derive(Debug, Arbitrary)]
struct Input {
    positions: Vec<[Number; 3]>,
    triangles: Vec<[u8; 3]>,
    rays: Vec<AnyRay>,
    /// Rays like the first, each a little further to the side: methods trace such together.
    fan: Option<(u8, Number)>,
    insertion: bool,
}

fuzz_target!(init: one_thread(), |input: Input| {
    let Input { positions, triangles, rays, fan, insertion } = input;
    let vertices = positions.len().clamp(1, 255) as u32;
    let mesh = Mesh {
        positions: positions.into_iter().take(255).map(|p| p.map(|x| x.0)).collect(),
        triangles: triangles.into_iter().take(64).map(|t| t.map(|v| u32::from(v) % vertices)).collect(),
        ..Mesh::default()
    };
    if mesh.validate().is_err() {
        return;
    }
    let mut batch: RayBatch = rays.iter().take(40).map(AnyRay::ray).collect();
    if let (Some(first), Some((count, step))) = (rays.first(), fan) {
        let first = first.ray();
        let aside = |i: u8| [first.dir[0] + f32::from(i) * step.0 * 1e-3, first.dir[1], first.dir[2]];
        batch.extend((0..count).map(|i| Ray { dir: aside(i), ..first }));
    }
    let trees = if insertion { Trees::insertion(&mesh) } else { Trees::binned(&mesh) };
    let levels: Vec<Level> = Level::available().collect();
    check("fuzz", &trees, &levels, &batch, &by_brute_force(&mesh, &batch));
});
