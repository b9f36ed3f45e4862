//! No box that a ray meets is culled, whatever rays and boxes.

use super::*;
use crate::geometry::Ray;
use crate::geometry::slab::{Near, PerRay, interval};
use crate::scene::random::Random;
use simd::{Level, Vector, kernel};

kernel! {
    fn frusta_of<S>(blocks: &[RayBlock], space: &Space) -> (Vec<Frustum>, Vec<(u32, u16)>) {
        let (mut frusta, mut odd) = (Vec::new(), Vec::new());
        for lanes in [0x0fff, 0xf000] {
            let survey = Survey::new::<S::Float>(blocks, lanes, space, &mut odd, 0);
            survey.frusta::<S::Float>(blocks, space, &mut frusta);
        }
        (frusta, odd)
    }
}

kernel! {
    /// The frustum's part around each group of four, and what it meets of the boxes up to a reach.
    fn part_meets<S>(frustum: &Frustum, block: &RayBlock, space: &Space, reach: f32, planes: &[f32; 8]) -> [bool; 4] {
        let mut met = [false; 4];
        for (chunk, met) in met.iter_mut().enumerate() {
            let ray = Packet::<S::Float4>::load(block, chunk);
            let on = frustum.members.of(&ray, chunk, space.largest);
            if on.any() {
                let mut part = frustum.part(&ray, on, space);
                part.shorten(&ray, on, ray.t_max.min(S::Float4::splat(reach)));
                let (low, high) = (Vec3::splat([planes[0], planes[1], planes[2]]), Vec3::splat([planes[4], planes[5], planes[6]]));
                *met = part.meets::<S::Float4>(low, high).any();
            }
        }
        met
    }
}

fn meets(frustum: &Frustum, planes: &[f32; 8]) -> bool {
    let vec3 = |i: usize| Vec3 { x: planes[i], y: planes[i + 1], z: planes[i + 2] };
    frustum.meets::<f32>(vec3(0), vec3(4))
}

/// By the exact test, as every method does it.
fn ray_meets(ray: &Packet<f32>, planes: &[f32; 8], reach: f32) -> bool {
    let [x, y, z] = ray.signs();
    let near = Near::of_octant(usize::from(x) | usize::from(y) << 1 | usize::from(z) << 2);
    let (t_near, t_far) = interval(planes, ray, PerRay, near, ray.t_min, ray.t_max.min(reach));
    t_near <= t_far
}

/// A number of some scale, now and then a special one.
fn number(random: &mut Random, scale: f32) -> f32 {
    match random.bits() % 24 {
        0 => 0.0,
        1 => -0.0,
        2 => scale,
        3 => -scale,
        4 => f32::MIN_POSITIVE,
        5 => 1e-42,
        6 => scale * 1e-6,
        _ => random.between(-scale, scale),
    }
}

/// Rays about one direction, or all over; from about one point, or all over.
fn packet(random: &mut Random, round: usize, scale: f32) -> Vec<RayBlock> {
    let (spread, scatter) = ([1.0, 0.1, 1e-3, 1e-6, 0.0][round % 5], [0.0, 1e-6, 0.1, 1.0][round / 5 % 4]);
    let at = [0; 3].map(|_| number(random, scale));
    let toward = [0; 3].map(|_| number(random, 1.0));
    let mut blocks = vec![RayBlock::NONE; 1 + round % 2];
    for i in 0..blocks.len() * 16 {
        let org = at.map(|x| x + scatter * number(random, scale));
        let length = [1.0, 1e-3, 1e6, 1.0][round / 7 % 4];
        let dir = toward.map(|x| length * (x + spread * number(random, 1.0)));
        let t_min = if i % 3 == 0 { number(random, scale) / length } else { 0.0 };
        let t_max = if i % 5 == 0 { number(random, scale).abs() / length } else { f32::INFINITY };
        let mut ray = Ray { org, t_min, dir, t_max };
        match random.bits() % 200 {
            0 => ray.dir[i % 3] = f32::NAN,
            1 => ray.dir[i % 3] = f32::INFINITY,
            2 => ray.org[i % 3] = 1e30,
            3 => ray.dir = ray.dir.map(|d| d * 1e25),
            4 => ray.dir = ray.dir.map(|d| d * 1e-30),
            5 => ray.t_max = f32::NAN,
            6 => ray.t_min = f32::INFINITY,
            _ => {}
        }
        blocks[i / 16].set(i % 16, &ray);
    }
    blocks
}

