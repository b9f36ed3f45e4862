//! What the tests have in common.

use rayon::ThreadPoolBuilder;

/// The same numbers for each seed.
pub(super) fn random(len: usize, seed: u32) -> Vec<u32> {
    let mut state = u64::from(seed) * 2 + 1;
    let next = |_| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 32) as u32
    };
    (0..len).map(next).collect()
}

/// On one thread and on several.
pub(super) fn everywhere(check: impl Fn() + Sync) {
    for threads in [1, 3] {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("a few threads");
        pool.install(&check);
    }
}
