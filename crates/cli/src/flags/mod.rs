//! Flags that several commands share, and what the library is asked for by them.

mod device;
mod hold;
mod method;
pub(crate) mod outputs;
mod overwrite;
mod units;

use std::path::Path;

use crate::failure::Failure;

pub(crate) use device::{DeviceOptions, word};
pub(crate) use hold::HoldOptions;
#[cfg(test)]
pub(crate) use overwrite::OUTPUTS;
pub(crate) use overwrite::{OverwriteOptions, keep_inputs, rule};
pub(crate) use units::{MOST_PERCENT, Units};

/// Folder and name of the file that `--out` names.
pub(crate) fn folder_and_name(out: &Path) -> Result<(&Path, &str), Failure> {
    match (out.parent(), out.file_name().and_then(|name| name.to_str())) {
        (Some(folder), Some(name)) if folder.as_os_str().is_empty() => Ok((Path::new("."), name)),
        (Some(folder), Some(name)) => Ok((folder, name)),
        _ => Err(Failure::command_line(
            "arguments",
            format!("--out is {}, which names no file", out.display()),
            "give the path of the file to write",
        )),
    }
}
