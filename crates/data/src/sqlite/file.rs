//! Pages of a file, one at a time.

use std::io::{Read, Seek, SeekFrom};
use std::rc::Rc;

use super::{Broken, broken};

/// The file's first 16 bytes.
const MAGIC: &[u8] = b"SQLite format 3\0";
/// Bytes of the file's head (section 1.3).
const HEAD: usize = 100;
/// A page keeps at least so many bytes beside what is reserved.
const LEAST_USABLE: usize = 480;

#[derive(Debug)]
pub(super) struct Pages<R> {
    reader: R,
    head: [u8; HEAD],
    size: usize,
    /// Bytes at the end of each page that are not the format's.
    reserved: usize,
    pub(super) count: u32,
    /// The last page that was read, with its number.
    last: Option<(u32, Page)>,
}

/// Bytes of a page.
#[derive(Debug, Clone)]
pub(super) struct Page(Rc<Vec<u8>>);

impl<R: Read + Seek> Pages<R> {
    pub(super) fn open(mut reader: R) -> Result<Self, Broken> {
        let length = reader.seek(SeekFrom::End(0))?;
        reader.seek(SeekFrom::Start(0))?;
        let mut head = [0; HEAD];
        if reader.read_exact(&mut head).is_err() || !head.starts_with(MAGIC) {
            return broken("the file has no head");
        }
        let size = match u16::from_be_bytes([head[16], head[17]]) {
            1 => 1 << 16,
            size => usize::from(size),
        };
        let reserved = usize::from(head[20]);
        if !size.is_power_of_two() || size < 512 || size - reserved < LEAST_USABLE {
            return broken(format!("pages of {size} bytes"));
        }
        let four =
            |at: usize| u32::from_be_bytes([head[at], head[at + 1], head[at + 2], head[at + 3]]);
        let whole = u32::try_from(length / size as u64).unwrap_or(u32::MAX);
        // an old writer leaves the number of pages as it was, and says so
        let stated = if four(24) == four(92) { four(28) } else { 0 };
        if stated > whole {
            return broken(format!("the file ends after {whole} of {stated} pages"));
        }
        Ok(Self {
            count: if stated > 0 { stated } else { whole },
            reader,
            head,
            size,
            reserved,
            last: None,
        })
    }

    /// Four bytes of the head as a number.
    pub(super) fn head(&self, at: usize) -> Result<u32, Broken> {
        let bytes = self
            .head
            .get(at..at + 4)
            .and_then(|own| own.try_into().ok());
        bytes.map_or_else(
            || broken("the file has no head"),
            |own| Ok(u32::from_be_bytes(own)),
        )
    }

    /// Bytes of a page that the format uses.
    pub(super) fn usable(&self) -> usize {
        self.size - self.reserved
    }

    /// Bytes of a payload that its first page keeps (section 1.6).
    pub(super) fn local(&self, length: usize) -> usize {
        let usable = self.usable();
        let most = usable - 35;
        if length <= most {
            return length;
        }
        let least = (usable - 12) * 32 / 255 - 23;
        let filled = least + (length - least) % (usable - 4);
        if filled <= most { filled } else { least }
    }

    pub(super) fn read(&mut self, number: u32) -> Result<Page, Broken> {
        if let Some((_, page)) = self.last.as_ref().filter(|own| own.0 == number) {
            return Ok(page.clone());
        }
        if number == 0 || number > self.count {
            return broken(format!("page {number} of {}", self.count));
        }
        let start = u64::from(number - 1) * self.size as u64;
        let mut bytes = vec![0; self.size];
        self.reader.seek(SeekFrom::Start(start))?;
        self.reader.read_exact(&mut bytes)?;
        bytes.truncate(self.usable());
        let page = Page(Rc::new(bytes));
        self.last = Some((number, page.clone()));
        Ok(page)
    }
}

impl Page {
    pub(super) fn slice(&self, from: usize, length: usize) -> Result<&[u8], Broken> {
        let end = from.saturating_add(length);
        self.0
            .get(from..end)
            .map_or_else(|| broken("a value reaches beyond its page"), Ok)
    }

    /// All that follows.
    pub(super) fn from(&self, from: usize) -> Result<&[u8], Broken> {
        self.slice(from, self.0.len().saturating_sub(from))
    }

    pub(super) fn byte(&self, at: usize) -> Result<u8, Broken> {
        Ok(self.slice(at, 1)?[0])
    }

    pub(super) fn u16(&self, at: usize) -> Result<u16, Broken> {
        let own = self.slice(at, 2)?;
        Ok(u16::from_be_bytes([own[0], own[1]]))
    }

    pub(super) fn u32(&self, at: usize) -> Result<u32, Broken> {
        let own = self.slice(at, 4)?;
        Ok(u32::from_be_bytes([own[0], own[1], own[2], own[3]]))
    }
}
