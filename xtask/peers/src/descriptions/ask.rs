//! The request to the peers, one process for all models, and their answer.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};
use serde::{Deserialize, Serialize};
use xtask_output::{read_json, said};

use super::files::Kind;
use super::subject::Motion;
use crate::bench_peers::tools::source;

const SCRIPT: &str = "descriptions.py";

/// A model that peers are asked about.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Model {
    pub(crate) kind: Kind,
    /// File with what it includes; none for a text that haptical wrote.
    pub(crate) path: Option<String>,
    pub(crate) text: String,
    pub(crate) peers: Vec<&'static str>,
    /// Link in whose frame the ends are wanted; none for the root.
    pub(crate) base: Option<String>,
    /// The root link.
    pub(crate) root: String,
    pub(crate) tips: Vec<String>,
    pub(crate) joints: Vec<String>,
    /// Where the file has none \[m/s^2\].
    pub(crate) gravity: [f64; 3],
    pub(crate) motions: Vec<Motion>,
}

/// Versions of the packages.
#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Versions {
    pinocchio: Option<String>,
    mujoco: Option<String>,
}

impl Versions {
    pub(crate) fn words(&self) -> String {
        let known = |own: &Option<String>| own.clone().unwrap_or_else(|| "absent".to_owned());
        let (pinocchio, mujoco) = (known(&self.pinocchio), known(&self.mujoco));
        format!("peers: Pinocchio {pinocchio}, MuJoCo {mujoco}")
    }
}

/// What a peer answers of a model.
#[derive(Debug, Clone, Default, Deserialize)]
pub(crate) struct Answer {
    pub(crate) peer: String,
    #[serde(default)]
    pub(crate) refused: Option<String>,
    /// Of each motion, of each end: position \[m\] and rotation, row by row.
    #[serde(default)]
    pub(crate) poses: Vec<Vec<Vec<f64>>>,
    /// Torques at rest.
    #[serde(default)]
    pub(crate) still: Vec<Vec<f64>>,
    /// Torques in motion.
    #[serde(default)]
    pub(crate) moving: Vec<Vec<f64>>,
    /// Parts of the model that are no rigid bodies.
    #[serde(default)]
    pub(crate) features: Vec<Feature>,
}

/// A part of a model that is not in the torques that are compared.
#[derive(Debug, Clone, Deserialize)]
pub(crate) struct Feature {
    pub(crate) kind: String,
    /// Largest force of it \[N m\], \[N\], or how many there are.
    pub(crate) size: f64,
}

#[derive(Debug, Deserialize)]
struct Answers {
    models: Vec<OfModel>,
}

#[derive(Debug, Deserialize)]
struct OfModel {
    answers: Vec<Answer>,
}

/// Versions of the packages; an error that says what to install where one is missing.
pub(crate) fn versions(python: &Path) -> Result<Versions> {
    let text = said(Command::new(python).arg(source(SCRIPT)).arg("--versions"));
    let text = text.context("numpy, pinocchio and mujoco are needed: pip install mujoco pin")?;
    let found: Versions = serde_json::from_str(&text).context(SCRIPT)?;
    let absent = [("pin", &found.pinocchio), ("mujoco", &found.mujoco)];
    let absent = absent.into_iter().filter(|(_, version)| version.is_none());
    let absent: Vec<&str> = absent.map(|(name, _)| name).collect();
    if !absent.is_empty() {
        bail!(
            "{} does not import the packages of {}: pip install {}",
            python.display(),
            absent.join(", "),
            absent.join(" ")
        );
    }
    Ok(found)
}

/// Asks the peers about all models; one list of answers for each.
pub(crate) fn ask(python: &Path, out: &Path, models: &[Model]) -> Result<Vec<Vec<Answer>>> {
    let count = models.len();
    let [request, answer] = ["request.json", "answer.json"].map(|name| out.join(name));
    let text = serde_json::to_string(&serde_json::json!({ "models": models }))?;
    std::fs::write(&request, text).with_context(|| request.display().to_string())?;
    let mut command = Command::new(python);
    command.arg(source(SCRIPT)).arg(&request).arg(&answer);
    said(&mut command)?;
    let answers: Answers = read_json(&answer)?;
    ensure!(
        answers.models.len() == count,
        "{SCRIPT} answered {} models of {count}",
        answers.models.len()
    );
    Ok(answers.models.into_iter().map(|own| own.answers).collect())
}
