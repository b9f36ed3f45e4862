//! Hashes of rays: neighbours get the same, or near ones (Garanzha and Loop 2010, sections 3.1 and 4).

use crate::geometry::{Aabb, RayBatch, RayBlock, Vec3};
use rayon::prelude::*;
use simd::{Float, Level, Uint, Vector, kernel};
use std::fmt;
use std::str::FromStr;

/// Blocks of rays that a thread takes at a time.
const PORTION: usize = 1 << 10;

/// By what rays are put into order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Reorder {
    /// They stay as they are.
    #[default]
    None,
    /// By the cell of their origin, as the paper does with shadow rays to an area light.
    Origin,
    /// By the cell of their origin, then by direction.
    Hash,
    /// By direction, then by the cell of their origin.
    Direction,
}

impl Reorder {
    /// All choices.
    pub const ALL: [Self; 4] = [Self::None, Self::Hash, Self::Origin, Self::Direction];

    /// The name that [`Reorder::from_str`] takes.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Origin => "origin",
            Self::Hash => "hash",
            Self::Direction => "direction",
        }
    }
}

impl FromStr for Reorder {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|choice| choice.name() == name);
        found.ok_or_else(|| format!("unknown order '{name}'; known: none, hash, origin, direction"))
    }
}

impl fmt::Display for Reorder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// How rays are hashed to 32 bits.
///
/// Origins: the scene's box is cut into cubes whose side is a fraction of its diagonal. With fraction 1 / n and c = log2(n), rounded up, a cell
/// has c bits for each axis, interleaved (along a Z-curve) so that neighbours are near in order: 24 bits with the paper's 0.004. What lies
/// outside of the box counts as in the cell at the border.
///
/// Directions: three bits for the axis of the largest component and its sign, the face of a cube that the direction goes through; then d
/// bits for the place on the face in each direction, interleaved, d being what is left of 32 bits, at most 8: 2 with fraction 0.004, 5 with 1/64.
///
/// From the highest bit on: [`Reorder::Hash`] has origin and direction, [`Reorder::Direction`] direction and origin, [`Reorder::Origin`] the origin
/// alone. Only strict operations are used: the same bits at every level.
#[derive(Debug, Clone, Copy)]
pub struct RayHash {
    key: Reorder,
    /// The box's lower corner.
    corner: [f32; 3],
    /// Cells per unit of length.
    cells: f32,
    /// Bits of an origin's cell for each axis.
    cell_bits: usize,
    /// Bits of the place on a face, for each of the two.
    place_bits: usize,
}

impl RayHash {
    /// The paper's size of a cell, the fraction of the diagonal that was best for most of its scenes.
    pub const CELL: f32 = 0.004;

    /// For rays in a scene's box, with cells of [`RayHash::CELL`].
    #[must_use]
    pub fn new(bounds: &Aabb, key: Reorder) -> Self {
        Self::with_cell(bounds, key, Self::CELL)
    }

    /// With cells whose side is a fraction of the box's diagonal: from 1/512 (1/1024 for origins alone) to 1, what is beyond counts as that.
    #[must_use]
    pub fn with_cell(bounds: &Aabb, key: Reorder, cell: f32) -> Self {
        let most = if key == Reorder::Origin { 10 } else { 9 };
        // No comparison is true of NaN.
        let cell = if cell > 1.0 / (1 << most) as f32 { cell.min(1.0) } else { 1.0 / (1 << most) as f32 };
        let cell_bits = (1..most).find(|&bits| (1 << bits) as f32 * cell >= 1.0).unwrap_or(most);
        let [x, y, z] = bounds.extent();
        let side = cell * (x * x + y * y + z * z).sqrt();
        // An empty box, a point, one that is too large: all rays start in one cell.
        let cells = if side.is_finite() && side >= f32::MIN_POSITIVE { 1.0 / side } else { 0.0 };
        let place_bits = ((32 - 3 - 3 * cell_bits.min(9)) / 2).min(8);
        Self { key, corner: bounds.min, cells, cell_bits, place_bits }
    }

    /// Bits of an origin's cell for each axis, and of a direction for each of the two coordinates on its face.
    #[must_use]
    pub const fn bits(&self) -> [usize; 2] {
        [self.cell_bits, self.place_bits]
    }

    /// By what it orders.
    #[must_use]
    pub const fn key(&self) -> Reorder {
        self.key
    }

    /// The hash of each ray.
    pub fn hash(&self, level: Level, rays: &RayBatch, hashes: &mut Vec<u32>) {
        hashes.resize(rays.len(), 0);
        let portions = rays.blocks().par_chunks(PORTION).zip(hashes.par_chunks_mut(16 * PORTION));
        portions.for_each(|(rays, hashes)| hash_blocks(level, self, rays, hashes));
    }

