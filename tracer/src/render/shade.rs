//! Shading: pass three. Phong's model on whole packets, with gathered materials and normals.

use super::textures::Textures;
use crate::Error;
use crate::geometry::{HitBatch, HitBlock, RayBatch, RayBlock, Vec3};
use crate::lanes::{self, Lanes, Width};
use crate::method::{BitVec, Context};
use crate::model::{Light, Model};
use crate::parallel::{PORTION, portions};
use simd::{Block, Float, Level, Mask, Vector};

/// What shading needs to know of each triangle, laid out for gathering and apart from what traversal reads
/// (Geimer & Müller 2003, section 3.2).
#[derive(Debug, Clone)]
pub struct Surfaces {
    /// Four words per triangle: the normals of its three vertices, and its material.
    pub(super) triangles: Vec<u32>,
    /// Three words per normal: the mesh's, then one for each flat triangle.
    pub(super) normals: Vec<f32>,
    /// [`Surfaces::MATERIAL`] words per material.
    materials: Vec<f32>,
    pub(super) textures: Textures,
}

impl Surfaces {
    /// Ambient, diffuse, specular, exponent.
    const MATERIAL: u32 = 10;

    /// From a scene whose mesh is valid ([`Model::validate`]).
    #[must_use]
    pub fn new(scene: &Model) -> Self {
        let mesh = &scene.mesh;
        let mut normals: Vec<f32> = mesh.normals.iter().flatten().copied().collect();
        let mut triangles = Vec::with_capacity(4 * mesh.triangles.len());
        for i in 0..mesh.triangles.len() {
            let smooth = mesh.normal_indices.get(i).filter(|&&n| n != [u32::MAX; 3]);
            let of_vertices = smooth.copied().unwrap_or_else(|| {
                let flat = (normals.len() / 3) as u32;
                normals.extend(face_normal(mesh.triangle(i)));
                [flat; 3]
            });
            triangles.extend(of_vertices);
            triangles.push(mesh.material(i));
        }
        let words = |m: &crate::model::Material| {
            [m.ambient, m.diffuse, m.specular].into_iter().flatten().chain([m.shininess]).collect::<Vec<f32>>()
        };
        let materials = scene.materials.iter().flat_map(words).collect();
        Self { triangles, normals, materials, textures: Textures::new(scene) }
    }
}

/// The unit normal of a flat triangle, counter-clockwise from its front; zero for a degenerate one.
fn face_normal([a, b, c]: [[f32; 3]; 3]) -> [f32; 3] {
    let edge = |p: [f32; 3]| Vec3 { x: p[0] - a[0], y: p[1] - a[1], z: p[2] - a[2] };
    let n = edge(b).cross(edge(c)).normalize();
    if n.x.is_nan() || n.y.is_nan() || n.z.is_nan() { [0.0; 3] } else { [n.x, n.y, n.z] }
}

/// What light there is.
#[derive(Debug, Clone)]
pub struct Lighting {
    /// Point lights.
    pub lights: Vec<Light>,
    /// Intensity of the ambient light.
    pub ambient: f32,
    /// What rays see that hit nothing.
    pub background: [f32; 3],
}

/// Rays from a light to the points that `rays` hit, short of the surface itself. They share their origin, the light.
pub(crate) fn shadow_rays(rays: &RayBatch, hits: &HitBatch, light: &Light, level: Level, lanes: Width) -> RayBatch {
    RayBatch::from_origin(light.position, rays.len(), |shadow| {
        let pairs: Vec<(&RayBlock, &HitBlock)> = rays.blocks().iter().zip(hits.blocks()).collect();
        let generate = |_, pairs: &[(&RayBlock, &HitBlock)], shadow: &mut [RayBlock]| {
            lanes::run_native(level, lanes, ShadowRays { light: light.position, pairs, shadow });
            Ok(())
        };
        let done = portions(PORTION, &pairs, shadow, generate, || (), |(), ()| ());
        debug_assert!(done.is_ok(), "nothing in it can fail");
    })
}

