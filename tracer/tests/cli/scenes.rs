//! Scenes from files, by all commands that take one.

use crate::batches::rays_npy;
use crate::{Folder, levels};

/// The squares of [`crate::SQUARES`].
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n\
                   property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n-1 -1 -1\n2 -1 -1\n2 2 -1\n-1 2 -1\n\
                   4 0 1 2 3\n4 4 5 6 7\n";

/// A scene as `.ply` is that as `.obj`, to every command.
#[test]
fn ply_is_obj() {
    let folder = Folder::with("s.ply", PLY);
    folder.write("s.obj", crate::SQUARES);
    folder.write("rays.npy", rays_npy(&[[0.5, 0.5, 1.0, 0.0, 0.0, 0.0, -1.0, f32::INFINITY]; 3]));
    let render =
        |file: &str, options: &str| folder.json(&format!("render {file} --size 24x20 --json -o x.png {options}"));
    for options in ["--shadows", "--integrator path --samples 2"] {
        assert_eq!(render("s.ply", options)["image_hash"], render("s.obj", options)["image_hash"], "{options}");
    }
    folder.run("trace s.ply --rays rays.npy --hits ply.npy");
    folder.run("trace s.obj --rays rays.npy --hits obj.npy");
    assert!(folder.read("ply.npy") == folder.read("obj.npy"));
    assert_eq!(
        folder.json("info s.ply --json")["scene"]["triangles"],
        folder.json("info s.obj --json")["scene"]["triangles"]
    );
    assert!(folder.run("compare s.ply --size 8x8 --repeat 1").contains("same bits"));
    folder.run("render s.ply --size 8x8");
    assert!(folder.files().contains(&"s.png".into()));
}

#[test]
fn generated_ply_is_read_back() {
    let folder = Folder::new();
    folder.run("generate rings --size 1 -o copy.ply");
    let view = "--size 40x30 --json --camera 3,3,3/0,0,0/0,0,1/45 -o x.png";
    let [copy, built_in] = ["copy.ply", "rings:1"].map(|scene| folder.json(&format!("render {scene} {view}")));
    assert_eq!(copy["hits_hash"], built_in["hits_hash"]);
    assert!(built_in["hits"].as_u64().is_some_and(|n| n > 0));
}

#[test]
fn plys_that_are_not_sound() {
    let folder = Folder::new();
    for (from, to, words) in [
        ("1 1 0", "1 nan 0", ["bad.ply:12: y of vertex 2 is NaN", "finite"]),
        ("0 1 2 3\n", "0 1 2 8\n", ["bad.ply:18: face 0 uses vertex 8", "there are 8"]),
        ("ply\n", "pl\n", ["bad.ply", "no PLY file"]),
        ("\n4 4 5 6 7\n", "", ["bad.ply", "cut short"]),
    ] {
        folder.write("bad.ply", PLY.replacen(from, to, 1));
        for command in ["render bad.ply -o x.png", "info bad.ply"] {
            folder.fails(command, 1, &words);
        }
    }
}

/// A lamp over a floor, and a camera that looks at the floor. Both are the square with corners (0, 0, 0) and (1, 1, 0).
const LIT: &str = r#"{"asset":{"version":"2.0"},"buffers":[{"uri":"square.bin","byteLength":54}],
"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":6}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"}],
"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.8,0.1,0.1,1],"metallicFactor":0}},{"emissiveFactor":[1,1,1],
"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":5}}}],
"meshes":[{"name":"floor","primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]},
{"name":"lamp","primitives":[{"attributes":{"POSITION":0},"indices":1,"material":1}]}],
"cameras":[{"type":"perspective","perspective":{"yfov":0.6,"znear":0.1}}],
"nodes":[{"mesh":0},{"mesh":1,"translation":[0,0,1],"scale":[0.5,0.5,1]},{"camera":0,"translation":[0.6,0.6,2]}],
"scenes":[{"nodes":[0,1,2]}],"scene":0}"#;

fn lit() -> Folder {
    let folder = Folder::with("lit.gltf", LIT);
    let floats = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0_f32];
    folder.write(
        "square.bin",
        floats.into_iter().flat_map(f32::to_le_bytes).chain([0, 1, 2, 0, 2, 3]).collect::<Vec<u8>>(),
    );
    folder
}

