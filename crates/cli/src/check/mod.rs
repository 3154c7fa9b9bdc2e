//! `haptical check`: validate a device file and a log, and say what the log could identify.

mod text;

use haptical::files::Source;
use haptical::{Identify, Log, NotIdentified, RankEntry};
use haptical_calibration::{
    CalibrationError, Channel, Options, Weights, candidate_parameters, channels, check_rig,
    held_for_scale, identifiability_at, prepare_device,
};
use haptical_model::{
    Device, JointType, ParameterId, Recording, TransmissionError, TransmissionKind,
};
use serde::Serialize;

use crate::arguments::CheckArguments;
use crate::failure::Failure;
use crate::terminal;
use crate::terminal::Progress;

/// What the check found.
#[derive(Debug, Serialize)]
pub(crate) struct Findings {
    pub(crate) device: DeviceFindings,
    pub(crate) log: Option<LogFindings>,
    pub(crate) warnings: Vec<String>,
}

#[derive(Debug, Serialize)]
pub(crate) struct DeviceFindings {
    pub(crate) file: String,
    pub(crate) name: String,
    pub(crate) links: usize,
    pub(crate) cables: usize,
    pub(crate) joints: Vec<JointFindings>,
}

#[derive(Debug, Serialize)]
pub(crate) struct JointFindings {
    pub(crate) joint: usize,
    pub(crate) name: String,
    pub(crate) unit: &'static str,
    pub(crate) transmission: &'static str,
    pub(crate) ratio: f64,
    /// Limits from home; none where the file gives none.
    pub(crate) lower: Option<f64>,
    pub(crate) upper: Option<f64>,
    /// Smallest and largest reading of the log.
    pub(crate) readings: Option<[f64; 2]>,
}

#[derive(Debug, Serialize)]
pub(crate) struct LogFindings {
    pub(crate) file: String,
    pub(crate) rows: usize,
    pub(crate) runs: usize,
    /// Mean rate within runs; none without times.
    pub(crate) rate_hz: Option<f64>,
    pub(crate) channels: Vec<ChannelFindings>,
    /// Columns that identification does not use.
    pub(crate) covariates: Vec<String>,
    pub(crate) identifiability: RankEntry,
    pub(crate) identifiable: Vec<String>,
    pub(crate) not_identified: Vec<NotIdentified>,
}

#[derive(Debug, Serialize)]
pub(crate) struct ChannelFindings {
    pub(crate) channel: String,
    pub(crate) unit: &'static str,
    pub(crate) readings: usize,
}

/// Status of a length that a fit holds because no measurement tells the device's size.
const HELD: &str = "held";
/// Degree of a parallelogram's polynomial (the paper's) where the log has readings enough for it.
const DEGREE: usize = 10;
const DEGREE_OF_FEW: usize = 2;
const READINGS_FOR_DEGREE: usize = 200;
/// Terms of equation (1) that a joint without drums can have: offset, ratio, output eccentricity.
const TERMS_WITHOUT_DRUMS: usize = 4;

/// Runs the command.
pub(crate) fn run(arguments: &CheckArguments) -> Result<(), Failure> {
    let progress = Progress::start("checking");
    let options = &arguments.device_options;
    let mut device = options.read_by_path(&arguments.device)?;
    let held = Identify {
        hold: arguments.hold.hold(),
        deviations: arguments.hold.deviations(),
        ..Identify::default()
    };
    held.hold(&mut device.model)?;
    let mut warnings = device.warnings.clone();
    let (recording, log) = match &arguments.log {
        None => (None, None),
        Some(path) => {
            let log = Log::open(&Source::by_path(path), &device)?;
            warnings.extend(log.warnings);
            let file = path.display().to_string();
            let found = look_at_log(&device.model, &log.recording, file).map_err(|error| {
                Failure::calibration(&error, &arguments.device, path).with_equipment(&device)
            })?;
            (Some(log.recording), Some(found))
        }
    };
    let file = arguments.device.display().to_string();
    let findings = Findings {
        device: look_at_device(&device.model, recording.as_ref(), file),
        log,
        warnings,
    };
    drop(progress);
    terminal::warn(&findings.warnings);
    let said = if arguments.json {
        let mut json = serde_json::to_string_pretty(&findings).map_err(Failure::internal)?;
        json.push('\n');
        json
    } else {
        text::text(&findings)?
    };
    terminal::write_output(said.as_bytes())
}

fn look_at_device(device: &Device, recording: Option<&Recording>, file: String) -> DeviceFindings {
    let joints = device
        .joints
        .iter()
        .enumerate()
        .map(|(index, joint)| JointFindings {
            joint: index + 1,
            name: joint.name.clone(),
            unit: match joint.joint_type {
                JointType::Revolute => "rad",
                JointType::Prismatic => "m",
            },
            transmission: match joint.transmission {
                TransmissionKind::Capstan => "capstan",
                TransmissionKind::Parallelogram => "parallelogram",
                TransmissionKind::Direct => "direct",
            },
            ratio: joint.transmission_ratio,
            lower: Some(joint.lower_rad).filter(|limit| limit.is_finite()),
            upper: Some(joint.upper_rad).filter(|limit| limit.is_finite()),
            readings: recording.map(|recording| range(&recording.joint[index])),
        })
        .collect();
    DeviceFindings {
        file,
        name: device.name.clone(),
        links: device.links.len(),
        cables: device.cables.len(),
        joints,
    }
}

