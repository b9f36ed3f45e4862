//! x86, four lanes: what vectors of all lane types share.

use super::*;

/// Columns to rows, and back.
#[inline(always)]
pub(super) fn transpose([a, b, c, d]: [__m128; 4]) -> [__m128; 4] {
    intrinsics! {
        let (ab_lo, ab_hi) = (_mm_unpacklo_ps(a, b), _mm_unpackhi_ps(a, b));
        let (cd_lo, cd_hi) = (_mm_unpacklo_ps(c, d), _mm_unpackhi_ps(c, d));
        [
            _mm_movelh_ps(ab_lo, cd_lo),
            _mm_movehl_ps(cd_lo, ab_lo),
            _mm_movelh_ps(ab_hi, cd_hi),
            _mm_movehl_ps(cd_hi, ab_hi),
        ]
    }
}

/// Lanes 2, 3, 2, 3.
#[inline(always)]
pub(super) fn upper_half(x: __m128) -> __m128 {
    intrinsics!(_mm_movehl_ps(x, x))
}

/// Lane 1 in lane 0.
#[inline(always)]
pub(super) fn lane1(x: __m128) -> __m128 {
    intrinsics!(_mm_shuffle_ps::<0b01>(x, x))
}

/// Orders streaming stores before whatever comes after them, also when what is stored panics.
pub(in crate::backend) struct StreamFence;
impl Drop for StreamFence {
    #[inline(always)]
    fn drop(&mut self) {
        intrinsics!(_mm_sfence());
    }
}

