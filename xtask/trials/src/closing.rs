//! Whether the loop is closed: the device that a diagnosis corrects predicts a recording that it has not seen, and that
//! recording, diagnosed against it, has no gap. Nothing here knows a truth but the channels without noise that a
//! prediction is compared with.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result, anyhow};
use haptical::{Device, Identify, Log, Replayed, identify, replay};
use haptical_model::Device as Model;
use serde::Serialize;
use xtask_blind::{
    Answer, CleanChannels, Prediction, TrueReduction, channel_of, closed_percent, true_reductions,
};

use super::compiled;
use super::subject::{Answered, Given, guarded};

/// What a corrected device makes of a recording that it has not seen.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Closing {
    /// Effects that it has: `backlash@3`.
    pub(crate) effects: Vec<String>,
    /// Its predictions against those of the device refitted without causes, channel by channel.
    pub(crate) channels: BTreeMap<String, TrueReduction>,
    /// Share of the gap of all channels that is closed \[%\].
    pub(crate) closed_percent: Option<f64>,
    /// The C that is exported of it, in the place of `simulate --replay`; none where nothing can be compiled, or where the
    /// device has effects that no control loop sees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) by_c: Option<ByC>,
    /// The recording diagnosed against it.
    pub(crate) again: Answer,
}

/// What the exported C makes of a recording.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct ByC {
    /// Share of the gap of all channels that is closed by its predictions \[%\].
    pub(crate) closed_percent: Option<f64>,
    /// Largest difference from what `simulate --replay` predicts, over the largest prediction of the channel.
    pub(crate) apart: f64,
    /// Share of the predictions of `--replay` that the C refuses, as outside the range that a polynomial was fitted on; they are
    /// in no figure.
    pub(crate) refused_share: f64,
}

/// What is said of an effect that is asked for.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Fit {
    /// `backlash@3`.
    pub(crate) asked: String,
    /// Whether the recording is said to show it.
    pub(crate) shown: bool,
    pub(crate) why: String,
}

impl Given {
    /// Predicts and diagnoses the recording that was kept back; none where none was, or no device was corrected. `haptical` is
    /// the command that exports C.
    pub(crate) fn closing(
        &self,
        answered: &Answered,
        clean: &CleanChannels,
        haptical: Option<&Path>,
    ) -> Option<Result<Closing>> {
        let (fresh, corrected) = (self.fresh.as_ref()?, answered.corrected.as_ref()?);
        let closing = || {
            let nominal = self.nominal()?;
            let log = log(fresh.clone(), &nominal)?;
            let by = |model: &Model| {
                let mut device = nominal.clone();
                device.model = model.clone();
                replay(&device, &log)
            };
            let (before, after) = (by(&answered.base)?, by(corrected)?);
            let predicted = predictions(&before, &after);
            let channels = true_reductions(&predicted, clean);
            let noise = after.channels.iter();
            let noise = noise.map(|own| (own.channel.clone(), own.noise_floor));
            let noise: BTreeMap<String, f64> = noise.collect();
            let by_c = match haptical {
                Some(haptical) => compiled::predicted(corrected, fresh, haptical)?,
                None => None,
            };
            let by_c = by_c.map(|by_c| ByC::new(&by_c, predicted, clean, &noise));
            let again = self.again(fresh, corrected)?;
            Ok(Closing {
                effects: effects(corrected),
                closed_percent: closed_percent(&channels, &noise),
                channels,
                by_c,
                again: answer(&again)?,
            })
        };
        Some(guarded(closing))
    }

    /// Fits the effect that is asked for, where one is.
    pub(crate) fn fitted(&self) -> Option<Result<Fit>> {
        let asked = self.asked.as_ref()?;
        let asked = label(asked.effect, asked.joint);
        let fitted = || {
            let nominal = self.nominal()?;
            let log = log(self.log.clone(), &nominal)?;
            let options = Identify {
                with: vec![asked.clone()],
                ..Identify::default()
            };
            let found = identify(&nominal, &log, &options)?;
            // a coupling is asked from every other joint
            let entries = &found.result.effects;
            let entry = entries.iter().find(|entry| entry.shown).or(entries.first());
            let entry = entry.context("nothing is said of the effect")?;
            Ok(Fit {
                asked: asked.clone(),
                shown: entry.shown,
                why: entry.why.clone(),
            })
        };
        Some(guarded(fitted))
    }

