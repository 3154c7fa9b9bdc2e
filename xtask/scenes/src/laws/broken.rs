//! The laws that are broken today, scene by scene: a list that may only shrink.

use std::fmt::Write as _;

use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};

use crate::scene::root;

/// Where the list is, from the root of the project.
pub(super) const FILE: &str = "fixtures/results/broken-laws.toml";

/// A law that a scene's answer breaks.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Deserialize, Serialize)]
pub(super) struct Broken {
    pub(super) law: String,
    pub(super) scene: String,
    /// How.
    pub(super) why: String,
}

#[derive(Debug, Default, Deserialize)]
struct List {
    #[serde(default)]
    broken: Vec<Broken>,
}

pub(super) fn read() -> Result<Vec<Broken>> {
    let text = std::fs::read_to_string(root(FILE)).with_context(|| FILE.to_owned())?;
    let list: List = toml::from_str(&text).with_context(|| FILE.to_owned())?;
    Ok(list.broken)
}

pub(super) fn write(list: &[Broken]) -> Result<()> {
    let mut text =
        "# Laws of xtask/scenes/src/laws that answers break: `cargo xtask laws --record` writes this list.\n".to_owned();
    for own in list {
        let quoted = |own: &str| toml::Value::String(own.to_owned()).to_string();
        writeln!(
            text,
            "\n[[broken]]\nlaw = {}\nscene = {}\nwhy = {}",
            quoted(&own.law),
            quoted(&own.scene),
            quoted(&own.why)
        )?;
    }
    Ok(std::fs::write(root(FILE), text)?)
}
