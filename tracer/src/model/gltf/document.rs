//! From bytes to a document whose indices all name what exists.

use super::{Notes, named};
use crate::Error;
use gltf::json::{self, Root, mesh::Semantic, validation::Checked};
use gltf::{Document, Glb};

/// Extensions that may be required.
const SUPPORTED: [&str; 10] = [
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// The document, and the buffer of a `.glb` file.
pub(super) fn parse(bytes: Vec<u8>, notes: &mut Notes<'_>) -> Result<(Document, Option<Vec<u8>>), Error> {
    let (root, blob) = if bytes.starts_with(b"glTF") {
        let glb = glb(&bytes).map_err(|e| notes.error(e))?;
        let root = json::deserialize::from_slice::<Root>(&glb.json);
        let root = root.map_err(|e| notes.error(format!("the JSON part is not acceptable as glTF 2.0: {e}")))?;
        (root, glb.bin.map(|bin| bin.into_owned()))
    } else {
        let json = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
        let root = json::deserialize::from_slice::<Root>(json).map_err(|e| Error::Data {
            path: notes.path.to_owned(),
            line: Some(e.line()),
            message: format!("not acceptable as glTF 2.0: {e}"),
        })?;
        (root, None)
    };
    check(&root).map_err(|e| notes.error(e))?;
    let root = without_extensions(root, notes)?;
    let document = Document::from_json(root).map_err(|e| {
        let reason = match &e {
            gltf::Error::Validation(faults) => {
                let first = faults.first().map(|(place, fault)| format!("{place}: {fault}"));
                format!("{} ({} faults in all)", first.unwrap_or_default(), faults.len())
            }
            e => e.to_string(),
        };
        notes.error(format!("not acceptable as glTF 2.0: {reason}"))
    })?;
    Ok((document, blob))
}

fn glb(bytes: &[u8]) -> Result<Glb<'_>, String> {
    let length = bytes.get(8..12).and_then(|b| b.try_into().ok()).map_or(0, u32::from_le_bytes) as usize;
    // The crate subtracts the header from it.
    if length < 12 || length > bytes.len() {
        let n = bytes.len();
        return Err(format!(
            "the file has {n} bytes, its header says {length}: it is damaged or cut short, get it again"
        ));
    }
    Glb::from_slice(&bytes[..length]).map_err(|e| match e {
        gltf::Error::Binary(gltf::binary::Error::Version(v)) => {
            format!("glTF of version {v}, only version 2 is supported")
        }
        e => format!("not acceptable as .glb ({e}): it is damaged or cut short, get it again"),
    })
}

/// What the crate relies on without having checked it.
fn check(root: &Root) -> Result<(), String> {
    // They are copied for each primitive.
    let short = |bound: &json::Value| {
        bound.as_array().is_some_and(|list| list.len() <= 16 && list.iter().all(json::Value::is_number))
    };
    if let Some(i) = root.accessors.iter().position(|a| !a.min.iter().chain(&a.max).all(short)) {
        return Err(format!("accessor {i}: its min and max have to be lists of up to 16 numbers, export it again"));
    }
    for (i, mesh) in root.meshes.iter().enumerate() {
        for (k, primitive) in mesh.primitives.iter().enumerate() {
            let positions = primitive.attributes.get(&Checked::Valid(Semantic::Positions));
            if let Some(index) = positions.map(|index| index.value()).filter(|&index| index >= root.accessors.len()) {
                let (what, n) = (named("mesh", i, mesh.name.as_deref()), root.accessors.len());
                return Err(format!("{what}, primitive {k}: POSITION is accessor {index}, but there are {n}"));
            }
        }
    }
    for (i, camera) in root.cameras.iter().enumerate() {
        let there = match camera.type_ {
            Checked::Valid(json::camera::Type::Perspective) => camera.perspective.is_some(),
            Checked::Valid(json::camera::Type::Orthographic) => camera.orthographic.is_some(),
            Checked::Invalid => true,
        };
        if !there {
            let what = named("camera", i, camera.name.as_deref());
            return Err(format!("{what} has another projection than its type says"));
        }
    }
    Ok(())
}

/// Complains about extensions that are not supported, and forgets those that are required.
fn without_extensions(mut root: Root, notes: &mut Notes<'_>) -> Result<Root, Error> {
    // Without these the scene is the same, but for its looks.
    let of_looks =
        |name: &str| ["KHR_materials_", "KHR_texture_", "EXT_texture_"].iter().any(|start| name.starts_with(start));
    if let Some(name) = root.extensions_required.iter().find(|e| !SUPPORTED.contains(&e.as_str()) && !of_looks(e)) {
        let message =
            format!("the scene cannot be read without the extension {name}, which is not supported: export it without");
        return Err(notes.error(message));
    }
    for name in root.extensions_used.iter().chain(&root.extensions_required) {
        if !SUPPORTED.contains(&name.as_str()) {
            notes.warn(&format!("the extension {name} is not supported: passed over"));
        }
    }
    root.extensions_required.clear();
    Ok(root)
}
