//! What the targets share.
#![forbid(unsafe_code)]

use arbitrary::{Arbitrary, Unstructured};
use std::path::Path;
use tracer::geometry::{Ray, RayBatch};

/// Everything on the thread of the fuzzer: it watches that one.
pub fn one_thread() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    pool.build_global().expect("the first pool");
}

/// Calls `f` with the path of a file of these bytes, in memory where the system has such a folder.
pub fn with_file(name: &str, bytes: &[u8], f: impl FnOnce(&Path)) {
    let memory = Path::new("/dev/shm");
    let folder = if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() }.expect("a folder");
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).expect("written");
    f(&path);
}

/// A number that geometry has trouble with, a small one that others are equal to, or any.
#[derive(Debug, Clone, Copy)]
pub struct Number(pub f32);

impl<'a> Arbitrary<'a> for Number {
    fn arbitrary(u: &mut Unstructured<'a>) -> arbitrary::Result<Self> {
        const SPECIAL: [f32; 16] = [
            -0.0,
            1e6,
            -1e6,
            1e30,
            -1e30,
            1e-40,
            1e-30,
            f32::MIN_POSITIVE,
            f32::MAX,
            f32::MIN,
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            1.0 + f32::EPSILON,
            1e18,
            -1e-18,
        ];
        Ok(Self(match u.arbitrary::<u8>()? {
            x @ 0..200 => (f32::from(x) - 100.0) / 8.0,
            x @ 200..216 => SPECIAL[usize::from(x) - 200],
            _ => f32::from_bits(u.arbitrary()?),
        }))
    }
}

/// A ray from any numbers.
#[derive(Debug, Clone, Copy, Arbitrary)]
pub struct AnyRay {
    org: [Number; 3],
    dir: [Number; 3],
    interval: Option<[Number; 2]>,
}

impl AnyRay {
    /// The same as the library has it.
    #[must_use]
    pub fn ray(&self) -> Ray {
        let ray = Ray::new(self.org.map(|x| x.0), self.dir.map(|x| x.0));
        self.interval.map_or(ray, |[t_min, t_max]| Ray { t_min: t_min.0, t_max: t_max.0, ..ray })
    }
}

/// Some rays through whatever lies around the origin.
#[must_use]
pub fn some_rays() -> RayBatch {
    (0..48)
        .map(|i| {
            let x = (i * 37 % 48) as f32 / 24.0 - 1.0;
            let (org, dir) = ([4.0 * x, 0.3 - x, 5.0], [x * 0.1, x * (i % 3) as f32, -1.0]);
            Ray::new(org, if i < 24 { dir } else { [dir[2], dir[0], dir[1]] })
        })
        .collect()
}
