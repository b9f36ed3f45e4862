//! `tracer trace`: rays from NumPy, hits to NumPy.

use crate::{Folder, SQUARES, levels};
use tracer::model::Model;
use tracer::progress::Silent;

const INF: f32 = f32::INFINITY;

/// An `.npy` file as NumPy writes it.
pub fn npy(dtype: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let mut header = format!("{{'descr': {dtype}, 'fortran_order': {order}, 'shape': {shape}, }}");
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..], header.as_bytes(), data].concat()
}

pub fn rays_npy(rays: &[[f32; 8]]) -> Vec<u8> {
    let data: Vec<u8> = rays.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    npy("'<f4'", false, &format!("({}, 8)", rays.len()), &data)
}

/// The header and the data.
fn split(file: &[u8]) -> (&str, &[u8]) {
    assert!(file.starts_with(b"\x93NUMPY\x01\x00"));
    let end = 10 + usize::from(u16::from_le_bytes([file[8], file[9]]));
    assert_eq!(end % 64, 0);
    (std::str::from_utf8(&file[10..end]).expect("text"), &file[end..])
}

/// t, u, v, primitive.
type Row = (f32, f32, f32, u32);

/// t, u, v, primitive of each ray.
fn hits(file: &[u8]) -> Vec<Row> {
    let (header, data) = split(file);
    let dtype = "[('t', '<f4'), ('u', '<f4'), ('v', '<f4'), ('primitive', '<u4')]";
    let start = format!("{{'descr': {dtype}, 'fortran_order': False, 'shape': ({},), }}", data.len() / 16);
    assert_eq!(header.trim_end(), start);
    let word = |row: &[u8; 16], i: usize| u32::from_le_bytes(row.as_chunks().0[i]);
    let number = |row, i| f32::from_bits(word(row, i));
    data.as_chunks().0.iter().map(|row| (number(row, 0), number(row, 1), number(row, 2), word(row, 3))).collect()
}

fn bools(file: &[u8]) -> Vec<bool> {
    let (header, data) = split(file);
    let start = format!("{{'descr': '|b1', 'fortran_order': False, 'shape': ({},), }}", data.len());
    assert_eq!(header.trim_end(), start);
    data.iter().map(|&b| [false, true][usize::from(b)]).collect()
}

const MISS: Row = (INF, 0.0, 0.0, u32::MAX);

/// Rays on the two squares, and what they hit by hand.
fn by_hand() -> (Vec<[f32; 8]>, Vec<Row>) {
    let down = |x, y| [x, y, 2.0, 0.0, 0.0, 0.0, -1.0, INF];
    vec![
        (down(0.75, 0.25), (2.0, 0.5, 0.25, 0)),
        (down(0.25, 0.75), (2.0, 0.25, 0.5, 1)),
        // The diagonal belongs to both: the lower id counts.
        (down(0.5, 0.5), (2.0, 0.0, 0.5, 0)),
        // Past the small square, on the large one.
        (down(-0.25, 1.25), (3.0, 0.25, 0.5, 3)),
        (down(5.0, 5.0), MISS),
        // A direction twice as long: half the t.
        ([0.75, 0.25, 2.0, 0.0, 0.0, 0.0, -2.0, INF], (1.0, 0.5, 0.25, 0)),
        // Starts behind the small square; ends before it; starts and ends exactly on it.
        ([0.75, 0.25, 2.0, 2.5, 0.0, 0.0, -1.0, INF], (3.0, 1.0 / 6.0, 0.416_666_66, 2)),
        ([0.75, 0.25, 2.0, 0.0, 0.0, 0.0, -1.0, 1.5], MISS),
        ([0.75, 0.25, 2.0, 2.0, 0.0, 0.0, -1.0, 2.0], (2.0, 0.5, 0.25, 0)),
        // From below.
        ([0.75, 0.25, -0.5, 0.0, 0.0, 0.0, 1.0, INF], (0.5, 0.5, 0.25, 0)),
    ]
    .into_iter()
    .unzip()
}

