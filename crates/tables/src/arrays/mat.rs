//! Arrays of MATLAB: MAT-files of level 5, as versions 5 to 7 write them (MathWorks, "MAT-File Format", chapter 1).
//!
//! Numbers are read, also within structures of one element (`data.q`). Cells, texts, objects, sparse and complex arrays are left out
//! with a note. Version 7.3 is HDF5 and is not read.

use std::io::Cursor;

use flate2::read::ZlibDecoder;

use super::{Array, MOST_NUMBERS};
use crate::error::TableError;
use crate::read::inflated;

/// How such a file begins.
pub(crate) const MAT_MAGIC: &[u8] = b"MATLAB 5.0";
/// The text and the two words before the first element \[bytes\].
const HEADER_BYTES: usize = 128;
/// Kinds of elements (table 1-1 of the format).
const INT8: u32 = 1;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Classes of arrays (table 1-3).
const STRUCTURE: u32 = 2;
const DOUBLE: u32 = 6;
const UINT64: u32 = 15;
/// Bit of the flags that says that there is an imaginary part.
const IS_COMPLEX: u32 = 0x0800;
/// Structures within structures that are followed.
const DEEPEST: usize = 8;

/// What a file holds.
pub(crate) struct Found {
    pub(crate) arrays: Vec<Array>,
    pub(crate) notes: Vec<String>,
}

/// Reads the arrays of numbers.
pub(crate) fn mat(bytes: &[u8], file: &str) -> Result<Found, TableError> {
    let damaged = |what: &str| TableError::damaged("MATLAB", what, file);
    let mut reader = Reader {
        is_big: match bytes.get(126..HEADER_BYTES) {
            Some(b"IM") => false,
            Some(b"MI") => true,
            _ => return Err(damaged("its header is cut off")),
        },
        arrays: Vec::new(),
        left_out: Vec::new(),
        count: 0,
    };
    let mut rest = &bytes[HEADER_BYTES..];
    while !rest.is_empty() {
        let element = reader
            .element(rest)
            .ok_or_else(|| damaged("an element is cut off"))?;
        rest = element.rest;
        if element.kind == COMPRESSED {
            let content = inflated(ZlibDecoder::new(Cursor::new(element.data)), "MATLAB", file)?;
            let inner = reader.element(&content);
            let inner = inner.ok_or_else(|| damaged("a compressed element is cut off"))?;
            if inner.kind == MATRIX {
                let read = reader.matrix(inner.data, None, 0);
                read.ok_or_else(|| reader.unread(file))?;
            }
        } else if element.kind == MATRIX {
            let read = reader.matrix(element.data, None, 0);
            read.ok_or_else(|| reader.unread(file))?;
        }
    }
    let notes = match reader.left_out.is_empty() {
        true => Vec::new(),
        false => vec![format!(
            "{file}: left out, they are no arrays of real numbers: {}",
            reader.left_out.join(", ")
        )],
    };
    Ok(Found {
        arrays: reader.arrays,
        notes,
    })
}

struct Reader {
    is_big: bool,
    arrays: Vec<Array>,
    left_out: Vec<String>,
    /// Numbers so far, or that the next array would bring.
    count: usize,
}

/// An element: its kind, its bytes, and what follows it.
struct Element<'b> {
    kind: u32,
    data: &'b [u8],
    rest: &'b [u8],
}

impl Reader {
    /// Why an array was not read.
    fn unread(&self, file: &str) -> TableError {
        match self.count > MOST_NUMBERS {
            true => TableError::too_large(file),
            false => TableError::damaged("MATLAB", "an array is cut off", file),
        }
    }

    fn word(&self, bytes: &[u8]) -> Option<u32> {
        let word = *bytes.first_chunk()?;
        Some(match self.is_big {
            true => u32::from_be_bytes(word),
            false => u32::from_le_bytes(word),
        })
    }

