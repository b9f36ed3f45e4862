//! Against the loop over all triangles.

use super::*;
use crate::model::Mesh;
use crate::scene::random::{Random, hits_of, rays, soup};
use crate::stats::Counters;

fn expected(mesh: &Mesh, rays: &RayBatch) -> Vec<Hit> {
    let first = |hits: Vec<Hit>| hits.into_iter().reduce(|a, b| if found::is_better(&b, &a) { b } else { a });
    rays.iter().map(|ray| first(hits_of(mesh, &ray)).unwrap_or(Hit::MISS)).collect()
}

fn bits(hit: Hit) -> [u32; 4] {
    [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive]
}

fn check(what: &str, method: &DivideConquer, rays: &RayBatch, expected: &[Hit]) -> Counters {
    let mut cx = Context { counters: Some(Counters::default()), cancel: None };
    let (mut hits, mut occluded) = (HitBatch::new(), BitVec::new());
    // Twice: the second time there are rooms that the first has left.
    for _ in 0..2 {
        method.closest(rays, &mut hits, &mut cx).expect("not cancelled");
    }
    for (i, (hit, expected)) in hits.iter().zip(expected).enumerate() {
        assert_eq!(bits(hit), bits(*expected), "{what}: ray {i} {:?}", rays.get(i));
    }
    method.any(rays, &mut occluded, &mut cx).expect("not cancelled");
    assert!(expected.iter().enumerate().all(|(i, hit)| occluded.get(i) != hit.is_miss()), "{what}: any");
    cx.counters.expect("asked for")
}

fn check_all(what: &str, mesh: &Mesh, rays: &RayBatch) {
    let expected = expected(mesh, rays);
    let triangles = TriangleBoxes::new(mesh).expect("a valid mesh");
    for level in Level::available() {
        for width in [Width::One, Width::Four, Width::Eight, Width::Sixteen] {
            let method = || DivideConquer::new(&triangles, level, width);
            let what = format!("{what}, {level}, {width}");
            check(&what, &method(), rays, &expected);
            check(&what, &method().with_filtering(Filtering::Places), rays, &expected);
            let small = DivideLimits { few_rays: 0, few_triangles: 1, filter_below: 1.0, ..DivideLimits::default() };
            check(&what, &method().with_limits(small), rays, &expected);
        }
    }
}

#[test]
fn random_triangles_and_rays() {
    let mut random = Random(11);
    for (triangles, size, n) in [(1, 1.0, 50), (7, 0.5, 100), (300, 0.3, 700), (2000, 0.05, 300)] {
        let mesh = soup(&mut random, triangles, size);
        let rays = rays(&mut random, &mesh, n);
        check_all(&format!("{triangles} triangles"), &mesh, &rays);
    }
}

#[test]
fn one_center_flat_boxes_and_lines() {
    let mut random = Random(12);
    // All centers in one point; all boxes flat; and triangles in a row that get ever smaller.
    let mut same = Mesh::default();
    let mut flat = Mesh::default();
    let mut row = Mesh::default();
    for i in 0..200 {
        let p = random.point(1.0);
        let s = 0.5 + random.between(0.0, 1.0);
        add(&mut same, [[-s, -s, 0.1 * s], [s, -s, -0.1 * s], [0.0, s, 0.0]]);
        add(&mut flat, [[p[0], p[1], 0.25], [p[0] + 0.2, p[1], 0.25], [p[0], p[1] + 0.1, 0.25]]);
        let x = 0.9_f32.powi(i);
        add(&mut row, [[x, -0.5, -0.5], [x, 0.5, -0.5], [x, 0.0, 0.5]]);
    }
    for (what, mesh) in [("one center", same), ("flat", flat), ("row", row)] {
        let rays = rays(&mut random, &mesh, 400);
        check_all(what, &mesh, &rays);
    }
}

fn add(mesh: &mut Mesh, corners: [[f32; 3]; 3]) {
    let n = mesh.positions.len() as u32;
    mesh.positions.extend(corners);
    mesh.triangles.push([n, n + 1, n + 2]);
}

