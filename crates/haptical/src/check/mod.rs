//! Judges what a log could identify, at the device as it is given. A fit to a part of the log shows mistaken columns alone.

mod commands;
mod text;
mod torques;

use haptical_calibration::{
    CalibrationError, Channel, HeldOut, Options, TransmissionFit, TransmissionTerms, Weights,
    candidate_parameters, channels, check_columns, check_rig, check_stands, fit_transmissions,
    held_for_scale, identifiability_at, prepare_device, split,
};
use haptical_model::{
    Device as Model, ParameterId, Recording, TransmissionError, TransmissionKind,
};
use serde::Serialize;

use crate::device::Device;
use crate::error::Error;
use crate::identify::{Identify, NotIdentified, RankEntry};
use crate::log::Log;

/// A device and a log, described. It prints as the command prints it.
#[derive(Debug, Clone, Serialize)]
pub struct Checked {
    /// The device.
    pub device: CheckedDevice,
    /// The log; none where none was given.
    pub log: Option<CheckedLog>,
    /// What is odd about both.
    pub warnings: Vec<String>,
    /// Which row each number in a parameter's name stands for, where the joints have names of their own; else empty.
    #[serde(skip)]
    named_rows: String,
}

/// A device file.
#[derive(Debug, Clone, Serialize)]
pub struct CheckedDevice {
    /// Its name in results.
    pub file: String,
    /// Name of the device.
    pub name: String,
    /// Number of links.
    pub links: usize,
    /// Number of cable encoders.
    pub cables: usize,
    /// The joints.
    pub joints: Vec<CheckedJoint>,
}

/// A joint; its ranges in rad, or in m where it slides.
#[derive(Debug, Clone, Serialize)]
pub struct CheckedJoint {
    /// Number, from 1.
    pub joint: usize,
    /// Name.
    pub name: String,
    /// `rad` or `m`.
    pub unit: &'static str,
    /// `capstan`, `parallelogram` or `direct`.
    pub transmission: &'static str,
    /// Transmission ratio.
    pub ratio: f64,
    /// Lower limit from home; none where the file gives none.
    pub lower: Option<f64>,
    /// Upper limit.
    pub upper: Option<f64>,
    /// Smallest and largest reading of the log.
    pub readings: Option<[f64; 2]>,
}

/// A log.
#[derive(Debug, Clone, Serialize)]
pub struct CheckedLog {
    /// Its name in results.
    pub file: String,
    /// Number of rows.
    pub rows: usize,
    /// Number of runs.
    pub runs: usize,
    /// Mean rate within runs \[Hz\]; none without times.
    pub rate_hz: Option<f64>,
    /// The measured channels.
    pub channels: Vec<CheckedChannel>,
    /// Columns that identification does not use.
    pub covariates: Vec<String>,
    /// Rank and conditioning at the device as it is given.
    pub identifiability: RankEntry,
    /// Names of parameters that the log fixes.
    pub identifiable: Vec<String>,
    /// The others.
    pub not_identified: Vec<NotIdentified>,
    /// Of a log that nothing can be identified from, what a diagnosis can ask of it, a sentence each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub good_for: Vec<String>,
}

/// A measured channel.
#[derive(Debug, Clone, Serialize)]
pub struct CheckedChannel {
    /// Name.
    pub channel: String,
    /// SI unit.
    pub unit: &'static str,
    /// Number of readings.
    pub readings: usize,
}

/// Status of a length that a fit holds because no measurement tells the device's size.
const HELD: &str = "held";
/// Degree of a parallelogram's polynomial (the paper's) where the log has readings enough for it.
const DEGREE: usize = 10;
const DEGREE_OF_FEW: usize = 2;
const READINGS_FOR_DEGREE: usize = 200;
/// Below this many rows an identification is checked by folds, and fitted to all rows.
const SHORT_LOG: usize = 100;
/// Terms of equation (1) that a joint without drums can have: offset, ratio, output eccentricity.
const TERMS_WITHOUT_DRUMS: usize = 4;

/// Describes a device, and what [`identify`](crate::identify()) with `request` could identify of it from a log.
///
/// ```
/// use haptical::prelude::*;
/// # let fixtures = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures");
/// # std::env::set_current_dir(fixtures)?;
/// let device = Device::load("devices/haptic7.toml")?;
/// let log = Log::read("logs/haptic7-sample.csv", &device)?;
/// let found = check(&device, Some(&log), &Identify::default())?;
/// println!("{found}"); // what `haptical check` prints
/// let log = found.log.ok_or("no log")?;
/// assert!(log.identifiable.iter().any(|name| name == "alpha3"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ErrorKind::Unidentifiable`](crate::ErrorKind) where the log fixes nothing; a log that does not belong to the
/// device; an unknown name in [`Identify::hold`] or [`Identify::deviations`].
pub fn check(device: &Device, log: Option<&Log>, request: &Identify) -> Result<Checked, Error> {
    let mut model = device.model.clone();
    request.hold(&mut model)?;
    let mut warnings = device.warnings.clone();
    let source = device.source();
    let found = log.map(|log| {
        warnings.extend(log.warnings.iter().cloned());
        let place = log.source();
        if let Some(found) = torques::torques_alone(&model, &log.recording, &place.label) {
            return Ok(found);
        }
        if let Some(found) = commands::commands_alone(&model, &log.recording, &place.label) {
            return Ok(found);
        }
        let found = checked_log(&model, &log.recording, &request.options, &place.label);
        found.map_err(|error| {
            Error::calibration(&error, &source.path, &place.path).with_equipment(device)
        })
    });
    Ok(Checked {
        log: found.transpose()?,
        device: checked_device(&model, log, source.label.clone()),
        warnings,
        named_rows: device.named_rows(),
    })
}

