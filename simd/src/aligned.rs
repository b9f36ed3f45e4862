//! A growable array aligned to a cache line.

use crate::Block;
use alloc::vec::Vec;
use std::fmt;
use std::marker::PhantomData;
use std::mem::{MaybeUninit, size_of};
use std::ops::{Deref, DerefMut};

/// Bytes of a cache line, and of the widest register.
const LINE: usize = 64;

/// The unit of allocation. Its bytes may be anything, also uninitialized.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Line([MaybeUninit<u8>; LINE]);

/// A `Vec` whose first element lies on a multiple of 64 bytes, so that no vector straddles two cache lines and the whole can be
/// seen as [`Block`]s. For types whose size divides 64 (checked when compiling).
///
/// ```
/// use simd::{AlignedVec, Block};
///
/// let mut numbers: AlignedVec<f32> = (0..20).map(|i| i as f32).collect();
/// assert!(numbers.as_ptr().addr().is_multiple_of(64));
/// assert_eq!(numbers[19], 19.0);
///
/// // Whole blocks, the last one filled up: loops over them have no remainder.
/// for block in numbers.padded_blocks(0.0) {
///     block.0.iter_mut().for_each(|x| *x += 1.0);
/// }
/// assert_eq!(numbers.len(), 20);
/// assert_eq!(numbers[19], 20.0);
/// ```
///
/// ```compile_fail
/// let v = simd::AlignedVec::<[f32; 3]>::new(); // 12 bytes
/// ```
pub struct AlignedVec<T> {
    /// Room for at least `len` elements.
    lines: Vec<Line>,
    /// So many elements are initialized.
    len: usize,
    elements: PhantomData<T>,
}

