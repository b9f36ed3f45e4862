//! Looking up textures.

use super::shade::word;
use crate::geometry::Vec3;
use crate::model::{LINEAR, Mesh, Model, Texture};
use simd::{Float, Mask, Vector};
use std::sync::Arc;

/// All textures of a scene, laid out for gathering. Nothing is there where no material has one.
#[derive(Debug, Clone)]
pub(super) struct Textures {
    /// [`Textures::MATERIAL`] words for each material.
    materials: Vec<u32>,
    /// Six words for each triangle: texture coordinates of its corners; NaN for one without.
    uvs: Vec<f32>,
    /// Pixels of all images.
    texels: Vec<u32>,
    /// Linear intensity of each byte of them.
    linear: Vec<f32>,
}

impl Textures {
    /// First pixel, width (0 without a texture), height, whether it tints the specular colour.
    const MATERIAL: u32 = 4;

    /// Of a valid model ([`Model::validate`]).
    pub(super) fn new(model: &Model) -> Self {
        let mesh = &model.mesh;
        let images = if mesh.uv_indices.is_empty() { Vec::new() } else { model.textures() };
        if images.is_empty() {
            return Self { materials: Vec::new(), uvs: Vec::new(), texels: Vec::new(), linear: Vec::new() };
        }
        let mut texels = Vec::with_capacity(images.iter().map(|image| image.texels().len()).sum());
        let firsts: Vec<u32> = images
            .iter()
            .map(|image| {
                let first = texels.len() as u32;
                texels.extend_from_slice(image.texels());
                first
            })
            .collect();
        let words = |texture: &Arc<Texture>, on_specular: bool| {
            let place = images.iter().position(|image| Arc::ptr_eq(image, texture))?;
            let (width, height) = texture.size();
            Some([firsts[place], width as u32, height as u32, u32::from(on_specular)])
        };
        let materials = model.materials.iter().flat_map(|m| {
            let texture = m.texture.as_ref().and_then(|texture| words(texture, m.texture_on_specular));
            texture.unwrap_or_default()
        });
        let corners = |t: &[u32; 3]| match *t {
            Mesh::FLAT => [[f32::NAN; 2]; 3],
            corners => corners.map(|n| mesh.uvs[n as usize]),
        };
        let uvs = mesh.uv_indices.iter().flat_map(|t| corners(t).into_iter().flatten());
        Self { materials: materials.collect(), uvs: uvs.collect(), texels, linear: LINEAR.to_vec() }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.texels.is_empty()
    }

    /// What the diffuse colour is multiplied by at a place of triangles, given by barycentric coordinates; 1 where there is no texture. There
    /// must be textures.
    #[inline(always)]
    pub(super) fn tint<F: Float>(
        &self,
        material: F::Index,
        primitive: F::Index,
        [u, v]: [F; 2],
        hit: F::Mask,
    ) -> Vec3<F> {
        let white = Vec3::splat([1.0; 3]);
        let materials = &self.materials[..];
        let first: F::Index = word(materials, material, Self::MATERIAL, 0, hit);
        let width: F::Index = word(materials, material, Self::MATERIAL, 1, hit);
        let height: F::Index = word(materials, material, Self::MATERIAL, 2, hit);
        let on = hit & width.gt(F::Index::splat(0));
        if on.none() {
            return white;
        }
        let w = F::splat(1.0) - u - v;
        let (s0, s1, s2) =
            (self.corner(primitive, 0, on), self.corner(primitive, 2, on), self.corner(primitive, 4, on));
        let (t0, t1, t2) =
            (self.corner(primitive, 1, on), self.corner(primitive, 3, on), self.corner(primitive, 5, on));
        let (s, t) = (w * s0 + u * s1 + v * s2, w * t0 + u * t1 + v * t2);
        let on = on & s.eq(s) & t.eq(t);
        // Rows are counted from the top.
        let (x, y) = (Interpolated::new(s, width), Interpolated::new(F::splat(1.0) - t, height));
        let (upper, lower) = (first + y.below * width, first + y.above * width);
        let upper = x.between(self.linear(upper + x.below, on), self.linear(upper + x.above, on));
        let lower = x.between(self.linear(lower + x.below, on), self.linear(lower + x.above, on));
        Vec3::select(on, y.between(upper, lower), white)
    }

    /// A word of the texture coordinates of triangles.
    #[inline(always)]
    fn corner<F: Float>(&self, primitive: F::Index, field: u32, on: F::Mask) -> F {
        word(&self.uvs, primitive, 6, field, on)
    }

    /// The linear colour of a pixel.
    #[inline(always)]
    fn linear<F: Float>(&self, texel: F::Index, on: F::Mask) -> Vec3<F> {
        let rgb = F::Index::gather_masked(&self.texels, texel, on, F::Index::splat(0));
        let byte = F::Index::splat(0xff);
        Vec3 {
            x: word(&self.linear, rgb & byte, 1, 0, on),
            y: word(&self.linear, (rgb >> 8) & byte, 1, 0, on),
            z: word(&self.linear, (rgb >> 16) & byte, 1, 0, on),
        }
    }

