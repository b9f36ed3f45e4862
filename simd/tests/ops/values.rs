//! What operations are tried on: patterns that mean something as a float or as an integer, crossed; and random ones.

use std::sync::LazyLock;

/// Each with both signs.
const FLOATS: [f32; 40] = [
    0.0,
    f32::from_bits(1), // denormals
    f32::from_bits(2),
    f32::from_bits(0x7f_ffff),
    f32::MIN_POSITIVE,
    f32::from_bits(0x80_0001),
    1.0e-20,
    1.0 / 3.0,
    0.499_999_97,
    0.5,
    0.500_000_06,
    0.999_999_94,
    1.0,
    1.000_000_1,
    1.5,
    2.0,
    2.5,
    3.5,
    100.7,
    32_768.5,
    4_194_303.5, // 2^22 and neighbours, where the last fractions are
    4_194_304.5,
    8_388_607.0, // 2^23
    8_388_607.5,
    8_388_608.0,
    8_388_609.0,
    16_777_215.0, // 2^24
    16_777_216.0,
    16_777_218.0,
    2_147_483_520.0, // 2^31
    2_147_483_648.0,
    2_147_483_904.0,
    4_294_967_040.0, // 2^32
    4_294_967_296.0,
    4_294_967_808.0,
    1.0e20,
    f32::MAX,
    f32::INFINITY,
    f32::NAN,
    f32::from_bits(0x7f80_0001), // a signalling NaN
];

const INTEGERS: [u32; 34] = [
    2,
    3,
    5,
    31,
    32,
    0xffff,
    0x1_0000,
    0x1_0001,
    0xff_ffff, // 2^24: from here on integers are rounded
    0x100_0000,
    0x100_0001,
    0x100_0002,
    0x100_0003,
    0x1ff_ffff,
    0x5555_5555,
    0x7fff_ff3f, // ties below 2^31
    0x7fff_ff40,
    0x7fff_ffbf,
    0x7fff_ffc0,
    0x7fff_fffe,
    0x7fff_ffff,
    0x8000_0001,
    0x8000_0040, // ties above, signed and unsigned
    0x8000_0080,
    0x8000_0081,
    0x8000_0180,
    0xaaaa_aaaa,
    0xff00_0001,
    0xffff_ff7f,
    0xffff_ff80,
    0xffff_ff81,
    0xffff_fffd,
    0xffff_fffe,
    0xffff_ffff,
];

/// All of them: a float is also a strange integer, an integer a strange float.
pub static SPECIAL: LazyLock<Vec<u32>> = LazyLock::new(|| {
    let floats = FLOATS.into_iter().flat_map(|x| [x.to_bits(), (-x).to_bits()]);
    floats.chain(INTEGERS).collect()
});

/// Steele, Lea and Flood's SplitMix64 ("Fast splittable pseudorandom number generators", 2014).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 32) as u32
    }

    /// Between -16 and 16.
    pub fn moderate(&mut self) -> f32 {
        self.bits() as i32 as f32 / (1 << 27) as f32
    }
}

/// The arguments of an operation: special values crossed, random patterns, random floats of similar size.
pub fn rows(arity: usize) -> Vec<[u32; 3]> {
    // Of triples every third value in each place.
    let special: Vec<u32> = SPECIAL.iter().copied().step_by(if arity < 3 { 1 } else { 3 }).collect();
    let n = special.len();
    let crossed = (0..n.pow(arity as u32)).map(|row| [row, row / n, row / n / n].map(|digit| special[digit % n]));
    let mut rows: Vec<[u32; 3]> = crossed.collect();
    let mut random = Random(1);
    rows.extend((0..1 << 14).map(|_| [0; 3].map(|_| random.bits())));
    rows.extend((0..1 << 14).map(|_| [0; 3].map(|_| random.moderate().to_bits())));
    rows.resize(rows.len().next_multiple_of(16), [0; 3]);
    rows
}
