//! Tables of a job in a page of the docs.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

use crate::command::read_text;

/// Puts a table between two lines of a page.
pub fn put_between(path: &Path, [begin, end]: [&str; 2], table: &str) -> Result<()> {
    let text = read_text(path)?;
    let (before, rest) = text
        .split_once(begin)
        .context("no line where the table begins")?;
    let (_, after) = rest
        .split_once(end)
        .context("no line where the table ends")?;
    fs::write(path, format!("{before}{begin}{table}{end}{after}"))?;
    Ok(())
}
