//! The bytes that a document names.

use super::{Notes, named};
use crate::Error;
use crate::model::decompress;
use crate::progress::Progress;
use gltf::Document;
use gltf::buffer::{Source, View};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// All buffers of a document, each as long as it says at least.
pub(super) struct Buffers(Vec<Rc<Vec<u8>>>);

impl Buffers {
    /// Reads them: `blob` is the one inside of a `.glb` file.
    pub(super) fn read(
        document: &Document,
        blob: Option<Vec<u8>>,
        path: &Path,
        progress: &dyn Progress,
    ) -> Result<Self, Error> {
        let notes = Notes::new(path);
        let blob = blob.map(Rc::new);
        let mut files: HashMap<&str, Rc<Vec<u8>>> = HashMap::new();
        let mut buffers = Vec::new();
        for buffer in document.buffers() {
            let what = named("buffer", buffer.index(), buffer.name());
            let bytes = match buffer.source() {
                Source::Bin => blob.clone().ok_or_else(|| {
                    notes.error(format!(
                        "{what} has no uri, and the file no binary part: it is damaged, export it again"
                    ))
                })?,
                Source::Uri(uri) => match files.get(uri) {
                    Some(bytes) => Rc::clone(bytes),
                    None => {
                        let bytes = Rc::new(fetch(uri, &what, path, progress)?);
                        files.insert(uri, Rc::clone(&bytes));
                        bytes
                    }
                },
            };
            if bytes.len() < buffer.length() {
                let (has, says) = (bytes.len(), buffer.length());
                return Err(
                    notes.error(format!("{what} has {has} bytes instead of {says}: it is cut short, get it again"))
                );
            }
            buffers.push(bytes);
        }
        Ok(Self(buffers))
    }

    /// The bytes of a view.
    pub(super) fn view(&self, view: &View<'_>) -> Result<&[u8], String> {
        let buffer = &self.0[view.buffer().index()];
        let end = view.offset().checked_add(view.length());
        end.and_then(|end| buffer.get(view.offset()..end)).ok_or_else(|| {
            let (what, buffer, len) = (view.index(), view.buffer().index(), buffer.len());
            format!("buffer view {what} reaches beyond the {len} bytes of buffer {buffer}")
        })
    }

    /// Bytes in all.
    pub(super) fn len(&self) -> usize {
        self.0.iter().map(|b| b.len()).sum()
    }
}

/// What an address names: data inside of it, or a file beside `path`.
pub(super) fn fetch(uri: &str, what: &str, path: &Path, progress: &dyn Progress) -> Result<Vec<u8>, Error> {
    let notes = Notes::new(path);
    if let Some(data) = uri.strip_prefix("data:") {
        let text = data.split_once(";base64,").map(|(_, text)| text);
        return text
            .and_then(base64)
            .ok_or_else(|| notes.error(format!("the data of {what} are not acceptable as base64")));
    }
    if uri.contains("://") {
        return Err(notes.error(format!("{what} is at {uri:?}: only files beside the scene are read")));
    }
    let file = locate(uri, path);
    // A device never ends.
    if file.exists() && !file.is_file() {
        return Err(notes.error(format!("{what}: {} is no file", file.display())));
    }
    decompress::read(&file, progress)
}

/// The file beside `path`, as the address is written or with its `%20` and the like decoded.
fn locate(uri: &str, path: &Path) -> PathBuf {
    let folder = path.parent().unwrap_or(Path::new(""));
    let plain = folder.join(uri);
    if plain.exists() { plain } else { folder.join(percent_decoded(uri)) }
}

fn percent_decoded(uri: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = uri.as_bytes();
    while let Some((&first, others)) = rest.split_first() {
        let code = others.get(..2).filter(|_| first == b'%').and_then(|hex| str::from_utf8(hex).ok());
        match code.and_then(|hex| u8::from_str_radix(hex, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = &others[2..];
            }
            None => {
                bytes.push(first);
                rest = others;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// RFC 4648, section 4; padding may be missing.
fn base64(text: &str) -> Option<Vec<u8>> {
    let text = text.trim_end_matches('=');
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 2);
    let (mut bits, mut n) = (0_u32, 0);
    for c in text.bytes() {
        let six = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(six);
        n += 6;
        if n >= 8 {
            n -= 8;
            bytes.push((bits >> n) as u8);
        }
    }
    // One letter alone is no byte.
    (n < 6).then_some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The test vectors of RFC 4648.
    #[test]
    fn base64_of_the_standard() {
        for (text, bytes) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYg==", "foob"),
            ("Zm9vYmE", "fooba"),
            ("Zm9vYmFy", "foobar"),
        ] {
            assert_eq!(base64(text).as_deref(), Some(bytes.as_bytes()), "{text}");
        }
        assert_eq!(base64("+/+/"), Some(vec![0xfb, 0xff, 0xbf]));
        for text in ["Z", "Zm9vY", "Zm 9v", "Zm9v\n", "Zm=v", "Zm9-"] {
            assert_eq!(base64(text), None, "{text}");
        }
    }

    #[test]
    fn addresses() {
        for (uri, name) in
            [("a%20b.bin", "a b.bin"), ("%C3%BC", "\u{fc}"), ("100%", "100%"), ("%zz%4", "%zz%4"), ("%2541", "%41")]
        {
            assert_eq!(percent_decoded(uri), name);
        }
    }
}
