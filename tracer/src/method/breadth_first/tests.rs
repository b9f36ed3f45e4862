//! Every way of tracing finds the hits of a loop over all triangles.

use super::*;
use crate::bvh::build::binned;
use crate::bvh::{BuildConfig, OctoConfig};
use crate::geometry::{Hit, Ray};
use crate::model::Mesh;
use crate::progress::Silent;
use crate::scene::random::{self, Random, hits_of};
use crate::stats::Counters;

struct Setup {
    bvh: Bvh,
    rays: RayBatch,
    expected: Vec<Hit>,
}

fn setup(mesh: &Mesh, config: &BuildConfig, rays: RayBatch) -> Setup {
    let bvh = Bvh::build(mesh, config, &Silent).expect("a valid mesh");
    let first = |hits: Vec<Hit>| {
        hits.into_iter().fold(Hit::MISS, |best, h| if (h.t, h.primitive) < (best.t, best.primitive) { h } else { best })
    };
    let expected = rays.iter().map(|ray| first(hits_of(mesh, &ray))).collect();
    Setup { bvh, rays, expected }
}

/// Rays that nothing orders, then some that go together, then some that are not ordinary.
fn all_kinds(random: &mut Random, mesh: &Mesh) -> RayBatch {
    let mut rays = random::rays(random, mesh, 700);
    let side_by_side =
        (0..600).map(|i| Ray::new([2.0, 0.5, 0.3], [-1.0, (i % 30) as f32 / 30.0 - 0.5, i as f32 / 300.0 - 1.0]));
    rays.extend(side_by_side);
    let unusual = (0..40).map(|i| {
        let org = random.point(1.5);
        let scale = [1e25, 1e-25, 1e-36, 1.0][i % 4];
        Ray { t_min: -1.0, ..Ray::new(org, org.map(|x| -x * scale)) }
    });
    rays.extend(unusual);
    rays.push(Ray::new([1e25, 0.0, 0.0], [-1.0, 0.0, 0.0]));
    rays
}

fn check(method: &BreadthFirst, setup: &Setup, what: &str) -> Counters {
    let (mut hits, mut occluded) = (HitBatch::new(), BitVec::new());
    let mut counted = Context { counters: Some(Counters::default()), cancel: None };
    let mut counters = Counters::default();
    for cx in [&mut Context::default(), &mut counted] {
        method.closest(&setup.rays, &mut hits, cx).expect("not cancelled");
        counters = cx.counters.unwrap_or_default();
        method.any(&setup.rays, &mut occluded, cx).expect("not cancelled");
        let bits = |h: Hit| [h.t.to_bits(), h.u.to_bits(), h.v.to_bits(), h.primitive];
        for (i, (hit, &expected)) in hits.iter().zip(&setup.expected).enumerate() {
            let ray = setup.rays.get(i);
            assert_eq!(bits(hit), bits(expected), "{what}: ray {i} {ray:?}: {hit:?}, expected {expected:?}");
            assert_eq!(occluded.get(i), !expected.is_miss(), "{what}: any, ray {i} {ray:?}");
        }
    }
    counters
}

fn soup() -> (Mesh, RayBatch) {
    let mut random = Random(3);
    let mesh = random::soup(&mut random, 500, 0.3);
    let rays = all_kinds(&mut random, &mesh);
    (mesh, rays)
}

#[test]
fn hits_at_all_levels_and_widths() {
    let (mesh, rays) = soup();
    let setup = setup(&mesh, &BuildConfig::default(), rays);
    let octo = OctoBvh::new(&setup.bvh, &OctoConfig::default()).expect("few nodes");
    let mut expected = Vec::new();
    for level in Level::available() {
        for width in [Width::One, Width::Four, Width::Eight, Width::Sixteen] {
            let method = BreadthFirst::new(&setup.bvh, &octo, level, width);
            let counters = check(&method, &setup, &format!("{level}, {width}"));
            // What the frusta do is the same at all levels and widths, what the groups do at all levels.
            let frusta = crate::stats::Frusta { groups: 0, ..counters.frusta };
            expected.push(frusta);
            assert!(frusta.frusta > 5 && frusta.leaves > frusta.frusta, "{frusta:?}");
            assert_eq!(frusta, expected[0]);
        }
    }
}

