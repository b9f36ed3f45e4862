//! Twice the lanes from two vectors: every width that a backend does not have natively.

use crate::backend::{check_bounds, list_lanes};
use crate::vector::check_masked;
use crate::vector::sealed::{List, Sealed};
use crate::{Block, Double, Float, Halves, Int, Integer, Mask, Uint, Vector};
use std::fmt;
use std::ops::*;

mod narrow;

/// The lower and the upper half of a vector of twice the lanes.
#[derive(Clone, Copy, Default, PartialEq)]
pub struct Pair<V>(pub(crate) V, pub(crate) V);

impl<V> Sealed for Pair<V> {}

impl<V: List> List for Pair<V> {
    fn list(&self, list: &mut fmt::DebugList<'_, '_>) {
        self.0.list(list);
        self.1.list(list);
    }
}
list_lanes!([V: List] Pair<V>);

macro_rules! operators {
    ($($Op:ident $op:ident $OpAssign:ident $op_assign:ident),*) => {$(
        impl<V: $Op<Output = V>> $Op for Pair<V> {
            type Output = Self;
            #[inline(always)]
            fn $op(self, other: Self) -> Self {
                Self(self.0.$op(other.0), self.1.$op(other.1))
            }
        }
        impl<V: $OpAssign> $OpAssign for Pair<V> {
            #[inline(always)]
            fn $op_assign(&mut self, other: Self) {
                self.0.$op_assign(other.0);
                self.1.$op_assign(other.1);
            }
        }
    )*};
}
operators!(
    Add add AddAssign add_assign, Sub sub SubAssign sub_assign, Mul mul MulAssign mul_assign, Div div DivAssign div_assign,
    BitAnd bitand BitAndAssign bitand_assign, BitOr bitor BitOrAssign bitor_assign, BitXor bitxor BitXorAssign bitxor_assign
);

impl<V: Neg<Output = V>> Neg for Pair<V> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl<V: Not<Output = V>> Not for Pair<V> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0, !self.1)
    }
}

impl<V: Shl<usize, Output = V>> Shl<usize> for Pair<V> {
    type Output = Self;
    #[inline(always)]
    fn shl(self, n: usize) -> Self {
        Self(self.0 << n, self.1 << n)
    }
}

impl<V: Shr<usize, Output = V>> Shr<usize> for Pair<V> {
    type Output = Self;
    #[inline(always)]
    fn shr(self, n: usize) -> Self {
        Self(self.0 >> n, self.1 >> n)
    }
}

impl<M: Mask> Mask for Pair<M> {
    const LANES: usize = 2 * M::LANES;

    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self(M::splat(value), M::splat(value))
    }
    #[inline(always)]
    fn from_bitmask(bits: u32) -> Self {
        Self(M::from_bitmask(bits), M::from_bitmask(bits >> M::LANES))
    }
    #[inline(always)]
    fn bitmask(self) -> u32 {
        self.0.bitmask() | self.1.bitmask() << M::LANES
    }
    #[inline(always)]
    fn any(self) -> bool {
        (self.0 | self.1).any()
    }
    #[inline(always)]
    fn all(self) -> bool {
        (self.0 & self.1).all()
    }
}

impl<V: Vector> Vector for Pair<V> {
    type Lane = V::Lane;
    type Mask = Pair<V::Mask>;
    type Index = Pair<V::Index>;
    const LANES: usize = 2 * V::LANES;

