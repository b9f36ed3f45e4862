//! Bytes as a saved scene: an error, or a scene whose queries end.
#![no_main]

use fuzz::{one_thread, some_rays, with_file};
use libfuzzer_sys::fuzz_target;
use simd::Level;
use tracer::Scene;
use tracer::geometry::HitBatch;
use tracer::method::BitVec;

/// As they are, or behind a header that fits (magic, version, length, FNV-1a): the checksum would stop all else.
fn file(bytes: &[u8]) -> Vec<u8> {
    let Some((&0, body)) = bytes.split_first() else { return bytes.to_vec() };
    let mix = |sum: u64, &byte: &u8| (sum ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    let sum = body.iter().fold(0xcbf2_9ce4_8422_2325, mix);
    let mut file = b"TRACER\r\n".to_vec();
    file.extend(2_u32.to_le_bytes());
    file.extend((body.len() as u64).to_le_bytes());
    file.extend(sum.to_le_bytes());
    file.extend(body);
    file
}

fuzz_target!(init: one_thread(), |bytes: &[u8]| {
    with_file("a.scene", &file(bytes), |path| {
        let Ok(scene) = Scene::load(path, Level::best()) else { return };
        let (rays, mut hits, mut occluded) = (some_rays(), HitBatch::new(), BitVec::new());
        scene.closest_batch(&rays, &mut hits);
        scene.occluded_batch(&rays, &mut occluded);
        for (i, ray) in rays.iter().enumerate() {
            if let Some(hit) = scene.closest(&ray) {
                let _ = scene.locate(hit.primitive);
            }
            let _ = (scene.occluded(&ray), hits.get(i), occluded.get(i));
        }
    });
});
