//! A trial as a folder: device file, model, two logs, and the truth where it may be seen.

use std::path::Path;

use anyhow::{Context, Result};
use haptical_data::{LogShape, write_log};

use crate::trial::Trial;

pub(crate) fn write_text(path: &Path, text: &str) -> Result<()> {
    std::fs::write(path, text).with_context(|| format!("{} cannot be written", path.display()))
}

/// Writes `device.toml`, `log.csv.gz`, `log2.csv.gz` where there is a second recording, for an ablation `model.toml`, and with
/// `with_truth` `truth.json` into a folder, which is made if it is not there.
pub fn write_trial(trial: &Trial, folder: &Path, with_truth: bool) -> Result<()> {
    let write = |name: &str, text: &str| write_text(&folder.join(name), text);
    std::fs::create_dir_all(folder)
        .with_context(|| format!("{} cannot be written", folder.display()))?;
    write("device.toml", &trial.device_toml)?;
    if let Some(model) = &trial.model_toml {
        write("model.toml", model)?;
    }
    let shape = LogShape::from(&trial.device);
    write_log(&folder.join("log.csv.gz"), &trial.log, &shape)?;
    if !trial.log2.is_empty() {
        write_log(&folder.join("log2.csv.gz"), &trial.log2, &shape)?;
    }
    if with_truth {
        let truth = serde_json::to_string_pretty(&trial.truth)?;
        write("truth.json", &(truth + "\n"))?;
    }
    Ok(())
}
