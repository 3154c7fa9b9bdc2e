//! Tables of an SQLite file, read page by page: no queries, and nothing of the file is run.
//!
//! SQLite, *Database File Format* (sqlite.org/fileformat2.html): sections in the docs are those of that page.

mod file;
mod record;
mod schema;

use std::io::{Read, Seek};

use self::file::Pages;
use self::record::{Encoding, Payload, varint};
use self::schema::columns;

pub(crate) use self::record::{Record, Value};

/// What does not hold together, in words.
#[derive(Debug, PartialEq)]
pub(crate) struct Broken(pub(crate) String);

impl From<std::io::Error> for Broken {
    fn from(error: std::io::Error) -> Self {
        Self(error.to_string())
    }
}

fn broken<T>(what: impl Into<String>) -> Result<T, Broken> {
    Err(Broken(what.into()))
}

/// A database.
#[derive(Debug)]
pub(crate) struct Database<R> {
    pages: Pages<R>,
    encoding: Encoding,
    /// Payloads that are larger are refused.
    most_bytes: usize,
}

/// A table with a number for each row.
#[derive(Debug, PartialEq)]
pub(crate) struct Table {
    /// Page at which its tree begins.
    root: u32,
    columns: Vec<String>,
    /// The column that is the row's number: its records hold nothing there.
    row_id: Option<usize>,
}

/// Where a row is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cell {
    page: u32,
    offset: u16,
}

/// Levels of a tree at most: with two cells a page more would be beyond the largest file.
const MOST_LEVELS: usize = 40;

impl<R: Read + Seek> Database<R> {
    /// Opens a file; rows of more bytes than `most_bytes` are refused.
    pub(crate) fn open(reader: R, most_bytes: usize) -> Result<Self, Broken> {
        let pages = Pages::open(reader)?;
        let encoding = match pages.head(56)? {
            0 | 1 => Encoding::Utf8,
            2 => Encoding::Utf16(u16::from_le_bytes),
            3 => Encoding::Utf16(u16::from_be_bytes),
            other => return broken(format!("its text has the encoding {other}, which is none")),
        };
        Ok(Self {
            pages,
            encoding,
            most_bytes,
        })
    }

    /// A table by its name; none where there is none (section 2.6, the schema table).
    pub(crate) fn table(&mut self, name: &str) -> Result<Option<Table>, Broken> {
        let schema = Table {
            root: 1,
            columns: Vec::new(),
            row_id: None,
        };
        for cell in self.rows(&schema)? {
            let mut row = self.record(cell)?;
            let mut text = |column| match self.value(&mut row, column)? {
                Value::Text(text) => Ok(Some(text)),
                _ => Ok::<_, Broken>(None),
            };
            if text(0)?.as_deref() != Some("table") || text(1)?.as_deref() != Some(name) {
                continue;
            }
            let sql = text(4)?.unwrap_or_default();
            let root = match self.value(&mut row, 3)? {
                Value::Integer(root) => u32::try_from(root).ok(),
                _ => None,
            };
            return match (root, columns(&sql)) {
                (Some(root), Some((columns, row_id))) => Ok(Some(Table {
                    root,
                    columns,
                    row_id,
                })),
                _ => broken(format!("the table `{name}` is not described")),
            };
        }
        Ok(None)
    }

    /// Where the rows of a table are, by their numbers (section 1.6, B-tree pages).
    pub(crate) fn rows(&mut self, table: &Table) -> Result<Vec<Cell>, Broken> {
        let mut found = Vec::new();
        // pages that are still to be read, the next one last
        let mut pages = vec![(table.root, 0)];
        let mut read = 0;
        while let Some((number, level)) = pages.pop() {
            read += 1;
            if level > MOST_LEVELS || read > self.pages.count {
                return broken("pages of a table lead back to each other");
            }
            let page = self.pages.read(number)?;
            let head = if number == 1 { 100 } else { 0 };
            let kind = page.byte(head)?;
            let cells = usize::from(page.u16(head + 3)?);
            let pointers = head + if kind == INTERIOR { 12 } else { 8 };
            let offsets = (0..cells).map(|cell| page.u16(pointers + 2 * cell));
            match kind {
                LEAF => {
                    for offset in offsets {
                        let offset = offset?;
                        found.push(Cell {
                            page: number,
                            offset,
                        });
                    }
                }
                INTERIOR => {
                    pages.push((page.u32(head + 8)?, level + 1));
                    let children = offsets.map(|offset| page.u32(usize::from(offset?)));
                    let children: Vec<u32> = children.collect::<Result<_, Broken>>()?;
                    pages.extend(children.into_iter().rev().map(|own| (own, level + 1)));
                }
                other => {
                    return broken(format!("page {number} is of kind {other}, and no table's"));
                }
            }
        }
        Ok(found)
    }

    /// A row.
    pub(crate) fn record(&mut self, cell: Cell) -> Result<Record, Broken> {
        let Cell { page, offset } = cell;
        let bytes = self.pages.read(page)?;
        let at = usize::from(offset);
        let (length, first) = varint(bytes.from(at)?)?;
        let (row_id, second) = varint(bytes.from(at + first)?)?;
        let length = usize::try_from(length).unwrap_or(usize::MAX);
        if length > self.most_bytes {
            return broken(format!("a row of {length} bytes"));
        }
        let local = self.pages.local(length);
        let start = at + first + second;
        let here = bytes.slice(start, local)?.to_vec();
        let next = match local < length {
            true => bytes.u32(start + local)?,
            false => 0,
        };
        let mut payload = Payload { here, next, length };
        let (head, _) = varint(&payload.here)?;
        let head = usize::try_from(head).unwrap_or(usize::MAX);
        self.complete(&mut payload, head)?;
        Record::new(payload, row_id, head)
    }

    /// The value of a column by its place; `Null` beyond the last one that the row has.
    pub(crate) fn value(&mut self, record: &mut Record, column: usize) -> Result<Value, Broken> {
        let Some(end) = record.end(column) else {
            return Ok(Value::Null);
        };
        self.complete(&mut record.payload, end)?;
        record.value(column, self.encoding)
    }

    /// The value of a column by its name.
    pub(crate) fn named(
        &mut self,
        (table, record): (&Table, &mut Record),
        name: &str,
    ) -> Result<Value, Broken> {
        let is_it = |own: &String| own.eq_ignore_ascii_case(name);
        let Some(column) = table.columns.iter().position(is_it) else {
            return broken(format!("no column `{name}`"));
        };
        let value = self.value(record, column)?;
        Ok(match value {
            Value::Null if table.row_id == Some(column) => Value::Integer(record.row_id),
            value => value,
        })
    }

    /// Reads a payload up to so many bytes, from the pages that it goes on in (section 1.7, overflow pages).
    fn complete(&mut self, payload: &mut Payload, bytes: usize) -> Result<(), Broken> {
        if bytes > payload.length {
            return broken("a row ends within a value");
        }
        while payload.here.len() < bytes {
            let page = self.pages.read(payload.next)?;
            let own = (payload.length - payload.here.len()).min(self.pages.usable() - 4);
            let page = page.slice(0, own + 4)?;
            payload.next = u32::from_be_bytes([page[0], page[1], page[2], page[3]]);
            payload.here.extend_from_slice(&page[4..]);
        }
        Ok(())
    }
}

/// Kinds of pages of a table.
const INTERIOR: u8 = 5;
const LEAF: u8 = 13;
