//! What vectors of every lane type can do.

use super::sealed::{List, Sealed};
use super::{Lane, Mask, Uint};
use crate::Block;
use crate::backend::check_bounds;
use std::fmt::Debug;

/// What vectors of every lane type can do. All lanes are zero by default.
pub trait Vector: Sealed + List + Copy + Debug + Default + Send + Sync + 'static {
    /// Type of one lane.
    type Lane: Lane;
    /// The mask of this width.
    type Mask: Mask;
    /// The `u32` vector of this width: indices.
    type Index: Uint<Mask = Self::Mask>;
    /// Number of lanes.
    const LANES: usize;

    /// All lanes `x`.
    fn splat(x: Self::Lane) -> Self;

    /// The first [`Vector::LANES`] elements of `src`.
    ///
    /// # Panics
    /// If `src` is shorter.
    fn load(src: &[Self::Lane]) -> Self;

    /// Writes the first [`Vector::LANES`] elements of `dst`.
    ///
    /// # Panics
    /// If `dst` is shorter.
    fn store(self, dst: &mut [Self::Lane]);

    /// All of `src`, zeros in the lanes past its end; nothing past its end is read. Elements past [`Vector::LANES`] are left out.
    #[inline(always)]
    fn load_partial(src: &[Self::Lane]) -> Self {
        if src.len() >= Self::LANES {
            return Self::load(src);
        }
        let mut block = Block::default();
        for (to, from) in block.0[..Self::LANES].iter_mut().zip(src) {
            *to = *from;
        }
        Self::load_block(&block, 0)
    }

    /// Writes as many lanes as `dst` has room for.
    #[inline(always)]
    fn store_partial(self, dst: &mut [Self::Lane]) {
        if dst.len() >= Self::LANES {
            return self.store(dst);
        }
        for (to, from) in dst.iter_mut().zip(self.to_block().0) {
            *to = from;
        }
    }

    /// `src[i]` where the mask is true, `or` elsewhere; elements of lanes that are off need not exist.
    ///
    /// # Panics
    /// If `src` ends before a lane that is on.
    #[inline(always)]
    fn load_masked(src: &[Self::Lane], mask: Self::Mask, or: Self) -> Self {
        let mut block = or.to_block();
        for lane in mask.set_lanes() {
            block.0[lane] = src[lane];
        }
        Self::load_block(&block, 0)
    }

    /// Writes the lanes where the mask is true; the other elements stay and need not exist.
    ///
    /// # Panics
    /// If `dst` ends before a lane that is on; nothing is written then.
    #[inline(always)]
    fn store_masked(self, dst: &mut [Self::Lane], mask: Self::Mask) {
        check_masked(dst.len(), mask);
        let block = self.to_block();
        for lane in mask.set_lanes() {
            dst[lane] = block.0[lane];
        }
    }

    /// Aligned load of group `chunk` of the block: elements `chunk * LANES ..`.
    ///
    /// # Panics
    /// If `chunk >= 16 / LANES`.
    fn load_block(block: &Block<Self::Lane>, chunk: usize) -> Self;

    /// Aligned store of group `chunk` of the block: elements `chunk * LANES ..`.
    ///
    /// # Panics
    /// If `chunk >= 16 / LANES`.
    fn store_block(self, block: &mut Block<Self::Lane>, chunk: usize);

    /// Fills blocks with vectors, group after group (`f` is given their number), past the caches where the level can: for
    /// much memory that is not read again soon.
    ///
    /// ```
    /// use simd::{Block, Vector};
    /// let mut blocks = vec![Block([0.0_f32; 16]); 4];
    /// let dst = &mut blocks[..];
    /// simd::dispatch!(simd::Level::best(), |S, dst: &mut [Block<f32>]| {
    ///     S::Float::stream(dst, |i| S::Float::splat((i * S::Float::LANES) as f32));
    /// });
    /// assert_eq!(blocks[3].0[0], 48.0);
    /// ```
    #[inline(always)]
    fn stream(dst: &mut [Block<Self::Lane>], mut f: impl FnMut(usize) -> Self) {
        let per_block = 16 / Self::LANES;
        for i in 0..dst.len() * per_block {
            f(i).store_block(&mut dst[i / per_block], i % per_block);
        }
    }

    /// `src[index[i]]` for each lane.
    ///
    /// # Panics
    /// If an index is out of bounds (one comparison for the whole vector).
    #[inline(always)]
    fn gather(src: &[Self::Lane], index: Self::Index) -> Self {
        Self::gather_masked(src, index, Self::Mask::splat(true), Self::splat(Self::Lane::default()))
    }

    /// `src[index[i]]` where the mask is true, `or` elsewhere; indices of lanes that are off are not looked at.
    ///
    /// # Panics
    /// If the index of a lane that is on is out of bounds (one comparison for the whole vector).
    fn gather_masked(src: &[Self::Lane], index: Self::Index, mask: Self::Mask, or: Self) -> Self;

    /// `dst[index[i]] = self[i]` for each lane; of lanes with the same index the highest stays.
    ///
    /// # Panics
    /// If an index is out of bounds (one comparison for the whole vector); nothing is written then.
    #[inline(always)]
    fn scatter(self, dst: &mut [Self::Lane], index: Self::Index) {
        self.scatter_masked(dst, index, Self::Mask::splat(true));
    }

    /// [`Vector::scatter`] of the lanes where the mask is true; indices of the others are not looked at.
    ///
    /// # Panics
    /// If the index of a lane that is on is out of bounds (one comparison for the whole vector); nothing is written then.
    #[inline(always)]
    fn scatter_masked(self, dst: &mut [Self::Lane], index: Self::Index, mask: Self::Mask) {
        check_bounds::<Self>(dst.len(), index, mask);
        let (block, index) = (self.to_block(), index.to_block());
        for lane in mask.set_lanes() {
            dst[index.0[lane] as usize] = block.0[lane];
        }
    }

    /// Array of structures to structure of arrays: field `k` of the first [`Vector::LANES`] rows in vector `k`.
    ///
    /// # Panics
    /// If there are fewer rows.
    #[inline(always)]
    fn load_rows2(rows: &[[Self::Lane; 2]]) -> [Self; 2] {
        let flat = rows[..Self::LANES].as_flattened();
        let (even, odd) = Self::load(flat).deinterleave(Self::load(&flat[Self::LANES..]));
        [even, odd]
    }

    /// The inverse of [`Vector::load_rows2`].
    ///
    /// # Panics
    /// If there are fewer than [`Vector::LANES`] rows.
    #[inline(always)]
    fn store_rows2([a, b]: [Self; 2], rows: &mut [[Self::Lane; 2]]) {
        let flat = rows[..Self::LANES].as_flattened_mut();
        let (low, high) = a.interleave(b);
        low.store(flat);
        high.store(&mut flat[Self::LANES..]);
    }

    /// As [`Vector::load_rows2`], of three fields.
    ///
    /// # Panics
    /// If there are fewer rows.
    #[inline(always)]
    fn load_rows3(rows: &[[Self::Lane; 3]]) -> [Self; 3] {
        let mut columns = [Block::default(); 3];
        for (i, row) in rows[..Self::LANES].iter().enumerate() {
            for k in 0..3 {
                columns[k].0[i] = row[k];
            }
        }
        [Self::load_block(&columns[0], 0), Self::load_block(&columns[1], 0), Self::load_block(&columns[2], 0)]
    }

    /// The inverse of [`Vector::load_rows3`].
    ///
    /// # Panics
    /// If there are fewer than [`Vector::LANES`] rows.
    #[inline(always)]
    fn store_rows3([a, b, c]: [Self; 3], rows: &mut [[Self::Lane; 3]]) {
        let (a, b, c) = (a.to_block(), b.to_block(), c.to_block());
        for (i, row) in rows[..Self::LANES].iter_mut().enumerate() {
            *row = [a.0[i], b.0[i], c.0[i]];
        }
    }

    /// Array of structures to structure of arrays: field `k` of the first [`Vector::LANES`] rows in vector `k`.
    ///
    /// # Panics
    /// If there are fewer rows.
    fn load_rows4(rows: &[[Self::Lane; 4]]) -> [Self; 4];

    /// The inverse of [`Vector::load_rows4`].
    ///
    /// # Panics
    /// If there are fewer than [`Vector::LANES`] rows.
    fn store_rows4(columns: [Self; 4], rows: &mut [[Self::Lane; 4]]);

    /// As [`Vector::load_rows2`], of eight fields.
    ///
    /// # Panics
    /// If there are fewer rows.
    #[inline(always)]
    fn load_rows8(rows: &[[Self::Lane; 8]]) -> [Self; 8] {
        // Quads: the lower fields of a row, its upper fields, the lower ones of the next row, ...
        let quads = rows[..Self::LANES].as_flattened().as_chunks::<4>().0;
        let [a, b, c, d] = Self::load_rows4(quads);
        let [e, f, g, h] = Self::load_rows4(&quads[Self::LANES..]);
        let ((a, e), (b, f)) = (a.deinterleave(e), b.deinterleave(f));
        let ((c, g), (d, h)) = (c.deinterleave(g), d.deinterleave(h));
        [a, b, c, d, e, f, g, h]
    }

    /// The inverse of [`Vector::load_rows8`].
    ///
    /// # Panics
    /// If there are fewer than [`Vector::LANES`] rows.
    #[inline(always)]
    fn store_rows8([a, b, c, d, e, f, g, h]: [Self; 8], rows: &mut [[Self::Lane; 8]]) {
        let quads = rows[..Self::LANES].as_flattened_mut().as_chunks_mut::<4>().0;
        let ((a, e), (b, f)) = (a.interleave(e), b.interleave(f));
        let ((c, g), (d, h)) = (c.interleave(g), d.interleave(h));
        Self::store_rows4([a, b, c, d], quads);
        Self::store_rows4([e, f, g, h], &mut quads[Self::LANES..]);
    }

    /// Rows to columns of a square: lane `j` of vector `i` with lane `i` of vector `j`.
    ///
    /// # Panics
    /// If there are not [`Vector::LANES`] vectors.
    #[inline(always)]
    fn transpose(rows: &mut [Self]) {
        let n = Self::LANES;
        assert!(rows.len() == n, "transpose: {} vectors of {n} lanes", rows.len());
        // Each pass shuffles all lanes perfectly, as a deck of cards; log2(n) passes make the transpose.
        let mut pass = 1;
        while pass < n {
            let mut shuffled = [Self::default(); 16];
            for i in 0..n / 2 {
                (shuffled[2 * i], shuffled[2 * i + 1]) = rows[i].interleave(rows[i + n / 2]);
            }
            #[allow(
                clippy::manual_memcpy,
                reason = "a copy of slices becomes a call, and the vectors go through memory"
            )]
            for i in 0..n {
                rows[i] = shuffled[i];
            }
            pass *= 2;
        }
    }

    /// `on_true` where the mask is true, else `on_false`.
    #[doc(alias("blend", "vec_select", "if_then_else"))]
    fn select(mask: Self::Mask, on_true: Self, on_false: Self) -> Self;

    /// `self == other`; false for NaN; 0 equals -0.
    #[doc(alias("simd_eq", "cmpeq"))]
    fn eq(self, other: Self) -> Self::Mask;
    /// `self < other`; false for NaN.
    #[doc(alias("simd_lt", "cmplt"))]
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`; false for NaN.
    #[doc(alias("simd_le", "cmple"))]
    fn le(self, other: Self) -> Self::Mask;
    /// `self != other`; true for NaN.
    #[inline(always)]
    fn ne(self, other: Self) -> Self::Mask {
        !self.eq(other)
    }
    /// `self > other`; false for NaN.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }
    /// `self >= other`; false for NaN.
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        other.le(self)
    }

    /// `if self < other { self } else { other }`: `other` when either is NaN or both are zeros.
    fn min(self, other: Self) -> Self;
    /// `if self > other { self } else { other }`: `other` when either is NaN or both are zeros.
    fn max(self, other: Self) -> Self;

    /// [`Vector::min`] over the lanes, as a tree: lane `i` with lane `i + LANES/2`, then the halves of that, down to one.
    fn reduce_min(self) -> Self::Lane;
    /// [`Vector::max`] over the lanes, in the order of [`Vector::reduce_min`].
    fn reduce_max(self) -> Self::Lane;

    /// The lane of the smallest value among those that are on, NaN left out; the lowest lane among equals.
    #[doc(alias("argmin", "select_min"))]
    #[inline(always)]
    fn min_index(self, mask: Self::Mask) -> Option<usize> {
        let mask = mask & self.eq(self);
        let rest = Self::select(mask, self, Self::splat(Self::Lane::LARGEST));
        (mask & rest.eq(Self::splat(rest.reduce_min()))).first()
    }

    /// The lane of the largest value among those that are on, NaN left out; the lowest lane among equals.
    #[doc(alias("argmax", "select_max"))]
    #[inline(always)]
    fn max_index(self, mask: Self::Mask) -> Option<usize> {
        let mask = mask & self.eq(self);
        let rest = Self::select(mask, self, Self::splat(Self::Lane::SMALLEST));
        (mask & rest.eq(Self::splat(rest.reduce_max()))).first()
    }

    /// Lane `i` is lane `index[i] % LANES` of `self`: a table of [`Vector::LANES`] entries.
    #[doc(alias("permute", "swizzle_dyn", "permutevar", "TableLookupLanes"))]
    #[inline(always)]
    fn lookup(self, index: Self::Index) -> Self {
        let (table, index) = (self.to_block(), index.to_block());
        Self::from_fn(|i| table.0[index.0[i] as usize % Self::LANES])
    }

    /// Lane `i` is lane `from(i) % LANES` of `self`. With a function the compiler can evaluate this is a constant shuffle.
    #[doc(alias("shuffle", "permute"))]
    #[inline(always)]
    fn swizzle(self, mut from: impl FnMut(usize) -> usize) -> Self {
        self.lookup(Self::Index::from_fn(|i| from(i) as u32))
    }

    /// Lane `i` is lane `(i + n) % LANES` of `self`.
    #[inline(always)]
    fn rotate_lanes_left(self, n: usize) -> Self {
        self.swizzle(|i| i + n % Self::LANES)
    }

    /// Lane `(i + n) % LANES` is lane `i` of `self`.
    #[inline(always)]
    fn rotate_lanes_right(self, n: usize) -> Self {
        self.swizzle(|i| i + Self::LANES - n % Self::LANES)
    }

    /// The last lane first.
    #[inline(always)]
    fn reverse(self) -> Self {
        self.swizzle(|i| Self::LANES - 1 - i)
    }

    /// Lanes of `self` and `other` in turn: `a0 b0 a1 b1 ...`, in two vectors.
    #[doc(alias("zip", "unpack"))]
    #[inline(always)]
    fn interleave(self, other: Self) -> (Self, Self) {
        let half = |at: usize| {
            let (a, b) = (self.swizzle(|i| at + i / 2), other.swizzle(|i| at + i / 2));
            Self::select(Self::Mask::from_bitmask(0x5555), a, b)
        };
        (half(0), half(Self::LANES / 2))
    }

    /// The inverse of [`Vector::interleave`]: the even and the odd lanes of `self` followed by `other`.
    #[doc(alias("unzip"))]
    #[inline(always)]
    fn deinterleave(self, other: Self) -> (Self, Self) {
        let every_other = |at: usize| {
            let (a, b) = (self.swizzle(|i| 2 * i + at), other.swizzle(|i| 2 * i + at));
            Self::select(Self::Mask::first_n(Self::LANES / 2), a, b)
        };
        (every_other(0), every_other(1))
    }

    /// The lanes where the mask is true, moved together to the front in their order; zeros behind them.
    #[doc(alias("compact", "pack"))]
    #[inline(always)]
    fn compress(self, mask: Self::Mask) -> Self {
        let (lanes, mut block, mut n) = (self.to_block(), Block::default(), 0);
        for i in 0..Self::LANES {
            // Written always, kept when the mask is true: no branch.
            block.0[n % 16] = lanes.0[i];
            n += (mask.bitmask() >> i & 1) as usize;
        }
        Self::select(Self::Mask::first_n(n), Self::load_block(&block, 0), Self::default())
    }

    /// Appends the lanes where the mask is true to the front of `dst`, in their order, and returns their number.
    /// Where there is room for it, a whole vector is written: zeros behind those lanes.
    ///
    /// ```
    /// use simd::{Level, Vector};
    ///
    /// simd::kernel! {
    ///     /// Those that are positive.
    ///     fn positive<S>(numbers: &[f32]) -> Vec<f32> {
    ///         let mut out = vec![0.0; numbers.len()];
    ///         let mut n = 0;
    ///         for chunk in numbers.chunks_exact(S::Float::LANES) {
    ///             let x = S::Float::load(chunk);
    ///             n += x.compress_store(x.gt(S::Float::splat(0.0)), &mut out[n..]);
    ///         }
    ///         out.truncate(n);
    ///         out
    ///     }
    /// }
    /// let numbers: Vec<f32> = (0..32).map(|i| (i % 3) as f32 - 1.0).collect();
    /// assert_eq!(positive(Level::best(), &numbers), [1.0; 10]);
    /// ```
    ///
    /// # Panics
    /// If `dst` has no room for the lanes.
    #[doc(alias("compressstore", "left_pack"))]
    #[inline(always)]
    fn compress_store(self, mask: Self::Mask, dst: &mut [Self::Lane]) -> usize {
        let (packed, n) = (self.compress(mask), mask.count());
        if dst.len() >= Self::LANES {
            packed.store(dst);
        } else {
            packed.store_partial(&mut dst[..n]);
        }
        n
    }

    /// The inverse of [`Vector::compress`]: the first lanes, in their order, moved to where the mask is true; zeros elsewhere.
    #[inline(always)]
    fn expand(self, mask: Self::Mask) -> Self {
        let (lanes, mut block) = (self.to_block(), Block::default());
        for (n, lane) in mask.set_lanes().enumerate() {
            block.0[lane] = lanes.0[n];
        }
        Self::load_block(&block, 0)
    }

    /// With one lane replaced.
    ///
    /// # Panics
    /// If `lane >= LANES`.
    #[inline(always)]
    fn with_lane(self, lane: usize, x: Self::Lane) -> Self {
        assert!(lane < Self::LANES, "lane {lane} of {}", Self::LANES);
        Self::select(Self::Mask::from_bitmask(1 << lane), Self::splat(x), self)
    }

    /// From a function of the lane number.
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> Self::Lane) -> Self {
        let mut block = Block::default();
        for (i, x) in block.0[..Self::LANES].iter_mut().enumerate() {
            *x = f(i);
        }
        Self::load_block(&block, 0)
    }

    /// The lanes, in the first [`Vector::LANES`] elements of a block; the others are zero.
    #[inline(always)]
    fn to_block(self) -> Block<Self::Lane> {
        let mut block = Block::default();
        self.store_block(&mut block, 0);
        block
    }

    /// One lane.
    ///
    /// # Panics
    /// If `lane >= LANES`.
    #[inline(always)]
    fn lane(self, lane: usize) -> Self::Lane {
        self.to_block().0[..Self::LANES][lane]
    }
}

