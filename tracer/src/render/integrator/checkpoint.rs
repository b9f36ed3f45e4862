//! Pictures that are not finished as files.
//!
//! Behind the header of [`crate::sealed`]: the length of a text in bytes, this text, the pixels times samples that are done (eight bytes), whether
//! rays are counted; then for each pixel three sums (words), mean and squares of the luminance (eight bytes each), the number of rays if counted.

use super::{Config, Film, Integrator, Path};
use crate::Error;
use crate::hash::fnv1a;
use crate::model::{Camera, Light, Material, Mesh, Model};
use crate::render::Scenery;
use crate::sealed::Kind;
use std::fmt::Write;

const KIND: Kind = Kind {
    magic: b"TRACERC\n",
    version: 1,
    name: "a checkpoint",
    remedy: "name another file, or remove it to begin anew",
};

/// What a picture is of, and how it is made: all that its bits depend on beside the number of samples. One field in each line, with its name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Identity(String);

impl Identity {
    /// Of a picture made of these.
    #[must_use]
    pub fn new(model: &Model, scenery: &Scenery, camera: &Camera, config: &Config) -> Self {
        let mut text = String::new();
        let mut field = |name: &str, value: &dyn std::fmt::Display| {
            let _ = writeln!(text, "{name}: {value}");
        };
        let part = config.part();
        field("program", &concat!("tracer ", env!("CARGO_PKG_VERSION")));
        field("scene", &format!("{:016x}", hash(model)));
        field("environment", &scenery.environment_text());
        field("camera", camera);
        field("size", &format!("{}x{}", config.width, config.height));
        field("crop", &format!("{},{},{},{}", part.x, part.y, part.width, part.height));
        field("seed", &config.seed);
        field("samples", &if config.samples > 1 { "several" } else { "one, through the middle of each pixel" });
        match config.integrator {
            Integrator::Eye { shadows } => {
                field("integrator", &"eye");
                field("shadows", &shadows);
            }
            Integrator::Whitted { bounces } => {
                field("integrator", &"whitted");
                field("bounces", &bounces);
            }
            Integrator::AmbientOcclusion { distance } => {
                field("integrator", &"ao");
                field("distance", &distance);
            }
            Integrator::Path(Path { bounces, roulette, mis, coat_alone }) => {
                field("integrator", &"path");
                field("bounces", &bounces);
                field("roulette", &roulette);
                field("mis", &mis);
                field("coat-alone", &coat_alone);
            }
        }
        Self(text)
    }

    /// The first field in which the other differs.
    fn differs(&self, other: &str) -> Option<String> {
        let pairs = self.0.lines().zip(other.lines());
        let (own, others) = pairs.into_iter().find(|(own, other)| own != other)?;
        let (name, own) = own.split_once(": ")?;
        let value = others.strip_prefix(name).and_then(|rest| rest.strip_prefix(": "));
        Some(match value {
            Some(value) => format!("its {name} is {value}, not {own}"),
            None => format!("it says nothing of its {name}, which should be {own}"),
        })
    }
}

/// Of all that can be seen. Whoever adds a field decides here whether it can be.
fn hash(model: &Model) -> u64 {
    let Model { name: _, mesh, materials, lights, camera: _, ambient, background } = model;
    let Mesh { positions, triangles, normals, normal_indices, materials: of_triangles, uvs, uv_indices } = mesh;
    let floats = |list: &[[f32; 3]]| fnv1a(list.as_flattened().iter().map(|c| c.to_bits()));
    let words = |list: &[[u32; 3]]| fnv1a(list.as_flattened().iter().copied());
    let mut parts = vec![
        floats(positions),
        words(triangles),
        floats(normals),
        words(normal_indices),
        fnv1a(of_triangles.iter().copied()),
        fnv1a(uvs.as_flattened().iter().map(|c| c.to_bits())),
        words(uv_indices),
    ];
    for material in materials {
        let Material {
            name: _,
            ambient,
            diffuse,
            specular,
            shininess,
            emission,
            ior,
            transmission,
            reflection,
            texture,
            texture_on_specular,
        } = material;
        parts.push(floats(&[*ambient, *diffuse, *specular, *emission, *transmission, [*shininess, *ior, 0.0]]));
        parts.push(*reflection as u64);
        parts.push(u64::from(*texture_on_specular));
        parts.push(texture.as_ref().map_or(0, |texture| texture.hash()));
    }
    for Light { position, intensity } in lights {
        parts.push(floats(&[*position, *intensity]));
    }
    parts.push(floats(&[[*ambient; 3], *background]));
    fnv1a(parts.iter().flat_map(|&part| [part as u32, (part >> 32) as u32]))
}

