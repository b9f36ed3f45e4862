//! Bytes as a PLY file: an error or a model that is sound, never a panic.
#![no_main]

use fuzz::{one_thread, with_file};
use libfuzzer_sys::fuzz_target;
use tracer::model::ply;
use tracer::progress::Silent;

fuzz_target!(init: one_thread(), |bytes: &[u8]| {
    with_file("a.ply", bytes, |path| {
        if let Ok((model, _warnings)) = ply::read(path, &Silent) {
            model.validate().expect("what was read is sound");
        }
    });
});
