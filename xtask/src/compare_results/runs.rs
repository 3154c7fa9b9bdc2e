//! The commands that are run, and their results as files.

use std::fs;
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use flate2::{Compression, read::GzDecoder, write::GzEncoder};
use serde::Deserialize;
use serde_json::Value;

/// All runs.
#[derive(Debug, Deserialize)]
pub(super) struct Runs {
    run: Vec<Run>,
}

/// Commands that belong together.
#[derive(Debug, Deserialize)]
pub(super) struct Run {
    pub(super) name: String,
    /// Commands without their program.
    steps: Vec<String>,
    /// Files below the run's folder that are compared.
    pub(super) results: Vec<String>,
    /// Jobs of this program instead of the command `haptical`.
    #[serde(default)]
    xtask: bool,
    /// Needs data outside this repository.
    #[serde(default)]
    pub(super) shared: bool,
}

impl Runs {
    pub(super) fn load(path: &Path) -> Result<Self> {
        let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
        Ok(toml::from_str(&text)?)
    }

    pub(super) fn named(&self, part: Option<&str>) -> impl Iterator<Item = &Run> {
        let part = part.unwrap_or_default().to_owned();
        self.run.iter().filter(move |run| run.name.contains(&part))
    }
}

/// The command `haptical`, built from this tree.
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

impl Run {
    /// Runs the steps in a fresh folder.
    pub(super) fn execute(&self, program: &Path, folder: &Path, shared: &Path) -> Result<()> {
        if folder.exists() {
            fs::remove_dir_all(folder)?;
        }
        fs::create_dir_all(folder)?;
        let own = std::env::current_exe()?;
        let program = if self.xtask { own.as_path() } else { program };
        for step in &self.steps {
            let placed = step
                .replace("{out}", &folder.to_string_lossy())
                .replace("{shared}", &shared.to_string_lossy());
            let output = Command::new(program)
                .args(placed.split_whitespace())
                .output()?;
            ensure!(
                output.status.success(),
                "{}: `{placed}` ended with {}:\n{}",
                self.name,
                output.status,
                String::from_utf8_lossy(&output.stderr)
            );
        }
        Ok(())
    }
}

/// A JSON file, gzip where its name says so.
pub(super) fn read(path: &Path) -> Result<Value> {
    let name = || path.display().to_string();
    let mut text = String::new();
    let bytes = fs::read(path).with_context(name)?;
    if path.extension().is_some_and(|extension| extension == "gz") {
        GzDecoder::new(bytes.as_slice()).read_to_string(&mut text)?;
    } else {
        text = String::from_utf8(bytes)?;
    }
    serde_json::from_str(&text).with_context(name)
}

/// Writes a JSON file, gzip.
pub(super) fn write(path: &Path, value: &Value) -> Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let mut encoder = GzEncoder::new(fs::File::create(path)?, Compression::best());
    encoder.write_all(&serde_json::to_vec(value)?)?;
    encoder.finish()?;
    Ok(())
}
