//! What holds for the trees of all builders.

use super::*;
use crate::progress::Silent;
use std::sync::atomic::{AtomicU64, Ordering};

/// Uniform random numbers in [0, 1).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / 16_777_216.0
    }

    fn point(&mut self, scale: [f32; 3]) -> [f32; 3] {
        scale.map(|s| (self.next() - 0.5) * s)
    }
}

fn mesh(corners: impl IntoIterator<Item = [[f32; 3]; 3]>) -> Mesh {
    let positions: Vec<_> = corners.into_iter().flatten().collect();
    let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh { positions, triangles, ..Default::default() }
}

/// Triangles of some size in a box.
fn soup(n: usize, seed: u64, room: [f32; 3], size: f32) -> Mesh {
    let mut r = Random(seed);
    mesh((0..n).map(|_| {
        let at = r.point(room);
        std::array::from_fn(|_| {
            let d = r.point(room.map(|x| x * size));
            std::array::from_fn(|i| at[i] + d[i])
        })
    }))
}

fn configs() -> Vec<BuildConfig> {
    vec![
        BuildConfig::default(),
        BuildConfig::Binned(binned::Config {
            max_leaf: 1,
            traversal_cost: 0.0,
            child_order: binned::ChildOrder::LowerFirst,
        }),
        BuildConfig::Binned(binned::Config { max_leaf: 99, traversal_cost: 1e9, ..Default::default() }),
        BuildConfig::fast(),
        BuildConfig::Linear(linear::Config { max_leaf: 1, traversal_cost: 0.0 }),
        BuildConfig::high(),
        BuildConfig::Reinsertion(reinsertion::Config {
            binned: binned::Config { max_leaf: 3, ..Default::default() },
            rounds: 3,
            stride: 0,
        }),
        BuildConfig::insertion(7),
        BuildConfig::Insertion(insertion::Config { seed: None, max_children: 2, sort_children: false }),
    ]
}

/// Builds with every configuration; checks that the trees are well-formed and hold what they shall.
fn check(mesh: &Mesh) -> Vec<Bvh> {
    let all = 0..mesh.triangles.len() as u32;
    let expected: Vec<u32> = all.filter(|&id| !triangle(mesh, id).is_degenerate()).collect();
    let build = |config: &BuildConfig| {
        let bvh = Bvh::build(mesh, config, &Silent).unwrap();
        bvh.validate().unwrap_or_else(|e| panic!("{config:?}: {e}"));
        let mut ids: Vec<u32> = bvh.triangles.iter().map(|t| t.id).collect();
        ids.sort_unstable();
        assert_eq!(ids, expected, "{config:?}");
        assert!(bvh.triangles.iter().all(|t| *t == triangle(mesh, t.id)));
        if matches!(config, BuildConfig::Binned(_) | BuildConfig::Linear(_)) {
            assert!(bvh.stats().max_depth <= MAX_DEPTH as usize);
        }
        bvh
    };
    configs().iter().map(build).collect()
}

#[test]
fn random_soups_of_all_sizes() {
    for n in (1..40).chain([100, 1000, 20_000]) {
        check(&soup(n, n as u64, [1.0, 2.0, 3.0], 0.1));
    }
    check(&soup(3000, 1, [1.0; 3], 2.0));
}

#[test]
fn flat_and_thin_scenes() {
    for room in [[1.0, 1.0, 0.0], [0.0, 1.0, 1.0], [1.0, 1e-30, 1.0], [1e6, 1e-6, 1.0]] {
        check(&soup(2000, 3, room, 0.05));
    }
}

#[test]
fn triangles_in_one_place() {
    let one = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for bvh in check(&mesh(vec![one; 100_000])) {
        assert!(bvh.stats().max_depth <= 24, "equal triangles make a balanced tree: {:?}", bvh.stats());
    }
    // Equal centers, different sizes.
    check(&mesh(
        (1..3000).map(|i| [[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]].map(|p| p.map(|x| x * i as f32))),
    ));
}

#[test]
fn geometrically_growing_triangles() {
    // The worst for depth: each split by area alone would cut off the largest.
    let corners = |i: i32| {
        let s = 2f32.powi(i % 200 - 100);
        [[s, 0.0, 0.0], [2.0 * s, 0.0, s], [s, s, 0.0]]
    };
    check(&mesh((0..3000).map(corners)));
}

#[test]
fn single_degenerate_and_none() {
    let one = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let point = [[0.5; 3]; 3];
    for bvh in check(&mesh([one])) {
        assert_eq!((bvh.nodes.len(), bvh.triangles.len()), (1, 1));
    }
    for bvh in check(&mesh([point; 5])) {
        assert!(bvh.nodes.is_empty() && bvh.triangles.is_empty());
    }
    for bvh in check(&mesh([point, one, point, one])) {
        assert_eq!(bvh.triangles.len(), 2);
        assert_eq!(bvh.stats().triangles, 2);
    }
    assert!(matches!(Bvh::build(&Mesh::default(), &BuildConfig::default(), &Silent), Err(Error::Geometry(_))));
}

#[test]
fn the_largest_and_smallest_numbers() {
    for scale in [1e-44, 1e-38, 1e-25, 1e10, 1e20, 1e37, f32::MAX] {
        let mut m = soup(1000, 5, [1.0; 3], 0.2);
        for x in m.positions.iter_mut().flatten() {
            *x *= scale;
        }
        check(&m);
    }
    // Some edges overflow, some boxes are as large as boxes can be.
    let mut r = Random(1);
    check(&mesh((0..1000).map(|_| std::array::from_fn(|_| r.point([f32::MAX; 3]).map(|x| x * 1.99)))));
}

