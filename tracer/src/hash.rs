//! A hash of results, to see at a glance that they are the same bits.

/// FNV-1a, 64 bits, over 32-bit words.
pub fn fnv1a(words: impl IntoIterator<Item = u32>) -> u64 {
    words.into_iter().flat_map(u32::to_le_bytes).fold(START, step)
}

/// The same over bytes.
pub fn fnv1a_bytes(bytes: &[u8]) -> u64 {
    bytes.iter().copied().fold(START, step)
}

const START: u64 = 0xcbf2_9ce4_8422_2325;

fn step(hash: u64, byte: u8) -> u64 {
    (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3)
}

#[cfg(test)]
mod tests {
    #[test]
    fn known_values() {
        assert_eq!(super::fnv1a([]), 0xcbf2_9ce4_8422_2325);
        assert_eq!(super::fnv1a([u32::from_le_bytes(*b"foob")]), 0xdd12_0e79_0c25_12af);
    }
}
