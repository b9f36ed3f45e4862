//! Every kind of bad input: a message that says what, where and what to do, the right exit code, no file left behind.

use crate::batches::{npy, rays_npy};
use crate::{Folder, SQUARES};

#[test]
fn scenes_that_are_not_there() {
    let folder = Folder::with("scene.blend", "");
    std::fs::create_dir(folder.path().join("folder.obj")).expect("made");
    for command in ["render {} -o out.png", "compare {} -o out.svg", "info {}", "trace {} --rays r.npy --hits out.npy"]
    {
        folder.write("r.npy", rays_npy(&[]));
        let run = |scene: &str, code, words: &[&str]| folder.fails(&command.replace("{}", scene), code, words);
        run("none.obj", 1, &["cannot open none.obj", "No such file"]);
        run("none/none.obj.zst", 1, &["cannot open none/none.obj.zst"]);
        run("folder.obj", 1, &["folder.obj"]);
        run("scene.blend", 2, &["scene.blend", ".obj"]);
        run("bals", 2, &["bals", "balls, rings, tree, hairball"]);
        run("balls:99", 2, &["balls:99", "from 0 to 6"]);
    }
}

#[test]
fn objs_that_are_not_sound() {
    let folder = Folder::new();
    for (obj, words) in [
        ("v 0 0 0\nv 1 nan 0\nv 0 1 0\nf 1 2 3\n", &["bad.obj:2", "finite"][..]),
        ("v 0 0 0\nv 1 0 0\nv 0 inf 0\nf 1 2 3\n", &["bad.obj:3", "finite"]),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", &["bad.obj:4"]),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n", &["bad.obj:4"]),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", &["bad.obj:4"]),
        ("v 0 0 0\nv 1 0 0\n\nf 1 2\n", &["bad.obj:4"]),
        ("v 0 0 0\nv 1 x 0\n", &["bad.obj:2"]),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\n", &["bad.obj", "no faces"]),
        ("", &["bad.obj", "no faces"]),
    ] {
        folder.write("bad.obj", obj);
        folder.write("r.npy", rays_npy(&[]));
        folder.fails("render bad.obj -o out.png", 1, words);
        folder.fails("trace bad.obj --rays r.npy --hits out.npy", 1, words);
    }
    folder.write("bad.obj.zst", "this is not zstd");
    folder.fails("info bad.obj.zst", 1, &["bad.obj.zst"]);
    folder.write("bad.obj.gz", "this is not gzip");
    folder.fails("info bad.obj.gz", 1, &["bad.obj.gz"]);
}

#[test]
fn rays_that_are_not_sound() {
    let folder = Folder::with("s.obj", SQUARES);
    let good = rays_npy(&[[0.0; 8]; 4]);
    let data = [0; 128];
    let long = [&b"\x93NUMPY\x02\x00"[..], &u32::MAX.to_le_bytes()].concat();
    let huge = npy("'<f4'", false, "(18446744073709551615, 8)", &data);
    for (file, words) in [
        (npy("'<f4'", false, "(16, 2)", &data), &["(16, 2)", "(N, 8)", "t_min"][..]),
        (npy("'<f4'", false, "(32,)", &data), &["(32,)", "(N, 8)"]),
        (npy("'<f4'", false, "(2, 2, 8)", &data), &["(2, 2, 8)", "(N, 8)"]),
        (npy("'<f4'", false, "(8589934592, 8589934592)", &data), &["(8589934592", "(N, 8)"]),
        (npy("'<f8'", false, "(2, 8)", &data), &["'<f8'", "'<f4'", "astype"]),
        (npy("'>f4'", false, "(4, 8)", &data), &["'>f4'", "little-endian"]),
        (npy("'<i4'", false, "(4, 8)", &data), &["'<i4'", "'<f4'"]),
        (npy("[('x', '<f4'), ('y', '<f4')]", false, "(16,)", &data), &["[('x', '<f4'), ('y', '<f4')]", "'<f4'"]),
        (npy("'|O'", false, "(4, 8)", &data), &["'|O'"]),
        (npy("'<f4'", true, "(4, 8)", &data), &["Fortran", "ascontiguousarray"]),
        (good[..good.len() - 1].to_vec(), &["ends in row 3 of 4"]),
        (huge, &["ends in row 4 of 18446744073709551615"]),
        (good[..40].to_vec(), &["no .npy file", "numpy.save"]),
        (good[..9].to_vec(), &["no .npy file"]),
        (long, &["no .npy file"]),
        (b"PK\x03\x04".to_vec(), &["no .npy file"]),
        (Vec::new(), &["no .npy file"]),
    ] {
        folder.write("rays.npy", file);
        let words = [&["rays.npy: "], words].concat();
        folder.fails("trace s.obj --rays rays.npy --hits hits.npy", 1, &words);
        folder.fails("trace s.obj --rays rays.npy --hits hits.npy --any", 1, &words);
    }
    folder.fails("trace s.obj --rays none.npy --hits hits.npy", 1, &["cannot open none.npy"]);
    folder.fails("trace s.obj --rays . --hits hits.npy", 1, &["cannot read ."]);
}

