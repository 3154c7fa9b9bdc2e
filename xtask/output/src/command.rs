//! Programs that jobs run, and the files that these write.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use serde::de::DeserializeOwned;

/// The repository.
pub fn root() -> PathBuf {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR"));
    manifest.ancestors().nth(2).unwrap_or(manifest).to_owned()
}

/// Builds the command `haptical` beside the program that runs; returns where it is.
pub fn built_command(root: &Path) -> Result<PathBuf> {
    let words = "build --profile jobs --quiet -p haptical-cli";
    said(cargo().current_dir(root).args(words.split(' ')))?;
    let name = format!("haptical{}", std::env::consts::EXE_SUFFIX);
    let folder = std::env::current_exe()?;
    let folder = folder.parent().context("the folder of this program")?;
    Ok(folder.join(name))
}

/// Cargo, as it started this program.
pub fn cargo() -> Command {
    Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Runs a program; returns its standard output, or an error with its words and all that it said.
pub fn said(command: &mut Command) -> Result<String> {
    let done = command.output();
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    let words: Vec<_> = words.map(|word| word.to_string_lossy()).collect();
    let words = words.join(" ");
    let done = done.with_context(|| words.clone())?;
    let [text, complaint] = [done.stdout, done.stderr]
        .map(|bytes| String::from_utf8_lossy(&bytes).trim_end().to_owned());
    ensure!(
        done.status.success(),
        "{words}: {}\n{text}\n{complaint}",
        done.status
    );
    Ok(text)
}

/// The text of a file; the error says which.
pub fn read_text(path: &Path) -> Result<String> {
    std::fs::read_to_string(path).with_context(|| path.display().to_string())
}

/// What a file of JSON holds; the error says which.
pub fn read_json<T: DeserializeOwned>(path: &Path) -> Result<T> {
    serde_json::from_str(&read_text(path)?).with_context(|| path.display().to_string())
}
