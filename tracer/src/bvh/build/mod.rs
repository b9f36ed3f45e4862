//! Builders: from a mesh to the depth-first array of nodes with skip pointers.

pub mod binned;
mod bins;
mod boxes;
pub mod insertion;
mod primitive;
mod sah;
mod sweep;
#[cfg(test)]
mod tests;

use super::{Bvh, Node};
use crate::Error;
use crate::geometry::Triangle;
use crate::model::Mesh;
use crate::progress::Progress;
use rayon::prelude::*;

/// Which builder makes the tree, and its knobs.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum BuildConfig {
    /// Top down by the surface area heuristic over bins: the default, fast to build and to traverse. See [`binned`].
    Binned(binned::Config),
    /// One triangle after the other, as in Geimer & Müller 2003, section 3.3: for comparison with the paper. See [`insertion`].
    Insertion(insertion::Config),
}

impl Default for BuildConfig {
    fn default() -> Self {
        Self::Binned(binned::Config::default())
    }
}

impl BuildConfig {
    /// The paper's insertion builder, its order of insertion shuffled from `seed`.
    #[must_use]
    pub fn insertion(seed: u64) -> Self {
        Self::Insertion(insertion::Config { seed: Some(seed), ..Default::default() })
    }
}

/// What a builder returns: the nodes, and the ids of the triangles in the order of the leaves.
struct Tree {
    nodes: Vec<Node>,
    ids: Vec<u32>,
}

impl Bvh {
    /// Builds the tree over the triangles of `mesh` that are not degenerate; empty when all are.
    ///
    /// Runs on the current rayon pool. The tree does not depend on the number of its threads. Progress is one stage,
    /// `"build"`, in triangles.
    ///
    /// # Errors
    /// [`Error::Geometry`] as [`Mesh::validate`] has it, [`Error::Cancelled`] when `progress` says so.
    pub fn build(mesh: &Mesh, config: &BuildConfig, progress: &dyn Progress) -> Result<Self, Error> {
        mesh.validate()?;
        let total = mesh.triangles.len();
        progress.stage("build", total as u64);
        progress.check()?;
        let primitives = primitive::primitives(mesh);
        progress.advance((total - primitives.len()) as u64);
        let Tree { nodes, ids } = match config {
            _ if primitives.is_empty() => Tree { nodes: Vec::new(), ids: Vec::new() },
            BuildConfig::Binned(config) => binned::build(primitives, config, progress)?,
            BuildConfig::Insertion(config) => insertion::build(primitives, config, progress)?,
        };
        progress.check()?;
        let triangles = ids.into_par_iter().map(|id| triangle(mesh, id)).collect();
        Ok(Self { nodes, triangles })
    }
}

/// The mesh's triangle `id`, as it is stored.
#[inline]
fn triangle(mesh: &Mesh, id: u32) -> Triangle {
    let i = id as usize;
    Triangle::new(mesh.triangle(i), id, mesh.material(i))
}
