//! NEON: what vectors of all lane types share.

use super::*;

/// Table lookup by bytes; a number of a byte above 15 gives 0.
#[inline(always)]
pub(super) fn lookup_bytes(x: uint32x4_t, bytes: uint8x16_t) -> uint32x4_t {
    intrinsics!(vreinterpretq_u32_u8(vqtbl1q_u8(vreinterpretq_u8_u32(x), bytes)))
}

/// [`Vector`] of one lane type from its intrinsics: memory and comparisons in common, minimum and maximum given.
macro_rules! vector {
    (
        $V:ident, $Lane:ty: splat $dup:ident, load $ld1:ident $ld4:ident, store $st1:ident $st4:ident, four $Four:ident,
        select $bsl:ident, eq $ceq:ident, lt $clt:ident, le $cle:ident, { $($given:tt)* }
    ) => {
        impl Vector for $V {
            type Lane = $Lane;
            type Mask = Bool4;
            type Index = Uint4;
            const LANES: usize = 4;

            #[inline(always)]
            fn splat(x: $Lane) -> Self {
                Self(intrinsics!($dup(x)))
            }
            #[inline(always)]
            fn load(src: &[$Lane]) -> Self {
                let src: *const $Lane = src[..4].as_ptr();
                // SAFETY: four elements are there to read.
                Self(unsafe { $ld1(src) })
            }
            #[inline(always)]
            fn store(self, dst: &mut [$Lane]) {
                let dst: *mut $Lane = dst[..4].as_mut_ptr();
                // SAFETY: four elements are there to write.
                unsafe { $st1(dst, self.0) }
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
                let rows: *const [$Lane; 4] = rows[..4].as_ptr();
                // SAFETY: four rows, sixteen elements, are there to read.
                let $Four(a, b, c, d) = unsafe { $ld4(rows.cast()) };
                [Self(a), Self(b), Self(c), Self(d)]
            }
            #[inline(always)]
            fn store_rows4([a, b, c, d]: [Self; 4], rows: &mut [[$Lane; 4]]) {
                let rows: *mut [$Lane; 4] = rows[..4].as_mut_ptr();
                // SAFETY: four rows, sixteen elements, are there to write.
                unsafe { $st4(rows.cast(), $Four(a.0, b.0, c.0, d.0)) }
            }
            #[inline(always)]
            fn select(mask: Bool4, on_true: Self, on_false: Self) -> Self {
                Self(intrinsics!($bsl(mask.0, on_true.0, on_false.0)))
            }
            #[inline(always)]
            fn lookup(self, index: Uint4) -> Self {
                // Numbers of bytes: four times the index, in four bytes, plus 0, 1, 2, 3.
                let lane = (index & Uint4::splat(3)) * Uint4::splat(0x0404_0404) + Uint4::splat(0x0302_0100);
                Self::of_lane_bits(lookup_bytes(self.lane_bits(), intrinsics!(vreinterpretq_u8_u32(lane.0))))
            }
            #[inline(always)]
            fn interleave(self, other: Self) -> (Self, Self) {
                let (a, b) = (self.lane_bits(), other.lane_bits());
                let (low, high) = intrinsics!((vzip1q_u32(a, b), vzip2q_u32(a, b)));
                (Self::of_lane_bits(low), Self::of_lane_bits(high))
            }
            #[inline(always)]
            fn deinterleave(self, other: Self) -> (Self, Self) {
                let (a, b) = (self.lane_bits(), other.lane_bits());
                let (even, odd) = intrinsics!((vuzp1q_u32(a, b), vuzp2q_u32(a, b)));
                (Self::of_lane_bits(even), Self::of_lane_bits(odd))
            }
            #[inline(always)]
            fn compress(self, mask: Bool4) -> Self {
                let bytes: *const [u8; 16] = &COMPRESS4[mask.bitmask() as usize % 16];
                // SAFETY: sixteen bytes are there to read.
                let bytes = unsafe { vld1q_u8(bytes.cast()) };
                Self::of_lane_bits(lookup_bytes(self.lane_bits(), bytes))
            }
            #[inline(always)]
            fn eq(self, other: Self) -> Bool4 {
                Bool4(intrinsics!($ceq(self.0, other.0)))
            }
            #[inline(always)]
            fn lt(self, other: Self) -> Bool4 {
                Bool4(intrinsics!($clt(self.0, other.0)))
            }
            #[inline(always)]
            fn le(self, other: Self) -> Bool4 {
                Bool4(intrinsics!($cle(self.0, other.0)))
            }
            $($given)*
        }
    };
}
pub(super) use vector;