#[test]
fn options_that_make_no_sense() {
    let folder = Folder::with("s.obj", SQUARES);
    for size in ["0x100", "100x0", "100", "x", "-1x5", "65536x1", "99999999999999999999x1", "1.5x2"] {
        folder.fails(&format!("render s.obj --size={size}"), 2, &[size, "from 1 to 65535 pixels"]);
        folder.fails(&format!("compare s.obj --size={size}"), 2, &[size]);
    }
    // More than 2^39 bytes.
    folder.fails("render s.obj --size 65535x65535", 2, &["65535x65535", "memory", "smaller"]);
    folder.fails("compare s.obj --size 65535x65535", 2, &["65535x65535", "memory", "smaller"]);

    let lacking = if cfg!(target_arch = "aarch64") { "sse2" } else { "neon" };
    for command in ["render s.obj", "info", "trace s.obj --rays r.npy --hits h.npy"] {
        folder.fails(&format!("{command} --level {lacking}"), 2, &["this CPU lacks level", lacking, "scalar"]);
        folder.fails(&format!("{command} --level mmx"), 2, &["unknown level 'mmx'", "avx512"]);
        folder.fails(&format!("{command} --threads 0"), 2, &["--threads"]);
        folder.fails(&format!("{command} --threads 1000000"), 2, &["--threads 1000000", "4096"]);
        folder.fails(&format!("{command} --build best"), 2, &["fast, medium, high, insertion"]);
        folder.fails(&format!("{command} --seed 1"), 2, &["--build insertion"]);
        folder.fails(&format!("{command} --seed 1 --build high"), 2, &["--build insertion"]);
        folder.fails(&format!("{command} --what"), 2, &["--what"]);
    }
    folder.fails("render s.obj --method best", 2, &["packet, ordered, single4"]);
    folder.fails("render s.obj --method auto --width 4", 2, &["--width is for --method packet, ordered"]);
    folder.fails("render s.obj --width 5", 2, &["unknown width '5'", "16"]);
    folder.fails("render s.obj -o out.jpg", 2, &["out.jpg", ".png or .exr"]);
    folder.fails("render s.obj --camera 0,0,0/0,0,0", 2, &["they must differ"]);
    folder.fails("render s.obj --camera -1,0/0,0,0", 2, &["2 numbers instead of 3"]);
    folder.fails("compare s.obj --repeat 0", 2, &["--repeat"]);
    folder.fails("trace s.obj --hits h.npy", 2, &["--rays"]);
    folder.fails("generate balls --size 99 -o b.obj", 2, &["balls:99", "from 0 to 6"]);
    folder.fails("generate cubes -o b.obj", 2, &["cubes", "hairball"]);
    folder.fails("generate balls --size 0 -o b.stl", 2, &["b.stl", ".obj or .ply"]);
    folder.fails("paint", 2, &["paint"]);
}

#[test]
fn places_that_cannot_be_written() {
    let folder = Folder::with("s.obj", SQUARES);
    folder.write("r.npy", rays_npy(&[[0.0; 8]]));
    for command in [
        "render s.obj --size 8x8 -o none/out.png",
        "compare s.obj --size 8x8 --repeat 1 --format svg -o none/out.svg",
        "trace s.obj --rays r.npy --hits none/out.npy",
        "trace s.obj --rays r.npy --hits none/out.npy --any",
        "generate balls --size 0 -o none/out.obj",
        "generate balls --size 0 -o none/out.ply",
    ] {
        folder.fails(command, 1, &["cannot create none/out.", "No such file"]);
    }
    // Known before the long work: of these the scene does not even exist.
    for command in [
        "render no.obj -o none/a.png",
        "render no.obj --integrator ao --cost none/a.png",
        "trace no.obj --rays r.npy --hits none/a.npy",
    ] {
        folder.fails(command, 1, &["cannot create none/a."]);
    }
}

/// A device that is always full stands for a full disk.
#[cfg(target_os = "linux")]
#[test]
fn full_disks() {
    let folder = Folder::with("s.obj", SQUARES);
    folder.write("r.npy", rays_npy(&[[0.0; 8]]));
    for (link, command) in [
        ("out.png", "render s.obj --size 8x8 -o out.png"),
        ("out.exr", "render s.obj --size 8x8 -o out.exr"),
        ("out.json", "compare s.obj --size 8x8 --repeat 1 -o out.json"),
        ("out.npy", "trace s.obj --rays r.npy --hits out.npy"),
        ("any.npy", "trace s.obj --rays r.npy --hits any.npy --any"),
        ("out.obj", "generate balls --size 0 -o out.obj"),
        ("out.mtl", "generate balls --size 0 -o out.obj"),
        ("out.ply", "generate balls --size 0 -o out.ply"),
    ] {
        let link = folder.path().join(link);
        std::os::unix::fs::symlink("/dev/full", &link).expect("linked");
        folder.fails(command, 1, &["cannot write", "No space left on device"]);
        std::fs::remove_file(link).expect("removed");
    }
    let full = std::fs::File::options().write(true).open("/dev/full").expect("a device");
    let (_, code, err) = crate::parts(&folder.command("info").stdout(full).output().expect("started"));
    assert_eq!(code, Some(1), "{err}");
    assert!(err.starts_with("error: cannot write standard output: No space left"), "{err}");
}
