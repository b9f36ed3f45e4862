//! The children of a node, as many rays together see them.

use super::bounds::Interval;
use super::tile::N;
use crate::bvh::WideNode;
use crate::geometry::Vec3;
use simd::{Float, Mask};

/// Sum of the sides of the box around the children.
#[inline(always)]
pub(super) fn size(node: &WideNode<N>) -> f32 {
    let mut size = 0.0;
    for axis in 0..3 {
        let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
        for i in 0..N {
            let (a, b) = (node.planes[axis][i], node.planes[axis + 3][i]);
            low = if a < low { a } else { low };
            high = if b > high { b } else { high };
        }
        size += high - low;
    }
    size
}

/// Near and far planes of child `i` in every lane.
#[inline(always)]
pub(super) fn planes<F: Float>(node: &WideNode<N>, [x, y, z]: [usize; 3], i: usize) -> (Vec3<F>, Vec3<F>) {
    let p = &node.planes;
    (Vec3::splat([p[x][i], p[1 + y][i], p[2 + z][i]]), Vec3::splat([p[3 - x][i], p[4 - y][i], p[5 - z][i]]))
}

/// The children whose boxes touch a box.
#[inline(always)]
pub(super) fn near_to<F: Float>(node: &WideNode<N>, [x, y, z]: &[[f32; 2]; 3]) -> u32 {
    let p = &node.planes;
    let x = F::load(&p[0]).le(F::splat(x[1])) & F::splat(x[0]).le(F::load(&p[3]));
    let y = F::load(&p[1]).le(F::splat(y[1])) & F::splat(y[0]).le(F::load(&p[4]));
    let z = F::load(&p[2]).le(F::splat(z[1])) & F::splat(z[0]).le(F::load(&p[5]));
    (x & y & z).bitmask()
}

/// Which boxes any of the rays may meet, and where the first may enter them.
#[inline(always)]
pub(super) fn meet<F: Float>(
    node: &WideNode<N>,
    [x, y, z]: [usize; 3],
    rays: &Interval<F>,
    reach: f32,
) -> (F, F::Mask) {
    let p = &node.planes;
    let near = Vec3 { x: F::load(&p[x]), y: F::load(&p[1 + y]), z: F::load(&p[2 + z]) };
    let far = Vec3 { x: F::load(&p[3 - x]), y: F::load(&p[4 - y]), z: F::load(&p[5 - z]) };
    let (t_near, t_far) = rays.between(near, far, F::splat(reach));
    (t_near, t_near.le(t_far))
}

/// Sum of the sides of the box of child `i`.
#[inline(always)]
pub(super) fn child_size(node: &WideNode<N>, i: usize) -> f32 {
    let p = &node.planes;
    (p[3][i] - p[0][i]) + (p[4][i] - p[1][i]) + (p[5][i] - p[2][i])
}
