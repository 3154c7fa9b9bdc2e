//! Recorded answers: one gzip file a scene, within it a number a line in a stable order.

use std::fs;
use std::io::{Read as _, Write as _};
use std::path::PathBuf;

use anyhow::{Context, Result};
use flate2::{Compression, GzBuilder, read::GzDecoder};
use serde_json::Value;

use crate::answer::trimmed;
use crate::scene::root;

/// Where the records are, from the root of the project.
const FOLDER: &str = "fixtures/results";

fn path(scene: &str) -> PathBuf {
    root(FOLDER).join(format!("{scene}.json.gz"))
}

/// The recorded answer of a scene, without what is not compared; none where there is none.
pub(crate) fn read(scene: &str) -> Result<Option<Value>> {
    let path = path(scene);
    if !path.exists() {
        return Ok(None);
    }
    let place = || path.display().to_string();
    let mut text = String::new();
    let bytes = fs::read(&path).with_context(place)?;
    GzDecoder::new(bytes.as_slice())
        .read_to_string(&mut text)
        .with_context(place)?;
    let answer = serde_json::from_str(&text).with_context(place)?;
    Ok(Some(trimmed(answer)))
}

pub(crate) fn write(scene: &str, answer: &Value) -> Result<()> {
    let path = path(scene);
    let file = fs::File::create(&path).with_context(|| path.display().to_string())?;
    // no name and no time in the head: the same bytes every time
    let mut encoder = GzBuilder::new().write(file, Compression::best());
    encoder.write_all(&serde_json::to_vec_pretty(answer)?)?;
    encoder.finish()?;
    Ok(())
}

/// Names of scenes that have a record.
pub(crate) fn names() -> Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(root(FOLDER))? {
        let name = entry?.file_name().to_string_lossy().into_owned();
        names.extend(name.strip_suffix(".json.gz").map(str::to_owned));
    }
    names.sort();
    Ok(names)
}

/// Removes the record of a scene that is no more.
pub(crate) fn remove(scene: &str) -> Result<()> {
    Ok(fs::remove_file(path(scene))?)
}

/// Writes the page that says every verdict in a line or two, for people and for `git diff`.
pub(crate) fn write_page(text: &str) -> Result<()> {
    Ok(fs::write(root(FOLDER).join("verdicts.txt"), text)?)
}

pub(crate) fn page() -> Result<String> {
    Ok(fs::read_to_string(root(FOLDER).join("verdicts.txt"))?)
}
