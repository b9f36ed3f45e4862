//! The text at the start of a PLY file that says what follows.

use crate::Error;
use std::path::{Path, PathBuf};

/// How numbers are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Format {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// Types of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Kind {
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    fn is_whole(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// Bytes in a binary file.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    Scalar(Kind),
    List { len: Kind, item: Kind },
}

#[derive(Debug, PartialEq, Eq)]
pub(super) struct Property {
    pub(super) name: String,
    pub(super) form: Form,
}

/// A table of the file.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
}

impl Element {
    /// The place of a property that is a number.
    pub(super) fn scalar(&self, name: &str) -> Option<usize> {
        self.properties.iter().position(|p| p.name == name && matches!(p.form, Form::Scalar(_)))
    }

    /// The place of a property that is a list.
    pub(super) fn list(&self, name: &str) -> Option<usize> {
        self.properties.iter().position(|p| p.name == name && matches!(p.form, Form::List { .. }))
    }
}

#[derive(Debug)]
pub(super) struct Header {
    path: PathBuf,
    pub(super) format: Format,
    pub(super) elements: Vec<Element>,
    /// Where the tables begin: byte, and line before.
    pub(super) end: usize,
    pub(super) lines: usize,
}

impl Header {
    pub(super) fn parse(bytes: &[u8], path: &Path) -> Result<Self, Error> {
        let fail = |line, message: String| Error::Data { path: path.to_owned(), line, message };
        // Old Macs end lines with \r alone.
        let mac = bytes.starts_with(b"ply\r") && !bytes.starts_with(b"ply\r\n");
        let newline = if mac { b'\r' } else { b'\n' };
        let (mut format, mut elements) = (None, Vec::new());
        let (mut at, mut line) = (0, 0);
        loop {
            let Some(end) = bytes[at..].iter().position(|&b| b == newline).map(|n| at + n) else {
                let message = if line == 0 {
                    "no PLY file: it does not begin with the line \"ply\""
                } else {
                    "the header has no end_header"
                };
                return Err(fail(None, message.into()));
            };
            let text = String::from_utf8_lossy(&bytes[at..end]);
            (at, line) = (end + 1, line + 1);
            let words: Vec<&str> = text.split_ascii_whitespace().collect();
            match words[..] {
                ["ply"] if line == 1 => {}
                _ if line == 1 => {
                    return Err(fail(None, "no PLY file: it does not begin with the line \"ply\"".into()));
                }
                [] | ["comment" | "obj_info", ..] => {}
                ["end_header"] => break,
                ["format", name, "1.0"] => format = Some(format_of(name).map_err(|e| fail(Some(line), e))?),
                ["element", name, count] => match count.parse() {
                    Ok(count) => elements.push(Element { name: name.into(), count, properties: Vec::new() }),
                    Err(_) => return Err(fail(Some(line), format!("{count:?} is not a number of elements"))),
                },
                ["property", .., name] => {
                    let property = property(&words, name).map_err(|e| fail(Some(line), e))?;
                    match elements.last_mut() {
                        Some(element) => element.properties.push(property),
                        None => return Err(fail(Some(line), "a property before the first element".into())),
                    }
                }
                _ => {
                    let text = text.trim().chars().take(60).collect::<String>();
                    return Err(fail(Some(line), format!("{text:?} is no line of a PLY header of version 1.0")));
                }
            }
        }
        let Some(format) = format else {
            return Err(fail(None, "the header has no line \"format\"".into()));
        };
        let header = Self { path: path.to_owned(), format, elements, end: at, lines: line };
        // What takes no bytes could be there any number of times.
        match header.elements.iter().find(|e| e.properties.is_empty() && e.count > 0) {
            Some(e) => Err(header.error(format!("the header gives elements {:?} no properties", e.name))),
            None => Ok(header),
        }
    }

    /// How many vertices are announced.
    pub(super) fn vertices(&self) -> Result<usize, Error> {
        for name in ["vertex", "face"] {
            if self.elements.iter().filter(|e| e.name == name).count() > 1 {
                return Err(self.error(format!("the header has several elements {name:?}")));
            }
        }
        match self.elements.iter().find(|e| e.name == "vertex") {
            Some(e) if u32::try_from(e.count).is_ok() => Ok(e.count),
            Some(e) => {
                Err(self.error(format!("there are {} vertices, {} is the most: split the scene", e.count, u32::MAX)))
            }
            None => Err(self.error("the header has no element vertex: there is nothing to see".into())),
        }
    }

    /// An error of the file as a whole.
    pub(super) fn error(&self, message: String) -> Error {
        Error::Data { path: self.path.clone(), line: None, message }
    }
}

fn format_of(name: &str) -> Result<Format, String> {
    match name {
        "ascii" => Ok(Format::Ascii),
        "binary_little_endian" => Ok(Format::LittleEndian),
        "binary_big_endian" => Ok(Format::BigEndian),
        _ => Err(format!("unknown format {name:?}, expected ascii, binary_little_endian or binary_big_endian")),
    }
}

fn property(words: &[&str], name: &str) -> Result<Property, String> {
    let kind = |word: &str| Kind::of(word).ok_or_else(|| format!("unknown type {word:?} of property {name:?}"));
    let form = match *words {
        [_, "list", len, item, _] => Form::List { len: kind(len)?, item: kind(item)? },
        [_, scalar, _] => Form::Scalar(kind(scalar)?),
        _ => return Err("a property has a type and a name, or list, two types and a name".into()),
    };
    match form {
        Form::List { len, .. } if !len.is_whole() => Err(format!("the length of list {name:?} is no whole number")),
        Form::List { item, .. } if name.starts_with("vertex_ind") && !item.is_whole() => {
            Err(format!("the items of list {name:?} are no whole numbers"))
        }
        form => Ok(Property { name: name.into(), form }),
    }
}
