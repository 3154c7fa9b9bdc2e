//! Friction, armatures, offsets and bodies of a moving arm in corrected.toml.

use haptical_diagnosis::{BESIDE_TORQUES, Diagnosis};
use haptical_effects::{Family, spec};
use haptical_model::{Device as Model, DeviceEffect, FrictionNumber, Recording};
use haptical_motion::{
    Dynamics, compared_dynamics, identify_drives, identify_dynamics, torques_left, with_dynamics,
};

use super::corrected::{tell_left, text};
use crate::device::Device;
use crate::files::DIAGNOSIS_FILES;
use crate::identify::{without_effects, without_friction};
use crate::log::Log;

/// What the file does not hold of them: beside a law of friction that is not quite the drive's a delay is no delay of the log.
const DELAY: &str =
    "the delay of the drives' torques: `haptical identify --with dynamics` finds it";
/// Share of the rows that numbers are fitted to, where the others say how well they predict.
const FITTED_SHARE: f64 = 0.6;
/// More numbers have to leave less of those than fewer do, by this share.
const LESS: f64 = 0.95;
/// A file that leaves so many times what its fit leaves of a torque says so.
const MORE_THAN_FIT: f64 = 1.5;

/// What is fitted of the device with the causes.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// Friction, armatures and offsets; its bodies are those of the diagnosis.
    Drives,
    /// Its bodies as well.
    Bodies,
}

/// Fits the device with the causes of a moving arm to its log: nothing of it, its drives, or drives and bodies, whichever predicts best the rows that it
/// did not see. Those are of the second recording, or of the log's end where there is none. Without such numbers the device stays as it is, and a
/// warning says why.
pub(super) fn fill(
    device: &Device,
    (log, validate): (&Log, Option<&Log>),
    diagnosis: &mut Diagnosis,
) {
    let is_beside = |words: &String| words == BESIDE_TORQUES;
    let Some(bare) = diagnosis.corrected.clone() else {
        return;
    };
    if !diagnosis.not_in_file.iter().any(is_beside) {
        return;
    }
    let task = Task {
        device,
        log,
        bare: &bare,
    };
    match task.filled(validate, diagnosis) {
        Ok(Some(filled)) => {
            let words = &mut diagnosis.not_in_file;
            words.retain(|words| !is_beside(words));
            words.extend(filled.not_in_file);
            let held = by_travel(diagnosis);
            let is_held = |words: &String| held.iter().any(|begin| words.starts_with(begin));
            diagnosis.not_in_file.retain(|words| !is_held(words));
            tell_left(diagnosis, filled.left);
        }
        Ok(None) => {}
        Err(why) => {
            diagnosis.corrected = Some(bare);
            let file = DIAGNOSIS_FILES[3];
            let warning = format!("{file} lacks friction and offsets of the drives: {why}");
            diagnosis.warnings.push(warning);
        }
    }
}

/// A device with causes that is fitted to a log.
#[derive(Clone, Copy)]
struct Task<'t> {
    device: &'t Device,
    log: &'t Log,
    bare: &'t Model,
}

/// What a fitted device leaves, and does not hold.
struct Filled {
    left: Vec<(String, f64)>,
    not_in_file: Vec<String>,
}