impl Film {
    /// Writes all that is needed to go on with the picture. The file appears whole or not at all.
    ///
    /// # Errors
    /// [`Error::Io`] when it cannot be written.
    pub fn save(&self, path: &std::path::Path, of: &Identity) -> Result<(), Error> {
        let mut body = Vec::with_capacity(64 + of.0.len() + 32 * self.sums.len());
        body.extend((of.0.len() as u32).to_le_bytes());
        body.extend(of.0.as_bytes());
        body.extend(self.done.to_le_bytes());
        body.extend(u32::from(!self.rays.is_empty()).to_le_bytes());
        self.sums.as_flattened().iter().for_each(|c| body.extend(c.to_le_bytes()));
        self.luminance.as_flattened().iter().for_each(|c| body.extend(c.to_le_bytes()));
        self.rays.iter().for_each(|n| body.extend(n.to_le_bytes()));
        KIND.write(path, &body)
    }

    /// Reads what [`Film::save`] wrote, on any machine, to go on with this picture.
    ///
    /// # Errors
    /// [`Error::Usage`] for a configuration that makes no sense; [`Error::Io`] when the file cannot be read, [`Error::Data`] when it is of another kind or
    /// version, damaged, or of another picture: then with the field that differs.
    pub fn load(path: &std::path::Path, of: &Identity, config: &Config) -> Result<Self, Error> {
        config.validate()?;
        let bytes =
            std::fs::read(path).map_err(|source| Error::Io { action: "read", path: path.to_owned(), source })?;
        parse(&bytes, of, config).map_err(|message| Error::Data { path: path.to_owned(), line: None, message })
    }
}