/// Many rays, so that there are tasks, samples and parts; the work of one thread is the same at each level.
#[test]
fn threads_find_the_same() {
    let mut random = Random(13);
    let mesh = soup(&mut random, 30_000, 0.05);
    let few = soup(&mut random, 2000, 0.2);
    for (mesh, n) in [(mesh, 24_000), (few, 40_000)] {
        let rays = rays(&mut random, &mesh, n);
        let triangles = TriangleBoxes::new(&mesh).expect("a valid mesh");
        let bvh = crate::bvh::Bvh::build(&mesh, &crate::bvh::BuildConfig::default(), &crate::progress::Silent);
        let bvh = bvh.expect("a valid mesh");
        let mut hits = HitBatch::new();
        let packet = crate::method::Packet::new(&bvh, Level::best(), Width::Auto);
        packet.closest(&rays, &mut hits, &mut Context::default()).expect("not cancelled");
        let expected: Vec<Hit> = hits.iter().collect();
        let mut work = None;
        for threads in [1, 2, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            for sharing in [Sharing::Naive, Sharing::Tasks] {
                let method = DivideConquer::new(&triangles, Level::best(), Width::Eight).with_sharing(sharing);
                let what = format!("{threads} threads, {sharing:?}");
                let counters = pool.install(|| check(&what, &method, &rays, &expected));
                if threads == 1 {
                    assert_eq!(*work.get_or_insert(counters), counters, "{what}");
                }
                assert!(method.memory() > 32 * n);
            }
        }
    }
}

#[test]
fn a_raised_flag_stops_it() {
    let mut random = Random(14);
    let mesh = soup(&mut random, 100, 0.5);
    let rays = rays(&mut random, &mesh, 100);
    let triangles = TriangleBoxes::new(&mesh).expect("a valid mesh");
    let flag = std::sync::atomic::AtomicBool::new(true);
    let mut cx = Context { counters: None, cancel: Some(&flag) };
    let method = DivideConquer::new(&triangles, Level::best(), Width::Auto);
    assert!(matches!(method.closest(&rays, &mut HitBatch::new(), &mut cx), Err(Error::Cancelled)));
}

#[test]
fn an_empty_batch_and_what_cannot_be_hit() {
    let mut mesh = Mesh::default();
    add(&mut mesh, [[0.0; 3]; 3]);
    let triangles = TriangleBoxes::new(&mesh).expect("a valid mesh");
    let rays: RayBatch = [crate::geometry::Ray::new([0.0; 3], [0.0, 0.0, 1.0])].into_iter().collect();
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        for sharing in [Sharing::Naive, Sharing::Tasks] {
            let method = DivideConquer::new(&triangles, Level::best(), Width::Auto).with_sharing(sharing);
            let mut hits = HitBatch::new();
            let mut ask = |rays: &RayBatch| {
                pool.install(|| method.closest(rays, &mut hits, &mut Context::default())).expect("not cancelled");
                hits.clone()
            };
            assert!(ask(&RayBatch::new()).is_empty());
            assert!(ask(&rays).get(0).is_miss());
        }
    }
}

#[test]
fn bytes_as_in_the_paper() {
    assert_eq!(DivideConquer::bytes(1000, 100, 4), 32 * 1000 + (48 + 4 * 4) * 100);
    let mut random = Random(8);
    let mesh = soup(&mut random, 5000, 0.1);
    let triangles = TriangleBoxes::new(&mesh).expect("a valid mesh");
    let rays: RayBatch = (0..20_000).map(|_| crate::geometry::Ray::new(random.point(1.0), random.point(1.0))).collect();
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        let method = DivideConquer::new(&triangles, Level::best(), Width::Auto).with_sharing(Sharing::Naive);
        for _ in 0..2 {
            pool.install(|| method.closest(&rays, &mut HitBatch::new(), &mut Context::default()))
                .expect("not cancelled");
        }
        // Hits (16 bytes) are left out in the paper; the ids of all triangles are held beside those of each thread.
        let (r, t) = (rays.len(), mesh.triangles.len());
        let most = DivideConquer::bytes(r, t, threads) + 16 * r + 2 * size_of::<u32>() * t;
        let held = triangles.memory() + method.memory();
        assert!(held <= most && held > most / 2, "{threads} threads: {held} bytes of {most}");
    }
}