/// A box that may be flat: about anything, or such that a ray hardly meets it.
fn planes(random: &mut Random, ray: &Ray, scale: f32) -> [f32; 8] {
    let mut planes = [0.0; 8];
    let t = random.between(0.0, 2.0) * scale / ray.dir.iter().fold(1e-30_f32, |most, d| most.max(d.abs()));
    let (near, aim) = (!random.bits().is_multiple_of(4), random.bits() % 3);
    for axis in 0..3 {
        let mut low = if near { ray.org[axis] + t * ray.dir[axis] } else { number(random, scale) };
        if near && aim == axis as u64 {
            low += (random.bits() % 9) as f32 * 0.5 * f32::EPSILON * low.abs();
        }
        let size = if random.bits().is_multiple_of(2) { 0.0 } else { random.between(0.0, scale) * 0.01 };
        let (low, high) = if random.bits().is_multiple_of(2) { (low, low + size) } else { (low - size, low) };
        (planes[axis], planes[axis + 4]) = (low, high);
    }
    planes
}

#[test]
fn no_box_that_a_ray_meets_is_culled() {
    let mut random = Random(5);
    let (mut met, mut culled, mut whole, mut parts) = (0, 0, 0, 0);
    for round in 0..4000 {
        let scale = [1.0, 1e-6, 1e5, 1e15][round / 11 % 4];
        let blocks = packet(&mut random, round, scale);
        let rays: Vec<Ray> = blocks.iter().flat_map(|block| (0..16).map(|lane| block.get(lane))).collect();
        let boxes: Vec<[f32; 8]> = (0..16)
            .map(|i| planes(&mut random, &rays[i], scale))
            .filter(|planes| planes.iter().all(|x| x.abs() < 1e18))
            .collect();
        let bounds = boxes
            .iter()
            .fold(Aabb::EMPTY, |all, p| all.union(&Aabb { min: [p[0], p[1], p[2]], max: [p[4], p[5], p[6]] }));
        let space = Space::new(bounds);
        let (frusta, odd) = frusta_of(Level::best(), &blocks, &space);
        whole += u32::from(frusta.len() == 2 && odd.is_empty());
        parts += u32::from(frusta.len() > 2);
        for (i, ray) in rays.iter().enumerate() {
            let ready = Packet::of(ray);
            let is_odd = odd.iter().any(|&(block, lanes)| block as usize == i / 16 && lanes >> (i % 16) & 1 != 0);
            let members: Vec<&Frustum> =
                frusta.iter().filter(|f| f.members.of(&ready, i % 16, space.largest)).collect();
            assert_eq!(members.len(), usize::from(ready.valid && !is_odd), "each ray in one frustum: {ray:?}");
            for planes in &boxes {
                let reach = random.between(0.0, 2.0) * scale;
                if is_odd || !ready.valid {
                    continue;
                }
                let frustum = members[0];
                if ray_meets(&ready, planes, f32::INFINITY) {
                    met += 1;
                    assert!(meets(frustum, planes), "{ray:?} meets {planes:?}, {frustum:?} does not");
                } else {
                    culled += u32::from(!meets(frustum, planes));
                }
                if ray_meets(&ready, planes, reach) {
                    let part = part_meets(Level::best(), frustum, &blocks[i / 16], &space, reach, planes);
                    assert!(
                        part[i % 16 / 4],
                        "{ray:?} meets {planes:?} before {reach}, a part of {frustum:?} does not"
                    );
                }
            }
        }
    }
    assert!(met > 50_000 && culled > 50_000 && whole > 500 && parts > 500, "{met} {culled} {whole} {parts}");
}

#[test]
fn all_levels_make_the_same_frusta() {
    let mut random = Random(9);
    for round in 0..100 {
        let blocks = packet(&mut random, round, 1.0);
        let space = Space::new(Aabb { min: [-1.0; 3], max: [2.0, 1.0, 1.0] });
        let expected = format!("{:?}", frusta_of(Level::best(), &blocks, &space));
        for level in Level::available() {
            assert_eq!(format!("{:?}", frusta_of(level, &blocks, &space)), expected, "{level}");
        }
    }
}