fn look_at_log(
    device: &Device,
    recording: &Recording,
    file: String,
) -> Result<LogFindings, CalibrationError> {
    let channels = channels(device, recording)?;
    check_rig(device, recording)?;
    let prepared = prepare_device(device, recording)?;
    let device = &prepared;
    let (device, mut parameters) = candidates(device, recording, &channels);
    let held = held_for_scale(&device, recording, &channels);
    parameters.retain(|parameter| !held.contains(parameter));
    let weights = Weights::stated(&device, &channels);
    let rules = Options::default().rules;
    let judged = identifiability_at(&device, recording, &channels, &parameters, &weights, &rules)?;
    let mut identifiable = Vec::new();
    let mut not_identified: Vec<NotIdentified> = held
        .iter()
        .map(|parameter| NotIdentified {
            name: parameter.name(&device),
            status: HELD,
            reason: format!(
                "{}: touches of unknown points and planes do not tell a device from a larger one: it is held, and \
                 the other lengths are in proportion to it",
                parameter.name(&device)
            ),
        })
        .collect();
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
    if identifiable.is_empty() {
        let reasons: Vec<String> = not_identified
            .iter()
            .take(3)
            .map(|refused| refused.reason.clone())
            .collect();
        return Err(CalibrationError::NothingIdentifiable {
            what: "at the nominal device".to_owned(),
            reason: reasons.join("; "),
        });
    }
    let readings = |channel: &Channel| {
        (0..recording.len())
            .filter(|&row| channel.has_reading(recording, row))
            .count()
    };
    Ok(LogFindings {
        file,
        rows: recording.len(),
        runs: run_count(recording),
        rate_hz: rate_hz(recording),
        channels: channels
            .iter()
            .map(|channel| ChannelFindings {
                channel: channel.name(),
                unit: channel.unit(&device),
                readings: readings(channel),
            })
            .collect(),
        covariates: recording
            .covariates
            .iter()
            .map(|(name, _)| name.clone())
            // homing fixtures are channels too
            .filter(|name| {
                channels
                    .iter()
                    .all(|channel| !name.starts_with(&format!("{}_", channel.name())))
            })
            .collect(),
        identifiability: RankEntry::from_judgements(std::iter::once(&judged)),
        identifiable,
        not_identified,
    })
}

/// What an identification from these channels could free: links where a channel sees the chain,
/// equation (1) of capstans, and of the others what their external encoder shows.
fn candidates(
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
) -> (Device, Vec<ParameterId>) {
    let mut device = device.clone();
    let sees_chain = channels.iter().any(|channel| channel.sees_chain());
    let mut parameters = if sees_chain {
        candidate_parameters(&device)
    } else {
        Vec::new()
    };
    for joint in 0..device.joints.len() {
        let has_output = channels.contains(&Channel::Output { joint });
        let kind = device.joints[joint].transmission;
        if !has_output && (kind != TransmissionKind::Capstan || !sees_chain) {
            continue;
        }
        let has_no_error = device.joints[joint].transmission_error == TransmissionError::default();
        if kind == TransmissionKind::Parallelogram && has_no_error {
            let few = recording.len() < READINGS_FOR_DEGREE;
            let degree = if few { DEGREE_OF_FEW } else { DEGREE };
            device.joints[joint].transmission_error = TransmissionError::Chebyshev {
                range_rad: range(&recording.joint[joint]),
                coefficients: vec![0.0; degree + 1],
            };
        }
        let has_drums = device.joints[joint].drum_distance_m.is_some();
        let is_equation = matches!(
            device.joints[joint].transmission_error,
            TransmissionError::Capstan(_)
        );
        let all = device.transmission_parameters(joint);
        let count = if is_equation && !has_drums {
            TERMS_WITHOUT_DRUMS
        } else {
            all.len()
        };
        parameters.extend(all.into_iter().take(count));
    }
    (device, parameters)
}

/// Smallest and largest reading.
fn range(readings: &[f64]) -> [f64; 2] {
    let low = readings.iter().copied().fold(f64::INFINITY, f64::min);
    let high = readings.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    [low, high]
}

fn run_count(recording: &Recording) -> usize {
    match &recording.run {
        None => 1,
        Some(run) => 1 + run.windows(2).filter(|pair| pair[0] != pair[1]).count(),
    }
}

/// Steps over the time that they take, steps between runs left out.
fn rate_hz(recording: &Recording) -> Option<f64> {
    let times = recording.time_s.as_ref()?;
    let same_run = |row: usize| {
        recording
            .run
            .as_ref()
            .is_none_or(|run| run[row] == run[row + 1])
    };
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
