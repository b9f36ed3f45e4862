//! Materials: metallic-roughness, as far as it can be told by the models of this crate.
//!
//! - transmission of a half or more: [`Reflection::Dielectric`], tinted by the base colour;
//! - metals (metalness of a half or more) of roughness 0.1 or less: [`Reflection::Mirror`];
//! - rough surfaces (0.7 or more) that are no metals: [`Reflection::Lambertian`];
//! - all else: [`Reflection::Glossy`], whose coat reflects as the index of refraction says, or as the metal's colour.

use super::images::{self, Images};
use super::{Notes, named};
use crate::model::{LINEAR, Material, Reflection};
use gltf::material::AlphaMode;
use gltf::{Document, material, texture};

/// All materials of a document, and the default one behind them.
pub(super) fn read(document: &Document, mut images: Images<'_>, notes: &mut Notes<'_>) -> Vec<Material> {
    let mut materials: Vec<Material> = document.materials().map(|m| one(&m, &mut images, notes)).collect();
    materials.push(Material { name: "default".into(), ..surface(Surface::default()) });
    materials
}

/// What decides on the model.
#[derive(Debug, Clone, Copy)]
struct Surface {
    base: [f32; 3],
    metallic: f32,
    roughness: f32,
    /// Reflectance of what is no metal, seen straight on.
    reflectance: [f32; 3],
    transmission: f32,
    ior: f32,
}

impl Default for Surface {
    /// What the specification says of a material about which nothing is said, but no metal: it has its light grey from there.
    fn default() -> Self {
        Self { base: [0.7; 3], metallic: 0.0, roughness: 1.0, reflectance: [0.04; 3], transmission: 0.0, ior: 1.5 }
    }
}

/// The texture of a material's base colour.
pub(super) fn base_texture<'a>(m: &material::Material<'a>) -> Option<texture::Info<'a>> {
    let old = m.pbr_specular_glossiness();
    old.map_or_else(|| m.pbr_metallic_roughness().base_color_texture(), |old| old.diffuse_texture())
}

fn one(m: &material::Material<'_>, images: &mut Images<'_>, notes: &mut Notes<'_>) -> Material {
    let what = named("material", m.index().unwrap_or_default(), m.name());
    let pbr = m.pbr_metallic_roughness();
    let [r, g, b, _] = pbr.base_color_factor();
    let ior = m.ior().unwrap_or(1.5).max(1.0);
    let straight = ((ior - 1.0) / (ior + 1.0)) * ((ior - 1.0) / (ior + 1.0));
    let [strength, tint] =
        m.specular().map_or([[1.0; 3]; 2], |s| [[s.specular_factor(); 3], s.specular_color_factor()]);
    let mut given = Surface {
        base: [r, g, b],
        metallic: pbr.metallic_factor(),
        roughness: pbr.roughness_factor(),
        reflectance: [0, 1, 2].map(|k| (straight * tint[k]).min(1.0) * strength[k]),
        transmission: m.transmission().map_or(0.0, |t| t.transmission_factor()),
        ior,
    };
    if let Some(info) = pbr.metallic_roughness_texture() {
        // Without it the factors say little: most are 1.
        let image = images.read(&info.texture(), &what, "it is taken for no metal", notes);
        let mean = image.map_or([0.0, 1.0, 0.0], |image| image.mean(|byte| f32::from(byte) / 255.0));
        given = Surface { metallic: given.metallic * mean[2], roughness: given.roughness * mean[1], ..given };
    }
    if let Some(info) = m.transmission().and_then(|t| t.transmission_texture()) {
        let image = images.read(&info.texture(), &what, "it is taken for opaque", notes);
        given.transmission *= image.map_or(0.0, |image| image.mean(|byte| f32::from(byte) / 255.0)[0]);
    }
    if let Some(old) = m.pbr_specular_glossiness() {
        let [r, g, b, _] = old.diffuse_factor();
        given = Surface {
            base: [r, g, b],
            metallic: 0.0,
            roughness: 1.0 - old.glossiness_factor(),
            reflectance: old.specular_factor(),
            ..given
        };
        if old.specular_glossiness_texture().is_some() {
            // Without it the factors say little: most are 1.
            given.roughness = 1.0;
            notes.warn(&format!("{what}: textures of glossiness are not supported, it is matt"));
        }
    }
    if m.unlit() {
        given = Surface { metallic: 0.0, roughness: 1.0, ..given };
        notes.warn(&format!("{what}: surfaces without shading (KHR_materials_unlit) are matt here"));
    }
    if m.alpha_mode() != AlphaMode::Opaque && given.transmission < 0.5 {
        notes.warn(&format!("{what}: transparency (alphaMode) is not supported, it is opaque here"));
    }
    let name = m.name().map_or_else(|| format!("material_{}", m.index().unwrap_or_default()), str::to_owned);
    let mut material = Material { name, emission: emission(m, &what, images, notes), ..surface(given) };
    if let Some(info) = base_texture(m) {
        images::look(&info.texture(), &what, notes);
        material.texture = images.read(&info.texture(), &what, "its colour is used", notes);
        material.texture_on_specular = given.metallic >= 0.5;
    }
    material
}

