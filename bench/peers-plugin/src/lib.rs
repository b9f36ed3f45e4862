//! `tracer` behind a C interface of four functions: build, name a method, trace a range of rays, free. A harness loads it beside
//! plugins of other tracers and measures all of them on the same rays, in turn, in one run.
//!
//! `rt_build` takes a specification: `wide8` for [`Auto`]; `singlewide4`, `singlewide8`, `singlewide16` for [`Single`]; `binary`
//! for [`Packet`]; then `;level=avx2` and the like. Methods: `i` for closest hits, `o` for occlusion. With `;count=1` the nodes and
//! triangle tests of each call go to the error output; times are then of no use.
//!
//! ```text
//! cargo build --release -p peers-plugin
//! bench scenes/room.mesh -m $PWD/target/release/libpeers_plugin.so/wide8/i -R rays/room_bounce1 rays/room_prim_scan
//! ```

use simd::Level;
use std::cell::Cell;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::time::Instant;
use tracer::bvh::{BuildConfig, Bvh, CollapseConfig, WideBvh};
use tracer::geometry::{HitBatch, RayBatch};
use tracer::method::{Auto, BitVec, Context, Limits, Method, Packet, Single, Width};
use tracer::model::Mesh;
use tracer::progress::Silent;
use tracer::stats::Counters;

/// `nv` vertices of three floats, `nt` triangles of three indices.
#[repr(C)]
pub struct RtMesh {
    v: *const f32,
    nv: u32,
    idx: *const u32,
    nt: u32,
}

/// `n` rays of eight floats: origin, direction, interval; and the same as arrays, one for each of the eight.
#[repr(C)]
pub struct RtRays {
    aos: *const [f32; 8],
    soa: [*const f32; 8],
    n: usize,
}

/// What a build cost.
#[repr(C)]
pub struct RtBuildInfo {
    build_s: f64,
    bytes_final: f64,
    bytes_peak: f64,
}

/// Rays at once: their copies stay in the cache, and 64 rows of an image of 1024 columns are in one batch.
const AT_ONCE: usize = 1 << 16;

#[derive(Default)]
struct Buffers {
    batch: RayBatch,
    hits: HitBatch,
    occluded: BitVec,
}

thread_local! {
    static BUFFERS: Cell<Buffers> = Cell::default();
}

enum Tree {
    Binary(Bvh),
    Wide4(WideBvh<4>),
    Wide8(WideBvh<8>),
    Wide16(WideBvh<16>),
}

/// A tree and the level it is traced at.
pub struct Tracer {
    tree: Tree,
    level: Level,
    single: bool,
    limits: Limits,
    count: bool,
}

impl Tracer {
    fn with_method(&self, run: impl FnOnce(&dyn Method)) {
        let level = self.level;
        match &self.tree {
            Tree::Binary(bvh) => run(&Packet::new(bvh, level, Width::Auto)),
            Tree::Wide4(bvh) => run(&Single::new(bvh, level)),
            Tree::Wide8(bvh) if !self.single => run(&Auto::new(bvh, level).with_limits(self.limits)),
            Tree::Wide8(bvh) => run(&Single::new(bvh, level)),
            Tree::Wide16(bvh) => run(&Single::new(bvh, level)),
        }
    }
}

fn build(spec: &str, mesh: &Mesh) -> Result<Tracer, String> {
    let mut words = spec.split(';');
    let kind = words.next().unwrap_or_default();
    let (kind, single) = kind.strip_prefix("single").map_or((kind, false), |kind| (kind, true));
    let mut limits = Limits::default();
    let mut count = false;
    let (mut level, mut collapse, mut config) = (Level::best(), CollapseConfig::default(), BuildConfig::default());
    for word in words {
        let (key, value) = word.split_once('=').ok_or(format!("'{word}' is not key=value"))?;
        let number = || value.parse().map_err(|e| format!("{word}: {e}"));
        match key {
            "count" => count = value == "1",
            "level" => level = value.parse().map_err(|e| format!("{e}"))?,
            "node_cost" => collapse.node_cost = number()?,
            "max_leaf" => collapse.max_leaf = number()? as usize,
            "together" => limits.together = number()?,
            "coherent" => limits.coherent = number()?,
            "blocks" => limits.blocks = number()? as u32,
            "rays" => limits.rays = number()? as u32,
            "mixed_closest" => limits.mixed_closest = number()? as u32,
            "mixed_any" => limits.mixed_any = number()? as u32,
            "scatter" => limits.scatter = number()?,
            "build" => {
                config = match value {
                    "fast" => BuildConfig::fast(),
                    "medium" => BuildConfig::medium(),
                    "high" => BuildConfig::high(),
                    _ => return Err(format!("unknown builder '{value}'")),
                }
            }
            _ => return Err(format!("unknown key '{key}'")),
        }
    }
    // The harness has threads of its own: a pool of one runs on the caller's. It can be built only once.
    let _ = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global();
    let tree = match kind {
        "binary" => Bvh::build(mesh, &config, &Silent).map(Tree::Binary),
        "wide4" => WideBvh::build(mesh, &config, &collapse, &Silent).map(Tree::Wide4),
        "wide8" => WideBvh::build(mesh, &config, &collapse, &Silent).map(Tree::Wide8),
        "wide16" => WideBvh::build(mesh, &config, &collapse, &Silent).map(Tree::Wide16),
        _ => return Err(format!("unknown tree '{kind}'")),
    };
    let tree = tree.map_err(|e| e.to_string())?;
    Ok(Tracer { tree, level, single, limits, count })
}

