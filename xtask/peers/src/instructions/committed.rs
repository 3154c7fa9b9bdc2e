//! The files of committed counts: one for each version of the compiler.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, ensure};
use haptical_report::write_atomically;
use serde::{Deserialize, Serialize};
use xtask_output::read_text;

use super::environment::Environment;

/// First lines of a file.
const HEAD: &str = "\
# Instructions of the workloads of `cargo xtask instructions`, as callgrind counts them on one thread.
# Written by `cargo xtask instructions --record`; what each workload is: docs/performance.md.

";

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Committed {
    pub(crate) rustc: String,
    pub(crate) target: String,
    pub(crate) lanes: String,
    /// To know; counts of other versions are compared.
    pub(crate) valgrind: String,
    /// By name of the workload.
    pub(crate) instructions: BTreeMap<String, u64>,
}

fn path(folder: &Path, environment: &Environment) -> PathBuf {
    folder.join(format!("{}.toml", environment.release))
}

/// What is committed for an environment: counts of the same compiler, target and lanes, or why there are none.
pub(crate) fn find(folder: &Path, environment: &Environment) -> Result<Result<Committed, String>> {
    let path = path(folder, environment);
    if !path.exists() {
        let mut others: Vec<String> = std::fs::read_dir(folder)
            .into_iter()
            .flatten()
            .filter_map(|entry| {
                let name = entry.ok()?.file_name().into_string().ok()?;
                Some(name.strip_suffix(".toml")?.to_owned())
            })
            .collect();
        others.sort();
        let others = match others.is_empty() {
            true => "none is".to_owned(),
            false => others.join(", "),
        };
        let release = &environment.release;
        let why = format!("no counts of rustc {release} are committed; committed: {others}");
        return Ok(Err(why));
    }
    let committed = read(&path)?;
    let pairs = [
        ("compiler", &committed.rustc, &environment.rustc),
        ("target", &committed.target, &environment.target),
        ("lanes", &committed.lanes, &environment.lanes),
    ];
    Ok(
        match pairs.iter().find(|(_, committed, here)| committed != here) {
            Some((what, committed, here)) => Err(format!(
                "{what}: the committed counts are of `{committed}`, here is `{here}`"
            )),
            None => Ok(committed),
        },
    )
}

fn read(path: &Path) -> Result<Committed> {
    let committed: Committed =
        toml::from_str(&read_text(path)?).with_context(|| path.display().to_string())?;
    for (name, count) in &committed.instructions {
        ensure!(
            *count > 0,
            "{}: `{name}` is 0; a workload takes instructions: record it again",
            path.display()
        );
    }
    Ok(committed)
}

/// Writes counts; a part of the workloads joins the others' counts, which must be of the same
/// environment. Counts of workloads that are not `known` are dropped.
pub(crate) fn record(
    folder: &Path,
    environment: &Environment,
    counts: &[(&str, u64)],
    known: &[&str],
    is_part: bool,
) -> Result<PathBuf> {
    let path = path(folder, environment);
    let mut instructions = BTreeMap::new();
    if is_part && path.exists() {
        let committed = find(folder, environment)?;
        let committed =
            committed.map_err(|why| anyhow!("{why}: record all workloads, without --only"));
        instructions = committed?.instructions;
    }
    instructions.retain(|name, _| known.contains(&name.as_str()));
    let counts = counts.iter();
    instructions.extend(counts.map(|(name, count)| ((*name).to_owned(), *count)));
    let committed = Committed {
        rustc: environment.rustc.clone(),
        target: environment.target.clone(),
        lanes: environment.lanes.clone(),
        valgrind: environment.valgrind.clone(),
        instructions,
    };
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    let text = format!("{HEAD}{}", toml::to_string(&committed)?);
    write_atomically(&path, text.as_bytes())?;
    Ok(path)
}
