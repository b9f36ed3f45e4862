//! Builders: from a mesh to the depth-first array of nodes with skip pointers.
//!
//! How the presets compare, in nodes of eight children and groups of four triangles that a single ray visits, from random points to
//! random points in the scene's box, and in the cost by the surface area heuristic (SAH) and overlap (EPO) of the binary tree. The hits are
//! the same.
//!
//! | | [fast](BuildConfig::fast) | [medium](BuildConfig::medium) | [high](BuildConfig::high) |
//! |---|---|---|---|
//! | conference: nodes, groups; SAH, EPO | 8.54, 3.78; 80.9, 24.3 | 6.38, 3.22; 71.1, 16.9 | 4.79, 2.28; 56.9, 10.2 |
//! | sponza | 10.21, 3.24; 143.5, 29.1 | 7.18, 2.24; 128.8, 22.8 | 4.79, 2.42; 99.4, 11.0 |
//! | kitchen | 6.78, 1.70; 77.6, 20.8 | 5.51, 1.38; 68.9, 14.7 | 3.46, 1.15; 49.6, 8.9 |
//! | balls | 1.82, 0.35; 6.24, 0.31 | 1.68, 0.31; 7.84, 0.17 | 1.62, 0.31; 5.88, 0.21 |
//! | hairball | 34.8, 7.69; 365, 19.7 | 32.4, 7.09; 317, 15.1 | 30.4, 6.94; 294, 12.9 |
//! | time to build | 0.7 to 0.8 | 1 | 8 to 11 |
//!
//! There are no spatial splits. The box of a piece of a triangle does not hold the triangle's box, so that hits would not be exact
//! any more; and cutting the triangles with the largest boxes to 1.1, 1.3 or 1.6 times as many pieces before building (Karras and Aila 2013)
//! made no tree better that reinsertion then improves: with 1.3 times as many SAH costs of 57.2, 103.1 and 57.2 instead of 56.9, 99.4
//! and 49.6 on conference, sponza and kitchen.

pub mod binned;
mod bins;
mod boxes;
pub mod insertion;
pub mod linear;
mod part;
pub(crate) mod primitive;
pub mod reinsertion;
mod sah;
mod sweep;
#[cfg(test)]
mod tests;

use super::collapse::collapse;
use super::{Bvh, CollapseConfig, Node, WideBvh};
use crate::Error;
use crate::geometry::Triangle;
use crate::model::Mesh;
use crate::progress::Progress;
use primitive::Primitive;
use rayon::prelude::*;
use std::borrow::Cow;

/// Which builder makes the tree, and its knobs.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum BuildConfig {
    /// Top down by the surface area heuristic over bins: the default, fast to build and to traverse. See [`binned`].
    Binned(binned::Config),
    /// Along a space-filling curve: the fastest to build. See [`linear`].
    Linear(linear::Config),
    /// As [`BuildConfig::Binned`], then improved by moving subtrees: the slowest to build, the fastest to traverse. See [`reinsertion`].
    Reinsertion(reinsertion::Config),
    /// One triangle after the other, as in Geimer & Müller 2003, section 3.3: for comparison with the paper. See [`insertion`].
    Insertion(insertion::Config),
}

impl Default for BuildConfig {
    fn default() -> Self {
        Self::medium()
    }
}

impl BuildConfig {
    /// For a tree that is built often and used little.
    #[must_use]
    pub fn fast() -> Self {
        Self::Linear(linear::Config::default())
    }

    /// The default: a good tree, soon.
    #[must_use]
    pub fn medium() -> Self {
        Self::Binned(binned::Config::default())
    }

    /// For a tree that is built once and used much.
    #[must_use]
    pub fn high() -> Self {
        Self::Reinsertion(reinsertion::Config::default())
    }

    /// The paper's insertion builder, its order of insertion shuffled from `seed`.
    #[must_use]
    pub fn insertion(seed: u64) -> Self {
        Self::Insertion(insertion::Config { seed: Some(seed), ..Default::default() })
    }

    /// How many bytes there are at once, at most, while [`WideBvh::build`] makes nodes of eight children over this many
    /// triangles, the mesh not counted: the lists of the builder, or the binary tree with what collapsing it needs, whichever is more.
    ///
    /// How many nodes there will be only building tells: this is for triangles that lie far from each other, which make the most. Of
    /// surfaces it takes 0.6 to 0.75 times as much ([`BuildConfig::high`]: 0.9). What remains, nodes and groups, is about half of it:
    /// [`WideBvh::bytes`].
    #[must_use]
    pub fn peak_bytes(&self, triangles: usize) -> u64 {
        // Bytes for each triangle, with one node for each; two where leaves are small.
        let nodes = |max_leaf| if max_leaf < 4 { 2 } else { 1 };
        // Ids and groups; nodes, with costs of collapsing; wide nodes.
        let collapse = |nodes: u64| 8 + nodes * (32 + 20) + 80;
        let per_triangle = match self {
            Self::Linear(config) => collapse(nodes(config.max_leaf)),
            Self::Binned(config) => collapse(nodes(config.max_leaf)),
            // Boxes and links of two nodes for each triangle, and the tree made of them.
            Self::Reinsertion(config) => collapse(nodes(config.binned.max_leaf)).max(232),
            // Two nodes for each triangle, and their copy of two children a node.
            Self::Insertion(_) => collapse(2) + 70,
        };
        per_triangle * triangles as u64
    }
}

