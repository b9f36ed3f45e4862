//! aarch64, four lanes: Advanced SIMD.

use super::tables::COMPRESS4;
use super::{check_bounds, intrinsics, list_lanes, mask_basics, operators, vector_basics};
use crate::pair::Pair;
use crate::vector::sealed::{List, Sealed};
use crate::{Block, Float, Int, Integer, Isa, Level, Mask, Simd, Uint, Vector};
use std::arch::aarch64::*;
use std::fmt;
use std::ops::*;

// ---- The set ----

/// Advanced SIMD with fused multiply-add, which every aarch64 has.
#[derive(Debug, Clone, Copy)]
pub struct Neon;
impl Sealed for Neon {}
impl Simd for Neon {
    const LEVEL: Level = Level::of_backend(Isa::Neon);
    type Float4 = Float4;
    type Int4 = Int4;
    type Uint4 = Uint4;
    type Bool4 = Bool4;
    type Float8 = Pair<Float4>;
    type Int8 = Pair<Int4>;
    type Uint8 = Pair<Uint4>;
    type Bool8 = Pair<Bool4>;
    type Float16 = Pair<Self::Float8>;
    type Int16 = Pair<Self::Int8>;
    type Uint16 = Pair<Self::Uint8>;
    type Bool16 = Pair<Self::Bool8>;
    type Float = Float4;
}

/// A type over its register.
macro_rules! register {
    ($($(#[$doc:meta])* $V:ident($reg:ty);)*) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy)]
        #[repr(transparent)]
        pub struct $V($reg);

        impl $V {
            #[inline(always)]
            fn new(x: $reg) -> Self {
                Self(x)
            }
        }
    )*};
}
register! {
    /// Four `f32`.
    Float4(float32x4_t);
    /// Four `i32`.
    Int4(int32x4_t);
    /// Four `u32`.
    Uint4(uint32x4_t);
    /// All bits of a true lane are ones, all of a false lane zeros.
    Bool4(uint32x4_t);
}
vector_basics!([] Float4, [] Int4, [] Uint4);

/// The bits of the lanes, whatever their type.
macro_rules! lane_bits {
    ($($V:ident, $x:ident: from $of:expr, to $to:expr;)*) => {$(
        impl $V {
            #[inline(always)]
            fn of_lane_bits($x: uint32x4_t) -> Self {
                Self($of)
            }
            #[inline(always)]
            fn lane_bits(self) -> uint32x4_t {
                let $x = self.0;
                $to
            }
        }
    )*};
}
lane_bits! {
    Float4, x: from intrinsics!(vreinterpretq_f32_u32(x)), to intrinsics!(vreinterpretq_u32_f32(x));
    Int4, x: from intrinsics!(vreinterpretq_s32_u32(x)), to intrinsics!(vreinterpretq_u32_s32(x));
    Uint4, x: from x, to x;
}

// ---- Masks ----

mask_basics!([] Bool4);

operators!([] Bool4:
    BitAnd bitand BitAndAssign bitand_assign = vandq_u32;
    BitOr bitor BitOrAssign bitor_assign = vorrq_u32;
    BitXor bitxor BitXorAssign bitxor_assign = veorq_u32;
);

impl Not for Bool4 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(intrinsics!(vmvnq_u32(self.0)))
    }
}

impl Bool4 {
    /// The bit of each lane in a bit mask.
    #[inline(always)]
    fn bit() -> uint32x4_t {
        Uint4::load(&[1, 2, 4, 8]).0
    }
}

impl Mask for Bool4 {
    const LANES: usize = 4;

    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self(Uint4::splat(u32::from(value).wrapping_neg()).0)
    }
    #[inline(always)]
    fn from_bitmask(bits: u32) -> Self {
        Self(intrinsics!(vtstq_u32(vdupq_n_u32(bits), Self::bit())))
    }
    #[inline(always)]
    fn bitmask(self) -> u32 {
        intrinsics!(vaddvq_u32(vandq_u32(self.0, Self::bit())))
    }
    #[inline(always)]
    fn any(self) -> bool {
        intrinsics!(vmaxvq_u32(self.0)) != 0
    }
    #[inline(always)]
    fn all(self) -> bool {
        intrinsics!(vminvq_u32(self.0)) != 0
    }
    #[inline(always)]
    fn count(self) -> usize {
        // A true lane is -1.
        intrinsics!(vaddvq_u32(self.0)).wrapping_neg() as usize
    }
}

// ---- What all lanes share ----

