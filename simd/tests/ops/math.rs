//! Computed functions: the same bits everywhere as with one lane. How accurate they are is tested in `tests/math.rs`.

use simd::math;

operations! {
    exp2(x: float) -> float { math::exp2(x) } is { math::exp2(x) }
    log2(x: float) -> float { math::log2(x) } is { math::log2(x) }
    pow(x: float, y: float) -> float { math::pow(x, y) } is { math::pow(x, y) }
}
