//! The tables of a PLY file, number by number.

use super::header::{Element, Form, Format, Header, Kind, Property};
use crate::Error;
use std::path::Path;

/// Where reading has come to.
pub(super) struct Body<'a> {
    bytes: &'a [u8],
    at: usize,
    format: Format,
    /// Of a text: the rest of the row, and its line.
    row: &'a [u8],
    line: usize,
    /// The element that is read and its number, for messages.
    what: String,
    number: usize,
    told: usize,
    path: &'a Path,
}

impl<'a> Body<'a> {
    pub(super) fn new(bytes: &'a [u8], header: &Header, path: &'a Path) -> Self {
        let (at, line) = (header.end, header.lines);
        let what = String::new();
        Self { bytes, at, format: header.format, row: &[], line, what, number: 0, told: 0, path }
    }

    /// Begins a row: a line that is not blank, in a text.
    pub(super) fn begin(&mut self, element: &Element, number: usize) -> Result<(), Error> {
        self.number = number;
        if number == 0 {
            self.what.clone_from(&element.name);
        }
        if self.format != Format::Ascii {
            return Ok(());
        }
        loop {
            let rest = &self.bytes[self.at..];
            if rest.is_empty() {
                return self.cut_short();
            }
            let end = rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(rest.len());
            self.row = rest[..end].trim_ascii();
            let newline = if rest[end..].starts_with(b"\r\n") { 2 } else { 1 };
            self.at = self.bytes.len().min(self.at + end + newline);
            self.line += 1;
            if !self.row.is_empty() {
                return Ok(());
            }
        }
    }

    /// Ends a row: nothing may be left of its line.
    pub(super) fn end(&mut self) -> Result<(), Error> {
        if self.row.is_empty() {
            return Ok(());
        }
        let rest = String::from_utf8_lossy(self.row);
        let rest: String = rest.chars().take(30).collect();
        self.fail(format!("{} {} goes on with {rest:?} after what the header says", self.what, self.number))
    }

    /// The next number; all types are exact in `f64`.
    pub(super) fn number(&mut self, kind: Kind) -> Result<f64, Error> {
        if self.format == Format::Ascii {
            return self.word(kind);
        }
        let Some(bytes) = self.bytes.get(self.at..self.at + kind.size()) else {
            return self.cut_short();
        };
        let mut word = [0; 8];
        word[..bytes.len()].copy_from_slice(bytes);
        if self.format == Format::BigEndian {
            word[..bytes.len()].reverse();
        }
        self.at += bytes.len();
        let [a, b, c, d, ..] = word;
        Ok(match kind {
            Kind::I8 => i8::from_le_bytes([a]).into(),
            Kind::U8 => a.into(),
            Kind::I16 => i16::from_le_bytes([a, b]).into(),
            Kind::U16 => u16::from_le_bytes([a, b]).into(),
            Kind::I32 => i32::from_le_bytes([a, b, c, d]).into(),
            Kind::U32 => u32::from_le_bytes([a, b, c, d]).into(),
            Kind::F32 => f32::from_le_bytes([a, b, c, d]).into(),
            Kind::F64 => f64::from_le_bytes(word),
        })
    }

    fn word(&mut self, kind: Kind) -> Result<f64, Error> {
        let end = self.row.iter().position(u8::is_ascii_whitespace).unwrap_or(self.row.len());
        let (word, rest) = self.row.split_at(end);
        self.row = rest.trim_ascii_start();
        if word.is_empty() {
            return self.fail(format!("{} {} has fewer numbers than the header says", self.what, self.number));
        }
        let text = str::from_utf8(word).unwrap_or_default();
        let number = match kind {
            // Rounded once.
            Kind::F32 => text.parse::<f32>().ok().map(f64::from),
            Kind::F64 => text.parse().ok(),
            _ => text.parse::<i64>().ok().map(|n| n as f64),
        };
        match number {
            Some(number) => Ok(number),
            None => {
                let (word, whole) = (String::from_utf8_lossy(word), !matches!(kind, Kind::F32 | Kind::F64));
                self.fail(format!("{word:?} is not a {}", if whole { "whole number" } else { "number" }))
            }
        }
    }

    /// The length of a list.
    pub(super) fn len(&mut self, kind: Kind) -> Result<usize, Error> {
        let len = self.number(kind)?;
        if len < 0.0 {
            return self.fail(format!("{} {} has a list of {len} items", self.what, self.number));
        }
        Ok(len as usize)
    }

    pub(super) fn skip(&mut self, property: &Property) -> Result<(), Error> {
        match property.form {
            Form::Scalar(kind) => self.number(kind).map(|_| ()),
            Form::List { len, item } => {
                for _ in 0..self.len(len)? {
                    self.number(item)?;
                }
                Ok(())
            }
        }
    }

    /// For how many rows to make room: no more than there are bytes left.
    pub(super) fn at_most(&self, count: usize) -> usize {
        // The shortest row of three numbers, or of a list.
        count.min((self.bytes.len() - self.at) / 3)
    }

    /// Bytes read since it was last asked.
    pub(super) fn untold(&mut self) -> u64 {
        (self.at - std::mem::replace(&mut self.told, self.at)) as u64
    }

    fn cut_short<T>(&self) -> Result<T, Error> {
        let (what, number) = (&self.what, self.number);
        let path = self.path.to_owned();
        let message = format!("the file ends in {what} {number} (counted from 0): it is cut short, get it again");
        Err(Error::Data { path, line: None, message })
    }

    /// An error here: in this line, or before this byte.
    pub(super) fn fail<T>(&self, message: impl Into<String>) -> Result<T, Error> {
        let (line, message) = match self.format {
            Format::Ascii => (Some(self.line), message.into()),
            _ => (None, format!("byte {}: {}", self.at, message.into())),
        };
        Err(Error::Data { path: self.path.to_owned(), line, message })
    }
}
