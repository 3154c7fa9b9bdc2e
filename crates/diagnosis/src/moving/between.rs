//! Encoders on the links of a moving arm, as `haptical-motion` examines them, beside what its torques say.

use haptical_calibration::{Channel, channels};
use haptical_effects::transmission::CAPSTAN_COMPLIANCE;
use haptical_effects::{Effect, Form, Hook, law, spec};
use haptical_model::{Device, DeviceEffect, Recording, TransmissionError, TransmissionKind};
use haptical_motion::{
    Between, ChannelFit, Finding, LoadSource, OwnEffect, examine_between, examine_own,
};

use super::words::Words;
use crate::answer::{CauseAnswer, Left, SecondChannel, Untestable};
use crate::force::answer::ForceAnswer;
use crate::thresholds::moving::STIFFNESS_SD;
use crate::thresholds::second::ALLOWED;

/// Names of a stiffness, and of a width: of a joint that turns and of one that slides. A law of a device file has the first of
/// them at either joint.
const STIFFNESS: [&str; 2] = ["stiffness_nm_per_rad", "stiffness_n_per_m"];
const WIDTH: [&str; 2] = ["width_rad", "width_m"];
/// Begins that of a spring that hardens, over the load that it had: a device file's springs are straight.
const SECANT: &str = "secant_";
/// A play that follows the load, as a number of a device file's effect.
const BY_LOAD: f64 = 2.0;

/// The encoders' answer where the device's own effects leave nothing, where a play that follows the load, or springs beside a delay, explain what they show; what else there may be is
/// asked of the base model and its effects. None for logs that show the chain as well.
pub(crate) fn of_links(
    device: &Device,
    (recording, second): (&Recording, Option<&Recording>),
    source: LoadSource,
    without: &[String],
) -> Option<Links> {
    let seen = channels(device, recording).ok()?;
    let is_direct = |own: &Channel| match own {
        Channel::Output { joint } => device.joints[*joint].transmission == TransmissionKind::Direct,
        _ => false,
    };
    if !seen.iter().all(is_direct) {
        return None;
    }
    let beside = |recording: &Recording| with_errors(device, recording);
    let is_on_links =
        |own: &&DeviceEffect| spec(&own.name).is_none_or(|spec| !spec.hook.is_on_drives());
    let own: Vec<&DeviceEffect> = device.effects.iter().filter(is_on_links).collect();
    if !own.is_empty() {
        let known: Option<Vec<(usize, OwnEffect)>> = own.into_iter().map(known).collect();
        let known = known?;
        let found = examine_own(&beside(recording)?, source, &known).ok()?;
        let mut links = Links {
            found,
            source,
            on_second: None,
        };
        if let Some(second) = second {
            let there = examine_own(&beside(second)?, source, &known).ok()?;
            links.on_second = Some(links.left_of(device, &there));
        }
        return links.found.is_adequate.then_some(links);
    }
    let second = second.and_then(beside);
    let found = examine_between(&beside(recording)?, second.as_ref(), source, without).ok()?;
    let speaks = found.is_adequate && is_beyond_one_law(&found.examined.findings);
    speaks.then_some(Links {
        found,
        source,
        on_second: None,
    })
}

/// An effect of the device that is of these laws.
fn known(own: &DeviceEffect) -> Option<(usize, OwnEffect)> {
    let number = |name: &str| own.numbers.get(name).copied();
    let stiffness = || STIFFNESS.iter().find_map(|name| number(name));
    let effect = match law(&own.name)? {
        (Hook::ExternalEncoder, Form::Delay) => OwnEffect::Delay(number("delay_s")?),
        (Hook::Transmission, Form::Spring) => OwnEffect::Spring(1.0 / stiffness()?),
        (Hook::Transmission, Form::Play) if number("driven_by") == Some(BY_LOAD) => {
            OwnEffect::Play(0.5 * WIDTH.iter().find_map(|name| number(name))?)
        }
        _ => return None,
    };
    Some((own.joint?, effect))
}

/// Findings that no single law of the catalogue stands for.
fn is_beyond_one_law(findings: &[Finding]) -> bool {
    let has = |form| {
        let mut laws = findings.iter().filter_map(|own| law(own.effect));
        laws.any(|law| law.1 == form)
    };
    let hardens = |own: &Finding| {
        own.numbers
            .iter()
            .any(|number| number.0.starts_with(SECANT))
    };
    has(Form::Play) || (has(Form::Delay) && has(Form::Spring)) || findings.iter().any(hardens)
}

