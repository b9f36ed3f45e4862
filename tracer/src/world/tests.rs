//! Worlds against loops over their instances, and over their primitives.

use super::*;
use crate::geometry::{HitBatch, Packet};
use crate::model::Mesh;
use crate::scene::random::{Random, rays, soup};
use std::sync::atomic::{AtomicUsize, Ordering};

type Rows = [[f32; 4]; 3];

/// Spheres, in boxes that are larger by a factor.
struct Spheres {
    spheres: Vec<([f32; 3], f32)>,
    boxes: f32,
}

impl Spheres {
    fn random(random: &mut Random, n: usize, boxes: f32) -> Self {
        Self { spheres: (0..n).map(|_| (random.point(1.0), random.between(0.02, 0.3))).collect(), boxes }
    }
}

impl Primitives for Spheres {
    fn count(&self) -> usize {
        self.spheres.len()
    }

    fn bounds(&self, i: usize) -> Aabb {
        let (c, r) = self.spheres[i];
        Aabb { min: c.map(|x| x - self.boxes * r), max: c.map(|x| x + self.boxes * r) }
    }

    fn closest(&self, i: usize, ray: &Ray) -> Option<Hit> {
        let (c, r) = self.spheres[i];
        let o: [f32; 3] = std::array::from_fn(|k| ray.org[k] - c[k]);
        let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let (a, b) = (dot(ray.dir, ray.dir), dot(o, ray.dir));
        let root = (b * b - a * (dot(o, o) - r * r)).sqrt();
        let t =
            [(-b - root) / a, (-b + root) / a].into_iter().find(|t| (ray.t_min.max(0.0)..=ray.t_max).contains(t))?;
        // The library knows the number itself.
        Some(Hit { t, u: 0.2 * (i % 5) as f32, v: 0.5, primitive: 77 })
    }
}

/// Turned, scaled (on each axis otherwise, perhaps mirrored), sheared and moved.
fn affine(random: &mut Random, moved: f32) -> Rows {
    let shift = random.point(moved);
    let stretch =
        [0, 1, 2].map(|_| random.between(0.3, 2.0) * if random.bits().is_multiple_of(4) { -1.0 } else { 1.0 });
    if random.bits().is_multiple_of(3) {
        // Flat boxes stay flat.
        return [0, 1, 2].map(|i| [0, 1, 2, 3].map(|k| if k == 3 { shift[i] } else { f32::from(i == k) * stretch[i] }));
    }
    let (a, b) = (random.between(0.0, 6.0), random.between(-0.5, 0.5));
    let turn = [[a.cos(), -a.sin(), b], [a.sin(), a.cos(), 0.0], [0.0, b, 1.0]];
    [0, 1, 2].map(|i| [turn[i][0] * stretch[0], turn[i][1] * stretch[1], turn[i][2] * stretch[2], shift[i]])
}

/// Scenes of triangles here and there, and of flat plates.
fn scenes(random: &mut Random) -> Vec<Arc<Scene>> {
    let plates = || {
        let mut mesh = Mesh::default();
        for z in [-0.7, 0.1, 0.3_f32] {
            let at = mesh.positions.len() as u32;
            mesh.positions.extend([[-1.0, -1.0, z], [1.0, -1.0, z], [1.0, 1.0, z], [-1.0, 1.0, z]]);
            mesh.triangles.extend([[at, at + 1, at + 2], [at, at + 2, at + 3]]);
        }
        mesh
    };
    let mut plate = plates();
    plate.triangles.truncate(2);
    let build = |builder: crate::SceneBuilder| Arc::new(builder.build().expect("valid meshes"));
    vec![
        build(Scene::builder().mesh(soup(random, 40, 0.4)).mask(0b0011).mesh(soup(random, 20, 0.2)).mask(0b0101)),
        build(Scene::builder().mesh(plate)),
        build(Scene::builder().mesh(soup(random, 1, 0.5))),
        build(Scene::builder().mesh(plates())),
        // Nothing that can be hit.
        build(Scene::builder().triangles(vec![[0.0; 3]], vec![[0, 0, 0]])),
    ]
}

