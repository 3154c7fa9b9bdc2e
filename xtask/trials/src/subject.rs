//! The diagnosis under trial: what it is given of a trial, and its answer. Nothing here knows a truth.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use anyhow::{Context, Result};
use haptical_diagnosis::{Options, diagnose};
use haptical_model::{Device, Recording};
use xtask_blind::{Prediction, Trial};

/// All that a diagnosis may see of a trial.
#[derive(Debug)]
pub(crate) struct Given {
    device: Device,
    log: Recording,
    log2: Recording,
    without: Vec<String>,
    model: Option<Device>,
}

/// An answer, fixed.
#[derive(Debug)]
pub(crate) struct Answered {
    /// gap.json.
    pub(crate) gap_json: String,
    /// predictions.csv of the second recording, channel by channel.
    pub(crate) predictions: BTreeMap<String, Vec<Prediction>>,
    /// Time that the diagnosis took \[s\].
    pub(crate) time_s: f64,
}

impl Given {
    /// What of `trial` is given away.
    pub(crate) fn from_trial(trial: &Trial) -> Result<Self> {
        let model = match &trial.model_toml {
            Some(text) => {
                let file = Device::from_toml(text, "model").context("the model of an ablation")?;
                Some(file.device)
            }
            None => None,
        };
        Ok(Self {
            device: trial.device.clone(),
            log: trial.log.clone(),
            log2: trial.log2.clone(),
            without: trial.without.clone(),
            model,
        })
    }

    /// A recording that belongs to no trial.
    pub(crate) fn alone(device: Device, log: Recording) -> Self {
        Self {
            device,
            log,
            log2: Recording::default(),
            without: Vec::new(),
            model: None,
        }
    }

    /// Rows of the recording.
    pub(crate) fn rows(&self) -> usize {
        self.log.len()
    }

    /// Diagnoses; an error or a panic of the diagnosis is text.
    pub(crate) fn answer(&self) -> Result<Answered, String> {
        self.diagnosed((!self.log2.is_empty()).then_some(&self.log2))
    }

    fn diagnosed(&self, validation: Option<&Recording>) -> Result<Answered, String> {
        let options = Options {
            without: self.without.clone(),
            model: self.model.as_ref(),
            validation,
            ..Options::default()
        };
        let start = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            diagnose(&self.device, &self.log, &options)
        }));
        let time_s = start.elapsed().as_secs_f64();
        let diagnosis = match outcome {
            Ok(Ok(diagnosis)) => diagnosis,
            Ok(Err(error)) if error.is_unidentifiable() => {
                return Err(format!("not identifiable: {error}"));
            }
            Ok(Err(error)) => return Err(error.to_string()),
            Err(panic) => {
                let said = panic.downcast_ref::<String>().map(String::as_str);
                let said = said.or_else(|| panic.downcast_ref::<&str>().copied());
                return Err(format!("panic: {}", said.unwrap_or("without words")));
            }
        };
        let gap_json = serde_json::to_string(&diagnosis)
            .map_err(|error| format!("gap.json cannot be written: {error}"))?;
        let mut predictions: BTreeMap<String, Vec<Prediction>> = BTreeMap::new();
        for one in diagnosis.predictions {
            predictions
                .entry(one.channel)
                .or_default()
                .push(Prediction {
                    row: one.row,
                    before: one.before,
                    after: one.after,
                });
        }
        Ok(Answered {
            gap_json,
            predictions,
            time_s,
        })
    }
}