/// A number of a cause, and the ends of its interval.
pub type NumberOfCause = (f64, [Option<f64>; 2]);

/// Device effects of a cause between motor and link (joint from 0), with its numbers and the ends of their intervals: a play is at the side
/// of its load, with the spring behind it.
pub fn effects_between(
    name: &str,
    joint: Option<usize>,
    number: &dyn Fn(&str) -> Option<NumberOfCause>,
) -> Vec<DeviceEffect> {
    // a law has one name of its number at joints that turn and at those that slide: the first; a spring that hardens is straight
    let of = |name: &str, keys: [&str; 2]| {
        let any = |key: &&str| number(&format!("{SECANT}{key}")).or_else(|| number(key));
        let (value, ci95) = keys.iter().find_map(any)?;
        let key = keys[0].to_owned();
        Some(DeviceEffect {
            name: name.to_owned(),
            joint,
            numbers: [(key.clone(), value)].into(),
            intervals: [(key, ci95)].into(),
            ..DeviceEffect::default()
        })
    };
    let spring = || of(CAPSTAN_COMPLIANCE.name, STIFFNESS);
    let play = || {
        let mut own = of(name, WIDTH)?;
        own.numbers.insert("driven_by".to_owned(), BY_LOAD);
        Some(own)
    };
    let found = match law(name) {
        Some((Hook::Transmission, Form::Play)) => [play(), spring()],
        Some((Hook::Transmission, Form::Spring)) => [spring(), None],
        Some((Hook::ExternalEncoder | Hook::Timing, Form::Delay)) => {
            [of(name, ["delay_s"; 2]), None]
        }
        _ => [None, None],
    };
    found.into_iter().flatten().collect()
}

/// The recording with what the device file says of its transmissions added to the motors' readings; none beyond what they allow.
fn with_errors(device: &Device, recording: &Recording) -> Option<Recording> {
    let mut beside = recording.clone();
    for (joint, readings) in device.joints.iter().zip(&mut beside.joint) {
        for reading in readings.iter_mut() {
            *reading += joint.error_rad(*reading).ok()?;
        }
    }
    Some(beside)
}

/// What encoders on links show.
pub(crate) struct Links {
    found: Between,
    source: LoadSource,
    /// What the device's effects leave of the second recording; none where they were looked for, or there is none.
    on_second: Option<Vec<SecondChannel>>,
}

impl Links {
    /// What the device's effects leave of a second recording, over what they leave of the first.
    fn left_of(&self, device: &Device, there: &Between) -> Vec<SecondChannel> {
        let words = Words::of_outputs(device, &there.examined);
        let channel = |own: &ChannelFit| {
            let mut first = self.found.examined.channels.iter();
            let first = first.find(|first| first.joint == own.joint)?;
            let left = Left {
                rms: own.rms_after,
                noise: first.noise,
                readings: own.before.len() as f64,
                error_of_fit: 0.0,
            };
            let name = (
                words.channel(own.joint),
                Some(own.joint + 1),
                words.unit(own.joint),
            );
            Some(SecondChannel::new(
                name,
                (left, first.rms_after),
                ALLOWED,
                None,
            ))
        };
        there.examined.channels.iter().filter_map(channel).collect()
    }

    /// Their answer, and what is left of a second recording, before those of the torques.
    pub(crate) fn before(
        &self,
        device: &Device,
        torques: Option<ForceAnswer>,
        effects: &[Box<dyn Effect>],
        has_second: bool,
    ) -> ForceAnswer {
        let examined = &self.found.examined;
        let words = Words::of_outputs(device, examined);
        let torques = torques.unwrap_or_default();
        let mut channels = words.gaps();
        let course = words.course(&channels);
        channels.extend(torques.channels.iter().cloned());
        let mut findings = words.causes();
        self.widen(&mut findings);
        let mut warnings = self.warnings(&words);
        warnings.extend(torques.unexplained().map(|gap| {
            format!(
                "the torque of joint {} shows a gap that no cause explains: {:.3} {unit}, noise {:.3} {unit}; stiffnesses by the load of the \
                 nominal bodies may be off by more than their intervals",
                gap.joint.unwrap_or_default(),
                gap.rms_before,
                gap.noise_floor,
                unit = gap.unit
            )
        }));
        warnings.extend(torques.warnings);
        let mut untestable = untestable(effects, &findings);
        untestable.extend(torques.untestable);
        findings.extend(torques.findings);
        let seen = has_second.then(|| {
            let mut seen = words.on_second();
            seen.second
                .channels
                .extend(self.on_second.iter().flatten().cloned());
            seen.extend(torques.second.unwrap_or_default());
            seen
        });
        ForceAnswer {
            changes: torques.changes,
            bodies: torques.bodies,
            channels,
            findings,
            untestable,
            unexplained_share: match examined.findings.is_empty() {
                true => torques.unexplained_share,
                false => examined.unexplained_share(),
            },
            significant: !examined.findings.is_empty() || torques.significant,
            numbers: examined.numbers + torques.numbers,
            tested: examined.tried + torques.tested,
            warnings,
            course,
            second: seen,
            ..ForceAnswer::default()
        }
    }

