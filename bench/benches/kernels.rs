//! The box test and a whole cast, at every level and width of this CPU.
//!
//! ```text
//! cargo bench -p bench
//! ```

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use simd::{Float, Level, Mask};
use std::hint::black_box;
use tracer::bvh::{BuildConfig, Bvh};
use tracer::geometry::HitBatch;
use tracer::method::{Context, Method, Packet, Width};
use tracer::model::builtin;
use tracer::progress::Silent;
use tracer::render::EyeRays;

/// One ray against boxes in structure-of-arrays form: how many it meets.
#[inline(always)]
fn slab<F: Float>(planes: &[Vec<f32>; 6], origin: [f32; 3], inv_dir: [f32; 3]) -> usize {
    let mut met = 0;
    for i in (0..planes[0].len()).step_by(F::LANES) {
        let (mut near, mut far) = (F::splat(0.0), F::splat(f32::INFINITY));
        for axis in 0..3 {
            let (o, inv) = (F::splat(origin[axis]), F::splat(inv_dir[axis]));
            let a = (F::load(&planes[axis][i..]) - o) * inv;
            let b = (F::load(&planes[axis + 3][i..]) - o) * inv;
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
        met += near.le(far).count();
    }
    met
}

simd::kernel! {
    fn slab4<S>(planes: &[Vec<f32>; 6]) -> usize {
        slab::<S::Float4>(planes, [0.5, 0.4, -1.0], [7.0, -9.0, 1.1])
    }
}
simd::kernel! {
    fn slab8<S>(planes: &[Vec<f32>; 6]) -> usize {
        slab::<S::Float8>(planes, [0.5, 0.4, -1.0], [7.0, -9.0, 1.1])
    }
}
simd::kernel! {
    fn slab16<S>(planes: &[Vec<f32>; 6]) -> usize {
        slab::<S::Float16>(planes, [0.5, 0.4, -1.0], [7.0, -9.0, 1.1])
    }
}

fn boxes(c: &mut Criterion) {
    const BOXES: usize = 1024;
    let at = |i: usize, k: usize| ((i * 37 + k * 11) % 101) as f32 / 101.0;
    let planes: [Vec<f32>; 6] =
        std::array::from_fn(|k| (0..BOXES).map(|i| at(i, k % 3) + if k < 3 { 0.0 } else { 0.1 }).collect());
    let mut group = c.benchmark_group("slab");
    group.throughput(Throughput::Elements(BOXES as u64));
    for level in Level::available() {
        for (lanes, kernel) in [(4, slab4 as fn(Level, &[Vec<f32>; 6]) -> usize), (8, slab8), (16, slab16)] {
            group.bench_function(BenchmarkId::new(level.to_string(), lanes), |b| {
                b.iter(|| kernel(level, black_box(&planes)));
            });
        }
    }
    group.finish();
}

fn casting(c: &mut Criterion) {
    let scene = builtin("balls:3").expect("a built-in scene").expect("a possible size");
    let bvh = Bvh::build(&scene.mesh, &BuildConfig::default(), &Silent).expect("a valid mesh");
    let eye = EyeRays::new(&scene.camera_or_default(), 256, 256, Level::best(), Width::Auto);
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    let mut group = c.benchmark_group("cast balls:3 256x256");
    group.throughput(Throughput::Elements(eye.rays().len() as u64)).sample_size(10);
    let mut hits = HitBatch::new();
    for level in Level::available() {
        for width in [Width::Four, Width::Eight, Width::Sixteen] {
            let method = Packet::new(&bvh, level, width);
            group.bench_function(BenchmarkId::new(level.to_string(), width), |b| {
                b.iter(|| one.install(|| method.closest(eye.rays(), &mut hits, &mut Context::default())));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, boxes, casting);
criterion_main!(benches);
