//! The table of the faults, `fixtures/mutants/faults.toml`.

use std::fmt;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use serde::Deserialize;
use xtask_output::read_text;

/// Where the table and the diffs are.
const FOLDER: &str = "fixtures/mutants";

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Faults {
    fault: Vec<Fault>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Fault {
    /// Its diff is `NAME.diff`.
    pub(super) name: String,
    /// What is wrong with it, in a sentence.
    pub(super) meaning: String,
    /// What must fail: each of these.
    pub(super) caught_by: Vec<Check>,
}

/// What must fail where the fault is planted.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(untagged, deny_unknown_fields)]
pub(super) enum Check {
    /// A test binary of the crate `haptical-PACKAGE`.
    Tests {
        package: String,
        #[serde(default)]
        target: Target,
        /// Only tests whose name contains one of these; all where it is empty.
        #[serde(default)]
        only: Vec<String>,
    },
    /// A golden scene of `compare-results`.
    Scene { scene: String },
}

/// The binary that has the tests.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Target {
    #[default]
    It,
    Lib,
}

impl fmt::Display for Check {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tests {
                package,
                target,
                only,
            } => {
                let target = match target {
                    Target::It => "it",
                    Target::Lib => "lib",
                };
                write!(f, "{package} {target}")?;
                only.iter().try_for_each(|name| write!(f, " {name}"))
            }
            Self::Scene { scene } => write!(f, "scene {scene}"),
        }
    }
}

pub(super) fn read(root: &Path) -> Result<Vec<Fault>> {
    let path = root.join(FOLDER).join("faults.toml");
    let faults: Faults =
        toml::from_str(&read_text(&path)?).with_context(|| path.display().to_string())?;
    Ok(faults.fault)
}

pub(super) fn diff_of(root: &Path, name: &str) -> PathBuf {
    root.join(FOLDER).join(format!("{name}.diff"))
}
