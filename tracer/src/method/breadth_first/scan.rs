use simd::Level;
pub(super) fn exclusive_scan(_level: Level, values: &[u32], sums: &mut [u32]) -> u32 {
    let mut sum = 0;
    for (v, s) in values.iter().zip(sums) {
        *s = sum;
        sum += v;
    }
    sum
}
