//! Memory: slices, blocks, rows, gathers; and that what is out of bounds panics.

use crate::harness::{Width, everywhere};
use crate::lanes::{AnyLane, Job};
use crate::values::Random;
use simd::{Block, Level, Mask, Vector};

/// Whether it panics. Where panics abort, nothing is tried and the answer is yes.
pub fn panics(f: impl FnOnce()) -> bool {
    cfg!(not(panic = "unwind")) || std::panic::catch_unwind(std::panic::AssertUnwindSafe(f)).is_err()
}

/// Different in every lane, and a NaN here and there.
fn numbers<L: AnyLane>(n: usize) -> Vec<L> {
    let mut random = Random(3);
    (0..n).map(|_| L::of_bits(random.bits())).collect()
}

fn bits<L: AnyLane>(lanes: &[L]) -> Vec<u32> {
    lanes.iter().map(|x| x.bits()).collect()
}

/// Runs a test for each lane type.
macro_rules! for_all_lane_types {
    ($($name:ident)*) => {$(
        #[test]
        fn $name() {
            for (level, width) in everywhere() {
                generic::$name::<f32>(level, width);
                generic::$name::<i32>(level, width);
                generic::$name::<u32>(level, width);
            }
        }
    )*};
}
for_all_lane_types!(
    load_store splat blocks rows gather gather_out_of_bounds from_fn_to_block_lane
    partial masked scatter stream other_rows
);

struct LoadStore<'a, L>(&'a [L], &'a mut [L]);
impl<L: AnyLane> Job<L> for LoadStore<'_, L> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector<Lane = L>>(self) {
        V::load(self.0).store(self.1);
    }
}

struct Splat<'a, L>(L, &'a mut [L]);
impl<L: AnyLane> Job<L> for Splat<'_, L> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector<Lane = L>>(self) {
        V::splat(self.0).store(self.1);
    }
}

/// From one chunk to another.
struct MoveChunk<'a, L>(&'a Block<L>, usize, &'a mut Block<L>, usize);
impl<L: AnyLane> Job<L> for MoveChunk<'_, L> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector<Lane = L>>(self) {
        V::load_block(self.0, self.1).store_block(self.2, self.3);
    }
}

/// Rows to columns, the columns one after the other.
struct LoadRows<'a, L>(&'a [[L; 4]], &'a mut [L]);
impl<L: AnyLane> Job<L> for LoadRows<'_, L> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector<Lane = L>>(self) {
        for (k, column) in V::load_rows4(self.0).into_iter().enumerate() {
            column.store(&mut self.1[k * V::LANES..]);
        }
    }
}

/// Columns, one after the other, to rows.
struct StoreRows<'a, L>(&'a [L], &'a mut [[L; 4]]);
impl<L: AnyLane> Job<L> for StoreRows<'_, L> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector<Lane = L>>(self) {
        let column = |k: usize| V::load(&self.0[k * V::LANES..]);
        V::store_rows4([column(0), column(1), column(2), column(3)], self.1);
    }
}

/// With a mask, else all lanes.
struct Gather<'a, L> {
    src: &'a [L],
    index: &'a [u32],
    mask: Option<u32>,
    or: &'a [L],
    out: &'a mut [L],
}
impl<L: AnyLane> Job<L> for Gather<'_, L> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector<Lane = L>>(self) {
        let index = V::Index::load(self.index);
        let gathered = match self.mask {
            Some(mask) => V::gather_masked(self.src, index, V::Mask::from_bitmask(mask), V::load(self.or)),
            None => V::gather(self.src, index),
        };
        gathered.store(self.out);
    }
}

/// From a function, to a block and to the lanes one by one.
struct FromFn<'a, L>(&'a [L; 16], &'a mut Block<L>, &'a mut [L]);
impl<L: AnyLane> Job<L> for FromFn<'_, L> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector<Lane = L>>(self) {
        let vector = V::from_fn(|i| self.0[i]);
        *self.1 = vector.to_block();
        for (i, lane) in self.2[..V::LANES].iter_mut().enumerate() {
            *lane = vector.lane(i);
        }
    }
}

