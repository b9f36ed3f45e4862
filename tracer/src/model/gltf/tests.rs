use super::*;
use crate::model::{Camera, Light, Mesh, Reflection};
use crate::progress::Silent;
use std::fs;

/// A `.glb` file of a JSON text and bytes.
fn glb(json: &str, bin: &[u8]) -> Vec<u8> {
    let padded = |bytes: &[u8], with: u8| [bytes, &vec![with; bytes.len().next_multiple_of(4) - bytes.len()]].concat();
    let chunk = |kind: &[u8], bytes: Vec<u8>| [&(bytes.len() as u32).to_le_bytes()[..], kind, &bytes].concat();
    let parts = [chunk(b"JSON", padded(json.as_bytes(), b' ')), chunk(b"BIN\0", padded(bin, 0))].concat();
    [&b"glTF\x02\0\0\0"[..], &(parts.len() as u32 + 12).to_le_bytes(), &parts].concat()
}

fn read_as(name: &str, bytes: &[u8]) -> Result<(Model, Vec<String>), Error> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    fs::write(&path, bytes).expect("written");
    let result = read(&path, &Silent);
    if let Ok((model, _)) = &result {
        model.validate().expect("what is read is sound");
    }
    let prefix = format!("{}/", folder.path().display());
    result.map(|(model, warnings)| (model, warnings.iter().map(|w| w.replace(&prefix, "")).collect()))
}

/// The error of a file.
fn error(bytes: &[u8]) -> String {
    read_as("a.glb", bytes).expect_err("an error").to_string()
}

/// A square of four vertices: x y z each; then its normals, then six indices as bytes.
fn square() -> Vec<u8> {
    let positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let floats = positions.into_iter().chain([[0.0, 0.0, 1.0]; 4]).flatten();
    floats.flat_map(f32::to_le_bytes).chain([0, 1, 2, 0, 2, 3]).collect()
}

/// Of [`square`]: positions, normals, indices.
const ACCESSORS: &str = r#""asset":{"version":"2.0"},"buffers":[{"byteLength":102}],
"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":48},{"buffer":0,"byteOffset":96,"byteLength":6}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5126,"count":4,"type":"VEC3"},{"bufferView":2,"componentType":5121,"count":6,"type":"SCALAR"}]"#;

/// The square with more members of the JSON.
fn scene(more: &str) -> String {
    format!("{{{ACCESSORS},{more}}}")
}

const PLAIN: &str = r#""meshes":[{"name":"square","primitives":[{"attributes":{"POSITION":0,"NORMAL":1},"indices":2}]}],
"nodes":[{"name":"n","mesh":0}],"scenes":[{"nodes":[0]}]"#;

fn plain() -> Vec<u8> {
    glb(&scene(PLAIN), &square())
}

fn meshes(more: &str) -> Mesh {
    read_as("a.glb", &glb(&scene(more), &square())).unwrap_or_else(|e| panic!("{more}: {e}")).0.mesh
}

/// The corners of all triangles.
fn corners(mesh: &Mesh) -> Vec<[[f32; 3]; 3]> {
    (0..mesh.triangles.len()).map(|i| mesh.triangle(i)).collect()
}

