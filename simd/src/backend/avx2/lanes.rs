//! AVX2: what vectors of all lane types share.

use super::*;

/// Columns to rows, and back, in each half by itself.
#[inline(always)]
pub(super) fn transpose([a, b, c, d]: [__m256; 4]) -> [__m256; 4] {
    intrinsics! {
        let (ab_lo, ab_hi) = (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
        let (cd_lo, cd_hi) = (_mm256_unpacklo_ps(c, d), _mm256_unpackhi_ps(c, d));
        [
            _mm256_shuffle_ps::<0b01_00_01_00>(ab_lo, cd_lo),
            _mm256_shuffle_ps::<0b11_10_11_10>(ab_lo, cd_lo),
            _mm256_shuffle_ps::<0b01_00_01_00>(ab_hi, cd_hi),
            _mm256_shuffle_ps::<0b11_10_11_10>(ab_hi, cd_hi),
        ]
    }
}

/// A register from its halves.
#[inline(always)]
pub(super) fn join(low: __m128, high: __m128) -> __m256 {
    intrinsics!(_mm256_set_m128(high, low))
}

/// [`Vector`] of one lane type: memory in common, comparisons given.
macro_rules! vector {
    ($V:ident, $Half:ty, $Lane:ty, $x:ident: splat $splat:expr, { $($given:tt)* }) => {
        impl $V {
            #[inline(always)]
            pub(in crate::backend) fn halves(self) -> ($Half, $Half) {
                let x = self.ps();
                let (low, high) = intrinsics!((_mm256_castps256_ps128(x), _mm256_extractf128_ps::<1>(x)));
                (<$Half>::of_ps(low), <$Half>::of_ps(high))
            }

            /// Fields `at` to `at + 3` of eight rows.
            #[inline(always)]
            fn load_fields<const N: usize>(rows: &[[$Lane; N]], at: usize) -> [Self; 4] {
                let rows = &rows[..8];
                let [a, b, c, d] = transpose([
                    join(<$Half>::load(&rows[0][at..]).ps(), <$Half>::load(&rows[4][at..]).ps()),
                    join(<$Half>::load(&rows[1][at..]).ps(), <$Half>::load(&rows[5][at..]).ps()),
                    join(<$Half>::load(&rows[2][at..]).ps(), <$Half>::load(&rows[6][at..]).ps()),
                    join(<$Half>::load(&rows[3][at..]).ps(), <$Half>::load(&rows[7][at..]).ps()),
                ]);
                [Self::of_ps(a), Self::of_ps(b), Self::of_ps(c), Self::of_ps(d)]
            }

            /// The inverse.
            #[inline(always)]
            fn store_fields<const N: usize>([a, b, c, d]: [Self; 4], rows: &mut [[$Lane; N]], at: usize) {
                let rows = &mut rows[..8];
                let [a, b, c, d] = transpose([a.ps(), b.ps(), c.ps(), d.ps()]);
                for (i, row) in [a, b, c, d].into_iter().enumerate() {
                    let (low, high) = Self::of_ps(row).halves();
                    low.store(&mut rows[i][at..]);
                    high.store(&mut rows[i + 4][at..]);
                }
            }
        }

        impl Halves for $V {
            type Half = $Half;

            #[inline(always)]
            fn from_halves(low: $Half, high: $Half) -> Self {
                Self::of_ps(join(low.ps(), high.ps()))
            }
            #[inline(always)]
            fn low(self) -> $Half {
                self.halves().0
            }
            #[inline(always)]
            fn high(self) -> $Half {
                self.halves().1
            }
        }

        impl Vector for $V {
            type Lane = $Lane;
            type Mask = Bool8;
            type Index = Uint8;
            const LANES: usize = 8;

            #[inline(always)]
            fn splat($x: $Lane) -> Self {
                Self::new(intrinsics!($splat))
            }
            #[inline(always)]
            fn load(src: &[$Lane]) -> Self {
                let src: *const $Lane = src[..8].as_ptr();
                // SAFETY: eight elements are there to read.
                Self::of_ps(unsafe { _mm256_loadu_ps(src.cast()) })
            }
            #[inline(always)]
            fn store(self, dst: &mut [$Lane]) {
                let dst: *mut $Lane = dst[..8].as_mut_ptr();
                // SAFETY: eight elements are there to write.
                unsafe { _mm256_storeu_ps(dst.cast(), self.ps()) }
            }
            #[inline(always)]
            fn load_block(block: &Block<$Lane>, chunk: usize) -> Self {
                let src: *const $Lane = block.0.as_chunks::<8>().0[chunk].as_ptr();
                // SAFETY: eight elements are there to read, 32 * chunk bytes into a block aligned to 64.
                Self::of_ps(unsafe { _mm256_load_ps(src.cast()) })
            }
            #[inline(always)]
            fn store_block(self, block: &mut Block<$Lane>, chunk: usize) {
                let dst: *mut $Lane = block.0.as_chunks_mut::<8>().0[chunk].as_mut_ptr();
                // SAFETY: eight elements are there to write, 32 * chunk bytes into a block aligned to 64.
                unsafe { _mm256_store_ps(dst.cast(), self.ps()) }
            }
            #[inline(always)]
            fn load_masked(src: &[$Lane], mask: Bool8, or: Self) -> Self {
                check_masked(src.len(), mask);
                // SAFETY: only lanes that are on are read, and the slice has those.
                let x = Self::of_ps(unsafe { _mm256_maskload_ps(src.as_ptr().cast(), mask.si()) });
                Self::select(mask, x, or)
            }
            #[inline(always)]
            fn store_masked(self, dst: &mut [$Lane], mask: Bool8) {
                check_masked(dst.len(), mask);
                // SAFETY: only lanes that are on are written, and the slice has those.
                unsafe { _mm256_maskstore_ps(dst.as_mut_ptr().cast(), mask.si(), self.ps()) }
            }
            #[inline(always)]
            fn load_partial(src: &[$Lane]) -> Self {
                let n = src.len().min(8);
                Self::load_masked(&src[..n], Bool8::first_n(n), Self::default())
            }
            #[inline(always)]
            fn store_partial(self, dst: &mut [$Lane]) {
                let n = dst.len().min(8);
                self.store_masked(&mut dst[..n], Bool8::first_n(n));
            }
            #[inline(always)]
            fn stream(dst: &mut [Block<$Lane>], mut f: impl FnMut(usize) -> Self) {
                let _fence = StreamFence;
                for (i, chunk) in Block::flatten_mut(dst).as_chunks_mut::<8>().0.iter_mut().enumerate() {
                    let x = f(i).ps();
                    // SAFETY: eight elements are there to write, at a multiple of 32 bytes into blocks aligned to 64; the fence
                    // comes before anybody else can look.
                    unsafe { _mm256_stream_ps(chunk.as_mut_ptr().cast(), x) }
                }
            }
            #[inline(always)]
            fn gather_masked(src: &[$Lane], index: Uint8, mask: Bool8, or: Self) -> Self {
                check_bounds::<Self>(src.len(), index, mask);
                if src.len() > i32::MAX as usize {
                    // The instruction takes indices as signed.
                    return Self::from_fn(|i| if mask.bitmask() >> i & 1 != 0 { src[index.lane(i) as usize] } else { or.lane(i) });
                }
                let base: *const f32 = src.as_ptr().cast();
                // SAFETY: the lanes that are on have indices below `src.len()`; the others are not read.
                Self::of_ps(unsafe { _mm256_mask_i32gather_ps::<4>(or.ps(), base, index.0, mask.0) })
            }
            #[inline(always)]
            fn load_rows4(rows: &[[$Lane; 4]]) -> [Self; 4] {
                Self::load_fields(rows, 0)
            }
            #[inline(always)]
            fn store_rows4(columns: [Self; 4], rows: &mut [[$Lane; 4]]) {
                Self::store_fields(columns, rows, 0);
            }
            #[inline(always)]
            fn load_rows8(rows: &[[$Lane; 8]]) -> [Self; 8] {
                let ([a, b, c, d], [e, f, g, h]) = (Self::load_fields(rows, 0), Self::load_fields(rows, 4));
                [a, b, c, d, e, f, g, h]
            }
            #[inline(always)]
            fn store_rows8([a, b, c, d, e, f, g, h]: [Self; 8], rows: &mut [[$Lane; 8]]) {
                Self::store_fields([a, b, c, d], rows, 0);
                Self::store_fields([e, f, g, h], rows, 4);
            }
            #[inline(always)]
            fn select(mask: Bool8, on_true: Self, on_false: Self) -> Self {
                let (t, f, m) = (on_true.ps(), on_false.ps(), mask.0);
                Self::of_ps(intrinsics!(_mm256_blendv_ps(f, t, m)))
            }
            #[inline(always)]
            fn lookup(self, index: Uint8) -> Self {
                let x = self.ps();
                Self::of_ps(intrinsics!(_mm256_permutevar8x32_ps(x, index.0)))
            }
            #[inline(always)]
            fn interleave(self, other: Self) -> (Self, Self) {
                let (a, b) = (self.ps(), other.ps());
                let (low, high) = intrinsics! {
                    let (even, odd) = (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
                    (_mm256_permute2f128_ps::<0x20>(even, odd), _mm256_permute2f128_ps::<0x31>(even, odd))
                };
                (Self::of_ps(low), Self::of_ps(high))
            }
            #[inline(always)]
            fn deinterleave(self, other: Self) -> (Self, Self) {
                let (a, b) = (self.ps(), other.ps());
                let (even, odd) = intrinsics! {
                    let (low, high) = (_mm256_permute2f128_ps::<0x20>(a, b), _mm256_permute2f128_ps::<0x31>(a, b));
                    (_mm256_shuffle_ps::<0b10_00_10_00>(low, high), _mm256_shuffle_ps::<0b11_01_11_01>(low, high))
                };
                (Self::of_ps(even), Self::of_ps(odd))
            }
            #[inline(always)]
            fn compress(self, mask: Bool8) -> Self {
                let lanes: *const Lanes8 = &COMPRESS8[mask.bitmask() as usize % 256];
                // SAFETY: 32 bytes are there to read, aligned to as many.
                let lanes = Uint8(unsafe { _mm256_load_si256(lanes.cast()) });
                let packed = self.lookup(lanes).ps();
                Self::of_ps(intrinsics!(_mm256_blendv_ps(packed, _mm256_setzero_ps(), lanes.ps())))
            }
            #[inline(always)]
            fn reduce_min(self) -> $Lane {
                let (low, high) = self.halves();
                low.min(high).reduce_min()
            }
            #[inline(always)]
            fn reduce_max(self) -> $Lane {
                let (low, high) = self.halves();
                low.max(high).reduce_max()
            }
            $($given)*
        }
    };
}
pub(super) use vector;