/// Loads all there is and stores what fits.
struct Partial<'a, L>(&'a [L], &'a mut [L]);
impl<L: AnyLane> Job<L> for Partial<'_, L> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector<Lane = L>>(self) {
        V::load_partial(self.0).store_partial(self.1);
    }
}

/// Loads the lanes of one mask, 0 elsewhere, and stores those of another.
struct Masked<'a, L>(&'a [L], u32, &'a mut [L], u32);
impl<L: AnyLane> Job<L> for Masked<'_, L> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector<Lane = L>>(self) {
        let x = V::load_masked(self.0, V::Mask::from_bitmask(self.1), V::default());
        x.store_masked(self.2, V::Mask::from_bitmask(self.3));
    }
}

/// With a mask, else all lanes.
struct Scatter<'a, L>(&'a [L], &'a [u32], Option<u32>, &'a mut [L]);
impl<L: AnyLane> Job<L> for Scatter<'_, L> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector<Lane = L>>(self) {
        let (x, index) = (V::load(self.0), V::Index::load(self.1));
        match self.2 {
            Some(mask) => x.scatter_masked(self.3, index, V::Mask::from_bitmask(mask)),
            None => x.scatter(self.3, index),
        }
    }
}

struct Stream<'a, L>(&'a [L], &'a mut [Block<L>]);
impl<L: AnyLane> Job<L> for Stream<'_, L> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector<Lane = L>>(self) {
        V::stream(self.1, |i| V::load(&self.0[i * V::LANES..]));
    }
}

/// Rows of 2, 3 and 8 to columns and back to other rows.
struct OtherRows<'a, L> {
    rows2: (&'a [[L; 2]], &'a mut [[L; 2]]),
    rows3: (&'a [[L; 3]], &'a mut [[L; 3]]),
    rows8: (&'a [[L; 8]], &'a mut [[L; 8]]),
    columns: &'a mut Vec<L>,
}
impl<L: AnyLane> Job<L> for OtherRows<'_, L> {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector<Lane = L>>(self) {
        let columns2 = V::load_rows2(self.rows2.0);
        let columns3 = V::load_rows3(self.rows3.0);
        let columns8 = V::load_rows8(self.rows8.0);
        for column in columns2.iter().chain(&columns3).chain(&columns8) {
            self.columns.extend_from_slice(&column.to_block().0[..V::LANES]);
        }
        V::store_rows2(columns2, self.rows2.1);
        V::store_rows3(columns3, self.rows3.1);
        V::store_rows8(columns8, self.rows8.1);
    }
}

struct OneLane(usize);
impl<L: AnyLane> Job<L> for OneLane {
    type Output = ();
    #[inline(always)]
    fn run<V: Vector<Lane = L>>(self) {
        V::splat(L::default()).lane(self.0);
    }
}

mod generic {
    use super::*;

    pub fn load_store<L: AnyLane>(level: Level, width: Width) {
        let (lanes, src) = (width.lanes(), numbers::<L>(48));
        for offset in 0..17 {
            let mut dst = vec![L::default(); 48];
            L::run(level, width, LoadStore(&src[offset..], &mut dst[16 - offset..]));
            let mut expected = vec![0; 48];
            expected[16 - offset..][..lanes].copy_from_slice(&bits(&src[offset..][..lanes]));
            assert_eq!(bits(&dst), expected, "{level}, {width:?}, {offset}");
        }
        for short in 0..lanes {
            let mut dst = vec![L::default(); lanes];
            assert!(panics(|| L::run(level, width, LoadStore(&src[..short], &mut dst))), "{level}, {width:?}, {short}");
            let dst = &mut dst[..short];
            assert!(panics(|| L::run(level, width, LoadStore(&src, dst))), "{level}, {width:?}, {short}");
        }
        let mut exact = vec![L::default(); lanes];
        L::run(level, width, LoadStore(&src[..lanes], &mut exact));
        assert_eq!(bits(&exact), bits(&src[..lanes]), "{level}, {width:?}");
    }

