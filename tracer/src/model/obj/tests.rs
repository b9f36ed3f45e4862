use super::*;
use crate::geometry::Aabb;
use crate::model::{Reflection, builtin};
use crate::progress::Silent;
use std::fs;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use tempfile::TempDir;

/// Reads an OBJ with other files beside it.
fn read_with(text: &[u8], others: &[(&str, &str)]) -> Result<(Model, Vec<String>), Error> {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, content) in others {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("created");
        fs::write(path, content).expect("written");
    }
    let path = folder.path().join("test.obj");
    fs::write(&path, text).expect("written");
    read(&path, &Silent)
}

fn mesh(text: &str) -> Mesh {
    let (scene, _) = read_with(text.as_bytes(), &[]).unwrap_or_else(|e| panic!("{text:?}: {e}"));
    scene.validate().expect("what is read is valid");
    scene.mesh
}

/// The error's line and message.
fn error(text: &[u8]) -> (Option<usize>, String) {
    match read_with(text, &[]) {
        Err(Error::Data { line, message, path }) => {
            assert!(path.ends_with("test.obj"));
            (line, message)
        }
        other => panic!("{:?}: {other:?}", String::from_utf8_lossy(text)),
    }
}

/// A tetrahedron's vertices, on lines 1 to 4: vertex `i` has x = `i`.
const FOUR: &str = "v 1 0 0\nv 2 1 0\nv 3 0 1\nv 4 1 1\n";

/// The x coordinates of each triangle, which are the file's vertex numbers.
fn xs(mesh: &Mesh) -> Vec<[u32; 3]> {
    (0..mesh.triangles.len()).map(|i| mesh.triangle(i).map(|p| p[0] as u32)).collect()
}

#[test]
fn faces_of_all_forms_become_fans_in_file_order() {
    let text = "vt 0 0\nvt 1 0\nvn 0 0 1\nf 1 2 3\nf 1/1 2/2 3/1\nf 1//1 3//1 4//1\nf 1/1/1 2/2/1 4/1/1\n\
                f -4 -3 -2\nf 1 2 3 4\nf 4/1/ 3// 2 +1\nf 1 2 3 4 3 2\n";
    let m = mesh(&format!("{FOUR}{text}"));
    let fans = [[1, 2, 3], [1, 2, 3], [1, 3, 4], [1, 2, 4], [1, 2, 3], [1, 2, 3], [1, 3, 4]];
    let more = [[4, 3, 2], [4, 2, 1], [1, 2, 3], [1, 3, 4], [1, 4, 3], [1, 3, 2]];
    assert_eq!(xs(&m), [&fans[..], &more].concat());
    assert_eq!(m.positions.len(), 4, "vertices are shared");
    assert_eq!(m.normals, [[0.0, 0.0, 1.0]]);
    let smooth: Vec<usize> = (0..13).filter(|&i| m.normal_indices[i] != Mesh::FLAT).collect();
    assert_eq!(smooth, [2, 3], "no normals are made up for faces without");
}

#[test]
fn ids_follow_the_file_through_groups_materials_points_and_lines() {
    let text = "usemtl a\no first\nf 1 2 3\np 1\np 1 2 3\ng x y\nf 2 3 4\nl 1 2\nl 1 2 3\nl 1/1 2/1 3/1 4/1\nusemtl b\n\
                f 3 4 1\ng first\nusemtl a\nf 4 1 2\no\nf 1 1 2\nusemtl b\nusemtl a\nf 2 2 2\nv 5 0 0\nf 1 2 -1\nusemtl b\n";
    let library = "newmtl b\nKd 0 0 1\nnewmtl a\nKd 1 0 0\n";
    let text = format!("mtllib m.mtl\n{FOUR}{text}");
    let (scene, warnings) = read_with(text.as_bytes(), &[("m.mtl", library)]).expect("sound");
    assert!(warnings.is_empty(), "{warnings:?}");
    let ids = [[1, 2, 3], [2, 3, 4], [3, 4, 1], [4, 1, 2], [1, 1, 2], [2, 2, 2], [1, 2, 5]];
    assert_eq!(xs(&scene.mesh), ids, "degenerate triangles keep their place");
    assert_eq!(scene.mesh.materials, [1, 1, 0, 1, 1, 1, 1]);
    assert_eq!(scene.name, "test");
    assert!(scene.mesh.normals.is_empty() && scene.mesh.normal_indices.is_empty());
    assert_eq!((scene.lights.len(), scene.camera), (0, None));
}

