//! VSX: what vectors of all lane types share.

/// [`Vector`] of one lane type: memory and moves in common, comparisons, minimum and maximum given.
macro_rules! vector {
    ($V:ident, $Lane:ty, { $($given:tt)* }) => {
        impl $V {
            /// The halves with each other, then lane 0 with lane 1.
            #[inline(always)]
            fn reduce(self, op: impl Fn(Self, Self) -> Self) -> $Lane {
                let two = op(self, self.rotate_lanes_left(2));
                op(two, two.rotate_lanes_left(1)).lane(0)
            }
            /// Columns to rows, and back: a perfect shuffle of all lanes, twice.
            #[inline(always)]
            fn transpose4([a, b, c, d]: [Self; 4]) -> [Self; 4] {
                let ((ac_low, ac_high), (bd_low, bd_high)) = (a.interleave(c), b.interleave(d));
                let ((a, b), (c, d)) = (ac_low.interleave(bd_low), ac_high.interleave(bd_high));
                [a, b, c, d]
            }
        }

        impl Vector for $V {
            type Lane = $Lane;
            type Mask = Bool4;
            type Index = Uint4;
            const LANES: usize = 4;

            #[inline(always)]
            fn splat(x: $Lane) -> Self {
                Self(intrinsics!(vec_splats(x)))
            }
            #[inline(always)]
            fn load(src: &[$Lane]) -> Self {
                let src: *const $Lane = src[..4].as_ptr();
                // SAFETY: four elements are there to read.
                Self(unsafe { vec_xl(0, src) })
            }
            #[inline(always)]
            fn store(self, dst: &mut [$Lane]) {
                let dst: *mut $Lane = dst[..4].as_mut_ptr();
                // SAFETY: four elements are there to write.
                unsafe { vec_xst(self.0, 0, dst) }
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
                Self::transpose4([Self::load(&rows[0]), Self::load(&rows[1]), Self::load(&rows[2]), Self::load(&rows[3])])
            }
            #[inline(always)]
            fn store_rows4(columns: [Self; 4], rows: &mut [[$Lane; 4]]) {
                let [a, b, c, d] = Self::transpose4(columns);
                let rows = &mut rows[..4];
                a.store(&mut rows[0]);
                b.store(&mut rows[1]);
                c.store(&mut rows[2]);
                d.store(&mut rows[3]);
            }
            #[inline(always)]
            fn select(mask: Bool4, on_true: Self, on_false: Self) -> Self {
                Self(intrinsics!(vec_sel(on_false.0, on_true.0, mask.0)))
            }
            #[inline(always)]
            fn lookup(self, index: Uint4) -> Self {
                // Numbers of bytes: four times the index, in four bytes, plus 0, 1, 2, 3.
                let lane = (index & Uint4::splat(3)) * Uint4::splat(0x0404_0404) + Uint4::splat(0x0302_0100);
                Self(intrinsics!(vec_perm(self.0, self.0, transmute(lane.0))))
            }
            #[inline(always)]
            fn interleave(self, other: Self) -> (Self, Self) {
                let (low, high) = intrinsics!((vec_mergeh(self.0, other.0), vec_mergel(self.0, other.0)));
                (Self(low), Self(high))
            }
            #[inline(always)]
            fn deinterleave(self, other: Self) -> (Self, Self) {
                let (even, odd) = (
                    [0_u8, 1, 2, 3, 8, 9, 10, 11, 16, 17, 18, 19, 24, 25, 26, 27],
                    [4_u8, 5, 6, 7, 12, 13, 14, 15, 20, 21, 22, 23, 28, 29, 30, 31],
                );
                let (even, odd) = intrinsics! {(
                    vec_perm(self.0, other.0, transmute(even)),
                    vec_perm(self.0, other.0, transmute(odd))
                )};
                (Self(even), Self(odd))
            }
            #[inline(always)]
            fn compress(self, mask: Bool4) -> Self {
                let bytes = COMPRESS4[mask.bitmask() as usize % 16];
                // Byte 16 is the first of the zeros.
                Self(intrinsics!(vec_perm(self.0, Self::default().0, transmute(bytes))))
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
