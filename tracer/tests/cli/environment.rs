//! `tracer render --environment`, `--cost`.

use crate::{Folder, SQUARES, levels};
use exr::prelude::*;

/// A picture in Radiance's format, without compression: for each pixel three mantissas and an exponent.
fn hdr(width: usize, height: usize, pixel: impl Fn(usize, usize) -> [u8; 4]) -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {width}\n").into_bytes();
    bytes.extend((0..width * height).flat_map(|i| pixel(i % width, i / width)));
    bytes
}

fn exr_file(folder: &Folder, name: &str, size: (usize, usize), pixel: impl Fn(usize, usize) -> [f32; 3] + Sync) {
    let pixel = |Vec2(x, y): Vec2<usize>| {
        let [r, g, b] = pixel(x, y);
        (r, g, b)
    };
    Image::from_channels(size, SpecificChannels::rgb(pixel))
        .write()
        .to_file(folder.path().join(name))
        .expect("written");
}

const SIZE: (usize, usize) = (6, 4);

/// Brighter above, and one pixel much brighter.
fn light(x: usize, y: usize) -> [f32; 3] {
    let bright = if (x, y) == (4, 1) { 64.0 } else { 1.0 };
    [bright * (4 - y) as f32 / 4.0, bright / 2.0, bright / 4.0]
}

fn scene() -> Folder {
    let folder = Folder::with("s.obj", SQUARES);
    exr_file(&folder, "sky.exr", SIZE, light);
    // 128 with the exponent 129 is 1.
    let exponent = |x: usize, y: usize| if (x, y) == (4, 1) { 135 } else { 129 };
    folder.write("sky.hdr", hdr(SIZE.0, SIZE.1, |x, y| [32 * (4 - y) as u8, 64, 32, exponent(x, y)]));
    folder
}

#[test]
fn one_map_in_two_formats_on_every_level() {
    let folder = scene();
    for integrator in ["path --mis --samples 4", "path --samples 2", "whitted"] {
        let command = format!("render s.obj --size 32x24 --json -o x.exr --integrator {integrator}");
        let report = folder.json(&format!("{command} --environment sky.exr"));
        let hash = |options: &str| folder.json(&format!("{command} {options}"))["image_hash"].clone();
        assert_eq!(hash("--environment sky.hdr"), report["image_hash"]);
        for level in levels() {
            assert_eq!(hash(&format!("--environment sky.exr --level {level} --threads 1")), report["image_hash"]);
        }
        assert_ne!(hash(""), report["image_hash"]);
        assert_ne!(hash("--environment sky.exr --environment-rotation -90"), report["image_hash"]);
        assert_ne!(hash("--environment sky.exr --up z"), report["image_hash"]);
        assert_eq!(hash("--environment sky.exr --up y"), report["image_hash"]);
    }
    // Built-in scenes say what is up.
    let hash = |options: &str| {
        let command = "render balls:0 --size 16x12 --integrator path --json -o x.png --environment sky.hdr";
        folder.json(&format!("{command} {options}"))["image_hash"].clone()
    };
    assert_eq!(hash(""), hash("--up z"));
    assert_ne!(hash(""), hash("--up y"));
}

/// A Radiance file's exposure says by what its pixels were multiplied.
#[test]
fn exposure() {
    let folder = scene();
    let text = folder.read("sky.hdr");
    let doubled: Vec<u8> = [&b"#?RADIANCE\nEXPOSURE=2\n"[..], &text[11..]].concat();
    folder.write("doubled.hdr", doubled);
    exr_file(&folder, "half.exr", SIZE, |x, y| light(x, y).map(|c| c / 2.0));
    let hash = |map: &str| {
        folder.json(&format!("render s.obj --size 8x8 --integrator path --json -o x.png --environment {map}"))["image_hash"].clone()
    };
    assert_eq!(hash("doubled.hdr"), hash("half.exr"));
    folder.write("rgbe.hdr", [&b"#?RGBE\n"[..], &text[11..]].concat());
    assert_eq!(hash("rgbe.hdr"), hash("sky.hdr"), "another name of the format");
}