/// Table lookup by bytes; a number of a byte above 15 gives 0.
#[inline(always)]
fn lookup_bytes(x: uint32x4_t, bytes: uint8x16_t) -> uint32x4_t {
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

// ---- Floats ----

vector! {
    Float4, f32: splat vdupq_n_f32, load vld1q_f32 vld4q_f32, store vst1q_f32 vst4q_f32, four float32x4x4_t,
    select vbslq_f32, eq vceqq_f32, lt vcltq_f32, le vcleq_f32,
{
    // Not the instructions of these names: they return NaN when either is, and order the zeros.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(other.lt(self), self, other)
    }
    #[inline(always)]
    fn reduce_min(self) -> f32 {
        self.reduce(Self::min)
    }
    #[inline(always)]
    fn reduce_max(self) -> f32 {
        self.reduce(Self::max)
    }
} }

operators!([] Float4:
    Add add AddAssign add_assign = vaddq_f32;
    Sub sub SubAssign sub_assign = vsubq_f32;
    Mul mul MulAssign mul_assign = vmulq_f32;
    Div div DivAssign div_assign = vdivq_f32;
);

impl Neg for Float4 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(intrinsics!(vnegq_f32(self.0)))
    }
}

impl Float4 {
    /// The halves with each other, then lane 0 with lane 1.
    #[inline(always)]
    fn reduce(self, op: impl Fn(Self, Self) -> Self) -> f32 {
        let two = op(self, Self(intrinsics!(vextq_f32::<2>(self.0, self.0))));
        let one = op(two, Self(intrinsics!(vdupq_laneq_f32::<1>(two.0))));
        intrinsics!(vgetq_lane_f32::<0>(one.0))
    }
}

impl Float for Float4 {
    type Int = Int4;

    #[inline(always)]
    fn abs(self) -> Self {
        Self(intrinsics!(vabsq_f32(self.0)))
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Self(intrinsics!(vbslq_f32(vdupq_n_u32(1 << 31), sign.0, self.0)))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(intrinsics!(vsqrtq_f32(self.0)))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self(intrinsics!(vrndmq_f32(self.0)))
    }
    #[inline(always)]
    fn ceil(self) -> Self {
        Self(intrinsics!(vrndpq_f32(self.0)))
    }
    #[inline(always)]
    fn trunc(self) -> Self {
        Self(intrinsics!(vrndq_f32(self.0)))
    }
    #[inline(always)]
    fn round(self) -> Self {
        Self(intrinsics!(vrndnq_f32(self.0)))
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        Self(intrinsics!(vfmaq_f32(c.0, self.0, b.0)))
    }
    #[inline(always)]
    fn mul_sub(self, b: Self, c: Self) -> Self {
        self.mul_add(b, -c)
    }
    #[inline(always)]
    fn neg_mul_add(self, b: Self, c: Self) -> Self {
        Self(intrinsics!(vfmsq_f32(c.0, self.0, b.0)))
    }

    // The conversions saturate and take NaN to 0 by themselves.
    #[inline(always)]
    fn mul_add_exact(self, b: Self, c: Self) -> Self {
        Self(intrinsics!(vfmaq_f32(c.0, self.0, b.0)))
    }
    #[inline(always)]
    fn rcp_approx(self) -> Self {
        Self(intrinsics!(vrecpeq_f32(self.0)))
    }
    #[inline(always)]
    fn rsqrt_approx(self) -> Self {
        Self(intrinsics!(vrsqrteq_f32(self.0)))
    }
    #[inline(always)]
    fn to_int(self) -> Int4 {
        Int4(intrinsics!(vcvtq_s32_f32(self.0)))
    }
    #[inline(always)]
    fn to_uint(self) -> Uint4 {
        Uint4(intrinsics!(vcvtq_u32_f32(self.0)))
    }
    #[inline(always)]
    fn from_int(x: Int4) -> Self {
        Self(intrinsics!(vcvtq_f32_s32(x.0)))
    }
    #[inline(always)]
    fn from_uint(x: Uint4) -> Self {
        Self(intrinsics!(vcvtq_f32_u32(x.0)))
    }
    #[inline(always)]
    fn to_bits(self) -> Uint4 {
        Uint4(intrinsics!(vreinterpretq_u32_f32(self.0)))
    }
    #[inline(always)]
    fn from_bits(x: Uint4) -> Self {
        Self(intrinsics!(vreinterpretq_f32_u32(x.0)))
    }
    #[inline(always)]
    fn reduce_add(self) -> f32 {
        // Not the addition across lanes: its order is another.
        self.reduce(Self::add)
    }
}

// ---- Integers ----

/// A shift count modulo 32 in every lane.
#[inline(always)]
fn shift_count(n: usize) -> int32x4_t {
    intrinsics!(vdupq_n_s32((n % 32) as i32))
}

