//! A trial as a folder: device file, model, two logs, and the truth where it may be seen.

use std::path::Path;

use haptical_data::{LogShape, write_log};

use crate::error::BlindError;
use crate::trial::Trial;

/// Writes `device.toml`, `log.csv.gz`, `log2.csv.gz` where there is a second recording, for an ablation `model.toml`, and with
/// `with_truth` `truth.json` into a folder, which is made if it is not there.
///
/// # Errors
/// [`BlindError::File`] from the file system, [`BlindError::Log`] from a log.
pub fn write_trial(trial: &Trial, folder: &Path, with_truth: bool) -> Result<(), BlindError> {
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(|source| BlindError::File { path, source })
    };
    std::fs::create_dir_all(folder).map_err(|source| BlindError::File {
        path: folder.to_owned(),
        source,
    })?;
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
        let truth =
            serde_json::to_string_pretty(&trial.truth).map_err(|source| BlindError::Json {
                what: "a truth",
                source,
            })?;
        write("truth.json", &(truth + "\n"))?;
    }
    Ok(())
}