#[test]
fn what_is_no_map() {
    let folder = scene();
    folder.write("text.hdr", "hello");
    folder.write("text.exr", "hello");
    folder.write("short.hdr", &folder.read("sky.hdr")[..60]);
    folder.write("short.exr", &folder.read("sky.exr")[..300]);
    folder.write("empty.hdr", b"");
    folder.write("huge.hdr", b"#?RADIANCE\n\n-Y 60000 +X 60000\n");
    folder.write("none.hdr", b"#?RADIANCE\n\n-Y 0 +X 0\n");
    folder.write("sky.png", "hello");
    for (name, bad) in [("nan.exr", f32::NAN), ("infinite.exr", f32::INFINITY), ("negative.exr", -0.25)] {
        exr_file(&folder, name, SIZE, |x, y| if (x, y) == (2, 3) { [0.5, bad, 0.5] } else { [1.0; 3] });
        let command = format!("render s.obj --integrator path --environment {name}");
        folder.fails(&command, 1, &[name, "pixel 2,3", "correct the map"]);
    }
    // Says that it was packed in another way than it was.
    let mut packed = folder.read("sky.exr");
    let name = b"compression\0compression\0\x01\0\0\0";
    let at = packed.windows(name.len()).position(|bytes| bytes == name).expect("an attribute") + name.len();
    packed[at] = 8;
    folder.write("lossy.exr", packed);
    for (name, code, words) in [
        ("lossy.exr", 1, &["dwaa compression", "save it with zip"][..]),
        ("text.hdr", 1, &["not a Radiance picture"]),
        ("text.exr", 1, &["not an OpenEXR picture"]),
        ("short.hdr", 1, &["not a Radiance picture"]),
        ("short.exr", 1, &["not an OpenEXR picture"]),
        ("empty.hdr", 1, &["not a Radiance picture"]),
        ("huge.hdr", 1, &["60000x60000", "scale it down"]),
        ("none.hdr", 1, &["0x0"]),
        ("missing.hdr", 1, &["cannot open missing.hdr"]),
        ("sky.png", 2, &[".hdr or .exr"]),
    ] {
        let words = [words, &[name]].concat();
        folder.fails(&format!("render s.obj --integrator path --environment {name}"), code, &words);
    }
    for (options, words) in [
        ("--environment sky.hdr", &["--environment", "whitted and path"][..]),
        ("--integrator ao --environment sky.hdr", &["--environment", "whitted and path"]),
        ("--integrator path --environment-rotation 3", &["--environment"]),
        ("--integrator path --environment sky.hdr --environment-rotation inf", &["finite"]),
        ("--integrator path --environment sky.hdr --up x", &["known: y, z"]),
        ("--cost c.png", &["--cost", "--integrator"]),
        ("--integrator path --cost c.exr", &["--cost", ".png"]),
    ] {
        folder.fails(&format!("render s.obj {options}"), 2, words);
    }
}

/// Another map, another picture: its checkpoint is refused.
#[test]
fn checkpoints_know_the_map() {
    let folder = scene();
    let command = "render s.obj --size 8x8 --integrator path --samples 2 --checkpoint film --environment sky.hdr";
    folder.run(command);
    folder.run(command);
    folder.fails(&format!("{command} --environment-rotation 5"), 1, &["its environment is map", "turned by 5 degrees"]);
}

#[test]
fn cost_in_false_colours() {
    let folder = scene();
    let command = "render s.obj --size 32x24 --integrator path --samples 4 --cost cost.png -o x.png";
    let report = folder.json(&format!("{command} --json"));
    let most = report["cost"]["most_rays"].as_u64().expect("a number");
    // Three rays and three to lights at most, for each sample.
    assert!(most > 4 && most <= 24, "{most}");
    let mut reader = png::Decoder::new(std::io::Cursor::new(folder.read("cost.png"))).read_info().expect("a picture");
    let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
    let info = reader.next_frame(&mut pixels).expect("pixels");
    assert_eq!((info.width, info.height), (32, 24));
    let color = |rgb: [u8; 3]| pixels.as_chunks::<3>().0.contains(&rgb);
    assert!(color([252, 255, 164]) && !color([0, 0, 4]));
    assert!(folder.run(command).contains(&format!("cost      cost.png, up to {most} rays")));
}
