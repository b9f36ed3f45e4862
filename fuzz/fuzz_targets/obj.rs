//! Bytes as an OBJ file: an error or a model that is sound, never a panic.
#![no_main]

use fuzz::{one_thread, with_file};
use libfuzzer_sys::fuzz_target;
use tracer::model::obj;
use tracer::progress::Silent;

fuzz_target!(init: one_thread(), |bytes: &[u8]| {
    with_file("a.obj", bytes, |path| {
        if let Ok((model, _warnings)) = obj::read(path, &Silent) {
            model.validate().expect("what was read is sound");
        }
    });
});
