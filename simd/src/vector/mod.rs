//! The operations: the traits [`Simd`], [`Vector`], [`Float`], [`Int`], [`Uint`], [`Narrow`] and [`Mask`].
//!
//! Every operation returns the same bits on every backend and at every width, with exceptions that say so: the *relaxed*
//! `mul_add` family, which is fused where the hardware has it, `product_error` where something under- or overflows, and which
//! of the many NaNs a NaN result is.
//! No backend flushes denormals to zero or fuses what is written apart: `a * b + c` rounds twice.
//!
//! Lane 0 is the first in memory. Integer arithmetic wraps.

use crate::Level;
use std::fmt::Debug;

mod double;
mod float;
pub(crate) mod integer;
mod lanes;
mod mask;
pub(crate) mod narrow;

pub use double::Double;
pub use float::Float;
pub use integer::{Int, Integer, Uint};
pub(crate) use lanes::check_masked;
pub use lanes::{Halves, Vector};
pub use mask::{Mask, SetLanes};
pub use narrow::{Char, Narrow, Short, UChar, UShort};

pub(crate) mod sealed {
    /// Keeps the traits of this crate implementable by its backends alone.
    pub trait Sealed {}

    /// Lists the lanes, for `Debug`.
    pub trait List {
        fn list(&self, list: &mut std::fmt::DebugList<'_, '_>);
    }
}
use sealed::Sealed;

/// An instruction set: its vector types. Reached through [`Kernel::run`](crate::Kernel::run) only.
///
/// The types carry the seed paper's names, float4, int4 and bool4, and their 8- and 16-wide kin. One mask per width serves
/// all lane types.
pub trait Simd: Sealed + Copy + Debug + Send + Sync + 'static {
    /// The level these types belong to.
    const LEVEL: Level;

    /// Four `f32`.
    #[doc(alias("float4", "f32x4", "vfloat4"))]
    type Float4: Float<Mask = Self::Bool4, Int = Self::Int4, Index = Self::Uint4>;
    /// Four `i32`.
    #[doc(alias("int4", "i32x4", "vint4"))]
    type Int4: Int<Mask = Self::Bool4, Index = Self::Uint4>;
    /// Four `u32`.
    #[doc(alias("uint4", "u32x4", "vuint4"))]
    type Uint4: Uint<Mask = Self::Bool4>;
    /// Mask of four lanes.
    #[doc(alias("bool4", "mask32x4", "vbool4"))]
    type Bool4: Mask;

    /// Eight `f32`.
    #[doc(alias("float8", "f32x8", "vfloat8"))]
    type Float8: Float<Mask = Self::Bool8, Int = Self::Int8, Index = Self::Uint8> + Halves<Half = Self::Float4>;
    /// Eight `i32`.
    #[doc(alias("int8", "i32x8", "vint8"))]
    type Int8: Int<Mask = Self::Bool8, Index = Self::Uint8> + Halves<Half = Self::Int4>;
    /// Eight `u32`.
    #[doc(alias("uint8", "u32x8", "vuint8"))]
    type Uint8: Uint<Mask = Self::Bool8> + Halves<Half = Self::Uint4>;
    /// Mask of eight lanes.
    #[doc(alias("bool8", "mask32x8", "vbool8"))]
    type Bool8: Mask;

    /// Sixteen `f32`.
    #[doc(alias("float16", "f32x16", "vfloat16"))]
    type Float16: Float<Mask = Self::Bool16, Int = Self::Int16, Index = Self::Uint16> + Halves<Half = Self::Float8>;
    /// Sixteen `i32`.
    #[doc(alias("int16", "i32x16", "vint16"))]
    type Int16: Int<Mask = Self::Bool16, Index = Self::Uint16> + Halves<Half = Self::Int8>;
    /// Sixteen `u32`.
    #[doc(alias("uint16", "u32x16", "vuint16"))]
    type Uint16: Uint<Mask = Self::Bool16> + Halves<Half = Self::Uint8>;
    /// Mask of sixteen lanes.
    #[doc(alias("bool16", "mask32x16", "vbool16"))]
    type Bool16: Mask;

    /// Two `f64`.
    #[doc(alias("double2", "f64x2", "vdouble2"))]
    type Double2: Double;
    /// Four `f64`.
    #[doc(alias("double4", "f64x4", "vdouble4"))]
    type Double4: Double + Halves<Half = Self::Double2>;
    /// Eight `f64`.
    #[doc(alias("double8", "f64x8", "vdouble8"))]
    type Double8: Double + Halves<Half = Self::Double4>;

    /// `f32` in the width of this level's registers.
    type Float: Float;

    /// Eight `i16`.
    #[doc(alias("short8", "i16x8", "vshort8"))]
    type Short8: Short<Unsigned = Self::UShort8, Wide = Self::Int4>;
    /// Eight `u16`.
    #[doc(alias("ushort8", "u16x8", "vushort8"))]
    type UShort8: UShort<Mask = <Self::Short8 as Narrow>::Mask, Signed = Self::Short8, Wide = Self::Uint4>;
    /// Sixteen `i16`.
    #[doc(alias("short16", "i16x16", "vshort16"))]
    type Short16: Short<Unsigned = Self::UShort16, Wide = Self::Int8>;
    /// Sixteen `u16`.
    #[doc(alias("ushort16", "u16x16", "vushort16"))]
    type UShort16: UShort<Mask = <Self::Short16 as Narrow>::Mask, Signed = Self::Short16, Wide = Self::Uint8>;

    /// Sixteen `i8`.
    #[doc(alias("char16", "i8x16", "vchar16"))]
    type Char16: Char<Unsigned = Self::UChar16, Wide = Self::Short8>;
    /// Sixteen `u8`.
    #[doc(alias("uchar16", "u8x16", "vuchar16"))]
    type UChar16: UChar<Mask = <Self::Char16 as Narrow>::Mask, Signed = Self::Char16, Wide = Self::UShort8>;
    /// Thirty-two `i8`.
    #[doc(alias("char32", "i8x32", "vchar32"))]
    type Char32: Char<Unsigned = Self::UChar32, Wide = Self::Short16>;
    /// Thirty-two `u8`.
    #[doc(alias("uchar32", "u8x32", "vuchar32"))]
    type UChar32: UChar<Mask = <Self::Char32 as Narrow>::Mask, Signed = Self::Char32, Wide = Self::UShort16>;
}

/// The type of one lane: `f32`, `i32`, `u32` or `f64`, and `i16`, `u16`, `i8`, `u8`.
pub trait Lane: Sealed + Copy + Debug + Default + PartialEq + PartialOrd + Send + Sync + 'static {
    /// Not smaller than any other value (infinity for floats).
    const LARGEST: Self;
    /// Not larger than any other value (minus infinity for floats).
    const SMALLEST: Self;
}
