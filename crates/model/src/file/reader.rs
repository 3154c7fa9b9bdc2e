//! Reads a TOML document value by value, with the place of each and the keys that were used.

use std::cell::RefCell;
use std::collections::BTreeSet;

use toml::de::{DeTable, DeValue};
use toml_edit::DocumentMut;

use crate::DeviceFileError;
use crate::error::Position;
use crate::file::Words;
use crate::file::syntax::syntax_error;
use crate::sizes::length_question;

type Result<T> = std::result::Result<T, DeviceFileError>;

/// A document with its name, for positions in errors.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Source<'s> {
    pub(crate) file: &'s str,
    pub(crate) text: &'s str,
}

impl Source<'_> {
    /// Line and column (from 1) of a byte offset.
    pub(crate) fn position(&self, offset: usize) -> Box<Position> {
        let mut end = offset.min(self.text.len());
        while !self.text.is_char_boundary(end) {
            end -= 1;
        }
        let before = &self.text[..end];
        let line = before.matches('\n').count() + 1;
        let column = before
            .rsplit('\n')
            .next()
            .map_or(0, |text| text.chars().count())
            + 1;
        Box::new(Position {
            file: self.file.to_owned(),
            line,
            column,
        })
    }

    /// The document in the form that is written back. It is stricter than the form that is read: it
    /// looks at the numbers of unknown keys too.
    pub(crate) fn editable(&self) -> Result<DocumentMut> {
        self.text.parse().map_err(|error: toml_edit::TomlError| {
            syntax_error(self, error.span(), error.message())
        })
    }
}

/// Largest number of a device, and smallest of what is above zero: no quantity in SI units is beyond
/// it, and what is computed from it does not overflow.
const LARGEST: f64 = 1e12;
/// See [`LARGEST`].
pub(crate) const SMALLEST: f64 = 1e-30;
/// Most numbers of a list: coefficients of a polynomial.
const MOST_NUMBERS: usize = 100;
/// Most unknown keys of a table that are named one by one.
const MOST_UNKNOWN: usize = 20;

/// What the document's outermost table is called.
const ROOT: &str = "the file";

/// One table of the document.
#[derive(Debug)]
pub(crate) struct Section<'s, 't> {
    source: Source<'s>,
    table: &'t DeTable<'s>,
    /// In words: `[[link]] row 3`.
    pub(crate) place: String,
    offset: usize,
    used: RefCell<BTreeSet<String>>,
}

impl<'s, 't> Section<'s, 't> {
    /// The outermost table.
    pub(crate) fn root(source: Source<'s>, table: &'t DeTable<'s>) -> Self {
        Self::new(source, table, ROOT, 0)
    }

    fn new(
        source: Source<'s>,
        table: &'t DeTable<'s>,
        place: impl Into<String>,
        offset: usize,
    ) -> Self {
        Self {
            source,
            table,
            place: place.into(),
            offset,
            used: RefCell::default(),
        }
    }

    fn find(&self, key: &str) -> Option<(&'t DeValue<'s>, usize)> {
        self.used.borrow_mut().insert(key.to_owned());
        self.table
            .iter()
            .find(|(name, _)| name.get_ref().as_ref() == key)
            .map(|(_, value)| (value.get_ref(), value.span().start))
    }

    pub(crate) fn has(&self, key: &str) -> bool {
        self.find(key).is_some()
    }

    pub(crate) fn missing(&self, key: &str, advice: &str) -> DeviceFileError {
        self.missing_at(self.offset, key, advice)
    }

    /// An error about a key that `other` asks this table to have, at `other`'s place.
    pub(crate) fn missing_for(&self, other: &Self, key: &str, advice: &str) -> DeviceFileError {
        self.missing_at(other.offset, key, advice)
    }

    fn missing_at(&self, offset: usize, key: &str, advice: &str) -> DeviceFileError {
        DeviceFileError::MissingKey {
            at: self.source.position(offset),
            place: self.place.clone(),
            key: key.to_owned(),
            advice: match self.unused_like(key) {
                Some(other) => format!("{advice}, or rename `{other}` if it is meant"),
                None => advice.to_owned(),
            },
        }
    }

