//! The pass over an OBJ's text before `tobj` reads it: checks every `v`, `vn` and `f` and names the line of an error, notes
//! what `tobj` would lose, and blanks all else in place, so that what it gets is plain: nothing but checked `v`, `vn`, `vt` and `f` lines.

use crate::Error;
use crate::bvh::Node;
use crate::progress::Progress;
use std::collections::HashMap;
use std::ops::Range;
use std::path::Path;

/// What was found besides numbers.
#[derive(Debug, Default)]
pub(super) struct Outline {
    /// Line and text of each `mtllib`.
    pub(super) libraries: Vec<(usize, String)>,
    /// Material names in order of first use, and the line of that use.
    pub(super) names: Vec<(usize, String)>,
    /// From which triangle on which of the names holds.
    pub(super) runs: Vec<(usize, usize)>,
    /// Triangles that lack a normal at some corner.
    pub(super) flat: Vec<Range<usize>>,
    /// Triangles that lack a texture coordinate at some corner.
    pub(super) bare: Vec<Range<usize>>,
    /// Line of the first texture coordinate that is not acceptable, should any be wanted.
    pub(super) bad_uv: Option<usize>,
    triangles: usize,
}

/// Checks and tidies a whole text.
pub(super) fn tidy(text: &mut [u8], path: &Path, progress: &dyn Progress) -> Result<Outline, Error> {
    progress.stage("check", text.len() as u64);
    progress.check()?;
    if text.starts_with(b"\xef\xbb\xbf") {
        text[..3].fill(b' ');
    }
    if !text.contains(&b'\n') {
        // Lines as old Macs end them.
        text.iter_mut().filter(|b| **b == b'\r').for_each(|b| *b = b'\n');
    }
    let mut pass = Pass { path, line: 0, counts: [0; 3], names: HashMap::new(), outline: Outline::default() };
    let (mut at, mut line, mut told) = (0, 0, 0);
    while at < text.len() {
        line += 1;
        pass.line = line;
        let mut end = line_end(text, at);
        while let Some(continued) = continuation(&text[at..end]) {
            let next = text.len().min(end + 1);
            text[at + continued..next].fill(b' ');
            end = line_end(text, end);
            line += 1;
        }
        pass.statement(&mut text[at..end])?;
        at = end + 1;
        if at - told > 1 << 20 {
            progress.advance((at - told) as u64);
            progress.check()?;
            told = at;
        }
    }
    if pass.outline.triangles == 0 {
        let message = format!(
            "there are {} vertices, but no faces (lines like \"f 1 2 3\"): there is nothing to see, or this is no OBJ file",
            pass.counts[0]
        );
        return Err(Error::Data { path: path.to_owned(), line: None, message });
    }
    Ok(pass.outline)
}

/// Blanks all texture coordinates of a tidied text.
pub(super) fn without_uvs(text: &mut [u8]) {
    for line in text.split_mut(|&b| b == b'\n') {
        if next_word(line, 0).is_some_and(|word| line[word] == *b"vt") {
            line.fill(b' ');
        }
    }
}

/// The end of the line that begins (or goes on) at `from`: place of its newline, or of the text's end.
fn line_end(text: &[u8], from: usize) -> usize {
    text[from..].iter().position(|&b| b == b'\n').map_or(text.len(), |n| from + n)
}

/// Where the backslash is that joins the line to the next one. A comment is never continued.
fn continuation(line: &[u8]) -> Option<usize> {
    let trimmed = line.strip_suffix(b"\r").unwrap_or(line);
    let comment = || line.trim_ascii_start().starts_with(b"#");
    (trimmed.last() == Some(&b'\\') && !comment()).then(|| trimmed.len() - 1)
}

/// The next word of a line from `at` on.
fn next_word(line: &[u8], at: usize) -> Option<Range<usize>> {
    let start = at + line[at..].iter().position(|b| !b.is_ascii_whitespace())?;
    let end = line[start..].iter().position(u8::is_ascii_whitespace).map_or(line.len(), |n| start + n);
    Some(start..end)
}

/// Like [`next_word`], for numbers: what follows a `#` is blanked.
fn next_number(line: &mut [u8], at: usize) -> Option<Range<usize>> {
    let word = next_word(line, at)?;
    if line[word.start] == b'#' {
        line[word.start..].fill(b' ');
        return None;
    }
    Some(word)
}

struct Pass<'a> {
    path: &'a Path,
    line: usize,
    /// Vertices, texture coordinates and normals so far.
    counts: [usize; 3],
    /// Places in `outline.names`.
    names: HashMap<String, usize>,
    outline: Outline,
}