    #[inline(always)]
    fn splat(x: V::Lane) -> Self {
        Self(V::splat(x), V::splat(x))
    }
    #[inline(always)]
    fn load(src: &[V::Lane]) -> Self {
        let src = &src[..Self::LANES];
        Self(V::load(src), V::load(&src[V::LANES..]))
    }
    #[inline(always)]
    fn store(self, dst: &mut [V::Lane]) {
        let dst = &mut dst[..Self::LANES];
        self.0.store(dst);
        self.1.store(&mut dst[V::LANES..]);
    }
    #[inline(always)]
    fn load_partial(src: &[V::Lane]) -> Self {
        Self(V::load_partial(src), V::load_partial(src.get(V::LANES..).unwrap_or_default()))
    }
    #[inline(always)]
    fn store_partial(self, dst: &mut [V::Lane]) {
        self.0.store_partial(dst);
        self.1.store_partial(dst.get_mut(V::LANES..).unwrap_or_default());
    }
    #[inline(always)]
    fn load_masked(src: &[V::Lane], mask: Self::Mask, or: Self) -> Self {
        let upper = src.get(V::LANES..).unwrap_or_default();
        Self(V::load_masked(src, mask.0, or.0), V::load_masked(upper, mask.1, or.1))
    }
    #[inline(always)]
    fn store_masked(self, dst: &mut [V::Lane], mask: Self::Mask) {
        check_masked(dst.len(), mask);
        self.0.store_masked(dst, mask.0);
        self.1.store_masked(dst.get_mut(V::LANES..).unwrap_or_default(), mask.1);
    }
    #[inline(always)]
    fn load_block(block: &Block<V::Lane>, chunk: usize) -> Self {
        assert!(chunk < 16 / Self::LANES, "chunk {chunk} of a block");
        Self(V::load_block(block, 2 * chunk), V::load_block(block, 2 * chunk + 1))
    }
    #[inline(always)]
    fn store_block(self, block: &mut Block<V::Lane>, chunk: usize) {
        assert!(chunk < 16 / Self::LANES, "chunk {chunk} of a block");
        self.0.store_block(block, 2 * chunk);
        self.1.store_block(block, 2 * chunk + 1);
    }
    #[inline(always)]
    fn gather(src: &[V::Lane], index: Self::Index) -> Self {
        Self(V::gather(src, index.0), V::gather(src, index.1))
    }
    #[inline(always)]
    fn gather_masked(src: &[V::Lane], index: Self::Index, mask: Self::Mask, or: Self) -> Self {
        Self(V::gather_masked(src, index.0, mask.0, or.0), V::gather_masked(src, index.1, mask.1, or.1))
    }
    #[inline(always)]
    fn scatter_masked(self, dst: &mut [V::Lane], index: Self::Index, mask: Self::Mask) {
        check_bounds::<Self>(dst.len(), index, mask);
        self.0.scatter_masked(dst, index.0, mask.0);
        self.1.scatter_masked(dst, index.1, mask.1);
    }
    #[inline(always)]
    fn stream(dst: &mut [Block<V::Lane>], mut f: impl FnMut(usize) -> Self) {
        let mut upper = V::default();
        V::stream(dst, |i| {
            if i % 2 == 0 {
                let both = f(i / 2);
                upper = both.1;
                both.0
            } else {
                upper
            }
        });
    }
    #[inline(always)]
    fn load_rows3(rows: &[[V::Lane; 3]]) -> [Self; 3] {
        let rows = &rows[..Self::LANES];
        let (lo, hi) = (V::load_rows3(rows), V::load_rows3(&rows[V::LANES..]));
        [Self(lo[0], hi[0]), Self(lo[1], hi[1]), Self(lo[2], hi[2])]
    }
    #[inline(always)]
    fn store_rows3([a, b, c]: [Self; 3], rows: &mut [[V::Lane; 3]]) {
        let rows = &mut rows[..Self::LANES];
        V::store_rows3([a.0, b.0, c.0], rows);
        V::store_rows3([a.1, b.1, c.1], &mut rows[V::LANES..]);
    }
    #[inline(always)]
    fn load_rows4(rows: &[[V::Lane; 4]]) -> [Self; 4] {
        let rows = &rows[..Self::LANES];
        let (lo, hi) = (V::load_rows4(rows), V::load_rows4(&rows[V::LANES..]));
        [Self(lo[0], hi[0]), Self(lo[1], hi[1]), Self(lo[2], hi[2]), Self(lo[3], hi[3])]
    }
    #[inline(always)]
    fn store_rows4(columns: [Self; 4], rows: &mut [[V::Lane; 4]]) {
        let rows = &mut rows[..Self::LANES];
        let [a, b, c, d] = columns;
        V::store_rows4([a.0, b.0, c.0, d.0], rows);
        V::store_rows4([a.1, b.1, c.1, d.1], &mut rows[V::LANES..]);
    }
    #[inline(always)]
    fn transpose(rows: &mut [Self]) {
        let n = V::LANES;
        assert!(rows.len() == 2 * n, "transpose: {} vectors of {} lanes", rows.len(), 2 * n);
        // A quarter at a time, with fewer shuffles and registers than the whole; those off the diagonal change places.
        let [mut a, mut b, mut c, mut d] = [[V::default(); 8]; 4];
        for i in 0..n {
            (a[i], b[i]) = (rows[i].0, rows[i].1);
            (c[i], d[i]) = (rows[i + n].0, rows[i + n].1);
        }
        V::transpose(&mut a[..n]);
        V::transpose(&mut b[..n]);
        V::transpose(&mut c[..n]);
        V::transpose(&mut d[..n]);
        for i in 0..n {
            (rows[i], rows[i + n]) = (Self(a[i], c[i]), Self(b[i], d[i]));
        }
    }
    #[inline(always)]
    fn select(mask: Self::Mask, on_true: Self, on_false: Self) -> Self {
        Self(V::select(mask.0, on_true.0, on_false.0), V::select(mask.1, on_true.1, on_false.1))
    }
    #[inline(always)]
    fn eq(self, other: Self) -> Self::Mask {
        Pair(self.0.eq(other.0), self.1.eq(other.1))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        Pair(self.0.lt(other.0), self.1.lt(other.1))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        Pair(self.0.le(other.0), self.1.le(other.1))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(self.0.min(other.0), self.1.min(other.1))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(self.0.max(other.0), self.1.max(other.1))
    }
    #[inline(always)]
    fn lookup(self, index: Self::Index) -> Self {
        let upper = V::Index::splat(V::LANES as u32);
        let half = |index: V::Index| {
            let in_lower = (index & upper).eq(V::Index::default());
            V::select(in_lower, self.0.lookup(index), self.1.lookup(index))
        };
        Self(half(index.0), half(index.1))
    }
    #[inline(always)]
    fn interleave(self, other: Self) -> (Self, Self) {
        let (a, b) = (self.0.interleave(other.0), self.1.interleave(other.1));
        (Self(a.0, a.1), Self(b.0, b.1))
    }
    #[inline(always)]
    fn deinterleave(self, other: Self) -> (Self, Self) {
        let (a, b) = (self.0.deinterleave(self.1), other.0.deinterleave(other.1));
        (Self(a.0, b.0), Self(a.1, b.1))
    }
    #[inline(always)]
    fn compress(self, mask: Self::Mask) -> Self {
        let mut block = Block::default();
        self.0.compress(mask.0).store(&mut block.0);
        let n = mask.0.count() % 16;
        self.1.compress(mask.1).store(&mut block.0[n..]);
        Self::load_block(&block, 0)
    }
    #[inline(always)]
    fn reduce_min(self) -> V::Lane {
        self.0.min(self.1).reduce_min()
    }
    #[inline(always)]
    fn reduce_max(self) -> V::Lane {
        self.0.max(self.1).reduce_max()
    }
}

