//! What the tests and benches of the workspace share.

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