/// Rays from near and far, some with numbers that boxes do not allow for.
fn questions(random: &mut Random, n: usize, far: f32) -> RayBatch {
    let around = soup(random, 30, 2.0);
    rays(random, &around, n)
        .iter()
        .enumerate()
        .map(|(i, ray)| {
            let to: [f32; 3] = std::array::from_fn(|k| ray.org[k] + ray.dir[k]);
            let org = random.point(far);
            match i % 7 {
                0 | 1 => Ray::new(org, std::array::from_fn(|k| to[k] - org[k])),
                2 => Ray { dir: ray.dir.map(|d| [1e-20, 1e-38][i % 2] * d), ..ray },
                3 if i % 2 == 0 => Ray { dir: ray.dir.map(|d| 1e20 * d), ..ray },
                4 if i % 3 == 0 => {
                    Ray { org: [ray.org[0], 1e19, ray.org[2]], dir: [1e-7 * ray.dir[0], -1e19, 0.0], ..ray }
                }
                _ => ray,
            }
        })
        .collect()
}

/// By a loop over all instances, and over the primitives of those that have such.
fn first(world: &World, ray: &Ray, accept: impl Fn(&WorldHit) -> bool) -> WorldHit {
    let mut best = WorldHit::MISS;
    for (of, instance) in world.instances.iter().zip(0..) {
        let (ray, accept) = (world.object_ray(instance, ray), |hit: &Hit| accept(&WorldHit { hit: *hit, instance }));
        let hits: Vec<Hit> = match &of.content {
            Content::Scene(scene) => scene.closest_where(&ray, accept).into_iter().collect(),
            Content::Items(items) => {
                let packet = Packet::of(&ray);
                let all = (0..items.len() as u32).filter_map(|i| items.closest(i, &ray, &packet));
                all.filter(|hit| packet.valid && accept(hit)).collect()
            }
        };
        for hit in hits {
            let key = |found: &WorldHit| (found.hit.t, found.instance, found.hit.primitive);
            let found = WorldHit { hit, instance };
            best = if best.is_miss() || key(&found) < key(&best) { found } else { best };
        }
    }
    best
}

#[test]
fn worlds_find_what_loops_over_instances_find() {
    let mut random = Random(11);
    let scenes = scenes(&mut random);
    let shared = [1.5, 3.0].map(|boxes| Arc::new(Spheres::random(&mut random, 40, boxes)));
    let (mut hits_seen, mut refused) = (0, 0);
    for (n, moved, far) in [(1, 0.0, 3.0), (12, 2.0, 5.0), (60, 3.0, 100.0), (25, 100.0, 1e4), (40, 2.0, 1e6)] {
        let mut builders: Vec<WorldBuilder> = Level::available().map(|level| World::builder().level(level)).collect();
        for i in 0..n {
            let (rows, mask) = (affine(&mut random, moved), 1 << (i % 5));
            let own = i % 4 == 3;
            builders = builders
                .into_iter()
                .map(|builder| match own {
                    true => builder.primitives(shared[i / 4 % 2].clone(), rows).mask(mask),
                    false => builder.instance(scenes[i % scenes.len()].clone(), rows).mask(mask | 1),
                })
                .collect();
        }
        let questions = questions(&mut random, 300, far);
        let masks: Vec<u32> = (0..300).map(|i| [0b0001, 0b0110, u32::MAX, 0][i % 4]).collect();
        let takes =
            |ray: usize, hit: &WorldHit| !(hit.hit.primitive as usize + ray).is_multiple_of(3) && hit.hit.u < 0.8;
        let mut expected = Vec::new();
        for builder in builders {
            let world = builder.build().expect("a sound world");
            let what = format!("{}, {n} instances", world.level);
            if expected.is_empty() {
                expected.extend(questions.iter().enumerate().map(|(i, ray)| {
                    let find = |accept: &dyn Fn(&WorldHit) -> bool| first(&world, &ray, accept);
                    let sees = |hit: &WorldHit| world.is_visible(hit, masks[i]);
                    [find(&|_| true), find(&|hit| takes(i, hit)), find(&sees), find(&|hit| sees(hit) && takes(i, hit))]
                }));
            }
            let mut closest = [const { Vec::new() }; 4];
            let mut occluded = [const { BitVec::new() }; 4];
            let both = |i: usize, hit: &WorldHit| world.is_visible(hit, masks[i]) && takes(i, hit);
            world.closest_batch(&questions, &mut closest[0]);
            world.closest_batch_where(&questions, &mut closest[1], takes);
            world.closest_batch_masked(&questions, &masks, &mut closest[2]).expect("a mask for each");
            world.closest_batch_where(&questions, &mut closest[3], both);
            world.occluded_batch(&questions, &mut occluded[0]);
            world.occluded_batch_where(&questions, &mut occluded[1], takes);
            world.occluded_batch_masked(&questions, &masks, &mut occluded[2]).expect("a mask for each");
            world.occluded_batch_where(&questions, &mut occluded[3], both);
            for (i, ray) in questions.iter().enumerate() {
                for query in 0..4 {
                    let expected = expected[i][query];
                    assert_eq!(closest[query][i], expected, "{what}, query {query}, ray {i} {ray:?}");
                    assert_eq!(occluded[query].get(i), !expected.is_miss(), "{what}, query {query}, ray {i} {ray:?}");
                }
                let one = [
                    (world.closest(&ray), world.occluded(&ray)),
                    (world.closest_where(&ray, |hit| takes(i, hit)), world.occluded_where(&ray, |hit| takes(i, hit))),
                    (world.closest_masked(&ray, masks[i]), world.occluded_masked(&ray, masks[i])),
                    (world.closest_where(&ray, |hit| both(i, hit)), world.occluded_where(&ray, |hit| both(i, hit))),
                ];
                for (query, (hit, occluded)) in one.into_iter().enumerate() {
                    let expected = expected[i][query];
                    assert_eq!(
                        (hit.unwrap_or(WorldHit::MISS), occluded),
                        (expected, !expected.is_miss()),
                        "{what}, ray {i}"
                    );
                }
                hits_seen += usize::from(!expected[i][0].is_miss());
                refused += usize::from(expected[i][3] != expected[i][0]);
            }
        }
    }
    assert!(hits_seen > 1000 && refused > 500, "{hits_seen}, {refused}");
}