/// Builds a tree; null, and a line on the error output, when it cannot.
///
/// # Safety
/// The mesh's arrays are as long as it says, `spec` ends with a zero, and `info` is there to write to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rt_build(
    spec: *const c_char,
    mesh: *const RtMesh,
    _threads: c_int,
    info: *mut RtBuildInfo,
) -> *mut c_void {
    // SAFETY: as the caller promises.
    let (spec, mesh, info) = unsafe { (CStr::from_ptr(spec), &*mesh, &mut *info) };
    // SAFETY: as the caller promises.
    let positions = unsafe { std::slice::from_raw_parts(mesh.v.cast::<[f32; 3]>(), mesh.nv as usize) };
    // SAFETY: as the caller promises.
    let triangles = unsafe { std::slice::from_raw_parts(mesh.idx.cast::<[u32; 3]>(), mesh.nt as usize) };
    let mesh = Mesh { positions: positions.to_vec(), triangles: triangles.to_vec(), ..Mesh::default() };
    let clock = Instant::now();
    match build(&spec.to_string_lossy(), &mesh) {
        Ok(tracer) => {
            info.build_s = clock.elapsed().as_secs_f64();
            info.bytes_final = match &tracer.tree {
                Tree::Binary(bvh) => bvh.stats().bytes,
                Tree::Wide4(bvh) => bvh.bytes(),
                Tree::Wide8(bvh) => bvh.bytes(),
                Tree::Wide16(bvh) => bvh.bytes(),
            } as f64;
            Box::into_raw(Box::new(tracer)).cast()
        }
        Err(error) => {
            eprintln!("peers-plugin: {error}");
            std::ptr::null_mut()
        }
    }
}

/// # Safety
/// `tracer` comes from [`rt_build`] and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rt_free(tracer: *mut c_void) {
    // SAFETY: as the caller promises.
    drop(unsafe { Box::from_raw(tracer.cast::<Tracer>()) });
}

/// 0 for closest hits, 1 for occlusion, -1 for what there is not.
///
/// # Safety
/// `name` ends with a zero.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rt_method(_tracer: *mut c_void, name: *const c_char) -> c_int {
    // SAFETY: as the caller promises.
    match unsafe { CStr::from_ptr(name) }.to_bytes() {
        b"i" => 0,
        b"o" => 1,
        _ => -1,
    }
}

/// Traces the rays from `begin` to `end`: distance and triangle of each, the ray's own end and `u32::MAX` where there is none.
///
/// # Safety
/// `tracer` comes from [`rt_build`], the arrays are as long as `rays` says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rt_trace(
    tracer: *mut c_void,
    method: c_int,
    rays: *const RtRays,
    begin: usize,
    end: usize,
    out_t: *mut f32,
    out_prim: *mut u32,
) {
    // SAFETY: as the caller promises.
    let (tracer, rays) = unsafe { (&*tracer.cast::<Tracer>(), &*rays) };
    // SAFETY: as the caller promises.
    let columns = rays.soa.map(|v| unsafe { &std::slice::from_raw_parts(v, rays.n)[begin..end] });
    // SAFETY: as the caller promises.
    let (t, primitive) = unsafe {
        (
            std::slice::from_raw_parts_mut(out_t.add(begin), end - begin),
            std::slice::from_raw_parts_mut(out_prim.add(begin), end - begin),
        )
    };
    // Each thread keeps its buffers from one call to the next.
    let Buffers { mut batch, mut hits, mut occluded } = BUFFERS.take();
    let mut cx = Context { counters: tracer.count.then(Counters::default), cancel: None };
    tracer.with_method(|find| {
        for begin in (0..t.len()).step_by(AT_ONCE) {
            let end = t.len().min(begin + AT_ONCE);
            let [x, y, z, dx, dy, dz, t_min, t_max] = columns.map(|v| &v[begin..end]);
            let (t, primitive) = (&mut t[begin..end], &mut primitive[begin..end]);
            batch.clear();
            batch.extend_from_arrays([x, y, z], [dx, dy, dz], t_min, t_max);
            if method == 0 {
                if find.closest(&batch, &mut hits, &mut cx).is_err() {
                    return;
                }
                let out = t.chunks_mut(16).zip(primitive.chunks_mut(16)).zip(t_max.chunks(16));
                for (block, ((t, primitive), t_max)) in hits.blocks().iter().zip(out) {
                    for lane in 0..t.len().min(16) {
                        let id = block.primitive.0[lane];
                        (t[lane], primitive[lane]) = (if id == u32::MAX { t_max[lane] } else { block.t.0[lane] }, id);
                    }
                }
            } else {
                if find.any(&batch, &mut occluded, &mut cx).is_err() {
                    return;
                }
                let out = t.chunks_mut(16).zip(primitive.chunks_mut(16)).zip(t_max.chunks(16));
                for (&word, ((t, primitive), t_max)) in occluded.words().iter().zip(out) {
                    for lane in 0..t.len().min(16) {
                        (t[lane], primitive[lane]) = (t_max[lane], if word >> lane & 1 != 0 { 0 } else { u32::MAX });
                    }
                }
            }
        }
    });
    BUFFERS.set(Buffers { batch, hits, occluded });
    if let Some(counters) = cx.counters {
        let per_ray = |n: u64| n as f64 / (end - begin) as f64;
        eprintln!("counted {:.2} {:.2}", per_ray(counters.box_tests), per_ray(counters.triangle_tests));
    }
}