#[test]
fn line_ends_comments_continuations_and_a_byte_order_mark() {
    let expected = mesh(&format!("{FOUR}f 1 2 3 4\n"));
    for text in [
        format!("\u{feff}{FOUR}f 1 2 3 4"),
        format!("{FOUR}f 1 2 3 4\n").replace('\n', "\r\n"),
        format!("{FOUR}f 1 2 3 4\n").replace('\n', "\r"),
        format!("# a \\\n{FOUR}#f 1 2 3\n  \t f\t1  2 3 4 # the end \\\n\n"),
        format!("{FOUR}f 1 \\\n2 3\\\n 4\n"),
        format!("{FOUR}f 1 \\\r\n2 3 \\\r\n4\r\n"),
        "v 1 0 0 # one\nv 2 1 0 .5 .5 .5\nv 6 0 2 2 \nv 4e0 +1. 1 1 #x\nf 1 2 3 4\\".into(),
        format!("s off\nfoo bar\nvp 1 2\ncstype bezier\n{FOUR}vt nan\nf 1 2 3 4\n"),
    ] {
        assert_eq!(mesh(&text), expected, "{text:?}");
    }
    let latin = [b"# \xa9 1999, \xfcbung\n", FOUR.as_bytes(), b"f 1 2 3 4\n"].concat();
    assert_eq!(read_with(&latin, &[]).expect("a comment may be anything").0.mesh, expected);
}

#[test]
fn normals_are_unit_vectors_or_none() {
    let text = format!("{FOUR}vn 0 3 4\nvn 0 0 0\nvn 1e-30 0 0\nf 1//1 2//1 3//3\nf 1//1 2//2 3//1\nf 1//1 2 3//1\n");
    let m = mesh(&text);
    assert_eq!((m.normals[0], m.normals[1]), ([0.0, 0.6, 0.8], [1.0, 0.0, 0.0]));
    assert_eq!(m.normal_indices, [[0, 0, 1], Mesh::FLAT, Mesh::FLAT]);
    let m = mesh(&format!("{FOUR}vn 0 0 1\nf 1 2 3\n"));
    assert!(m.normals.is_empty() && m.normal_indices.is_empty(), "nobody uses them");
}

/// Each fault is refused in its line, counted with all that joins lines and ends them.
#[test]
fn faults_are_named_with_their_line() {
    for (text, line, reason) in [
        ("v 1 2 nan\n", 5, "coordinate nan is NaN"),
        ("\n\nv 1 -inf 0\n", 7, "-inf, it must be a finite"),
        ("v 1e39 0 0\n", 5, "1e39 is inf"),
        ("v 1 2\n", 5, "this one has 2"),
        ("v 1 2 # 3\n", 5, "this one has 2"),
        ("v\n", 5, "this one has 0"),
        ("v 1 2 3 4 5\n", 5, "this one has 5"),
        ("v 1 2 3 0\n", 5, "divides"),
        ("v 1 2 3 1e-40\n", 5, "divides"),
        ("v 1 2 x\n", 5, "\"x\" is not a number"),
        ("v 1,5 2 3\n", 5, "\"1,5\" is not a number"),
        ("v 1 2 3#4\n", 5, "\"3#4\" is not a number"),
        ("vn 0 NaN 1\n", 5, "normal's component NaN"),
        ("vn 0 1\n", 5, "this one has 2"),
        ("f 1 2 5\n", 5, "vertex 5, but there are 4 above it"),
        ("f 1 2 0\n", 5, "count from 1"),
        ("f 1 2 -5\n", 5, "vertex -5, but there are 4"),
        ("f 1 2 99999999999999999999\n", 5, "no corner of a face"),
        ("f 1 2 18446744073709551615\n", 5, "no corner of a face"),
        ("f 1 2 3.0\n", 5, "\"3.0\" is no corner"),
        ("f 1 2 3/\u{e9}\n", 5, "no corner"),
        ("f 1//1 2//1 3//1\n", 5, "normal 1, but there are 0"),
        ("vn 0 0 1\nf 1//1 2//-2 3//1\n", 6, "normal -2, but there are 1"),
        ("f 1/1 2/1 3/1\n", 5, "texture coordinate 1, but there are 0"),
        ("vt 0 0\nvn 0 0 1\nf 1/1/1/1 2 3\n", 7, "no corner"),
        ("f /1 2 3\n", 5, "no corner"),
        ("f 1 2\n", 5, "at least 3 vertices, this one has 2"),
        ("f\n", 5, "this one has 0"),
        ("f 1 2 # 3\n", 5, "this one has 2"),
        ("#\\\nf 1 2 3 \\\n4\nf 1 2\n", 8, "at least 3"),
        ("f 1 \\\n2 3 \\\n 9\nf 1 2 3\n", 5, "vertex 9"),
        ("f 1 2 3\nv 5 5 5\nf 6 1 2\n", 7, "vertex 6, but there are 5"),
    ] {
        for text in [format!("{FOUR}{text}"), format!("{FOUR}{text}").replace('\n', "\r\n")] {
            let (found, message) = error(text.as_bytes());
            assert_eq!(found, Some(line), "{text:?}: {message}");
            assert!(message.contains(reason), "{text:?}: {message:?} should contain {reason:?}");
        }
    }
}

