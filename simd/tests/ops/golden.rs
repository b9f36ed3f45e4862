//! Same bits everywhere: hashes of what each operation gives at each width, which every level of every processor has to match.
//!
//! They are in `golden.txt`. After a change of tests or operations, write them anew and look at what changed:
//!
//! ```text
//! SIMD_GOLDEN=$PWD/target/golden cargo test -p simd --test ops
//! LC_ALL=C sort -u target/golden > simd/tests/ops/golden.txt; rm target/golden
//! ```

use simd::Level;
use std::io::Write;

const GOLDEN: &str = include_str!("golden.txt");

/// FNV-1a, a word at a time.
#[derive(Clone, Copy)]
pub struct Hash(u64);

impl Hash {
    pub fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
    pub fn add(&mut self, bits: u32) {
        self.0 = (self.0 ^ u64::from(bits)).wrapping_mul(0x0100_0000_01b3);
    }
    /// A float, of which NaN are all the same.
    pub fn add_number(&mut self, bits: u32) {
        self.add(if f32::from_bits(bits).is_nan() { 0x7fc0_0000 } else { bits });
    }

    /// Compares with the golden hash of this name and number of lanes.
    pub fn check(self, level: Level, name: &str, lanes: usize) {
        // The FPU of a CPU without SSE2 makes signalling NaNs quiet on their way: not even the arguments are the same there.
        if cfg!(all(target_arch = "x86", not(target_feature = "sse2"))) {
            return;
        }
        let line = format!("{name} {lanes} {:016x}", self.0);
        if let Some(path) = std::env::var_os("SIMD_GOLDEN") {
            let mut file = std::fs::OpenOptions::new().create(true).append(true).open(path).unwrap();
            file.write_all(format!("{line}\n").as_bytes()).unwrap();
            return;
        }
        let name = format!("{name} {lanes} ");
        let golden = GOLDEN.lines().find(|golden| golden.starts_with(&name));
        assert_eq!(Some(&*line), golden, "{level}: not the same bits as elsewhere");
    }
}