/// No leaf is deeper (the root is at depth 0) in trees that are built top down: where only balanced splits still fit, splits are
/// balanced.
pub const MAX_DEPTH: u32 = 64;

/// Larger ranges of primitives are worked on in pieces of this size, in parallel. Constant, so that the result is the same for any
/// number of threads.
const PIECE: usize = 8192;

/// What a builder returns: the nodes, and the ids of the triangles in the order of the leaves.
struct Tree {
    nodes: Vec<Node>,
    ids: Vec<u32>,
}

impl Bvh {
    /// Builds the tree over the triangles of `mesh` that are not degenerate; empty when all are.
    ///
    /// Runs on the current rayon pool. The tree does not depend on the number of its threads. Progress is a stage
    /// `"build"` in triangles, and for [`BuildConfig::Reinsertion`] a second, `"optimize"`, in rounds.
    ///
    /// # Errors
    /// [`Error::Geometry`] as [`Mesh::validate`] has it, [`Error::Cancelled`] when `progress` says so.
    pub fn build(mesh: &Mesh, config: &BuildConfig, progress: &dyn Progress) -> Result<Self, Error> {
        let Tree { nodes, ids } = tree(mesh, primitive::primitives, config, progress)?;
        let mut triangles = simd::vec_in_huge_pages(ids.len());
        ids.into_par_iter().map(|id| triangle(mesh, id)).collect_into_vec(&mut triangles);
        Ok(Self { nodes, triangles })
    }
}

impl<const N: usize> WideBvh<N> {
    /// What [`Bvh::build`] and [`Bvh::collapse`] make, in less time and memory.
    ///
    /// ```
    /// use tracer::bvh::{BuildConfig, CollapseConfig, WideBvh};
    /// use tracer::{model::Model, progress::Silent};
    ///
    /// # fn main() -> Result<(), tracer::Error> {
    /// let (model, _warnings) = Model::open("balls:1", &Silent)?;
    /// let bvh = WideBvh::<8>::build(&model.mesh, &BuildConfig::default(), &CollapseConfig::default(), &Silent)?;
    /// assert!(bvh.bytes() < 80 * bvh.triangles);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// As [`Bvh::build`].
    pub fn build(
        mesh: &Mesh,
        config: &BuildConfig,
        collapse: &CollapseConfig,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        Ok(tree(mesh, primitive::primitives, config, progress)?.collapse(mesh, collapse))
    }

    /// As [`WideBvh::build`], but slivers are left out no more than other triangles, and boxes hold the vertices as they are given:
    /// what the watertight test needs.
    pub(crate) fn build_watertight(
        mesh: &Mesh,
        config: &BuildConfig,
        collapse: &CollapseConfig,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        Ok(tree(mesh, primitive::slivers_too, config, progress)?.collapse(mesh, collapse))
    }
}

impl Tree {
    fn collapse<const N: usize>(self, mesh: &Mesh, config: &CollapseConfig) -> WideBvh<N> {
        let Self { nodes, ids } = self;
        collapse(Cow::Owned(nodes), ids.len(), &|place| triangle(mesh, ids[place]), config)
    }
}

fn tree(
    mesh: &Mesh,
    primitives: fn(&Mesh) -> Vec<Primitive>,
    config: &BuildConfig,
    progress: &dyn Progress,
) -> Result<Tree, Error> {
    mesh.validate()?;
    let total = mesh.triangles.len();
    progress.stage("build", total as u64);
    progress.check()?;
    let primitives = primitives(mesh);
    progress.advance((total - primitives.len()) as u64);
    let tree = match config {
        _ if primitives.is_empty() => Tree { nodes: Vec::new(), ids: Vec::new() },
        BuildConfig::Binned(config) => binned::build(primitives, config, progress)?,
        BuildConfig::Linear(config) => linear::build(primitives, config, progress)?,
        BuildConfig::Reinsertion(config) => reinsertion::build(primitives, config, progress)?,
        BuildConfig::Insertion(config) => insertion::build(primitives, config, progress)?,
    };
    progress.check()?;
    Ok(tree)
}

/// The mesh's triangle `id`, as it is stored.
#[inline]
pub(super) fn triangle(mesh: &Mesh, id: u32) -> Triangle {
    let i = id as usize;
    Triangle::new(mesh.triangle(i), id, mesh.material(i))
}