#[test]
fn what_is_no_obj_is_refused() {
    for text in ["", "\n", FOUR, "hello\n", "{\"a\": 1}", "f\\", "\\"] {
        let (_, message) = error(text.as_bytes());
        assert!(message.contains("no faces") || message.contains("at least 3"), "{message}");
    }
    assert_eq!(error(FOUR.as_bytes()).1[..21], *"there are 4 vertices,");
    let png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x02\0\0\0\x02\0\x08\x02\0\0\0";
    let named = [FOUR.as_bytes(), b"usemtl gr\xfcn\nf 1 2 3\n"].concat();
    for (text, line) in [(&png[..], 1), (&named, 5), (b"v 1 2 3\n\xff\xfe\n", 2)] {
        let (found, message) = error(text);
        assert!(found == Some(line) && message.contains("not UTF-8"), "{found:?}: {message}");
    }
    assert!(matches!(read(Path::new("none.obj"), &Silent), Err(Error::Io { action: "open", .. })));
}

#[test]
fn materials_of_a_library() {
    let library = "# c\nKd 9 9 9\n\tnewmtl  red one \r\nKa .1 0.2 3e-1\nKd 1 0 0 # red\nKs .5\nNs 20\nd -halo .5\nillum x\n\
                   map_Kd\nTr\nnewmtl bare\nKd spectral a.rfl 1\nKe 1\n";
    let text = format!("mtllib sub\\a b.mtl\n{FOUR}f 1 2 3\nusemtl red one\nf 1 2 3\nusemtl bare\nf 1 2 3\n");
    let (scene, warnings) = read_with(text.as_bytes(), &[("sub/a b.mtl", library)]).expect("sound");
    let red = Material {
        ambient: [0.1, 0.2, 0.3],
        diffuse: [1.0, 0.0, 0.0],
        specular: [0.5; 3],
        shininess: 20.0,
        reflection: Reflection::Glossy,
        ..Material::grey("red one")
    };
    let bare = Material { emission: [1.0; 3], ..Material::grey("bare") };
    assert_eq!(scene.materials, [red, bare, Material::grey("default")]);
    assert_eq!(scene.mesh.materials, [2, 0, 1]);
    assert!(warnings.len() == 1 && warnings[0].contains("a b.mtl:10: the texture"), "{warnings:?}");
}

