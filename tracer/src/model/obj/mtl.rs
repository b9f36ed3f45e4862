//! Material libraries.

use super::textures::{self, Map, Textures};
use super::tidy::Outline;
use crate::Error;
use crate::model::{Material, Reflection};
use std::collections::{HashMap, HashSet};
use std::fmt::Write;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// The materials of all libraries that an OBJ names; none when there is no library that could be read. A missing library
/// is a warning.
pub(super) fn read(obj: &Path, outline: &Outline, warnings: &mut Vec<String>) -> Result<Option<Vec<Material>>, Error> {
    let folder = obj.parent().unwrap_or(Path::new(""));
    let mut found = None;
    // Some programs name it again for each object.
    let mut known = HashSet::new();
    for (line, names) in &outline.libraries {
        // A name may have blanks in it, or there may be several: whichever is there.
        let whole = [names.as_str()];
        let several: Vec<&str> = names.split_whitespace().collect();
        let names = if locate(folder, names).is_some() || several.is_empty() { &whole[..] } else { &several };
        for name in names {
            let path = locate(folder, name).unwrap_or_else(|| folder.join(name));
            if !known.insert(path.clone()) {
                continue;
            }
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
pub(super) fn locate(folder: &Path, name: &str) -> Option<PathBuf> {
    [folder.join(name), folder.join(name.replace('\\', "/"))].into_iter().find(|p| p.is_file())
}

fn parse(text: &str, path: &Path, warnings: &mut Vec<String>) -> Result<Vec<Material>, Error> {
    let (plain, maps) = tidy(text, path)?;
    let file = path.display();
    let (materials, _) = tobj::load_mtl_buf(&mut plain.as_bytes()).map_err(|e| Error::Data {
        path: path.to_owned(),
        line: None,
        message: format!("not acceptable as MTL: {e}"),
    })?;
    let read = |m: tobj::Material| {
        let default = Material::grey(&m.name);
        // tobj does not know this keyword; `tidy` checked that three numbers follow.
        let transmission = m.unknown_param.get("Tf").and_then(|text| numbers(text).ok()?.try_into().ok());
        let specular = m.specular.unwrap_or(default.specular);
        Material {
            ambient: m.ambient.unwrap_or(default.ambient),
            diffuse: m.diffuse.unwrap_or(default.diffuse),
            specular,
            shininess: m.shininess.unwrap_or(default.shininess),
            emission: m.emissive.unwrap_or(default.emission),
            ior: m.optical_density.unwrap_or(default.ior),
            transmission: transmission.unwrap_or(default.transmission),
            reflection: reflection(&m, specular, &file.to_string(), warnings),
            name: m.name,
            ..default
        }
    };
    let mut materials: Vec<Material> = materials.into_iter().map(read).collect();
    let mut textures = Textures { library: path, known: HashMap::new(), texels: 0 };
    for map in maps {
        if map.has_options() {
            warnings.push(format!("{file}:{}: options of map_Kd are not supported: passed over", map.line));
        }
        match textures.read(&map) {
            Ok(texture) => textures::put(&mut materials, &map, texture),
            Err(reason) => warnings.push(format!("{file}:{}: the texture {reason}: the colour Kd is used", map.line)),
        }
    }
    Ok(materials)
}

/// What the illumination model of the MTL specification (Wavefront, Advanced Visualizer, appendix B) is here.
fn reflection(m: &tobj::Material, specular: [f32; 3], file: &str, warnings: &mut Vec<String>) -> Reflection {
    let name = &m.name;
    let glossy = if specular == [0.0; 3] { Reflection::Lambertian } else { Reflection::Glossy };
    let reflection = match m.illumination_model {
        Some(0 | 1) => Reflection::Lambertian,
        Some(2 | 8) | None => glossy,
        Some(3 | 5) => Reflection::Mirror,
        Some(4 | 6 | 7 | 9) => Reflection::Dielectric,
        Some(other) => {
            warnings.push(format!("{file}: illum {other} of material {name:?} is not supported: taken for illum 2"));
            glossy
        }
    };
    if m.dissolve.is_some_and(|d| d < 1.0) && reflection != Reflection::Dielectric {
        warnings.push(format!(
            "{file}: material {name:?} is see-through (d, Tr): opaque here, as only glass is supported (illum 4, 6, 7 or 9)"
        ));
    }
    reflection
}

/// The lines that are used, with their numbers checked: `tobj` would drop the whole library for any line it does not
/// like, and it panics on a colour of one number. Also returns the textures.
fn tidy(text: &str, path: &Path) -> Result<(String, Vec<Map>), Error> {
    let (mut plain, mut maps, mut materials) = (String::new(), Vec::new(), 0);
    for (i, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let fail = |message| Error::Data { path: path.to_owned(), line: Some(i + 1), message };
        let (keyword, rest) = line.trim().split_once(char::is_whitespace).unwrap_or((line.trim(), ""));
        let rest = rest.trim();
        match keyword {
            "newmtl" if rest.is_empty() => return Err(fail("a material needs a name".into())),
            "newmtl" => {
                materials += 1;
                _ = writeln!(plain, "newmtl {rest}");
            }
            // A colour as a spectrum is not for us: the default is used.
            "Ka" | "Kd" | "Ks" | "Ke" | "Tf" if rest.starts_with(['s', 'x']) => {}
            "Ka" | "Kd" | "Ks" | "Ke" | "Tf" => match numbers(rest).map_err(fail)?[..] {
                [grey] => _ = writeln!(plain, "{keyword} {grey} {grey} {grey}"),
                [r, g, b, ..] => _ = writeln!(plain, "{keyword} {r} {g} {b}"),
                _ => return Err(fail(format!("{keyword} needs 3 numbers (or 1 for a grey)"))),
            },
            "Ns" => match numbers(rest).map_err(fail)?[..] {
                [exponent, ..] if exponent >= 0.0 => _ = writeln!(plain, "Ns {exponent}"),
                _ => return Err(fail("Ns needs a number that is not negative".into())),
            },
            // Many programs write 0 where nothing refracts.
            "Ni" => match numbers(rest).map_err(fail)?[..] {
                [index, ..] if index > 0.0 => _ = writeln!(plain, "Ni {index}"),
                [0.0, ..] => {}
                _ => return Err(fail("Ni needs a number that is not negative".into())),
            },
            "illum" => {
                if let Some(model) = rest.split_whitespace().next().and_then(|word| word.parse::<u8>().ok()) {
                    _ = writeln!(plain, "illum {model}");
                }
            }
            // `-halo` and the like are left out.
            "d" => _ = dissolve(rest).map(|d| writeln!(plain, "d {d}")),
            "Tr" => _ = dissolve(rest).map(|t| writeln!(plain, "d {}", 1.0 - t)),
            "map_Kd" if materials > 0 => maps.push(Map::parse(materials - 1, i + 1, rest)),
            _ => {}
        }
    }
    Ok((plain, maps))
}

/// The number of a `d` or `Tr` line, if it is one that makes sense.
fn dissolve(rest: &str) -> Option<f32> {
    numbers(rest).ok()?.first().copied().filter(|d| (0.0..=1.0).contains(d))
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
        let colors = [("Ka", m.ambient), ("Kd", m.diffuse), ("Ks", m.specular), ("Ke", m.emission)];
        for (keyword, [r, g, b]) in colors.into_iter().chain([("Tf", m.transmission)]) {
            writeln!(out, "{keyword} {r} {g} {b}")?;
        }
        let illum = match m.reflection {
            Reflection::Lambertian => 1,
            Reflection::Glossy => 2,
            Reflection::Mirror => 3,
            Reflection::Dielectric => 7,
        };
        writeln!(out, "Ns {}\nNi {}\nillum {illum}\n", m.shininess, m.ior)?;
    }
    Ok(())
}
