//! Pictures as files.

use std::io::{self, Cursor};
use std::path::{Path, PathBuf};
use tracer::Error;
use tracer::output::write_atomically;
use tracer::render::Image;
use tracer::render::integrator::{Layers, Rendering};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// sRGB, 8 bits per channel.
    Png,
    /// Linear, 32-bit floats.
    Exr,
}

impl Kind {
    /// As the name of the file says.
    pub fn of(path: &Path) -> Result<Self, Error> {
        match path.extension().map(|e| e.to_ascii_lowercase()).as_ref().and_then(|e| e.to_str()) {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            _ => Err(Error::Usage(format!("{}: give a picture that ends in .png or .exr", path.display()))),
        }
    }

    /// The whole file.
    pub fn encode(self, image: &Image) -> io::Result<Vec<u8>> {
        match self {
            Self::Png => png(image),
            Self::Exr => exr(image),
        }
    }
}

/// Encodes in memory, then writes whole or not at all. Returns the size of the file.
pub fn write(image: &Image, path: &Path) -> Result<usize, Error> {
    let kind = Kind::of(path)?;
    let encoded = kind.encode(image);
    let bytes = encoded.map_err(|source| Error::Io { action: "encode", path: PathBuf::from(path), source })?;
    write_atomically(path, |out| out.write_all(&bytes))?;
    Ok(bytes.len())
}

/// Three bytes for each pixel, as a .png.
pub fn write_rgb8(width: usize, height: usize, pixels: &[u8], path: &Path) -> Result<(), Error> {
    let encoded = rgb8(width, height, pixels);
    let bytes = encoded.map_err(|source| Error::Io { action: "encode", path: PathBuf::from(path), source })?;
    write_atomically(path, |out| out.write_all(&bytes))
}

/// The light and what else is known of each pixel, in one layer with named channels (.exr): R G B; Y of the variance; Z, the distance; normal,
/// albedo; numbers of triangles and materials; rays for all samples together.
pub fn write_layers(rendering: Rendering, layers: Layers, path: &Path) -> Result<usize, Error> {
    use exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Layer, LayerAttributes, WritableImage};
    let Rendering { image, variance, rays, .. } = rendering;
    let column = |pixels: &[[f32; 3]], k: usize| FlatSamples::F32(pixels.iter().map(|p| p[k]).collect());
    let mut channels = exr::prelude::SmallVec::new();
    for (names, pixels) in [
        (["R", "G", "B"], &image.pixels),
        (["albedo.R", "albedo.G", "albedo.B"], &layers.albedo),
        (["normal.X", "normal.Y", "normal.Z"], &layers.normal),
    ] {
        for (k, name) in names.into_iter().enumerate() {
            channels.push(AnyChannel::new(name, column(pixels, k)));
        }
    }
    channels.push(AnyChannel::new("Z", FlatSamples::F32(layers.depth)));
    channels.push(AnyChannel::new("variance.Y", FlatSamples::F32(variance)));
    channels.push(AnyChannel::new("primitive.ID", FlatSamples::U32(layers.primitive)));
    channels.push(AnyChannel::new("material.ID", FlatSamples::U32(layers.material)));
    channels.push(AnyChannel::new("cost.rays", FlatSamples::U32(rays)));
    let size = (image.width, image.height);
    let layer = Layer::new(size, LayerAttributes::default(), Encoding::default(), AnyChannels::sort(channels));
    let mut bytes = Vec::new();
    let encoded = exr::image::Image::from_layer(layer).write().to_buffered(Cursor::new(&mut bytes));
    let encoded = encoded.map_err(|e| match e {
        exr::error::Error::Io(e) => e,
        e => io::Error::other(e),
    });
    encoded.map_err(|source| Error::Io { action: "encode", path: PathBuf::from(path), source })?;
    write_atomically(path, |out| out.write_all(&bytes))?;
    Ok(bytes.len())
}

fn png(image: &Image) -> io::Result<Vec<u8>> {
    rgb8(image.width, image.height, &image.to_srgb8())
}

fn rgb8(width: usize, height: usize, pixels: &[u8]) -> io::Result<Vec<u8>> {
    let side = |n: usize| u32::try_from(n).map_err(io::Error::other);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side(width)?, side(height)?);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}

fn exr(image: &Image) -> io::Result<Vec<u8>> {
    use exr::prelude::{SpecificChannels, Vec2, WritableImage};
    let pixel = |Vec2(x, y): Vec2<usize>| {
        let [r, g, b] = image.pixels[y * image.width + x];
        (r, g, b)
    };
    let mut bytes = Vec::new();
    let file = exr::image::Image::from_channels((image.width, image.height), SpecificChannels::rgb(pixel));
    match file.write().to_buffered(Cursor::new(&mut bytes)) {
        Ok(()) => Ok(bytes),
        Err(exr::error::Error::Io(e)) => Err(e),
        Err(e) => Err(io::Error::other(e)),
    }
}