/// What `illum`, `Ke`, `Ni`, `Tf`, `d` and `Tr` mean, and which warnings there are.
#[test]
fn reflection_models_of_a_library() {
    use Reflection::{Dielectric, Glossy, Lambertian, Mirror};
    for (lines, reflection, warning) in [
        ("", Lambertian, ""),
        ("Ks 1 1 1", Glossy, ""),
        ("Ks 1 1 1\nillum 1", Lambertian, ""),
        ("Ks 0 0 0\nillum 2", Lambertian, ""),
        ("Ks .1 0 0\nillum 2\nd 1.0", Glossy, ""),
        ("illum 3", Mirror, ""),
        ("illum 5", Mirror, ""),
        ("illum 4\nd .5", Dielectric, ""),
        ("illum 7\nTr .5", Dielectric, ""),
        ("illum 10", Lambertian, "illum 10 of material \"a\" is not supported"),
        ("d 0.5", Lambertian, "material \"a\" is see-through"),
        ("Tr 0.5\nillum 3", Mirror, "material \"a\" is see-through"),
        ("Tr 0\nNi 0", Lambertian, ""),
    ] {
        let (text, library) = (format!("mtllib a.mtl\n{FOUR}usemtl a\nf 1 2 3\n"), format!("newmtl a\n{lines}\n"));
        let (scene, warnings) = read_with(text.as_bytes(), &[("a.mtl", &library)]).expect("sound");
        let [material] = &scene.materials[..] else { panic!("{lines}: {:?}", scene.materials) };
        assert_eq!(material.reflection, reflection, "{lines}");
        assert_eq!(warnings.len(), usize::from(!warning.is_empty()), "{lines}: {warnings:?}");
        assert!(warnings.iter().all(|w| w.contains(warning)), "{warnings:?}");
    }
    let text = format!("mtllib a.mtl\n{FOUR}usemtl a\nf 1 2 3\n");
    let library = "newmtl a\nKe 1 2.5 3\nTf .5\nNi 1.33\nillum 7\n";
    let (scene, _) = read_with(text.as_bytes(), &[("a.mtl", library)]).expect("sound");
    let Material { emission, transmission, ior, .. } = scene.materials[0];
    assert_eq!((emission, transmission, ior), ([1.0, 2.5, 3.0], [0.5; 3], 1.33));
    assert_eq!(written(&scene).1.materials, scene.materials);
}

#[test]
fn a_scene_is_named_after_its_file() {
    for (file, name) in [("a.obj", "a"), ("x/b.v2.OBJ.gz", "b.v2"), ("c.obj.zst", "c"), ("d.zst", "d")] {
        assert_eq!(crate::model::stem(Path::new(file)).as_deref(), Some(name));
    }
}

#[test]
fn several_libraries() {
    let files = [("a.mtl", "newmtl x\nKd 0 0 0\nnewmtl y\n"), ("b.mtl", "newmtl x\nKd .25 .25 .25\n")];
    for statement in ["mtllib a.mtl b.mtl\n", "mtllib a.mtl\nmtllib   b.mtl\n", "mtllib\ta.mtl\tb.mtl\n"] {
        let text = format!("{statement}{FOUR}usemtl\tx\nf 1 2 3\n");
        let (scene, warnings) = read_with(text.as_bytes(), &files).expect("sound");
        assert!(warnings.is_empty(), "{warnings:?}");
        let used = &scene.materials[scene.mesh.material(0) as usize];
        assert_eq!((scene.materials.len(), used.diffuse), (3, [0.25; 3]), "the last one counts");
    }
}

#[test]
fn missing_materials_are_warnings() {
    let faces = format!("{FOUR}usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n");
    let no_file = format!("mtllib none.mtl\n{faces}");
    let not_in_it = format!("mtllib a.mtl\n{faces}");
    for (text, expected) in [
        (&faces, "names no library (mtllib)"),
        (&no_file, "test.obj:1: the material library"),
        (&not_in_it, "test.obj:8: no library has the material \"b\""),
    ] {
        let (scene, warnings) = read_with(text.as_bytes(), &[("a.mtl", "newmtl a\nKd .7 .7 .7\n")]).expect("sound");
        assert!(warnings.len() == 1 && warnings[0].contains(expected), "{warnings:?}");
        assert_eq!(scene.materials, [Material::grey("a"), Material::grey("b")]);
        assert_eq!(scene.mesh.materials, [0, 1]);
    }
    let (scene, warnings) = read_with(format!("{FOUR}f 1 2 3\n").as_bytes(), &[]).expect("sound");
    assert_eq!((scene.materials, warnings.len()), (vec![Material::grey("default")], 0));
    assert!(scene.mesh.materials.is_empty());
}

