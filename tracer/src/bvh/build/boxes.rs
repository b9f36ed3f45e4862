//! Trees over boxes of anything.

use super::primitive::Primitive;
use super::{Tree, binned};
use crate::Error;
use crate::bvh::collapse::collapse;
use crate::bvh::{CollapseConfig, Node, WideBvh};
use crate::geometry::{Aabb, Triangle};
use crate::progress::Silent;
use std::borrow::Cow;

impl WideBvh<8> {
    /// Over finite boxes; what is in them is told by the ids in the groups, which are places in `boxes`. Each is alone in its leaf.
    /// Boxes that are [empty](Aabb::EMPTY) are left out.
    ///
    /// # Errors
    /// [`Error::Geometry`] when there are too many.
    pub(crate) fn of_boxes(boxes: &[Aabb]) -> Result<Self, Error> {
        if boxes.len() > Node::MAX_TRIANGLES {
            return Err(Error::Geometry(format!(
                "there are {} boxes, {} is the most",
                boxes.len(),
                Node::MAX_TRIANGLES
            )));
        }
        let numbered = boxes.iter().zip(0..).filter(|(b, _)| **b != Aabb::EMPTY);
        let primitives: Vec<Primitive> = numbered.map(|(b, id)| Primitive::new(b, id)).collect();
        let config = binned::Config { max_leaf: 1, ..Default::default() };
        let Tree { nodes, ids } = match primitives.is_empty() {
            true => Tree { nodes: Vec::new(), ids: Vec::new() },
            false => binned::build(primitives, &config, &Silent)?,
        };
        // Nothing but the ids of these triangles is looked at.
        let triangle = |place: usize| Triangle::new([[0.0; 3]; 3], ids[place], 0);
        Ok(collapse(Cow::Owned(nodes), ids.len(), &triangle, &CollapseConfig { node_cost: 1.0, max_leaf: 1 }))
    }
}