/// [`Vector`] of one lane type: memory in common, comparisons given.
macro_rules! vector {
    ($V:ident, $Lane:ty, $x:ident: splat $splat:expr, { $($given:tt)* }) => {
        impl<I: Sse> Vector for $V<I> {
            type Lane = $Lane;
            type Mask = Bool4<I>;
            type Index = Uint4<I>;
            const LANES: usize = 4;

            #[inline(always)]
            fn splat($x: $Lane) -> Self {
                Self::new(intrinsics!($splat))
            }
            #[inline(always)]
            fn load(src: &[$Lane]) -> Self {
                let src: *const $Lane = src[..4].as_ptr();
                // SAFETY: four elements are there to read.
                Self::of_ps(unsafe { _mm_loadu_ps(src.cast()) })
            }
            #[inline(always)]
            fn store(self, dst: &mut [$Lane]) {
                let dst: *mut $Lane = dst[..4].as_mut_ptr();
                // SAFETY: four elements are there to write.
                unsafe { _mm_storeu_ps(dst.cast(), self.ps()) }
            }
            #[inline(always)]
            fn load_block(block: &Block<$Lane>, chunk: usize) -> Self {
                let src: *const $Lane = block.0.as_chunks::<4>().0[chunk].as_ptr();
                // SAFETY: four elements are there to read, 16 * chunk bytes into a block aligned to 64.
                Self::of_ps(unsafe { _mm_load_ps(src.cast()) })
            }
            #[inline(always)]
            fn store_block(self, block: &mut Block<$Lane>, chunk: usize) {
                let dst: *mut $Lane = block.0.as_chunks_mut::<4>().0[chunk].as_mut_ptr();
                // SAFETY: four elements are there to write, 16 * chunk bytes into a block aligned to 64.
                unsafe { _mm_store_ps(dst.cast(), self.ps()) }
            }
            #[inline(always)]
            fn stream(dst: &mut [Block<$Lane>], mut f: impl FnMut(usize) -> Self) {
                let _fence = StreamFence;
                for (i, chunk) in Block::flatten_mut(dst).as_chunks_mut::<4>().0.iter_mut().enumerate() {
                    let x = f(i).ps();
                    // SAFETY: four elements are there to write, at a multiple of 16 bytes into blocks aligned to 64; the fence
                    // comes before anybody else can look.
                    unsafe { _mm_stream_ps(chunk.as_mut_ptr().cast(), x) }
                }
            }
            #[inline(always)]
            fn gather_masked(src: &[$Lane], index: Uint4<I>, mask: Bool4<I>, or: Self) -> Self {
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
                let [a, b, c, d] = transpose([
                    Self::load(&rows[0]).ps(),
                    Self::load(&rows[1]).ps(),
                    Self::load(&rows[2]).ps(),
                    Self::load(&rows[3]).ps(),
                ]);
                [Self::of_ps(a), Self::of_ps(b), Self::of_ps(c), Self::of_ps(d)]
            }
            #[inline(always)]
            fn store_rows4([a, b, c, d]: [Self; 4], rows: &mut [[$Lane; 4]]) {
                let [a, b, c, d] = transpose([a.ps(), b.ps(), c.ps(), d.ps()]);
                let rows = &mut rows[..4];
                Self::of_ps(a).store(&mut rows[0]);
                Self::of_ps(b).store(&mut rows[1]);
                Self::of_ps(c).store(&mut rows[2]);
                Self::of_ps(d).store(&mut rows[3]);
            }
            #[inline(always)]
            fn select(mask: Bool4<I>, on_true: Self, on_false: Self) -> Self {
                let (t, f, m) = (on_true.ps(), on_false.ps(), mask.0);
                Self::of_ps(intrinsics! {
                    if const { I::SSE41 } {
                        _mm_blendv_ps(f, t, m)
                    } else {
                        _mm_or_ps(_mm_and_ps(m, t), _mm_andnot_ps(m, f))
                    }
                })
            }
            #[inline(always)]
            fn lookup(self, index: Uint4<I>) -> Self {
                let x = self.ps();
                if const { I::AVX2 } {
                    return Self::of_ps(intrinsics!(_mm_permutevar_ps(x, index.0)));
                }
                if const { I::SSE41 } {
                    return Self::of_ps(intrinsics! {
                        // Numbers of bytes: four times the index, in four bytes, plus 0, 1, 2, 3.
                        let low_byte = _mm_setr_epi8(0, 0, 0, 0, 4, 4, 4, 4, 8, 8, 8, 8, 12, 12, 12, 12);
                        let lane = _mm_and_si128(_mm_shuffle_epi8(index.0, low_byte), _mm_set1_epi8(3));
                        let byte = _mm_add_epi8(_mm_slli_epi32::<2>(lane), _mm_set1_epi32(0x0302_0100));
                        _mm_castsi128_ps(_mm_shuffle_epi8(_mm_castps_si128(x), byte))
                    });
                }
                let (table, index) = (self.to_block(), index.to_block());
                Self::from_fn(|i| table.0[(index.0[i] % 4) as usize])
            }
            #[inline(always)]
            fn interleave(self, other: Self) -> (Self, Self) {
                let (a, b) = (self.ps(), other.ps());
                let (low, high) = intrinsics!((_mm_unpacklo_ps(a, b), _mm_unpackhi_ps(a, b)));
                (Self::of_ps(low), Self::of_ps(high))
            }
            #[inline(always)]
            fn deinterleave(self, other: Self) -> (Self, Self) {
                let (a, b) = (self.ps(), other.ps());
                let (even, odd) = intrinsics! {
                    (_mm_shuffle_ps::<0b10_00_10_00>(a, b), _mm_shuffle_ps::<0b11_01_11_01>(a, b))
                };
                (Self::of_ps(even), Self::of_ps(odd))
            }
            #[inline(always)]
            fn compress(self, mask: Bool4<I>) -> Self {
                let bits = mask.bitmask() as usize % 16;
                if const { I::SSE41 } {
                    let bytes: *const [u8; 16] = &COMPRESS4[bits];
                    // SAFETY: sixteen bytes are there to read.
                    let bytes = unsafe { _mm_loadu_si128(bytes.cast()) };
                    let x = self.ps();
                    return Self::of_ps(intrinsics!(_mm_castsi128_ps(_mm_shuffle_epi8(_mm_castps_si128(x), bytes))));
                }
                let (lanes, mut block, mut n) = (self.to_block(), Block::default(), 0);
                for i in 0..4 {
                    // Written always, moved on from where the mask is true: no branch.
                    block.0[n % 8] = lanes.0[i];
                    n += bits >> i & 1;
                }
                block.0[n % 8] = Default::default();
                Self::load_block(&block, 0)
            }
            #[inline(always)]
            fn reduce_min(self) -> $Lane {
                let two = self.min(Self::of_ps(upper_half(self.ps())));
                two.min(Self::of_ps(lane1(two.ps()))).first()
            }
            #[inline(always)]
            fn reduce_max(self) -> $Lane {
                let two = self.max(Self::of_ps(upper_half(self.ps())));
                two.max(Self::of_ps(lane1(two.ps()))).first()
            }
            $($given)*
        }
    };
}
pub(super) use vector;
