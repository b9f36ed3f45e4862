//! Counters and interval tests against a walk that is written for nothing but to be plain.

mod walk;

use super::*;
use crate::bvh::BuildConfig;
use crate::geometry::{Hit, Ray};
use crate::model::Model;
use crate::progress::Silent;
use walk::Walk;

struct Random(u32);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as f32 / 8_388_608.0 - 1.0
    }

    fn point(&mut self) -> [f32; 3] {
        [self.next(), self.next(), self.next()]
    }
}

/// Rays of a camera, rays from near each other to all sides, and rays from everywhere; some short, some of no use.
fn rays(number: usize) -> RayBatch {
    let mut random = Random(1);
    let third = number / 3;
    (0..number)
        .map(|i| {
            let (org, dir) = match i / third {
                0 => {
                    let (x, y) = ((i % 24) as f32 / 24.0 - 0.5, (i / 24 % 24) as f32 / 24.0 - 0.5);
                    ([2.1, 1.3, 1.7], [-2.1 + x, -1.3 - x + 0.5 * y, -1.7 + y])
                }
                1 => {
                    let at = [(i / 64 % 3) as f32 * 0.4, (i / 192 % 3) as f32 * 0.3, 0.6];
                    (random.point().map(|x| 0.05 * x).map(|x| x + at[i % 3]), random.point())
                }
                _ => (random.point().map(|x| 2.0 * x), random.point()),
            };
            let t_max = if i % 5 == 0 { 0.7 } else { f32::INFINITY };
            let dir = if i % 97 == 0 { [0.0; 3] } else { dir };
            Ray { org, t_min: if i % 7 == 0 { 0.1 } else { 0.0 }, dir, t_max }
        })
        .collect()
}

fn check(bvh: &Bvh, rays: &RayBatch, method: &Reordering, what: &str) -> walk::Intervals {
    let mut intervals = walk::Intervals::default();
    for any in [false, true] {
        let mut cx = Context { counters: Some(Counters::default()), cancel: None };
        let (mut hits, mut occluded) = (HitBatch::new(), BitVec::new());
        let done =
            if any { method.any(rays, &mut occluded, &mut cx) } else { method.closest(rays, &mut hits, &mut cx) };
        assert!(done.is_ok());
        let mut walk = Walk::new(bvh, method, any);
        let found: Vec<Hit> = walk.run(rays);
        for (i, expected) in found.iter().enumerate() {
            if any {
                assert_eq!(occluded.get(i), !expected.is_miss(), "{what}, any, ray {i}");
            } else {
                assert_eq!(hits.get(i), *expected, "{what}, ray {i}");
            }
        }
        assert_eq!(cx.counters, Some(walk.counters), "{what}, {}", if any { "any" } else { "closest" });
        intervals.all_hit += walk.intervals.all_hit;
        intervals.all_miss += walk.intervals.all_miss;
    }
    intervals
}

#[test]
fn counters_are_those_of_a_plain_walk_and_interval_tests_are_right() {
    let (model, _) = Model::open("balls:2", &Silent).expect("built in");
    let rays = rays(1200);
    let mut intervals = walk::Intervals::default();
    for config in [BuildConfig::default(), BuildConfig::insertion(3)] {
        let bvh = Bvh::build(&model.mesh, &config, &Silent).expect("a valid mesh");
        let mut check = |method: Reordering, what: &str| {
            let of = check(&bvh, &rays, &method, what);
            intervals.all_hit += of.all_hit;
            intervals.all_miss += of.all_miss;
        };
        check(Reordering::new(&bvh, Level::SCALAR, Width::One, Traversal::Single), "single");
        for width in [Width::Four, Width::Eight, Width::Sixteen] {
            for traversal in [Traversal::Simd, Traversal::Packet, Traversal::Adaptive, Traversal::Exact] {
                let method = Reordering::new(&bvh, Level::SCALAR, width, traversal);
                check(method, &format!("{traversal:?}, {width}"));
            }
            let method = Reordering::new(&bvh, Level::SCALAR, width, Traversal::Adaptive);
            let method = method.with_packet(112).with_threshold(0.7).with_interval_tests_from(0);
            check(method.clone().with_intervals(crate::method::Intervals::Loose), &format!("loose, {width}"));
            check(method.with_partition(Partition::InPlace), &format!("in place, {width}"));
        }
    }
    assert!(intervals.all_hit > 100 && intervals.all_miss > 2000, "{intervals:?}");
}

#[test]
fn depths_are_those_of_the_nodes() {
    let (model, _) = Model::open("balls:1", &Silent).expect("built in");
    let bvh = Bvh::build(&model.mesh, &BuildConfig::default(), &Silent).expect("a valid mesh");
    let depths = tally::depths(&bvh);
    assert_eq!((depths.len(), depths[0], depths[1]), (bvh.nodes.len(), 0, 1));
    for (i, node) in bvh.nodes.iter().enumerate().filter(|(_, node)| node.triangles().1 == 0) {
        assert_eq!(depths[bvh.nodes[i + 1].skip() as usize], depths[i] + 1, "{i} {node:?}");
    }
}
