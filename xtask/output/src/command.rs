//! The command `haptical`, built for a job.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

/// Builds the command beside the program that runs; returns where it is.
pub fn built_command(root: &Path) -> Result<PathBuf> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let built = Command::new(cargo)
        .current_dir(root)
        .args([
            "build",
            "--profile",
            "jobs",
            "--quiet",
            "-p",
            "haptical-cli",
        ])
        .output()?;
    let said = String::from_utf8_lossy(&built.stderr);
    ensure!(
        built.status.success(),
        "haptical-cli does not build: {said}"
    );
    let name = format!("haptical{}", std::env::consts::EXE_SUFFIX);
    let folder = std::env::current_exe()?;
    let folder = folder.parent().context("the folder of this program")?;
    Ok(folder.join(name))
}