#[test]
fn bad_meshes_are_errors() {
    let good = soup(10, 1, [1.0; 3], 0.1);
    let mut nan = good.clone();
    nan.positions[4][1] = f32::NAN;
    let mut index = good.clone();
    index.triangles[3][2] = 30;
    for bad in [nan, index] {
        for config in configs() {
            assert!(matches!(Bvh::build(&bad, &config, &Silent), Err(Error::Geometry(_))));
        }
    }
}

fn bits(bvh: &Bvh) -> (Vec<[u32; 8]>, Vec<u32>) {
    let nodes = bvh.nodes.iter().map(|n| n.planes().map(f32::to_bits)).collect();
    (nodes, bvh.triangles.iter().map(|t| t.id).collect())
}

#[test]
fn same_tree_for_any_number_of_threads() {
    let m = soup(60_000, 9, [3.0, 1.0, 2.0], 0.02);
    for config in configs() {
        let trees = [1, 2, 4].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            bits(&pool.install(|| Bvh::build(&m, &config, &Silent)).unwrap())
        });
        assert!(trees[0] == trees[1] && trees[0] == trees[2], "{config:?}");
    }
}

#[test]
fn insertion_depends_on_the_seed_alone() {
    let m = soup(2000, 11, [1.0; 3], 0.05);
    let tree = |seed| bits(&Bvh::build(&m, &BuildConfig::insertion(seed), &Silent).unwrap());
    assert_eq!(tree(1), tree(1));
    assert_ne!(tree(1), tree(2));
}

#[test]
fn larger_children_come_first() {
    let m = soup(5000, 13, [1.0; 3], 0.05);
    for config in [BuildConfig::default(), BuildConfig::high(), BuildConfig::insertion(0)] {
        let bvh = Bvh::build(&m, &config, &Silent).unwrap();
        let area = |i: usize| bvh.nodes[i].bounds().half_area();
        for (i, node) in bvh.nodes.iter().enumerate().filter(|(_, n)| n.triangles().1 == 0) {
            let mut child = i + 1;
            while (bvh.nodes[child].skip()) < node.skip() {
                let next = bvh.nodes[child].skip() as usize;
                assert!(area(child) >= area(next), "{config:?}: children {child} and {next} of {i}");
                child = next;
            }
        }
    }
}

#[test]
fn trees_are_good() {
    let m = soup(20_000, 15, [1.0; 3], 0.02);
    let cost = |config: &BuildConfig| Bvh::build(&m, config, &Silent).unwrap().stats().sah_cost;
    let (binned, insertion) = (cost(&BuildConfig::default()), cost(&BuildConfig::insertion(0)));
    let median = cost(&BuildConfig::Binned(binned::Config { traversal_cost: f32::NAN, ..Default::default() }));
    assert!(binned < 155.0 && binned < median, "binned {binned}, with leaves as large as can be {median}");
    assert!(insertion < 1.5 * binned, "insertion {insertion}, binned {binned}");
    let (fast, high) = (cost(&BuildConfig::fast()), cost(&BuildConfig::high()));
    assert!(fast < 1.2 * binned && high < 0.98 * binned, "fast {fast}, medium {binned}, high {high}");
    let balls = crate::model::builtin("balls:2").expect("a name").expect("a size").mesh;
    let cost = |config: &BuildConfig| Bvh::build(&balls, config, &Silent).unwrap().stats().sah_cost;
    let (fast, binned, high) = (cost(&BuildConfig::fast()), cost(&BuildConfig::medium()), cost(&BuildConfig::high()));
    assert!(fast < 1.2 * binned && high < 0.85 * binned, "fast {fast}, medium {binned}, high {high}");
}

#[test]
fn all_triangles_are_reported_and_cancelling_stops() {
    #[derive(Default)]
    struct Counting {
        done: AtomicU64,
        total: AtomicU64,
        limit: u64,
    }
    impl Progress for Counting {
        fn stage(&self, _: &str, total: u64) {
            self.total.fetch_add(total, Ordering::Relaxed);
        }
        fn advance(&self, n: u64) {
            self.done.fetch_add(n, Ordering::Relaxed);
        }
        fn cancelled(&self) -> bool {
            self.limit > 0 && self.done.load(Ordering::Relaxed) >= self.limit
        }
    }
    let m = soup(50_000, 17, [1.0; 3], 0.02);
    for config in configs() {
        let all = Counting::default();
        Bvh::build(&m, &config, &all).unwrap();
        let rounds = if let BuildConfig::Reinsertion(config) = config { u64::from(config.rounds) } else { 0 };
        assert_eq!((all.done.into_inner(), all.total.into_inner()), (50_000 + rounds, 50_000 + rounds));
        if rounds > 0 {
            let most = Counting { limit: 50_001, ..Default::default() };
            assert!(matches!(Bvh::build(&m, &config, &most), Err(Error::Cancelled)));
        }
        let some = Counting { limit: 10_000, ..Default::default() };
        assert!(matches!(Bvh::build(&m, &config, &some), Err(Error::Cancelled)));
        assert!(some.done.into_inner() < 50_000);
    }
}