    /// The specular colour of materials under this tint.
    #[inline(always)]
    pub(super) fn specular<F: Float>(
        &self,
        specular: Vec3<F>,
        tint: Vec3<F>,
        material: F::Index,
        on: F::Mask,
    ) -> Vec3<F> {
        let tinted: F::Index = word(&self.materials, material, Self::MATERIAL, 3, on);
        Vec3::select(tinted.gt(F::Index::splat(0)), specular * tint, specular)
    }
}

/// The two pixels whose middles a coordinate lies between, and the part of the way from one to the other.
struct Interpolated<F: Float> {
    below: F::Index,
    above: F::Index,
    part: F,
}

impl<F: Float> Interpolated<F> {
    /// A coordinate in a row of so many pixels that repeats at whole numbers.
    #[inline(always)]
    fn new(coordinate: F, pixels: F::Index) -> Self {
        let (zero, one) = (F::Index::splat(0), F::Index::splat(1));
        // From half a pixel before the first on.
        let place = coordinate.fract() * F::from_uint(pixels) - F::splat(0.5);
        let floor = place.floor();
        let last = pixels - one;
        let below = F::Index::select(floor.lt(F::splat(0.0)), last, floor.to_uint().min(last));
        let above = F::Index::select(below.eq(last), zero, below + one);
        Self { below, above, part: place - floor }
    }

    #[inline(always)]
    fn between(&self, below: Vec3<F>, above: Vec3<F>) -> Vec3<F> {
        below.scale(F::splat(1.0) - self.part) + above.scale(self.part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Material;
    use std::path::Path;

    /// A triangle with corners (0, 0), (1, 0) and (0, 1) of texture space, and one without.
    fn textures(width: usize, height: usize, pixels: &[[u8; 3]]) -> Textures {
        let mesh = Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2]; 2],
            uvs: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
            uv_indices: vec![[0, 1, 2], Mesh::FLAT],
            ..Mesh::default()
        };
        let texture = Texture::new("a", width, height, pixels).expect("an image");
        let textured = Material { texture: Some(texture.into()), ..Material::grey("textured") };
        let model =
            Model { materials: vec![Material::grey("plain"), textured], ..Model::of_mesh(Path::new("a"), mesh) };
        Textures::new(&model)
    }

    fn tint(textures: &Textures, material: u32, triangle: u32, u: f32, v: f32) -> [f32; 3] {
        let (material, triangle) = (<f32 as Vector>::Index::splat(material), <f32 as Vector>::Index::splat(triangle));
        let rgb = textures.tint::<f32>(material, triangle, [u, v], <f32 as Vector>::Mask::splat(true));
        [rgb.x, rgb.y, rgb.z]
    }

    #[test]
    fn pixels_and_between_them() {
        // Red, green; blue, white below.
        let t = textures(2, 2, &[[255, 0, 0], [0, 255, 0], [0, 0, 255], [255; 3]]);
        for (u, v, expected) in [
            (0.25, 0.75, [1.0, 0.0, 0.0]),
            (0.75, 0.75, [0.0, 1.0, 0.0]),
            (0.25, 0.25, [0.0, 0.0, 1.0]),
            (0.75, 0.25, [1.0; 3]),
            (0.5, 0.75, [0.5, 0.5, 0.0]),
            (0.5, 0.5, [0.5; 3]),
            // Repeated: between the last and the first.
            (0.0, 0.75, [0.5, 0.5, 0.0]),
            (1.0, 0.75, [0.5, 0.5, 0.0]),
            (-0.75, 1.75, [1.0, 0.0, 0.0]),
            (0.25, 0.0, [0.5, 0.0, 0.5]),
        ] {
            assert_eq!(tint(&t, 1, 0, u, v), expected, "{u} {v}");
        }
        assert_eq!(tint(&t, 0, 0, 0.3, 0.3), [1.0; 3], "no texture");
        assert_eq!(tint(&t, 1, 1, 0.3, 0.3), [1.0; 3], "no coordinates");
    }

    /// Whatever the coordinates are, pixels of the image are looked up.
    #[test]
    fn far_away() {
        let t = textures(3, 1, &[[128; 3]; 3]);
        for u in [0.0, -0.0, 1e-45, -1e-30, 0.999_999_94, 1e9, -1e9, 3e38, -3e38, f32::INFINITY, f32::NAN] {
            for v in [0.3, u] {
                let [r, ..] = tint(&t, 1, 0, u, v);
                // White where the place is no number.
                let known = (u + v).is_finite() && u.abs() < 1e38;
                assert!((r - LINEAR[128]).abs() < 1e-6 || r == 1.0 && !known, "{u} {v}: {r}");
            }
        }
    }
}
