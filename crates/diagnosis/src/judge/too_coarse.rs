//! Noise that the device file states far too large: what the model leaves refutes it, and a gap below it would pass
//! for noise (docs/diagnosis.md, "Noise").

use std::f64::consts::TAU;

use haptical_calibration::Channel;
use haptical_model::{Device, Recording};

use crate::Result;
use crate::answer::{CauseAnswer, Diagnosis, noise_level};
use crate::engine::{Base, Prepared};
use crate::noise::{is_stated, smallest_step};
use crate::thresholds::noise::{
    ARITHMETIC_COUNTS, COMPUTED, FINER_COUNTS, REFUTED, REFUTING_FREEDOM,
};

/// A channel whose residual is far below its stated noise.
#[derive(Debug, Clone)]
struct Refuted {
    channel: Channel,
    unit: &'static str,
    /// Root mean square of what the model leaves.
    left: f64,
    /// Stated noise, rounding included.
    stated: f64,
}

/// A device file's noise, corrected by what a recording shows of it.
#[derive(Debug)]
pub(crate) struct Corrected {
    pub(crate) device: Device,
    refuted: Vec<Refuted>,
    warnings: Vec<String>,
}

impl Corrected {
    /// The noise of every channel whose residual refutes it; none where nothing refutes the stated noise.
    pub(crate) fn new(
        nominal: &Device,
        base: &Base,
        recording: &Recording,
    ) -> Result<Option<Self>> {
        let refuted = refuted(base, recording)?;
        if refuted.is_empty() {
            return Ok(None);
        }
        let mut device = nominal.clone();
        let mut warnings = finer_counts(&mut device, recording, &refuted);
        let counts_did_it = !warnings.is_empty();
        for channel in &refuted {
            if channel.left < COMPUTED * channel.stated {
                warnings.push(format!(
                    "{}: the model leaves no noise at all: the column was computed from others, not measured, so \
                     that it can show no gap",
                    channel.channel.name()
                ));
            } else if !counts_did_it {
                warnings.extend(finer_noise(&mut device, channel));
            }
        }
        Ok(Some(Self {
            device,
            refuted,
            warnings,
        }))
    }

    /// Says in the answer what was wrong.
    pub(crate) fn report(&self, answer: &mut Diagnosis, without: &[String]) {
        answer.warnings.splice(0..0, self.warnings.iter().cloned());
        for channel in &self.refuted {
            let name = channel.channel.name();
            // what is left may hold a gap: the noise is what the diagnosis found it to be
            let mut gaps = answer.gap.channels.iter();
            let noise = gaps
                .find(|gap| gap.channel == name)
                .map(|gap| gap.noise_floor);
            let ratio = noise.unwrap_or(channel.left).min(channel.stated) / channel.stated;
            let joint = match channel.channel {
                Channel::Output { joint } => Some(joint),
                _ => None,
            };
            for noise in &mut answer.noise {
                if noise.channel.split('.').next() == Some(name.as_str()) {
                    noise.ratio = ratio;
                    "the log, far below the device file".clone_into(&mut noise.from);
                }
            }
            let finding: CauseAnswer = noise_level(joint, ratio, 0.1 * ratio);
            if !without.contains(&finding.effect) {
                answer.causes.push(finding);
            }
        }
    }
}

/// Channels with enough readings that leave less than half of their stated noise.
fn refuted(base: &Base, recording: &Recording) -> Result<Vec<Refuted>> {
    let prepared = Prepared::new(base, recording, recording)?;
    let parameters = base.free.len() as f64;
    let mut found = Vec::new();
    for &channel in &base.channels {
        if !is_stated(&base.device, channel) {
            continue;
        }
        let Some((squares, stated, readings)) = prepared.squares(channel) else {
            continue;
        };
        // as if this channel alone had paid for every parameter
        let freedom = readings - parameters;
        let (left, stated) = ((squares / freedom).sqrt(), (stated / readings).sqrt());
        if freedom >= REFUTING_FREEDOM && left < REFUTED * stated {
            found.push(Refuted {
                channel,
                unit: channel.unit(&base.device),
                left,
                stated,
            });
        }
    }
    Ok(found)
}

/// Counts of motor encoders that the log's own steps refute, in the device; a warning for each.
fn finer_counts(device: &mut Device, recording: &Recording, refuted: &[Refuted]) -> Vec<String> {
    let mut warnings = Vec::new();
    for (index, joint) in device.joints.iter_mut().enumerate() {
        let concerned = refuted.iter().any(|refuted| match refuted.channel {
            Channel::Output { joint } => joint == index,
            _ => true,
        });
        let (Some(quantum), Some(counts)) =
            (joint.reading_quantum_rad(), joint.encoder_counts_per_rev)
        else {
            continue;
        };
        let Some(step) = recording
            .joint
            .get(index)
            .and_then(|column| smallest_step(column, ARITHMETIC_COUNTS * quantum))
            .filter(|step| concerned && *step < FINER_COUNTS * quantum)
        else {
            continue;
        };
        warnings.push(format!(
            "joint {}: encoder_counts_per_rev = {counts} with transmission_ratio = {} would read in steps of \
             {quantum:.3e}, but the log's readings move by {step:.3e}: the counts (or the ratio) are stated too small, \
             and the noise too large by as much; the diagnosis goes by the log's steps",
            index + 1,
            joint.transmission_ratio
        ));
        joint.encoder_counts_per_rev = Some(TAU / step / joint.transmission_ratio.abs());
    }
    warnings
}

/// The noise that a channel's residual shows, in the device; a warning that names the stated number.
fn finer_noise(device: &mut Device, refuted: &Refuted) -> Option<String> {
    let sd = Some(refuted.left);
    let key = match refuted.channel {
        Channel::Output { joint } => {
            device.joints.get_mut(joint)?.external_encoder_sd_rad = sd;
            format!(
                "external_encoder_sd_rad (or external_encoder_counts_per_rev) of joint {}",
                joint + 1
            )
        }
        Channel::Cable { index } => {
            device.cables.get_mut(index)?.distance_sd_m = sd;
            "distance_sd_m (or counts_per_rev) of the cable encoder".to_owned()
        }
        Channel::Position => {
            device.tracker.as_mut()?.position_sd_m = sd;
            "position_sd_m of [tracker]".to_owned()
        }
        Channel::Orientation => {
            device.tracker.as_mut()?.rotation_sd_rad = sd;
            "rotation_sd_rad of [tracker]".to_owned()
        }
        Channel::Contact => {
            device.surroundings.contact_sd_m = sd;
            "sd_m of [contact]".to_owned()
        }
        Channel::Plane => {
            device.surroundings.plane_sd_m = sd;
            "sd_m of [plane]".to_owned()
        }
        Channel::Fixture { .. } | Channel::ContactPair { .. } | Channel::PlanePair { .. } => {
            return None;
        }
    };
    let Refuted {
        channel,
        unit,
        left,
        stated,
    } = refuted;
    Some(format!(
        "{}: the model leaves {left:.3e} {unit}, far less than the noise of {stated:.3e} {unit} that follows from the \
         device file: {key} is stated too large; the diagnosis goes by what is left",
        channel.name()
    ))
}
