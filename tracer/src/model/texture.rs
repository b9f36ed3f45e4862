//! Images on surfaces.

use crate::Error;
use crate::hash::fnv1a;
use std::sync::{Arc, LazyLock};

/// An image that colours a surface: sRGB, 8 bits, repeated in both directions and interpolated between the middles of its pixels.
///
/// ```
/// use tracer::model::{Material, Texture};
///
/// let checkers = Texture::new("checkers", 2, 2, &[[255; 3], [0; 3], [0; 3], [255; 3]]).expect("four pixels");
/// let floor = Material { texture: Some(checkers.into()), ..Material::grey("floor") };
/// assert_eq!(floor.texture.expect("there").size(), (2, 2));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Texture {
    name: String,
    width: usize,
    height: usize,
    /// Red in the lowest byte, then green and blue; row by row from the top left.
    texels: Vec<u32>,
}

impl Texture {
    /// The most pixels that the textures of a scene have together.
    pub const MAX_TEXELS: usize = 1 << 28;

    /// Of its size and pixels.
    pub(crate) fn hash(&self) -> u64 {
        fnv1a([self.width as u32, self.height as u32].into_iter().chain(self.texels.iter().copied()))
    }

    /// From its pixels, row by row from the top left.
    ///
    /// # Errors
    /// [`Error::Usage`] when it has no pixels, or other numbers of them than its size says, or is larger than 65,535 each way.
    pub fn new(name: &str, width: usize, height: usize, pixels: &[[u8; 3]]) -> Result<Self, Error> {
        const SIZES: std::ops::RangeInclusive<usize> = 1..=u16::MAX as usize;
        if !SIZES.contains(&width) || !SIZES.contains(&height) || width * height != pixels.len() {
            let n = pixels.len();
            return Err(Error::Usage(format!("texture {name}: {width}x{height} is no size of {n} pixels")));
        }
        let texels = pixels.iter().map(|&[r, g, b]| u32::from_le_bytes([r, g, b, 0])).collect();
        Ok(Self { name: name.into(), width, height, texels })
    }

    /// From the bytes of a PNG or JPEG file; what it says of transparency is left out.
    ///
    /// # Errors
    /// The reason why they are none.
    #[cfg(feature = "textures")]
    pub(super) fn decode(name: &str, bytes: &[u8]) -> Result<Self, String> {
        let image = match image::guess_format(bytes) {
            Ok(image::ImageFormat::Jpeg) => jpeg(bytes)?,
            Ok(image::ImageFormat::Png) => png(bytes)?,
            _ => return Err("only PNG and JPEG are supported: convert it".into()),
        };
        let (width, height) = (image.width() as usize, image.height() as usize);
        Self::new(name, width, height, image.into_raw().as_chunks().0).map_err(|e| e.to_string())
    }

    /// Without the feature `textures`.
    ///
    /// # Errors
    /// Always.
    #[cfg(not(feature = "textures"))]
    pub(super) fn decode(_name: &str, _bytes: &[u8]) -> Result<Self, String> {
        Err("textures need the feature textures of this crate".into())
    }

    /// Its file's name, or what else it is called.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// This one, unless it is too large together with those before it, whose pixels are counted.
    pub(super) fn within(self, texels: &mut usize) -> Result<Arc<Self>, String> {
        *texels += self.texels.len();
        match *texels <= Self::MAX_TEXELS {
            true => Ok(Arc::new(self)),
            false => Err(format!("the textures have more than {} pixels together", Self::MAX_TEXELS)),
        }
    }

    pub(crate) fn texels(&self) -> &[u32] {
        &self.texels
    }

    /// The mean of each of its channels, from 0 to 1, of what `decode` makes of a byte.
    #[cfg(feature = "gltf")]
    pub(super) fn mean(&self, decode: impl Fn(u8) -> f32) -> [f32; 3] {
        let mut counts = [[0_u64; 256]; 3];
        for texel in &self.texels {
            let bytes = texel.to_le_bytes();
            (0..3).for_each(|k| counts[k][usize::from(bytes[k])] += 1);
        }
        counts.map(|counts| {
            let sum: f64 = (0..=255).zip(counts).map(|(byte, n)| f64::from(decode(byte)) * n as f64).sum();
            (sum / self.texels.len() as f64) as f32
        })
    }
}

/// Refuses what announces more pixels than its bytes can stand for.
#[cfg(feature = "textures")]
fn check(width: usize, height: usize, bytes: &[u8], pixels_per_byte: usize) -> Result<(), String> {
    match width.saturating_mul(height) / pixels_per_byte <= bytes.len() {
        true => Ok(()),
        false => Err(format!("it says that it has {width}x{height} pixels: it is damaged or cut short")),
    }
}

#[cfg(feature = "textures")]
fn png(bytes: &[u8]) -> Result<image::RgbImage, String> {
    let reader = || image::ImageReader::with_format(std::io::Cursor::new(bytes), image::ImageFormat::Png);
    let (width, height) = reader().into_dimensions().map_err(|e| e.to_string())?;
    // Deflate packs 1032 bytes into one, each of eight pixels at most.
    check(width as usize, height as usize, bytes, 8192 + 64)?;
    Ok(reader().decode().map_err(|e| e.to_string())?.into_rgb8())
}

