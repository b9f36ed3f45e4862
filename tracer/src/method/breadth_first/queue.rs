//! The level-synchronous traversal (Garanzha & Loop 2010, section 3.3): pairs of a frustum and a node go from one queue to another, a level of the
//! tree at a time, and what is left in the end are pairs of a frustum and a leaf.

use super::children::{self, Children, LEAF};
use super::leaves::Leaves;
use crate::bvh::OctoBvh;
use crate::geometry::frustum::Frustum;
use crate::lanes::{self, Lanes};
use crate::sort::exclusive_scan;
use crate::stats;
use simd::{Float, Integer, Level, Vector};

/// Room behind the last element, so that eight can be written anywhere.
const PADDING: usize = 8;

/// Pairs of a frustum and a node.
#[derive(Debug, Default)]
struct Queue {
    frusta: Vec<u32>,
    nodes: Vec<u32>,
    len: usize,
}

impl Queue {
    /// Room for so many: memory is taken as it is needed.
    fn reserve(&mut self, elements: usize) {
        if self.nodes.len() < elements + PADDING {
            let room = elements.next_power_of_two() + PADDING;
            self.frusta.resize(room, 0);
            self.nodes.resize(room, 0);
        }
    }

    /// Where the pairs of another frustum begin, as near to the middle as can be; `None` if there is one frustum alone.
    fn middle(&self) -> Option<usize> {
        let (frusta, half) = (&self.frusta[..self.len], self.len / 2);
        let is_first = |i: &usize| frusta[*i] != frusta[*i - 1];
        let (above, below) = ((half.max(1)..self.len).find(is_first), (1..half).rev().find(is_first));
        match (below, above) {
            (Some(below), Some(above)) if half - below < above - half => Some(below),
            (below, above) => above.or(below),
        }
    }
}

/// Both queues, and what is computed for each pair: in memory that is kept from one batch to the next.
#[derive(Debug)]
pub(super) struct Queues {
    input: Queue,
    output: Queue,
    /// Boxes of the node's children that the frustum meets.
    numbers: Vec<u32>,
    sums: Vec<u32>,
    /// Which children these are: see [`Children`].
    sorted: Vec<u32>,
    /// What they are added to.
    bases: Vec<u32>,
    capacity: usize,
    /// Second halves of batches that were split, the last on top.
    waiting: Vec<[Vec<u32>; 2]>,
}

impl Queues {
    /// For at most so many pairs at a time.
    pub(super) fn with_capacity(capacity: usize) -> Self {
        Self {
            input: Queue::default(),
            output: Queue::default(),
            numbers: Vec::new(),
            sums: Vec::new(),
            sorted: Vec::new(),
            bases: Vec::new(),
            capacity,
            waiting: Vec::new(),
        }
    }

    pub(super) fn bytes(&self) -> usize {
        let columns = [&self.input.frusta, &self.input.nodes, &self.output.frusta, &self.output.nodes];
        let others = [&self.numbers, &self.sums, &self.sorted, &self.bases];
        columns.iter().chain(&others).map(|column| column.len() * size_of::<u32>()).sum()
    }

    /// Takes all frusta from the root to the leaves. Where these have become more than pairs may be, `full` is told how many frusta are through with
    /// them, and may forget their leaves.
    pub(super) fn traverse(
        &mut self,
        level: Level,
        tree: &OctoBvh,
        frusta: &[Frustum],
        leaves: &mut Leaves,
        mut count: Option<&mut stats::Frusta>,
        full: &mut dyn FnMut(&mut Leaves, usize),
    ) {
        self.waiting.clear();
        leaves.clear(frusta.len());
        for first in (0..frusta.len()).step_by(self.capacity) {
            self.input.len = self.capacity.min(frusta.len() - first);
            self.input.reserve(self.input.len);
            for (i, (frustum, node)) in self.input.frusta.iter_mut().zip(&mut self.input.nodes).enumerate() {
                if i >= self.input.len {
                    break;
                }
                (*frustum, *node) = ((first + i) as u32, children::root(tree));
            }
            if leaves.nodes.len() > self.capacity {
                full(leaves, first);
            }
            loop {
                self.descend(level, tree, frusta, &mut count);
                leaves.append(level, &self.input.frusta[..self.input.len], &self.input.nodes[..self.input.len]);
                if leaves.nodes.len() > self.capacity
                    && let Some([frusta, _]) = self.waiting.last()
                {
                    full(leaves, frusta[0] as usize);
                }
                let Some([frusta, nodes]) = self.waiting.pop() else { break };
                self.input.len = nodes.len();
                self.input.reserve(nodes.len());
                self.input.frusta[..nodes.len()].copy_from_slice(&frusta);
                self.input.nodes[..nodes.len()].copy_from_slice(&nodes);
            }
        }
    }