impl Task<'_> {
    /// The answer gets the device as it was fitted; none where no fit predicts more than the causes alone.
    fn filled(
        self,
        validate: Option<&Log>,
        diagnosis: &mut Diagnosis,
    ) -> Result<Option<Filled>, String> {
        let all = &self.log.recording;
        let (fitted, scored) = match validate {
            Some(second) => (all.as_ref().clone(), second.recording.as_ref().clone()),
            None => parts(all),
        };
        // springs and plays behind the drives follow the bodies' loads
        let kinds: &[Kind] = match is_of_torques(diagnosis) {
            true => &[Kind::Drives, Kind::Bodies],
            false => &[Kind::Drives],
        };
        // without a second recording the fit that predicts best is made anew, to the whole log
        let is_last = validate.is_some();
        let fits = kinds
            .iter()
            .map(|kind| (*kind, self.fitted((*kind, is_last), &fitted, diagnosis)));
        let fits: Vec<_> = fits.collect();
        let edge_hz = fits
            .iter()
            .find_map(|(_, fit)| Some(fit.as_ref().ok()?.1.edge_hz));
        let Some(edge_hz) = edge_hz else {
            return fits
                .into_iter()
                .find_map(|(_, fit)| fit.err())
                .map_or(Ok(None), Err);
        };
        let without = self.left(self.bare, &scored, edge_hz)?;
        let score = |model: &Model| {
            let left = self.left(model, &scored, edge_hz)?;
            Ok::<f64, String>(misfit(&left, &without))
        };
        let mut best = (score(self.bare)?, None);
        for (kind, fit) in &fits {
            let score = fit.as_ref().ok().and_then(|fit| score(&fit.0).ok());
            if let Some(score) = score.filter(|score| *score < LESS * best.0) {
                best = (score, Some(*kind));
            }
        }
        let Some(best) = best.1 else {
            return Ok(None);
        };
        let of_all = fits.into_iter().find(|(kind, _)| *kind == best);
        let of_all = of_all.filter(|_| is_last).map(|(_, fit)| fit);
        let again = || self.fitted((best, true), all, diagnosis);
        let (model, found) = of_all.unwrap_or_else(again)?;
        let has_delay = delays(&model) != delays(&self.device.model);
        diagnosis.corrected = Some(model);
        let written = text(self.device, diagnosis).map_err(|error| error.to_string())?;
        let read = Device::from_toml(&written.unwrap_or_default(), DIAGNOSIS_FILES[3])
            .map_err(|error| format!("it would not be read again: {error}"))?;
        let left = self.left(&read.model, all, found.edge_hz)?;
        let mut not_in_file: Vec<String> = (best == Kind::Drives && !has_delay)
            .then(|| DELAY.to_owned())
            .into_iter()
            .collect();
        not_in_file.extend(more_than_fit(&read.model, &left, &found));
        let channel = |(joint, rms): (usize, f64)| (format!("torque{}", joint + 1), rms);
        Ok(Some(Filled {
            left: left.into_iter().map(channel).collect(),
            not_in_file,
        }))
    }

    /// The device with what was fitted to a recording; a fit that is not the last is compared with others alone.
    fn fitted(
        self,
        (kind, is_last): (Kind, bool),
        recording: &Recording,
        diagnosis: &Diagnosis,
    ) -> Result<(Model, Dynamics), String> {
        let words = |error: haptical_motion::MotionError| error.to_string();
        let model = without_own_friction(self.bare, diagnosis);
        let torques = self.without_effects(&model, recording)?;
        let (model, found) = match kind {
            Kind::Bodies => {
                let found = match is_last {
                    true => identify_dynamics(&model, &torques, None, None),
                    false => compared_dynamics(&model, &torques, false),
                };
                (model, found.map_err(words)?)
            }
            Kind::Drives => {
                let bodies = diagnosis.bodies.iter().filter(|_| is_of_torques(diagnosis));
                let model = bodies.fold(model, |model, change| {
                    change.applied(&model).unwrap_or(model)
                });
                let found = match is_last {
                    true => identify_drives(&model, &torques),
                    false => compared_dynamics(&model, &torques, true),
                };
                (model, found.map_err(words)?)
            }
        };
        let mut filled = with_dynamics(&model, &found).map_err(|error| error.to_string())?;
        if kind == Kind::Drives {
            for (joint, given) in filled.joints.iter_mut().zip(&model.joints) {
                joint.torque_delay_s = given.torque_delay_s;
            }
        }
        // a friction that is a cause is the one of its joint
        for cause in model.effects.iter().filter(|effect| effect.is_friction()) {
            let is_same = |joint| joint == cause.joint;
            (filled.effects).retain(|effect| !effect.is_friction() || !is_same(effect.joint));
            filled.effects.push(cause.clone());
        }
        Ok((filled, found))
    }

    /// What a device leaves of a recording's torques.
    fn left(
        self,
        model: &Model,
        recording: &Recording,
        edge_hz: f64,
    ) -> Result<Vec<(usize, f64)>, String> {
        let torques = self.without_effects(&without_friction(model), recording)?;
        torques_left(model, &torques, edge_hz).map_err(|error| error.to_string())
    }

    fn without_effects(self, model: &Model, recording: &Recording) -> Result<Recording, String> {
        let place = (
            self.device.source().path.as_path(),
            self.log.source().path.as_path(),
        );
        let torques = without_effects(model, recording, place);
        Ok(torques.map_err(|error| error.to_string())?.into_owned())
    }
}