impl<T: Copy + 'static> AlignedVec<T> {
    /// Elements per line. As the size of a type is a multiple of its alignment, a line is aligned for `T` too.
    const PER_LINE: usize = {
        assert!(size_of::<T>() > 0 && LINE.is_multiple_of(size_of::<T>()), "the size of the elements must divide 64");
        LINE / size_of::<T>()
    };

    /// An empty one; it allocates nothing yet.
    #[must_use]
    pub const fn new() -> Self {
        const { assert!(Self::PER_LINE > 0) };
        Self { lines: Vec::new(), len: 0, elements: PhantomData }
    }

    /// An empty one with room for `capacity` elements.
    #[must_use]
    pub fn with_capacity(capacity: usize) -> Self {
        Self { lines: Vec::with_capacity(capacity.div_ceil(Self::PER_LINE)), ..Self::new() }
    }

    /// A copy of the slice.
    #[must_use]
    pub fn from_slice(slice: &[T]) -> Self {
        let mut v = Self::new();
        v.extend_from_slice(slice);
        v
    }

    /// Number of elements it can hold without allocating.
    #[must_use]
    pub fn capacity(&self) -> usize {
        self.lines.capacity() * Self::PER_LINE
    }

    /// Makes room for `additional` more elements.
    pub fn reserve(&mut self, additional: usize) {
        let len = self.len.checked_add(additional).expect("capacity overflow");
        self.lines.reserve(len.div_ceil(Self::PER_LINE).saturating_sub(self.lines.len()));
    }

    /// Makes `lines` long enough for `len` elements, which it does not initialize.
    fn grow(&mut self, len: usize) {
        let lines = len.div_ceil(Self::PER_LINE);
        if lines > self.lines.len() {
            self.lines.resize(lines, Line([MaybeUninit::uninit(); LINE]));
        }
    }

    /// All elements there is room for in `lines`, initialized or not.
    fn slots(&mut self) -> &mut [MaybeUninit<T>] {
        let count = self.lines.len() * Self::PER_LINE;
        // SAFETY: the lines are aligned for `T`, hold `PER_LINE` of them each without a gap, and any bytes will do for
        // `MaybeUninit`; the slice borrows `self`.
        unsafe { std::slice::from_raw_parts_mut(self.lines.as_mut_ptr().cast(), count) }
    }

    /// Appends an element.
    #[inline]
    pub fn push(&mut self, element: T) {
        let len = self.len;
        self.grow(len + 1);
        self.slots()[len].write(element);
        self.len = len + 1;
    }

    /// Removes the last element.
    pub fn pop(&mut self) -> Option<T> {
        let last = self.last().copied()?;
        self.len -= 1;
        Some(last)
    }

    /// Appends a copy of the slice.
    pub fn extend_from_slice(&mut self, slice: &[T]) {
        let (start, len) = (self.len, self.len + slice.len());
        self.grow(len);
        for (slot, &element) in self.slots()[start..len].iter_mut().zip(slice) {
            slot.write(element);
        }
        self.len = len;
    }

    /// Makes it `len` elements long: drops what is beyond, or appends copies of `element`.
    pub fn resize(&mut self, len: usize, element: T) {
        if len > self.len {
            let start = self.len;
            self.grow(len);
            self.slots()[start..len].fill(MaybeUninit::new(element));
        }
        self.len = len;
    }

    /// Drops the elements beyond the first `len`.
    pub fn truncate(&mut self, len: usize) {
        self.len = self.len.min(len);
    }

    /// Drops all elements; keeps the memory.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// The elements.
    #[must_use]
    #[inline]
    pub fn as_slice(&self) -> &[T] {
        // SAFETY: `lines` has room for `len` elements, aligned for `T` and without gaps, and so many are initialized.
        unsafe { std::slice::from_raw_parts(self.lines.as_ptr().cast(), self.len) }
    }

    /// The elements.
    #[must_use]
    #[inline]
    pub fn as_mut_slice(&mut self) -> &mut [T] {
        // SAFETY: as in `as_slice`; borrowed mutably.
        unsafe { std::slice::from_raw_parts_mut(self.lines.as_mut_ptr().cast(), self.len) }
    }

    /// The elements as blocks, if their number is a multiple of 16.
    #[must_use]
    pub fn as_blocks(&self) -> Option<&[Block<T>]> {
        Block::slice_of(self)
    }

    /// The elements as blocks, if their number is a multiple of 16.
    #[must_use]
    pub fn as_mut_blocks(&mut self) -> Option<&mut [Block<T>]> {
        Block::slice_of_mut(self)
    }

    /// The elements as blocks, the last block filled up with `padding`, which does not count as elements.
    pub fn padded_blocks(&mut self, padding: T) -> &mut [Block<T>] {
        let len = self.len;
        self.resize(len.next_multiple_of(16), padding);
        let padded = self.len;
        self.len = len;
        // SAFETY: `resize` has initialized so many elements; as in `as_mut_slice`.
        let elements = unsafe { std::slice::from_raw_parts_mut(self.lines.as_mut_ptr().cast(), padded) };
        Block::slice_of_mut(elements).expect("aligned, and a multiple of 16")
    }
}

impl<T: Copy + 'static> Default for AlignedVec<T> {
    fn default() -> Self {
        Self::new()
    }
}

impl<T: Copy + 'static> Clone for AlignedVec<T> {
    fn clone(&self) -> Self {
        Self::from_slice(self)
    }
}

impl<T: Copy + 'static> Deref for AlignedVec<T> {
    type Target = [T];
    #[inline]
    fn deref(&self) -> &[T] {
        self.as_slice()
    }
}

impl<T: Copy + 'static> DerefMut for AlignedVec<T> {
    #[inline]
    fn deref_mut(&mut self) -> &mut [T] {
        self.as_mut_slice()
    }
}

impl<T: Copy + fmt::Debug + 'static> fmt::Debug for AlignedVec<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.as_slice().fmt(f)
    }
}

impl<T: Copy + PartialEq + 'static> PartialEq for AlignedVec<T> {
    fn eq(&self, other: &Self) -> bool {
        self.as_slice() == other.as_slice()
    }
}
impl<T: Copy + Eq + 'static> Eq for AlignedVec<T> {}

impl<T: Copy + 'static> From<&[T]> for AlignedVec<T> {
    fn from(slice: &[T]) -> Self {
        Self::from_slice(slice)
    }
}

