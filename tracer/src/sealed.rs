//! Files of this crate's own. Everything is little-endian: eight bytes that say of which kind the file is, the version (four bytes), the number
//! of bytes behind this header (eight bytes), a checksum of them (FNV-1a, eight bytes), and these bytes, in words of four.

use crate::Error;
use crate::hash::fnv1a_bytes;
use crate::output::write_atomically;
use std::path::Path;

/// A kind of file.
pub(crate) struct Kind {
    pub(crate) magic: &'static [u8; 8],
    pub(crate) version: u32,
    /// With its article, for messages.
    pub(crate) name: &'static str,
    /// What to do about a file that is of no use.
    pub(crate) remedy: &'static str,
}

pub(crate) const HEADER: usize = 8 + 4 + 8 + 8;

impl Kind {
    /// Writes a file of this kind. It appears whole or not at all.
    pub(crate) fn write(&self, path: &Path, body: &[u8]) -> Result<(), Error> {
        write_atomically(path, |out| {
            out.write_all(self.magic)?;
            out.write_all(&self.version.to_le_bytes())?;
            out.write_all(&(body.len() as u64).to_le_bytes())?;
            out.write_all(&fnv1a_bytes(body).to_le_bytes())?;
            out.write_all(body)
        })
    }

    /// What is behind the header, if the file is of this kind and whole.
    pub(crate) fn open<'a>(&self, bytes: &'a [u8]) -> Result<Words<'a>, String> {
        let Self { magic, version, name, remedy } = *self;
        let Some((header, body)) = bytes.split_at_checked(HEADER).filter(|(header, _)| header.starts_with(magic))
        else {
            return Err(format!("not {name}: {remedy}"));
        };
        let mut header = Words(&header[8..]);
        let found = header.word()?;
        if found != version {
            return Err(format!("{name} of version {found}, this program reads version {version}: {remedy}"));
        }
        let length = header.long()?;
        if length != body.len() as u64 {
            return Err(self.damaged(&format!("{} bytes where there should be {length}", body.len())));
        }
        if header.long()? != fnv1a_bytes(body) {
            return Err(self.damaged("the checksum is another"));
        }
        Ok(Words(body))
    }

    pub(crate) fn damaged(&self, what: &str) -> String {
        format!("damaged, {what}: {}", self.remedy)
    }
}

/// Bytes taken from the front.
pub(crate) struct Words<'a>(&'a [u8]);

impl<'a> Words<'a> {
    /// Bytes that are left.
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    pub(crate) fn word(&mut self) -> Result<u32, String> {
        let (word, rest) = self.0.split_first_chunk().ok_or("damaged, it ends too early")?;
        self.0 = rest;
        Ok(u32::from_le_bytes(*word))
    }

    pub(crate) fn long(&mut self) -> Result<u64, String> {
        Ok(u64::from(self.word()?) | u64::from(self.word()?) << 32)
    }

    pub(crate) fn floats<const N: usize>(&mut self) -> Result<[f32; N], String> {
        let mut floats = [0.0; N];
        for x in &mut floats {
            *x = f32::from_bits(self.word()?);
        }
        Ok(floats)
    }

    pub(crate) fn bytes(&mut self, len: usize) -> Result<&'a [u8], String> {
        let (bytes, rest) = self.0.split_at_checked(len).ok_or("damaged, it ends too early")?;
        self.0 = rest;
        Ok(bytes)
    }
}

#[cfg(test)]
/// The same file with the checksum that belongs to what it holds.
pub(crate) fn with_checksum(mut bytes: Vec<u8>) -> Vec<u8> {
    let sum = fnv1a_bytes(&bytes[HEADER..]);
    bytes[20..28].copy_from_slice(&sum.to_le_bytes());
    bytes
}