/// Operators that `i32` and `u32` share.
macro_rules! integer {
    ($V:ident: $add:ident $sub:ident $mul:ident $and:ident $or:ident $xor:ident $not:ident $shift:ident) => {
        operators!([] $V:
            Add add AddAssign add_assign = $add;
            Sub sub SubAssign sub_assign = $sub;
            Mul mul MulAssign mul_assign = $mul;
            BitAnd bitand BitAndAssign bitand_assign = $and;
            BitOr bitor BitOrAssign bitor_assign = $or;
            BitXor bitxor BitXorAssign bitxor_assign = $xor;
        );
        impl Not for $V {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self(intrinsics!($not(self.0)))
            }
        }
        impl Shl<usize> for $V {
            type Output = Self;
            #[inline(always)]
            fn shl(self, n: usize) -> Self {
                Self(intrinsics!($shift(self.0, shift_count(n))))
            }
        }
        impl Shr<usize> for $V {
            type Output = Self;
            #[inline(always)]
            fn shr(self, n: usize) -> Self {
                // To the right is to the left by a negative count.
                Self(intrinsics!($shift(self.0, vnegq_s32(shift_count(n)))))
            }
        }
        impl Integer for $V {
            #[inline(always)]
            fn shl_lanes(self, n: Uint4) -> Self {
                let n = Int4::from_uint(n & Uint4::splat(31));
                Self(intrinsics!($shift(self.0, n.0)))
            }
            #[inline(always)]
            fn shr_lanes(self, n: Uint4) -> Self {
                let n = Int4::from_uint(n & Uint4::splat(31));
                Self(intrinsics!($shift(self.0, vnegq_s32(n.0))))
            }
        }
    };
}
integer!(Int4: vaddq_s32 vsubq_s32 vmulq_s32 vandq_s32 vorrq_s32 veorq_s32 vmvnq_s32 vshlq_s32);
integer!(Uint4: vaddq_u32 vsubq_u32 vmulq_u32 vandq_u32 vorrq_u32 veorq_u32 vmvnq_u32 vshlq_u32);

vector! {
    Int4, i32: splat vdupq_n_s32, load vld1q_s32 vld4q_s32, store vst1q_s32 vst4q_s32, four int32x4x4_t,
    select vbslq_s32, eq vceqq_s32, lt vcltq_s32, le vcleq_s32,
{
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(intrinsics!(vminq_s32(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(intrinsics!(vmaxq_s32(self.0, other.0)))
    }
    #[inline(always)]
    fn reduce_min(self) -> i32 {
        intrinsics!(vminvq_s32(self.0))
    }
    #[inline(always)]
    fn reduce_max(self) -> i32 {
        intrinsics!(vmaxvq_s32(self.0))
    }
} }

impl Neg for Int4 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(intrinsics!(vnegq_s32(self.0)))
    }
}

impl Int for Int4 {
    #[inline(always)]
    fn abs(self) -> Self {
        Self(intrinsics!(vabsq_s32(self.0)))
    }
    #[inline(always)]
    fn to_uint(self) -> Uint4 {
        Uint4(intrinsics!(vreinterpretq_u32_s32(self.0)))
    }
    #[inline(always)]
    fn from_uint(x: Uint4) -> Self {
        Self(intrinsics!(vreinterpretq_s32_u32(x.0)))
    }
}

vector! {
    Uint4, u32: splat vdupq_n_u32, load vld1q_u32 vld4q_u32, store vst1q_u32 vst4q_u32, four uint32x4x4_t,
    select vbslq_u32, eq vceqq_u32, lt vcltq_u32, le vcleq_u32,
{
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(intrinsics!(vminq_u32(self.0, other.0)))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(intrinsics!(vmaxq_u32(self.0, other.0)))
    }
    #[inline(always)]
    fn reduce_min(self) -> u32 {
        intrinsics!(vminvq_u32(self.0))
    }
    #[inline(always)]
    fn reduce_max(self) -> u32 {
        intrinsics!(vmaxvq_u32(self.0))
    }
} }

impl Uint for Uint4 {
    #[inline(always)]
    fn mul_high(self, other: Self) -> Self {
        Self(intrinsics! {
            let low = vreinterpretq_u32_u64(vmull_u32(vget_low_u32(self.0), vget_low_u32(other.0)));
            let high = vreinterpretq_u32_u64(vmull_high_u32(self.0, other.0));
            vuzp2q_u32(low, high)
        })
    }
    #[inline(always)]
    fn count_ones(self) -> Self {
        Self(intrinsics!(vpaddlq_u16(vpaddlq_u8(vcntq_u8(vreinterpretq_u8_u32(self.0))))))
    }
    #[inline(always)]
    fn leading_zeros(self) -> Self {
        Self(intrinsics!(vclzq_u32(self.0)))
    }
}