impl Pass<'_> {
    fn statement(&mut self, line: &mut [u8]) -> Result<(), Error> {
        let Some(word) = next_word(line, 0) else {
            return Ok(());
        };
        let end = word.end;
        match &line[word] {
            b"v" => return self.vertex(line, end),
            b"vn" => return self.normal(line, end),
            b"f" => return self.face(line, end),
            b"vt" => {
                self.texture_coordinate(line, end);
                return Ok(());
            }
            b"usemtl" => self.use_material(&line[end..])?,
            b"mtllib" => {
                let name = self.text(&line[end..])?.trim().to_owned();
                self.outline.libraries.push((self.line, name));
            }
            [b'#', ..] => {}
            _ => _ = self.text(line)?,
        }
        line.fill(b' ');
        Ok(())
    }

    fn vertex(&mut self, line: &mut [u8], mut at: usize) -> Result<(), Error> {
        let (mut numbers, mut third) = (0, 0);
        while let Some(word) = next_number(line, at) {
            at = word.end;
            numbers += 1;
            match numbers {
                1..=3 => self.finite("coordinate", &line[word])?,
                4 => third = word.start,
                _ => {}
            }
        }
        match numbers {
            3 => {}
            4 => self.weight(line)?,
            // What follows is a colour; tobj wants all vertices to have one, or none.
            6.. => line[third..].fill(b' '),
            _ => {
                return self.fail(format!(
                    "a vertex has 3 coordinates (or 4 numbers with a weight, or 6 with a colour), this one has {numbers}"
                ));
            }
        }
        self.counts[0] += 1;
        Ok(())
    }

    /// A fourth number divides the coordinates.
    fn weight(&self, line: &[u8]) -> Result<(), Error> {
        let numbers = line.split(u8::is_ascii_whitespace).filter_map(|w| str::from_utf8(w).ok()?.parse::<f32>().ok());
        let numbers: Vec<f32> = numbers.collect();
        match numbers[..] {
            [x, y, z, w] if w != 0.0 && [x, y, z].iter().all(|c| (c / w).is_finite()) => Ok(()),
            _ => {
                self.fail("the fourth number of a vertex divides the others: give one that leaves them finite, or none")
            }
        }
    }

    fn normal(&mut self, line: &mut [u8], mut at: usize) -> Result<(), Error> {
        let mut numbers = 0;
        while let Some(word) = next_number(line, at) {
            at = word.end;
            numbers += 1;
            if numbers <= 3 {
                self.finite("normal's component", &line[word])?;
            }
        }
        if numbers != 3 {
            return self.fail(format!("a normal has 3 components, this one has {numbers}"));
        }
        self.counts[2] += 1;
        Ok(())
    }

    fn texture_coordinate(&mut self, line: &mut [u8], mut at: usize) {
        let mut numbers = 0;
        while let Some(word) = next_number(line, at) {
            at = word.end;
            numbers += 1;
            // The third is for textures that are no images.
            if numbers <= 2 && self.finite("texture coordinate", &line[word]).is_err() {
                numbers = 0;
                break;
            }
        }
        if numbers < 2 {
            self.outline.bad_uv.get_or_insert(self.line);
        }
        self.counts[1] += 1;
    }

    fn face(&mut self, line: &mut [u8], mut at: usize) -> Result<(), Error> {
        let (mut corners, mut all) = (0, [true; 3]);
        while let Some(word) = next_number(line, at) {
            at = word.end;
            corners += 1;
            let has = self.corner(&line[word])?;
            (0..3).for_each(|kind| all[kind] &= has[kind]);
        }
        if corners < 3 {
            return self
                .fail(format!("a face needs at least 3 vertices, this one has {corners}: remove or complete it"));
        }
        let first = self.outline.triangles;
        let end = first + corners - 2;
        if end > Node::MAX_TRIANGLES {
            return self.fail(format!("more than {} triangles: split the scene", Node::MAX_TRIANGLES));
        }
        self.outline.triangles = end;
        for (all, runs) in [(all[1], &mut self.outline.bare), (all[2], &mut self.outline.flat)] {
            match runs.last_mut() {
                _ if all => {}
                Some(run) if run.end == first => run.end = end,
                _ => runs.push(first..end),
            }
        }
        Ok(())
    }

    /// Checks `v`, `v/vt`, `v//vn` or `v/vt/vn`: which of the three are there.
    fn corner(&self, word: &[u8]) -> Result<[bool; 3], Error> {
        const KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];
        let mut has = [false; 3];
        for (kind, part) in word.split(|&b| b == b'/').enumerate() {
            if kind > 0 && part.is_empty() {
                continue;
            }
            let (Some(name), Some(index)) = (KINDS.get(kind), integer(part)) else {
                let word = String::from_utf8_lossy(word);
                return self.fail(format!("{word:?} is no corner of a face, expected v, v/vt, v//vn or v/vt/vn"));
            };
            let count = self.counts[kind];
            let hint = match index {
                0 => "they count from 1 (or from -1 backwards)",
                _ if index.unsigned_abs() <= count as u64 => {
                    has[kind] = true;
                    continue;
                }
                _ => "correct the index, or move the face below what it uses",
            };
            return self.fail(format!("the face uses {name} {index}, but there are {count} above it: {hint}"));
        }
        Ok(has)
    }

    fn use_material(&mut self, rest: &[u8]) -> Result<(), Error> {
        let name = self.text(rest)?.trim();
        let number = match self.names.get(name) {
            Some(&number) => number,
            None => {
                self.outline.names.push((self.line, name.to_owned()));
                self.names.insert(name.to_owned(), self.outline.names.len() - 1);
                self.outline.names.len() - 1
            }
        };
        let (first, runs) = (self.outline.triangles, &mut self.outline.runs);
        if runs.last().is_some_and(|&(start, _)| start == first) {
            runs.pop();
        }
        if runs.last().is_none_or(|&(_, last)| last != number) {
            runs.push((first, number));
        }
        Ok(())
    }

    fn finite(&self, what: &str, word: &[u8]) -> Result<(), Error> {
        if is_plain(word) {
            return Ok(());
        }
        match str::from_utf8(word).ok().and_then(|w| w.parse::<f32>().ok()) {
            Some(x) if x.is_finite() => Ok(()),
            Some(x) => {
                let word = String::from_utf8_lossy(word);
                self.fail(format!("the {what} {word} is {x}, it must be a finite number: correct or remove it"))
            }
            None => self.fail(format!("{:?} is not a number", String::from_utf8_lossy(word))),
        }
    }

    fn text<'t>(&self, line: &'t [u8]) -> Result<&'t str, Error> {
        str::from_utf8(line).or_else(|_| self.fail("this is not UTF-8 text: convert the file, or is it no OBJ file?"))
    }

    fn fail<T>(&self, message: impl Into<String>) -> Result<T, Error> {
        Err(Error::Data { path: self.path.to_owned(), line: Some(self.line), message: message.into() })
    }
}