/// A scene as `.gltf`, with its camera and lamps, and the same as `.glb`.
#[test]
fn gltf_with_a_lamp_and_a_camera() {
    let folder = lit();
    let json = LIT.replace("\"uri\":\"square.bin\",", "");
    let json = format!("{json:0$}", json.len().next_multiple_of(4));
    let bin = [folder.read("square.bin"), vec![0; 2]].concat();
    let chunk = |kind: &[u8], bytes: &[u8]| [&(bytes.len() as u32).to_le_bytes()[..], kind, bytes].concat();
    let chunks = [chunk(b"JSON", json.as_bytes()), chunk(b"BIN\0", &bin)].concat();
    folder.write("lit.glb", [&b"glTF\x02\0\0\0"[..], &(chunks.len() as u32 + 12).to_le_bytes(), &chunks].concat());

    let render =
        |file: &str| folder.json(&format!("render {file} --size 24x24 --json --integrator path --samples 8 -o x.png"));
    let (text, binary) = (render("lit.gltf"), render("lit.glb"));
    assert_eq!(text["image_hash"], binary["image_hash"]);
    assert!(text["camera"].as_str().is_some_and(|c| c.starts_with("0.6,0.6,2/0.6,0.6,-")), "{text}");
    let (.., pixels) = crate::pictures::png(&folder.read("x.png"));
    let [r, g, b] = pixels.as_chunks::<3>().0[12 * 24 + 12];
    assert!(r > g && r > b, "the floor is red, under a blue sky: {r} {g} {b}");
    assert!(pixels.as_chunks::<3>().0.contains(&[255; 3]), "the lamp is white");
    assert_eq!(folder.json("info lit.glb --json")["scene"]["triangles"], 4);
}

/// A camera that looks straight down does not turn the map: y is up in files.
#[test]
fn gltf_cameras_do_not_say_what_is_up() {
    let folder = lit();
    let down = "{\"camera\":0,\"translation\":[0.6,2,0.6],\"rotation\":[-0.70710678,0,0,0.70710678]}";
    folder.write("down.gltf", LIT.replacen("{\"camera\":0,\"translation\":[0.6,0.6,2]}", down, 1));
    let rows = [32, 64, 96, 128].map(|red: u8| [[red, 64, 32, 129]; 6]);
    let header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 6\n";
    folder.write("sky.hdr", [&header[..], rows.as_flattened().as_flattened()].concat());
    let hash = |options: &str| {
        let command = "render down.gltf --size 8x8 --json --integrator path -o x.png --environment sky.hdr";
        folder.json(&format!("{command} {options}"))["image_hash"].clone()
    };
    assert_eq!(hash(""), hash("--up y"));
    assert_ne!(hash(""), hash("--up z"));
}

#[test]
fn gltfs_that_are_not_sound() {
    let folder = lit();
    for (from, to, words) in [
        ("\"mesh\":1", "\"mesh\":2", ["bad.gltf", "nodes[1].mesh"]),
        ("square.bin", "none.bin", ["cannot open none.bin", "No such file"]),
        ("\"count\":6", "\"count\":9", ["mesh 0 \"floor\", primitive 0", "buffer view 1"]),
        ("\"asset\":", "\"asset\"", ["bad.gltf:1", "expected `:`"]),
    ] {
        folder.write("bad.gltf", LIT.replacen(from, to, 1));
        folder.fails("render bad.gltf -o x.png", 1, &words);
    }
    folder.write("bad.glb", "glTF\x02\0\0\0\0\0\0\0");
    folder.fails("info bad.glb", 1, &["bad.glb", "12 bytes, its header says 0"]);
    folder.write(
        "warns.gltf",
        LIT.replacen("\"scene\":0", "\"scene\":0,\"extensionsUsed\":[\"KHR_materials_sheen\"]", 1),
    );
    let output = folder.command("info warns.gltf").output().expect("started");
    let (_, code, err) = crate::parts(&output);
    assert!(code == Some(0) && err.contains("warns.gltf: the extension KHR_materials_sheen is not supported"), "{err}");
}

/// The corners of an image are where they belong, on every level; without the image the colour is used.
#[test]
fn textures_of_an_mtl() {
    let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3 4/4\n";
    let folder = Folder::with("a.obj", obj);
    folder.write("a.mtl", "newmtl a\nKd 1 1 1\nmap_Kd -clamp off a b.png\n");
    let view = "--camera 0.5,0.5,2/0.5,0.5,0//40 --size 64x64 -o x.png";
    let output = folder.command(&format!("render a.obj {view}")).output().expect("started");
    let (_, code, err) = crate::parts(&output);
    assert!(code == Some(0) && err.contains("a.mtl:3: the texture a b.png cannot be read"), "{err}");

    let image = image::RgbImage::from_fn(2, 2, |x, y| {
        image::Rgb([[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 0]][(x + 2 * y) as usize])
    });
    image.save(folder.path().join("a b.png")).expect("written");
    for integrator in ["eye", "whitted"] {
        let command = format!("render a.obj {view} --json --integrator {integrator}");
        let hash = folder.json(&command)["image_hash"].clone();
        for level in levels() {
            assert_eq!(folder.json(&format!("{command} --level {level}"))["image_hash"], hash, "{integrator}, {level}");
        }
        let (.., pixels) = crate::pictures::png(&folder.read("x.png"));
        let quarter = |x: usize, y: usize| pixels.as_chunks::<3>().0[y * 64 + x].map(|c| c > 128);
        let found = [quarter(22, 22), quarter(41, 22), quarter(22, 41), quarter(41, 41)];
        assert_eq!(
            found,
            [[true, false, false], [false, true, false], [false, false, true], [true, true, false]],
            "{integrator}"
        );
    }
}
