//! Which rays meet a box (section 3.1), and bringing those to the front.

use super::rays::{Active, BUFFER, Row, T_MAX, bits, id, load, meets};
use crate::lanes::SimdLanes;
use simd::{Float, Mask, Simd, Vector};
use std::sync::atomic::{AtomicU32, Ordering};

/// Moves the rays among the first `len` that meet the box to the front, and returns their number.
///
/// A ray is a row of 32 bytes: one exchange moves it. To compress columns of a vector of rays into memory instead (AVX-512) takes a store for each of eight
/// columns, and each row twice through a transpose.
pub(super) struct Filter<'a, A> {
    pub(super) rays: &'a mut A,
    pub(super) len: usize,
    /// `min x y z _ max x y z _`.
    pub(super) planes: [f32; 8],
    /// No ray starts before.
    pub(super) from: f32,
}

impl<A: Active> SimdLanes for Filter<'_, A> {
    type Output = usize;

    #[inline(always)]
    fn run<S: Simd, F: Float>(self) -> usize {
        let Self { rays, len, planes, from, .. } = self;
        let mut buffer = BUFFER;
        let (mut at, mut active) = (0, 0);
        while at < len {
            let n = F::LANES.min(len - at);
            let met = bits::<F>(meets::<F>(rays.load::<F>(at, n, &mut buffer), &planes, from), n);
            if met == ((1_u64 << n) - 1) as u32 && active == at {
                active += n;
            } else {
                let mut rest = met;
                while rest != 0 {
                    rays.swap::<S>(at + rest.trailing_zeros() as usize, active);
                    rest &= rest - 1;
                    active += 1;
                }
            }
            at += n;
        }
        active
    }
}

/// Copies the rays that meet the box, and returns their number.
pub(super) struct Copy<'a> {
    pub(super) rows: &'a [Row],
    /// As many.
    pub(super) to: &'a mut [Row],
    /// Where rays end by now, by number, as bits; empty where that is known.
    pub(super) ends: &'a [AtomicU32],
    /// `min x y z _ max x y z _`.
    pub(super) planes: [f32; 8],
    /// No ray starts before.
    pub(super) from: f32,
}

impl SimdLanes for Copy<'_> {
    type Output = usize;

    #[inline(always)]
    fn run<S: Simd, F: Float>(self) -> usize {
        let Self { rows, to, ends, planes, from, .. } = self;
        let (mut at, mut active) = (0, 0);
        while at < rows.len() {
            let n = F::LANES.min(rows.len() - at);
            let mut buffer = BUFFER;
            let mut rest = bits::<F>(meets::<F>(load::<F>(rows, at, n, &mut buffer), &planes, from), n);
            while rest != 0 {
                let row = &rows[at + rest.trailing_zeros() as usize];
                rest &= rest - 1;
                let copy = &mut to[active];
                S::Float8::load(row).store(copy);
                if !ends.is_empty() {
                    copy[T_MAX] = f32::from_bits(ends[id(row)].load(Ordering::Relaxed));
                }
                active += 1;
            }
            at += n;
        }
        active
    }
}

/// The part of the first `len` rays that meets the box, by a sample of them; they stay where they are.
pub(super) struct Sample<'a, A> {
    pub(super) rays: &'a A,
    pub(super) len: usize,
    /// `min x y z _ max x y z _`.
    pub(super) planes: [f32; 8],
    /// No ray starts before.
    pub(super) from: f32,
}

impl<A: Active> Sample<'_, A> {
    /// How many rays are looked at.
    const SIZE: usize = 256;
    /// A sample of less costs as much as it saves.
    pub(super) const LEAST: usize = 16 * Self::SIZE;

    /// Box tests of a sample.
    pub(super) fn tests(lanes: usize) -> u64 {
        (Self::SIZE / lanes) as u64
    }
}

impl<A: Active> SimdLanes for Sample<'_, A> {
    type Output = f32;

    #[inline(always)]
    fn run<S: Simd, F: Float>(self) -> f32 {
        let Self { rays, len, planes, from, .. } = self;
        let mut buffer = BUFFER;
        let (chunks, mut met) = (Self::SIZE / F::LANES, 0);
        for i in 0..chunks {
            let at = i * ((len - F::LANES) / chunks);
            met += meets::<F>(rays.load::<F>(at, F::LANES, &mut buffer), &planes, from).bitmask().count_ones();
        }
        met as f32 / Self::SIZE as f32
    }
}