fn checked_device(device: &Model, log: Option<&Log>, file: String) -> CheckedDevice {
    let joints = device.joints.iter().enumerate();
    let joints = joints.map(|(index, joint)| CheckedJoint {
        joint: index + 1,
        name: joint.name.clone(),
        unit: joint.unit(),
        transmission: match joint.transmission {
            TransmissionKind::Capstan => "capstan",
            TransmissionKind::Parallelogram => "parallelogram",
            TransmissionKind::Direct => "direct",
        },
        ratio: joint.transmission_ratio,
        lower: Some(joint.lower_rad).filter(|limit| limit.is_finite()),
        upper: Some(joint.upper_rad).filter(|limit| limit.is_finite()),
        readings: log.map(|log| range(&log.recording.joint[index])),
    });
    CheckedDevice {
        file,
        name: device.name.clone(),
        links: device.links.len(),
        cables: device.cables.len(),
        joints: joints.collect(),
    }
}

fn checked_log(
    device: &Model,
    recording: &Recording,
    options: &Options,
    file: &str,
) -> Result<CheckedLog, CalibrationError> {
    let channels = channels(device, recording)?;
    check_rig(device, recording)?;
    check_stands(device, recording)?;
    check_columns(device, recording)?;
    let prepared = prepare_device(device, recording)?;
    let device = &prepared;
    let (device, mut parameters, unsupported) = candidates(device, recording, &channels, options);
    let held = held_for_scale(&device, recording, &channels);
    parameters.retain(|parameter| !held.contains(parameter));
    let weights = Weights::stated(&device, &channels);
    let rules = &options.rules;
    // where the samples support none of the forms that could be freed, nothing is to be judged
    let judged = match parameters.is_empty() && !unsupported.is_empty() {
        true => None,
        false => {
            let judged =
                identifiability_at(&device, recording, &channels, &parameters, &weights, rules);
            Some(judged?)
        }
    };
    let mut identifiable = Vec::new();
    let kept = |parameter: &ParameterId, why: &str| {
        let name = parameter.name(&device);
        NotIdentified {
            status: HELD,
            reason: format!("{name}{why}"),
            name,
        }
    };
    let scale = ": touches of unknown points and planes do not tell a device from a larger one: it is held, and the other lengths \
                 are in proportion to it";
    let form = " is held: the samples support a form without it";
    let held = held.iter().map(|parameter| kept(parameter, scale));
    let unsupported = unsupported.iter().map(|parameter| kept(parameter, form));
    let mut not_identified: Vec<NotIdentified> = held.chain(unsupported).collect();
    if let Some(judged) = &judged {
        for (index, (name, status)) in judged.names.iter().zip(&judged.statuses).enumerate() {
            match judged.reason(index) {
                None => identifiable.push(name.clone()),
                Some(reason) => not_identified.push(NotIdentified {
                    name: name.clone(),
                    status: status.name(),
                    reason,
                }),
            }
        }
    }
    if identifiable.is_empty() && judged.is_some() {
        let reasons = not_identified.iter().take(3);
        let reasons: Vec<&str> = reasons.map(|refused| refused.reason.as_str()).collect();
        return Err(CalibrationError::NothingIdentifiable {
            what: "at the nominal device".to_owned(),
            reason: reasons.join("; "),
        });
    }
    let readings = |channel: &Channel| {
        let rows = 0..recording.len();
        rows.filter(|&row| channel.has_reading(recording, row))
            .count()
    };
    // homing fixtures are channels too
    let is_channel = |name: &str| {
        let names = channels.iter().map(|channel| channel.name());
        let mut prefixes = names.map(|name| format!("{name}_"));
        prefixes.any(|prefix| name.starts_with(&prefix))
    };
    let covariates = recording.covariates.iter().map(|(name, _)| name);
    let covariates = covariates.filter(|name| !is_channel(name));
    let channels = channels.iter().map(|channel| CheckedChannel {
        channel: channel.name(),
        unit: channel.unit(&device),
        readings: readings(channel),
    });
    Ok(CheckedLog {
        channels: channels.collect(),
        covariates: covariates.cloned().collect(),
        identifiability: RankEntry {
            candidates: identifiable.len() + not_identified.len(),
            ..RankEntry::from_judgements(judged.iter())
        },
        identifiable,
        not_identified,
        ..CheckedLog::of_rows(file, recording)
    })
}

