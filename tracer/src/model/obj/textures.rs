//! Textures that material libraries name.

use super::mtl::locate;
use crate::model::{Material, Texture};
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A `map_Kd`.
pub(super) struct Map {
    /// Number of the material in its library.
    material: usize,
    pub(super) line: usize,
    /// Options and a file.
    text: String,
}

impl Map {
    pub(super) fn parse(material: usize, line: usize, text: &str) -> Self {
        Self { material, line, text: text.to_owned() }
    }

    /// Whether there are options, which are passed over.
    pub(super) fn has_options(&self) -> bool {
        self.file().len() < self.text.len()
    }

    /// The file's name, behind options that are passed over: `-s 1 1 1`, `-clamp on` ...
    fn file(&self) -> &str {
        let mut rest = self.text.as_str();
        while let Some((option, more)) = rest.strip_prefix('-').and_then(|r| r.split_once(char::is_whitespace)) {
            let numbers = match option {
                "o" | "s" | "t" => 3,
                "mm" => 2,
                "blendu" | "blendv" | "cc" | "clamp" | "texres" | "bm" | "boost" | "imfchan" | "type" => 1,
                _ => break,
            };
            rest = more.trim_start();
            for i in 0..numbers {
                let Some((word, more)) = rest.split_once(char::is_whitespace) else { break };
                // One or two numbers may be missing of three.
                if i > 0 && word.parse::<f32>().is_err() {
                    break;
                }
                rest = more.trim_start();
            }
        }
        rest
    }
}

/// Reads textures, each once.
pub(super) struct Textures<'a> {
    pub(super) library: &'a Path,
    pub(super) known: HashMap<PathBuf, Result<Arc<Texture>, String>>,
    /// Pixels so far.
    pub(super) texels: usize,
}

impl Textures<'_> {
    /// The texture of a map, or what is wrong with it.
    pub(super) fn read(&mut self, map: &Map) -> Result<Arc<Texture>, String> {
        let (folder, name) = (self.library.parent().unwrap_or(Path::new("")), map.file());
        let path = locate(folder, name);
        let wanted = path.clone().unwrap_or_else(|| folder.join(name));
        let read = || match path.as_ref().map(fs::read) {
            Some(Ok(bytes)) => Texture::decode(name, &bytes)?.within(&mut self.texels),
            Some(Err(e)) => Err(e.to_string()),
            None => Err("there is no such file".into()),
        };
        let texture = self.known.entry(wanted.clone()).or_insert_with(read).clone();
        texture.map_err(|reason| format!("{} cannot be read ({reason})", wanted.display()))
    }
}

/// Gives a material its texture. Where Kd is black the image stands for it, as many programs mean it.
pub(super) fn put(materials: &mut [Material], map: &Map, texture: Arc<Texture>) {
    if let Some(material) = materials.get_mut(map.material) {
        if material.diffuse == [0.0; 3] {
            material.diffuse = [1.0; 3];
        }
        material.texture = Some(texture);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_passed_over() {
        for (text, file) in [
            ("a.png", "a.png"),
            ("textures\\a b.png", "textures\\a b.png"),
            ("-s 2 2 1 a.png", "a.png"),
            ("-s 2 a b.png", "a b.png"),
            ("-clamp on -o 0.5 1 -mm 0 1 -bm 1 a.png", "a.png"),
            ("-strange.png", "-strange.png"),
            ("-strange thing.png", "-strange thing.png"),
            ("-s", "-s"),
            ("", ""),
        ] {
            assert_eq!(Map::parse(0, 1, text).file(), file, "{text}");
        }
    }
}
