//! `tracer render`, `tracer generate`.

use crate::{Folder, SQUARES, levels};
use std::io::Cursor;

/// Width, height and pixels.
pub fn png(bytes: &[u8]) -> (u32, u32, Vec<u8>) {
    let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().expect("a picture");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut pixels).expect("pixels");
    assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
    assert!(reader.info().srgb.is_some(), "says that it is sRGB");
    (info.width, info.height, pixels)
}

fn colors(pixels: &[u8]) -> usize {
    let mut colors = pixels.as_chunks::<3>().0.to_vec();
    colors.sort_unstable();
    colors.dedup();
    colors.len()
}

#[test]
fn a_picture_under_the_scene_s_name() {
    let folder = Folder::new();
    let out = folder.run("render balls:1 --size 67x41");
    assert_eq!(folder.files(), ["balls.png"]);
    assert!(out.contains("balls, 1,922 triangles") && out.contains("wrote     balls.png"), "{out}");
    let (width, height, pixels) = png(&folder.read("balls.png"));
    assert_eq!((width, height), (67, 41));
    assert!(colors(&pixels) > 100, "{} colours", colors(&pixels));
}

#[test]
fn the_same_picture_on_every_level() {
    let folder = Folder::new();
    folder.run("render balls:1 --size 40x30 --shadows -o first.png --level scalar --width 1 --threads 1");
    for level in levels() {
        for width in ["4", "8", "16", "auto"] {
            folder.run(&format!("render balls:1 --size 40x30 --shadows -o x.png --level {level} --width {width}"));
            assert!(folder.read("x.png") == folder.read("first.png"), "{level}, width {width}");
        }
    }
    folder.run("render balls:1 --size 40x30 --shadows -o x.png --build insertion --seed 3 --slab conservative");
    assert!(folder.read("x.png") == folder.read("first.png"), "insertion");
    folder.run("render balls:1 --size 40x30 -o x.png");
    assert!(folder.read("x.png") != folder.read("first.png"), "without shadows");
}

#[test]
fn linear_floats_in_exr() {
    use exr::prelude::*;
    let folder = Folder::new();
    folder.run("render balls:0 --size 31x17 -o out.exr");
    let empty = |size: Vec2<usize>, _: &_| (size.0, vec![[0.0_f32; 3]; size.0 * size.1]);
    let set = |(width, all): &mut (usize, Vec<[f32; 3]>), at: Vec2<usize>, (r, g, b): (f32, f32, f32)| {
        all[at.1 * *width + at.0] = [r, g, b];
    };
    let reader = read().no_deep_data().largest_resolution_level().rgb_channels(empty, set);
    let image = reader.first_valid_layer().all_attributes();
    let image = image.from_buffered(Cursor::new(folder.read("out.exr"))).expect("a picture");
    assert_eq!(image.layer_data.size, Vec2(31, 17));
    let (_, pixels) = image.layer_data.channel_data.pixels;
    folder.run("render balls:0 --size 31x17 -o out.png");
    let (.., encoded) = png(&folder.read("out.png"));
    for (linear, srgb) in pixels.iter().flatten().zip(encoded) {
        let linear = linear.clamp(0.0, 1.0);
        let encoded = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
        assert!((255.0 * encoded - f32::from(srgb)).abs() < 0.51, "{linear} became {srgb}");
    }
    assert!(pixels.iter().flatten().any(|&c| c > 0.1));
}

#[test]
fn an_obj_without_camera_and_lights_is_framed_and_lit() {
    let folder = Folder::with("squares.obj", SQUARES);
    let report = folder.json("render squares.obj --size 50x40 --json");
    assert_eq!(folder.files(), ["squares.obj", "squares.png"]);
    assert_eq!((&report["scene"], &report["triangles"]), (&"squares".into(), &4.into()));
    let hits = report["hits"].as_u64().expect("a number");
    assert!(hits > 200 && hits < 2000, "{hits} of 2000 pixels");
    assert_eq!(report["rays"], 2000);
    for key in ["load_ms", "build_ms", "eye_ms", "cast_ms", "shade_ms", "total_ms", "mrays_per_s"] {
        assert!(report[key].as_f64().is_some_and(|n| n >= 0.0), "{key}: {}", report[key]);
    }
    let (.., pixels) = png(&folder.read("squares.png"));
    assert!(colors(&pixels) > 1);
}

