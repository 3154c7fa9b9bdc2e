//! Zip archives: the arrays of NumPy in an NPZ file, and the check that none unpacks to more than the memory holds.

use std::io::{Cursor, Read};

use zip::ZipArchive;

use super::{Array, MOST_NUMBERS, npy};
use crate::error::TableError;
use crate::read::inflated;

/// Most files of an archive.
const MOST_ENTRIES: usize = 4096;

fn open<'b>(bytes: &'b [u8], file: &str) -> Result<ZipArchive<Cursor<&'b [u8]>>, TableError> {
    let archive = ZipArchive::new(Cursor::new(bytes));
    let archive = archive.map_err(|error| TableError::damaged("zip", error, file))?;
    match archive.len() > MOST_ENTRIES {
        true => Err(TableError::too_large(file)),
        false => Ok(archive),
    }
}

/// Names of an archive's files.
pub(crate) fn zip_names(bytes: &[u8], file: &str) -> Result<Vec<String>, TableError> {
    let archive = open(bytes, file)?;
    let names = archive.file_names();
    let names = names.map(|name| Ok(name?.into_owned()));
    let names: Result<Vec<String>, zip::result::ZipError> = names.collect();
    names.map_err(|error| TableError::damaged("zip", error, file))
}

/// The files of an archive whose names end so, unpacked.
pub(crate) fn limited_entries(
    bytes: &[u8],
    ends: &str,
    file: &str,
) -> Result<Vec<(String, Vec<u8>)>, TableError> {
    let mut archive = open(bytes, file)?;
    let mut found = Vec::new();
    let mut all = 0;
    for index in 0..archive.len() {
        let entry = archive.by_index(index);
        let entry = entry.map_err(|error| TableError::damaged("zip", error, file))?;
        let name = entry.name();
        let name = name.map_err(|error| TableError::damaged("zip", error, file))?;
        let name = name.into_owned();
        if !name.ends_with(ends) {
            continue;
        }
        let content = inflated(entry.take(u64::MAX), "zip", file)?;
        all += content.len() as u64;
        if all > haptical_data::MOST_MEMORY_BYTES / 2 {
            return Err(TableError::too_large(file));
        }
        found.push((name, content));
    }
    Ok(found)
}

/// The arrays of an NPZ file, by their names.
pub(crate) fn npz(bytes: &[u8], file: &str) -> Result<Vec<Array>, TableError> {
    let entries = limited_entries(bytes, ".npy", file)?;
    let mut arrays = Vec::new();
    let mut numbers = 0;
    for (name, content) in &entries {
        let array = npy(content, name.trim_end_matches(".npy"), file)?;
        numbers += array.values.len();
        if numbers > MOST_NUMBERS {
            return Err(TableError::too_large(file));
        }
        arrays.push(array);
    }
    Ok(arrays)
}