#[test]
fn hits_with_all_parameters() {
    let (mesh, rays) = soup();
    let ten = BuildConfig::Binned(binned::Config { max_leaf: 10, traversal_cost: 4.0, ..binned::Config::default() });
    let setups = [setup(&mesh, &ten, rays.clone()), setup(&mesh, &BuildConfig::insertion(7), rays)];
    for (i, setup) in setups.iter().enumerate() {
        for (levels, max_leaf) in [(1, 0), (2, 4), (3, 0), (3, 10), (3, 255)] {
            let octo = OctoBvh::new(&setup.bvh, &OctoConfig { levels, max_leaf }).expect("few nodes");
            let method = BreadthFirst::new(&setup.bvh, &octo, Level::best(), Width::Auto);
            let base = check(&method, setup, "").frusta;
            assert_eq!(base.splits, 0);
            let what = format!("tree {i}, {levels} levels, {max_leaf}");
            let depth = check(&method.clone().with_visit(Visit::DepthFirst), setup, &format!("{what}, depth first"));
            assert_eq!((depth.frusta.leaves, depth.frusta.box_tests), (base.leaves, base.box_tests));
            let given = check(&method.clone().with_sort(None), setup, &format!("{what}, not sorted")).frusta;
            assert!(given.frusta < base.frusta, "what is not sorted makes less frusta, and wider ones");
            for packet in [16, 48, 512] {
                let method = method.clone().with_packet(packet);
                check(&method, setup, &format!("{what}, packets of {packet}"));
                check(&method.with_sort(None), setup, &format!("{what}, packets of {packet}, not sorted"));
            }
            for (key, cell) in [(Reorder::Hash, 0.2), (Reorder::Origin, 0.5), (Reorder::Direction, 0.1)] {
                let hash = RayHash::with_cell(&octo.bounds(), key, cell);
                check(&method.clone().with_sort(Some(hash)), setup, &format!("{what}, by {key}, cells of {cell}"));
            }
            for queue in [1, 7, 100] {
                let short = check(&method.clone().with_queue(queue), setup, &format!("{what}, queue of {queue}"));
                // Splitting leaves out nothing and repeats nothing, but for how often leaves are carried down.
                let same = |f: crate::stats::Frusta| (f.frusta, f.leaves, f.box_tests, f.groups, f.rays);
                assert_eq!(same(short.frusta), same(base), "{what}, queue of {queue}");
                assert!(short.frusta.splits > 0 || queue != 7, "{what}, queue of {queue}");
            }
        }
    }
}

#[test]
fn threads_change_nothing() {
    let (mesh, rays) = soup();
    let many: RayBatch = (0..40_000).map(|i| rays.get(i % rays.len())).collect();
    let bvh = Bvh::build(&mesh, &BuildConfig::default(), &Silent).expect("a valid mesh");
    let octo = OctoBvh::new(&bvh, &OctoConfig::default()).expect("few nodes");
    let method = BreadthFirst::new(&bvh, &octo, Level::best(), Width::Auto);
    let mut expected = None;
    for threads in [1, 2, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let mut hits = HitBatch::new();
        let mut cx = Context { counters: Some(Counters::default()), cancel: None };
        pool.install(|| method.closest(&many, &mut hits, &mut cx)).expect("not cancelled");
        let found = (hits.hash(), cx.counters);
        assert_eq!(*expected.get_or_insert(found), found, "{threads} threads");
    }
}

#[test]
fn nothing_to_do() {
    let (mesh, rays) = soup();
    let mut bvh = Bvh::build(&mesh, &BuildConfig::default(), &Silent).expect("a valid mesh");
    let octo = OctoBvh::new(&bvh, &OctoConfig::default()).expect("few nodes");
    let none = Setup { bvh: bvh.clone(), rays: RayBatch::new(), expected: Vec::new() };
    check(&BreadthFirst::new(&bvh, &octo, Level::best(), Width::Auto), &none, "no rays");
    bvh.nodes.clear();
    bvh.triangles.clear();
    let octo = OctoBvh::new(&bvh, &OctoConfig::default()).expect("no nodes");
    let expected = vec![Hit::MISS; rays.len()];
    let empty = Setup { bvh, rays, expected };
    check(&BreadthFirst::new(&empty.bvh, &octo, Level::best(), Width::Auto), &empty, "no triangles");
}
