//! What building takes of memory at once is no more than `BuildConfig::peak_bytes` says, and not far less. A test of its own, for it counts all that is
//! allocated.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use tests::Random;
use tracer::bvh::{BuildConfig, CollapseConfig, WideBvh};
use tracer::model::{Mesh, builtin};
use tracer::progress::Silent;

struct Counting;

static LIVE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

fn count(bytes: usize) {
    PEAK.fetch_max(LIVE.fetch_add(bytes, Relaxed) + bytes, Relaxed);
}

// SAFETY: the system's allocator does the work.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count(layout.size());
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        LIVE.fetch_sub(layout.size(), Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(block, layout) }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count(size);
        LIVE.fetch_sub(layout.size(), Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.realloc(block, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Small triangles far from each other: as many nodes as there can be.
fn dust(number: u32) -> Mesh {
    let mut random = Random(5);
    let mut positions = Vec::new();
    for _ in 0..number {
        let center: [f32; 3] = std::array::from_fn(|_| random.unit());
        positions.extend((0..3).map(|_| center.map(|x| x + 1e-4 * random.unit())));
    }
    Mesh { positions, triangles: (0..number).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(), ..Mesh::default() }
}

#[test]
fn the_peak_is_no_more_than_is_said() {
    let scene = |spec| builtin(spec).expect("a built-in scene").expect("a possible size").mesh;
    let scenes = [("balls", scene("balls:3")), ("hairball", scene("hairball:300")), ("dust", dust(100_000))];
    for (scene, mesh) in scenes {
        let n = mesh.triangles.len();
        for (name, config) in [
            ("fast", BuildConfig::fast()),
            ("medium", BuildConfig::medium()),
            ("high", BuildConfig::high()),
            ("insertion", BuildConfig::insertion(0)),
        ] {
            let before = LIVE.load(Relaxed);
            PEAK.store(before, Relaxed);
            let collapse = CollapseConfig::default();
            let wide = WideBvh::<8>::build(&mesh, &config, &collapse, &Silent).expect("a valid mesh");
            let (peak, live) = (PEAK.load(Relaxed) - before, LIVE.load(Relaxed) - before);
            let ratio = peak as f64 / config.peak_bytes(n) as f64;
            let per = |bytes: usize| bytes as f64 / n as f64;
            println!(
                "{scene}, {name}: at most {:.1} bytes per triangle, {ratio:.2} times what is said, then {:.1}",
                per(peak),
                per(live)
            );
            assert!(ratio > 0.5 && ratio < 1.0, "{scene}, {name}: {ratio}");
            assert!(live >= wide.bytes() && live < wide.bytes() + 100_000, "{live} {}", wide.bytes());
        }
    }
}
