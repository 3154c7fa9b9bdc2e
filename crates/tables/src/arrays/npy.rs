//! Arrays of NumPy: the format NPY, versions 1 to 3 (numpy.lib.format, NEP 1).

use super::{Array, MOST_NUMBERS};
use crate::error::TableError;

/// How such a file begins.
pub(crate) const NPY_MAGIC: &[u8] = b"\x93NUMPY";
/// Longest header \[bytes\].
const LONGEST_HEADER: usize = 1 << 16;

/// Reads an array of numbers.
pub(crate) fn npy(bytes: &[u8], array: &str, file: &str) -> Result<Array, TableError> {
    let damaged = |what: &str| TableError::damaged("NumPy", what, file);
    let (header, data) = split(bytes).ok_or_else(|| damaged("its header is cut off"))?;
    let refuse = |what: String, next: &str| TableError::new("not-a-table", what, file, next);
    let kind = value(header, "descr").ok_or_else(|| damaged("no `descr` in its header"))?;
    if !kind.starts_with('\'') {
        let what = "the array has named parts (a structured dtype)".to_owned();
        return Err(refuse(
            what,
            "save each part as an array of its own, numpy.savez(FILE, q=array[\"q\"], ...)",
        ));
    }
    let kind = kind.trim_matches('\'');
    let is_fortran = value(header, "fortran_order").is_some_and(|word| word.starts_with("True"));
    let shape = shape(header).ok_or_else(|| damaged("no `shape` in its header"))?;
    let (order, letters) = kind.split_at(usize::from(kind.starts_with(['<', '>', '|', '='])));
    let Some((read, size)) = reader(letters) else {
        let what = format!("the array is of type `{kind}`, not of numbers");
        return Err(refuse(what, "save it as numbers, array.astype(float)"));
    };
    let count = shape
        .iter()
        .try_fold(1_usize, |all, &length| all.checked_mul(length));
    let count = count.filter(|count| *count <= MOST_NUMBERS);
    let count = count.ok_or_else(|| TableError::too_large(file))?;
    if data.len() / size < count {
        return Err(damaged("it has fewer numbers than its shape says"));
    }
    let mut word = [0; 8];
    let values: Vec<f64> = (data.chunks_exact(size).take(count))
        .map(|chunk| {
            let own = &mut word[..size];
            own.copy_from_slice(chunk);
            if order == ">" {
                own.reverse();
            }
            read(&word)
        })
        .collect();
    let shape = if shape.is_empty() { vec![1] } else { shape };
    let name = array.to_owned();
    Ok(match is_fortran {
        true => Array::from_first_axis_fastest(name, shape, &values),
        false => Array {
            name,
            shape,
            values,
        },
    })
}

/// The header's text and the data behind it.
fn split(bytes: &[u8]) -> Option<(&str, &[u8])> {
    let rest = bytes.strip_prefix(NPY_MAGIC)?;
    let (version, rest) = (rest.first()?, rest.get(2..)?);
    let (length, rest) = match version {
        1 => {
            let (length, rest) = rest.split_first_chunk()?;
            (usize::from(u16::from_le_bytes(*length)), rest)
        }
        2 | 3 => {
            let (length, rest) = rest.split_first_chunk()?;
            (usize::try_from(u32::from_le_bytes(*length)).ok()?, rest)
        }
        _ => return None,
    };
    if length > LONGEST_HEADER || length > rest.len() {
        return None;
    }
    let (header, data) = rest.split_at(length);
    Some((std::str::from_utf8(header).ok()?, data))
}

/// What follows a key of the header, to the next comma or the end.
fn value<'h>(header: &'h str, key: &str) -> Option<&'h str> {
    let (_, rest) = header.split_once(&format!("'{key}'"))?;
    let rest = rest.trim_start().strip_prefix(':')?.trim_start();
    Some(rest.split([',', '}']).next().unwrap_or(rest).trim())
}

fn shape(header: &str) -> Option<Vec<usize>> {
    let (_, rest) = header.split_once("'shape'")?;
    let (_, rest) = rest.split_once('(')?;
    let (inner, _) = rest.split_once(')')?;
    let words = inner
        .split(',')
        .map(str::trim)
        .filter(|word| !word.is_empty());
    words.map(|word| word.parse().ok()).collect()
}

/// A number from its bytes, lowest first, and how many they are.
type Read = fn(&[u8; 8]) -> f64;

fn reader(letters: &str) -> Option<(Read, usize)> {
    macro_rules! of {
        ($kind:ty) => {{
            const SIZE: usize = size_of::<$kind>();
            let read: Read = |word| {
                let mut own = [0; SIZE];
                own.copy_from_slice(&word[..SIZE]);
                <$kind>::from_le_bytes(own) as f64
            };
            (read, SIZE)
        }};
    }
    Some(match letters {
        "f8" => of!(f64),
        "f4" => of!(f32),
        "i8" => of!(i64),
        "i4" => of!(i32),
        "i2" => of!(i16),
        "i1" => of!(i8),
        "u8" => of!(u64),
        "u4" => of!(u32),
        "u2" => of!(u16),
        "u1" | "b1" => of!(u8),
        _ => return None,
    })
}
