//! The diagnosis of a log that has joints and torques alone, or encoders on links besides that are explained already: no position is
//! fitted, and the geometry is the device file's.

use haptical_calibration::{CalibrationError, channels, check_recording};
use haptical_effects::force::PAYLOAD;
use haptical_effects::{Context, Effect, Form, spec};
use haptical_judge::{Admission, Check};
use haptical_model::{Device, Joint, Recording};
use haptical_motion::why_not;

use crate::answer::{
    CandidateAnswer, CauseAnswer, ChannelGap, Diagnosis, Gap, HeldOutAnswer, NoReduction, Place,
    Prediction, Provenance, SECOND_RECORDING, SecondAnswer, TORQUES_NOT_TESTED, Untestable,
    Verdict, in_torques, not_in_file, of_drives,
};
use crate::force::answer::ForceAnswer;
use crate::force::{examine, names};
use crate::judge::{by_torques, on_unseen};
use crate::noise::NoiseSource;
use crate::servo_loop::has_commands;
use crate::thresholds::servo::UNTRUSTED_SCALE;
use crate::{DiagnosisError, Options, Result};

/// Whether torques are all that a recording has to say of a device with links. Untrusted ones have nothing to say where there are commands.
pub(crate) fn applies(device: &Device, recording: &Recording) -> bool {
    let has_commands = has_commands(device, recording);
    let is_asked = |(joint, own): (usize, &Joint)| {
        let column = recording.torque_nm.get(joint).and_then(Option::as_ref);
        let is_read = column.is_some_and(|column| column.iter().any(|value| value.is_finite()));
        is_read && (own.torque_scale_sd < UNTRUSTED_SCALE || !has_commands)
    };
    device.joints.iter().enumerate().any(is_asked)
        && device.has_links()
        && matches!(
            channels(device, recording),
            Err(CalibrationError::NoChannel)
        )
}

/// What a diagnosis of a motion says of the rows that it looked at, within [`Diagnosis::held_out`](crate::Diagnosis::held_out).
pub const BEHIND_A_LOW_PASS: &str = "behind a low pass";

/// The torques' part of an answer.
pub(crate) struct OfTorques {
    pub(crate) verdict: Verdict,
    /// All of the gap where unseen rows take its name.
    pub(crate) unexplained_share: f64,
    pub(crate) gap: Gap,
    pub(crate) place: Option<Place>,
    pub(crate) causes: Vec<CauseAnswer>,
    /// Causes that unseen rows do not bear out.
    pub(crate) candidates: Vec<CandidateAnswer>,
    /// What is said of unseen rows.
    pub(crate) warnings: Vec<String>,
    pub(crate) second: Option<SecondAnswer>,
    pub(crate) predictions: Vec<Prediction>,
    pub(crate) held_out: String,
}

impl OfTorques {
    pub(crate) fn new(force: &ForceAnswer, is_moving: bool) -> Self {
        let rows = match is_moving {
            true => BEHIND_A_LOW_PASS,
            false => "block means of 0.1 s",
        };
        let by_log = by_torques(force);
        let place = in_torques(force).filter(|_| by_log != Verdict::NoGap);
        let located = place.as_ref().map(|place| place.channel.as_str());
        let gap = Gap::new(by_log, located, force.channels.clone());
        let mut causes = force.findings.clone();
        gap.agree_with(&mut causes);
        let (mut warnings, mut predictions) = (Vec::new(), Vec::new());
        let mut held_out = held_out_rows(&causes, is_moving, rows);
        let seen = force.second.as_ref();
        let shown = seen.iter().flat_map(|seen| &seen.held_out);
        let shown = shown.filter(|channel| located == Some(channel.channel.as_str()));
        let shown = shown.map(|channel| channel.clone().agreeing(&gap)).next();
        let after_verdict = put_second(&mut causes, shown, is_moving);
        if let Some(seen) = seen {
            warnings.extend(seen.warnings.iter().cloned());
            predictions.clone_from(&seen.predictions);
            // a motion's second recording may be one that the first one does not predict
            if !is_moving || !seen.held_out.is_empty() {
                held_out = format!("{SECOND_RECORDING}, {rows}");
            }
        }
        let (verdict, mut candidates, said) = on_unseen(by_log, &mut causes);
        candidates.extend(force.candidates.iter().cloned());
        if let (Some(first), Some(shown)) = (causes.first_mut(), after_verdict) {
            first.held_out = Some(shown);
        }
        warnings.extend(said);
        Self {
            unexplained_share: match by_log.has_causes() && verdict == Verdict::Unknown {
                true => 1.0,
                false => force.unexplained_share,
            },
            verdict,
            gap,
            place,
            causes,
            candidates,
            warnings,
            second: seen.map(|seen| seen.second.clone()),
            predictions,
            held_out,
        }
    }
}