/// Hits on plates far away, whose own boxes have no thickness, are lost without growing boxes.
#[test]
fn no_hit_on_a_flat_box_is_lost() {
    let mut random = Random(12);
    let plate = vec![[-1.0, -1.0, 0.1], [1.0, -1.0, 0.1], [1.0, 1.0, 0.1], [-1.0, 1.0, 0.1]];
    let plate = Arc::new(Scene::builder().triangles(plate, vec![[0, 1, 2], [0, 2, 3]]).build().expect("valid"));
    let mut found = 0;
    for case in 0..400 {
        let size = [1.0, 1e-3, 1e3, 1e6][case % 4];
        let mut rows = affine(&mut random, [0.0, 10.0, 1e4][case % 3]);
        rows.iter_mut().for_each(|row| row[..3].iter_mut().for_each(|x| *x *= size));
        let mut builder = World::builder();
        for i in 0..9 {
            let mut moved = rows;
            moved[i % 3][3] += size * i as f32;
            builder = builder.instance(plate.clone(), moved);
        }
        let world = builder.build().expect("a sound world");
        for _ in 0..50 {
            let i = (random.bits() % 9) as u32;
            // A point of the plate, often on its border.
            let [u, v] = [0, 1].map(|_| random.between(-1.4, 1.4).clamp(-1.0, 1.0));
            let moved = |k: usize| if k == i as usize % 3 { size * i as f32 } else { 0.0 };
            let to = [0, 1, 2].map(|k| rows[k][0] * u + rows[k][1] * v + rows[k][2] * 0.1 + rows[k][3] + moved(k));
            let org = random.point([1.0, 100.0, 1e6][case / 4 % 3] * size);
            let ray = Ray::new(org, std::array::from_fn(|k| to[k] - org[k]));
            let mut best = WorldHit::MISS;
            for instance in 0..9 {
                let hit = plate.closest(&world.object_ray(instance, &ray)).unwrap_or(Hit::MISS);
                best = if hit.t < best.hit.t { WorldHit { hit, instance } } else { best };
            }
            assert_eq!(world.closest(&ray).unwrap_or(WorldHit::MISS), best, "case {case}, {ray:?}");
            found += usize::from(!best.is_miss());
        }
    }
    assert!(found > 10_000, "{found}");
}

#[test]
fn the_lower_instance_wins_and_an_identity_changes_nothing() {
    let mut random = Random(13);
    let mesh = soup(&mut random, 60, 0.5);
    let scene = Arc::new(Scene::builder().mesh(mesh.clone()).build().expect("a valid mesh"));
    let mut builder = World::builder();
    for _ in 0..20 {
        builder = builder.instance(scene.clone(), World::IDENTITY);
    }
    let world = builder.build().expect("a sound world");
    let rays = rays(&mut random, &mesh, 200);
    let (mut hits, mut alone) = (Vec::new(), HitBatch::new());
    world.closest_batch(&rays, &mut hits);
    scene.closest_batch(&rays, &mut alone);
    for (found, hit) in hits.iter().zip(alone.iter()) {
        let expected = if hit.is_miss() { WorldHit::MISS } else { WorldHit { hit, instance: 0 } };
        assert_eq!(*found, expected);
    }
    assert_eq!((world.instances(), hits.len()), (20, 200));
    let (b, tight) = (world.bounds(), mesh.bounds());
    assert!(b.contains(&tight) && (0..3).all(|k| b.max[k] < tight.max[k] + 1e-3 && b.min[k] > tight.min[k] - 1e-3));
}