struct ShadowRays<'a> {
    light: [f32; 3],
    pairs: &'a [(&'a RayBlock, &'a HitBlock)],
    shadow: &'a mut [RayBlock],
}

impl Lanes for ShadowRays<'_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        // Ends a little before the surface, by more than the rounding of the hit point.
        let end = F::splat(1.0 - 1e-4);
        let light = Vec3::<F>::splat(self.light);
        for (block, chunk) in lanes::chunks::<F>(self.pairs.len()) {
            let (rays, hits) = self.pairs[block];
            let shadow = &mut self.shadow[block];
            let point = Points::<F>::load(rays, hits, chunk);
            (point.position - light).store(&mut shadow.dir, chunk);
            F::splat(0.0).store_block(&mut shadow.t_min, chunk);
            F::select(point.hit, end, F::splat(f32::NEG_INFINITY)).store_block(&mut shadow.t_max, chunk);
        }
    }
}

/// Where rays hit, and from where.
struct Points<F: Float> {
    hit: F::Mask,
    position: Vec3<F>,
    /// Unit vector against the ray.
    to_eye: Vec3<F>,
    u: F,
    v: F,
    primitive: F::Index,
}

impl<F: Float> Points<F> {
    #[inline(always)]
    fn load(rays: &RayBlock, hits: &HitBlock, chunk: usize) -> Self {
        let primitive = F::Index::load_block(&hits.primitive, chunk);
        let hit = primitive.ne(F::Index::splat(crate::geometry::Hit::NO_PRIMITIVE));
        let t = F::select(hit, F::load_block(&hits.t, chunk), F::splat(0.0));
        let (org, dir) = (Vec3::load(&rays.org, chunk), Vec3::load(&rays.dir, chunk));
        Self {
            hit,
            position: org + dir.scale(t),
            to_eye: dir.normalize().scale(F::splat(-1.0)),
            u: F::load_block(&hits.u, chunk),
            v: F::load_block(&hits.v, chunk),
            primitive,
        }
    }
}

/// All that the third pass reads.
pub(crate) struct Job<'a> {
    pub(crate) rays: &'a RayBatch,
    pub(crate) hits: &'a HitBatch,
    pub(crate) lighting: &'a Lighting,
    pub(crate) surfaces: &'a Surfaces,
    /// Per light, the rays whose points it does not reach; empty when there are no shadows.
    pub(crate) shadows: &'a [BitVec],
    pub(crate) level: Level,
    pub(crate) lanes: Width,
    pub(crate) cx: &'a Context<'a>,
}

/// The colour of every ray.
///
/// # Errors
/// [`Error::Cancelled`].
pub(crate) fn shade(job: &Job<'_>) -> Result<Vec<[Block<f32>; 3]>, Error> {
    let mut colors = vec![[Block::default(); 3]; job.rays.blocks().len()];
    let portion = |first, rays: &[RayBlock], colors: &mut [[Block<f32>; 3]]| {
        job.cx.check()?;
        lanes::run_native(job.level, job.lanes, Shade { job, first, rays, colors });
        Ok(())
    };
    portions(PORTION, job.rays.blocks(), &mut colors, portion, || (), |(), ()| ())?;
    Ok(colors)
}

struct Shade<'a> {
    job: &'a Job<'a>,
    /// Number of the first block.
    first: usize,
    rays: &'a [RayBlock],
    colors: &'a mut [[Block<f32>; 3]],
}

impl Lanes for Shade<'_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let Self { job, first, rays, colors, .. } = self;
        let hits = &job.hits.blocks()[first..];
        for (block, chunk) in lanes::chunks::<F>(rays.len()) {
            let point = Points::<F>::load(&rays[block], &hits[block], chunk);
            let mut rgb = Vec3::splat(job.lighting.background);
            if point.hit.any() {
                rgb = Vec3::select(point.hit, phong(job, &point, first + block, chunk), rgb);
            }
            rgb.store(&mut colors[block], chunk);
        }
    }
}