#[test]
fn a_method_without_a_tree_builds_none() {
    let folder = Folder::with("squares.obj", SQUARES);
    let [with, without] = ["packet", "divide-conquer"]
        .map(|method| folder.json(&format!("render squares.obj --size 50x40 --json --method {method}")));
    assert_eq!((&with["build"], &without["build"]), (&"medium".into(), &"none".into()));
    assert_eq!((with["nodes"].as_u64() > Some(0), without["nodes"].as_u64()), (true, Some(0)));
    assert_eq!((&with["hits_hash"], &with["image_hash"]), (&without["hits_hash"], &without["image_hash"]));
    let out = folder.run("render squares.obj --size 50x40 --method divide-conquer");
    assert!(out.contains("tree      none, triangles taken apart in "), "{out}");
}

#[test]
fn cameras() {
    let folder = Folder::with("squares.obj", SQUARES);
    let away = folder.json("render squares.obj --size 8x8 --json --camera -0.5,0.5,5/-0.5,0.5,9");
    assert_eq!(away["hits"], 0);
    let near = folder.json("render squares.obj --size 8x8 --json --camera 0.5,0.5,0.5/0.5,0.5,0/0,1,0/30");
    assert_eq!((&near["hits"], &near["camera"]), (&64.into(), &"0.5,0.5,0.5/0.5,0.5,0/0,1,0/30".into()));
}

#[test]
fn generated_scenes_are_read_back_as_they_were() {
    let folder = Folder::new();
    let built_in = folder.json("render balls:1 --size 64x64 --json");
    let out = folder.run("generate balls --size 1 -o copy.obj");
    assert!(out.contains("copy.obj") && out.contains("1,922"), "{out}");
    let copy = folder.json("render copy.obj --size 64x64 --camera 2.1,1.3,1.7/0,0,0/0,0,1/45 --json");
    assert_eq!(copy["hits_hash"], built_in["hits_hash"]);
    folder.run("generate hairball --size 2 -o hair.ply");
    assert!(folder.read("hair.ply").starts_with(b"ply\n"));
    assert_eq!(folder.files(), ["balls.png", "copy.mtl", "copy.obj", "copy.png", "hair.ply"]);
}

/// A red and a green wall under a lamp, and a mirror.
const ROOM: (&str, &str) = (
    "mtllib room.mtl\nv -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\nv -.5 1.9 -.5\nv .5 1.9 -.5\nv .5 1.9 .5\n\
     v -.5 1.9 .5\nusemtl red\nf 1 2 3 4\nf 1 2 6 5\nusemtl green\nf 1 4 8 5\nusemtl mirror\nf 2 3 7 6\nusemtl lamp\nf 9 10 11 12\n",
    "newmtl red\nKd .7 .1 .1\nnewmtl green\nKd .1 .7 .1\nnewmtl mirror\nKs .9 .9 .9\nillum 3\nnewmtl lamp\nKd 0 0 0\nKe 9 9 9\n",
);
const VIEW: &str = "--camera 0.2,1,4/0,1,0 --size 32x24";