/// True for what needs no closer look to be a finite `f32`: at most 30 digits, perhaps a point, perhaps a negative exponent.
fn is_plain(word: &[u8]) -> bool {
    let word = word.strip_prefix(b"-").unwrap_or(word);
    let (mut digits, mut points) = (0, 0);
    for (i, b) in word.iter().enumerate() {
        match b {
            b'0'..=b'9' => digits += 1,
            b'.' => points += 1,
            b'e' if word[i..].starts_with(b"e-") => {
                let exponent = &word[i + 2..];
                return digits > 0 && points <= 1 && digits <= 30 && is_digits(exponent);
            }
            _ => return false,
        }
    }
    digits > 0 && points <= 1 && digits <= 30
}

fn is_digits(word: &[u8]) -> bool {
    !word.is_empty() && word.iter().all(u8::is_ascii_digit)
}

/// A decimal number of at most 18 digits.
fn integer(word: &[u8]) -> Option<i64> {
    let (sign, digits) = match word {
        [b'-', digits @ ..] => (-1, digits),
        [b'+', digits @ ..] => (1, digits),
        digits => (1, digits),
    };
    if !is_digits(digits) || digits.len() > 18 {
        return None;
    }
    Some(sign * digits.iter().fold(0, |n, b| 10 * n + i64::from(b - b'0')))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever passes as plain, Rust reads as a finite number.
    #[test]
    fn plain_numbers_are_numbers() {
        for word in ["0", "-0", "1.", ".5", "-12.25", "1e-3", "1.5e-99999", &"9".repeat(30)] {
            assert!(is_plain(word.as_bytes()), "{word}");
            assert!(word.parse::<f32>().expect(word).is_finite(), "{word}");
        }
        for word in
            ["", "-", ".", "-.", "--1", "1.2.3", "e-1", ".e-1", "1e-", "1e-x", "1e5", "nan", "inf", "1-2", "0x1"]
        {
            assert!(!is_plain(word.as_bytes()), "{word}");
        }
    }

    #[test]
    fn integers() {
        for (word, expected) in [("7", 7), ("+7", 7), ("-7", -7), ("007", 7), ("0", 0), ("-0", 0)] {
            assert_eq!(integer(word.as_bytes()), Some(expected));
        }
        for word in ["", "-", "1.0", "1e2", "a", "1 ", "--1", "9999999999999999999"] {
            assert_eq!(integer(word.as_bytes()), None, "{word}");
        }
    }
}