    pub fn splat<L: AnyLane>(level: Level, width: Width) {
        for x in numbers::<L>(8) {
            let mut dst = vec![L::default(); width.lanes()];
            L::run(level, width, Splat(x, &mut dst));
            assert_eq!(bits(&dst), vec![x.bits(); width.lanes()], "{level}, {width:?}");
        }
    }

    pub fn blocks<L: AnyLane>(level: Level, width: Width) {
        let lanes = width.lanes();
        let chunks = 16 / lanes;
        let src = Block(std::array::from_fn(|i| numbers::<L>(16)[i]));
        for from in 0..chunks {
            for to in 0..chunks {
                let mut dst = Block::default();
                L::run(level, width, MoveChunk(&src, from, &mut dst, to));
                let mut expected = [0; 16];
                expected[to * lanes..][..lanes].copy_from_slice(&bits(&src.0[from * lanes..][..lanes]));
                assert_eq!(bits(&dst.0), expected, "{level}, {width:?}, {from} to {to}");
            }
        }
        // Also such that a multiple of it, in bytes or elements, wraps around to something small.
        for bad in [chunks, chunks + 1, 16, usize::MAX, usize::MAX / 2 + 1, usize::MAX / 4 + 1, usize::MAX / 16 + 1] {
            let mut dst = Block::default();
            assert!(panics(|| L::run(level, width, MoveChunk(&src, bad, &mut dst, 0))), "{level}, {width:?}, {bad}");
            assert!(panics(|| L::run(level, width, MoveChunk(&src, 0, &mut dst, bad))), "{level}, {width:?}, {bad}");
        }
    }

    pub fn rows<L: AnyLane>(level: Level, width: Width) {
        let lanes = width.lanes();
        let flat = numbers::<L>(4 * (lanes + 3));
        let (rows, _) = flat.as_chunks::<4>();
        let mut columns = vec![L::default(); 4 * lanes];
        L::run(level, width, LoadRows(rows, &mut columns));
        for (k, column) in columns.chunks_exact(lanes).enumerate() {
            let expected: Vec<L> = rows[..lanes].iter().map(|row| row[k]).collect();
            assert_eq!(bits(column), bits(&expected), "{level}, {width:?}, column {k}");
        }

        let mut back = vec![[L::default(); 4]; lanes + 3];
        L::run(level, width, StoreRows(&columns, &mut back));
        assert_eq!(bits(back[..lanes].as_flattened()), bits(rows[..lanes].as_flattened()), "{level}, {width:?}");
        assert_eq!(bits(back[lanes..].as_flattened()), [0; 12], "{level}, {width:?}: rows beyond were written");

        for short in 0..lanes {
            assert!(panics(|| L::run(level, width, LoadRows(&rows[..short], &mut columns))), "{level}, {width:?}");
            assert!(panics(|| L::run(level, width, StoreRows(&columns, &mut back[..short]))), "{level}, {width:?}");
        }
    }

    pub fn partial<L: AnyLane>(level: Level, width: Width) {
        let (lanes, src) = (width.lanes(), numbers::<L>(40));
        for n in 0..20 {
            for m in 0..20 {
                let mut dst = src[20..].to_vec();
                L::run(level, width, Partial(&src[..n], &mut dst[..m]));
                let mut expected = src[20..].to_vec();
                for i in 0..m.min(lanes) {
                    expected[i] = if i < n { src[i] } else { L::default() };
                }
                assert_eq!(bits(&dst), bits(&expected), "{level}, {width:?}, {n} to {m}");
            }
        }
    }