    fn nominal(&self) -> Result<Device> {
        Ok(Device::from_toml(&self.device_toml, "device.toml")?)
    }
}

impl ByC {
    /// `predicted` is what `--replay` predicts.
    fn new(
        by_c: &compiled::Predicted,
        mut predicted: BTreeMap<String, Vec<Prediction>>,
        clean: &CleanChannels,
        noise_sd: &BTreeMap<String, f64>,
    ) -> Self {
        let mut apart: f64 = 0.0;
        let (mut refused, mut all) = (0_usize, 0_usize);
        predicted.retain(|name, _| by_c.channel(name).is_some());
        for (name, rows) in &mut predicted {
            let own = by_c.channel(name).unwrap_or_default();
            let all_rows = rows.len();
            all += all_rows;
            // a row that is not there is as far as can be
            let here = |row: usize| own.get(row).copied().unwrap_or(f64::INFINITY);
            rows.retain(|one| !here(one.row).is_nan());
            refused += all_rows - rows.len();
            let (mut largest, mut difference) = (0.0_f64, 0.0_f64);
            for one in rows {
                largest = largest.max(one.after.abs());
                difference = difference.max((here(one.row) - one.after).abs());
                one.after = here(one.row);
            }
            apart = apart.max(difference / largest.max(f64::MIN_POSITIVE));
        }
        Self {
            closed_percent: closed_percent(&true_reductions(&predicted, clean), noise_sd),
            apart,
            refused_share: refused as f64 / all.max(1) as f64,
        }
    }
}

fn log(recording: haptical_model::Recording, device: &Device) -> Result<Log> {
    Ok(Log::from_recording(recording, "log.csv", device)?)
}

/// What a gap.json says.
pub(crate) fn answer(gap_json: &str) -> Result<Answer> {
    Answer::from_json(gap_json).map_err(|error| anyhow!("gap.json cannot be read: {error:#}"))
}

/// `backlash@3`; the joint is from 1.
fn label(effect: &str, joint: Option<usize>) -> String {
    let joint = joint.map(|joint| format!("@{joint}"));
    format!("{effect}{}", joint.unwrap_or_default())
}

/// Effects of a device, joints that yield among them.
fn effects(device: &Model) -> Vec<String> {
    let own = device.effects.iter();
    let own = own.map(|effect| label(&effect.name, effect.joint.map(|joint| joint + 1)));
    let yielding =
        (0..device.joints.len()).filter(|&joint| device.compliance_rad_per_nm(joint) > 0.0);
    let yielding = yielding.map(|joint| label("joint-compliance", Some(joint + 1)));
    own.chain(yielding).collect()
}

/// What both devices predict for the same readings.
fn predictions(before: &Replayed, after: &Replayed) -> BTreeMap<String, Vec<Prediction>> {
    let by_channel = after.channels.iter().filter_map(|own| {
        let mut others = before.channels.iter();
        let other = others.find(|other| other.channel == own.channel)?;
        let first = other.residuals.iter();
        let first: BTreeMap<usize, f64> = first.map(|(row, axes)| (*row, axes[0])).collect();
        let all = own.residuals.iter().filter_map(|(row, axes)| {
            let measured = value(after, &own.channel, *row)? - axes[0];
            Some(Prediction {
                row: *row,
                before: measured + first.get(row)?,
                after: measured + axes[0],
            })
        });
        Some((own.channel.clone(), all.collect()))
    });
    by_channel.collect()
}

/// What is predicted for a reading of an external encoder or a cable.
fn value(replayed: &Replayed, channel: &str, row: usize) -> Option<f64> {
    let predicted = &replayed.predicted;
    let column = channel_of(channel, &predicted.output, &predicted.cable_m)?;
    column.as_ref()?.get(row).copied()
}