/// Whether all channels are torques.
fn is_of_torques(diagnosis: &Diagnosis) -> bool {
    let mut channels = diagnosis.gap.channels.iter();
    channels.all(|of| of.channel.starts_with("torque"))
}

/// Rows that numbers are fitted to, and those that say how well they predict.
fn parts(recording: &Recording) -> (Recording, Recording) {
    let fitted = (FITTED_SHARE * recording.len() as f64) as usize;
    let rows = |rows: std::ops::Range<usize>| recording.select(&rows.collect::<Vec<_>>());
    (rows(0..fitted), rows(fitted..recording.len()))
}

/// What a fit leaves of torques, in shares of what is left without one.
fn misfit(left: &[(usize, f64)], without: &[(usize, f64)]) -> f64 {
    let both = left.iter().zip(without);
    both.map(|((_, left), (_, without))| (left / without.max(f64::MIN_POSITIVE)).powi(2))
        .sum()
}

/// What the fit of the torques leaves less than a file without its every detail.
fn more_than_fit(model: &Model, left: &[(usize, f64)], found: &Dynamics) -> Option<String> {
    let of_joint = |(joint, rms): &(usize, f64)| {
        let fit = found.residuals.iter().find(|entry| entry.joint == *joint)?;
        let unit = model.joints[*joint].torque_unit();
        let rms_of_fit = fit.after_rms;
        (*rms > MORE_THAN_FIT * rms_of_fit).then(|| {
            format!(
                "torque{} leaves {rms:.4} {unit} for {rms_of_fit:.4}",
                joint + 1
            )
        })
    };
    let said: Vec<String> = left.iter().filter_map(of_joint).collect();
    (!said.is_empty()).then(|| {
        format!(
            "how friction leads the motion and builds up at reversals: by this file {}",
            said.join(", ")
        )
    })
}

fn delays(model: &Model) -> Vec<Option<f64>> {
    model
        .joints
        .iter()
        .map(|joint| joint.torque_delay_s)
        .collect()
}

/// How the sentences begin on friction that builds up over a travel and that the file holds as such.
fn by_travel(diagnosis: &Diagnosis) -> Vec<String> {
    let effects = diagnosis.corrected.iter().flat_map(|file| &file.effects);
    let has_travel = |joint: Option<usize>| {
        let mut of_joint = effects
            .clone()
            .filter(|entry| entry.is_friction() && entry.joint == joint);
        of_joint.any(|entry| FrictionNumber::TurnoverTravel.stated(entry).is_some())
    };
    let causes = diagnosis.causes.iter();
    let held = causes.filter(|cause| {
        let is_loop = spec(&cause.effect).is_some_and(|spec| spec.family == Family::Loop);
        is_loop && has_travel(cause.joint.map(|joint| joint - 1))
    });
    held.map(|cause| format!("{} at {}:", cause.effect, cause.place()))
        .collect()
}

/// The device with the causes without the friction that is found anew: all but that of a cause.
fn without_own_friction(bare: &Model, diagnosis: &Diagnosis) -> Model {
    let is_cause = |entry: &DeviceEffect| {
        let mut causes = diagnosis.causes.iter();
        causes.any(|cause| cause.is_of(&entry.name, entry.joint))
    };
    let mut model = bare.clone();
    model
        .effects
        .retain(|entry| !entry.is_friction() || is_cause(entry));
    model
}
