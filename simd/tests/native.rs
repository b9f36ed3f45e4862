//! The types that can be named: the same bits as at every level.

use simd::{Block, Float, Int, Isa, Level, Mask, Vector, math, native};

#[inline(always)]
fn work<F: Float>(input: &[Block<f32>], output: &mut [Block<f32>]) -> usize {
    let mut count = 0;
    for (input, output) in input.iter().zip(output) {
        for chunk in 0..16 / F::LANES {
            let x = F::load_block(input, chunk);
            let negative = x.lt(F::splat(0.0));
            count += negative.count();
            let y = F::select(negative, x.floor() * x, math::pow(x, F::splat(1.5)) / (x + F::splat(0.25)).sqrt());
            (y + F::from_int(x.to_int() >> 1)).store_block(output, chunk);
        }
    }
    count
}

simd::kernel! {
    fn at_level<S>(input: &[Block<f32>], output: &mut [Block<f32>]) -> usize {
        work::<S::Float>(input, output)
    }
}

fn bits(blocks: &[Block<f32>]) -> Vec<u32> {
    Block::flatten(blocks).iter().map(|x| x.to_bits()).collect()
}

#[test]
fn same_bits_as_every_level() {
    let input: Vec<Block<f32>> =
        (0..50).map(|i| Block(std::array::from_fn(|j| ((i * 16 + j) as f32).sin() * 100.0))).collect();
    let mut expected = input.clone();
    let count = work::<native::Float>(&input, &mut expected);
    assert!(count > 100);

    let check = |count_there: usize, output: &[Block<f32>], what: &str| {
        assert_eq!((count_there, bits(output)), (count, bits(&expected)), "{what}");
    };
    let mut output = input.clone();
    for level in Level::available() {
        check(at_level(level, &input, &mut output), &output, level.isa().name());
    }
    check(work::<native::Float4>(&input, &mut output), &output, "four lanes");
    check(work::<native::Float8>(&input, &mut output), &output, "eight lanes");
    check(work::<native::Float16>(&input, &mut output), &output, "sixteen lanes");
    check(work::<f32>(&input, &mut output), &output, "one lane");
}

/// The level is one that this CPU has, and the one that the compiler's flags say.
#[test]
fn level() {
    let isa = native::LEVEL.isa();
    assert_eq!(Level::new(isa), Some(native::LEVEL));
    assert_eq!(native::Float::LANES, isa.lanes());
    let expected = if cfg!(all(target_feature = "avx512f", target_feature = "avx512vl")) {
        Isa::Avx512
    } else if cfg!(all(target_feature = "avx2", target_feature = "fma")) {
        Isa::Avx2
    } else if cfg!(target_feature = "sse4.2") {
        Isa::Sse42
    } else if cfg!(target_feature = "sse2") {
        Isa::Sse2
    } else if cfg!(all(target_arch = "aarch64", target_feature = "neon")) {
        Isa::Neon
    } else if cfg!(all(target_arch = "powerpc64", target_endian = "little", feature = "vsx")) {
        Isa::Vsx
    } else if cfg!(all(target_arch = "wasm32", target_feature = "relaxed-simd")) {
        Isa::WasmRelaxed
    } else if cfg!(all(target_arch = "wasm32", target_feature = "simd128")) {
        Isa::Wasm
    } else {
        Isa::Scalar
    };
    assert_eq!(isa, expected);
    println!("compiled for {isa}");
}

/// They can be kept in structs and shared between threads.
#[test]
fn named() {
    #[derive(Clone, Copy, Debug)]
    struct Points {
        x: native::Float8,
        on: native::Bool8,
        id: native::Uint8,
    }
    fn is_thread_safe<T: Send + Sync + 'static>(_: &T) {}
    let points =
        Points { x: native::Float8::splat(1.5), on: native::Bool8::first_n(3), id: native::Int8::splat(-1).to_uint() };
    is_thread_safe(&points);
    assert_eq!(points.x.to_bits().reduce_max(), 1.5_f32.to_bits());
    assert_eq!((points.on.count(), points.id.lane(7)), (3, u32::MAX));
}