    /// The device with the causes, and with the zeros of its encoders.
    pub(crate) fn corrected(&self, device: &Device, causes: &[CauseAnswer]) -> Device {
        let mut corrected = device.clone();
        for (joint, offset_rad) in &self.found.offsets_rad {
            if let TransmissionError::Capstan(error) =
                &mut corrected.joints[*joint].transmission_error
            {
                error.offset_rad += offset_rad;
            }
        }
        for cause in causes {
            let joint = cause.joint.map(|joint| joint - 1);
            let number = |key: &str| {
                let own = cause.parameters.get(key)?;
                Some((own.value, own.ci95.map(Some)))
            };
            let found = effects_between(&cause.effect, joint, &number).into_iter();
            corrected.effects.extend(found.map(|own| DeviceEffect {
                confusable_with: cause.confusable_with.clone(),
                fit: true,
                ..own
            }));
        }
        corrected
    }

    /// Stiffnesses are known as the torques are.
    fn widen(&self, causes: &mut [CauseAnswer]) {
        for cause in causes {
            for (name, own) in &mut cause.parameters {
                if (name.starts_with("stiffness") || name.starts_with(SECANT))
                    && self.source == LoadSource::Links
                {
                    *own = own.off_by_a_factor(STIFFNESS_SD);
                }
            }
        }
    }

    fn warnings(&self, words: &Words<'_>) -> Vec<String> {
        let mut warnings = words.not_predicted();
        for own in &self.found.examined.findings {
            if let (Some(joint), true) = (
                own.joint,
                own.numbers.iter().any(|own| own.0.starts_with(SECANT)),
            ) {
                warnings.push(format!(
                    "the spring at joint {} hardens with its load: its stiffness is that at rest, and a device file, whose springs are straight, gets \
                     the secant over the load of this log",
                    joint + 1
                ));
            }
        }
        if self.found.examined.findings.is_empty() {
            warnings.push(
                "the zeros of the encoders on the links were not compared with the model's"
                    .to_owned(),
            );
        }
        let own = &self.found.own_delays_s;
        if !own.is_empty() {
            let each = own.iter().map(|(joint, delay_s, sd)| {
                let channel = words.channel(*joint);
                format!("{channel} {:.2} +- {:.2}", 1e3 * delay_s, 1e3 * sd)
            });
            let each = each.collect::<Vec<_>>().join(", ");
            warnings.push(format!(
                "one delay does for all encoders on links; by themselves they are late by {each} ms (one standard deviation): they, or the \
                 time stamps of all motor encoders, are shifted together"
            ));
        }
        let is_spring =
            |own: &Finding| own.numbers.iter().any(|own| own.0.starts_with("stiffness"));
        if self.source == LoadSource::Drives && self.found.examined.findings.iter().any(is_spring) {
            warnings.push(
                "the device file gives no masses: stiffnesses are by the recorded torques, in which the drives' friction counts as load"
                    .to_owned(),
            );
        }
        warnings
    }
}

/// Effects on positions that were not compared.
fn untestable(effects: &[Box<dyn Effect>], found: &[CauseAnswer]) -> Vec<Untestable> {
    let mut all: Vec<Untestable> = Vec::new();
    for effect in effects {
        let name = effect.name();
        if found.iter().all(|own| own.effect != name) {
            let why = match effect.spec().hook {
                Hook::Transmission | Hook::ExternalEncoder | Hook::Timing => {
                    "delays, springs and plays explain the encoders on the links: it was not compared with them"
                }
                _ => {
                    "the log has joints, encoders on their links and torques alone: nothing shows it"
                }
            };
            Untestable::add(&mut all, name, None, why.to_owned());
        }
    }
    all
}