impl<T: Copy + 'static> Extend<T> for AlignedVec<T> {
    fn extend<I: IntoIterator<Item = T>>(&mut self, elements: I) {
        let elements = elements.into_iter();
        self.reserve(elements.size_hint().0);
        elements.for_each(|element| self.push(element));
    }
}

impl<T: Copy + 'static> FromIterator<T> for AlignedVec<T> {
    fn from_iter<I: IntoIterator<Item = T>>(elements: I) -> Self {
        let mut v = Self::new();
        v.extend(elements);
        v
    }
}

impl<'a, T: Copy + 'static> IntoIterator for &'a AlignedVec<T> {
    type Item = &'a T;
    type IntoIter = std::slice::Iter<'a, T>;
    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl<'a, T: Copy + 'static> IntoIterator for &'a mut AlignedVec<T> {
    type Item = &'a mut T;
    type IntoIter = std::slice::IterMut<'a, T>;
    fn into_iter(self) -> Self::IntoIter {
        self.iter_mut()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Random operations on it and on a `Vec`.
    #[test]
    fn behaves_as_a_vec() {
        let mut v = AlignedVec::<u32>::new();
        let mut model = Vec::new();
        let mut seed = 1_u32;
        for _ in 0..20_000 {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let n = (seed >> 8) as usize % 50;
            match seed >> 29 {
                0 | 1 => {
                    v.push(seed);
                    model.push(seed);
                }
                2 => assert_eq!(v.pop(), model.pop()),
                3 => {
                    v.extend(0..n as u32);
                    model.extend(0..n as u32);
                }
                4 => {
                    let slice = vec![seed; n];
                    v.extend_from_slice(&slice);
                    model.extend_from_slice(&slice);
                }
                5 => {
                    v.resize(n, seed);
                    model.resize(n, seed);
                }
                6 => {
                    let padded = v.padded_blocks(seed);
                    assert_eq!(padded.len(), model.len().div_ceil(16));
                    assert!(Block::flatten(padded)[model.len()..].iter().all(|&x| x == seed));
                    padded.iter_mut().flat_map(|block| &mut block.0).for_each(|x| *x ^= 1);
                    model.iter_mut().for_each(|x| *x ^= 1);
                }
                _ => {
                    v.truncate(n);
                    model.truncate(n);
                }
            }
            assert_eq!(*v, *model);
            assert!(v.as_ptr().addr().is_multiple_of(64) && v.capacity() >= v.len());
        }
        assert_eq!(v.clone(), v);
        assert_eq!(format!("{v:?}"), format!("{model:?}"));
        v.clear();
        assert!(v.is_empty() && v != AlignedVec::from_slice(&[1]));
    }

    #[test]
    fn other_sizes() {
        fn check<T: Copy + PartialEq + fmt::Debug + 'static>(elements: &[T]) {
            let mut v = AlignedVec::with_capacity(elements.len());
            let capacity = v.capacity();
            v.extend(elements.iter().copied());
            assert!(v.capacity() == capacity && v.as_ptr().addr().is_multiple_of(64));
            assert_eq!(*v, *elements);
            assert_eq!(v, AlignedVec::from(elements));
            assert!((&v).into_iter().zip(elements).all(|(a, b)| a == b));
        }
        check(&[(); 100].map(|()| 7_u8));
        check(&[(1_u8, 2_u16); 33]); // has a byte of padding
        check(&["text"; 9]);
        check(&[[1.5_f64; 4]; 5]);
        check(&[Block([3_i32; 16]); 3]);
    }

    #[test]
    fn mutable_access() {
        let mut v: AlignedVec<f32> = (0..32).map(|i| i as f32).collect();
        for x in &mut v {
            *x *= 2.0;
        }
        v[3] = -1.0;
        assert_eq!(v.as_blocks().unwrap()[0].0[..4], [0.0, 2.0, 4.0, -1.0]);
        v.as_mut_blocks().unwrap()[1].0[15] = 5.0;
        assert_eq!(v.last(), Some(&5.0));
        v.push(0.0);
        assert_eq!(v.as_blocks(), None);
        assert_eq!(v.as_mut_blocks(), None);
        assert_eq!(AlignedVec::<f32>::default().as_blocks(), Some(&[][..]));
    }
}