    pub fn masked<L: AnyLane>(level: Level, width: Width) {
        let (lanes, src) = (width.lanes(), numbers::<L>(32));
        let needed = |mask: u32| (0..lanes).filter(|i| mask >> i & 1 == 1).max().map_or(0, |i| i + 1);
        let mut random = Random(5);
        for _ in 0..300 {
            let (from, to) = (random.bits() & random.bits() >> (random.bits() % 16), random.bits());
            // Exactly as long as the masks ask for.
            let mut dst = src[16..][..needed(to)].to_vec();
            L::run(level, width, Masked(&src[..needed(from)], from, &mut dst, to));
            for (i, x) in dst.iter().enumerate() {
                let loaded = if from >> i & 1 == 1 { src[i] } else { L::default() };
                let expected = if to >> i & 1 == 1 { loaded } else { src[16 + i] };
                assert_eq!(x.bits(), expected.bits(), "{level}, {width:?}, lane {i}, {from:x} to {to:x}");
            }
            let short = needed(to).saturating_sub(1);
            if short < needed(to) {
                let before = src[16..][..short].to_vec();
                let mut dst = before.clone();
                assert!(panics(|| L::run(level, width, Masked(&src, u32::MAX, &mut dst, to))), "{level}, {width:?}");
                assert_eq!(bits(&dst), bits(&before), "{level}, {width:?}: written before the check");
                let mut dst = src.clone();
                assert!(panics(|| L::run(level, width, Masked(&src[..short], to, &mut dst, 0))), "{level}, {width:?}");
            }
        }
    }

    pub fn scatter<L: AnyLane>(level: Level, width: Width) {
        let (lanes, src) = (width.lanes(), numbers::<L>(60));
        let mut random = Random(6);
        for round in 0..200 {
            let (mut dst, mut expected) = (src[20..57].to_vec(), src[20..57].to_vec());
            // Few places, so that lanes meet.
            let places = if round % 2 == 0 { 37 } else { 5 };
            let mask = if round % 3 == 0 { None } else { Some(random.bits()) };
            let on = |i: usize| mask.is_none_or(|mask| mask >> i & 1 == 1);
            let wild = [37, u32::MAX, 1 << 31, 1 << 30];
            let index: Vec<u32> =
                (0..16).map(|i| if on(i) { random.bits() % places } else { wild[i % wild.len()] }).collect();
            for i in (0..lanes).filter(|&i| on(i)) {
                expected[index[i] as usize] = src[i];
            }
            L::run(level, width, Scatter(&src, &index, mask, &mut dst));
            assert_eq!(bits(&dst), bits(&expected), "{level}, {width:?}, {index:?}, mask {mask:x?}");
        }
        for lane in 0..lanes {
            for (len, bad) in [(37, 37), (37, u32::MAX), (37, 1 << 31), (1, 1), (0, 0)] {
                let mut index = [0; 16];
                index[lane] = bad;
                let mut dst = src[..len].to_vec();
                let job = Scatter(&src[20..], &index, Some(1 << lane), &mut dst);
                assert!(panics(|| L::run(level, width, job)), "{level}, {width:?}, lane {lane}: {bad} of {len}");
                assert_eq!(bits(&dst), bits(&src[..len]), "{level}, {width:?}: written before the check");
            }
        }
    }

    pub fn stream<L: AnyLane>(level: Level, width: Width) {
        let src = numbers::<L>(16 * 5);
        for blocks in 0..=5 {
            let mut dst = vec![Block::default(); blocks];
            L::run(level, width, Stream(&src, &mut dst));
            let written: Vec<u32> = dst.iter().flat_map(|block| bits(&block.0)).collect();
            assert_eq!(written, bits(&src[..16 * blocks]), "{level}, {width:?}");
        }
    }

    pub fn other_rows<L: AnyLane>(level: Level, width: Width) {
        let (lanes, flat) = (width.lanes(), numbers::<L>(8 * 16));
        let (rows2, rows3, rows8) = (flat.as_chunks::<2>().0, flat.as_chunks::<3>().0, flat.as_chunks::<8>().0);
        let (mut back2, mut back3, mut back8) =
            (vec![[L::default(); 2]; lanes], vec![[L::default(); 3]; lanes], vec![[L::default(); 8]; lanes]);
        let mut columns = Vec::new();
        let job = OtherRows {
            rows2: (rows2, &mut back2),
            rows3: (rows3, &mut back3),
            rows8: (rows8, &mut back8),
            columns: &mut columns,
        };
        L::run(level, width, job);
        let mut expected = Vec::new();
        (0..2).for_each(|k| expected.extend(rows2[..lanes].iter().map(|row| row[k])));
        (0..3).for_each(|k| expected.extend(rows3[..lanes].iter().map(|row| row[k])));
        (0..8).for_each(|k| expected.extend(rows8[..lanes].iter().map(|row| row[k])));
        assert_eq!(bits(&columns), bits(&expected), "{level}, {width:?}");
        assert_eq!(bits(back2.as_flattened()), bits(&flat[..2 * lanes]), "{level}, {width:?}: rows of 2");
        assert_eq!(bits(back3.as_flattened()), bits(&flat[..3 * lanes]), "{level}, {width:?}: rows of 3");
        assert_eq!(bits(back8.as_flattened()), bits(&flat[..8 * lanes]), "{level}, {width:?}: rows of 8");
    }

