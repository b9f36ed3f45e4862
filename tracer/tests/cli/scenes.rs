//! Scenes from files, by all commands that take one.

use crate::Folder;
use crate::batches::rays_npy;

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
    assert_eq!(folder.json("info s.ply --json")["triangles"], folder.json("info s.obj --json")["triangles"]);
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
