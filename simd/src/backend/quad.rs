//! Four `f64` in the registers of a level: what their vectors share. A backend says what its instructions are in [`Quad`].
//!
//! Their masks and indices are those of four 32-bit lanes: a mask is widened where it chooses, and narrowed where it is found.

use super::{check_bounds, list_lanes, vector_basics};
use crate::pair::Pair;
use crate::vector::sealed::{List, Sealed};
use crate::{Block, Double, Halves, Mask, Uint, Vector};
use std::fmt;
use std::ops::*;

/// The registers of four `f64`, and what is one instruction or two for them. As [`Double`] and [`Vector`] say of each lane.
pub trait Quad: Copy + Send + Sync + 'static {
    type Mask: Mask;
    type Index: Uint<Mask = Self::Mask>;

    fn splat(x: f64) -> Self;
    fn load(src: &[f64; 4]) -> Self;
    fn store(self, dst: &mut [f64; 4]);
    fn select(mask: Self::Mask, on_true: Self, on_false: Self) -> Self;
    fn eq(self, other: Self) -> Self::Mask;
    fn lt(self, other: Self) -> Self::Mask;
    fn le(self, other: Self) -> Self::Mask;
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    fn add(self, other: Self) -> Self;
    fn sub(self, other: Self) -> Self;
    fn mul(self, other: Self) -> Self;
    fn div(self, other: Self) -> Self;
    /// The bits that are on in one and not in the other.
    fn xor(self, other: Self) -> Self;
    /// The bits that are on in both.
    fn and(self, other: Self) -> Self;
    fn sqrt(self) -> Self;
    fn floor(self) -> Self;
    fn ceil(self) -> Self;
    fn trunc(self) -> Self;
    fn round(self) -> Self;
    fn mul_add(self, b: Self, c: Self) -> Self;
    fn neg_mul_add(self, b: Self, c: Self) -> Self;
    fn mul_add_exact(self, b: Self, c: Self) -> Self;

    /// Each lane by itself.
    #[inline(always)]
    fn each(self, f: impl Fn(f64) -> f64) -> Self {
        let [a, b, c, d] = lanes(self);
        Self::load(&[f(a), f(b), f(c), f(d)])
    }
}

#[inline(always)]
pub(super) fn lanes<Q: Quad>(x: Q) -> [f64; 4] {
    let mut lanes = [0.0; 4];
    x.store(&mut lanes);
    lanes
}

/// Four `f64`.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct Double4<Q>(Q);

vector_basics!([Q: Quad] Double4<Q>);

/// Bit 63.
#[inline(always)]
fn sign<Q: Quad>() -> Q {
    Q::splat(-0.0)
}

macro_rules! operators {
    ($($Op:ident $op:ident $OpAssign:ident $op_assign:ident;)*) => {$(
        impl<Q: Quad> $Op for Double4<Q> {
            type Output = Self;
            #[inline(always)]
            fn $op(self, other: Self) -> Self {
                Self(self.0.$op(other.0))
            }
        }
        impl<Q: Quad> $OpAssign for Double4<Q> {
            #[inline(always)]
            fn $op_assign(&mut self, other: Self) {
                *self = self.$op(other);
            }
        }
    )*};
}
operators! {
    Add add AddAssign add_assign;
    Sub sub SubAssign sub_assign;
    Mul mul MulAssign mul_assign;
    Div div DivAssign div_assign;
}

impl<Q: Quad> Neg for Double4<Q> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(self.0.xor(sign()))
    }
}

impl<Q: Quad> Double4<Q> {
    #[inline(always)]
    fn of([a, b, c, d]: [f64; 4]) -> Self {
        Self(Q::load(&[a, b, c, d]))
    }

    #[inline(always)]
    fn fold(self, op: impl Fn(f64, f64) -> f64) -> f64 {
        let [a, b, c, d] = lanes(self.0);
        op(op(a, c), op(b, d))
    }
}

impl<Q: Quad> Vector for Double4<Q> {
    type Lane = f64;
    type Mask = Q::Mask;
    type Index = Q::Index;
    const LANES: usize = 4;

