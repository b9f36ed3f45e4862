//! AVX-512: what vectors of all lane types share.

use super::*;

/// Columns to rows, and back, in each quarter by itself.
#[inline(always)]
pub(super) fn transpose([a, b, c, d]: [__m512; 4]) -> [__m512; 4] {
    intrinsics! {
        let (ab_lo, ab_hi) = (_mm512_unpacklo_ps(a, b), _mm512_unpackhi_ps(a, b));
        let (cd_lo, cd_hi) = (_mm512_unpacklo_ps(c, d), _mm512_unpackhi_ps(c, d));
        [
            _mm512_shuffle_ps::<0b01_00_01_00>(ab_lo, cd_lo),
            _mm512_shuffle_ps::<0b11_10_11_10>(ab_lo, cd_lo),
            _mm512_shuffle_ps::<0b01_00_01_00>(ab_hi, cd_hi),
            _mm512_shuffle_ps::<0b11_10_11_10>(ab_hi, cd_hi),
        ]
    }
}

/// A register from its quarters.
#[inline(always)]
pub(super) fn join(a: __m128, b: __m128, c: __m128, d: __m128) -> __m512 {
    intrinsics! {
        let low = _mm512_castps256_ps512(_mm256_set_m128(b, a));
        _mm512_insertf32x8::<1>(low, _mm256_set_m128(d, c))
    }
}