    /// A key that nobody asked for so far and that is like `key`.
    fn unused_like(&self, key: &str) -> Option<&'t str> {
        let used = self.used.borrow();
        let names = self.table.iter().map(|(name, _)| name.get_ref().as_ref());
        nearest(key, names.filter(|name| !used.contains(*name)))
    }

    /// An error about the value of a key.
    pub(crate) fn refuse(
        &self,
        key: &str,
        found: impl Into<String>,
        allowed: &str,
    ) -> DeviceFileError {
        let offset = self.find(key).map_or(self.offset, |(_, offset)| offset);
        self.refuse_at(offset, key, found, allowed)
    }

    fn refuse_at(
        &self,
        offset: usize,
        key: &str,
        found: impl Into<String>,
        allowed: &str,
    ) -> DeviceFileError {
        DeviceFileError::Value {
            at: self.source.position(offset),
            place: self.place.clone(),
            key: key.to_owned(),
            found: found.into(),
            allowed: allowed.to_owned(),
        }
    }

    /// A finite number, if the key is there.
    pub(crate) fn number(&self, key: &str) -> Result<Option<f64>> {
        let Some((value, offset)) = self.find(key) else {
            return Ok(None);
        };
        self.to_number(key, value, offset).map(Some)
    }

    /// A finite number above zero, if the key is there.
    pub(crate) fn positive(&self, key: &str) -> Result<Option<f64>> {
        match self.number(key)? {
            Some(value) if value <= 0.0 => {
                Err(self.refuse(key, value.to_string(), "it must be above zero"))
            }
            Some(value) if value < SMALLEST => {
                let allowed = format!("at least {SMALLEST:e} is expected");
                Err(self.refuse(key, format!("{value:e}"), &allowed))
            }
            other => Ok(other),
        }
    }

    /// A number that is not negative, if the key is there; `quantity` names it.
    pub(crate) fn not_negative(&self, key: &str, quantity: &str) -> Result<Option<f64>> {
        match self.number(key)? {
            Some(value) if value < 0.0 => {
                let allowed = format!("{quantity} is not negative");
                Err(self.refuse(key, value.to_string(), &allowed))
            }
            other => Ok(other),
        }
    }

    /// Warns of a length, if the key is there, that is probably in millimetres.
    pub(crate) fn warn_of_millimetres(&self, key: &str, warnings: &mut Vec<String>) -> Result<()> {
        if let (Some(length_m), Some((_, offset))) = (self.number(key)?, self.find(key))
            && let Some(question) = length_question(length_m)
        {
            let at = self.source.position(offset);
            warnings.push(format!("{at}: {}: `{key}` {question}", self.place));
        }
        Ok(())
    }

    /// A finite number that must be there.
    pub(crate) fn required(&self, key: &str, advice: &str) -> Result<f64> {
        self.number(key)?.ok_or_else(|| self.missing(key, advice))
    }

    pub(crate) fn text(&self, key: &str) -> Result<Option<&'t str>> {
        match self.find(key) {
            None => Ok(None),
            Some((DeValue::String(text), _)) => Ok(Some(text.as_ref())),
            Some((value, offset)) => {
                Err(self.refuse_at(offset, key, value.type_str(), "text in quotes is expected"))
            }
        }
    }

    /// The meaning of one of some words, if the key is there.
    pub(crate) fn word<T: Copy>(&self, key: &str, words: &Words<T>) -> Result<Option<T>> {
        let Some(found) = self.text(key)? else {
            return Ok(None);
        };
        if let Some((_, value)) = words.iter().find(|(word, _)| *word == found) {
            return Ok(Some(*value));
        }
        let quoted: Vec<String> = words
            .iter()
            .map(|(word, _)| format!("\"{word}\""))
            .collect();
        let (others, last) = quoted.split_at(words.len() - 1);
        let allowed = format!("it must be {} or {}", others.join(", "), last.join(""));
        Err(self.refuse(key, format!("\"{found}\""), &allowed))
    }

    /// A list of finite numbers of any length.
    pub(crate) fn numbers(&self, key: &str) -> Result<Option<Vec<f64>>> {
        match self.find(key) {
            None => Ok(None),
            Some((DeValue::Array(items), offset)) if items.len() > MOST_NUMBERS => {
                let found = format!("a list of {} numbers", items.len());
                let allowed = format!("at most {MOST_NUMBERS} are read");
                Err(self.refuse_at(offset, key, found, &allowed))
            }
            Some((DeValue::Array(items), _)) => items
                .iter()
                .map(|item| self.to_number(key, item.get_ref(), item.span().start))
                .collect::<Result<Vec<f64>>>()
                .map(Some),
            Some((value, offset)) => Err(self.refuse_at(
                offset,
                key,
                value.type_str(),
                "a list of numbers is expected",
            )),
        }
    }

    /// All keys, in the order of the file's table.
    pub(crate) fn keys(&self) -> Vec<&'t str> {
        let names = self.table.iter();
        names.map(|(name, _)| name.get_ref().as_ref()).collect()
    }

    /// True or false, if the key is there.
    pub(crate) fn truth(&self, key: &str) -> Result<Option<bool>> {
        match self.find(key) {
            None => Ok(None),
            Some((DeValue::Boolean(truth), _)) => Ok(Some(*truth)),
            Some((value, offset)) => {
                Err(self.refuse_at(offset, key, literal(value), "true or false is expected"))
            }
        }
    }

    /// Two ends of an interval that must be there; an end that is not finite is open.
    pub(crate) fn ends(&self, key: &str) -> Result<[Option<f64>; 2]> {
        let wrong =
            |found: String| self.refuse(key, found, "two numbers are expected, low and high");
        let Some((DeValue::Array(items), _)) = self.find(key) else {
            return Err(wrong("no list".to_owned()));
        };
        let end = |index: usize| -> Result<Option<f64>> {
            let Some(item) = items.get(index).filter(|_| items.len() == 2) else {
                return Err(wrong(format!("a list of {}", items.len())));
            };
            match item.get_ref() {
                DeValue::Float(number) if number.as_str().contains("inf") => Ok(None),
                value => self.to_number(key, value, item.span().start).map(Some),
            }
        };
        Ok([end(0)?, end(1)?])
    }

    /// A list of texts.
    pub(crate) fn texts(&self, key: &str) -> Result<Option<Vec<&'t str>>> {
        let wrong = |value: &DeValue<'_>, offset: usize| {
            self.refuse_at(
                offset,
                key,
                value.type_str(),
                "a list of texts in quotes is expected",
            )
        };
        match self.find(key) {
            None => Ok(None),
            Some((DeValue::Array(items), _)) => items
                .iter()
                .map(|item| match item.get_ref() {
                    DeValue::String(text) => Ok(text.as_ref()),
                    other => Err(wrong(other, item.span().start)),
                })
                .collect::<Result<Vec<&str>>>()
                .map(Some),
            Some((value, offset)) => Err(wrong(value, offset)),
        }
    }

    /// A list of exactly `N` finite numbers.
    pub(crate) fn vector<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>> {
        let Some(values) = self.numbers(key)? else {
            return Ok(None);
        };
        let found = values.len();
        <[f64; N]>::try_from(values).map(Some).map_err(|_| {
            self.refuse(
                key,
                format!("{found} numbers"),
                &format!("{N} numbers are expected"),
            )
        })
    }

    /// A list of exactly `N` finite numbers that must be there.
    pub(crate) fn required_vector<const N: usize>(
        &self,
        key: &str,
        advice: &str,
    ) -> Result<[f64; N]> {
        self.vector(key)?.ok_or_else(|| self.missing(key, advice))
    }

    /// One table below this one.
    pub(crate) fn table(&self, key: &str) -> Result<Option<Section<'s, 't>>> {
        match self.find(key) {
            None => Ok(None),
            Some((DeValue::Table(table), offset)) => {
                let place = if self.place == ROOT {
                    format!("[{key}]")
                } else {
                    format!("[{key}] of {}", self.place)
                };
                Ok(Some(Section::new(self.source, table, place, offset)))
            }
            Some((value, offset)) => {
                Err(self.refuse_at(offset, key, value.type_str(), "a table is expected"))
            }
        }
    }

    /// What is read from one table below this one; its unknown keys are named.
    pub(crate) fn within<T>(
        &self,
        key: &str,
        warnings: &mut Vec<String>,
        read: impl FnOnce(&Section<'s, 't>, &mut Vec<String>) -> Result<T>,
    ) -> Result<Option<T>> {
        let Some(section) = self.table(key)? else {
            return Ok(None);
        };
        let found = read(&section, warnings)?;
        section.unknown_keys(warnings);
        Ok(Some(found))
    }

    /// What is read from each of a list of tables, as [`Section::within`].
    pub(crate) fn each<T>(
        &self,
        key: &str,
        warnings: &mut Vec<String>,
        mut read: impl FnMut(&Section<'s, 't>) -> Result<T>,
    ) -> Result<Vec<T>> {
        let mut found = Vec::new();
        for section in self.tables(key, 1)? {
            found.push(read(&section)?);
            section.unknown_keys(warnings);
        }
        Ok(found)
    }

    /// A list of tables; `number` names the first.
    pub(crate) fn tables(&self, key: &str, first: usize) -> Result<Vec<Section<'s, 't>>> {
        match self.find(key) {
            None => Ok(Vec::new()),
            Some((DeValue::Array(items), _)) => items
                .iter()
                .enumerate()
                .map(|(index, item)| match item.get_ref() {
                    DeValue::Table(table) => {
                        let place = format!("[[{key}]] {}", index + first);
                        Ok(Section::new(self.source, table, place, item.span().start))
                    }
                    other => {
                        let expected = "a list of tables is expected";
                        Err(self.refuse_at(item.span().start, key, other.type_str(), expected))
                    }
                })
                .collect(),
            Some((value, offset)) => {
                let allowed = format!("write each as [[{key}]]");
                Err(self.refuse_at(offset, key, value.type_str(), &allowed))
            }
        }
    }

    /// Keys that nobody asked for, as warnings: probably misspelt.
    pub(crate) fn unknown_keys(&self, warnings: &mut Vec<String>) {
        let used = self.used.borrow();
        let unknown: Vec<_> = self
            .table
            .iter()
            .map(|(name, _)| name)
            .filter(|name| !used.contains(name.get_ref().as_ref()))
            .collect();
        if let Some(more @ 1..) = unknown.len().checked_sub(MOST_UNKNOWN) {
            let (file, place) = (self.source.file, &self.place);
            warnings.push(format!(
                "{file}: {place} has {more} further keys that are not known and not used"
            ));
        }
        for name in unknown.into_iter().take(MOST_UNKNOWN) {
            let line = self.source.position(name.span().start).line;
            let absent = used
                .iter()
                .filter(|key| !self.table.contains_key(key.as_str()));
            let meant = nearest(name.get_ref(), absent.map(String::as_str))
                .map_or_else(String::new, |key| format!("; did you mean `{key}`?"));
            warnings.push(format!(
                "{}:{line}: {} has the key `{}`, which is not known and not used{meant}",
                self.source.file,
                self.place,
                name.get_ref()
            ));
        }
    }

    fn to_number(&self, key: &str, value: &DeValue<'_>, offset: usize) -> Result<f64> {
        let number = match value {
            DeValue::Float(number) => number.as_str().replace('_', "").parse::<f64>().ok(),
            DeValue::Integer(number) => {
                i64::from_str_radix(&number.as_str().replace('_', ""), number.radix())
                    .ok()
                    .map(|integer| integer as f64)
            }
            _ => None,
        };
        match number {
            Some(number) if number.abs() <= LARGEST => Ok(number),
            Some(_) => Err(self.refuse_at(
                offset,
                key,
                literal(value),
                &format!("a finite number is expected, at most {LARGEST:e}"),
            )),
            None => {
                let allowed = "a number is expected";
                Err(self.refuse_at(offset, key, literal(value), allowed))
            }
        }
    }
}

/// A value as the file has it, or what it is.
fn literal(value: &DeValue<'_>) -> String {
    match value {
        DeValue::Float(number) => number.as_str().to_owned(),
        DeValue::Integer(number) => number.as_str().to_owned(),
        DeValue::String(text) => format!("the text \"{text}\""),
        other => other.type_str().to_owned(),
    }
}

/// Likeness (Jaro & Winkler's) from which a key is offered in place of another.
const LIKENESS: f64 = 0.85;

/// The one of `names` that is most like `name`.
fn nearest<'n>(name: &str, names: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    names
        .map(|other| (strsim::jaro_winkler(name, other), other))
        .filter(|(likeness, _)| *likeness > LIKENESS)
        .max_by(|(a, _), (b, _)| a.total_cmp(b))
        .map(|(_, other)| other)
}