/// Decoded without the intrinsics of any processor, for the same bits on all of them: the features `x86` and `neon` of the decoder are off. (Its options do
/// not switch them off: where another crate asks for these features, what is no sound JPEG may look different.)
#[cfg(feature = "textures")]
fn jpeg(bytes: &[u8]) -> Result<image::RgbImage, String> {
    use zune_core::bytestream::ZCursor;
    use zune_core::colorspace::ColorSpace;
    use zune_core::options::DecoderOptions;
    // As large as `image` allows.
    const MOST: usize = 16_384;
    let options = DecoderOptions::default().jpeg_set_out_colorspace(ColorSpace::RGB);
    let options = options.set_max_width(MOST).set_max_height(MOST);
    let mut decoder = zune_jpeg::JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|e| e.to_string())?;
    let (width, height) = decoder.dimensions().unwrap_or_default();
    // A block of 64 pixels takes a bit at least.
    check(width, height, bytes, 512)?;
    let pixels = decoder.decode().map_err(|e| e.to_string())?;
    image::RgbImage::from_raw(width as u32, height as u32, pixels).ok_or_else(|| "it has no colours".into())
}

/// Linear intensity of each byte of sRGB (IEC 61966-2-1).
pub(crate) static LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
    std::array::from_fn(|byte| {
        let c = byte as f64 / 255.0;
        (if c <= 0.040_45 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }) as f32
    })
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes() {
        assert_eq!(
            Texture::new("a", 2, 1, &[[1, 2, 3], [4, 5, 6]]).expect("two pixels").texels(),
            [0x03_0201, 0x06_0504]
        );
        for (width, height) in [(0, 0), (1, 1), (2, 2), (usize::MAX, 2), (2, 0)] {
            Texture::new("a", width, height, &[[0; 3]; 2]).expect_err("not two pixels");
        }
    }

    #[test]
    fn linear_intensities() {
        assert_eq!((LINEAR[0], LINEAR[255]), (0.0, 1.0));
        assert!((LINEAR[128] - 0.215_861).abs() < 1e-6 && LINEAR.is_sorted());
    }

    #[cfg(feature = "gltf")]
    #[test]
    fn means() {
        let texture = Texture::new("a", 2, 1, &[[0, 51, 255], [255, 51, 255]]).expect("two pixels");
        assert_eq!(texture.mean(|byte| f32::from(byte) / 255.0), [0.5, 0.2, 1.0]);
    }

    #[cfg(feature = "textures")]
    #[test]
    fn png_and_jpeg() {
        use image::{GrayImage, ImageFormat, RgbImage, RgbaImage};
        let encode = |image: image::DynamicImage, format| {
            let mut bytes = std::io::Cursor::new(Vec::new());
            image.write_to(&mut bytes, format).expect("encoded");
            bytes.into_inner()
        };
        let picture = RgbImage::from_fn(19, 13, |x, y| image::Rgb([10 * x as u8, 15 * y as u8, 128]));
        let exact = Texture::decode("a", &encode(picture.clone().into(), ImageFormat::Png)).expect("a PNG");
        assert_eq!((exact.size(), exact.texels()[20]), ((19, 13), 0x80_0f0a));
        let lossy = Texture::decode("a", &encode(picture.into(), ImageFormat::Jpeg)).expect("a JPEG");
        assert_eq!(lossy.size(), (19, 13));
        for (a, b) in exact.texels().iter().zip(lossy.texels()) {
            let far = a.to_le_bytes().iter().zip(b.to_le_bytes()).any(|(a, b)| a.abs_diff(b) > 40);
            assert!(!far, "{a:06x} {b:06x}");
        }
        let gray = GrayImage::from_pixel(3, 3, image::Luma([77]));
        for format in [ImageFormat::Png, ImageFormat::Jpeg] {
            let gray = Texture::decode("a", &encode(gray.clone().into(), format)).expect("grey");
            assert!(gray.texels().iter().all(|&t| t == 0x4d_4d4d), "{gray:?}");
        }
        let clear = RgbaImage::from_pixel(1, 1, image::Rgba([1, 2, 3, 0]));
        assert_eq!(Texture::decode("a", &encode(clear.into(), ImageFormat::Png)).expect("clear").texels(), [0x03_0201]);
    }

    /// Cut anywhere it is an error or a picture, never a panic.
    #[cfg(feature = "textures")]
    #[test]
    fn cut_short() {
        let picture = image::RgbImage::from_fn(17, 9, |x, y| image::Rgb([x as u8, y as u8, 99]));
        for format in [image::ImageFormat::Png, image::ImageFormat::Jpeg] {
            let mut bytes = std::io::Cursor::new(Vec::new());
            picture.write_to(&mut bytes, format).expect("encoded");
            let bytes = bytes.into_inner();
            for end in 0..bytes.len() {
                _ = Texture::decode("a", &bytes[..end]);
                let mut damaged = bytes.clone();
                damaged[end] ^= 0x55;
                _ = Texture::decode("a", &damaged);
            }
            Texture::decode("a", &bytes[..20]).expect_err("a header alone");
        }
        // A PNG whose header says that it has 2^30 pixels.
        let mut bytes = std::io::Cursor::new(Vec::new());
        picture.write_to(&mut bytes, image::ImageFormat::Png).expect("encoded");
        let mut bytes = bytes.into_inner();
        bytes[16..24].copy_from_slice(&[0, 0, 0x80, 0, 0, 0, 0x80, 0]);
        let crc = crc32(&bytes[12..29]).to_be_bytes();
        bytes[29..33].copy_from_slice(&crc);
        assert!(Texture::decode("a", &bytes).expect_err("too few bytes").contains("32768x32768 pixels"));
        assert!(Texture::decode("a", b"GIF89a").expect_err("a GIF").contains("PNG and JPEG"));
    }

    /// As PNG wants it (ISO 3309).
    #[cfg(feature = "textures")]
    fn crc32(bytes: &[u8]) -> u32 {
        !bytes.iter().fold(u32::MAX, |crc, &byte| {
            (0..8).fold(crc ^ u32::from(byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 })
        })
    }
}
