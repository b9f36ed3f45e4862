use super::*;
use crate::progress::Silent;
use std::sync::atomic::AtomicBool;

fn parsed(bytes: &[u8]) -> Result<(Mesh, Vec<String>), Error> {
    let result = parse(bytes, Path::new("a.ply"), &Silent);
    if let Ok((mesh, _)) = &result {
        mesh.validate().expect("what is read is valid");
    }
    result
}

const TEXT: &str = "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 5\nproperty float x\nproperty double y\nproperty int z\n\
                    property uchar red\nelement face 2\nproperty list uchar int vertex_indices\nproperty list short float weights\n\
                    end_header\n0 0 0 255\n1 0.1 0 1\n1 1 0 2\n-1e-1 1 0 3\n\n7 7 -7 4\n4 0 1 2 3 0\n3 2 3 4 2 0.5 nan\n";

fn expected() -> Mesh {
    Mesh {
        positions: vec![[0.0; 3], [1.0, 0.1, 0.0], [1.0, 1.0, 0.0], [-0.1, 1.0, 0.0], [7.0, 7.0, -7.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3], [2, 3, 4]],
        ..Mesh::default()
    }
}

/// [`TEXT`] in binary.
fn binary(big: bool) -> Vec<u8> {
    let name = if big { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = TEXT.split_inclusive("end_header\n").next().expect("a header").replace("ascii", name).into_bytes();
    let mut put = |mut little: Vec<u8>| {
        if big {
            little.reverse();
        }
        bytes.extend(little);
    };
    for (i, [x, y, z]) in
        [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [1.0, 1.0, 0.0], [-0.1, 1.0, 0.0], [7.0, 7.0, -7.0]].into_iter().enumerate()
    {
        put((x as f32).to_le_bytes().to_vec());
        put(f64::to_le_bytes(y).to_vec());
        put((z as i32).to_le_bytes().to_vec());
        put(vec![i as u8]);
    }
    for (face, weights) in [(&[0, 1, 2, 3][..], &[][..]), (&[2, 3, 4], &[0.5, f32::NAN])] {
        put(vec![face.len() as u8]);
        face.iter().for_each(|v: &i32| put(v.to_le_bytes().to_vec()));
        put((weights.len() as i16).to_le_bytes().to_vec());
        weights.iter().for_each(|w: &f32| put(w.to_le_bytes().to_vec()));
    }
    bytes
}

#[test]
fn all_formats_and_line_ends() {
    let files =
        [TEXT.into(), TEXT.replace('\n', "\r\n").into(), TEXT.replace('\n', "\r").into(), binary(false), binary(true)];
    for file in files {
        let (mesh, warnings) = parsed(&file).expect("sound");
        assert_eq!((mesh, warnings.len()), (expected(), 0));
    }
}

#[test]
fn normals_and_other_elements() {
    let text = "ply\nformat ascii 1.0\nelement camera 2\nproperty list int double at\nelement face 2\nproperty uchar flags\n\
                property list uint uint vertex_index\nelement vertex 4\nproperty double nz\nproperty float nx\nproperty float ny\n\
                property float z\nproperty float y\nproperty float x\nend_header\n0\n2 nan 1\n9 3 0 1 2\n9 3 1 2 3\n\
                2 0 0 3 2 1\n1 0 0 6 5 4\n0.6 0.8 0 9 8 7\n0 0 0 1 1 1\n";
    let (mesh, warnings) = parsed(text.as_bytes()).expect("sound");
    assert_eq!(mesh.positions[..2], [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]);
    assert_eq!(mesh.normals[..3], [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.8, 0.0, 0.6]]);
    assert_eq!(mesh.normal_indices, [[0, 1, 2], Mesh::FLAT], "a normal without direction");
    assert_eq!(warnings, ["a.ply: 2 elements \"camera\" are passed over"]);
}

#[test]
fn reads_what_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("some.thing.ply");
    write(&expected(), &path, &Silent).expect("written");
    let (model, warnings) = read(&path, &Silent).expect("read");
    assert_eq!((model.mesh, model.name.as_str(), warnings.len()), (expected(), "some.thing", 0));
    assert!(matches!(read(&path, &AtomicBool::new(true)), Err(Error::Cancelled)));
}

