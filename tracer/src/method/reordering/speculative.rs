//! A packet that goes where its first active ray goes (Wald, Boulos and Shirley 2007), each ray asked in leaves (Boulos, Wald and Benthin 2008, section 3.1).

use super::group::Tree;
use super::interval::Bounds;
use super::rays::{Found, Planes, Results, Sixteen};
use super::tally::Tally;
use simd::{Float, Mask};

/// A node that waits, for the rays from the first active one on.
#[derive(Debug, Clone, Copy)]
struct Entry {
    node: u32,
    parent: u32,
    first: u16,
}

/// A traversal, with memory that it keeps from packet to packet.
pub(super) struct Speculative {
    stack: Vec<Entry>,
}

impl Speculative {
    pub(super) fn new() -> Self {
        Self { stack: Vec::with_capacity(64) }
    }

    /// A packet; interval tests are for those of more rays than `tested_above`.
    #[inline(always)]
    pub(super) fn traverse<F: Float, T: Tally>(
        &mut self,
        tree: Tree,
        rays: &mut [Sixteen],
        tested_above: usize,
        results: &mut Results,
        tally: &mut T,
    ) {
        if tree.bvh.nodes.is_empty() {
            return;
        }
        tally.packet();
        let bounds = Bounds::of_many::<F>(rays, None, 16 * rays.len() > tested_above);
        let (nodes, groups) = (&tree.bvh.nodes[..], 16 / F::LANES * rays.len());
        self.stack.push(Entry { node: 0, parent: u32::MAX, first: 0 });
        while let Some(Entry { node: at, parent, first }) = self.stack.pop() {
            tally.visit();
            let (at, first) = (at as usize, usize::from(first));
            let node = &nodes[at];
            let planes = Planes::<F>::new(node.planes(), tree.growth);
            let mut count = Asked { above: None, tests: 0, rays: 0 };
            if T::ON {
                count.above = nodes.get(parent as usize).map(|node| Planes::<F>::new(node.planes(), tree.growth));
            }
            // The group of the first active ray, then all of them at once, then one group after the other.
            let mut group = first / F::LANES;
            let mut bits = count.ask::<T>(rays, group, &planes);
            let mut all_miss = false;
            if bits == 0 {
                if let Some(bounds) = &bounds {
                    all_miss = bounds.all_miss(node.planes(), tree.growth);
                    tally.intervals(at, all_miss.then_some((rays.len() * 16 - first) as u32));
                }
                while bits == 0 && !all_miss && group + 1 < groups {
                    group += 1;
                    bits = count.ask::<T>(rays, group, &planes);
                }
            }
            let first = group * F::LANES + bits.trailing_zeros() as usize;
            let (leaf, number) = node.triangles();
            if bits != 0 && number > 0 {
                tally.primitives(number);
                let triangles = &tree.bvh.triangles[leaf as usize..(leaf + number) as usize];
                loop {
                    if bits != 0 {
                        let (rays, chunk) = (&mut rays[group * F::LANES / 16], group % (16 / F::LANES));
                        let mut found = Found::<F>::load(rays, chunk);
                        found.leaf(triangles, &rays.packet(chunk), bits, results.is_any(), tally);
                        found.store(rays, chunk, results);
                    }
                    group += 1;
                    if group == groups {
                        break;
                    }
                    bits = count.ask::<T>(rays, group, &planes);
                }
            } else if bits != 0 {
                self.descend(tree, rays, (at, first));
            }
            if T::ON {
                tally.boxes(at, count.tests, count.rays);
            }
        }
    }

    #[inline(always)]
    fn descend(&mut self, tree: Tree, rays: &[Sixteen], (at, ray): (usize, usize)) {
        let nodes = &tree.bvh.nodes[..];
        let (parent, first) = (at as u32, ray as u16);
        if let Some(children) = tree.order.of(at) {
            let is_negative = rays[ray / 16].is_negative(ray % 16, children.axis);
            let (near, far) = children.near_and_far(at, is_negative);
            self.stack.push(Entry { node: far as u32, parent, first });
            self.stack.push(Entry { node: near as u32, parent, first });
        } else {
            // Where a builder made more children they come last stored first.
            let mut child = parent + 1;
            while child < nodes[at].skip() {
                self.stack.push(Entry { node: child, parent, first });
                child = nodes[child as usize].skip();
            }
        }
    }
}

/// Box tests of a node, and what is counted of them.
struct Asked<F: Float> {
    above: Option<Planes<F>>,
    tests: u32,
    rays: u32,
}

impl<F: Float> Asked<F> {
    /// Which rays of a group meet the box.
    #[inline(always)]
    fn ask<T: Tally>(&mut self, rays: &[Sixteen], group: usize, planes: &Planes<F>) -> u32 {
        let (rays, chunk) = (&rays[group * F::LANES / 16], group % (16 / F::LANES));
        if T::ON {
            self.tests += 1;
            let met = match &self.above {
                Some(above) => {
                    let (t_near, t_far) = rays.interval(chunk, above);
                    t_near.le(t_far)
                }
                None => F::load_block(&rays.t_min, chunk).le(F::load_block(&rays.reach, chunk)),
            };
            self.rays += met.bitmask().count_ones();
        }
        let (t_near, t_far) = rays.interval(chunk, planes);
        t_near.le(t_far).bitmask()
    }
}