#[test]
fn one_square_in_all_containers() {
    let (model, warnings) = read_as("some.thing.glb", &plain()).expect("sound");
    assert_eq!((model.name.as_str(), warnings.len()), ("some.thing", 0));
    assert_eq!(model.mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(model.mesh.normals, [[0.0, 0.0, 1.0]; 4]);
    assert_eq!(model.mesh.normal_indices, model.mesh.triangles);
    assert_eq!((model.materials.len(), model.materials[0].diffuse), (1, [0.7; 3]));
    assert_eq!((model.camera, model.lights.len()), (None, 0));

    let base64 = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAAAA\
                  AAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/AAAAAAAAAAAAAIA/AAECAAID";
    let inside = scene(PLAIN).replace(
        "\"byteLength\":102",
        &format!("\"byteLength\":102,\"uri\":\"data:application/octet-stream;base64,{base64}\""),
    );
    assert_eq!(read_as("a.gltf", inside.as_bytes()).expect("sound").0.mesh, model.mesh);

    let folder = tempfile::tempdir().expect("a folder");
    let beside = scene(PLAIN).replace("\"byteLength\":102", "\"byteLength\":102,\"uri\":\"a%20b.bin\"");
    let path = folder.path().join("a.gltf");
    fs::write(&path, beside).expect("written");
    let missing = read(&path, &Silent).expect_err("no buffer").to_string();
    assert!(missing.contains("cannot open") && missing.contains("a b.bin"), "{missing}");
    fs::write(folder.path().join("a b.bin"), square()).expect("written");
    assert_eq!(read(&path, &Silent).expect("sound").0.mesh, model.mesh);
    fs::write(folder.path().join("a b.bin"), &square()[..101]).expect("written");
    let short = read(&path, &Silent).expect_err("a short buffer").to_string();
    assert!(short.contains("buffer 0 has 101 bytes instead of 102"), "{short}");
}

/// Children move with their parents, and each node comes before its children.
#[test]
fn nodes() {
    let mesh = meshes(
        r#""meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1},"indices":2}]}],"scene":1,"scenes":[{"nodes":[]},{"nodes":[0,3]}],
        "nodes":[{"children":[1,2],"translation":[10,0,0],"rotation":[0,0,0.70710678,0.70710678]},
        {"mesh":0,"scale":[2,3,1]},{"mesh":0,"matrix":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,5,1]},{"mesh":0}]"#,
    );
    let near = |i: usize, expected: [[f32; 3]; 3]| {
        let triangle = mesh.triangle(i);
        let off =
            triangle.as_flattened().iter().zip(expected.as_flattened()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(off < 1e-5, "{i}: {triangle:?}, not {expected:?}");
    };
    assert_eq!(mesh.triangles.len(), 6);
    // A quarter of a turn: x becomes y, y becomes -x.
    near(0, [[10.0, 0.0, 0.0], [10.0, 2.0, 0.0], [7.0, 2.0, 0.0]]);
    // Mirrored, the corners run the other way round, so that its front stays the front.
    near(2, [[10.0, 0.0, 5.0], [9.0, -1.0, 5.0], [10.0, -1.0, 5.0]]);
    near(4, [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
    assert!(mesh.normals.iter().all(|n| (n[2] - 1.0).abs() < 1e-6));
    assert_eq!(mesh.normal_indices[2], mesh.triangles[2], "normals go with their corners");
}

#[test]
fn lists_strips_and_fans_with_and_without_indices() {
    let of = |primitive: &str| {
        let json = format!(
            r#""meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},{primitive}}}]}}],"nodes":[{{"mesh":0}}]"#
        );
        let mesh = meshes(&json);
        assert!(mesh.normals.is_empty() && mesh.normal_indices.is_empty());
        let number = |p: [f32; 3]| {
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].iter().position(|q| q[..] == p[..2]).expect("a corner")
        };
        corners(&mesh).iter().map(|t| t.map(number)).collect::<Vec<_>>()
    };
    assert_eq!(of(r#""indices":2"#), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(of(r#""indices":2,"mode":4"#), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(of(r#""mode":5"#), [[0, 1, 2], [1, 3, 2]]);
    assert_eq!(of(r#""mode":6"#), [[1, 2, 0], [2, 3, 0]]);
    assert_eq!(of(r#""mode":5,"indices":2"#), [[0, 1, 2], [1, 0, 2], [2, 0, 2], [0, 3, 2]]);
}

/// Only vertices that are used are there; what is sparse replaces what is not.
#[test]
fn quantized_and_sparse() {
    let json = r#""asset":{"version":"2.0"},"extensionsRequired":["KHR_mesh_quantization"],"extensionsUsed":["KHR_mesh_quantization"],
        "buffers":[{"byteLength":40}],"bufferViews":[{"buffer":0,"byteLength":16,"byteStride":4},{"buffer":0,"byteOffset":16,"byteLength":2},
        {"buffer":0,"byteOffset":20,"byteLength":8},{"buffer":0,"byteOffset":28,"byteLength":6}],
        "accessors":[{"bufferView":0,"componentType":5120,"normalized":true,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0],
        "sparse":{"count":1,"indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":2}}},
        {"bufferView":3,"componentType":5123,"count":3,"type":"SCALAR"}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"nodes":[{"mesh":0}]"#;
    let bytes = [
        &[0, 0, 0, 9, 127, 0, 0, 9, 0, 0x81, 0, 9, 5, 5, 5, 9, 2, 0, 0, 0][..],
        &[127, 127, 0x80, 0, 0, 0, 0, 0],
        &[2, 0, 0, 0, 1, 0],
        &[0; 6],
    ]
    .concat();
    let (model, warnings) = read_as("a.glb", &glb(&format!("{{{json}}}"), &bytes)).expect("sound");
    assert_eq!(model.mesh.positions, [[1.0, 1.0, -1.0], [0.0; 3], [1.0, 0.0, 0.0]], "in order of first use");
    assert!(warnings.is_empty(), "{warnings:?}");
}

#[test]
fn materials_lights_and_cameras() {
    let json = r#""extensionsUsed":["KHR_lights_punctual","KHR_materials_ior","KHR_materials_clearcoat"],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":2,"material":1},{"attributes":{"POSITION":0},"indices":2}]}],
        "materials":[{"name":"lamp","emissiveFactor":[1,0.5,0],"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":8}}},
        {"name":"glass","alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[0.9,1,1,0.2],"metallicFactor":0},
        "extensions":{"KHR_materials_transmission":{"transmissionFactor":1},"KHR_materials_ior":{"ior":1.33}}},
        {"alphaMode":"BLEND"}],
        "cameras":[{"type":"orthographic","orthographic":{"xmag":1,"ymag":1,"zfar":9,"znear":1}},
        {"type":"perspective","perspective":{"yfov":1.5707963,"znear":0.1}}],
        "extensions":{"KHR_lights_punctual":{"lights":[{"type":"point","name":"bulb","color":[1,0.5,0],"intensity":314.15927},
        {"type":"directional","intensity":3.1415927},{"type":"spot","spot":{},"intensity":1},{"type":"point","intensity":-1}]}},
        "nodes":[{"mesh":0},{"camera":0},{"camera":1,"translation":[0.5,0.5,3]},
        {"translation":[0.5,0.5,10],"extensions":{"KHR_lights_punctual":{"light":0}}},{"extensions":{"KHR_lights_punctual":{"light":1}}},
        {"translation":[0.5,0.5,1],"extensions":{"KHR_lights_punctual":{"light":2}}},{"extensions":{"KHR_lights_punctual":{"light":3}}}]"#;
    let (model, warnings) = read_as("a.glb", &glb(&scene(json), &square())).expect("sound");
    let [lamp, glass, see_through, default] = &model.materials[..] else { panic!("{:?}", model.materials) };
    assert_eq!((lamp.name.as_str(), lamp.emission), ("lamp", [8.0, 4.0, 0.0]));
    assert_eq!((glass.reflection, glass.ior, glass.transmission), (Reflection::Dielectric, 1.33, [0.9, 1.0, 1.0]));
    // What is said of a metal by default, and nothing said at all.
    assert_eq!((see_through.reflection, see_through.specular), (Reflection::Glossy, [1.0; 3]));
    assert_eq!((default.reflection, default.name.as_str()), (Reflection::Lambertian, "default"));
    assert_eq!(model.mesh.materials, [1, 1, 3, 3]);

    let camera = model.camera.expect("a camera");
    let ahead = camera.at[2];
    assert_eq!(camera, Camera { eye: [0.5, 0.5, 3.0], at: [0.5, 0.5, ahead], up: [0.0, 1.0, 0.0], fov: camera.fov });
    assert!(ahead < 0.0 && (camera.fov - 90.0).abs() < 1e-4, "{camera}");
    let [bulb, sun, spot] = model.lights[..] else { panic!("{:?}", model.lights) };
    assert_eq!(bulb, Light { position: [0.5, 0.5, 10.0], intensity: [1.0, 0.5, 0.0] });
    assert!(sun.position[2] > 50.0 && sun.position[0] == 0.5 && sun.intensity == [1.0; 3], "{sun:?}");
    assert!(spot.intensity[0] > 0.3, "{spot:?}");
    for (warning, words) in warnings.iter().zip([
        "a.glb: the extension KHR_materials_clearcoat is not supported",
        "material 2: transparency",
        "light 0 \"bulb\": its light does not fall off",
        "light 2: spot lights are not supported",
        "light 3: its light does not",
        "light 3: its place or intensity is not acceptable",
        "camera 0: only perspective",
    ]) {
        assert!(warning.contains(words), "{warnings:#?} lack {words:?}");
    }
    assert_eq!(warnings.len(), 7, "{warnings:#?}");
}

#[test]
fn what_is_passed_over_is_told_once() {
    let json = r#""skins":[{"joints":[1]}],"scenes":[{"nodes":[0,1]},{"nodes":[]}],
        "nodes":[{"name":"body","mesh":0,"skin":0},{"mesh":0}],"meshes":[{"name":"m","primitives":[
        {"attributes":{"POSITION":0,"COLOR_0":1},"indices":2,"targets":[{"POSITION":1}]},{"attributes":{"POSITION":0},"mode":0}]}]"#;
    let (model, warnings) = read_as("a.glb", &glb(&scene(json), &square())).expect("sound");
    assert_eq!(model.mesh.triangles.len(), 4);
    let expected = [
        "of its 2 scenes one is shown",
        "node 0 \"body\": skins are not supported",
        "mesh 0 \"m\", primitive 0: morph targets",
        "mesh 0 \"m\", primitive 0: colours of vertices",
        "mesh 0 \"m\", primitive 1: points and lines",
    ];
    assert_eq!(warnings.len(), expected.len(), "{warnings:#?}");
    for (warning, words) in warnings.iter().zip(expected) {
        assert!(warning.starts_with("a.glb: ") && warning.contains(words), "{warning} lacks {words:?}");
    }
}

/// Each kind of damage to the JSON is an error that names the place.
#[test]
fn faults() {
    for (from, to, reason) in [
        ("\"mesh\":0", "\"mesh\":7", "nodes[0].mesh"),
        ("\"POSITION\":0", "\"POSITION\":9", "mesh 0 \"square\", primitive 0: POSITION is accessor 9, but there are 3"),
        ("\"POSITION\":0,", "", "POSITION"),
        ("\"POSITION\":0", "\"POSITION\":2", "POSITION"),
        ("\"NORMAL\":1", "\"NORMAL\":2", "accessor 2: its elements are Scalar, expected Vec3"),
        ("\"NORMAL\":1", "\"NORMAL\":3", "NORMAL"),
        ("\"indices\":2", "\"indices\":1", "primitive 0: accessor 1: its elements are Vec3, expected Scalar"),
        ("\"componentType\":5121", "\"componentType\":5120", "its indices are no whole numbers"),
        ("\"componentType\":5121", "\"componentType\":5125", "6 elements of 4 bytes do not fit into buffer view 2"),
        ("\"componentType\":5121", "\"componentType\":1", "componentType"),
        ("\"count\":6", "\"count\":5", "its 5 corners are no multiple of 3"),
        ("\"count\":6", "\"count\":7", "7 elements of 1 bytes do not fit"),
        ("\"count\":6", "\"count\":18446744073709551615", "do not fit"),
        ("\"count\":4", "\"count\":3", "other numbers of positions (3) and normals"),
        ("\"bufferView\":0", "\"byteOffset\":18446744073709551615,\"bufferView\":0", "do not fit"),
        ("\"byteOffset\":96", "\"byteOffset\":99", "buffer view 2 reaches beyond the 104 bytes"),
        ("\"byteOffset\":96", "\"byteOffset\":18446744073709551615", "buffer view 2 reaches beyond"),
        ("\"byteLength\":102", "\"byteLength\":9999999999", "buffer 0 has 104 bytes instead of 9999999999"),
        ("\"byteLength\":102", "\"byteLength\":102,\"uri\":\"http://a.b/c.bin\"", "only files beside the scene"),
        ("\"byteLength\":102", "\"byteLength\":102,\"uri\":\"data:;base64,AAA*\"", "not acceptable as base64"),
        ("\"byteLength\":102", "\"byteLength\":102,\"uri\":\".\"", "is no file"),
        (
            "\"bufferView\":0,",
            "\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":2,\"componentType\":5121},\"values\":{\"bufferView\":1}},\"x\":0,",
            "sound",
        ),
        (
            "\"bufferView\":0,",
            "\"sparse\":{\"count\":2,\"indices\":{\"bufferView\":2,\"byteOffset\":2,\"componentType\":5121},\"values\":{\"bufferView\":1}},\"x\":0,",
            "accessor 0: sparse element 0 of 4: they have to be there, and in rising order",
        ),
        ("\"min\":[0,0,0]", "\"min\":[[0],0,0]", "accessor 0: its min and max"),
        ("\"mesh\":0", "\"mesh\":0,\"children\":[0]", "node 0 \"n\" has two parents or is its own descendant"),
        (
            "\"mesh\":0",
            "\"mesh\":0,\"translation\":[1e38,0,0],\"scale\":[3e38,1,1]",
            "vertex 1 is (1, 0, 0), at its place (inf",
        ),
        ("\"nodes\":[0]", "\"nodes\":[0,0]", "two parents"),
        ("\"nodes\":[0]", "\"nodes\":[]", "no triangles"),
        (
            "\"version\":\"2.0\"",
            "\"version\":\"2.0\"},\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"extras\":{",
            "without the extension KHR_draco",
        ),
        (
            "\"nodes\":[{",
            "\"cameras\":[{\"type\":\"perspective\",\"orthographic\":{\"xmag\":1,\"ymag\":1,\"zfar\":9,\"znear\":1}}],\"nodes\":[{\"camera\":0,",
            "camera 0 has another projection",
        ),
        ("\"nodes\":[{", "\"nodes\":[{\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}},", "light"),
    ] {
        let json = scene(PLAIN);
        assert!(json.contains(from), "{from}");
        let file = glb(&json.replacen(from, to, 1), &square());
        if reason == "sound" {
            read_as("a.glb", &file).expect("all zero but for one vertex");
            continue;
        }
        let error = error(&file);
        assert!(error.contains("a.glb: ") && error.contains(reason), "{to}: {error:?} lacks {reason:?}");
    }
    let text = read_as("a.gltf", b"{\n\"asset\": {\"version\": 2.0}}").expect_err("no text").to_string();
    assert!(text.contains("a.gltf:2: not acceptable as glTF"), "{text}");
}

#[test]
fn damaged_numbers() {
    let change = |at: usize, bytes: &[u8]| {
        let mut bin = square();
        bin[at..at + bytes.len()].copy_from_slice(bytes);
        glb(&scene(PLAIN), &bin)
    };
    let nan = f32::NAN.to_le_bytes();
    let message = error(&change(16, &nan));
    assert!(message.contains("mesh 0 \"square\", primitive 0: vertex 1 is (1, NaN, 0)"), "{message}");
    let message = error(&change(100, &[4]));
    assert!(message.contains("primitive 0: corner 4 uses vertex 4, but there are 4"), "{message}");
    let (model, _) = read_as("a.glb", &change(48, &nan)).expect("a normal of no use");
    assert_eq!(
        (model.mesh.normals.len(), model.mesh.normal_indices.len()),
        (0, 0),
        "both triangles have it: they are flat"
    );
}

/// Cut anywhere it is an error, never a panic, and damage is one or is not.
#[test]
fn cut_and_damaged() {
    let file = plain();
    for end in 0..file.len() {
        error(&file[..end]);
    }
    for length in [0_u32, 1, 11, 12, 13, 20, u32::MAX] {
        let mut damaged = file.clone();
        damaged[8..12].copy_from_slice(&length.to_le_bytes());
        error(&damaged);
    }
    for at in 0..file.len() {
        for bits in [0x01, 0x02, 0x10, 0x80] {
            let mut damaged = file.clone();
            damaged[at] ^= bits;
            _ = read_as("a.glb", &damaged);
        }
    }
}

/// Images inside of a buffer, in the JSON and beside the file; coordinates by the material's set and map.
#[cfg(feature = "textures")]
#[test]
fn textures() {
    let png = |color: [u8; 3]| {
        let mut bytes = std::io::Cursor::new(Vec::new());
        image::RgbImage::from_pixel(2, 3, image::Rgb(color))
            .write_to(&mut bytes, image::ImageFormat::Png)
            .expect("encoded");
        bytes.into_inner()
    };
    let image = png([0, 128, 255]);
    let json = r#""extensionsUsed":["KHR_texture_transform"],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":3},"indices":2,"material":0},
        {"attributes":{"POSITION":0,"TEXCOORD_1":3},"indices":2,"material":1},{"attributes":{"POSITION":0},"indices":2,"material":2}]}],
        "materials":[{"pbrMetallicRoughness":{"metallicFactor":0.2,"baseColorTexture":{"index":0}}},
        {"emissiveFactor":[1,1,1],"emissiveTexture":{"index":0},"pbrMetallicRoughness":{"baseColorTexture":{"index":0,
        "texCoord":1,"extensions":{"KHR_texture_transform":{"offset":[0.5,0],"rotation":1.5707963,"scale":[2,3]}}}}},
        {"pbrMetallicRoughness":{"metallicRoughnessTexture":{"index":0},"baseColorTexture":{"index":1}}}],
        "textures":[{"source":0,"sampler":0},{"source":1}],"samplers":[{"wrapS":33071}],
        "images":[{"bufferView":3,"mimeType":"image/png","name":"sky"},{"uri":"none.png"}],"nodes":[{"mesh":0}]"#;
    // Vec2 of the positions' bytes: (0, 0), (0, 1), (0, 0), (1, 1).
    let accessors = ACCESSORS
        .replace("\"byteLength\":102}", &format!("\"byteLength\":{}}}", 104 + image.len()))
        .replace(
            "\"byteLength\":6}",
            &format!("\"byteLength\":6}},{{\"buffer\":0,\"byteOffset\":104,\"byteLength\":{}}}", image.len()),
        )
        .replace("\"SCALAR\"}", "\"SCALAR\"},{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC2\"}");
    let file = glb(&format!("{{{accessors},{json}}}"), &[square(), vec![0; 2], image].concat());
    let (model, warnings) = read_as("a.glb", &file).expect("sound");

    let [sky, lamp, metal, _] = &model.materials[..] else { panic!("{:?}", model.materials) };
    let texture = sky.texture.as_ref().expect("read");
    assert_eq!((texture.name(), texture.size(), sky.texture_on_specular), ("sky", (2, 3), false));
    assert!(lamp.texture_on_specular && std::sync::Arc::ptr_eq(texture, lamp.texture.as_ref().expect("read")));
    assert_eq!(lamp.emission, [0.0, crate::model::LINEAR[128], 1.0], "the mean of the image");
    // Blue is metalness, green roughness.
    assert!(
        metal.texture.is_none() && metal.reflection == Reflection::Glossy && metal.diffuse == [0.0; 3],
        "{metal:?}"
    );

    let uv = |i: usize| model.mesh.uv_indices[i].map(|n| model.mesh.uvs[n as usize]);
    assert_eq!(uv(0), [[0.0, 1.0], [0.0, 0.0], [0.0, 1.0]], "images begin at the top there, and end there here");
    assert_eq!(uv(1), [[0.0, 1.0], [0.0, 1.0], [1.0, 0.0]]);
    for (found, expected) in uv(3).iter().zip([[0.5, 1.0], [0.5, 1.0], [3.5, 3.0]]) {
        assert!(
            (found[0] - expected[0]).abs() < 1e-5 && (found[1] - expected[1]).abs() < 1e-5,
            "{found:?}, not {expected:?}"
        );
    }
    assert_eq!(model.mesh.uv_indices[4..], [Mesh::FLAT; 2]);
    let words = [
        "material 0: textures are repeated",
        "material 1: textures are repeated",
        "material 2: its texture is not read (cannot open",
    ];
    assert_eq!(warnings.len(), 3, "{warnings:#?}");
    assert!(warnings.iter().zip(words).all(|(warning, words)| warning.contains(words)), "{warnings:#?}");
}

/// A texture whose image is in another format only is passed over, and surfaces that it would say much about are plain.
#[test]
fn textures_without_an_image() {
    let json = r#""extensionsRequired":["KHR_texture_basisu"],"extensionsUsed":["KHR_texture_basisu"],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":2,"material":0}]}],
        "materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.5,0.5,0.5,1],"metallicFactor":0,"baseColorTexture":{"index":0}}},
        {"pbrMetallicRoughness":{"metallicFactor":0},"extensions":{"KHR_materials_transmission":{"transmissionFactor":1,
        "transmissionTexture":{"index":0}}}},
        {"extensions":{"KHR_materials_pbrSpecularGlossiness":{"specularGlossinessTexture":{"index":0}}}}],
        "textures":[{"extensions":{"KHR_texture_basisu":{"source":0}}}],"images":[{"uri":"a.ktx2"}],"nodes":[{"mesh":0}]"#;
    let (model, warnings) = read_as("a.glb", &glb(&scene(json), &square())).expect("sound");
    let [plain, opaque, matt, _] = &model.materials[..] else { panic!("{:?}", model.materials) };
    assert!(plain.texture.is_none() && plain.diffuse == [0.5; 3], "{plain:?}");
    assert_eq!((opaque.reflection, matt.reflection), (Reflection::Lambertian, Reflection::Lambertian));
    for (warning, words) in warnings.iter().zip([
        "the extension KHR_texture_basisu is not supported",
        "material 0: its texture is neither PNG nor JPEG: its colour is used",
        "material 1: its texture is neither PNG nor JPEG: it is taken for opaque",
        "material 2: textures of glossiness are not supported",
    ]) {
        assert!(warning.contains(words), "{warnings:#?} lack {words:?}");
    }
    assert_eq!(warnings.len(), 4, "{warnings:#?}");
}
