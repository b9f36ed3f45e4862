//! Whole files in memory, unpacked.

use crate::Error;
use crate::progress::Progress;
use flate2::read::MultiGzDecoder;
use ruzstd::decoding::errors::{FrameDecoderError, ReadFrameHeaderError};
use ruzstd::decoding::{FrameDecoder, StreamingDecoder};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

/// Reads a file; one whose name ends in `.gz` or `.zst` is unpacked. The stage's units are bytes of the file.
pub(super) fn read(path: &Path, progress: &dyn Progress) -> Result<Vec<u8>, Error> {
    let io = |action| move |source| Error::Io { action, path: path.to_owned(), source };
    let file = File::open(path).map_err(io("open"))?;
    let size = file.metadata().map_err(io("open"))?.len();
    progress.stage("read", size);
    let source = BufReader::with_capacity(1 << 17, Watched { file, progress });
    let mut bytes = Vec::new();
    let packing = path.extension().map(|e| e.to_ascii_lowercase());
    let (packing, result) = match packing.as_ref().and_then(|e| e.to_str()) {
        Some("gz") => ("gzip", MultiGzDecoder::new(source).read_to_end(&mut bytes).map(|_| ())),
        Some("zst") => ("zstd", unpack_zstd(source, &mut bytes)),
        _ => {
            let room = bytes.try_reserve(usize::try_from(size).unwrap_or(usize::MAX));
            room.map_err(|_| io("read")(io::ErrorKind::OutOfMemory.into()))?;
            ("", { source }.read_to_end(&mut bytes).map(|_| ()))
        }
    };
    progress.check()?;
    match result {
        Ok(()) => Ok(bytes),
        // What the operating system says has a number; what an unpacker says has none.
        Err(e) if packing.is_empty() || e.raw_os_error().is_some() => Err(io("read")(e)),
        Err(e) => Err(Error::Data {
            path: path.to_owned(),
            line: None,
            message: format!("the {packing} data are damaged or cut short ({e}): get or pack the file again"),
        }),
    }
}

/// All frames of a zstd file (parallel packers write several), skippable ones skipped, checksums compared.
fn unpack_zstd(mut source: impl BufRead, bytes: &mut Vec<u8>) -> io::Result<()> {
    let mut decoder = FrameDecoder::new();
    let mut frames = 0;
    while frames == 0 || !source.fill_buf()?.is_empty() {
        frames += 1;
        let mut stream = match StreamingDecoder::new_with_decoder(&mut source, &mut decoder) {
            Ok(stream) => stream,
            Err(FrameDecoderError::ReadFrameHeaderError(ReadFrameHeaderError::SkipFrame { length, .. })) => {
                let skipped = io::copy(&mut (&mut source).take(length.into()), &mut io::sink())?;
                if skipped < length.into() {
                    return Err(io::ErrorKind::UnexpectedEof.into());
                }
                continue;
            }
            Err(e) => return Err(io::Error::other(e)),
        };
        stream.read_to_end(bytes)?;
        let stored = decoder.get_checksum_from_data();
        if stored.is_some() && stored != decoder.get_calculated_checksum() {
            return Err(io::Error::other("wrong checksum"));
        }
    }
    Ok(())
}

/// A file that tells how far it has been read and fails when the work is cancelled.
struct Watched<'a> {
    file: File,
    progress: &'a dyn Progress,
}

impl Read for Watched<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.progress.cancelled() {
            return Err(io::Error::other("cancelled"));
        }
        let n = self.file.read(buffer)?;
        self.progress.advance(n as u64);
        Ok(n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Silent;
    use flate2::Compression;
    use flate2::write::GzEncoder;
    use ruzstd::encoding::{CompressionLevel, compress_to_vec};
    use std::io::Write;
    use std::sync::atomic::AtomicBool;

    fn gz(text: &[u8]) -> Vec<u8> {
        let mut packer = GzEncoder::new(Vec::new(), Compression::fast());
        packer.write_all(text).expect("packed");
        packer.finish().expect("packed")
    }

    fn zst(text: &[u8]) -> Vec<u8> {
        compress_to_vec(text, CompressionLevel::Fastest)
    }

    fn unpack(name: &str, content: &[u8]) -> Result<Vec<u8>, Error> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(name);
        std::fs::write(&path, content).expect("written");
        read(&path, &Silent)
    }

    fn text() -> Vec<u8> {
        (0..30_000_u32).flat_map(|i| (i * i).to_string().into_bytes()).collect()
    }

    #[test]
    fn unpacks_by_name() {
        let text = text();
        for (name, packed) in [("a.obj", text.clone()), ("a.obj.gz", gz(&text)), ("a.OBJ.ZST", zst(&text))] {
            assert!(unpack(name, &packed).expect(name) == text, "{name}");
        }
    }

    #[test]
    fn several_parts_in_one_file() {
        let expected = b"first second";
        let skippable = b"\x50\x2a\x4d\x18\x03\0\0\0abc".to_vec();
        assert_eq!(unpack("a.gz", &[gz(b"first "), gz(b"second")].concat()).expect("two members"), expected);
        let frames = [skippable.clone(), zst(b"first "), skippable, zst(b"second")].concat();
        assert_eq!(unpack("a.zst", &frames).expect("two frames"), expected);
    }

    #[test]
    fn damage_is_told_from_data() {
        let text = text();
        for (name, packed) in [("a.gz", gz(&text)), ("a.zst", zst(&text))] {
            for cut in [0, 1, 7, packed.len() / 2, packed.len() - 1] {
                let e = unpack(name, &packed[..cut]).expect_err("cut short");
                assert!(e.to_string().contains("damaged or cut short"), "{e}");
            }
            let mut damaged = packed.clone();
            let last = damaged.len() - 6;
            damaged[last] ^= 0x10;
            unpack(name, &damaged).expect_err("one bit is wrong");
            unpack(name, b"v 0 0 0\nnot packed at all").expect_err("not packed");
        }
    }

    #[test]
    fn cancelled_work_says_so() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.zst");
        std::fs::write(&path, zst(&text())).expect("written");
        assert!(matches!(read(&path, &AtomicBool::new(true)), Err(Error::Cancelled)));
        assert!(matches!(read(&folder.path().join("none"), &Silent), Err(Error::Io { action: "open", .. })));
    }
}