#[test]
fn hits_computed_by_hand() {
    let folder = Folder::with("squares.obj", SQUARES);
    let (rays, expected) = by_hand();
    folder.write("rays.npy", rays_npy(&rays));
    let report = folder.json("trace squares.obj --rays rays.npy --hits hits.npy --threads 1 --repeat 3 --json");
    for (i, (hit, expected)) in hits(&folder.read("hits.npy")).into_iter().zip(&expected).enumerate() {
        let near = |a: f32, b: f32| a == b || (a - b).abs() < 1e-6;
        let same = (hit.0, hit.3) == (expected.0, expected.3) && near(hit.1, expected.1) && near(hit.2, expected.2);
        assert!(same, "ray {i}: {hit:?} instead of {expected:?}");
    }
    assert_eq!((&report["rays"], &report["hits"], &report["threads"]), (&10.into(), &8.into(), &1.into()));
    assert_eq!((&report["method"], &report["scene"]), (&"auto".into(), &"squares".into()));
    assert_eq!(report["level"], simd::Level::best().to_string());
    for key in ["build_ms", "trace_ms", "wall_ms", "mrays_per_s"] {
        assert!(report[key].as_f64().is_some_and(|n| n >= 0.0), "{key}: {}", report[key]);
    }
    folder.run("trace squares.obj --rays rays.npy --hits any.npy --any");
    let expected: Vec<bool> = expected.iter().map(|h| h.3 != u32::MAX).collect();
    assert_eq!(bools(&folder.read("any.npy")), expected);
}

#[test]
fn the_same_bytes_whatever_traces() {
    let folder = Folder::new();
    // Every fifth ray has a number that is none, or is unusual.
    let specials = [f32::NAN, INF, -INF, 0.0, -0.0, 1e-40, -1.0, f32::MAX];
    let rays: Vec<[f32; 8]> = (0..999)
        .map(|i| {
            let angle = |k: f32| (i as f32 * k).sin();
            let mut ray = [3.0 * angle(1.1), 3.0 * angle(0.7), 2.0 + angle(0.3), 0.0, 0.0, 0.0, 0.0, INF];
            (0..3).for_each(|k| ray[4 + k] = 0.5 * angle(0.9 + k as f32) - ray[k]);
            if i % 5 == 0 {
                ray[i / 5 % 8] = specials[i / 40 % 8];
            }
            ray
        })
        .collect();
    folder.write("rays.npy", rays_npy(&rays));
    folder.run("trace balls:1 --rays rays.npy --hits first.npy --level scalar --width 1 --threads 1");
    let first = folder.read("first.npy");
    let number = hits(&first).iter().filter(|h| h.3 != u32::MAX).count();
    assert!((300..999).contains(&number), "{number} hits");
    let mut ways: Vec<String> =
        levels().iter().flat_map(|l| ["4", "8", "16"].map(|w| format!("--level {l} --width {w}"))).collect();
    ways.extend(
        [
            "--threads 3",
            "--build insertion --seed 9",
            "--build fast",
            "--build high",
            "--slab conservative",
            "--repeat 2",
            "--method divide-conquer",
            "--method divide-conquer --threads 2 --reorder hash",
            "--method breadth-first --reorder origin",
            "--method auto --reorder direction",
        ]
        .map(String::from),
    );
    for way in ways {
        let out = folder.run(&format!("trace balls:1 --rays rays.npy --hits hits.npy {way}"));
        let made =
            if way.contains("divide-conquer") { "; no tree, triangles taken apart in " } else { " tree built in " };
        assert!(out.contains(made), "{way}: {out}");
        assert!(folder.read("hits.npy") == first, "{way}");
    }
}