/// One picture by every method and level; more samples, less noise; a part of it.
#[test]
fn light_by_whitted_and_paths() {
    let folder = Folder::with("room.obj", ROOM.0);
    folder.write("room.mtl", ROOM.1);
    for options in
        ["path --samples 4 --bounces 3 --mis --roulette --seed 5", "whitted --samples 2", "ao --distance 0.5"]
    {
        let command = format!("render room.obj {VIEW} --json -o x.png --integrator {options}");
        let report = folder.json(&command);
        assert!(report["rays"].as_u64().is_some_and(|n| n > 32 * 24) && report["bounces"][0][1] != 0, "{report}");
        for level in levels() {
            for method in ["packet", "single8"] {
                let again = folder.json(&format!("{command} --level {level} --method {method} --threads 1"));
                assert_eq!(again["image_hash"], report["image_hash"], "{options}, {level}, {method}");
            }
        }
    }
    let hash =
        |options: &str| folder.json(&format!("render room.obj {VIEW} --json -o x.png --integrator path {options}"));
    let plain = hash("--samples 2");
    assert_eq!(hash("--samples 2 --ungrouped")["image_hash"], plain["image_hash"]);
    assert_ne!(hash("--samples 2 --seed 1")["image_hash"], plain["image_hash"]);
    assert_eq!(hash("--samples 2 --crop 3,4,5,6")["width"], 5);
    assert_eq!(hash("--samples 1000000 --time-limit 0")["samples"], 1);
    let out = folder.run(&format!("render room.obj {VIEW} -o a.png --integrator path"));
    assert!(out.contains("rays to lights") && out.contains("wrote     a.png"), "{out}");
    for curve in ["reinhard", "aces"] {
        folder.run(&format!("render room.obj {VIEW} -o b.png --integrator path --tone {curve} --exposure -1"));
        assert!(folder.read("a.png") != folder.read("b.png"));
    }
}

#[test]
fn layers_in_exr() {
    use exr::prelude::*;
    let folder = Folder::with("room.obj", ROOM.0);
    folder.write("room.mtl", ROOM.1);
    folder.run(&format!("render room.obj {VIEW} -o out.exr --integrator path --samples 4 --layers"));
    let reader = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes();
    let image = reader.from_buffered(Cursor::new(folder.read("out.exr"))).expect("a picture");
    let channels = &image.layer_data.channel_data.list;
    let names: Vec<String> = channels.iter().map(|c| c.name.to_string()).collect();
    let expected =
        "B G R Z albedo.B albedo.G albedo.R cost.rays material.ID normal.X normal.Y normal.Z primitive.ID variance.Y";
    assert_eq!(names.join(" "), expected);
    let middle = 12 * 32 + 16;
    let at =
        |name: &str| channels.iter().find(|c| c.name.eq(name)).expect(name).sample_data.values_as_f32().nth(middle);
    // The wall at the back, from 4 in front of the room's middle.
    let (z, normal) = (at("Z").expect("a pixel"), at("normal.Z").expect("a pixel"));
    assert!((z - 5.0).abs() < 0.1 && normal == 1.0 && at("albedo.R") == Some(0.7), "{z} {normal}");
    assert_eq!((at("material.ID"), at("primitive.ID").map(|id| id == 2.0 || id == 3.0)), (Some(0.0), Some(true)));
    assert!(at("variance.Y").is_some_and(|v| v >= 0.0));
    assert!(at("cost.rays").is_some_and(|n| n > 4.0 && n <= 24.0));
}

#[test]
fn options_of_light_that_make_no_sense() {
    let folder = Folder::with("s.obj", SQUARES);
    for (options, words) in [
        ("--samples 4", &["--samples", "whitted, ao and path"][..]),
        ("--mis", &["--mis", "--integrator path"]),
        ("--integrator whitted --roulette", &["--roulette", "--integrator path"]),
        ("--integrator ao --bounces 3", &["--bounces"]),
        ("--integrator path --distance 3", &["--distance", "--integrator ao"]),
        ("--integrator path --shadows", &["--shadows", "always"]),
        ("--integrator ao --distance 0", &["above 0"]),
        ("--integrator path --crop 0,0,9,9 --size 8x8", &["0,0,9,9", "not inside"]),
        ("--integrator path --crop 0,0,9", &["four whole numbers"]),
        ("--integrator path --samples 0", &["samples"]),
        ("--integrator path --tone filmic", &["none, reinhard, aces"]),
        ("--exposure 1e9", &["--exposure"]),
        ("--integrator path --time-limit=-1", &["--time-limit"]),
        ("--integrator path --time-limit nan", &["--time-limit"]),
        ("-o x.exr --tone aces", &["--tone", ".png"]),
        ("--integrator path --layers", &["--layers", ".exr"]),
        ("--seed 3", &["--seed"]),
    ] {
        folder.fails(&format!("render s.obj {options}"), 2, words);
    }
}
