//! report.html: the results in a folder with an answer in a line each.

use std::path::Path;

use haptical_report::{Block, Document, Link, Section, Tone};
use serde_json::Value;

use super::own::{Listing, own_text, read_all};
use super::{ResultKind, is_sealed_by, sealed_text};
use crate::error::Error;
use crate::page::facts;

/// Who wrote it: every command that leaves a result.
const WRITER: &str = "haptical";

/// The page of the results that are in a folder, as every command with a result writes it; none where there are none.
///
/// # Errors
/// A fault of this library alone.
pub fn index(folder: &Path) -> Result<Option<String>, Error> {
    let results = read_all(folder);
    match results.is_empty() {
        true => Ok(None),
        false => page(&results).map(Some),
    }
}

/// Whether a file is such a page, as it was written.
pub fn is_one(path: &Path) -> bool {
    own_text(path).is_some_and(|text| is_sealed_by(&text, WRITER))
}

/// The page of these results.
pub(super) fn page(results: &[(ResultKind, Listing)]) -> Result<String, Error> {
    let in_order = ResultKind::ALL.into_iter();
    let results = in_order.flat_map(|kind| results.iter().filter(move |(own, _)| *own == kind));
    let sections = results.map(section).collect::<Result<Vec<_>, Error>>()?;
    let lead = match sections.len() {
        1 => "One result is in this folder.".to_owned(),
        count => format!("{count} results are in this folder."),
    };
    let page = Document::new("Results", lead, sections).to_html();
    Ok(sealed_text(&(page + "\n"), WRITER, ["<!-- ", " -->"]))
}

/// Answer, files and origin of a result.
fn section((kind, result): &(ResultKind, Listing)) -> Result<Section, Error> {
    let answer = result.value.get("answer").and_then(Value::as_str);
    let provenance = &result.value["provenance"];
    let version = provenance["haptical_version"].as_str().unwrap_or("unknown");
    let without = || format!("Version {version} wrote it, without an answer in a line.");
    let answer = answer.map_or_else(without, str::to_owned);
    let changed = format!("{} was changed after it was written.", kind.result);
    let (tone, label) = match result.is_whole {
        true => (Tone::Neutral, ""),
        false => (Tone::Bad, &*changed),
    };
    let is_there = |name: &&&str| {
        **name == kind.result || result.outputs.iter().any(|output| output.file == **name)
    };
    let mut names: Vec<&str> = kind.files.iter().filter(is_there).copied().collect();
    // the page for people first
    names.sort_by_key(|name| *name != kind.page);
    let links = names.into_iter().map(|name| Link {
        file: name.to_owned(),
        text: meaning(name).to_owned(),
    });
    let mut rows = vec![("version".to_owned(), format!("haptical {version}"))];
    for input in provenance["inputs"].as_array().into_iter().flatten() {
        let word = |key: &str| input[key].as_str().unwrap_or_default();
        let value = format!("{}, SHA-256 {}", word("file"), word("sha256"));
        rows.push((word("flag").to_owned(), value));
    }
    let blocks = vec![
        Block::notice(tone, label, answer),
        Block::Links(links.collect()),
        Block::Folded {
            summary: "What it was made from".to_owned(),
            blocks: vec![facts("", rows)?.into()],
        },
    ];
    Ok(Section::new(kind.title, blocks))
}

/// What a file is.
fn meaning(name: &str) -> &'static str {
    match name {
        "identified.toml" => "device file with the identified values",
        "rejected.toml" => "device file of the fit that was not kept",
        "predictions.csv" => "measured, before and after for each reading of the second log",
        "rigs.svg" => "which rig tells which parameters",
        "poses.csv" => "poses to measure next",
        _ if name.ends_with(".html") => "tables and figures",
        _ => "all numbers, for programs",
    }
}
