//! Built scenes as files.
//!
//! Behind the header of [`crate::sealed`], in words of four bytes: the numbers of meshes, nodes and groups, the first triangle of each
//! mesh, the mask of each mesh, the box around all, the nodes (48 planes, 8 children) and the groups (36 coordinates, 4 ids).

use super::Scene;
use crate::Error;
use crate::bvh::{WideBvh, WideNode};
use crate::geometry::{Aabb, TriangleGroup};
use crate::sealed::{Kind, Words};
use simd::Level;
use std::path::Path;

const KIND: Kind = Kind {
    magic: b"TRACER\r\n",
    version: 2,
    name: "a saved scene",
    remedy: "build the scene from its mesh and save it",
};

impl Scene {
    /// Writes the scene as it is, tree and triangles, to be loaded without building. The file appears whole or not at all.
    ///
    /// # Errors
    /// [`Error::Io`] when it cannot be written; [`Error::Usage`] for a scene that is [watertight](super::SceneBuilder::watertight).
    pub fn save(&self, path: &Path) -> Result<(), Error> {
        if self.vertices.is_some() {
            return Err(Error::Usage(
                "a watertight scene cannot be saved: save its mesh, and build the scene of that".into(),
            ));
        }
        let mut body = Vec::with_capacity(64 + self.bvh.bytes());
        let mut word = |x: u32| body.extend(x.to_le_bytes());
        let WideBvh { nodes, groups, .. } = &self.bvh;
        [self.first.len(), nodes.len(), groups.len()].iter().for_each(|&n| word(n as u32));
        self.first.iter().chain(&self.masks).for_each(|&x| word(x));
        self.bounds.min.iter().chain(&self.bounds.max).for_each(|x| word(x.to_bits()));
        for node in nodes {
            node.planes.as_flattened().iter().for_each(|x| word(x.to_bits()));
            node.children.iter().for_each(|child| word(child.bits()));
        }
        for group in groups {
            for v in [&group.v0, &group.e1, &group.e2] {
                v.as_flattened().iter().for_each(|x| word(x.to_bits()));
            }
            group.id.iter().for_each(|&id| word(id));
        }
        KIND.write(path, &body)
    }

    /// Reads what [`Scene::save`] wrote, on any machine, to be traced at a level.
    ///
    /// # Errors
    /// [`Error::Io`] when the file cannot be read, [`Error::Data`] when it is of another kind or version, or damaged: no such file makes
    /// a query fail.
    pub fn load(path: &Path, level: Level) -> Result<Self, Error> {
        let bytes =
            std::fs::read(path).map_err(|source| Error::Io { action: "read", path: path.to_owned(), source })?;
        parse(&bytes, level).map_err(|message| Error::Data { path: path.to_owned(), line: None, message })
    }
}