    fn element<'b>(&self, bytes: &'b [u8]) -> Option<Element<'b>> {
        let tag = self.word(bytes)?;
        // a small element has its length in the tag's upper half, and its data in the same eight bytes
        let small = tag >> 16;
        if small != 0 {
            let data = bytes.get(4..8)?.get(..usize::try_from(small).ok()?)?;
            return Some(Element {
                kind: tag & 0xffff,
                data,
                rest: bytes.get(8..)?,
            });
        }
        let length = usize::try_from(self.word(bytes.get(4..)?)?).ok()?;
        let end = length.checked_add(8)?;
        let data = bytes.get(8..end)?;
        // elements begin at multiples of eight bytes, but for compressed ones
        let next = if tag == COMPRESSED {
            end
        } else {
            end.checked_next_multiple_of(8)?
        };
        Some(Element {
            kind: tag,
            data,
            rest: bytes.get(next..).unwrap_or_default(),
        })
    }

    /// Adds an array; its own name, or that of the field that it is. None where it is cut off or too large.
    fn matrix(&mut self, bytes: &[u8], field: Option<&str>, depth: usize) -> Option<()> {
        if bytes.is_empty() {
            // an empty field
            return Some(());
        }
        let flags = self.element(bytes)?;
        if flags.kind != UINT32 {
            return None;
        }
        let word = self.word(flags.data)?;
        let shape = self.element(flags.rest)?;
        let class = word & 0xff;
        let name = self.element(shape.rest)?;
        if shape.kind != INT32 || name.kind != INT8 {
            // objects have other parts
            self.left_out.push(field.unwrap_or("an object").to_owned());
            return Some(());
        }
        let own = String::from_utf8_lossy(name.data).into_owned();
        let own = field.map_or(own, str::to_owned);
        let sizes = shape
            .data
            .chunks_exact(4)
            .map(|chunk| usize::try_from(self.word(chunk)?).ok());
        let sizes: Vec<usize> = sizes.collect::<Option<_>>()?;
        let count = sizes
            .iter()
            .try_fold(1_usize, |all, &size| all.checked_mul(size))?;
        if class == STRUCTURE && count == 1 && depth < DEEPEST {
            return self.structure(name.rest, &own, depth);
        }
        let is_numbers = (DOUBLE..=UINT64).contains(&class) && word & IS_COMPLEX == 0;
        if !is_numbers || sizes.len() < 2 {
            self.left_out.push(own);
            return Some(());
        }
        self.count = self.count.saturating_add(count);
        if self.count > MOST_NUMBERS {
            return None;
        }
        let real = self.element(name.rest)?;
        let values = self.numbers(&real)?;
        if values.len() != count {
            return None;
        }
        // a row, 1 x n, is meant as a column
        let sizes = match sizes[..] {
            [1, length] => vec![length],
            _ => sizes,
        };
        self.arrays
            .push(Array::from_first_axis_fastest(own, sizes, &values));
        Some(())
    }

    /// The fields of a structure of one element.
    fn structure(&mut self, bytes: &[u8], own: &str, depth: usize) -> Option<()> {
        let length = self.element(bytes)?;
        let names = self.element(length.rest)?;
        let length = usize::try_from(self.word(length.data)?).ok()?;
        let mut rest = names.rest;
        if length == 0 {
            return Some(());
        }
        for name in names.data.chunks_exact(length) {
            let name = name.split(|&byte| byte == 0).next().unwrap_or_default();
            let name = format!("{own}.{}", String::from_utf8_lossy(name));
            let field = self.element(rest)?;
            rest = field.rest;
            self.matrix(field.data, Some(&name), depth + 1)?;
        }
        Some(())
    }

    /// Numbers of any kind that an array is kept in.
    fn numbers(&self, element: &Element<'_>) -> Option<Vec<f64>> {
        let is_big = self.is_big;
        macro_rules! of {
            ($kind:ty) => {{
                const SIZE: usize = size_of::<$kind>();
                let chunks = element.data.chunks_exact(SIZE).map(|chunk| {
                    let mut own = [0; SIZE];
                    own.copy_from_slice(chunk);
                    let number = if is_big {
                        <$kind>::from_be_bytes(own)
                    } else {
                        <$kind>::from_le_bytes(own)
                    };
                    number as f64
                });
                chunks.collect()
            }};
        }
        Some(match element.kind {
            INT8 => of!(i8),
            2 => of!(u8),
            3 => of!(i16),
            4 => of!(u16),
            INT32 => of!(i32),
            UINT32 => of!(u32),
            7 => of!(f32),
            9 => of!(f64),
            12 => of!(i64),
            13 => of!(u64),
            _ => return None,
        })
    }
}
