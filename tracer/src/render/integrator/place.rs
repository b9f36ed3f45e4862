//! Where rays meet surfaces: the first step of shading, for all models alike.

use crate::geometry::{Hit, HitBlock, RayBlock, Vec3};
use crate::render::material::negate;
use crate::render::scenery::{OFFSET, Scenery};
use crate::render::shade::{normal, word, words3};
use crate::render::textures::Textures;
use simd::{Float, Vector};

/// A point of a surface, per lane.
pub(super) struct Place<F: Float> {
    pub(super) hit: F::Mask,
    pub(super) position: Vec3<F>,
    /// Unit normal of the triangle, on the side that the ray comes from.
    pub(super) face: Vec3<F>,
    /// Unit normal to shade with, on that side.
    pub(super) normal: Vec3<F>,
    /// Unit vector against the ray.
    pub(super) to_eye: Vec3<F>,
    /// How far from the surface rays start that leave it.
    pub(super) offset: F,
    /// 1 on the side where the triangle's corners run counter-clockwise, -1 on the other.
    pub(super) side: F,
    pub(super) material: F::Index,
    /// From the ray's origin.
    pub(super) distance: F,
}

impl<F: Float> Place<F> {
    /// The hits of group `chunk` of a block.
    #[inline(always)]
    pub(super) fn load(scenery: &Scenery, rays: &RayBlock, hits: &HitBlock, chunk: usize) -> Self {
        let primitive = F::Index::load_block(&hits.primitive, chunk);
        let hit = primitive.ne(F::Index::splat(Hit::NO_PRIMITIVE));
        let (u, v) = (F::load_block(&hits.u, chunk), F::load_block(&hits.v, chunk));
        let corners = &scenery.corners[..];
        let corner = words3::<F>(corners, primitive, 9, 0, hit);
        let (e1, e2) = (words3(corners, primitive, 9, 3, hit), words3(corners, primitive, 9, 6, hit));
        let [sizes, size1, size2] = [largest(corner), largest(e1), largest(e2)];

        let dir = Vec3::<F>::load(&rays.dir, chunk);
        let length = dir.dot(dir).sqrt();
        let to_eye = negate(dir.scale(F::splat(1.0) / length));
        // Edges of about unit length, so that no product is too small a number.
        let one = F::splat(1.0);
        let face = e1.scale(one / size1).cross(e2.scale(one / size2)).normalize();
        let side = one.copysign(face.dot(to_eye));
        let face = face.scale(side);
        let smooth = normal(&scenery.surfaces, primitive, [u, v], hit);
        let smooth = smooth.scale(one.copysign(smooth.dot(face)));
        // A normal that the eye sees from behind, or that is none, is of no use.
        let useful = F::splat(1e-3).lt(smooth.dot(to_eye));
        Self {
            hit,
            position: corner + e1.scale(u) + e2.scale(v),
            face,
            normal: Vec3::select(useful, smooth, face),
            to_eye,
            offset: (sizes + size1 + size2) * F::splat(OFFSET),
            side,
            material: word(&scenery.surfaces.triangles, primitive, 4, 3, hit),
            distance: F::load_block(&hits.t, chunk) * length,
        }
    }

    /// What textures multiply its colours by. There must be textures; `hits` are those that it is of.
    #[inline(always)]
    pub(super) fn tint(&self, textures: &Textures, hits: &HitBlock, chunk: usize) -> Vec3<F> {
        let primitive = F::Index::load_block(&hits.primitive, chunk);
        let place = [F::load_block(&hits.u, chunk), F::load_block(&hits.v, chunk)];
        textures.tint(self.material, primitive, place, self.hit)
    }

    /// Where a ray starts that leaves the surface on the side of the eye.
    #[inline(always)]
    pub(super) fn start(&self) -> Vec3<F> {
        self.position + self.face.scale(self.offset)
    }
}

#[inline(always)]
fn largest<F: Float>(v: Vec3<F>) -> F {
    v.x.abs().max(v.y.abs()).max(v.z.abs())
}