fn parse(bytes: &[u8], level: Level) -> Result<Scene, String> {
    let damaged = |what: &str| KIND.damaged(what);
    let mut words = KIND.open(bytes)?;
    let length = words.len();
    let [meshes, nodes, groups] = [words.word()?, words.word()?, words.word()?].map(|n| n as usize);
    // What the numbers claim is there, before memory is asked for.
    if length as u128 != 4 * (9 + 2 * meshes as u128 + 56 * nodes as u128 + 40 * groups as u128) {
        return Err(damaged("its numbers contradict its length"));
    }
    let first = (0..meshes).map(|_| words.word()).collect::<Result<Vec<_>, _>>()?;
    if !first.is_sorted() || first.first().is_some_and(|&first| first != 0) {
        return Err(damaged("its meshes overlap"));
    }
    let masks = (0..meshes).map(|_| words.word()).collect::<Result<Vec<_>, _>>()?;
    let bounds = Aabb { min: words.floats()?, max: words.floats()? };
    let node = |words: &mut Words| {
        let mut node = WideNode::EMPTY;
        for planes in &mut node.planes {
            *planes = words.floats()?;
        }
        for child in &mut node.children {
            *child = crate::bvh::Child::from_bits(words.word()?);
        }
        Ok::<_, String>(node)
    };
    let group = |words: &mut Words| {
        let mut group = TriangleGroup::new(&[]);
        for v in [&mut group.v0, &mut group.e1, &mut group.e2] {
            for axis in v {
                *axis = words.floats()?;
            }
        }
        for id in &mut group.id {
            *id = words.word()?;
        }
        Ok::<_, String>(group)
    };
    // As a built tree's: queries miss the TLB less often.
    let (mut all_nodes, mut all_groups) = (simd::vec_in_huge_pages(nodes), simd::vec_in_huge_pages(groups));
    for _ in 0..nodes {
        all_nodes.push(node(&mut words)?);
    }
    for _ in 0..groups {
        all_groups.push(group(&mut words)?);
    }
    let bvh = WideBvh::from_parts(all_nodes, all_groups).map_err(|what| damaged(&what))?;
    Ok(Scene { bvh, level, bounds, first, masks, vertices: None })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{HitBatch, Ray, RayBatch};
    use crate::sealed::{HEADER, with_checksum};

    fn scene() -> Scene {
        let mesh = crate::model::builtin("balls:1").expect("a name").expect("a size").mesh;
        Scene::builder().mesh(mesh.clone()).mask(0b10).mesh(mesh).build().expect("a valid mesh")
    }

    fn saved() -> Vec<u8> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("scene.bin");
        scene().save(&path).expect("written");
        std::fs::read(&path).expect("read")
    }

    #[test]
    fn comes_back_the_same() {
        let (scene, loaded) = (scene(), parse(&saved(), Level::best()).expect("sound"));
        let rays: RayBatch =
            (0..300).map(|i| Ray::new([0.01 * i as f32 - 1.5, 0.1, 5.0], [0.0, 0.003, -1.0])).collect();
        let (mut a, mut b) = (HitBatch::new(), HitBatch::new());
        scene.closest_batch(&rays, &mut a);
        loaded.closest_batch(&rays, &mut b);
        assert_eq!((a.hash(), scene.first, scene.bounds), (b.hash(), loaded.first, loaded.bounds));
        assert_eq!(loaded.masks, [0b10, u32::MAX]);
        assert!(a.iter().any(|hit| !hit.is_miss()));
        assert_eq!((scene.bvh.depth, scene.bvh.triangles), (loaded.bvh.depth, loaded.bvh.triangles));
    }

    #[test]
    fn damage_is_an_error() {
        let good = saved();
        let fails = |bytes: &[u8], reason: &str| {
            let e = parse(bytes, Level::best()).expect_err(reason);
            assert!(e.contains(reason), "{e}");
        };
        fails(&[], "not a saved scene");
        fails(b"solid ascii stl, not a scene of ours", "not a saved scene");
        fails(&good[..good.len() - 1], "bytes where there should be");
        let mut version = good.clone();
        version[8] = 9;
        fails(&version, "version 9");
        for at in (HEADER..good.len()).step_by(97) {
            let mut bytes = good.clone();
            bytes[at] ^= 0x10;
            fails(&bytes, "the checksum is another");
        }
    }

    /// With a checksum that is right, whatever is accepted can be traced.
    #[test]
    fn no_forgery_makes_a_query_fail() {
        let good = saved();
        let rays: RayBatch = (0..64).map(|i| Ray::new([0.05 * i as f32 - 1.5, 0.1, 5.0], [0.0, 0.003, -1.0])).collect();
        let mut accepted = 0;
        for (i, at) in (HEADER..good.len()).step_by(131).enumerate() {
            let mut bytes = good.clone();
            bytes[at] = [0, 0x7f, 0x80, 0xff][i % 4];
            if let Ok(scene) = parse(&with_checksum(bytes), Level::best()) {
                accepted += 1;
                scene.closest_batch(&rays, &mut HitBatch::new());
                let _ = scene.closest(&rays.get(7));
            }
        }
        assert!(accepted > 0, "most coordinates can be anything");
    }
}