#[test]
fn faults_of_a_library() {
    for (library, line, reason) in [
        ("newmtl a\nKd 1 x 0\n", 2, "\"x\" is not a finite number"),
        ("newmtl a\nKd 1 nan 0\n", 2, "\"nan\" is not a finite number"),
        ("newmtl a\n\nKs 1 2\n", 3, "Ks needs 3 numbers"),
        ("newmtl a\nKa\n", 2, "Ka needs 3 numbers"),
        ("newmtl a\nNs -1\n", 2, "not negative"),
        ("newmtl a\nNs\n", 2, "Ns needs a number"),
        ("newmtl a\nKe 1 2\n", 2, "Ke needs 3 numbers"),
        ("newmtl a\nNi -1\n", 2, "Ni needs a number"),
        ("newmtl\n", 1, "needs a name"),
    ] {
        let e =
            read_with(format!("mtllib a.mtl\n{FOUR}f 1 2 3\n").as_bytes(), &[("a.mtl", library)]).expect_err(library);
        let message = e.to_string();
        assert!(message.contains(&format!("a.mtl:{line}: ")) && message.contains(reason), "{message}");
    }
}

fn written(scene: &Model) -> (TempDir, Model) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.obj");
    write(scene, &path, &Silent).expect("written");
    let (back, warnings) = read(&path, &Silent).expect("read back");
    assert!(warnings.is_empty(), "{warnings:?}");
    (folder, back)
}

#[test]
fn written_scenes_come_back_the_same() {
    for spec in ["balls:1", "rings:1", "tree:3"] {
        let scene = builtin(spec).expect("a name").expect("a size");
        let (folder, back) = written(&scene);
        assert!(back.mesh == scene.mesh && back.materials == scene.materials, "{spec}");
        assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 2, "nothing but the .obj and the .mtl");
    }
    // Its vertices are not in order of first use: they come back renumbered.
    let scene = builtin("hairball:3").expect("a name").expect("a size");
    let (_folder, back) = written(&scene);
    assert_eq!(back.mesh.positions.len(), scene.mesh.positions.len());
    for i in 0..scene.mesh.triangles.len() {
        assert_eq!(back.mesh.triangle(i), scene.mesh.triangle(i));
        let normals = |m: &Mesh| m.normal_indices[i].map(|n| m.normals[n as usize]);
        assert_eq!(normals(&back.mesh), normals(&scene.mesh));
    }
}

/// Numbers of every size, materials in any order, names that a file cannot hold.
#[test]
fn difficult_scenes_come_back_too() {
    let grey = |name: &str, shade: f32| Material { diffuse: [shade; 3], ..Material::grey(name) };
    let scene = Model {
        name: "scene".into(),
        mesh: Mesh {
            positions: vec![[f32::MAX, f32::MIN_POSITIVE, 1e-45], [-0.0, 0.1, 1.0 / 3.0], [16_777_217.0, -1e-7, 1e20]],
            triangles: vec![[0, 1, 2], [0, 0, 0], [2, 1, 0], [1, 2, 0]],
            normals: vec![[0.0, 0.6, 0.8], [1.0, 0.0, 0.0]],
            normal_indices: vec![Mesh::FLAT, [0, 0, 1], Mesh::FLAT, [1, 0, 0]],
            materials: vec![3, 0, 3, 1],
            ..Mesh::default()
        },
        materials: vec![grey("a", 0.1), grey("a", 0.2), grey(" a\nb\\", 0.3), grey("", 0.4)],
        lights: vec![],
        camera: None,
        ambient: 1.0,
        background: [0.0; 3],
    };
    let (_folder, back) = written(&scene);
    let bits = |m: &Mesh| m.positions.as_flattened().iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&back.mesh), bits(&scene.mesh));
    assert_eq!(back.mesh, scene.mesh);
    assert_eq!(back.materials.iter().map(|m| &m.name[..]).collect::<Vec<_>>(), ["a", "a_1", "a_b_", "material"]);
    assert!(back.materials.iter().zip(&scene.materials).all(|(a, b)| a.diffuse == b.diffuse));
}

#[test]
fn a_failed_write_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("scene.obj");
    let mut scene = builtin("balls:1").expect("a name").expect("a size");
    assert!(matches!(write(&scene, &path, &AtomicBool::new(true)), Err(Error::Cancelled)));
    scene.mesh.positions[0][0] = f32::NAN;
    assert!(matches!(write(&scene, &path, &Silent), Err(Error::Geometry(_))));
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 0);
}

/// Says stop at the n-th question.
struct StopAt(AtomicUsize);

impl Progress for StopAt {
    fn cancelled(&self) -> bool {
        self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1)).is_err()
    }
}

