//! All operations in one table: what they mean, what they do with NaN, and what they compile to.
//!
//! Every operation returns the same bits on every level and at every width, with two exceptions: those marked *relaxed*, and which of
//! the many NaNs a NaN result is. No level flushes denormals to zero or fuses what is written apart.
//!
//! The columns of levels are for vectors as wide as the level's registers: four lanes for SSE, NEON and wasm, eight for AVX2, sixteen for
//! AVX-512; wider vectors are made of those. `Double` is four lanes in those columns. Vectors of 16- and 8-bit lanes (`Narrow`) are 16 bytes in those columns, 32 for AVX2 and
//! AVX-512. *By lanes*: in scalar code, through memory. *Composed*: of others in this table. Instructions are those for `f32` or for all
//! lane types, `...` stands for their kin. The methods' own documentation says more.
//!
//! VSX, which nightly Rust alone has, is without a column. It is much as NEON with other names (`xvaddsp` for `fadd`, `vadduwm` for
//! `add`, `xxsel` for `bsl`, `vperm` for `tbl`), but for these: estimates divide, as on wasm; `trunc` is `floor` of the magnitude;
//! `reduce_min` and `reduce_max` are a tree for integers too; rows of 4 are interleaved twice; `mul_high` is composed; `Narrow` is by
//! lanes.
//!
#![doc = include_str!("vector/operations.md")]
