//! Every way of finding hits, at every level, against the loop over all triangles: the same bits.

use crate::brute_force;
use simd::{Isa, Level};
use tracer::Scene;
use tracer::bvh::{BuildConfig, Bvh, CollapseConfig, OctoBvh, OctoConfig, WideBvh};
use tracer::geometry::{Aabb, Hit, HitBatch, RayBatch, Triangle};
use tracer::method::{
    Auto, BitVec, BreadthFirst, Context, DivideConquer, DivideLimits, Filtering, Intervals, Limits, Method, Packet,
    Partition, Reordering, SharedOrigin, Single, SlabForm, Sorted, Traversal, TriangleBoxes, Visit, Width,
};
use tracer::model::Mesh;
use tracer::progress::Silent;
use tracer::sort::{RayHash, Reorder};

/// The trees that methods need over a mesh.
#[derive(Debug)]
pub struct Trees {
    name: &'static str,
    binary: Bvh,
    four: WideBvh<4>,
    eight: WideBvh<8>,
    sixteen: WideBvh<16>,
    boxes: TriangleBoxes,
    octo: OctoBvh,
    /// The same with two children a node and larger leaves.
    halves: OctoBvh,
}

impl Trees {
    /// By the binned builder.
    ///
    /// # Panics
    /// If the mesh is not valid, as the other constructor.
    #[must_use]
    pub fn binned(mesh: &Mesh) -> Self {
        Self::new("binned", mesh, &BuildConfig::default())
    }

    /// By the insertion builder.
    #[must_use]
    pub fn insertion(mesh: &Mesh) -> Self {
        Self::new("insertion", mesh, &BuildConfig::insertion(7))
    }

    fn new(name: &'static str, mesh: &Mesh, config: &BuildConfig) -> Self {
        let binary = Bvh::build(mesh, config, &Silent).expect("a valid mesh");
        let config = CollapseConfig::default();
        let (four, eight, sixteen) = (binary.collapse(&config), binary.collapse(&config), binary.collapse(&config));
        let boxes = TriangleBoxes::new(mesh).expect("a valid mesh");
        let octo = |config| OctoBvh::new(&binary, &config).expect("few nodes");
        let (octo, halves) = (octo(OctoConfig::default()), octo(OctoConfig { levels: 1, max_leaf: 20 }));
        Self { name, binary, four, eight, sixteen, boxes, octo, halves }
    }
}

/// What the definition says, ray by ray.
#[must_use]
pub fn by_brute_force(mesh: &Mesh, rays: &RayBatch) -> Vec<Hit> {
    let triangles: Vec<Triangle> = brute_force::triangles(mesh);
    rays.iter().map(|ray| brute_force::closest(&ray, &triangles)).collect()
}

/// Checks that all methods at the levels given find these hits, bit for bit, and that any hit is found where there is one. `closest` of
/// the hits are numbers: no NaN is among them.
///
/// # Panics
/// If a method finds something else.
pub fn check(what: &str, trees: &Trees, levels: &[Level], rays: &RayBatch, expected: &[Hit]) {
    for hit in expected {
        assert!(!hit.t.is_nan() && hit.u >= 0.0 && hit.v >= 0.0, "{what}: {hit:?}");
    }
    let early =
        Limits { together: -1.0, coherent: -1.0, blocks: 0, rays: 0, scatter: 1e9, apart: 1e9, ..Limits::default() };
    for &level in levels {
        let same = |method: &dyn Method, kind: &str| {
            let what = || format!("{what}, {} tree, {level}, {} {kind}", trees.name, method.name());
            check_method(&what, method, rays, expected);
        };
        same(&Single::<4>::new(&trees.four, level), "4");
        same(&Single::<8>::new(&trees.eight, level), "8");
        same(&Single::<16>::new(&trees.sixteen, level), "16");
        same(&Auto::new(&trees.eight, level), "");
        same(&Auto::new(&trees.eight, level).with_limits(early), "that keeps rays together");
        let bounds = trees.binary.nodes.first().map_or(Aabb::EMPTY, |root| root.bounds());
        same(&Sorted::new(Single::new(&trees.eight, level), level, &bounds, Reorder::Hash), "by hash");
        let packet = Packet::new(&trees.binary, level, Width::Auto);
        same(&Sorted::new(packet, level, &bounds, Reorder::Direction), "by direction");
        for width in [Width::One, Width::Four, Width::Eight, Width::Sixteen] {
            let packet = Packet::new(&trees.binary, level, width);
            same(&packet.with_shared_origin(SharedOrigin::Always), &format!("{width}"));
            let loose = packet.with_form(SlabForm::Conservative).with_shared_origin(SharedOrigin::Never);
            same(&loose, &format!("{width} conservative"));
            check_reordering(&trees.binary, level, width, &same);
            let divide = DivideConquer::new(&trees.boxes, level, width);
            same(&divide, &format!("{width}"));
            let limits = DivideLimits { few_rays: 0, few_triangles: 1, ..DivideLimits::default() };
            same(&divide.with_limits(limits).with_filtering(Filtering::Places), &format!("{width}, by places"));
            check_frusta(trees, level, width, &same);
        }
    }
}

