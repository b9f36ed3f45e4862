//! Where records come from: an array of them, or the caller's two.

use super::record::Record;
use std::ops::Range;

/// Records that are moved together: all their digits are known before the first of them is written, which does not wait for it then.
pub(super) const GROUP: usize = 8;

/// Records in order.
pub(super) trait Source<R: Record>: Sync {
    /// Their number.
    fn len(&self) -> usize;

    /// The keys of a range.
    fn keys(&self, range: Range<usize>) -> impl Iterator<Item = R::Key>;

    /// Those of a range, as many groups as it has.
    fn groups(&self, range: Range<usize>) -> impl Iterator<Item = impl Group<R>>;

    /// Those of the range that are behind its groups.
    fn rest(&self, range: Range<usize>) -> impl Iterator<Item = R>;
}

/// [`GROUP`] records where they lie, to be read once for their digits and once to be moved: registers do not hold them all.
pub(super) trait Group<R: Record> {
    /// One of them.
    fn get(&self, i: usize) -> R;
}

impl<R: Record> Source<R> for [R] {
    fn len(&self) -> usize {
        self.len()
    }

    #[inline(always)]
    fn keys(&self, range: Range<usize>) -> impl Iterator<Item = R::Key> {
        self[range].iter().map(|record| record.key())
    }

    #[inline(always)]
    fn groups(&self, range: Range<usize>) -> impl Iterator<Item = impl Group<R>> {
        self[range].as_chunks::<GROUP>().0.iter()
    }

    #[inline(always)]
    fn rest(&self, range: Range<usize>) -> impl Iterator<Item = R> {
        self[range].as_chunks::<GROUP>().1.iter().copied()
    }
}

impl<R: Record> Group<R> for &[R; GROUP] {
    #[inline(always)]
    fn get(&self, i: usize) -> R {
        self[i]
    }
}

/// Keys and their values: where records come from, and where they go to.
pub(super) struct Arrays<'a, R: Record> {
    pub(super) keys: &'a mut [R::Key],
    pub(super) values: &'a mut [u32],
}

impl<R: Record> Arrays<'_, R> {
    pub(super) fn split_at(self, at: usize) -> (Self, Self) {
        let (keys, more_keys) = self.keys.split_at_mut(at);
        let (values, more_values) = self.values.split_at_mut(at);
        (Self { keys, values }, Self { keys: more_keys, values: more_values })
    }

    pub(super) fn fill(self, records: &[R]) {
        for ((record, key), value) in records.iter().zip(self.keys).zip(self.values) {
            (*key, *value) = (record.key(), record.value());
        }
    }
}

impl<R: Record> Source<R> for Arrays<'_, R> {
    fn len(&self) -> usize {
        self.keys.len()
    }

    #[inline(always)]
    fn keys(&self, range: Range<usize>) -> impl Iterator<Item = R::Key> {
        self.keys[range].iter().copied()
    }

    #[inline(always)]
    fn groups(&self, range: Range<usize>) -> impl Iterator<Item = impl Group<R>> {
        let keys = self.keys[range.clone()].as_chunks::<GROUP>().0;
        keys.iter().zip(self.values[range].as_chunks::<GROUP>().0)
    }

    #[inline(always)]
    fn rest(&self, range: Range<usize>) -> impl Iterator<Item = R> {
        let keys = self.keys[range.clone()].as_chunks::<GROUP>().1;
        let values = self.values[range].as_chunks::<GROUP>().1;
        keys.iter().zip(values).map(|(&key, &value)| R::new(key, value))
    }
}

impl<R: Record> Group<R> for (&[R::Key; GROUP], &[u32; GROUP]) {
    #[inline(always)]
    fn get(&self, i: usize) -> R {
        R::new(self.0[i], self.1[i])
    }
}