impl<V: Vector> Halves for Pair<V> {
    type Half = V;

    #[inline(always)]
    fn from_halves(low: V, high: V) -> Self {
        Self(low, high)
    }
    #[inline(always)]
    fn low(self) -> V {
        self.0
    }
    #[inline(always)]
    fn high(self) -> V {
        self.1
    }
}

macro_rules! lanewise {
    ($($name:ident($($arg:ident),*);)*) => {$(
        #[inline(always)]
        fn $name(self $(, $arg: Self)*) -> Self {
            Self(self.0.$name($($arg.0),*), self.1.$name($($arg.1),*))
        }
    )*};
}

impl<V: Float> Float for Pair<V> {
    type Int = Pair<V::Int>;

    lanewise! {
        abs(); copysign(sign); sqrt(); floor(); ceil(); trunc(); round();
        mul_add(b, c); mul_sub(b, c); neg_mul_add(b, c); neg_mul_sub(b, c); mul_add_exact(b, c); product_error(b, product);
        rcp_approx(); rsqrt_approx();
    }
    #[inline(always)]
    fn load_f16(src: &[u16]) -> Self {
        let src = &src[..Self::LANES];
        Self(V::load_f16(src), V::load_f16(&src[V::LANES..]))
    }
    #[inline(always)]
    fn store_f16(self, dst: &mut [u16]) {
        let dst = &mut dst[..Self::LANES];
        self.0.store_f16(dst);
        self.1.store_f16(&mut dst[V::LANES..]);
    }
    #[inline(always)]
    fn reduce_mul(self) -> f32 {
        (self.0 * self.1).reduce_mul()
    }
    #[inline(always)]
    fn to_int(self) -> Self::Int {
        Pair(self.0.to_int(), self.1.to_int())
    }
    #[inline(always)]
    fn to_uint(self) -> Self::Index {
        Pair(self.0.to_uint(), self.1.to_uint())
    }
    #[inline(always)]
    fn from_int(x: Self::Int) -> Self {
        Self(V::from_int(x.0), V::from_int(x.1))
    }
    #[inline(always)]
    fn from_uint(x: Self::Index) -> Self {
        Self(V::from_uint(x.0), V::from_uint(x.1))
    }
    #[inline(always)]
    fn to_bits(self) -> Self::Index {
        Pair(self.0.to_bits(), self.1.to_bits())
    }
    #[inline(always)]
    fn from_bits(x: Self::Index) -> Self {
        Self(V::from_bits(x.0), V::from_bits(x.1))
    }
    #[inline(always)]
    fn reduce_add(self) -> f32 {
        (self.0 + self.1).reduce_add()
    }
}

