//! Random triangles and rays, and a loop over all triangles: for tests.

use crate::geometry::moller_trumbore::intersect;
use crate::geometry::slab::{Near, PerRay};
use crate::geometry::{Aabb, Hit, Packet, Ray, RayBatch, Triangle};
use crate::model::Mesh;

/// The same numbers everywhere (SplitMix64).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * ((self.bits() >> 40) as f32 / (1 << 24) as f32)
    }

    pub(crate) fn point(&mut self, size: f32) -> [f32; 3] {
        [self.between(-size, size), self.between(-size, size), self.between(-size, size)]
    }
}

/// `n` triangles of about a size in the cube from -1 to 1, some of them twice.
pub(crate) fn soup(random: &mut Random, n: usize, size: f32) -> Mesh {
    let mut positions: Vec<[f32; 3]> = Vec::new();
    for i in 0..n {
        if i % 10 == 9 {
            positions.extend_from_within(positions.len() - 3..);
            continue;
        }
        let (at, size) = (random.point(1.0), random.between(0.1, 1.0) * size);
        for _ in 0..3 {
            let d = random.point(size);
            positions.push([at[0] + d[0], at[1] + d[1], at[2] + d[2]]);
        }
    }
    let triangles = (0..n as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Mesh { positions, triangles, ..Mesh::default() }
}

/// Rays from around a mesh to points around it; some along an axis, some from a vertex, some short, some of no use.
pub(crate) fn rays(random: &mut Random, mesh: &Mesh, n: usize) -> RayBatch {
    let Aabb { min, max } = mesh.bounds();
    let inside = |random: &mut Random| -> [f32; 3] { std::array::from_fn(|k| random.between(min[k], max[k])) };
    (0..n)
        .map(|i| {
            let to = inside(random);
            let org = random.point(2.0);
            let ray = Ray::new(org, std::array::from_fn(|k| to[k] - org[k]));
            match i % 16 {
                0 => Ray { dir: [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [-0.0, 0.0, 1.0]][i / 16 % 3], org: to, ..ray },
                1 => Ray { org: mesh.positions[random.bits() as usize % mesh.positions.len()], ..ray },
                2 => Ray { t_min: random.between(0.0, 1.0), t_max: random.between(0.5, 1.5), ..ray },
                3 => Ray { dir: ray.dir.map(|d| 100.0 * d), ..ray },
                4 if i % 32 == 4 => Ray { t_max: f32::NAN, ..ray },
                _ => ray,
            }
        })
        .collect()
}

/// All hits of a ray, by primitive.
pub(crate) fn hits_of(mesh: &Mesh, ray: &Ray) -> Vec<Hit> {
    let ray = Packet::of(ray);
    let negative = |inv: f32| usize::from(inv < 0.0);
    let inv = ray.inv_dir;
    let near = Near::of_octant(negative(inv.x) | negative(inv.y) << 1 | negative(inv.z) << 2);
    let triangles = (0..mesh.triangles.len()).map(|i| Triangle::new(mesh.triangle(i), i as u32, 0));
    triangles
        .filter(|t| ray.valid && !t.is_degenerate())
        .filter_map(|t| {
            let hit = intersect(&t, &ray, PerRay, near)?;
            hit.mask.then_some(Hit { t: hit.t, u: hit.u, v: hit.v, primitive: t.id })
        })
        .collect()
}
