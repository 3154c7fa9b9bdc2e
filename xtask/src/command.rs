//! The command `haptical`, for jobs that run it.

use std::path::PathBuf;
use std::process::Command;

use anyhow::{Result, ensure};

/// The command, built from this tree.
pub(crate) fn command() -> Result<PathBuf> {
    let built = Command::new("cargo")
        .args([
            "build",
            "--quiet",
            "--profile",
            "jobs",
            "--package",
            "haptical-cli",
            "--locked",
        ])
        .status()?;
    ensure!(built.success(), "haptical does not build");
    let own = std::env::current_exe()?;
    Ok(own.with_file_name(format!("haptical{}", std::env::consts::EXE_SUFFIX)))
}