/// Phong 1975: ambient, and for each light diffuse and highlight. Both sides of a surface are lit alike.
#[inline(always)]
fn phong<F: Float>(job: &Job<'_>, point: &Points<F>, block: usize, chunk: usize) -> Vec3<F> {
    let (zero, one) = (F::splat(0.0), F::splat(1.0));
    let normal = normal(job.surfaces, point.primitive, [point.u, point.v], point.hit);
    let facing = point.to_eye.dot(normal);
    let normal = Vec3 { x: normal.x.mul_sign(facing), y: normal.y.mul_sign(facing), z: normal.z.mul_sign(facing) };
    // The eye mirrored at the surface: a highlight is where a light lies in this direction.
    let mirrored = normal.scale(facing.abs() + facing.abs()) - point.to_eye;

    let material: F::Index = word(&job.surfaces.triangles, point.primitive, 4, 3, point.hit);
    let materials = &job.surfaces.materials;
    let mut ambient = words3(materials, material, Surfaces::MATERIAL, 0, point.hit);
    let mut diffuse = words3(materials, material, Surfaces::MATERIAL, 3, point.hit);
    let mut specular = words3(materials, material, Surfaces::MATERIAL, 6, point.hit);
    let shininess = word(materials, material, Surfaces::MATERIAL, 9, point.hit);

    let textures = &job.surfaces.textures;
    if !textures.is_empty() {
        let tint = textures.tint(material, point.primitive, [point.u, point.v], point.hit);
        ambient = ambient * tint;
        diffuse = diffuse * tint;
        specular = textures.specular(specular, tint, material, point.hit);
    }

    let mut rgb = ambient.scale(F::splat(job.lighting.ambient));
    for (number, light) in job.lighting.lights.iter().enumerate() {
        let to_light = (Vec3::splat(light.position) - point.position).normalize();
        let cos = to_light.dot(normal);
        let mut lit = zero.lt(cos) & point.hit;
        if let Some(dark) = job.shadows.get(number) {
            lit &= !F::Mask::from_bitmask(u32::from(dark.words()[block]) >> (chunk * F::LANES));
        }
        if lit.none() {
            continue;
        }
        let highlight = to_light.dot(mirrored).max(zero).min(one);
        let highlight = simd::math::pow(highlight, shininess);
        let light = Vec3::splat(light.intensity) * (diffuse.scale(cos) + specular.scale(highlight));
        rgb = Vec3::select(lit, rgb + light, rgb);
    }
    rgb
}

/// The vertex normals weighted by the hit's barycentric coordinates, of unit length.
#[inline(always)]
pub(super) fn normal<F: Float>(surfaces: &Surfaces, primitive: F::Index, [u, v]: [F; 2], hit: F::Mask) -> Vec3<F> {
    let (triangles, normals) = (&surfaces.triangles, &surfaces.normals);
    let n0: Vec3<F> = words3(normals, word(triangles, primitive, 4, 0, hit), 3, 0, hit);
    let n1 = words3(normals, word(triangles, primitive, 4, 1, hit), 3, 0, hit);
    let n2 = words3(normals, word(triangles, primitive, 4, 2, hit), 3, 0, hit);
    (n0.scale(F::splat(1.0) - u - v) + n1.scale(u) + n2.scale(v)).normalize()
}

/// Word `field` of record `index`, of `size` words each; zero where nothing was hit.
#[inline(always)]
pub(super) fn word<V: Vector>(table: &[V::Lane], index: V::Index, size: u32, field: u32, mask: V::Mask) -> V {
    let at = index * V::Index::splat(size) + V::Index::splat(field);
    V::gather_masked(table, at, mask, V::splat(V::Lane::default()))
}

/// Three words from `field` on.
#[inline(always)]
pub(super) fn words3<F: Float>(table: &[f32], index: F::Index, size: u32, field: u32, mask: F::Mask) -> Vec3<F> {
    Vec3 {
        x: word(table, index, size, field, mask),
        y: word(table, index, size, field + 1, mask),
        z: word(table, index, size, field + 2, mask),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn face_normals_are_unit_or_zero() {
        assert_eq!(face_normal([[0.0; 3], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0]]), [0.0, 0.0, 1.0]);
        assert_eq!(face_normal([[1.0; 3]; 3]), [0.0; 3]);
    }
}
