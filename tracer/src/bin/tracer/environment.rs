//! Environment maps from files: `tracer render --environment`.

use crate::machine;
use crate::workload::Workload;
use image::ImageDecoder;
use image::codecs::hdr::HdrDecoder;
use std::fs::{self, File};
use std::io::Cursor;
use std::path::{Path, PathBuf};
use tracer::Error;
use tracer::render::{Environment, Image, Up};

/// Light from all around.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(next_help_heading = "Light")]
pub struct EnvironmentOptions {
    /// Light the scene by a map of all directions, .hdr or .exr, latitudes by longitudes, for whitted and path. Its uppermost row is up, its middle
    /// looks along -z (along y with --up z)
    #[arg(long, value_name = "FILE")]
    pub environment: Option<PathBuf>,
    /// Turn the map about the upward axis, counter-clockwise as seen from above
    #[arg(long, value_name = "DEGREES", requires = "environment", allow_hyphen_values = true)]
    environment_rotation: Option<f32>,
    /// The axis that is up in the scene, for the map: y or z [default: y; z for the built-in scenes]
    #[arg(long, value_name = "AXIS", requires = "environment")]
    up: Option<Up>,
}

impl EnvironmentOptions {
    /// Refuses what cannot be read, before the long work.
    pub fn check(&self) -> Result<(), Error> {
        let Some(path) = &self.environment else { return Ok(()) };
        kind(path)?;
        if self.environment_rotation.is_some_and(|degrees| !degrees.is_finite()) {
            return Err(Error::Usage("--environment-rotation: give a finite number of degrees".into()));
        }
        let opened = File::open(path);
        opened.map(drop).map_err(|source| Error::Io { action: "open", path: path.clone(), source })
    }

    /// The map, as it lies in the scene.
    pub fn open(&self, work: &Workload) -> Result<Option<Environment>, Error> {
        let Some(path) = &self.environment else { return Ok(None) };
        // Cameras of built-in scenes say what is up; those of files may look down.
        let camera = work.scene.camera.filter(|_| work.built_in);
        let own = camera.map(|camera| if camera.up[2].abs() > camera.up[1].abs() { Up::Z } else { Up::Y });
        let up = self.up.or(own).unwrap_or_default();
        let map = Environment::new(&read(path)?, up, self.environment_rotation.unwrap_or(0.0));
        map.map(Some).map_err(|e| data(path, e.to_string()))
    }
}

#[derive(Clone, Copy)]
enum Kind {
    Hdr,
    Exr,
}

fn kind(path: &Path) -> Result<Kind, Error> {
    match path.extension().map(|e| e.to_ascii_lowercase()).as_ref().and_then(|e| e.to_str()) {
        Some("hdr") => Ok(Kind::Hdr),
        Some("exr") => Ok(Kind::Exr),
        _ => Err(Error::Usage(format!("{}: give a map that ends in .hdr or .exr", path.display()))),
    }
}

fn data(path: &Path, message: String) -> Error {
    Error::Data { path: path.to_owned(), line: None, message }
}

/// A picture of linear light.
fn read(path: &Path) -> Result<Image, Error> {
    let kind = kind(path)?;
    let bytes = fs::read(path).map_err(|source| Error::Io { action: "read", path: path.to_owned(), source })?;
    let image = match kind {
        Kind::Hdr => hdr(path, &bytes)?,
        Kind::Exr => exr(path, &bytes)?,
    };
    Ok(image)
}

/// Refuses what is too large before memory is asked for.
fn check_size(path: &Path, width: usize, height: usize) -> Result<(), Error> {
    // A pixel as it is read, in the picture, in the map; chances to choose it.
    const BYTES_PER_PIXEL: u64 = 60;
    let too_large = width > Environment::MAX_SIDE || height > Environment::MAX_SIDE;
    if too_large || width * height > Environment::MAX_PIXELS {
        let (side, all) = (Environment::MAX_SIDE, Environment::MAX_PIXELS);
        return Err(data(
            path,
            format!("a map of {width}x{height} pixels: {side} each way and {all} together are the most, scale it down"),
        ));
    }
    machine::check_memory(BYTES_PER_PIXEL * (width * height) as u64, &format!("a map of {width}x{height} pixels"))
}

fn hdr(path: &Path, bytes: &[u8]) -> Result<Image, Error> {
    let fail =
        |e: image::ImageError| data(path, format!("not a Radiance picture that can be read ({e}): save it anew"));
    // Another name of the format, which some programs write.
    let strict = !bytes.starts_with(b"#?RGBE");
    let decoder = HdrDecoder::with_strictness(Cursor::new(bytes), strict).map_err(fail)?;
    let (width, height) = decoder.dimensions();
    let (width, height) = (width as usize, height as usize);
    check_size(path, width, height)?;
    // Pixels were multiplied by it.
    let exposure = decoder.metadata().exposure.unwrap_or(1.0);
    let mut pixels = vec![0; 12 * width * height];
    decoder.read_image(&mut pixels).map_err(fail)?;
    let float = |bytes: &[u8; 4]| f32::from_ne_bytes(*bytes) / exposure;
    let pixels = pixels.as_chunks::<12>().0.iter().map(|pixel| {
        let [r, g, b] = [0, 4, 8].map(|k| float(&[pixel[k], pixel[k + 1], pixel[k + 2], pixel[k + 3]]));
        [r, g, b]
    });
    Ok(Image { width, height, pixels: pixels.collect() })
}

fn exr(path: &Path, bytes: &[u8]) -> Result<Image, Error> {
    use exr::compression::Compression;
    use exr::prelude::{MetaData, ReadChannels, ReadLayers, Vec2, read};
    let fail =
        |e: exr::error::Error| data(path, format!("not an OpenEXR picture that can be read ({e}): save it anew"));
    let about = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(fail)?;
    for header in &about.headers {
        check_size(path, header.layer_size.width(), header.layer_size.height())?;
        let whole = header.shared_attributes.display_window;
        if header.layer_size != whole.size || header.own_attributes.layer_position != whole.position {
            let message = "holds a part of the picture (its data window is not its display window): save the whole";
            return Err(data(path, message.into()));
        }
        if let Compression::DWAA(_) | Compression::DWAB(_) = header.compression {
            let message =
                format!("unpacking {} gives other bits on other processors: save it with zip", header.compression);
            return Err(data(path, message));
        }
    }
    let create =
        |Vec2(width, height): Vec2<usize>, _: &_| Image { width, height, pixels: vec![[0.0; 3]; width * height] };
    let set = |image: &mut Image, Vec2(x, y): Vec2<usize>, (r, g, b): (f32, f32, f32)| {
        image.pixels[y * image.width + x] = [r, g, b];
    };
    let reader = read().no_deep_data().largest_resolution_level().rgb_channels(create, set);
    let reader = reader.first_valid_layer().all_attributes();
    Ok(reader.from_buffered(Cursor::new(bytes)).map_err(fail)?.layer_data.channel_data.pixels)
}
