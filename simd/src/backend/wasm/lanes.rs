//! WebAssembly: what vectors of all lane types share.

use super::*;

/// Columns to rows, and back.
#[inline(always)]
pub(super) fn transpose([a, b, c, d]: [v128; 4]) -> [v128; 4] {
    let (ab_lo, ab_hi) = (u32x4_shuffle::<0, 4, 1, 5>(a, b), u32x4_shuffle::<2, 6, 3, 7>(a, b));
    let (cd_lo, cd_hi) = (u32x4_shuffle::<0, 4, 1, 5>(c, d), u32x4_shuffle::<2, 6, 3, 7>(c, d));
    [
        u64x2_shuffle::<0, 2>(ab_lo, cd_lo),
        u64x2_shuffle::<1, 3>(ab_lo, cd_lo),
        u64x2_shuffle::<0, 2>(ab_hi, cd_hi),
        u64x2_shuffle::<1, 3>(ab_hi, cd_hi),
    ]
}

/// [`Vector`] of one lane type from its intrinsics: memory in common, minimum and maximum given.
macro_rules! vector {
    (
        [$($generics:tt)*] $V:ty, $Lane:ty: splat $splat:ident, first $extract:ident, eq $eq:ident, lt $lt:ident, le $le:ident,
        { $($given:tt)* }
    ) => {
        impl<$($generics)*> $V {
            /// The halves with each other, then lane 0 with lane 1.
            #[inline(always)]
            fn reduce(self, op: impl Fn(Self, Self) -> Self) -> $Lane {
                let two = op(self, Self::new(u64x2_shuffle::<1, 1>(self.0, self.0)));
                let one = op(two, Self::new(u32x4_shuffle::<1, 1, 1, 1>(two.0, two.0)));
                $extract::<0>(one.0)
            }
        }

        impl<$($generics)*> Vector for $V {
            type Lane = $Lane;
            type Mask = Bool4;
            type Index = Uint4;
            const LANES: usize = 4;

            #[inline(always)]
            fn splat(x: $Lane) -> Self {
                Self::new($splat(x))
            }
            #[inline(always)]
            fn load(src: &[$Lane]) -> Self {
                let src: *const $Lane = src[..4].as_ptr();
                // SAFETY: four elements are there to read.
                Self::new(unsafe { v128_load(src.cast()) })
            }
            #[inline(always)]
            fn store(self, dst: &mut [$Lane]) {
                let dst: *mut $Lane = dst[..4].as_mut_ptr();
                // SAFETY: four elements are there to write.
                unsafe { v128_store(dst.cast(), self.0) }
            }
            #[inline(always)]
            fn load_block(block: &Block<$Lane>, chunk: usize) -> Self {
                Self::load(&block.0.as_chunks::<4>().0[chunk])
            }
            #[inline(always)]
            fn store_block(self, block: &mut Block<$Lane>, chunk: usize) {
                self.store(&mut block.0.as_chunks_mut::<4>().0[chunk]);
            }
            #[inline(always)]
            fn gather_masked(src: &[$Lane], index: Uint4, mask: Bool4, or: Self) -> Self {
                check_bounds::<Self>(src.len(), index, mask);
                let (index, mut lanes) = (index.to_block(), or.to_block());
                let mask = mask.bitmask();
                for i in 0..4 {
                    if mask >> i & 1 != 0 {
                        // SAFETY: the index of a lane that is on was found in bounds.
                        lanes.0[i] = unsafe { *src.get_unchecked(index.0[i] as usize) };
                    }
                }
                Self::load_block(&lanes, 0)
            }
            #[inline(always)]
            fn load_rows4(rows: &[[$Lane; 4]]) -> [Self; 4] {
                let rows = &rows[..4];
                let row = |i: usize| Self::load(&rows[i]).0;
                let [a, b, c, d] = transpose([row(0), row(1), row(2), row(3)]);
                [Self::new(a), Self::new(b), Self::new(c), Self::new(d)]
            }
            #[inline(always)]
            fn store_rows4([a, b, c, d]: [Self; 4], rows: &mut [[$Lane; 4]]) {
                let [a, b, c, d] = transpose([a.0, b.0, c.0, d.0]);
                let rows = &mut rows[..4];
                Self::new(a).store(&mut rows[0]);
                Self::new(b).store(&mut rows[1]);
                Self::new(c).store(&mut rows[2]);
                Self::new(d).store(&mut rows[3]);
            }
            #[inline(always)]
            fn lookup(self, index: Uint4) -> Self {
                // Numbers of bytes: four times the index, in four bytes, plus 0, 1, 2, 3.
                let lane = (index & Uint4::splat(3)) * Uint4::splat(0x0404_0404) + Uint4::splat(0x0302_0100);
                Self::new(i8x16_swizzle(self.0, lane.0))
            }
            #[inline(always)]
            fn interleave(self, other: Self) -> (Self, Self) {
                let (a, b) = (self.0, other.0);
                (Self::new(u32x4_shuffle::<0, 4, 1, 5>(a, b)), Self::new(u32x4_shuffle::<2, 6, 3, 7>(a, b)))
            }
            #[inline(always)]
            fn deinterleave(self, other: Self) -> (Self, Self) {
                let (a, b) = (self.0, other.0);
                (Self::new(u32x4_shuffle::<0, 2, 4, 6>(a, b)), Self::new(u32x4_shuffle::<1, 3, 5, 7>(a, b)))
            }
            #[inline(always)]
            fn compress(self, mask: Bool4) -> Self {
                let bytes: *const [u8; 16] = &COMPRESS4[mask.bitmask() as usize % 16];
                // SAFETY: sixteen bytes are there to read. Numbers above 15 give zeros.
                Self::new(i8x16_swizzle(self.0, unsafe { v128_load(bytes.cast()) }))
            }
            #[inline(always)]
            fn select(mask: Bool4, on_true: Self, on_false: Self) -> Self {
                Self::new(v128_bitselect(on_true.0, on_false.0, mask.0))
            }
            #[inline(always)]
            fn eq(self, other: Self) -> Bool4 {
                Bool4($eq(self.0, other.0))
            }
            #[inline(always)]
            fn lt(self, other: Self) -> Bool4 {
                Bool4($lt(self.0, other.0))
            }
            #[inline(always)]
            fn le(self, other: Self) -> Bool4 {
                Bool4($le(self.0, other.0))
            }
            #[inline(always)]
            fn reduce_min(self) -> $Lane {
                self.reduce(Self::min)
            }
            #[inline(always)]
            fn reduce_max(self) -> $Lane {
                self.reduce(Self::max)
            }
            $($given)*
        }
    };
}
pub(super) use vector;