/// Light of its own; none where a texture says from where, and cannot be read.
fn emission(m: &material::Material<'_>, what: &str, images: &mut Images<'_>, notes: &mut Notes<'_>) -> [f32; 3] {
    let (strength, mut factor) = (m.emissive_strength().unwrap_or(1.0), m.emissive_factor());
    if factor == [0.0; 3] {
        return factor;
    }
    if let Some(info) = m.emissive_texture() {
        let image = images.read(&info.texture(), what, "it sends out no light", notes);
        let mean = image.map_or([0.0; 3], |image| image.mean(|byte| LINEAR[usize::from(byte)]));
        (0..3).for_each(|k| factor[k] *= mean[k]);
    }
    factor.map(|c| if (c * strength).is_finite() { (c * strength).max(0.0) } else { 0.0 })
}

fn surface(given: Surface) -> Material {
    let unit = |x: f32| if x.is_finite() { x.clamp(0.0, 1.0) } else { 0.0 };
    let (base, reflectance) = (given.base.map(unit), given.reflectance.map(unit));
    let (metallic, roughness) = (unit(given.metallic), unit(given.roughness));
    let metal = Material {
        diffuse: base.map(|c| c * (1.0 - metallic)),
        specular: [0, 1, 2].map(|k| reflectance[k] * (1.0 - metallic) + base[k] * metallic),
        shininess: exponent(roughness),
        ..Material::matt("", base)
    };
    if given.transmission >= 0.5 {
        let ior = if given.ior.is_finite() { given.ior } else { 1.5 };
        return Material { ior, transmission: base, diffuse: base, reflection: Reflection::Dielectric, ..metal };
    }
    match (metallic >= 0.5, roughness) {
        (true, ..=0.1) => Material { reflection: Reflection::Mirror, ..metal },
        (false, 0.7..) => Material::matt("", base),
        _ => Material { reflection: Reflection::Glossy, ..metal },
    }
}

/// The exponent of a Phong lobe about as wide as the distribution of that roughness, whose alpha is its square (Walter et al. 2007, "Microfacet
/// Models for Refraction through Rough Surfaces", section 5.2: 2 / alpha^2 - 2), a quarter of it as the lobe is around the mirrored direction.
fn exponent(roughness: f32) -> f32 {
    let alpha = (roughness * roughness).max(0.01);
    ((2.0 / (alpha * alpha) - 2.0) / 4.0).max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn which_becomes_what() {
        let of = |change: fn(&mut Surface)| {
            let mut given = Surface { base: [0.8, 0.4, 0.2], roughness: 0.5, ..Surface::default() };
            change(&mut given);
            surface(given)
        };
        let plastic = of(|_| ());
        assert_eq!(
            (plastic.reflection, plastic.diffuse, plastic.specular),
            (Reflection::Glossy, [0.8, 0.4, 0.2], [0.04; 3])
        );
        assert_eq!(plastic.shininess, 7.5);
        let matt = of(|s| s.roughness = 0.9);
        assert_eq!((matt.reflection, matt.specular), (Reflection::Lambertian, [0.0; 3]));
        let metal = of(|s| s.metallic = 1.0);
        assert_eq!((metal.reflection, metal.diffuse, metal.specular), (Reflection::Glossy, [0.0; 3], [0.8, 0.4, 0.2]));
        let rough = of(|s| (s.metallic, s.roughness) = (1.0, 1.0));
        assert_eq!((rough.reflection, rough.shininess), (Reflection::Glossy, 1.0));
        let mirror = of(|s| (s.metallic, s.roughness) = (1.0, 0.0));
        assert_eq!((mirror.reflection, mirror.specular), (Reflection::Mirror, [0.8, 0.4, 0.2]));
        let glass = of(|s| (s.transmission, s.ior) = (1.0, 1.33));
        assert_eq!((glass.reflection, glass.transmission, glass.ior), (Reflection::Dielectric, [0.8, 0.4, 0.2], 1.33));
        let hostile = of(|s| (s.base, s.metallic, s.roughness) = ([f32::MAX; 3], -1e30, f32::INFINITY));
        assert!(hostile.diffuse == [1.0; 3] && hostile.shininess.is_finite(), "{hostile:?}");
    }
}
