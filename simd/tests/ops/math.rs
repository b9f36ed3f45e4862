//! Computed functions: the same bits everywhere as with one lane. How accurate they are is tested in `tests/math.rs`.

use simd::math;

operations! {
    exp(x: float) -> float { math::exp(x) } is { math::exp(x) }
    exp2(x: float) -> float { math::exp2(x) } is { math::exp2(x) }
    ln(x: float) -> float { math::ln(x) } is { math::ln(x) }
    log2(x: float) -> float { math::log2(x) } is { math::log2(x) }
    pow(x: float, y: float) -> float { math::pow(x, y) } is { math::pow(x, y) }
    cbrt(x: float) -> float { math::cbrt(x) } is { math::cbrt(x) }
    sin(x: float) -> float { math::sin_cos(x).0 } is { math::sin(x) }
    cos(x: float) -> float { math::sin_cos(x).1 } is { math::cos(x) }
    tan(x: float) -> float { math::tan(x) } is { math::tan(x) }
    asin(x: float) -> float { math::asin(x) } is { math::asin(x) }
    acos(x: float) -> float { math::acos(x) } is { math::acos(x) }
    atan(x: float) -> float { math::atan(x) } is { math::atan(x) }
    atan2(y: float, x: float) -> float { math::atan2(y, x) } is { math::atan2(y, x) }
}