    #[inline(always)]
    fn splat(x: f64) -> Self {
        Self(Q::splat(x))
    }
    #[inline(always)]
    fn load(src: &[f64]) -> Self {
        Self(Q::load(&src[..4].as_chunks().0[0]))
    }
    #[inline(always)]
    fn store(self, dst: &mut [f64]) {
        self.0.store(&mut dst[..4].as_chunks_mut().0[0]);
    }
    #[inline(always)]
    fn load_block(block: &Block<f64>, chunk: usize) -> Self {
        Self(Q::load(&block.0.as_chunks().0[chunk]))
    }
    #[inline(always)]
    fn store_block(self, block: &mut Block<f64>, chunk: usize) {
        self.0.store(&mut block.0.as_chunks_mut().0[chunk]);
    }
    #[inline(always)]
    fn gather_masked(src: &[f64], index: Q::Index, mask: Q::Mask, or: Self) -> Self {
        check_bounds::<Self>(src.len(), index, mask);
        let (index, mut lanes) = (index.to_block(), lanes(or.0));
        for lane in mask.set_lanes() {
            lanes[lane % 4] = src[index.0[lane] as usize];
        }
        Self::of(lanes)
    }
    #[inline(always)]
    fn load_rows4(rows: &[[f64; 4]]) -> [Self; 4] {
        let [a, b, c, d] = rows[..4].as_chunks::<4>().0[0];
        let column = |k: usize| Self::of([a[k], b[k], c[k], d[k]]);
        [column(0), column(1), column(2), column(3)]
    }
    #[inline(always)]
    fn store_rows4([a, b, c, d]: [Self; 4], rows: &mut [[f64; 4]]) {
        let (a, b, c, d) = (lanes(a.0), lanes(b.0), lanes(c.0), lanes(d.0));
        for (k, row) in rows[..4].iter_mut().enumerate() {
            *row = [a[k], b[k], c[k], d[k]];
        }
    }
    #[inline(always)]
    fn select(mask: Q::Mask, on_true: Self, on_false: Self) -> Self {
        Self(Q::select(mask, on_true.0, on_false.0))
    }
    #[inline(always)]
    fn eq(self, other: Self) -> Q::Mask {
        self.0.eq(other.0)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Q::Mask {
        self.0.lt(other.0)
    }
    #[inline(always)]
    fn le(self, other: Self) -> Q::Mask {
        self.0.le(other.0)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0))
    }
    #[inline(always)]
    fn interleave(self, other: Self) -> (Self, Self) {
        let ([a, b, c, d], [e, f, g, h]) = (lanes(self.0), lanes(other.0));
        (Self::of([a, e, b, f]), Self::of([c, g, d, h]))
    }
    #[inline(always)]
    fn deinterleave(self, other: Self) -> (Self, Self) {
        let ([a, b, c, d], [e, f, g, h]) = (lanes(self.0), lanes(other.0));
        (Self::of([a, c, e, g]), Self::of([b, d, f, h]))
    }
    #[inline(always)]
    fn reduce_min(self) -> f64 {
        self.fold(Vector::min)
    }
    #[inline(always)]
    fn reduce_max(self) -> f64 {
        self.fold(Vector::max)
    }
}

impl<Q: Quad> Halves for Double4<Q> {
    type Half = Pair<f64>;

    #[inline(always)]
    fn from_halves(Pair(a, b): Pair<f64>, Pair(c, d): Pair<f64>) -> Self {
        Self::of([a, b, c, d])
    }
    #[inline(always)]
    fn low(self) -> Pair<f64> {
        let [a, b, ..] = lanes(self.0);
        Pair(a, b)
    }
    #[inline(always)]
    fn high(self) -> Pair<f64> {
        let [.., c, d] = lanes(self.0);
        Pair(c, d)
    }
}

impl<Q: Quad> Double for Double4<Q> {
    #[inline(always)]
    fn abs(self) -> Self {
        Self(self.0.and(Q::splat(f64::from_bits(u64::MAX >> 1))))
    }
    #[inline(always)]
    fn copysign(self, other: Self) -> Self {
        Self(self.0.xor(self.0.xor(other.0).and(sign())))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self(self.0.floor())
    }
    #[inline(always)]
    fn ceil(self) -> Self {
        Self(self.0.ceil())
    }
    #[inline(always)]
    fn trunc(self) -> Self {
        Self(self.0.trunc())
    }
    #[inline(always)]
    fn round(self) -> Self {
        Self(self.0.round())
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self(self.0.mul_add(b.0, c.0))
    }
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        self.mul_add(b, -c)
    }
    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        Self(self.0.neg_mul_add(b.0, c.0))
    }
    #[inline(always)]
    fn mul_add_exact(self, b: Self, c: Self) -> Self {
        Self(self.0.mul_add_exact(b.0, c.0))
    }
    #[inline(always)]
    fn reduce_add(self) -> f64 {
        self.fold(|a, b| a + b)
    }
    #[inline(always)]
    fn reduce_mul(self) -> f64 {
        self.fold(|a, b| a * b)
    }
}

/// `mul_add_exact` where no instruction does it.
#[inline(always)]
#[allow(dead_code, reason = "there are architectures that always have it")]
pub(super) fn mul_add_each<Q: Quad>(a: Q, b: Q, c: Q) -> Q {
    let (a, b, c) = (lanes(a), lanes(b), lanes(c));
    let lane = |i: usize| super::soft::mul_add_double(a[i], b[i], c[i]);
    Q::load(&[lane(0), lane(1), lane(2), lane(3)])
}
