//! What the tests and benches of the workspace share.

pub mod agreement;
pub mod brute_force;

/// The README's Rust, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;

use std::path::{Path, PathBuf};

/// The file of a real scene (`conference`, `crytek_sponza`, `country_kitchen`): `NAME.obj.zst` in the folder that the
/// environment variable `TRACER_SCENES` names, else in `../shared/scenes` beside the workspace.
///
/// Where there is none, says so and how to get it, so that the caller can skip what needs it.
///
/// # Panics
/// When the scene is missing and the environment variable `CI` is set: there nothing may be skipped.
#[must_use]
pub fn real_scene(name: &str) -> Option<PathBuf> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/scenes");
    let folder = std::env::var_os("TRACER_SCENES").map_or_else(beside, PathBuf::from);
    let path = folder.join(format!("{name}.obj.zst"));
    if path.is_file() {
        return Some(path);
    }
    let message = format!(
        "{name}: scene not found, skipped (to get it: put {name}.obj.zst and {name}.mtl into a folder and set \
         TRACER_SCENES to it; looked in {})",
        folder.display()
    );
    assert!(std::env::var_os("CI").is_none(), "{message}");
    println!("{message}");
    None
}

/// SplitMix64: the same numbers everywhere.
#[derive(Debug, Clone)]
pub struct Random(pub u64);

impl Random {
    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    /// Between 0 and 1, 24 bits.
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1 << 24) as f32
    }

    /// Between `low` and `high`.
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + self.unit() * (high - low)
    }

    /// One of the items.
    pub fn pick<T: Copy>(&mut self, items: &[T]) -> T {
        items[(self.bits() % items.len() as u64) as usize]
    }
}
