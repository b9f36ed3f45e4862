//! `tracer render`, `tracer generate`.

use crate::{Folder, SQUARES, levels};
use std::io::Cursor;

/// Width, height and pixels.
fn png(bytes: &[u8]) -> (u32, u32, Vec<u8>) {
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