fn parse(bytes: &[u8], of: &Identity, config: &Config) -> Result<Film, String> {
    let mut words = KIND.open(bytes)?;
    let length = words.word()? as usize;
    let text = std::str::from_utf8(words.bytes(length)?).map_err(|_| KIND.damaged("its text is none"))?;
    if let Some(difference) = of.differs(text) {
        return Err(format!("a checkpoint of another picture, {difference}: {}", KIND.remedy));
    }
    if text != of.0 {
        return Err(KIND.damaged("its text has another length"));
    }
    let mut film = Film::new(config);
    film.done = words.long()?;
    match (words.word()?, config.count_rays) {
        (0, true) => return Err(format!("a checkpoint that does not count rays: {}", KIND.remedy)),
        (0, false) => {}
        (1, _) => film.rays = vec![0; film.sums.len()],
        _ => return Err(KIND.damaged("it counts something unknown")),
    }
    let of_pixel = 3 * 4 + 2 * 8 + if film.rays.is_empty() { 0 } else { 4 };
    if words.len() as u64 != of_pixel * film.pixels() {
        return Err(KIND.damaged("its numbers contradict its length"));
    }
    for sum in &mut film.sums {
        *sum = words.floats()?;
    }
    for number in film.luminance.as_flattened_mut() {
        *number = f64::from_bits(words.long()?);
    }
    for rays in &mut film.rays {
        *rays = words.word()?;
    }
    let finite = film.sums.as_flattened().iter().all(|c| c.is_finite())
        && film.luminance.iter().all(|[mean, squares]| mean.is_finite() && squares.is_finite() && *squares >= 0.0);
    if !finite {
        return Err(KIND.damaged("its sums are not those of light"));
    }
    let most = film.pixels() * u64::from(config.samples);
    if film.done > most {
        let more = film.done.div_ceil(film.pixels());
        return Err(format!(
            "a checkpoint of {more} samples, {} are asked for: ask for as many, or more",
            config.samples
        ));
    }
    Ok(film)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::integrator::Crop;
    use crate::sealed::{HEADER, with_checksum};

    fn config() -> Config {
        Config { samples: 8, crop: Some(Crop { x: 1, y: 2, width: 3, height: 2 }), ..Config::new(20, 10) }
    }

    fn identity(config: &Config) -> Identity {
        let model = crate::model::builtin("balls:0").expect("a name").expect("a size");
        let camera = model.camera_or_default();
        Identity::new(&model, &Scenery::new(&model, &camera), &camera, config)
    }

    fn film(config: &Config) -> Film {
        let mut film = Film::new(config);
        let pixels = crate::render::integrator::camera::pixels(&config.part());
        film.add(&pixels, &[[0.25, 1.0, 3.5]; 6], &[7; 6]);
        film.add(&pixels[..4], &[[0.1, 0.2, 1e-20]; 4], &[2; 4]);
        film
    }

    fn saved(config: &Config) -> Vec<u8> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("film");
        film(config).save(&path, &identity(config)).expect("written");
        std::fs::read(&path).expect("read")
    }

    #[test]
    fn comes_back_the_same() {
        for count_rays in [false, true] {
            let config = Config { count_rays, ..config() };
            let loaded = parse(&saved(&config), &identity(&config), &config).expect("sound");
            assert_eq!(loaded, film(&config));
            assert_eq!((loaded.samples(), loaded.done(), loaded.rays.len()), (1, 10, if count_rays { 6 } else { 0 }));
        }
        // Counts that are there are kept, counts that are not cannot be made up.
        let (with, without) = (Config { count_rays: true, ..config() }, config());
        assert_eq!(parse(&saved(&with), &identity(&without), &without).expect("sound"), film(&with));
        let e = parse(&saved(&without), &identity(&with), &with).expect_err("no counts");
        assert!(e.contains("does not count rays"), "{e}");
    }

    /// Every field is told apart, and named.
    #[test]
    fn of_another_picture() {
        let usual = config();
        let bytes = saved(&usual);
        let path = |path| Integrator::Path(path);
        let crop = Some(Crop { x: 2, y: 2, width: 3, height: 2 });
        for (other, field) in [
            (Config { width: 21, ..usual }, "size is 20x10, not 21x10"),
            (Config { crop, ..usual }, "crop is 1,2,3,2, not 2,2,3,2"),
            (Config { seed: 1, ..usual }, "seed is 0, not 1"),
            (Config { samples: 1, ..usual }, "samples is several"),
            (Config { integrator: Integrator::Whitted { bounces: 2 }, ..usual }, "integrator is path, not whitted"),
            (Config { integrator: path(Path { bounces: 9, ..Path::default() }), ..usual }, "bounces is 2, not 9"),
            (Config { integrator: path(Path { mis: true, ..Path::default() }), ..usual }, "mis is false, not true"),
            (Config { integrator: path(Path { roulette: true, ..Path::default() }), ..usual }, "roulette"),
            (Config { integrator: path(Path { coat_alone: true, ..Path::default() }), ..usual }, "coat-alone"),
        ] {
            let e = parse(&bytes, &identity(&other), &other).expect_err(field);
            assert!(e.contains("another picture") && e.contains(field), "{e}");
        }
        let model = crate::model::builtin("balls:0").expect("a name").expect("a size");
        let camera = model.camera_or_default();
        let of = |model: &Model, camera: Camera| {
            let scenery = Scenery::new(model, &camera);
            parse(&bytes, &Identity::new(model, &scenery, &camera, &usual), &usual).err().unwrap_or_default()
        };
        assert!(of(&model, Camera { fov: 1.0, ..camera }).contains("its camera is"));
        let changes: [fn(&mut Model); 6] = [
            |m| m.mesh.positions[7][1] += 1.0,
            |m| m.mesh.triangles.swap(0, 1),
            |m| m.mesh.normals[0] = [1.0, 0.0, 0.0],
            |m| m.materials[0].diffuse[2] = 0.11,
            |m| m.lights.truncate(1),
            |m| m.ambient = 0.77,
        ];
        for change in changes {
            let mut changed = model.clone();
            change(&mut changed);
            assert!(of(&changed, camera).contains("its scene is"));
        }
        let fewer = Config { samples: 2, ..usual };
        assert!(parse(&bytes, &identity(&fewer), &fewer).is_ok());
        let mut long = film(&usual);
        long.done = 6 * 5 + 1;
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("film");
        long.save(&file, &identity(&usual)).expect("written");
        let e = Film::load(&file, &identity(&fewer), &fewer).expect_err("fewer");
        assert!(e.to_string().contains("of 6 samples, 2 are asked for"), "{e}");
    }

    #[test]
    fn damage_is_an_error() {
        let (config, good) = (config(), saved(&config()));
        let fails = |bytes: &[u8], reason: &str| {
            let e = parse(bytes, &identity(&config), &config).expect_err(reason);
            assert!(e.contains(reason), "{e}");
        };
        fails(&[], "not a checkpoint");
        fails(b"P6 20 10 255, no checkpoint of ours", "not a checkpoint");
        fails(&good[..good.len() - 1], "bytes where there should be");
        let mut version = good.clone();
        version[8] = 9;
        fails(&version, "version 9");
        for at in HEADER..good.len() {
            let mut bytes = good.clone();
            bytes[at] ^= 0x10;
            fails(&bytes, "the checksum is another");
            // With a checksum that is right: an error, or a picture that can be gone on with.
            if let Ok(film) = parse(&with_checksum(bytes), &identity(&config), &config) {
                assert!(film.done <= 48 && film.sums.as_flattened().iter().all(|c| c.is_finite()));
            }
        }
    }
}