    #[inline(always)]
    fn of<F: Float>(&self, org: Vec3<F>, dir: Vec3<F>) -> F::Index {
        match self.key {
            Reorder::None => F::Index::default(),
            Reorder::Origin => self.cell(org),
            Reorder::Hash => (self.cell(org) << (3 + 2 * self.place_bits)) | self.direction(dir),
            Reorder::Direction => (self.direction(dir) << (3 * self.cell_bits)) | self.cell(org),
        }
    }

    #[inline(always)]
    fn cell<F: Float>(&self, org: Vec3<F>) -> F::Index {
        let p = (org - Vec3::splat(self.corner)).scale(F::splat(self.cells));
        let last = F::Index::splat((1 << self.cell_bits) - 1);
        // What is below 0 or NaN is 0.
        let (x, y, z) = (p.x.to_uint().min(last), p.y.to_uint().min(last), p.z.to_uint().min(last));
        (spread3(x) << 2) | (spread3(y) << 1) | spread3(z)
    }

    #[inline(always)]
    fn direction<F: Float>(&self, dir: Vec3<F>) -> F::Index {
        let (zero, one) = (F::splat(0.0), F::splat(1.0));
        let (x, y, z) = (dir.x.abs(), dir.y.abs(), dir.z.abs());
        let along_x = x.ge(y) & x.ge(z);
        let along_y = y.ge(z);
        let major = F::select(along_x, dir.x, F::select(along_y, dir.y, dir.z));
        let u = F::select(along_x, dir.y, F::select(along_y, dir.z, dir.x));
        let v = F::select(along_x, dir.z, F::select(along_y, dir.x, dir.y));
        let axis = F::select(along_x, zero, F::select(along_y, one, F::splat(2.0))).to_uint();
        let sign = F::select(major.lt(zero), one, zero).to_uint();
        // From -1 .. 1 to the numbers of cells.
        let half = F::splat((1_u32 << self.place_bits) as f32 * 0.5);
        let last = F::Index::splat((1 << self.place_bits) - 1);
        let size = major.abs();
        let (u, v) = ((u / size + one) * half, (v / size + one) * half);
        let (u, v) = (u.to_uint().min(last), v.to_uint().min(last));
        let face = (axis << 1) | sign;
        (face << (2 * self.place_bits)) | (spread2(u) << 1) | spread2(v)
    }
}

kernel! {
    fn hash_blocks<S>(hash: &RayHash, rays: &[RayBlock], hashes: &mut [u32]) {
        let lanes = S::Float::LANES;
        for (block, hashes) in rays.iter().zip(hashes.chunks_mut(16)) {
            for chunk in 0..16 / lanes {
                let (org, dir) = (Vec3::<S::Float>::load(&block.org, chunk), Vec3::load(&block.dir, chunk));
                let to = (chunk * lanes).min(hashes.len());
                hash.of(org, dir).store_partial(&mut hashes[to..]);
            }
        }
    }
}

/// Moves the lowest ten bits apart, two zeros between them.
#[inline(always)]
fn spread3<U: Uint>(x: U) -> U {
    let x = (x | (x << 16)) & U::splat(0x0300_00ff);
    let x = (x | (x << 8)) & U::splat(0x0300_f00f);
    let x = (x | (x << 4)) & U::splat(0x030c_30c3);
    (x | (x << 2)) & U::splat(0x0924_9249)
}

/// Moves the lowest eight bits apart, a zero between them.
#[inline(always)]
fn spread2<U: Uint>(x: U) -> U {
    let x = (x | (x << 4)) & U::splat(0x0f0f);
    let x = (x | (x << 2)) & U::splat(0x3333);
    (x | (x << 1)) & U::splat(0x5555)
}

