//! The nodes of a scene and where they are.

use super::buffers::Buffers;
use super::primitive::{self, Shape};
use super::{Notes, named};
use crate::Error;
use crate::bvh::Node as Tree;
use crate::model::Mesh;
use crate::progress::Progress;
use gltf::{Document, Node};

/// An affine map: three columns, and where the origin goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Affine(pub(super) [[f64; 3]; 4]);

impl Affine {
    const IDENTITY: Self = Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]]);

    fn of(node: &Node<'_>) -> Self {
        let matrix = node.transform().matrix();
        Self(matrix.map(|[x, y, z, _]| [x, y, z].map(f64::from)))
    }

    /// `inner` first.
    fn after(&self, inner: &Self) -> Self {
        let [x, y, z, origin] = inner.0;
        Self([self.vector(x), self.vector(y), self.vector(z), self.point(origin)])
    }

    pub(super) fn vector(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [a, b, c, _] = &self.0;
        [0, 1, 2].map(|k| a[k] * x + b[k] * y + c[k] * z)
    }

    pub(super) fn point(&self, p: [f64; 3]) -> [f64; 3] {
        let (v, origin) = (self.vector(p), self.0[3]);
        [0, 1, 2].map(|k| v[k] + origin[k])
    }

    /// The map of normals, but for their length: that of the cofactors. And whether it mirrors.
    pub(super) fn normals(&self) -> (Self, bool) {
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let [a, b, c, _] = self.0;
        let cofactors = [cross(b, c), cross(c, a), cross(a, b)];
        let determinant: f64 = (0..3).map(|k| a[k] * cofactors[0][k]).sum();
        let sign = if determinant < 0.0 { -1.0 } else { 1.0 };
        let [x, y, z] = cofactors.map(|v| v.map(|c| sign * c));
        (Self([x, y, z, [0.0; 3]]), determinant < 0.0)
    }
}

/// All nodes of a scene, each before its children.
pub(super) struct Graph<'a>(pub(super) Vec<(Node<'a>, Affine)>);

impl<'a> Graph<'a> {
    /// The default scene, or the first one; without scenes all nodes that are nobody's children.
    pub(super) fn walk(document: &'a Document, notes: &mut Notes<'_>) -> Result<Self, Error> {
        let scene = document.default_scene().or_else(|| document.scenes().next());
        let mut roots: Vec<Node<'a>> = match scene {
            Some(scene) => scene.nodes().collect(),
            None => {
                let mut children = vec![false; document.nodes().len()];
                document.nodes().flat_map(|n| n.children()).for_each(|child| children[child.index()] = true);
                document.nodes().filter(|n| !children[n.index()]).collect()
            }
        };
        if document.scenes().len() > 1 {
            notes.warn(&format!(
                "of its {} scenes one is shown: the default one, or the first",
                document.scenes().len()
            ));
        }
        roots.reverse();
        let mut todo: Vec<_> = roots.into_iter().map(|root| (root, Affine::IDENTITY)).collect();
        let mut seen = vec![false; document.nodes().len()];
        let mut nodes = Vec::new();
        while let Some((node, parent)) = todo.pop() {
            let what = named("node", node.index(), node.name());
            if std::mem::replace(&mut seen[node.index()], true) {
                return Err(
                    notes.error(format!("{what} has two parents or is its own descendant: nodes have to form a tree"))
                );
            }
            if node.skin().is_some() {
                notes.warn(&format!("{what}: skins are not supported, it is shown without"));
            }
            let place = parent.after(&Affine::of(&node));
            let first = todo.len();
            todo.extend(node.children().map(|child| (child, place)));
            todo[first..].reverse();
            nodes.push((node, place));
        }
        Ok(Self(nodes))
    }

    /// All triangles. (Their normals are not of unit length.)
    pub(super) fn mesh(
        &self,
        document: &Document,
        buffers: &Buffers,
        notes: &mut Notes<'_>,
        progress: &dyn Progress,
    ) -> Result<Mesh, Error> {
        let meshes = self.meshes(document, buffers, notes)?;
        let of = |node: &Node<'_>| node.mesh().and_then(|mesh| meshes[mesh.index()].as_ref());
        let total = self.0.iter().filter_map(|(node, _)| of(node)).fold(0, |sum: usize, (n, _)| sum.saturating_add(*n));
        match total {
            0 => return Err(notes.error("the scene has no triangles: there is nothing to see")),
            n if n > Tree::MAX_TRIANGLES => {
                let most = Tree::MAX_TRIANGLES;
                return Err(notes.error(format!("the scene has {n} triangles, {most} is the most: split it")));
            }
            _ => {}
        }
        progress.stage("parse", total as u64);
        let default = document.materials().len();
        let mut mesh = Mesh::default();
        for (node, place) in &self.0 {
            for shape in of(node).into_iter().flat_map(|(_, shapes)| shapes) {
                shape.add_to(&mut mesh, place, default).map_err(|e| notes.error(e))?;
                progress.advance(shape.triangles() as u64);
                progress.check()?;
            }
        }
        if mesh.normals.is_empty() {
            mesh.normal_indices.clear();
        }
        if mesh.uvs.is_empty() {
            mesh.uv_indices.clear();
        }
        Ok(mesh)
    }

    /// Of each mesh that is shown. (Many nodes may show the same.)
    fn meshes<'b>(
        &self,
        document: &Document,
        buffers: &'b Buffers,
        notes: &mut Notes<'_>,
    ) -> Result<Vec<Option<Shown<'b>>>, Error> {
        let mut meshes: Vec<_> = document.meshes().map(|_| None).collect();
        for mesh in self.0.iter().filter_map(|(node, _)| node.mesh()) {
            if meshes[mesh.index()].is_some() {
                continue;
            }
            let name = named("mesh", mesh.index(), mesh.name());
            let mut shapes = Vec::new();
            for primitive in mesh.primitives() {
                let what = format!("{name}, primitive {}", primitive.index());
                primitive::look(&primitive, &what, notes);
                let shape = Shape::new(&primitive, buffers, what).map_err(|e| notes.error(e))?;
                shapes.extend(shape.filter(|shape| shape.triangles() > 0));
            }
            let triangles = shapes.iter().map(Shape::triangles).fold(0, usize::saturating_add);
            meshes[mesh.index()] = Some((triangles, shapes));
        }
        Ok(meshes)
    }
}

/// How many triangles a mesh has, and what they are made of.
type Shown<'b> = (usize, Vec<Shape<'b>>);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps() {
        let turn = Affine([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [5.0, 0.0, 0.0]]);
        let stretch = Affine([[2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, -1.0], [1.0, 1.0, 1.0]]);
        let both = turn.after(&stretch);
        assert_eq!(both.point([1.0, 1.0, 1.0]), turn.point(stretch.point([1.0, 1.0, 1.0])));
        assert_eq!(both.point([1.0, 1.0, 1.0]), [1.0, 3.0, 0.0]);
        // A plane x + y = 0 has the normal (1, 1, 0); stretched, (3, 2, 0).
        let (normals, mirrors) = stretch.normals();
        let n = normals.vector([1.0, 1.0, 0.0]);
        assert!(mirrors && n[0] > 0.0 && n[0] * 2.0 == n[1] * 3.0, "{n:?}");
        assert!(!turn.normals().1);
    }
}
