//! Sorting rays (Garanzha and Loop 2010, section 3.1): scans, radix sort, hashes of rays, and the scheme that puts them together.
//!
//! Everything here is the same, bit for bit, at every level and on any number of threads of the current rayon pool.

mod chunks;
mod hash;
mod order;
mod output;
mod radix;
mod scan;
mod sorter;
#[cfg(test)]
mod test;

pub use chunks::Chunks;
pub use hash::{RayHash, Reorder, z_order};
pub use order::RaySort;
pub use radix::RadixSort;
pub use scan::{compact, exclusive_scan, head_flags, segmented_scan};
pub use sorter::RaySorter;
