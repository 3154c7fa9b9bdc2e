//! Rows as the format keeps them (section 2.1, the record format).

use super::{Broken, broken};

/// How a file keeps its text.
#[derive(Debug, Clone, Copy)]
pub(super) enum Encoding {
    Utf8,
    Utf16(fn([u8; 2]) -> u16),
}

/// A value of a row.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Value {
    Null,
    Integer(i64),
    Real(f64),
    Text(String),
    Blob(Vec<u8>),
}

/// Bytes of a row, as far as they are read.
#[derive(Debug)]
pub(super) struct Payload {
    pub(super) here: Vec<u8>,
    /// The page that it goes on in.
    pub(super) next: u32,
    /// Of the whole.
    pub(super) length: usize,
}

/// A row whose values are read when they are asked for.
#[derive(Debug)]
pub(crate) struct Record {
    pub(super) payload: Payload,
    pub(super) row_id: i64,
    /// Kind, first byte and length of each value.
    values: Vec<(u64, usize, usize)>,
}

impl Record {
    /// A row whose head of so many bytes is read.
    pub(super) fn new(payload: Payload, row_id: i64, head: usize) -> Result<Self, Broken> {
        let bytes = &payload.here[..head.min(payload.here.len())];
        let (_, mut at) = varint(bytes)?;
        let mut values = Vec::new();
        let mut start = head;
        while at < bytes.len() {
            let (kind, read) = varint(&bytes[at..])?;
            let Some(length) = length(kind.cast_unsigned()) else {
                return broken(format!("a value of kind {kind}"));
            };
            values.push((kind.cast_unsigned(), start, length));
            start = start.saturating_add(length);
            at += read;
        }
        Ok(Self {
            payload,
            row_id,
            values,
        })
    }

    /// Bytes up to the end of a value; none of a row that ends before.
    pub(super) fn end(&self, column: usize) -> Option<usize> {
        let (_, start, length) = self.values.get(column)?;
        Some(start.saturating_add(*length))
    }

    /// A value whose bytes are read.
    pub(super) fn value(&self, column: usize, encoding: Encoding) -> Result<Value, Broken> {
        let Some(&(kind, start, length)) = self.values.get(column) else {
            return Ok(Value::Null);
        };
        let bytes = self.payload.here.get(start..start + length);
        let Some(bytes) = bytes else {
            return broken("a row ends within a value");
        };
        Ok(match kind {
            0 => Value::Null,
            // a number of its own length, the first bit its sign
            1..=6 => {
                let sign = if bytes[0] >= 0x80 { -1 } else { 0 };
                let add = |sum: i64, byte: &u8| (sum << 8) | i64::from(*byte);
                Value::Integer(bytes.iter().fold(sign, add))
            }
            7 => {
                let add = |sum: u64, byte: &u8| (sum << 8) | u64::from(*byte);
                Value::Real(f64::from_bits(bytes.iter().fold(0, add)))
            }
            8 => Value::Integer(0),
            9 => Value::Integer(1),
            kind if kind.is_multiple_of(2) => Value::Blob(bytes.to_vec()),
            _ => Value::Text(encoding.text(bytes)?),
        })
    }
}

impl Encoding {
    fn text(self, bytes: &[u8]) -> Result<String, Broken> {
        let text = match self {
            Self::Utf8 => String::from_utf8(bytes.to_vec()).ok(),
            Self::Utf16(pair) => {
                let (pairs, _) = bytes.as_chunks::<2>();
                let units: Vec<u16> = pairs.iter().map(|own| pair(*own)).collect();
                String::from_utf16(&units).ok()
            }
        };
        text.map_or_else(|| broken("text in another encoding than the file's"), Ok)
    }
}

/// Bytes of a value of a kind; none of a kind that is kept for later.
fn length(kind: u64) -> Option<usize> {
    match kind {
        0 | 8 | 9 => Some(0),
        1..=4 => Some(kind as usize),
        5 => Some(6),
        6 | 7 => Some(8),
        10 | 11 => None,
        _ => usize::try_from((kind - 12) / 2).ok(),
    }
}

/// A number of one to nine bytes, seven bits in each and eight in the ninth, and how many there are.
pub(super) fn varint(bytes: &[u8]) -> Result<(i64, usize), Broken> {
    let mut value = 0_u64;
    for (at, byte) in bytes.iter().take(9).enumerate() {
        if at == 8 {
            value = (value << 8) | u64::from(*byte);
            return Ok((value.cast_signed(), 9));
        }
        value = (value << 7) | u64::from(byte & 0x7f);
        if byte & 0x80 == 0 {
            return Ok((value.cast_signed(), at + 1));
        }
    }
    broken("a number reaches beyond its page")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_any_length_are_read() {
        assert_eq!(varint(&[0x05, 9]), Ok((5, 1)));
        assert_eq!(varint(&[0x81, 0x00]), Ok((128, 2)));
        assert_eq!(varint(&[0xff; 9]), Ok((-1, 9)));
        assert!(varint(&[0x81]).is_err());
    }

    #[test]
    fn values_are_those_of_their_kinds() {
        // head of 8 bytes: one byte, three bytes, a float, 1, text of 2, a blob of 1, nothing
        let mut here = vec![8, 1, 3, 7, 9, 17, 14, 0];
        here.extend([0xfe, 0xff, 0x00, 0x00]);
        here.extend(1.5_f64.to_be_bytes());
        here.extend(b"ab\x07");
        let payload = Payload {
            length: here.len(),
            here,
            next: 0,
        };
        let record = Record::new(payload, 4, 8).unwrap();
        let wanted = [
            Value::Integer(-2),
            Value::Integer(-65_536),
            Value::Real(1.5),
            Value::Integer(1),
            Value::Text("ab".to_owned()),
            Value::Blob(vec![7]),
            Value::Null,
            Value::Null,
        ];
        for (column, wanted) in wanted.into_iter().enumerate() {
            assert_eq!(record.value(column, Encoding::Utf8), Ok(wanted));
        }
    }
}
