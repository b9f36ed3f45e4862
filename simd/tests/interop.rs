//! Conversions to and from other crates' types, both ways.

#![allow(unused, reason = "each feature uses its part")]

use simd::{Block, Float, Level, Simd, Vector};

fn numbers() -> [f32; 16] {
    std::array::from_fn(|i| i as f32 - 7.5)
}

#[cfg(feature = "bytemuck")]
#[test]
fn plain_data() {
    let zero: Block<i32> = bytemuck::Zeroable::zeroed();
    assert_eq!(zero, Block::default());
    let blocks = [Block(numbers()), Block([-0.0; 16])];
    let bits: &[Block<u32>] = bytemuck::cast_slice(&blocks);
    assert_eq!(bits[0].0, numbers().map(f32::to_bits));
    assert_eq!(bits[1].0, [1 << 31; 16]);
    assert_eq!(bytemuck::bytes_of(&blocks).len(), 128);
    assert_eq!(bytemuck::cast_slice::<_, f32>(&blocks), Block::flatten(&blocks));
}

/// Blocks as the vectors of another crate and back.
macro_rules! fill_blocks {
    ($test:ident: $krate:ident) => {
        #[test]
        fn $test() {
            macro_rules! check {
                ($lanes:expr, $x4:ty, $x8:ty, $x16:ty) => {{
                    let block = Block($lanes);
                    let x4: [$x4; 4] = block.into();
                    let x8: [$x8; 2] = block.into();
                    let x16: $x16 = block.into();
                    assert_eq!(bytemuck::bytes_of(&x4), bytemuck::bytes_of(&block));
                    assert_eq!(bytemuck::cast::<$x4, [u32; 4]>(x4[3]), bytemuck::cast::<_, [u32; 16]>(block)[12..]);
                    assert_eq!(bytemuck::cast::<$x8, [u32; 8]>(x8[1]), bytemuck::cast::<_, [u32; 16]>(block)[8..]);
                    assert_eq!(Block::from(x4), block);
                    assert_eq!(Block::from(x8), block);
                    assert_eq!(Block::from(x16), block);
                }};
            }
            check!(numbers(), $krate::f32x4, $krate::f32x8, $krate::f32x16);
            check!(numbers().map(|x| x as i32 * 1_000_000), $krate::i32x4, $krate::i32x8, $krate::i32x16);
            check!(numbers().map(f32::to_bits), $krate::u32x4, $krate::u32x8, $krate::u32x16);
        }
    };
}

#[cfg(feature = "wide")]
fill_blocks!(wide_vectors: wide);
#[cfg(feature = "pulp")]
fill_blocks!(pulp_vectors: pulp);

#[cfg(feature = "glam")]
mod glam_points {
    use super::*;
    use glam::{Vec3, Vec4};
    use simd::interop::glam::*;

    #[inline(always)]
    fn there_and_back<F: Float>() {
        let points4: [Vec4; 16] = std::array::from_fn(|i| Vec4::new(i as f32, -1.0, 0.5 * i as f32, 100.0));
        let points3 = points4.map(Vec4::truncate);
        let xyzw = load4::<F>(&points4);
        let xyz = load3::<F>(&points3);
        for lane in 0..F::LANES {
            assert_eq!(Vec4::from_array([0, 1, 2, 3].map(|k| xyzw[k].lane(lane))), points4[lane]);
            assert_eq!(Vec3::from_array([0, 1, 2].map(|k| xyz[k].lane(lane))), points3[lane]);
        }
        let (mut back4, mut back3) = ([Vec4::ZERO; 16], [Vec3::ZERO; 16]);
        store4(xyzw, &mut back4);
        store3(xyz, &mut back3);
        assert_eq!(back4[..F::LANES], points4[..F::LANES]);
        assert_eq!(back3[..F::LANES], points3[..F::LANES]);
        assert!(back4[F::LANES..].iter().all(|&p| p == Vec4::ZERO));
        assert!(back3[F::LANES..].iter().all(|&p| p == Vec3::ZERO));
    }

    simd::kernel! {
        fn all_widths<S>() {
            there_and_back::<f32>();
            there_and_back::<S::Float4>();
            there_and_back::<S::Float8>();
            there_and_back::<S::Float16>();
        }
    }

    #[test]
    fn points() {
        for level in Level::available() {
            all_widths(level);
        }
    }

    #[test]
    #[should_panic(expected = "out of range")]
    fn too_few() {
        let _ = load3::<f32>(&[]);
    }
}
