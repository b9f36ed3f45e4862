//! The leaves that the frusta of a packet captured, with boxes side by side, so that as many as a vector has lanes are tested against a group's part of the frustum at once.

use crate::bvh::{Bvh, OctoBvh, OctoNode};
use simd::{Block, Float};

/// Sixteen leaves, or fewer.
#[derive(Debug)]
pub(super) struct Sixteen {
    /// Their boxes; in lanes without any one that nothing meets.
    pub(super) low: [Block<f32>; 3],
    pub(super) high: [Block<f32>; 3],
    pub(super) nodes: [u32; 16],
}

/// The leaves that the frusta of a packet captured.
#[derive(Debug, Default)]
pub(super) struct Boxes {
    all: Vec<Sixteen>,
    /// Where those of each frustum end.
    ends: Vec<usize>,
}

/// The box that nothing meets.
const NOTHING: [f32; 8] = {
    let (low, high) = (f32::INFINITY, f32::NEG_INFINITY);
    [low, low, low, 0.0, high, high, high, 0.0]
};

impl Boxes {
    pub(super) fn clear(&mut self) {
        self.all.clear();
        self.ends.clear();
    }

    /// The leaves of the next frustum. Their triangles are asked for.
    #[inline(always)]
    pub(super) fn add<F: Float>(&mut self, (bvh, tree): (&Bvh, &OctoBvh), leaves: &[u32]) {
        let (rows, zero) = (tree.rows(), [Block([0.0; 16]); 3]);
        for leaves in leaves.chunks(16) {
            let mut boxes = [NOTHING; 16];
            let mut sixteen = Sixteen { low: zero, high: zero, nodes: [0; 16] };
            for ((row, node), &leaf) in boxes.iter_mut().zip(&mut sixteen.nodes).zip(leaves) {
                *row = rows[leaf as usize];
                *node = leaf;
                let (first, number) = OctoNode::of_row(row).triangles();
                for i in first as usize..(first + number) as usize {
                    simd::prefetch(&bvh.triangles, i);
                }
            }
            for chunk in 0..16 / F::LANES {
                let [x, y, z, _, high_x, high_y, high_z, _] = F::load_rows8(&boxes[chunk * F::LANES..]);
                x.store_block(&mut sixteen.low[0], chunk);
                y.store_block(&mut sixteen.low[1], chunk);
                z.store_block(&mut sixteen.low[2], chunk);
                high_x.store_block(&mut sixteen.high[0], chunk);
                high_y.store_block(&mut sixteen.high[1], chunk);
                high_z.store_block(&mut sixteen.high[2], chunk);
            }
            self.all.push(sixteen);
        }
        self.ends.push(self.all.len());
    }

    /// Those of a frustum of the packet.
    #[inline(always)]
    pub(super) fn of(&self, frustum: usize) -> &[Sixteen] {
        let begin = if frustum == 0 { 0 } else { self.ends[frustum - 1] };
        &self.all[begin..self.ends[frustum]]
    }
}