/// Whenever reading is told to stop, it does, and says so.
#[test]
fn reading_can_be_cancelled_at_any_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.obj");
    let vertices = "v 0.123456789 0.5 0.25\n".repeat(200_000);
    fs::write(&path, format!("{vertices}f 1 2 3\n")).expect("written");
    let questions = (0..).take_while(|&n| match read(&path, &StopAt(AtomicUsize::new(n))) {
        Err(Error::Cancelled) => true,
        Err(e) => panic!("{e}"),
        Ok((scene, _)) => {
            assert_eq!(scene.mesh.bounds(), Aabb { min: [0.123_456_79, 0.5, 0.25], max: [0.123_456_79, 0.5, 0.25] });
            false
        }
    });
    assert!(questions.count() > 10, "several stages ask more than once");
}

/// Texture coordinates are there where something has a texture, and only then are they looked at.
#[cfg(feature = "textures")]
#[test]
fn textures() {
    let folder = tempfile::tempdir().expect("a folder");
    let image = image::RgbImage::from_pixel(2, 1, image::Rgb([255, 0, 9]));
    fs::create_dir(folder.path().join("maps")).expect("created");
    image.save(folder.path().join("maps/a b.png")).expect("written");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("written");
    let library = "map_Kd maps/a b.png\nnewmtl none\nKd 1 0 0\nmap_Kd maps/none.png\nnewmtl a\nKd 0 0 0\nmap_Kd -s 1 1 maps\\a b.png\n\
                   newmtl b\nKd .5 .5 .5\nmap_Kd maps/a b.png\nnewmtl text\nmap_Kd a.mtl\n";
    write("a.mtl", library);
    let obj = format!(
        "mtllib a.mtl\n{FOUR}vt 0 .5 9\nvt 1 0 # one\nvt 2 -1\nusemtl a\nf 1/2 2/3 3/1 4/3\nf 1 2 3\nf 1/1 2/2 3\n"
    );
    write("a.obj", &obj);
    let (scene, warnings) = read(&folder.path().join("a.obj"), &Silent).expect("sound");
    scene.validate().expect("sound");
    assert_eq!(scene.mesh.uvs, [[1.0, 0.0], [2.0, -1.0], [0.0, 0.5]], "in order of first use");
    assert_eq!(scene.mesh.uv_indices, [[0, 1, 2], [0, 2, 1], Mesh::FLAT, Mesh::FLAT]);
    let [none, a, b, text] = &scene.materials[..] else { panic!("{:?}", scene.materials) };
    assert!(none.texture.is_none() && text.texture.is_none() && none.diffuse == [1.0, 0.0, 0.0]);
    assert_eq!((a.diffuse, b.diffuse), ([1.0; 3], [0.5; 3]), "where Kd is black the image stands for it");
    assert_eq!(a.texture.as_ref().map(|t| (t.name(), t.size())), Some(("maps\\a b.png", (2, 1))));
    assert!(std::sync::Arc::ptr_eq(a.texture.as_ref().expect("read"), b.texture.as_ref().expect("read")), "read once");
    let [missing, options, no_image] = &warnings[..] else { panic!("{warnings:?}") };
    assert!(
        missing.contains("a.mtl:4: the texture ")
            && missing.contains("none.png cannot be read (there is no such file): the colour Kd")
    );
    assert!(options.contains("a.mtl:7: options of map_Kd"), "{options}");
    assert!(no_image.contains("a.mtl:12: ") && no_image.contains("only PNG and JPEG"), "{no_image}");

    write("a.obj", &obj.replace("usemtl a\n", "mtllib a.mtl\nusemtl a\nmtllib none.mtl\nmtllib none.mtl\n"));
    let (again, warnings) = read(&folder.path().join("a.obj"), &Silent).expect("sound");
    assert_eq!((again.materials.len(), again.textures().len(), warnings.len()), (4, 1, 4), "each library once");

    let nan = obj.replace("vt 1 0", "vt 1 nan");
    write("a.obj", &nan);
    let error = read(&folder.path().join("a.obj"), &Silent).expect_err("no number").to_string();
    assert!(error.contains("a.obj:7: a texture coordinate has two finite numbers"), "{error}");
    write("a.obj", &nan.replace("mtllib", "#"));
    let (plain, _) = read(&folder.path().join("a.obj"), &Silent).expect("nobody wants them");
    assert!(plain.mesh.uvs.is_empty() && plain.mesh.uv_indices.is_empty());
}
