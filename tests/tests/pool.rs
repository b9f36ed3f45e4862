//! Work runs on the threads of the caller's rayon pool alone. A file of its own, for it needs a process whose global pool nobody used.

use std::sync::Mutex;
use tests::Random;
use tracer::Scene;
use tracer::geometry::{HitBatch, Ray, RayBatch};
use tracer::method::BitVec;
use tracer::model::builtin;
use tracer::progress::Progress;

/// Remembers the names of the threads that tell of progress.
#[derive(Default)]
struct Names(Mutex<Vec<String>>);

impl Progress for Names {
    fn advance(&self, _: u64) {
        let name = std::thread::current().name().unwrap_or_default().to_owned();
        self.0.lock().expect("no panic").push(name);
    }
}

#[test]
fn the_callers_pool_is_used_and_no_other() {
    let mesh = builtin("balls:3").expect("a name").expect("a size").mesh;
    let mut random = Random(1);
    let rays: RayBatch = (0..20_000)
        .map(|_| Ray::new([0; 3].map(|_| random.between(-2.0, 2.0)), [0; 3].map(|_| random.between(-1.0, 1.0))))
        .collect();
    let mut results = Vec::new();
    for (threads, watertight) in [(1, false), (3, false), (1, true), (3, true)] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).thread_name(|i| format!("mine {i}"));
        let names = Names::default();
        let hash = pool.build().expect("a pool").install(|| {
            let scene = Scene::builder().mesh(mesh.clone()).watertight(watertight).progress(&names).build();
            let scene = scene.expect("a valid mesh");
            let (mut hits, mut occluded) = (HitBatch::new(), BitVec::new());
            scene.closest_batch(&rays, &mut hits);
            scene.occluded_batch(&rays, &mut occluded);
            assert!(occluded.count_ones() > 1000);
            (hits.hash(), occluded)
        });
        let names = names.0.into_inner().expect("no panic");
        assert!(!names.is_empty() && names.iter().all(|name| name.starts_with("mine")), "{names:?}");
        results.push(hash);
    }
    assert_eq!(results[0], results[1]);
    assert_eq!(results[2], results[3]);
    rayon::ThreadPoolBuilder::new().build_global().expect("nobody started the global pool so far");
}
