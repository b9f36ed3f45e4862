//! What the radix sort moves: a key and the value that goes with it, together.

/// Digits have eight bits. With eleven or twelve a pass less is needed, but so many lines of memory are written to in turn that it takes
/// longer than those of eight bits together.
pub(super) const DIGITS: usize = 256;

/// Where the records of each digit start, from how many there are.
pub(super) fn starts(counts: &[u32; DIGITS]) -> [u32; DIGITS] {
    let (mut starts, mut sum) = ([0; DIGITS], 0);
    for (start, count) in starts.iter_mut().zip(counts) {
        (*start, sum) = (sum, sum + count);
    }
    starts
}

/// A key and a value.
pub(super) trait Record: Copy + Default + Send + Sync {
    /// The key.
    type Key: Copy + Send + Sync + Into<u64>;

    /// Of these.
    fn new(key: Self::Key, value: u32) -> Self;

    /// The key.
    fn key(self) -> Self::Key;

    /// The value.
    fn value(self) -> u32;

    /// A byte of the key, the lowest being number 0. (That it is known when compiling takes half the time: the byte is read from where the record
    /// lies, which needs no register.)
    fn digit<const BYTE: usize>(self) -> usize;
}

/// A key of 32 bits above its value: half as many lines of memory are written to at once as with two arrays.
impl Record for u64 {
    type Key = u32;

    #[inline(always)]
    fn new(key: u32, value: u32) -> Self {
        Self::from(key) << 32 | Self::from(value)
    }

    #[inline(always)]
    fn key(self) -> u32 {
        (self >> 32) as u32
    }

    #[inline(always)]
    fn value(self) -> u32 {
        self as u32
    }

    #[inline(always)]
    fn digit<const BYTE: usize>(self) -> usize {
        (self >> (32 + 8 * (BYTE % 4))) as usize % DIGITS
    }
}

/// A key of 64 bits and its value.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Long {
    key: u64,
    value: u32,
}

impl Record for Long {
    type Key = u64;

    #[inline(always)]
    fn new(key: u64, value: u32) -> Self {
        Self { key, value }
    }

    #[inline(always)]
    fn key(self) -> u64 {
        self.key
    }

    #[inline(always)]
    fn value(self) -> u32 {
        self.value
    }

    #[inline(always)]
    fn digit<const BYTE: usize>(self) -> usize {
        (self.key >> (8 * BYTE)) as usize % DIGITS
    }
}