/// The pixels of a picture along a Z-curve, which is how the paper orders eye rays: numbers of pixels, row after row in the picture.
///
/// # Panics
/// If a side has more than 65,536 pixels, or the picture as many as [`u32::MAX`].
#[must_use]
pub fn z_order(width: usize, height: usize) -> Vec<u32> {
    assert!(width.max(height) <= 1 << 16, "a picture of {width}x{height} pixels");
    assert!(u32::try_from(width * height).is_ok(), "a picture of {width}x{height} pixels");
    let spread = |x: usize| (0..16).fold(0_u32, |sum, bit| sum | (x as u32 >> bit & 1) << (2 * bit));
    let columns: Vec<u32> = (0..width).map(spread).collect();
    let mut keys: Vec<u32> = Vec::with_capacity(width * height);
    for y in 0..height {
        let row = spread(y) << 1;
        keys.extend(columns.iter().map(|column| column | row));
    }
    let mut order = (0..keys.len() as u32).collect::<Vec<u32>>();
    super::RadixSort::new().sort(&mut keys, &mut order);
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ray;
    use crate::sort::test;

    const BOX: Aabb = Aabb { min: [-1.0, 0.0, 2.0], max: [3.0, 4.0, 6.0] };

    fn hashes(hash: &RayHash, level: Level, rays: &RayBatch) -> Vec<u32> {
        let mut hashes = Vec::new();
        hash.hash(level, rays, &mut hashes);
        hashes
    }

    /// Rays everywhere, some of them odd.
    fn rays() -> RayBatch {
        let numbers = test::random(6 * 3000, 5);
        let odd = [0.0, -0.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, f32::MIN_POSITIVE, 1e-42];
        let number = |&x: &u32| if x % 50 == 0 { odd[x as usize / 50 % 8] } else { (x >> 8) as f32 / 1e6 - 8.0 };
        let of = |x: &[u32]| Ray::new([0, 1, 2].map(|i| number(&x[i])), [3, 4, 5].map(|i| number(&x[i])));
        numbers.chunks(6).map(of).chain([Ray::new([0.0; 3], [0.0; 3])]).collect()
    }

    #[test]
    fn the_same_bits_everywhere() {
        let rays = rays();
        for key in Reorder::ALL {
            for cell in [RayHash::CELL, 1.0 / 64.0, 0.0005, 0.7, 3.0, f32::NAN] {
                let hash = RayHash::with_cell(&BOX, key, cell);
                let expected = hashes(&hash, Level::SCALAR, &rays);
                test::everywhere(|| {
                    for level in Level::available() {
                        assert_eq!(hashes(&hash, level, &rays), expected, "{key}, {level}");
                    }
                });
            }
        }
    }

    #[test]
    fn fields_fill_the_hash() {
        let bits = |key, cell| RayHash::with_cell(&BOX, key, cell).bits();
        assert_eq!(bits(Reorder::Hash, RayHash::CELL), [8, 2]);
        assert_eq!(bits(Reorder::Hash, 1.0 / 64.0), [6, 5]);
        assert_eq!(bits(Reorder::Hash, 0.0), [9, 1]);
        assert_eq!(bits(Reorder::Origin, 0.0)[0], 10);
        assert_eq!(bits(Reorder::Direction, 1.0), [1, 8]);
    }

    #[test]
    fn rays_of_one_cell_and_face_have_one_hash() {
        let hash = RayHash::with_cell(&BOX, Reorder::Hash, 0.1);
        // Cells have a side of 0.1 sqrt(48) = 0.69.
        let of = |org, dir| hashes(&hash, Level::best(), &[Ray::new(org, dir)].into_iter().collect())[0];
        let one = of([-0.9, 0.1, 2.1], [1.0, 0.01, 0.02]);
        assert_eq!(one, of([-0.5, 0.6, 2.6], [100.0, 1.1, 2.1]));
        assert_ne!(one, of([-0.9, 0.8, 2.1], [1.0, 0.01, 0.02]));
        assert_ne!(one, of([-0.9, 0.1, 2.1], [-1.0, 0.01, 0.02]));
        assert_ne!(one, of([-0.9, 0.1, 2.1], [0.01, 1.0, 0.02]));
        assert_ne!(one, of([-0.9, 0.1, 2.1], [1.0, 0.9, 0.02]));
        let origin = RayHash::with_cell(&BOX, Reorder::Origin, 0.1);
        let rays = [Ray::new([0.0, 1.0, 3.0], [1.0, 0.0, 0.0]), Ray::new([0.0, 1.0, 3.0], [0.0, -1.0, 0.0])];
        let both = hashes(&origin, Level::best(), &rays.into_iter().collect());
        assert_eq!(both[0], both[1]);
    }

    #[test]
    fn a_scene_without_extent_has_one_cell() {
        for bounds in
            [Aabb::EMPTY, Aabb { min: [1.0; 3], max: [1.0; 3] }, Aabb { min: [f32::MIN; 3], max: [f32::MAX; 3] }]
        {
            let hash = RayHash::new(&bounds, Reorder::Origin);
            assert!(hashes(&hash, Level::best(), &rays()).iter().all(|&hash| hash == 0), "{bounds:?}");
        }
    }

    #[test]
    fn z_curves() {
        assert_eq!(z_order(4, 4), [0, 1, 4, 5, 2, 3, 6, 7, 8, 9, 12, 13, 10, 11, 14, 15]);
        assert_eq!(z_order(3, 2), [0, 1, 3, 4, 2, 5]);
        assert!(z_order(0, 5).is_empty());
        let mut all = z_order(300, 217);
        // 16 x 16 pixels are 256 in a row.
        assert!(all[..256].iter().all(|pixel| pixel % 300 < 16 && pixel / 300 < 16));
        all.sort_unstable();
        assert!(all.into_iter().eq(0..300 * 217));
    }

    #[test]
    fn names() {
        for choice in Reorder::ALL {
            assert_eq!(choice.to_string().parse(), Ok(choice));
        }
        assert!("morton".parse::<Reorder>().is_err());
    }
}
