//! Single rays with a triangle test that lets none slip through between neighbours (Woop, Benthin and Wald 2013).

use super::query::{Any, Closest, Query};
use super::ready::Ready;
use super::walk::entry;
use super::{BitVec, Context, Method, PORTION, in_portions};
use crate::Error;
use crate::bvh::{Child, WideBvh, WideNode};
use crate::geometry::watertight::{Lanes, Sheared, VertexGroup, intersect};
use crate::geometry::{Aabb, Hit, HitBatch, Ray, RayBatch, RayBlock, Vec3};
use crate::model::Mesh;
use crate::stats::{Count, Counters, NoCount};
use simd::{Float, Kernel, Level, Mask, Simd};

/// Children of a node.
const N: usize = 8;

/// The vertices of a tree's triangles as they were given.
#[derive(Debug, Clone)]
pub(crate) struct Vertices {
    /// In the order of the tree's groups.
    groups: Vec<VertexGroup>,
    bounds: Aabb,
}

impl Vertices {
    /// Of a tree over this mesh.
    pub(crate) fn new(bvh: &WideBvh<N>, mesh: &Mesh) -> Self {
        let group = |ids| VertexGroup::new(ids, |id| mesh.triangle(id as usize));
        Self { groups: bvh.groups.iter().map(|g| group(g.id)).collect(), bounds: mesh.bounds() }
    }
}

/// Watertight queries of a [`Scene`](crate::Scene): see [`SceneBuilder::watertight`](crate::SceneBuilder::watertight).
#[derive(Debug, Clone, Copy)]
pub struct Watertight<'a> {
    bvh: &'a WideBvh<N>,
    vertices: &'a Vertices,
    level: Level,
}

impl<'a> Watertight<'a> {
    pub(crate) fn new(bvh: &'a WideBvh<N>, vertices: &'a Vertices, level: Level) -> Self {
        Self { bvh, vertices, level }
    }

    /// The first hit of one ray; [`Hit::MISS`] if there is none.
    #[must_use]
    pub fn closest_of(&self, ray: &Ray) -> Hit {
        let hits = self.one::<Closest>(ray);
        Hit { t: hits.t.0[0], u: hits.u.0[0], v: hits.v.0[0], primitive: hits.primitive.0[0] }
    }

    /// Whether one ray hits anything.
    #[must_use]
    pub fn any_of(&self, ray: &Ray) -> bool {
        self.one::<Any>(ray) != 0
    }

    fn one<Q: Query>(&self, ray: &Ray) -> Q::Block {
        let mut rays = [RayBlock::NONE];
        rays[0].set(0, ray);
        let mut results = [Q::NOTHING];
        self.level.run(Trace::<Q, _> { method: *self, rays: &rays, results: &mut results, count: NoCount });
        let [result] = results;
        result
    }

    fn find<Q: Query>(&self, rays: &RayBatch, results: &mut [Q::Block], cx: &mut Context<'_>) -> Result<(), Error> {
        in_portions(PORTION, rays, results, cx, |count, rays, results| {
            if count {
                // The work is the same at every level.
                Level::run_native(Trace::<Q, _> { method: *self, rays, results, count: Counters::default() })
            } else {
                self.level.run(Trace::<Q, _> { method: *self, rays, results, count: NoCount })
            }
        })
    }
}

impl Method for Watertight<'_> {
    fn name(&self) -> &'static str {
        "watertight"
    }

    fn source(&self) -> &'static str {
        "Woop, Benthin and Wald 2013"
    }

    fn memory(&self) -> usize {
        size_of_val(self.vertices.groups.as_slice())
    }

    fn closest(&self, rays: &RayBatch, hits: &mut HitBatch, cx: &mut Context<'_>) -> Result<(), Error> {
        self.find::<Closest>(rays, hits.resize(rays.len()), cx)
    }

    fn any(&self, rays: &RayBatch, occluded: &mut BitVec, cx: &mut Context<'_>) -> Result<(), Error> {
        self.find::<Any>(rays, occluded.resize(rays.len()), cx)
    }
}

/// A portion of rays through the tree.
struct Trace<'a, Q: Query, C> {
    method: Watertight<'a>,
    rays: &'a [RayBlock],
    results: &'a mut [Q::Block],
    count: C,
}

