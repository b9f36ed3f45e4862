//! NumPy's `.npy` format, versions 1 to 3 (NEP 1): rays in, hits out.

use std::fs::File;
use std::io::{self, BufReader, Read};
use std::path::Path;
use tracer::Error;
use tracer::geometry::{Hit, HitBatch, Ray, RayBatch};
use tracer::method::BitVec;
use tracer::output::write_atomically;
use tracer::progress::Progress;

/// Rays or hits between two looks at the cancel flag.
const PORTION: usize = 1 << 14;
const ROW_BYTES: usize = 32;

const MAGIC: &[u8] = b"\x93NUMPY";
/// The longest header that NumPy itself accepts by default is 10,000 bytes.
const MAX_HEADER: usize = 1 << 16;

/// Reads an array of shape (N, 8), float32, little-endian, in C order: org x y z, t_min, dir x y z, t_max.
pub fn read_rays(path: &Path, progress: &dyn Progress) -> Result<RayBatch, Error> {
    let io = |action| move |source| Error::Io { action, path: path.to_owned(), source };
    let mut file = BufReader::with_capacity(1 << 17, File::open(path).map_err(io("open"))?);
    let bad = |message| Error::Data { path: path.to_owned(), line: None, message };
    let header = read_header(&mut file).map_err(io("read"))?.ok_or_else(|| bad(NO_NPY.into()))?;
    let rows = number_of_rays(&header).map_err(bad)?;
    progress.stage("read", rows);
    let mut rays = RayBatch::new();
    let mut buffer = vec![0; PORTION * ROW_BYTES];
    let mut left = rows;
    while left > 0 {
        progress.check()?;
        let portion = left.min(PORTION as u64) as usize;
        let bytes = fill(&mut file, &mut buffer[..portion * ROW_BYTES]).map_err(io("read"))?;
        rays.extend(bytes.as_chunks::<ROW_BYTES>().0.iter().map(ray));
        if bytes.len() < portion * ROW_BYTES {
            let row = rays.len();
            return Err(bad(format!("the file ends in row {row} of {rows} (counted from 0): write it again")));
        }
        progress.advance(portion as u64);
        left -= portion as u64;
    }
    Ok(rays)
}

/// Writes a structured array of shape (N,): `t`, `u`, `v` float32, `primitive` uint32; all little-endian.
pub fn write_hits(path: &Path, hits: &HitBatch, progress: &dyn Progress) -> Result<(), Error> {
    let dtype = "[('t', '<f4'), ('u', '<f4'), ('v', '<f4'), ('primitive', '<u4')]";
    write(path, dtype, hits.iter().map(bytes_of), progress)
}

/// Writes an array of shape (N,) of booleans.
pub fn write_bools(path: &Path, bits: &BitVec, progress: &dyn Progress) -> Result<(), Error> {
    write(path, "'|b1'", (0..bits.len()).map(|i| [u8::from(bits.get(i))]), progress)
}

fn write<const N: usize>(
    path: &Path,
    dtype: &str,
    rows: impl ExactSizeIterator<Item = [u8; N]>,
    progress: &dyn Progress,
) -> Result<(), Error> {
    progress.stage("write", rows.len() as u64);
    let written = write_atomically(path, |out| {
        out.write_all(&header(dtype, rows.len()))?;
        for (i, row) in rows.enumerate() {
            if i % PORTION == 0 {
                progress.advance(if i == 0 { 0 } else { PORTION as u64 });
                if progress.cancelled() {
                    return Err(io::Error::other("cancelled"));
                }
            }
            out.write_all(&row)?;
        }
        Ok(())
    });
    progress.check()?;
    written
}

/// Version 1.0, the data aligned to 64 bytes.
fn header(dtype: &str, rows: usize) -> Vec<u8> {
    let dict = format!("{{'descr': {dtype}, 'fortran_order': False, 'shape': ({rows},), }}");
    let begin = MAGIC.len() + 4;
    let length = (begin + dict.len() + 1).next_multiple_of(64) - begin;
    let mut header = [MAGIC, &[1, 0], &(length as u16).to_le_bytes()].concat();
    header.extend(format!("{dict:<width$}\n", width = length - 1).into_bytes());
    header
}