/// Diagnoses the torques.
pub(crate) fn diagnose(
    device: &Device,
    recording: &Recording,
    effects: &[Box<dyn Effect>],
    (options, moving): (&Options<'_>, Option<ForceAnswer>),
) -> Result<Diagnosis> {
    check_recording(device, recording, &[])?;
    let model = options.model.unwrap_or(device);
    let is_known = moving.as_ref().is_some_and(|moving| !is_open(moving));
    let context = match is_known {
        true => Context::of_drives(model, recording)?,
        false => Context::new(model, recording, &[])?,
    };
    let changed = match &moving {
        Some(moving) if is_open(moving) => between_runs(&context, moving, options)?,
        _ => None,
    };
    let is_moving = moving.is_some() && changed.is_none();
    let force = match changed.or(moving) {
        Some(force) => force,
        None => examine(&context, options.validation, &options.without)?,
    };
    let slow = (!is_moving).then(|| why_not(model, recording)).flatten();
    if let (Some(why), true) = (&force.not_tested, force.channels.is_empty()) {
        return Err(DiagnosisError::Torques {
            why: slow.unwrap_or_else(|| why.clone()),
        });
    }
    let OfTorques {
        verdict,
        unexplained_share,
        gap,
        place,
        causes,
        candidates,
        warnings,
        second,
        predictions,
        held_out,
    } = OfTorques::new(&force, is_moving);
    let warnings = [warnings_of(&force, slow.as_deref()), warnings].concat();
    let changes = (&causes[..], &force.changes[..], context.reference_degc);
    let corrected = of_drives(device, verdict, changes);
    let devices = (device, corrected.as_ref());
    let not_held = not_in_file(verdict, &causes, devices, (&force.changes, is_moving));
    let provenance = Provenance::new(recording.len(), force.numbers, force.tested, options);
    Ok(Diagnosis {
        admission: match is_moving {
            true => force.admission.clone(),
            false => of_slow_torques(&gap, recording.len()),
        },
        adjusted: force.adjusted.clone(),
        own_model: force.own_model.clone(),
        bodies: force.bodies.clone(),
        not_in_file: not_held,
        next_experiment: next_experiment(verdict, &force, is_moving),
        traces: (force.course.iter())
            .filter(|_| verdict != Verdict::NoGap)
            .cloned()
            .collect(),
        unexplained_share,
        closed_unseen_share: force
            .closed_unseen_share
            .filter(|_| verdict != Verdict::Unknown),
        second,
        silent: force.silent.clone(),
        untestable: untestable(effects, &force, is_moving),
        candidates,
        warnings,
        held_out,
        corrected,
        predictions,
        place,
        ..Diagnosis::of_causes(verdict, gap, causes, model.clone(), provenance)
    })
}

/// Whether the equations of motion leave a gap without a name.
fn is_open(moving: &ForceAnswer) -> bool {
    moving.not_tested.is_none() && moving.significant && !moving.is_explained()
}

/// A payload that changed between the runs of a moving arm whose equations of motion leave a gap without a name: the change is asked for
/// alone, so that what the model lacks in all runs alike, friction above all, does not count (docs/diagnosis-force.md, "Payload").
fn between_runs(
    context: &Context<'_>,
    moving: &ForceAnswer,
    options: &Options<'_>,
) -> Result<Option<ForceAnswer>> {
    if context.runs.len() < 2 {
        return Ok(None);
    }
    let others = names().filter(|name| *name != PAYLOAD.name);
    let others = others
        .map(str::to_owned)
        .chain(options.without.iter().cloned());
    let others: Vec<String> = others.collect();
    let mut found = examine(context, options.validation, &others)?;
    if !found.findings.first().is_some_and(CauseAnswer::is_of_runs) {
        return Ok(None);
    }
    found.warnings.push(
        "the equations of motion leave a gap in all runs that no effect explains: the payload is what changed between them, by the torques of \
         postures that they share"
            .to_owned(),
    );
    found.warnings.extend(moving.warnings.iter().cloned());
    Ok(Some(found))
}

/// What admits a verdict on the torques of a slow motion.
fn of_slow_torques(gap: &Gap, rows: usize) -> Admission {
    let floors = gap.channels.iter().map(|own| {
        let by = own.noise_source.words();
        format!(
            "{} {:.3e} {} by {by}",
            own.channel, own.noise_floor, own.unit
        )
    });
    let floors = floors.collect::<Vec<_>>().join(", ");
    let is_rest = |channel: &ChannelGap| channel.noise_source == NoiseSource::Rest;
    Admission {
        known_noise: match gap.channels.iter().any(is_rest) {
            true => Check::unknown(floors),
            false => Check::yes(floors),
        },
        enough: Check::yes(format!("{rows} rows")),
        ..Admission::default()
    }
}

/// What is said of the torques of a log.
fn warnings_of(force: &ForceAnswer, slow: Option<&str>) -> Vec<String> {
    let not_tested = force.not_tested.iter();
    let not_tested = not_tested.map(|why| format!("{TORQUES_NOT_TESTED}: {why}"));
    let warnings = force.warnings.iter().cloned().chain(not_tested);
    warnings.chain(slow.map(said_of_slow)).collect()
}

/// Which rows of the log were held out; nothing where none were.
fn held_out_rows(causes: &[CauseAnswer], is_moving: bool, rows: &str) -> String {
    if causes.iter().all(|cause| cause.held_out.is_none()) {
        return String::new();
    }
    let part = match is_moving {
        true => "a fifth of the log",
        false => "a tenth of each run",
    };
    format!("{part} in turn, {rows}")
}

/// What is said of a log that the equations of motion are not asked of.
fn said_of_slow(why: &str) -> String {
    format!(
        "the equations of motion were not used: {why}. The torques were judged as those of a slow motion, and nothing is said of inertia, \
         armature, delay or the masses of links"
    )
}

/// Whether a cause belongs to its log, so that no share of it closes on other rows.
fn is_of_log(own: &CauseAnswer) -> bool {
    let held_out = own.held_out.as_ref();
    held_out.is_some_and(|own| own.no_reduction == Some(NoReduction::Undetermined))
}

/// Puts what a second recording shows into the first cause, where that is checked by it; else what is to be put there after the verdict: a
/// load that came in between two runs of the log is refuted by no second recording that begins without it.
fn put_second(
    causes: &mut [CauseAnswer],
    shown: Option<HeldOutAnswer>,
    is_moving: bool,
) -> Option<HeldOutAnswer> {
    let is_put = |first: &&mut CauseAnswer| !is_of_log(first) && (!is_moving || !is_checked(first));
    let first = causes.first_mut().filter(is_put)?;
    if first.is_of_runs() {
        return shown;
    }
    first.held_out = shown.or(first.held_out.take());
    None
}

/// Whether a cause is checked at its own joint already, as what moves an arm is.
fn is_checked(own: &CauseAnswer) -> bool {
    own.joint.is_some() && own.held_out.is_some()
}

/// Why effects on positions are not tested.
const POSITIONS: &str =
    "the log has joints and torques alone: no encoder, distance or position shows it";

/// Why a play is not tested by the torques of a motion.
const PLAY: &str = "no encoder is on the links: of a play the motor's torque shows knocks where the load changes sides, which friction before \
                    sliding and a gear's spring leave as well, so that a gap there has no name; put an encoder on the link";

/// Effects on positions, which nothing shows here, and those on torques that this log cannot test.
fn untestable(
    effects: &[Box<dyn Effect>],
    force: &ForceAnswer,
    is_moving: bool,
) -> Vec<Untestable> {
    let mut found: Vec<Untestable> = Vec::new();
    let of_motion = haptical_motion::effect_names();
    // what the torques of a motion show is not untestable
    let is_shown = |effect: &dyn Effect| is_moving && of_motion.contains(&effect.name());
    for effect in effects.iter().filter(|effect| !is_shown(effect.as_ref())) {
        let why = match effect.spec().form {
            Form::Play if is_moving => PLAY,
            _ => POSITIONS,
        };
        if found.iter().all(|entry| entry.effect != effect.name()) {
            found.push(Untestable::new(effect.name(), why));
        }
    }
    found.extend(force.untestable.iter().cloned());
    found
}

fn next_experiment(verdict: Verdict, force: &ForceAnswer, is_moving: bool) -> Option<String> {
    let first = force.findings.first().map(|cause| cause.effect.as_str());
    match (verdict, first) {
        (Verdict::NoGap, _) => None,
        (Verdict::Named | Verdict::Ambiguous, Some(name)) => {
            let confirm = spec(name).map_or("", |spec| spec.confirm);
            Some(match confirm {
                "" => format!(
                    "to confirm {name}: repeat the trajectory at a third of the speed, and once with a known weight at the flange; \
                     friction keeps its size, weights and gains grow with the load"
                ),
                confirm => confirm.replace("{name}", name),
            })
        }
        _ => Some(
            "repeat the trajectory at a third of the speed: what is friction keeps its size, what is inertia falls to a ninth; \
             then once with a known weight at the flange"
                .to_owned()
                + match is_moving {
                    true => "; an encoder on the link tells a play or a spring of its gear",
                    false => "",
                },
        ),
    }
}