/// Against a loop over all triangles in double precision.
#[test]
fn hits_of_a_brute_force_loop() {
    let folder = Folder::new();
    let rays: Vec<[f32; 8]> = (0..400)
        .map(|i| {
            let at = |k: f32| (i as f32 * k).cos();
            let (org, to) =
                ([4.0 * at(1.3), 4.0 * at(0.37), 3.0 + at(0.11)], [0.6 * at(2.1), 0.6 * at(1.7), 0.6 * at(0.9)]);
            [org[0], org[1], org[2], 0.0, to[0] - org[0], to[1] - org[1], to[2] - org[2], INF]
        })
        .collect();
    folder.write("rays.npy", rays_npy(&rays));
    folder.run("trace balls:1 --rays rays.npy --hits hits.npy");
    let (scene, _) = Model::open("balls:1", &Silent).expect("a scene");
    let triangles: Vec<[[f64; 3]; 3]> =
        (0..scene.mesh.triangles.len()).map(|i| scene.mesh.triangle(i).map(|p| p.map(f64::from))).collect();
    let mut number = 0;
    for (i, (ray, hit)) in rays.iter().zip(hits(&folder.read("hits.npy"))).enumerate() {
        let near = triangles.iter().map(|t| distance(&ray.map(f64::from), t)).fold(f64::INFINITY, f64::min);
        let same = near.is_infinite() && hit.0.is_infinite() || (near - f64::from(hit.0)).abs() < 1e-5;
        assert!(same, "ray {i} {ray:?}: {hit:?}, expected t = {near}");
        if hit.3 != u32::MAX {
            number += 1;
            let own = distance(&ray.map(f64::from), &triangles[hit.3 as usize]);
            assert!((own - f64::from(hit.0)).abs() < 1e-5, "ray {i}: triangle {} is at {own}", hit.3);
        }
    }
    assert!(number > 200, "{number} hits");
}

/// Where a ray meets a triangle; infinite when it does not.
fn distance(ray: &[f64; 8], [a, b, c]: &[[f64; 3]; 3]) -> f64 {
    let sub = |p: &[f64; 3], q: &[f64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
    let dot = |p: [f64; 3], q: [f64; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
    let cross =
        |p: [f64; 3], q: [f64; 3]| [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]];
    let (org, dir) = ([ray[0], ray[1], ray[2]], [ray[4], ray[5], ray[6]]);
    let (e1, e2, s) = (sub(b, a), sub(c, a), sub(&org, a));
    let p = cross(dir, e2);
    let q = cross(s, e1);
    let det = dot(e1, p);
    let [u, v, t] = [dot(s, p), dot(dir, q), dot(e2, q)].map(|x| x / det);
    if u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t >= 0.0 { t } else { f64::INFINITY }
}

#[test]
fn no_rays_are_rays_too() {
    let folder = Folder::with("rays.npy", rays_npy(&[]));
    let report = folder.json("trace balls:0 --rays rays.npy --hits hits.npy --json");
    assert_eq!((&report["rays"], &report["hits"]), (&0.into(), &0.into()));
    assert!(hits(&folder.read("hits.npy")).is_empty());
    folder.run("trace balls:0 --rays rays.npy --hits hits.npy --any");
    assert!(bools(&folder.read("hits.npy")).is_empty());
}

/// They are counted, and never hit.
#[test]
fn degenerate_triangles_keep_their_numbers() {
    let folder = Folder::with("d.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2\nf 1 1 1\nf 1 2 3\n");
    folder.write(
        "rays.npy",
        rays_npy(&[[0.25, 0.25, 1.0, 0.0, 0.0, 0.0, -1.0, INF], [0.5, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0, INF]]),
    );
    folder.run("trace d.obj --rays rays.npy --hits hits.npy");
    assert_eq!(hits(&folder.read("hits.npy")), [(1.0, 0.25, 0.25, 2), (1.0, 0.5, 0.0, 2)]);
    let info = folder.json("info d.obj --json");
    assert_eq!((&info["scene"]["triangles"], &info["scene"]["degenerate"]), (&3.into(), &2.into()));
    // When nothing else is there, nothing is hit.
    folder.write("d.obj", "v 0 0 0\nv 1 0 0\nf 1 2 2\n");
    folder.run("trace d.obj --rays rays.npy --hits hits.npy");
    assert_eq!(hits(&folder.read("hits.npy")), [MISS, MISS]);
    folder.run("render d.obj --size 9x9");
}