/// Each fault is named with its line, or byte.
#[test]
fn faults() {
    let change = |from: &str, to: &str| {
        assert!(TEXT.contains(from), "{from}");
        TEXT.replacen(from, to, 1)
    };
    let no_faces = TEXT.split("4 0 1").next().expect("the vertices").replace("face 2", "face 0");
    for (text, reason) in [
        (String::new(), "a.ply: no PLY file"),
        ("v 1 2 3\n".into(), "no PLY file"),
        (change("end_header", "comment"), "is no line of a PLY header"),
        ("ply\nformat ascii 1.0\n".into(), "no end_header"),
        (change("format ascii 1.0\n", ""), "no line \"format\""),
        (change("ascii", "utf8"), "a.ply:2: unknown format \"utf8\""),
        (change("1.0", "2.0"), "a.ply:2: \"format ascii 2.0\" is no line of a PLY header"),
        (change("element vertex 5", ""), "a.ply:5: a property before the first element"),
        (change("vertex 5", "vertex -5"), "a.ply:4: \"-5\" is not a number of elements"),
        (change("vertex 5", "point 5"), "no element vertex"),
        (change("vertex 5", "vertex 4294967296"), "4294967296 vertices"),
        (change("vertex 5", "vertex 4000000000"), "a.ply:19: vertex 5 goes on with \"3 0\""),
        (change("element face", "element nothing 18446744073709551615\nelement face"), "\"nothing\" no properties"),
        (change("element face", "element vertex 1\nproperty int x\nelement face"), "several elements \"vertex\""),
        (change("property int z", "property int24 z"), "a.ply:7: unknown type \"int24\""),
        (change("property int z", "property z"), "a.ply:7: a property has a type and a name"),
        (change("property int z", "property int w"), "no x, y and z"),
        (change("vertex_indices", "corners"), "no list vertex_indices"),
        (change("uchar int vertex", "uchar float vertex"), "a.ply:10: the items of list"),
        (change("uchar int vertex", "float int vertex"), "a.ply:10: the length of list"),
        (change("1 0.1 0 1", "1 nan 0 1"), "a.ply:14: y of vertex 1 is NaN"),
        (change("1 0.1 0 1", "1 1e39 0 1"), "a.ply:14: y of vertex 1 is inf"),
        (change("1 0.1 0 1", "1 a 0 1"), "a.ply:14: \"a\" is not a number"),
        (change("1 0.1 0 1", "1 0 0.5 1"), "a.ply:14: \"0.5\" is not a whole number"),
        (change("1 0.1 0 1", "1 0.1"), "a.ply:14: vertex 1 has fewer numbers"),
        (change("1 0.1 0 1", "1 0.1 0 1 9"), "a.ply:14: vertex 1 goes on with \"9\""),
        (change("4 0 1 2 3 0", "4 0 1 2 5 0"), "a.ply:19: face 0 uses vertex 5, but there are 5"),
        (change("4 0 1 2 3 0", "4 0 1 2 -1 0"), "a.ply:19: face 0 uses vertex -1"),
        (change("4 0 1 2 3 0", "2 0 1 0"), "a.ply:19: face 0 has 2 vertices"),
        (change("4 0 1 2 3 0", "-1 0"), "a.ply:19: face 0 has a list of -1 items"),
        (change("2 0.5 nan", "2000000000 0.5 nan"), "a.ply:20: face 1 has fewer numbers"),
        (no_faces, "no faces: clouds of points"),
    ] {
        let error = parsed(text.as_bytes()).expect_err(reason).to_string();
        assert!(error.contains(reason), "{error:?} lacks {reason:?}");
    }
    let mut damaged = binary(true);
    let last = damaged.len() - 14 - 1;
    damaged[last] = 9;
    let error = parsed(&damaged).expect_err("no vertex 9").to_string();
    assert!(error.contains(&format!("byte {}: face 1 uses vertex", last + 1)), "{error}");
}

/// Cut anywhere it is an error, never a panic, and damage is one or is not.
#[test]
fn cut_and_damaged() {
    for file in [TEXT.as_bytes().to_vec(), binary(false), binary(true)] {
        for end in 0..file.len() - 20 {
            parsed(&file[..end]).expect_err("cut short");
        }
        for at in 0..file.len() {
            for bits in [0x01, 0x80, 0xff] {
                let mut damaged = file.clone();
                damaged[at] ^= bits;
                _ = parsed(&damaged);
            }
        }
    }
}
