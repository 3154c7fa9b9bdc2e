//! The measured sets: where their files are, what is known of them, and what the command answers.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use anyhow::{Context, Result};
use serde::Deserialize;
use serde_json::Value;
use xtask_output::{read_json, read_text, said};

use super::Arguments;

#[derive(Debug, Deserialize)]
pub(super) struct Sets {
    pub(super) set: Vec<Set>,
}

#[derive(Debug, Deserialize)]
pub(super) struct Set {
    pub(super) name: String,
    /// Description of the device, the log, and flags for both commands, with `{shared}`, `{fetched}` and `{here}`.
    device: String,
    log: String,
    #[serde(default)]
    options: Vec<String>,
    /// A second recording for `diagnose`.
    second: Option<String>,
    /// A command that makes the log from the set's own files, without its program; `{out}` is the set's folder.
    import: Option<String>,
    /// Whether nothing but `diagnose` applies: a log of torques alone.
    #[serde(default)]
    diagnose_only: bool,
    pub(super) source: String,
    /// What others found of it.
    pub(super) known: String,
    /// What stays unknown, and why.
    pub(super) remark: String,
}

/// What the command answered for a set.
#[derive(Debug)]
pub(super) struct Answers {
    /// `identified.json`, and the seconds that it took.
    pub(super) identified: Option<(Value, f64)>,
    /// `gap.json`, and the seconds that it took.
    pub(super) gap: (Value, f64),
    /// `identified.json` with the causes as parameters, where they are part of a device.
    pub(super) with_causes: Option<Value>,
}

/// The folder with the list of sets and the files that belong to it.
pub(super) const HERE: &str = "fixtures/real-arms";

/// The files that the two commands answer with.
const IDENTIFIED: &str = "identified.json";
const GAP: &str = "gap.json";

impl Sets {
    pub(super) fn load() -> Result<Self> {
        let path = Path::new(HERE).join("sets.toml");
        Ok(toml::from_str(&read_text(&path)?)?)
    }
}

impl Set {
    /// The file that is missing, or what the command answers.
    pub(super) fn answers(
        &self,
        program: &Path,
        folders: &Arguments,
    ) -> Result<Result<Answers, PathBuf>> {
        let own = folders.out.join(self.name.replace([' ', ',', '/'], "-"));
        std::fs::create_dir_all(&own)?;
        let place = |text: &str| folders.place(text).replace("{out}", &own.to_string_lossy());
        let device = place(&self.device);
        let log = place(&self.log);
        if !Path::new(&device).exists() {
            return Ok(Err(device.into()));
        }
        if let Some(import) = &self.import {
            let import = format!("{} --force", place(import));
            self.run(program, import.split_whitespace())?;
        }
        if !Path::new(&log).exists() {
            return Ok(Err(log.into()));
        }
        let options: Vec<String> = self.options.iter().map(|option| place(option)).collect();
        let answer = |job: &str, name: &str, more: &[String]| -> Result<(Value, f64)> {
            let folder = own.join(name);
            let out = folder.to_string_lossy();
            let fixed = [
                job, "--device", &device, "--log", &log, "--out", &out, "--force",
            ];
            let flags = options.iter().chain(more).map(String::as_str);
            let start = Instant::now();
            self.run(program, fixed.into_iter().chain(flags))?;
            let seconds = start.elapsed().as_secs_f64();
            let file = if job == "identify" { IDENTIFIED } else { GAP };
            Ok((read_json(&folder.join(file))?, seconds))
        };
        let identified = match self.diagnose_only {
            true => None,
            false => Some(answer("identify", "identify", &[])?),
        };
        let second = self.second.as_ref();
        let validate = second.map(|second| vec!["--validate".to_owned(), place(second)]);
        let gap = answer("diagnose", "diagnose", &validate.unwrap_or_default())?;
        let diagnosed = own.join("diagnose");
        let with_causes = match &identified {
            Some(_) if diagnosed.join("corrected.toml").exists() => {
                let gap = diagnosed.join(GAP).to_string_lossy().into_owned();
                let (result, _) = answer("identify", "with-causes", &["--with".to_owned(), gap])?;
                Some(result)
            }
            _ => None,
        };
        Ok(Ok(Answers {
            identified,
            gap,
            with_causes,
        }))
    }

    fn run<'a>(&self, program: &Path, arguments: impl Iterator<Item = &'a str>) -> Result<()> {
        said(Command::new(program).args(arguments)).with_context(|| self.name.clone())?;
        Ok(())
    }
}