/// A vector of two vectors of half the lanes.
pub trait Halves: Vector {
    /// The vector of half the lanes.
    type Half: Vector<Lane = Self::Lane>;

    /// The lower lanes first.
    fn from_halves(low: Self::Half, high: Self::Half) -> Self;
    /// The lower lanes.
    fn low(self) -> Self::Half;
    /// The upper lanes.
    fn high(self) -> Self::Half;
}

/// Panics if a lane that is on is not below `len`.
#[inline(always)]
pub(crate) fn check_masked<M: Mask>(len: usize, mask: M) {
    let needed = mask.last().map_or(0, |lane| lane + 1);
    assert!(needed <= len, "masked access: lane {} is on, the slice has {len} elements", needed.wrapping_sub(1));
}

/// Folds the lanes as a tree: lane `i` with lane `i + LANES/2`, then the halves of that, down to one.
#[inline(always)]
pub(crate) fn reduce<V: Vector>(x: V, op: impl Fn(V, V) -> V) -> V::Lane {
    let (mut x, mut n) = (x, V::LANES / 2);
    while n > 0 {
        x = op(x, x.rotate_lanes_left(n));
        n /= 2;
    }
    x.lane(0)
}

/// Lane `i` becomes the fold of lanes `0..=i`: each takes in the lane 1, then 2, 4, ... below it (Kogge & Stone 1973).
#[inline(always)]
pub(crate) fn scan<V: Vector>(x: V, op: impl Fn(V, V) -> V) -> V {
    let (mut x, mut n) = (x, 1);
    while n < V::LANES {
        x = V::select(!V::Mask::first_n(n), op(x.rotate_lanes_right(n), x), x);
        n *= 2;
    }
    x
}

/// Moves all lanes up by one; zero in the first.
#[inline(always)]
pub(crate) fn up_by_one<V: Vector>(x: V) -> V {
    V::select(V::Mask::first_n(1), V::default(), x.rotate_lanes_right(1))
}