impl<Q: Query, C: Count> Kernel for Trace<'_, Q, C> {
    type Output = Counters;

    #[inline(always)]
    fn run<S: Simd>(mut self) -> Counters {
        let Watertight { bvh, vertices, .. } = self.method;
        // Each node on the way leaves all but one of its children, and the root is put there.
        let mut stack = vec![0; bvh.depth * N + 1];
        for (block, results) in self.rays.iter().zip(self.results) {
            let ready = Ready::new::<S::Float>(block, bvh.largest_coordinate());
            let mut found = Q::NOTHING;
            let mut rest = ready.valid;
            while rest != 0 {
                let lane = rest.trailing_zeros() as usize % 16;
                rest &= rest - 1;
                self.count.packet();
                let ray = Sheared::new(ready.ray(lane), ready.octant(lane), &vertices.bounds);
                let hit = walk::<S, Q, C>(bvh, vertices, &ray, &mut stack, &mut self.count);
                if !hit.is_miss() {
                    Q::store(&mut found, lane, &hit);
                }
            }
            *results = found;
        }
        self.count.total()
    }
}

/// The hit of one ray, the closest or any.
#[inline(always)]
fn walk<S: Simd, Q: Query, C: Count>(
    bvh: &WideBvh<N>,
    vertices: &Vertices,
    ray: &Sheared,
    stack: &mut [u64],
    count: &mut C,
) -> Hit {
    let (boxes, triangles) = (ray.splat::<S::Float8>(), ray.splat::<S::Float4>());
    let upper = ray.near.upper();
    let mut best = Hit { t: ray.ray.t_max, ..Hit::MISS };
    let mut free = 1;
    stack[0] = entry(0.0, Child::node(0));
    while free > 0 {
        free -= 1;
        let (t_near, child) = (f32::from_bits((stack[free] >> 32) as u32), Child::from_bits(stack[free] as u32));
        // What the ray enters behind its hit so far is passed over.
        if t_near > best.t {
            continue;
        }
        if child.is_leaf() {
            let (first, end) = child.groups();
            for group in &vertices.groups[first..end] {
                count.triangle_test();
                closest(group, ray, &triangles, &mut best, count);
            }
            if !Q::CLOSEST && !best.is_miss() {
                break;
            }
        } else if let Some(node) = bvh.nodes.get(child.index()) {
            count.box_test();
            push(node, upper, (&boxes, ray.ray.t_min, best.t), stack, &mut free);
        }
    }
    best
}

/// Puts the children that the ray meets on the stack, the nearest on top.
#[inline(always)]
fn push<F: Float>(
    node: &WideNode<N>,
    upper: [usize; 3],
    (boxes, from, to): (&Lanes<F>, f32, f32),
    stack: &mut [u64],
    free: &mut usize,
) {
    let plane = |i: usize| F::load(&node.planes[i]);
    let [x, y, z] = upper;
    let near = Vec3 { x: plane(x), y: plane(1 + y), z: plane(2 + z) };
    let far = Vec3 { x: plane(3 - x), y: plane(4 - y), z: plane(5 - z) };
    let (t_near, t_far) = boxes.interval(near, far, F::splat(from), F::splat(to));
    let mut bits = t_near.le(t_far).bitmask();
    let t_near = t_near.to_block();
    let bottom = *free;
    assert!(bottom + N <= stack.len(), "the stack has room for the children of every node on the way");
    while bits != 0 {
        let i = bits.trailing_zeros() as usize % N;
        bits &= bits - 1;
        let new = entry(t_near.0[i], node.children[i]);
        let mut at = *free;
        while at > bottom && stack[at - 1] < new {
            stack[at] = stack[at - 1];
            at -= 1;
        }
        stack[at] = new;
        *free += 1;
    }
}

/// The closest hit among a group of triangles, if it is closer than what there is; the lower id wins at equal distance.
#[inline(always)]
fn closest<F: Float, C: Count>(group: &VertexGroup, ray: &Sheared, lanes: &Lanes<F>, best: &mut Hit, count: &mut C) {
    let Some(hit) = intersect(group, ray, lanes, best.t) else { return };
    let mut bits = hit.mask.bitmask();
    if bits == 0 {
        return;
    }
    count.triangle_hit();
    let (t, u, v) = (hit.t.to_block(), hit.u.to_block(), hit.v.to_block());
    while bits != 0 {
        let i = bits.trailing_zeros() as usize % group.id.len();
        bits &= bits - 1;
        let primitive = group.id[i];
        if t.0[i] < best.t || (t.0[i] == best.t && primitive < best.primitive) {
            *best = Hit { t: t.0[i], u: u.0[i], v: v.0[i], primitive };
        }
    }
}