    pub fn gather<L: AnyLane>(level: Level, width: Width) {
        let (src, or) = (numbers::<L>(37), numbers::<L>(60)[37..].to_vec());
        let mut random = Random(4);
        for round in 0..200 {
            let index: Vec<u32> = (0..16).map(|_| random.bits() % 37).collect();
            let mut out = vec![L::default(); 16];
            L::run(level, width, Gather { src: &src, index: &index, mask: None, or: &or, out: &mut out });
            for i in 0..width.lanes() {
                assert_eq!(out[i].bits(), src[index[i] as usize].bits(), "{level}, {width:?}, lane {i}");
            }

            // Lanes that are off: in bounds or wild, and at times there is nothing to gather from.
            let mask = if round == 0 { 0 } else { random.bits() };
            let on = |i: usize| mask >> i & 1 == 1;
            let wild = [37, u32::MAX, 1 << 31, 1 << 30, (1 << 31) - 1, 5];
            let index: Vec<u32> = (0..16).map(|i| if on(i) { index[i] } else { wild[i % wild.len()] }).collect();
            let src = if mask == 0 { &[][..] } else { &src };
            L::run(level, width, Gather { src, index: &index, mask: Some(mask), or: &or, out: &mut out });
            for i in 0..width.lanes() {
                let expected = if on(i) { src[index[i] as usize] } else { or[i] };
                assert_eq!(out[i].bits(), expected.bits(), "{level}, {width:?}, lane {i}, mask {mask:x}");
            }
        }
    }

    pub fn gather_out_of_bounds<L: AnyLane>(level: Level, width: Width) {
        let src = numbers::<L>(37);
        let or = src.clone();
        for lane in 0..width.lanes() {
            for (len, bad) in [(37, 37), (37, u32::MAX), (37, 1 << 31), (37, 1 << 30), (1, 1), (0, 0)] {
                let mut index = [0; 16];
                index[lane] = bad;
                for mask in [None, Some(u32::MAX), Some(1 << lane)] {
                    let mut out = vec![L::default(); 16];
                    let job = Gather { src: &src[..len], index: &index, mask, or: &or, out: &mut out };
                    assert!(
                        panics(|| L::run(level, width, job)),
                        "{level}, {width:?}, lane {lane}: {bad} of {len}, mask {mask:x?}"
                    );
                }
            }
        }
    }

    pub fn from_fn_to_block_lane<L: AnyLane>(level: Level, width: Width) {
        let (numbers, lanes) = (numbers::<L>(16), width.lanes());
        let src = std::array::from_fn(|i| numbers[i]);
        let (mut block, mut one_by_one) = (Block(src), [L::default(); 16]);
        L::run(level, width, FromFn(&src, &mut block, &mut one_by_one));
        let mut expected = [0; 16];
        expected[..lanes].copy_from_slice(&bits(&src[..lanes]));
        assert_eq!(bits(&block.0), expected, "{level}, {width:?}");
        assert_eq!(bits(&one_by_one), expected, "{level}, {width:?}");
        for bad in [lanes, 16, usize::MAX] {
            assert!(panics(|| L::run(level, width, OneLane(bad))), "{level}, {width:?}, {bad}");
        }
    }
}

#[test]
fn prefetch_is_only_a_hint() {
    let numbers = [1.0_f32; 8];
    for index in [0, 7, 8, usize::MAX] {
        simd::prefetch(&numbers, index);
    }
    simd::prefetch::<u32>(&[], 0);
}
