//! Images that materials name.

use super::buffers::{Buffers, fetch};
use super::{Notes, named};
use crate::model::Texture;
use crate::progress::Progress;
use gltf::texture::WrappingMode;
use gltf::{Document, texture};
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Reads images, each once.
pub(super) struct Images<'a> {
    pub(super) document: &'a Document,
    pub(super) buffers: &'a Buffers,
    pub(super) path: &'a Path,
    pub(super) progress: &'a dyn Progress,
    pub(super) known: HashMap<usize, Result<Arc<Texture>, String>>,
    /// Pixels so far.
    pub(super) texels: usize,
}

impl Images<'_> {
    /// The image of a texture; none, and a warning, when it cannot be read. `what` is the material, `instead` what is used then.
    pub(super) fn read(
        &mut self,
        texture: &texture::Texture<'_>,
        what: &str,
        instead: &str,
        notes: &mut Notes<'_>,
    ) -> Option<Arc<Texture>> {
        let Some(source) = texture.source() else {
            notes.warn(&format!("{what}: its texture is neither PNG nor JPEG: {instead}"));
            return None;
        };
        let index = source.index();
        let image = match self.known.get(&index) {
            Some(image) => image.clone(),
            None => {
                let image = self.image(index);
                self.known.insert(index, image.clone());
                image
            }
        };
        match image {
            Ok(image) => Some(image),
            Err(reason) => {
                notes.warn(&format!("{what}: its texture is not read ({reason}): {instead}"));
                None
            }
        }
    }

    fn image(&mut self, index: usize) -> Result<Arc<Texture>, String> {
        let image = &self.document.as_json().images[index];
        let what = named("image", index, image.name.as_deref());
        let name =
            image.name.as_deref().or(image.uri.as_deref().filter(|uri| !uri.starts_with("data:"))).unwrap_or(&what);
        let mut decode = |bytes: &[u8]| {
            Texture::decode(name, bytes).and_then(|t| t.within(&mut self.texels)).map_err(|e| format!("{what}: {e}"))
        };
        if let Some(view) = image.buffer_view {
            let view = self.document.views().nth(view.value()).ok_or("no such view")?;
            return decode(self.buffers.view(&view)?);
        }
        let uri = image.uri.as_deref().ok_or_else(|| format!("{what} has neither uri nor bufferView"))?;
        decode(&fetch(uri, &what, self.path, self.progress).map_err(|e| e.to_string())?)
    }
}

/// Warns of what is not supported of the way a texture is looked up.
pub(super) fn look(texture: &texture::Texture<'_>, what: &str, notes: &mut Notes<'_>) {
    let sampler = texture.sampler();
    if [sampler.wrap_s(), sampler.wrap_t()] != [WrappingMode::Repeat; 2] {
        notes.warn(&format!("{what}: textures are repeated here, whatever wrapS and wrapT say"));
    }
}
