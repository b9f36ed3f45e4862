//! Material libraries.

use super::tidy::Outline;
use crate::Error;
use crate::model::Material;
use std::fmt::Write;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The materials of all libraries that an OBJ names; none when there is no library that could be read. A missing library
/// is a warning.
pub(super) fn read(obj: &Path, outline: &Outline, warnings: &mut Vec<String>) -> Result<Option<Vec<Material>>, Error> {
    let folder = obj.parent().unwrap_or(Path::new(""));
    let mut found = None;
    for (line, names) in &outline.libraries {
        // A name may have blanks in it, or there may be several: whichever is there.
        let whole = [names.as_str()];
        let several: Vec<&str> = names.split_whitespace().collect();
        let names = if locate(folder, names).is_some() || several.is_empty() { &whole[..] } else { &several };
        for name in names {
            let path = locate(folder, name).unwrap_or_else(|| folder.join(name));
            match fs::read(&path) {
                Ok(bytes) => {
                    found.get_or_insert_with(Vec::new).extend(parse(
                        &String::from_utf8_lossy(&bytes),
                        &path,
                        warnings,
                    )?);
                }
                Err(e) => warnings.push(format!(
                    "{}:{line}: the material library {} cannot be read ({e}): its surfaces are light grey",
                    obj.display(),
                    path.display()
                )),
            }
        }
    }
    Ok(found)
}

/// The file of that name, which may have been written where folders are separated by backslashes.
fn locate(folder: &Path, name: &str) -> Option<PathBuf> {
    [folder.join(name), folder.join(name.replace('\\', "/"))].into_iter().find(|p| p.is_file())
}

fn parse(text: &str, path: &Path, warnings: &mut Vec<String>) -> Result<Vec<Material>, Error> {
    let (plain, textures) = tidy(text, path)?;
    if textures > 0 {
        let file = path.display();
        warnings.push(format!("{file}: textures are not read ({textures} map_Kd): the colours Kd are used"));
    }
    let (materials, _) = tobj::load_mtl_buf(&mut plain.as_bytes()).map_err(|e| Error::Data {
        path: path.to_owned(),
        line: None,
        message: format!("not acceptable as MTL: {e}"),
    })?;
    let read = |m: tobj::Material| {
        let default = Material::grey(&m.name);
        Material {
            ambient: m.ambient.unwrap_or(default.ambient),
            diffuse: m.diffuse.unwrap_or(default.diffuse),
            specular: m.specular.unwrap_or(default.specular),
            shininess: m.shininess.unwrap_or(default.shininess),
            name: m.name,
        }
    };
    Ok(materials.into_iter().map(read).collect())
}

/// The lines that are used, with their numbers checked: `tobj` would drop the whole library for any line it does not
/// like, and it panics on a colour of one number. Also returns how many colours come from textures.
fn tidy(text: &str, path: &Path) -> Result<(String, usize), Error> {
    let (mut plain, mut textures) = (String::new(), 0);
    for (i, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let fail = |message| Error::Data { path: path.to_owned(), line: Some(i + 1), message };
        let (keyword, rest) = line.trim().split_once(char::is_whitespace).unwrap_or((line.trim(), ""));
        let rest = rest.trim();
        match keyword {
            "newmtl" if rest.is_empty() => return Err(fail("a material needs a name".into())),
            "newmtl" => _ = writeln!(plain, "newmtl {rest}"),
            // A colour as a spectrum is not for us: the default is used.
            "Ka" | "Kd" | "Ks" if rest.starts_with(['s', 'x']) => {}
            "Ka" | "Kd" | "Ks" => match numbers(rest).map_err(fail)?[..] {
                [grey] => _ = writeln!(plain, "{keyword} {grey} {grey} {grey}"),
                [r, g, b, ..] => _ = writeln!(plain, "{keyword} {r} {g} {b}"),
                _ => return Err(fail(format!("{keyword} needs 3 numbers (or 1 for a grey)"))),
            },
            "Ns" => match numbers(rest).map_err(fail)?[..] {
                [exponent, ..] if exponent >= 0.0 => _ = writeln!(plain, "Ns {exponent}"),
                _ => return Err(fail("Ns needs a number that is not negative".into())),
            },
            "map_Kd" => textures += 1,
            _ => {}
        }
    }
    Ok((plain, textures))
}

fn numbers(text: &str) -> Result<Vec<f32>, String> {
    let words = text.split_whitespace().take_while(|w| !w.starts_with('#'));
    let number = |w: &str| match w.parse::<f32>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(format!("{w:?} is not a finite number")),
    };
    words.map(number).collect()
}

/// Writes materials under the given names.
pub(super) fn write(materials: &[Material], names: &[String], out: &mut dyn io::Write) -> io::Result<()> {
    for (m, name) in materials.iter().zip(names) {
        writeln!(out, "newmtl {name}")?;
        for (keyword, [r, g, b]) in [("Ka", m.ambient), ("Kd", m.diffuse), ("Ks", m.specular)] {
            writeln!(out, "{keyword} {r} {g} {b}")?;
        }
        writeln!(out, "Ns {}\n", m.shininess)?;
    }
    Ok(())
}
