//! Sorting rays (Garanzha and Loop 2010, section 3.1): scans, radix sort, hashes of rays, and the scheme that puts them together.
//!
//! Everything here is the same, bit for bit, at every level and on any number of threads of the current rayon pool.

mod output;
mod scan;

pub use scan::{compact, exclusive_scan, head_flags, segmented_scan};