/// [`Vector`] of one lane type: memory in common, comparisons given.
macro_rules! vector {
    ($V:ident, $Half:ty, $Quarter:ty, $Lane:ty, $x:ident: splat $splat:expr, { $($given:tt)* }) => {
        impl $V {
            #[inline(always)]
            pub(in crate::backend) fn halves(self) -> ($Half, $Half) {
                let x = self.ps();
                let (low, high) = intrinsics!((_mm512_castps512_ps256(x), _mm512_extractf32x8_ps::<1>(x)));
                (<$Half>::of_ps(low), <$Half>::of_ps(high))
            }

            /// Fields `at` to `at + 3` of sixteen rows.
            #[inline(always)]
            fn load_fields<const N: usize>(rows: &[[$Lane; N]], at: usize) -> [Self; 4] {
                let rows = &rows[..16];
                let [a, b, c, d] = transpose([
                    join(<$Quarter>::load(&rows[0][at..]).ps(), <$Quarter>::load(&rows[4][at..]).ps(), <$Quarter>::load(&rows[8][at..]).ps(), <$Quarter>::load(&rows[12][at..]).ps()),
                    join(<$Quarter>::load(&rows[1][at..]).ps(), <$Quarter>::load(&rows[5][at..]).ps(), <$Quarter>::load(&rows[9][at..]).ps(), <$Quarter>::load(&rows[13][at..]).ps()),
                    join(<$Quarter>::load(&rows[2][at..]).ps(), <$Quarter>::load(&rows[6][at..]).ps(), <$Quarter>::load(&rows[10][at..]).ps(), <$Quarter>::load(&rows[14][at..]).ps()),
                    join(<$Quarter>::load(&rows[3][at..]).ps(), <$Quarter>::load(&rows[7][at..]).ps(), <$Quarter>::load(&rows[11][at..]).ps(), <$Quarter>::load(&rows[15][at..]).ps()),
                ]);
                [Self::of_ps(a), Self::of_ps(b), Self::of_ps(c), Self::of_ps(d)]
            }

            /// The inverse.
            #[inline(always)]
            fn store_fields<const N: usize>([a, b, c, d]: [Self; 4], rows: &mut [[$Lane; N]], at: usize) {
                let rows = &mut rows[..16];
                let [a, b, c, d] = transpose([a.ps(), b.ps(), c.ps(), d.ps()]);
                for (i, row) in [a, b, c, d].into_iter().enumerate() {
                    let (low, high) = Self::of_ps(row).halves();
                    let ((a, b), (c, d)) = (low.halves(), high.halves());
                    a.store(&mut rows[i][at..]);
                    b.store(&mut rows[i + 4][at..]);
                    c.store(&mut rows[i + 8][at..]);
                    d.store(&mut rows[i + 12][at..]);
                }
            }
        }

        impl Halves for $V {
            type Half = $Half;

            #[inline(always)]
            fn from_halves(low: $Half, high: $Half) -> Self {
                let (low, high) = (low.ps(), high.ps());
                Self::of_ps(intrinsics!(_mm512_insertf32x8::<1>(_mm512_castps256_ps512(low), high)))
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
            type Mask = Bool16;
            type Index = Uint16;
            const LANES: usize = 16;

            #[inline(always)]
            fn splat($x: $Lane) -> Self {
                Self::new(intrinsics!($splat))
            }
            #[inline(always)]
            fn load(src: &[$Lane]) -> Self {
                let src: *const $Lane = src[..16].as_ptr();
                // SAFETY: sixteen elements are there to read.
                Self::of_ps(unsafe { _mm512_loadu_ps(src.cast()) })
            }
            #[inline(always)]
            fn store(self, dst: &mut [$Lane]) {
                let dst: *mut $Lane = dst[..16].as_mut_ptr();
                // SAFETY: sixteen elements are there to write.
                unsafe { _mm512_storeu_ps(dst.cast(), self.ps()) }
            }
            #[inline(always)]
            fn load_block(block: &Block<$Lane>, chunk: usize) -> Self {
                let src: *const $Lane = block.0.as_chunks::<16>().0[chunk].as_ptr();
                // SAFETY: sixteen elements are there to read, 64 * chunk bytes into a block aligned to 64.
                Self::of_ps(unsafe { _mm512_load_ps(src.cast()) })
            }
            #[inline(always)]
            fn store_block(self, block: &mut Block<$Lane>, chunk: usize) {
                let dst: *mut $Lane = block.0.as_chunks_mut::<16>().0[chunk].as_mut_ptr();
                // SAFETY: sixteen elements are there to write, 64 * chunk bytes into a block aligned to 64.
                unsafe { _mm512_store_ps(dst.cast(), self.ps()) }
            }
            #[inline(always)]
            fn load_masked(src: &[$Lane], mask: Bool16, or: Self) -> Self {
                check_masked(src.len(), mask);
                // SAFETY: only lanes that are on are read, and the slice has those.
                Self::of_ps(unsafe { _mm512_mask_loadu_ps(or.ps(), mask.0, src.as_ptr().cast()) })
            }
            #[inline(always)]
            fn store_masked(self, dst: &mut [$Lane], mask: Bool16) {
                check_masked(dst.len(), mask);
                // SAFETY: only lanes that are on are written, and the slice has those.
                unsafe { _mm512_mask_storeu_ps(dst.as_mut_ptr().cast(), mask.0, self.ps()) }
            }
            #[inline(always)]
            fn load_partial(src: &[$Lane]) -> Self {
                let n = src.len().min(16);
                Self::load_masked(&src[..n], Bool16::first_n(n), Self::default())
            }
            #[inline(always)]
            fn store_partial(self, dst: &mut [$Lane]) {
                let n = dst.len().min(16);
                self.store_masked(&mut dst[..n], Bool16::first_n(n));
            }
            #[inline(always)]
            fn stream(dst: &mut [Block<$Lane>], mut f: impl FnMut(usize) -> Self) {
                let _fence = StreamFence;
                for (i, block) in dst.iter_mut().enumerate() {
                    let x = f(i).ps();
                    // SAFETY: sixteen elements are there to write, aligned to 64 bytes; the fence comes before anybody else can look.
                    unsafe { _mm512_stream_ps(block.0.as_mut_ptr().cast(), x) }
                }
            }
            #[inline(always)]
            fn scatter_masked(self, dst: &mut [$Lane], index: Uint16, mask: Bool16) {
                check_bounds::<Self>(dst.len(), index, mask);
                if dst.len() > i32::MAX as usize {
                    // The instruction takes indices as signed.
                    return mask.set_lanes().for_each(|i| dst[index.lane(i) as usize] = self.lane(i));
                }
                let base: *mut f32 = dst.as_mut_ptr().cast();
                // SAFETY: the lanes that are on have indices below `dst.len()`; the others are not written.
                unsafe { _mm512_mask_i32scatter_ps::<4>(base.cast(), mask.0, index.0, self.ps()) }
            }
            #[inline(always)]
            fn gather_masked(src: &[$Lane], index: Uint16, mask: Bool16, or: Self) -> Self {
                check_bounds::<Self>(src.len(), index, mask);
                if src.len() > i32::MAX as usize {
                    // The instruction takes indices as signed.
                    return Self::from_fn(|i| if mask.bitmask() >> i & 1 != 0 { src[index.lane(i) as usize] } else { or.lane(i) });
                }
                let base: *const f32 = src.as_ptr().cast();
                // SAFETY: the lanes that are on have indices below `src.len()`; the others are not read.
                Self::of_ps(unsafe { _mm512_mask_i32gather_ps::<4>(or.ps(), mask.0, index.0, base) })
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
            fn select(mask: Bool16, on_true: Self, on_false: Self) -> Self {
                Self::of_ps(intrinsics!(_mm512_mask_blend_ps(mask.0, on_false.ps(), on_true.ps())))
            }
            #[inline(always)]
            fn lookup(self, index: Uint16) -> Self {
                let x = self.ps();
                Self::of_ps(intrinsics!(_mm512_permutexvar_ps(index.0, x)))
            }
            #[inline(always)]
            fn interleave(self, other: Self) -> (Self, Self) {
                let (a, b) = (self.ps(), other.ps());
                let lane = |at: usize| Uint16::from_fn(|i| (at + i / 2 + 16 * (i % 2)) as u32).0;
                let (low, high) = (lane(0), lane(8));
                let (low, high) = intrinsics!((_mm512_permutex2var_ps(a, low, b), _mm512_permutex2var_ps(a, high, b)));
                (Self::of_ps(low), Self::of_ps(high))
            }
            #[inline(always)]
            fn deinterleave(self, other: Self) -> (Self, Self) {
                let (a, b) = (self.ps(), other.ps());
                let (even, odd) = (Uint16::from_fn(|i| 2 * i as u32).0, Uint16::from_fn(|i| 2 * i as u32 + 1).0);
                let (even, odd) = intrinsics!((_mm512_permutex2var_ps(a, even, b), _mm512_permutex2var_ps(a, odd, b)));
                (Self::of_ps(even), Self::of_ps(odd))
            }
            #[inline(always)]
            fn compress(self, mask: Bool16) -> Self {
                let x = self.ps();
                Self::of_ps(intrinsics!(_mm512_maskz_compress_ps(mask.0, x)))
            }
            #[inline(always)]
            fn expand(self, mask: Bool16) -> Self {
                let x = self.ps();
                Self::of_ps(intrinsics!(_mm512_maskz_expand_ps(mask.0, x)))
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