/// What an identification from these channels could free, what of it the samples do not support, and the device with the
/// forms of transmission errors that they do support: links where a channel sees the chain, and the drives as
/// [`identify`](crate::identify()) takes them. What a form adds is zero as long as the device file says nothing of it.
fn candidates(
    device: &Model,
    recording: &Recording,
    channels: &[Channel],
    options: &Options,
) -> (Model, Vec<ParameterId>, Vec<ParameterId>) {
    let mut device = device.clone();
    let sees_chain = channels.iter().any(|channel| channel.sees_chain());
    let mut parameters = match sees_chain {
        true => candidate_parameters(&device),
        false => Vec::new(),
    };
    let mut unsupported = Vec::new();
    let forms = forms(&device, recording, channels, options);
    for joint in 0..device.joints.len() {
        let has_output = channels.contains(&Channel::Output { joint });
        let kind = device.joints[joint].transmission;
        if !has_output && (kind != TransmissionKind::Capstan || !sees_chain) {
            continue;
        }
        let form = forms.iter().find(|form| form.joint == joint);
        let terms = form.map(|form| form.terms);
        let degree = match terms {
            Some(TransmissionTerms::Polynomial(degree)) => Some(degree),
            _ => None,
        };
        let has_no_error = device.joints[joint].transmission_error == TransmissionError::default();
        if kind == TransmissionKind::Parallelogram && has_no_error {
            let few = recording.len() < READINGS_FOR_DEGREE;
            let usual = if few { DEGREE_OF_FEW } else { DEGREE };
            device.joints[joint].transmission_error = TransmissionError::Chebyshev {
                range_rad: range(&recording.joint[joint]),
                coefficients: vec![0.0; degree.unwrap_or(usual) + 1],
            };
        }
        let has_drums = device.joints[joint].drum_distance_m.is_some();
        let error = &device.joints[joint].transmission_error;
        let mut own = device.transmission_parameters(joint);
        if matches!(error, TransmissionError::Capstan(_)) && !has_drums {
            own.truncate(TERMS_WITHOUT_DRUMS);
        }
        if let Some(terms) = terms {
            let lacking = terms.unsupported_parameters(kind);
            let is_lacking = |parameter: &ParameterId| matches!(parameter, ParameterId::Transmission { index, .. } if lacking.contains(index));
            unsupported.extend(own.iter().copied().filter(is_lacking));
            own.retain(|parameter| !is_lacking(parameter));
        }
        parameters.extend(own);
    }
    (device, parameters, unsupported)
}

/// The forms of transmission errors that the rows of a fit support; none where they cannot be fitted, which the fit itself
/// then says.
fn forms(
    device: &Model,
    recording: &Recording,
    channels: &[Channel],
    options: &Options,
) -> Vec<TransmissionFit> {
    // folds are a check of a fit to all rows
    let held_out = match options.held_out {
        HeldOut::Share(share) if recording.len() >= SHORT_LOG => HeldOut::Share(share),
        _ => HeldOut::None,
    };
    let part = split(recording, held_out);
    let fitted = part.map(|part| recording.select(&part.fit));
    let rows = fitted.as_ref().unwrap_or(recording);
    let weights = Weights::stated(device, channels);
    let found = fit_transmissions(device, rows, channels, &weights, options);
    found.map_or_else(|_| Vec::new(), |(_, forms)| forms)
}

/// Smallest and largest reading.
fn range(readings: &[f64]) -> [f64; 2] {
    let low = readings.iter().copied().fold(f64::INFINITY, f64::min);
    let high = readings.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    [low, high]
}

impl CheckedLog {
    /// What the rows alone say.
    fn of_rows(file: &str, recording: &Recording) -> Self {
        let runs = recording.run.iter().flat_map(|run| run.windows(2));
        Self {
            file: file.to_owned(),
            rows: recording.len(),
            runs: 1 + runs.filter(|pair| pair[0] != pair[1]).count(),
            rate_hz: rate_hz(recording),
            channels: Vec::new(),
            covariates: Vec::new(),
            identifiability: RankEntry::default(),
            identifiable: Vec::new(),
            not_identified: Vec::new(),
            good_for: Vec::new(),
        }
    }
}

/// Steps over the time that they take, steps between runs left out.
fn rate_hz(recording: &Recording) -> Option<f64> {
    let times = recording.time_s.as_ref()?;
    let run = recording.run.as_ref();
    let same_run = |row: usize| run.is_none_or(|run| run[row] == run[row + 1]);
    let (mut steps, mut seconds) = (0_usize, 0.0);
    for (row, pair) in times.windows(2).enumerate() {
        let step = pair[1] - pair[0];
        if same_run(row) && step.is_finite() {
            steps += 1;
            seconds += step;
        }
    }
    (seconds > 0.0).then(|| steps as f64 / seconds)
}
