//! Bytes as a glTF file: an error or a model that is sound, never a panic.
#![no_main]

use fuzz::{one_thread, with_file};
use libfuzzer_sys::fuzz_target;
use tracer::model::gltf;
use tracer::progress::Silent;

fuzz_target!(init: one_thread(), |bytes: &[u8]| {
    with_file("a.glb", bytes, |path| {
        if let Ok((model, _warnings)) = gltf::read(path, &Silent) {
            model.validate().expect("what was read is sound");
        }
    });
});