fn ray(row: &[u8; ROW_BYTES]) -> Ray {
    let number = |i: usize| f32::from_le_bytes(row.as_chunks().0[i]);
    let point = |i| [number(i), number(i + 1), number(i + 2)];
    Ray { org: point(0), t_min: number(3), dir: point(4), t_max: number(7) }
}

fn bytes_of(hit: Hit) -> [u8; 16] {
    let mut bytes = [0; 16];
    let words = [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.primitive];
    for (to, word) in bytes.as_chunks_mut().0.iter_mut().zip(words) {
        *to = word.to_le_bytes();
    }
    bytes
}

/// As many bytes as there are, at most as many as fit.
fn fill<'a>(source: &mut impl Read, buffer: &'a mut [u8]) -> io::Result<&'a [u8]> {
    let mut filled = 0;
    while filled < buffer.len() {
        match source.read(&mut buffer[filled..]) {
            Ok(0) => break,
            Ok(n) => filled += n,
            Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
            Err(e) => return Err(e),
        }
    }
    Ok(&buffer[..filled])
}

const NO_NPY: &str = "this is no .npy file: write it with numpy.save(file, rays)";

/// The text of the header; none when this is no `.npy` file.
fn read_header(file: &mut impl Read) -> io::Result<Option<String>> {
    let mut start = [0; 8];
    if fill(file, &mut start)?.len() < 8 || !start.starts_with(MAGIC) {
        return Ok(None);
    }
    let mut length = [0; 4];
    let length_bytes = match start[MAGIC.len()] {
        1 => 2,
        2 | 3 => 4,
        _ => return Ok(None),
    };
    fill(file, &mut length[..length_bytes])?;
    let length = u32::from_le_bytes(length) as usize;
    let mut text = vec![0; length.min(MAX_HEADER)];
    let text = fill(file, &mut text)?;
    Ok((text.len() == length).then(|| String::from_utf8_lossy(text).into_owned()))
}

/// N, when the header says shape (N, 8), float32, little-endian, C order; else what is wrong with it.
fn number_of_rays(header: &str) -> Result<u64, String> {
    let value = |key| entry(header, key).ok_or_else(|| format!("the header lacks '{key}': {NO_NPY}"));
    let (dtype, fortran, shape) = (value("descr")?, value("fortran_order")?, value("shape")?);
    if dtype.trim_matches(['\'', '"']) != "<f4" {
        return Err(format!(
            "the dtype is {dtype}, but rays are '<f4' (float32, little-endian): convert them with rays.astype('<f4')"
        ));
    }
    let numbers: Vec<&str> =
        shape.trim_matches(['(', ')']).split(',').map(str::trim).filter(|n| !n.is_empty()).collect();
    let rows = match numbers[..] {
        [rows, "8"] => rows.parse().ok(),
        _ => None,
    };
    let Some(rows) = rows else {
        return Err(format!(
            "the shape is {shape}, but rays are (N, 8), a row for each: org x y z, t_min, dir x y z, t_max"
        ));
    };
    if fortran != "False" {
        return Err("the array is in Fortran order: write it in C order, with numpy.ascontiguousarray(rays)".into());
    }
    Ok(rows)
}

