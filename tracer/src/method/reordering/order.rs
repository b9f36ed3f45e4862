//! Which child comes first (Wald, Boulos and Shirley 2007): decided by the axis along which two children lie farthest apart, and by the sign of the
//! first active ray on it.

use crate::bvh::{Bvh, Node};

/// For each inner node of two children the second one, the axis, and which child is the lower one on it: the tree has this in three places, far apart.
#[derive(Debug, Clone)]
pub(super) struct Order(Vec<u32>);

/// Two children, the first of which is the next node.
#[derive(Debug, Clone, Copy)]
pub(super) struct Children {
    pub(super) second: usize,
    pub(super) axis: usize,
    is_second_lower: bool,
}

impl Order {
    pub(super) fn new(bvh: &Bvh) -> Self {
        let of = |i: usize| {
            let Some(second) = second(&bvh.nodes, i) else { return 0 };
            let (a, b) = (centre(&bvh.nodes[i + 1]), centre(&bvh.nodes[second]));
            let apart = [0, 1, 2].map(|axis| b[axis] - a[axis]);
            let axis = (1..3).fold(0, |most, axis| if apart[axis].abs() > apart[most].abs() { axis } else { most });
            (second as u32) << 3 | u32::from(apart[axis] < 0.0) << 2 | axis as u32
        };
        Self((0..bvh.nodes.len()).map(of).collect())
    }

    pub(super) fn bytes(&self) -> usize {
        4 * self.0.len()
    }

    /// The children of an inner node, if they are two.
    #[inline(always)]
    pub(super) fn of(&self, node: usize) -> Option<Children> {
        let word = self.0[node];
        if word == 0 {
            return None;
        }
        let (second, axis) = ((word >> 3) as usize, (word & 3) as usize);
        Some(Children { second, axis, is_second_lower: word & 4 != 0 })
    }
}

impl Children {
    /// The nearer and the farther one for a ray, given the node above and whether its direction is negative on the axis.
    #[inline(always)]
    pub(super) fn near_and_far(self, above: usize, is_negative: bool) -> (usize, usize) {
        let first = above + 1;
        if is_negative == self.is_second_lower { (first, self.second) } else { (self.second, first) }
    }
}

fn second(nodes: &[Node], node: usize) -> Option<usize> {
    if nodes[node].triangles().1 > 0 {
        return None;
    }
    let second = nodes.get(node + 1)?.skip() as usize;
    (nodes.get(second)?.skip() == nodes[node].skip() && second < nodes[node].skip() as usize).then_some(second)
}

/// Twice the centre.
fn centre(node: &Node) -> [f32; 3] {
    let b = node.bounds();
    [b.min[0] + b.max[0], b.min[1] + b.max[1], b.min[2] + b.max[2]]
}