impl<V: Double> Double for Pair<V> {
    lanewise! {
        abs(); copysign(sign); sqrt(); floor(); ceil(); trunc(); round();
        mul_add(b, c); mul_sub(b, c); neg_mul_add(b, c); neg_mul_sub(b, c); mul_add_exact(b, c);
    }
    #[inline(always)]
    fn reduce_add(self) -> f64 {
        (self.0 + self.1).reduce_add()
    }
    #[inline(always)]
    fn reduce_mul(self) -> f64 {
        (self.0 * self.1).reduce_mul()
    }
}

impl<V: Integer> Integer for Pair<V>
where
    Pair<V::Index>: Uint<Mask = Pair<V::Mask>>,
{
    #[inline(always)]
    fn shl_lanes(self, n: Self::Index) -> Self {
        Self(self.0.shl_lanes(n.0), self.1.shl_lanes(n.1))
    }
    #[inline(always)]
    fn shr_lanes(self, n: Self::Index) -> Self {
        Self(self.0.shr_lanes(n.0), self.1.shr_lanes(n.1))
    }
    #[inline(always)]
    fn reduce_add(self) -> V::Lane {
        (self.0 + self.1).reduce_add()
    }
    #[inline(always)]
    fn reduce_mul(self) -> V::Lane {
        (self.0 * self.1).reduce_mul()
    }
}

impl<V: Int> Int for Pair<V> {
    lanewise! { abs(); mul_high(other); }
    #[inline(always)]
    fn to_uint(self) -> Self::Index {
        Pair(self.0.to_uint(), self.1.to_uint())
    }
    #[inline(always)]
    fn from_uint(x: Self::Index) -> Self {
        Self(V::from_uint(x.0), V::from_uint(x.1))
    }
}

impl<V: Uint> Uint for Pair<V> {
    lanewise! { mul_high(other); count_ones(); leading_zeros(); trailing_zeros(); }
}