/// The text of a value in a Python dictionary that is written as `{'key': value, ...}`.
fn entry<'a>(dict: &'a str, key: &str) -> Option<&'a str> {
    let inner = dict.trim().strip_prefix('{')?.strip_suffix('}')?;
    let (mut depth, mut quote) = (0_i32, None);
    let separates = move |c: char| {
        match (quote, c) {
            (Some(q), _) if c == q => quote = None,
            (Some(_), _) => {}
            (None, '\'' | '"') => quote = Some(c),
            (None, '(' | '[' | '{') => depth += 1,
            (None, ')' | ']' | '}') => depth -= 1,
            _ => {}
        }
        c == ',' && depth == 0 && quote.is_none()
    };
    let pairs = inner.split(separates).filter_map(|pair| pair.split_once(':'));
    pairs.map(|(k, v)| (k.trim(), v.trim())).find(|(k, _)| k.trim_matches(['\'', '"']) == key).map(|(_, v)| v)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_are_aligned_and_read_back() {
        for rows in [0, 7, 12_345_678_901] {
            let header = header("'<f4'", rows);
            assert_eq!((header.len() % 64, header.last()), (0, Some(&b'\n')));
            let text = read_header(&mut &header[..]).expect("readable").expect("a header");
            assert_eq!(entry(&text, "descr"), Some("'<f4'"));
            assert_eq!(entry(&text, "shape"), Some(format!("({rows},)").as_str()));
        }
    }

    #[test]
    fn entries_in_any_order_and_with_any_nesting() {
        let dict = r#" {"shape": (3, 8), 'descr': [('a:,', '<f4', (2,)), ("b'", '<u4')], 'fortran_order': False} "#;
        assert_eq!(entry(dict, "shape"), Some("(3, 8)"));
        assert_eq!(entry(dict, "descr"), Some(r#"[('a:,', '<f4', (2,)), ("b'", '<u4')]"#));
        assert_eq!(entry(dict, "fortran_order"), Some("False"));
        assert_eq!(entry(dict, "none"), None);
        assert_eq!(entry("'shape': 3", "shape"), None);
    }

    #[test]
    fn accepts_what_it_should() {
        let dict = |dtype: &str, order: &str, shape: &str| {
            format!("{{'descr': {dtype}, 'fortran_order': {order}, 'shape': {shape}, }}  \n")
        };
        for (shape, rows) in [("(0, 8)", 0), ("(5, 8)", 5), ("(5,8,)", 5), ("(18446744073709551615, 8)", u64::MAX)] {
            assert_eq!(number_of_rays(&dict("'<f4'", "False", shape)), Ok(rows));
        }
        for (dtype, order, shape, reason) in [
            ("'>f4'", "False", "(5, 8)", "the dtype is '>f4'"),
            ("'<f8'", "False", "(5, 8)", "the dtype is '<f8'"),
            ("[('x', '<f4')]", "False", "(5,)", "the dtype is [('x', '<f4')]"),
            ("'<f4'", "True", "(5, 8)", "Fortran order"),
            ("'<f4'", "False", "(5, 7)", "the shape is (5, 7)"),
            ("'<f4'", "False", "(8,)", "the shape is (8,)"),
            ("'<f4'", "False", "()", "the shape is ()"),
            ("'<f4'", "False", "(5, 8, 1)", "the shape is (5, 8, 1)"),
            ("'<f4'", "False", "(-1, 8)", "the shape is (-1, 8)"),
            ("'<f4'", "False", "(99999999999999999999, 8)", "the shape is (9999"),
        ] {
            let message = number_of_rays(&dict(dtype, order, shape)).expect_err(reason);
            assert!(message.contains(reason), "{message}");
        }
        assert!(number_of_rays("{'shape': (5, 8)}").expect_err("no dtype").contains("lacks 'descr'"));
    }

    #[test]
    fn what_is_no_npy_file() {
        let long = [MAGIC, &[2, 0], &u32::MAX.to_le_bytes()].concat();
        let cut = [MAGIC, &[1, 0], &100_u16.to_le_bytes(), b"{'descr'"].concat();
        for bytes in [&b""[..], b"PK\x03\x04 zipped", b"\x93NUMPY\x09\x00  ", &long, &cut] {
            assert!(read_header(&mut &*bytes).expect("readable").is_none(), "{bytes:?}");
        }
    }

    #[test]
    fn numbers_are_little_endian() {
        let mut row = [0; ROW_BYTES];
        row.as_chunks_mut().0.iter_mut().enumerate().for_each(|(i, n)| *n = (i as f32).to_le_bytes());
        let ray = ray(&row);
        assert_eq!((ray.org, ray.t_min, ray.dir, ray.t_max), ([0.0, 1.0, 2.0], 3.0, [4.0, 5.0, 6.0], 7.0));
        let bytes = bytes_of(Hit { t: 1.0, u: 0.0, v: 2.0, primitive: 0x0403_0201 });
        assert_eq!(bytes, [0, 0, 128, 63, 0, 0, 0, 0, 0, 0, 0, 64, 1, 2, 3, 4]);
    }
}