fn check_reordering(bvh: &Bvh, level: Level, width: Width, same: &dyn Fn(&dyn Method, &str)) {
    let method = |traversal| Reordering::new(bvh, level, width, traversal);
    if width == Width::One {
        same(&method(Traversal::Single), "");
        return;
    }
    // Emulated levels have one lane at any width.
    if matches!(level.isa(), Isa::Serial | Isa::Scalar) && width != Width::Eight {
        return;
    }
    for traversal in [Traversal::Simd, Traversal::Packet, Traversal::Adaptive, Traversal::Exact] {
        same(&method(traversal), &format!("{width}"));
    }
    if width == Width::Eight {
        let often = method(Traversal::Adaptive).with_packet(80).with_threshold(0.9).with_interval_tests_from(0);
        same(&often.clone().with_intervals(Intervals::Loose), "8, loose");
        same(&often.with_partition(Partition::InPlace), "8, in place");
    }
}

fn check_frusta(trees: &Trees, level: Level, width: Width, same: &dyn Fn(&dyn Method, &str)) {
    // Emulated levels have one lane at any width.
    if matches!(level.isa(), Isa::Serial | Isa::Scalar) && width != Width::Eight {
        return;
    }
    let method = BreadthFirst::new(&trees.binary, &trees.octo, level, width);
    same(&method, &format!("{width}"));
    same(&method.clone().with_sort(None), &format!("{width}, not sorted"));
    if width != Width::Eight {
        return;
    }
    same(&method.clone().with_packet(16).with_queue(5), "8, small packets and queues");
    same(&method.clone().with_visit(Visit::DepthFirst), "8, depth first");
    let hash = RayHash::with_cell(&trees.octo.bounds(), Reorder::Origin, 0.1);
    let halves = BreadthFirst::new(&trees.binary, &trees.halves, level, width).with_sort(Some(hash));
    same(&halves, "8, two children a node");
    same(&halves.with_packet(1024).with_sort(None).with_queue(1), "8, two children a node, large packets");
}

/// Checks that watertight scenes over trees of two builders find the same, at all levels, in batches and ray by ray.
///
/// # Panics
/// If not, or if the mesh is not valid.
pub fn check_watertight(what: &str, mesh: &Mesh, levels: &[Level], rays: &RayBatch) {
    let mut expected = Vec::new();
    for config in [BuildConfig::default(), BuildConfig::insertion(7)] {
        for &level in levels {
            let scene = Scene::builder().mesh(mesh.clone()).watertight(true).level(level).build_config(config);
            let scene = scene.build().expect("a valid mesh");
            let method = scene.watertight().expect("asked for");
            if expected.is_empty() {
                expected = rays.iter().map(|ray| method.closest_of(&ray)).collect();
            }
            for hit in expected.iter().filter(|hit| !hit.is_miss()) {
                assert!(!hit.t.is_nan() && hit.u >= 0.0 && hit.v >= 0.0, "{what}: {hit:?}");
            }
            check_method(&|| format!("{what}, watertight, {config:?}, {level}"), &method, rays, &expected);
            let same = rays.iter().zip(&expected).all(|(ray, hit)| method.any_of(&ray) != hit.is_miss());
            assert!(same, "{what}, watertight, {level}: any hit of one ray");
        }
    }
}

fn check_method(what: &dyn Fn() -> String, method: &dyn Method, rays: &RayBatch, expected: &[Hit]) {
    let (mut hits, mut occluded, mut cx) = (HitBatch::new(), BitVec::new(), Context::default());
    method.closest(rays, &mut hits, &mut cx).expect("not cancelled");
    method.any(rays, &mut occluded, &mut cx).expect("not cancelled");
    assert_eq!((hits.len(), occluded.len()), (expected.len(), expected.len()), "{}", what());
    for (i, (hit, expected)) in hits.iter().zip(expected).enumerate() {
        assert_eq!(bits(hit), bits(*expected), "{}: ray {i} {:?}: {hit:?}, expected {expected:?}", what(), rays.get(i));
        assert_eq!(occluded.get(i), !expected.is_miss(), "{}: any, ray {i} {:?}", what(), rays.get(i));
    }
}

fn bits(hit: Hit) -> [u32; 4] {
    [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive]
}
