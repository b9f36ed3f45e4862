//! Numbers in buffers.

use super::buffers::Buffers;
use gltf::Accessor;
use gltf::accessor::{DataType, Dimensions, sparse};
use gltf::buffer::View;
use std::cmp::Ordering;

/// The elements of an accessor, all of which are there.
pub(super) struct Values<'a> {
    base: Option<Table<'a>>,
    /// Elements that differ from it.
    sparse: Option<Sparse<'a>>,
    len: usize,
    data: DataType,
    normalized: bool,
}

/// Elements at equal distances.
struct Table<'a> {
    bytes: &'a [u8],
    stride: usize,
}

impl<'a> Table<'a> {
    /// `len` elements of `size` bytes, from `offset` on in a view; all of them lie within it.
    fn new(buffers: &'a Buffers, view: &View<'_>, offset: usize, len: usize, size: usize) -> Result<Self, String> {
        let stride = view.stride().unwrap_or(size);
        let bytes = buffers.view(view)?;
        let needed =
            len.saturating_sub(1).checked_mul(stride).and_then(|n| n.checked_add(if len == 0 { 0 } else { size }));
        match bytes.get(offset..) {
            Some(bytes) if needed.is_some_and(|n| n <= bytes.len()) => Ok(Self { bytes, stride }),
            _ => Err(format!("{len} elements of {size} bytes do not fit into buffer view {}", view.index())),
        }
    }

    fn element(&self, i: usize) -> &'a [u8] {
        &self.bytes[i * self.stride..]
    }
}

/// Which elements differ, in rising order, and how.
struct Sparse<'a> {
    indices: Table<'a>,
    index_type: DataType,
    values: Table<'a>,
    len: usize,
}

impl<'a> Sparse<'a> {
    fn index(&self, place: usize) -> usize {
        whole(self.indices.element(place), self.index_type) as usize
    }

    /// Element `i`, if it is one of them: by halving, as many accessors may share them.
    fn element(&self, i: usize) -> Option<&'a [u8]> {
        let (mut first, mut end) = (0, self.len);
        while first < end {
            let middle = first.midpoint(end);
            match self.index(middle).cmp(&i) {
                Ordering::Equal => return Some(self.values.element(middle)),
                Ordering::Less => first = middle + 1,
                Ordering::Greater => end = middle,
            }
        }
        None
    }
}

impl<'a> Values<'a> {
    /// Those of an accessor that has `dimensions`.
    pub(super) fn new(buffers: &'a Buffers, accessor: &Accessor<'_>, dimensions: Dimensions) -> Result<Self, String> {
        Self::checked(buffers, accessor, dimensions).map_err(|e| format!("accessor {}: {e}", accessor.index()))
    }

    fn checked(buffers: &'a Buffers, accessor: &Accessor<'_>, dimensions: Dimensions) -> Result<Self, String> {
        if accessor.dimensions() != dimensions {
            return Err(format!("its elements are {:?}, expected {dimensions:?}", accessor.dimensions()));
        }
        let (len, data) = (accessor.count(), accessor.data_type());
        let size = dimensions.multiplicity() * data.size();
        let table = |view: &View<'_>, offset, len| Table::new(buffers, view, offset, len, size);
        let base = accessor.view().map(|view| table(&view, accessor.offset(), len)).transpose()?;
        // All zero but for what is sparse: in proportion to the file all the same.
        if base.is_none() && len > buffers.len() {
            return Err(format!("it has {len} elements, but no bytes"));
        }
        let sparse = accessor.sparse().map(|sparse| {
            let values = table(&sparse.values().view(), sparse.values().offset(), sparse.count())?;
            differing(buffers, &sparse, values, len)
        });
        Ok(Self { base, sparse: sparse.transpose()?, len, data, normalized: accessor.normalized() })
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Whether they are whole numbers without sign, which alone may be indices.
    pub(super) fn are_indices(&self) -> bool {
        matches!(self.data, DataType::U8 | DataType::U16 | DataType::U32) && !self.normalized
    }

    /// An element of `N` numbers, or the first `N` of it.
    pub(super) fn get<const N: usize>(&self, i: usize) -> [f32; N] {
        let bytes = self.bytes(i);
        std::array::from_fn(|k| bytes.map_or(0.0, |bytes| self.number(&bytes[k * self.data.size()..])))
    }

    /// An element that is an index.
    pub(super) fn index(&self, i: usize) -> u32 {
        self.bytes(i).map_or(0, |bytes| whole(bytes, self.data))
    }

    fn bytes(&self, i: usize) -> Option<&'a [u8]> {
        let sparse = self.sparse.as_ref().and_then(|sparse| sparse.element(i));
        sparse.or_else(|| self.base.as_ref().map(|base| base.element(i)))
    }

    /// Whole numbers of `n` bits that are normalized are divided by the largest one.
    fn number(&self, bytes: &[u8]) -> f32 {
        let word = [bytes[0], bytes.get(1).copied().unwrap_or(0)];
        let (number, largest) = match self.data {
            DataType::F32 => return f32::from_bits(whole(bytes, DataType::U32)),
            DataType::I8 => (f32::from(bytes[0] as i8), 127.0),
            DataType::U8 => (f32::from(bytes[0]), 255.0),
            DataType::I16 => (f32::from(i16::from_le_bytes(word)), 32_767.0),
            DataType::U16 => (f32::from(u16::from_le_bytes(word)), 65_535.0),
            DataType::U32 => (whole(bytes, DataType::U32) as f32, 4_294_967_295.0),
        };
        if self.normalized { (number / largest).max(-1.0) } else { number }
    }
}

/// A whole number without sign.
fn whole(bytes: &[u8], data: DataType) -> u32 {
    let n = data.size().min(4);
    (0..n).fold(0, |sum, i| sum | u32::from(bytes[i]) << (8 * i))
}

/// The elements of an accessor of `len` that differ, with these values.
fn differing<'a>(
    buffers: &'a Buffers,
    sparse: &sparse::Sparse<'_>,
    values: Table<'a>,
    len: usize,
) -> Result<Sparse<'a>, String> {
    let indices = sparse.indices();
    let index_type = match indices.index_type() {
        sparse::IndexType::U8 => DataType::U8,
        sparse::IndexType::U16 => DataType::U16,
        sparse::IndexType::U32 => DataType::U32,
    };
    let table = Table::new(buffers, &indices.view(), indices.offset(), sparse.count(), index_type.size())?;
    let sparse = Sparse { indices: table, index_type, values, len: sparse.count() };
    let mut least = 0;
    for place in 0..sparse.len {
        let index = sparse.index(place);
        if !(least..len).contains(&index) {
            return Err(format!("sparse element {index} of {len}: they have to be there, and in rising order"));
        }
        least = index + 1;
    }
    Ok(sparse)
}