/// Hits where they cannot be, and answers of whether there is one that count.
struct Sloppy {
    t: Vec<f32>,
    asked: AtomicUsize,
}

impl Primitives for Sloppy {
    fn count(&self) -> usize {
        self.t.len()
    }
    fn bounds(&self, i: usize) -> Aabb {
        Aabb { min: [0.0, 0.0, i as f32], max: [1.0, 1.0, i as f32 + 0.5] }
    }
    fn closest(&self, i: usize, _: &Ray) -> Option<Hit> {
        Some(Hit { t: self.t[i], u: 0.0, v: 0.0, primitive: 0 })
    }
    fn occluded(&self, i: usize, ray: &Ray) -> bool {
        self.asked.fetch_add(1, Ordering::Relaxed);
        self.closest(i, ray).is_some_and(|hit| hit.t <= ray.t_max)
    }
}

#[test]
fn hits_of_primitives_are_moved_into_their_boxes() {
    let up = Ray { t_max: 100.0, ..Ray::new([0.5, 0.5, -1.0], [0.0, 0.0, 1.0]) };
    let world = |t: &[f32]| {
        let sloppy = Arc::new(Sloppy { t: t.to_vec(), asked: AtomicUsize::new(0) });
        (World::builder().primitives(sloppy.clone(), World::IDENTITY).build().expect("sound boxes"), sloppy)
    };
    // In its box, before it, behind it; no number; out of the ray's interval.
    let t = |of: &[f32]| world(of).0.closest(&up).map(|found| (found.hit.primitive, found.hit.t));
    assert_eq!(t(&[1.25]), Some((0, 1.25)));
    assert_eq!(t(&[0.25]), Some((0, 1.0)));
    assert!(t(&[50.0]).is_some_and(|(i, t)| i == 0 && (1.5..1.501).contains(&t)));
    assert_eq!((t(&[f32::NAN]), t(&[101.0]), t(&[-1.0])), (None, None, None));
    // The third says that it is before the first, which it cannot be.
    assert_eq!(t(&[1.25, f32::NAN, 0.0]), Some((0, 1.25)));
    let (world, sloppy) = world(&[101.0, 1.0]);
    assert!(world.occluded(&up) && sloppy.asked.load(Ordering::Relaxed) > 0);
    let beside = Ray { org: [1.5, 0.5, -1.0], ..up };
    assert!(!world.occluded(&beside) && world.closest(&beside).is_none());
}

#[test]
fn what_cannot_be_built_says_where() {
    let scene = Scene::builder().triangles(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]);
    let scene = Arc::new(scene.build().expect("a triangle"));
    let fails = |builder: WorldBuilder, reasons: [&str; 2]| {
        let e = builder.build().expect_err("not sound").to_string();
        assert!(reasons.iter().all(|reason| e.contains(reason)), "{e}");
    };
    let first = || World::builder().instance(scene.clone(), World::IDENTITY);
    fails(World::builder(), ["no instances", "add"]);
    fails(first().instance(scene.clone(), [[0.0; 4]; 3]), ["instance 1", "no inverse"]);
    fails(first().instance(scene.clone(), [[f32::NAN; 4]; 3]), ["instance 1", "finite"]);
    let far = [[1.0, 0.0, 0.0, 1e30], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    fails(first().instance(scene.clone(), far), ["instance 1", "2^60"]);
    let spheres = |spheres: Vec<([f32; 3], f32)>| Arc::new(Spheres { spheres, boxes: 1.0 });
    let bad = spheres(vec![([0.0; 3], 1.0), ([0.0; 3], -1.0)]);
    fails(first().primitives(bad, World::IDENTITY), ["instance 1", "primitive 1"]);
    fails(first().primitives(spheres(vec![([f32::NAN; 3], 1.0)]), World::IDENTITY), ["instance 1", "primitive 0"]);

    // Nothing in it is no fault.
    let world = World::builder().primitives(spheres(Vec::new()), World::IDENTITY).build().expect("an empty world");
    assert!(world.closest(&Ray::new([0.0; 3], [1.0; 3])).is_none() && world.bounds() == Aabb::EMPTY);
    let rays: RayBatch = [Ray::new([0.0; 3], [1.0; 3])].into_iter().collect();
    let e = world.closest_batch_masked(&rays, &[], &mut Vec::new()).expect_err("no mask");
    assert!(e.to_string().contains("0 masks for 1 rays"), "{e}");
}
