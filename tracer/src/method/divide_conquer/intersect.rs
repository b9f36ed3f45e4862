//! Rays against triangles where nothing is divided any further (section 3.3).

use super::rays::{Active, BUFFER, id, packet};
use crate::geometry::moller_trumbore::intersect_mixed;
use crate::geometry::{Hit, Triangle};
use crate::lanes::Lanes;
use simd::{Float, Mask};

/// The first `len` rays against all triangles; returns how many tests had a hit.
///
/// The paper's outer loop is over triangles. Here it is over rays: they are put into columns once, and triangles were decoded before.
pub(super) struct Intersect<'a, A> {
    pub(super) rays: &'a mut A,
    pub(super) len: usize,
    pub(super) triangles: &'a [Triangle],
    /// No ray starts before.
    pub(super) from: f32,
    /// Where each ray starts; empty when all start at `from`.
    pub(super) starts: &'a [f32],
    /// Best hits, by the ray's number.
    pub(super) found: &'a mut [Hit],
    /// A ray that has a hit looks for nothing more.
    pub(super) any: bool,
}

impl<A: Active> Lanes for Intersect<'_, A> {
    type Output = u64;

    #[inline(always)]
    fn run<F: Float>(self) -> u64 {
        let Self { rays, len, triangles, from, starts, found, any } = self;
        let mut buffer = BUFFER;
        let (mut at, mut tests_hit) = (0, 0);
        while at < len {
            let n = F::LANES.min(len - at);
            let rows = rays.load::<F>(at, n, &mut buffer);
            let mut ray = packet::<F>(rows, F::splat(from));
            let mut changed = 0_u32;
            for triangle in triangles {
                let Some(hits) = intersect_mixed(triangle, &ray) else { continue };
                let candidates = super::rays::bits::<F>(hits.mask, n);
                if candidates == 0 {
                    continue;
                }
                tests_hit += 1;
                let nearer = hits.t.lt(ray.t_max).bitmask();
                let (t, u, v) = (hits.t.to_block(), hits.u.to_block(), hits.v.to_block());
                let (mut rest, mut better) = (candidates, 0);
                while rest != 0 {
                    let lane = rest.trailing_zeros() as usize % 16;
                    rest &= rest - 1;
                    let number = id(&rows[lane]);
                    let hit = Hit { t: t.0[lane], u: u.0[lane], v: v.0[lane], primitive: triangle.id };
                    if !starts.is_empty() && hit.t < starts[number] {
                        continue;
                    }
                    // At equal distance the lower id wins.
                    if nearer >> lane & 1 != 0 || hit.primitive < found[number].primitive {
                        found[number] = hit;
                        better |= 1 << lane;
                    }
                }
                // Not by way of memory, where hits may still wait to be written.
                let end = if any { F::splat(f32::NEG_INFINITY) } else { hits.t };
                ray.t_max = F::select(F::Mask::from_bitmask(better), end, ray.t_max);
                changed |= better;
            }
            let ends = ray.t_max.to_block();
            while changed != 0 {
                let lane = changed.trailing_zeros() as usize % 16;
                changed &= changed - 1;
                rays.shorten(at + lane, ends.0[lane]);
            }
            at += n;
        }
        tests_hit
    }
}
