//! How the idioms of other libraries are written here: `wide`, `pulp`, `fearless_simd`, `std::simd`, ISPC, Embree.
//!
//! Everywhere the same three steps: write a function generic over one vector type, `fn f<F: Float>(..)`; name the width inside of a
//! kernel, `f::<S::Float8>(..)`; run it at a level.
//!
//! ```
//! use simd::{Float, Level, Mask, Simd, Vector};
//!
//! #[inline(always)]
//! fn clamped_sum<F: Float>(numbers: &[f32]) -> f32 {
//!     let mut sum = F::splat(0.0);
//!     let mut chunks = numbers.chunks_exact(F::LANES);
//!     for chunk in &mut chunks {
//!         sum += F::load(chunk).clamp(F::splat(0.0), F::splat(1.0));
//!     }
//!     // What is left over: zeros fill the vector.
//!     sum += F::load_partial(chunks.remainder()).clamp(F::splat(0.0), F::splat(1.0));
//!     sum.reduce_add()
//! }
//!
//! simd::kernel! {
//!     fn sum<S>(numbers: &[f32]) -> f32 {
//!         clamped_sum::<S::Float8>(numbers)
//!     }
//! }
//!
//! let numbers = [2.0, 0.5, -3.0, 0.25, 1.0];
//! for level in Level::available() {
//!     assert_eq!(sum(level, &numbers), 2.75);
//! }
//! ```
//!
//! # From `wide`
//!
//! `wide` chooses its instructions when the program is compiled, and its types are concrete. The nearest thing is
//! [`native`](crate::native); a kernel gives run-time dispatch beside it.
//!
//! | `wide` | here |
//! |---|---|
//! | `f32x8` | `S::Float8` in a kernel, [`native::Float8`](crate::native::Float8) outside |
//! | `f32x8::new(array)`, `f32x8::from(slice)` | `F::load(&array)` |
//! | `v.to_array()` | `v.to_block().0`, or `v.store(&mut array)` |
//! | `a.cmp_lt(b)` (bits in floats) | `a.lt(b)`, a [`Mask`](crate::Mask) |
//! | `mask.blend(t, f)` | `F::select(mask, t, f)` |
//! | `mask.move_mask()` | `mask.bitmask()` |
//! | `a.mul_add(b, c)` (fused if compiled so) | `a.mul_add(b, c)` relaxed; `a.mul_add_exact(b, c)` everywhere the same |
//! | `a.fast_min(b)`, `a.min(b)` | `a.min(b)`, `a.min_num(b)` |
//! | `v.round_int()`, `v.trunc_int()` | `v.round().to_int()`, `v.to_int()` |
//! | `v.sin_cos()`, `v.exp()`, `v.pow_f32x8(w)` | `math::sin_cos(v)`, `math::exp(v)`, `math::pow(v, w)`: the same bits at every level |
//! | `f32x8::transpose(rows)` | `F::transpose(&mut rows)` |
//! | values of its types | feature `wide`: `From` and `Into` with blocks ([`interop`](crate::interop)) |
//!
//! # From `pulp`
//!
//! | `pulp` | here |
//! |---|---|
//! | `Arch::new().dispatch(op)` | `Level::best().run(kernel)`, or a function made by [`kernel!`](crate::kernel) |
//! | `impl WithSimd for Op { fn with_simd<S: Simd>(self, simd: S) }` | [`kernel!`](crate::kernel) writes it; by hand: [`Kernel`](crate::Kernel) |
//! | `simd.add_f32s(a, b)` | `a + b` |
//! | `S::f32s`, as wide as the level likes | `S::Float`; `S::Float4`, `S::Float8`, `S::Float16` for a width |
//! | `S::as_simd_f32s(slice)`: vectors and a tail | `slice.chunks_exact(F::LANES)` and `F::load_partial(tail)` |
//! | `simd.select_f32s_m32s(m, a, b)` | `F::select(m, a, b)` |
//! | `simd.reduce_sum_f32s(v)` (order by level) | `v.reduce_add()` (order by width alone) |
//! | no SSE level, no gather, no fixed widths | all of them |
//!
//! # From `fearless_simd`
//!
//! | `fearless_simd` | here |
//! |---|---|
//! | `Level::new()` | [`Level::best`](crate::Level::best), [`Level::cached`](crate::Level::cached) |
//! | `dispatch!(level, simd => f(simd, x))` | `dispatch!(level, \|S, x: T\| -> U { f::<S::Float8>(x) })` |
//! | `f32x4::from_slice(simd, &a)`, a token in every call | `F::load(&a)`, no token |
//! | `simd.select_f32x4(m, a, b)`, `m.select(a, b)` | `F::select(m, a, b)` |
//! | `a.zip_low(b)`, `a.zip_high(b)` | `a.interleave(b)` |
//! | `a.madd(b, c)` | `a.mul_add(b, c)` |
//! | `S::f32s` | `S::Float` |
//!
//! # From `std::simd` (nightly)
//!
//! | `std::simd` | here |
//! |---|---|
//! | `Simd<f32, 8>`, `f32x8` | `S::Float8` |
//! | `f32x8::from_slice(s)`, `copy_to_slice` | `F::load(s)`, `store` |
//! | `load_or_default`, `load_select`, `store_select` | `load_partial`, `load_masked`, `store_masked` |
//! | `gather_or`, `scatter_select` | `gather_masked`, `scatter_masked`; out of bounds panics |
//! | `a.simd_lt(b)`, `mask.select(t, f)` | `a.lt(b)`, `F::select(mask, t, f)` |
//! | `simd_swizzle!(v, [..])`, `swizzle_dyn` | `v.swizzle(\|i\| ..)`, `v.lookup(index)` |
//! | `simd_min` (IEEE `minNum`) | `min_num`; `min` is x86's |
//! | `reduce_sum` (order unspecified) | `reduce_add` (order documented) |
//! | `interleave`, `deinterleave`, `rotate_elements_left` | `interleave`, `deinterleave`, `rotate_lanes_left` |
//!
//! # From ISPC
//!
//! | ISPC | here |
//! |---|---|
//! | `varying float x` | `x: F` |
//! | `uniform float x` | `x: f32`; `F::splat(x)` where they meet |
//! | `programCount`, `programIndex` | `F::LANES`, `F::Index::from_fn(\|i\| i as u32)` |
//! | `foreach (i = 0 ... n)` | `chunks_exact(F::LANES)` and `load_partial`, `store_partial` |
//! | `if (x < y) { a = b; }` | `a = F::select(x.lt(y), b, a)` |
//! | `while (any(mask))`, `any`, `all`, `none` | `while mask.any()`, `all`, `none` |
//! | `foreach_active (i)` | `for lane in mask.set_lanes()` |
//! | `packed_store_active(dst, x)` | `x.compress_store(mask, dst)` |
//! | `a[index]` with varying `index` | `F::gather(a, index)`, `x.scatter(a, index)` |
//! | `reduce_add(x)`, `exclusive_scan_add(x)` | `x.reduce_add()`, `x.prefix_sum_exclusive()` |
//! | `shuffle(x, i)`, `rotate(x, n)`, `broadcast(x, i)` | `x.lookup(i)`, `x.rotate_lanes_left(n)`, `F::splat(x.lane(i))` |
//! | `soa<8> struct` | [`Block`](crate::Block)s of each field; `load_rows2` to `load_rows8` |
//! | `--target=sse4-i32x4,avx2-i32x8,...` | every level in one binary; `SIMD_LEVEL` picks one |
//!
//! # From Embree's `common/simd`
//!
//! | Embree | here |
//! |---|---|
//! | `vfloat4`, `vint8`, `vuint16`, `vbool4` | `S::Float4`, `S::Int8`, `S::Uint16`, `S::Bool4` |
//! | `vfloat<N>` in a template | `F: Float` |
//! | `select(m, t, f)`, `movemask(m)`, `popcnt(m)` | `F::select(m, t, f)`, `m.bitmask()`, `m.count()` |
//! | `madd`, `msub`, `nmadd`, `nmsub` | `mul_add`, `mul_sub`, `neg_mul_add`, `neg_mul_sub` |
//! | `rcp(x)`, `rsqrt(x)` (one step of Newton's) | `x.rcp()`, `x.rsqrt()` (two steps, 2 ulp) |
//! | `reduce_min(x)`, `select_min(m, x)` | `x.reduce_min()`, `x.min_index(m)` |
//! | `vfloat4::compact(m, x)` | `x.compress(m)` |
//! | `vfloat4::gather(p, i)` | `F::gather(p, i)` |
//! | `transpose(r0, r1, r2, r3, c0, ...)` | `F::transpose(&mut rows)`, `F::load_rows4(rows)` |
//! | `shuffle<1, 0, 3, 2>(x)` | `x.swizzle(\|i\| i ^ 1)` |
//! | one compilation per ISA, function pointers | [`Level::run`](crate::Level::run) |
