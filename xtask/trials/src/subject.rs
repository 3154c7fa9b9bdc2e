//! The diagnosis under trial: what it is given of a trial, and its answer. Nothing here knows a truth.

use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use anyhow::{Context, Result, anyhow, bail};
use haptical_diagnosis::{Diagnosis, Options, diagnose};
use haptical_model::{Device, Recording};
use xtask_blind::{Asked, Prediction, Suite, Trial};

/// All that a diagnosis may see of a trial.
#[derive(Debug)]
pub(crate) struct Given {
    pub(crate) device: Device,
    /// What is said of its file.
    warnings: Vec<String>,
    /// Why device file or log were not read.
    refused: Option<String>,
    /// The text of its file.
    pub(crate) device_toml: String,
    pub(crate) log: Recording,
    /// The second recording, to measure the shrink on.
    log2: Recording,
    /// A second recording that is kept back until there is an answer.
    pub(crate) fresh: Option<Recording>,
    without: Vec<String>,
    model: Option<Device>,
    /// An effect to be fitted.
    pub(crate) asked: Option<Asked>,
}

/// An answer, fixed.
#[derive(Debug)]
pub(crate) struct Answered {
    pub(crate) gap_json: String,
    /// predictions.csv of the second recording, channel by channel.
    pub(crate) predictions: BTreeMap<String, Vec<Prediction>>,
    /// Time that the diagnosis took \[s\].
    pub(crate) time_s: f64,
    /// The device refitted without causes.
    pub(crate) base: Device,
    /// The device refitted together with them, where they are part of one.
    pub(crate) corrected: Option<Device>,
}

impl Given {
    /// What of `trial`, one of `suite`, is given away.
    pub(crate) fn from_trial(suite: Suite, trial: &Trial) -> Result<Self> {
        let model = trial.model_toml.as_ref();
        let model = model.map(|text| Device::from_toml(text, "model"));
        let model = model.transpose().context("the model of an ablation")?;
        let mut log2 = trial.log2.clone();
        let read = suite.is_of_admission().then(|| read(trial));
        let own = || (trial.device.clone(), Vec::new());
        let ((device, warnings), refused) = match read {
            Some(Err(error)) => (own(), Some(error.to_string())),
            Some(Ok(read)) => (read, None),
            None => (own(), None),
        };
        let is_kept = suite.keeps_second_back();
        let fresh = is_kept.then(|| std::mem::take(&mut log2));
        Ok(Self {
            device,
            warnings,
            refused,
            device_toml: trial.device_toml.clone(),
            log: trial.log.clone(),
            log2,
            fresh,
            without: trial.without.clone(),
            model: model.map(|file| file.device),
            asked: trial.asked.clone(),
        })
    }

    /// A recording that belongs to no trial.
    pub(crate) fn alone(device: Device, log: Recording) -> Self {
        Self {
            device,
            warnings: Vec::new(),
            refused: None,
            device_toml: String::new(),
            log,
            log2: Recording::default(),
            fresh: None,
            without: Vec::new(),
            model: None,
            asked: None,
        }
    }

    /// Diagnoses; an error or a panic of the diagnosis is text.
    pub(crate) fn answer(&self) -> Result<Answered> {
        let options = Options {
            without: self.without.clone(),
            model: self.model.as_ref(),
            validation: (!self.log2.is_empty()).then_some(&self.log2),
            ..Options::default()
        };
        if let Some(refused) = &self.refused {
            bail!("{refused}");
        }
        let start = Instant::now();
        let mut diagnosis = diagnosis(&self.device, &self.log, &options)?;
        diagnosis.warnings.extend(self.warnings.iter().cloned());
        let time_s = start.elapsed().as_secs_f64();
        let gap_json = gap_json(&diagnosis)?;
        let mut predictions: BTreeMap<String, Vec<Prediction>> = BTreeMap::new();
        for one in diagnosis.predictions {
            let rows = predictions.entry(one.channel).or_default();
            rows.push(Prediction {
                row: one.row,
                before: one.before,
                after: one.after,
            });
        }
        Ok(Answered {
            gap_json,
            predictions,
            time_s,
            base: diagnosis.device,
            // a curve in the place of a cause that is unknown closes a gap without an answer
            corrected: (diagnosis.corrected).filter(|_| diagnosis.correction.is_none()),
        })
    }

    /// gap.json of the recording that was kept back, diagnosed against a model.
    pub(crate) fn again(&self, fresh: &Recording, model: &Device) -> Result<String> {
        let options = Options {
            without: self.without.clone(),
            model: Some(model),
            ..Options::default()
        };
        gap_json(&diagnosis(&self.device, fresh, &options)?)
    }
}

/// The device as its file has it, read as a user's is, with both logs, and what is said of the file.
fn read(trial: &Trial) -> Result<(Device, Vec<String>)> {
    let device = haptical::Device::from_toml(&trial.device_toml, "device.toml")?;
    for (log, name) in [(&trial.log, "log.csv"), (&trial.log2, "log2.csv")] {
        haptical::Log::from_recording(log.clone(), name, &device)?;
    }
    Ok((device.model, device.warnings))
}

fn gap_json(diagnosis: &Diagnosis) -> Result<String> {
    serde_json::to_string(diagnosis).map_err(|error| anyhow!("gap.json cannot be written: {error}"))
}

/// A diagnosis; its error or its panic is text.
fn diagnosis(device: &Device, log: &Recording, options: &Options<'_>) -> Result<Diagnosis> {
    guarded(|| match diagnose(device, log, options) {
        Err(error) if error.is_unidentifiable() => bail!("not identifiable: {error}"),
        outcome => Ok(outcome?),
    })
}

/// The outcome of `work`; a panic of it is an error.
pub(crate) fn guarded<T>(work: impl FnOnce() -> Result<T>) -> Result<T> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let said = panic.downcast_ref::<String>().map(String::as_str);
        let said = said.or_else(|| panic.downcast_ref::<&str>().copied());
        bail!("panic: {}", said.unwrap_or("without words"))
    })
}