    /// Takes the pairs of the input down to the leaves, or the first of them, while the others wait.
    fn descend(&mut self, level: Level, tree: &OctoBvh, frusta: &[Frustum], count: &mut Option<&mut stats::Frusta>) {
        loop {
            let len = self.input.len;
            if self.numbers.len() < len {
                for v in [&mut self.numbers, &mut self.sums, &mut self.sorted, &mut self.bases] {
                    v.resize(len.next_power_of_two(), 0);
                }
            }
            let step = Step {
                tree,
                frusta,
                pairs: [&self.input.frusta[..len], &self.input.nodes[..len]],
                numbers: &mut self.numbers[..len],
                sorted: &mut self.sorted[..len],
                bases: &mut self.bases[..len],
            };
            if !lanes::run_eight(level, step) {
                return;
            }
            let total = exclusive_scan(level, &self.numbers[..len], &mut self.sums[..len]) as usize;
            // A single frustum that comes to more nodes has more room.
            if total > self.capacity
                && let Some(middle) = self.input.middle()
            {
                let rest = middle..len;
                self.waiting.push([self.input.frusta[rest.clone()].to_vec(), self.input.nodes[rest].to_vec()]);
                self.input.len = middle;
                if let Some(count) = count {
                    count.splits += 1;
                }
                continue;
            }
            self.output.reserve(total);
            if let Some(count) = count {
                count.steps += len as u64;
                count.box_tests += children::number(tree, &self.input.nodes[..len]);
            }
            let scatter = Scatter {
                frusta: &self.input.frusta[..len],
                numbers: &self.numbers[..len],
                sums: &self.sums[..len],
                sorted: &self.sorted[..len],
                bases: &self.bases[..len],
                to: [&mut self.output.frusta, &mut self.output.nodes],
            };
            lanes::run_eight(level, scatter);
            self.output.len = total;
            std::mem::swap(&mut self.input, &mut self.output);
        }
    }
}

/// Tests each pair's frustum against the node's children. False if all nodes are leaves, which are their own children.
struct Step<'a> {
    tree: &'a OctoBvh,
    frusta: &'a [Frustum],
    pairs: [&'a [u32]; 2],
    numbers: &'a mut [u32],
    sorted: &'a mut [u32],
    bases: &'a mut [u32],
}

impl Lanes for Step<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<F: Float>(self) -> bool {
        let rows = self.tree.rows();
        let mut inner = false;
        let [frusta, nodes] = self.pairs;
        let to = self.numbers.iter_mut().zip(self.sorted).zip(self.bases);
        for ((i, (&frustum, &node)), ((number, sorted), base)) in frusta.iter().zip(nodes).enumerate().zip(to) {
            if let Some(&later) = nodes.get(i + 4) {
                children::prefetch(rows, later);
            }
            let children = if node & LEAF != 0 {
                Children::of_leaf(node)
            } else {
                inner = true;
                Children::of::<F>(rows, node, &self.frusta[frustum as usize])
            };
            (*number, *sorted, *base) = (children.number, children.sorted, children.base);
        }
        inner
    }
}

/// Writes the children of each pair to where the scan says.
struct Scatter<'a> {
    frusta: &'a [u32],
    numbers: &'a [u32],
    sums: &'a [u32],
    sorted: &'a [u32],
    bases: &'a [u32],
    to: [&'a mut [u32]; 2],
}

impl Lanes for Scatter<'_> {
    type Output = ();

    #[inline(always)]
    fn run<F: Float>(self) {
        let [to_frusta, to_nodes] = self.to;
        let shifts = F::Index::load(&[0, 4, 8, 12, 16, 20, 24, 28]);
        let from = self.frusta.iter().zip(self.numbers).zip(self.sums).zip(self.sorted).zip(self.bases);
        for ((((&frustum, &number), &sum), &sorted), &base) in from {
            // More than there are is written: what comes later is written over it.
            let mut k = 0;
            while k < number as usize {
                let children = F::Index::splat(sorted >> (4 * k)).shr_lanes(shifts);
                let leaf = (children & F::Index::splat(8)) << 28;
                let at = sum as usize + k;
                ((F::Index::splat(base) + (children & F::Index::splat(7))) | leaf).store(&mut to_nodes[at..]);
                F::Index::splat(frustum).store(&mut to_frusta[at..]);
                k += F::LANES;
            }
        }
    }
}
