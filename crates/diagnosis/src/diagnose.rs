//! The whole diagnosis, from a device and a recording to an answer.

use haptical_calibration::{CalibrationError, Channel, channels, check_recording, check_rig};
use haptical_effects::device::{attached_at, bare};
use haptical_effects::structure::JOINT_COMPLIANCE;
use haptical_effects::{Absorbed, Context, Effect, catalogue};
use haptical_model::{Device, DeviceEffect, JointCompliance, ParameterId, Recording};
use haptical_motion::{LoadSource, is_moving_arm};

use crate::admission::admitted;
use crate::answer::{Diagnosis, Verdict, answer, changed, judged, not_in_file};
use crate::current::without_currents;
use crate::engine::{Base, Prepared, Unfinished, onto_touches, own_sizes, placed};
use crate::force::answer::ForceAnswer;
use crate::joined::{View, joined};
use crate::judge::{Corrected, Findings, Inputs};
use crate::log::{Log, thinned};
use crate::moving::between::{Links, of_links};
use crate::moving::{carries_links_alone, of_moving_arm, with_link_torques};
use crate::noise::{KnownNoise, is_stated, without_readings};
use crate::own_effects::within_laws;
use crate::second_round::{Again, Bases, nearer};
use crate::select::{Selection, Selector, is_displacement};
use crate::servo_loop::has_commands;
use crate::{DiagnosisError, Options, Result, current, servo_loop, torques_alone};

/// Fits the device jointly to the recording, then says what is left of it: whether there is a gap, where, which
/// effect of the catalogue causes it, or that none does.
///
/// # Errors
/// [`DiagnosisError`]; [`DiagnosisError::is_unidentifiable`] tells recordings that fix nothing from
/// input that is wrong.
pub fn diagnose(
    device: &Device,
    recording: &Recording,
    options: &Options<'_>,
) -> Result<Diagnosis, DiagnosisError> {
    let currents = without_currents(device, recording);
    let log = Log::new(
        device,
        currents.as_ref().unwrap_or(recording),
        options.model,
    );
    let second = options.validation;
    let of_second = second.and_then(|second| without_currents(device, second));
    let second = of_second.as_ref().or(second);
    let second = second.map(|second| Log::new(device, second, options.model));
    let options = &Options {
        validation: second.as_ref().map(|second| second.recording.as_ref()),
        ..options.clone()
    };
    let whole = recording;
    let recording = log.recording.as_ref();
    let of_chain = of_chain(device, recording, options).map(|mut found| {
        log.of_log(&mut found, second.as_ref());
        admitted(found)
    });
    // a part that was interrupted may have been left out
    options.interrupt.check()?;
    // what a moving arm's torques make of its commands says more of them than its positions do
    let model = options.model.unwrap_or(device);
    let is_by_torques = of_chain.is_ok() && is_moving_arm(model, recording);
    let is_asked = has_commands(device, recording) && !is_by_torques;
    let of_loop = is_asked.then(|| View {
        answer: effects_of(device, options)
            .and_then(|effects| servo_loop::diagnose(device, recording, &effects, options)),
        names: &haptical_servo::NAMES,
    });
    options.interrupt.check()?;
    let of_currents = currents.is_some().then(|| View {
        answer: current::diagnose(device, whole, options),
        names: &current::NAMES,
    });
    joined(of_chain, of_loop.into_iter().chain(of_currents))
        .map(judged)
        .map(admitted)
}

/// The diagnosis of positions, of encoders on links and of torques.
fn of_chain(device: &Device, recording: &Recording, options: &Options<'_>) -> Result<Diagnosis> {
    let found = diagnose_all(device, recording, options)?;
    let found = match found.split_row {
        Some(row) => with_split(found, (device, recording, options), row)?,
        None => found,
    };
    let mut own = match device.effects.is_empty() {
        true => options
            .model
            .map_or(Vec::new(), |model| model.effects.clone()),
        false => device.effects.clone(),
    };
    let mut rigid = bare(device);
    if let Some(model) = options.model.filter(|_| !device.has_compliance())
        && model.has_compliance()
    {
        own.extend(yielding(model));
        rigid.surroundings.compliance.clear();
    }
    within_laws(found, &own, (&rigid, recording), options)
}

/// The diagnosis of single postures of which those from a row on are another run, where a displacement between the two has a name then.
fn with_split(
    found: Diagnosis,
    (device, recording, options): (&Device, &Recording, &Options<'_>),
    row: usize,
) -> Result<Diagnosis> {
    let mut cut = recording.clone();
    let runs = (0..recording.len()).map(|at| 2 * recording.run_at(at) + i64::from(at >= row));
    cut.run = Some(runs.collect());
    let again = diagnose_all(device, &cut, options)?;
    let line = recording.line.get(row).copied().unwrap_or_default();
    let is_displaced = again
        .causes
        .first()
        .is_some_and(|first| haptical_effects::spec(&first.effect).is_some_and(is_displacement));
    let said = |then: &str| {
        format!(
            "from line {line} of the log on (row {}) something is displaced{then}",
            row + 1
        )
    };
    Ok(match again.verdict.has_causes() && is_displaced {
        true => {
            let mut again = again;
            again.warnings.push(said(
                ": the rows before it and behind it were judged as two runs",
            ));
            again
        }
        false => {
            let mut found = found;
            found.warnings.push(said(
                "; give the rows before it and behind it different numbers in a column `run`",
            ));
            found
        }
    })
}

/// What a file does not hold of encoders on the links of a moving arm.
const SLOW_PART: &str = "that the encoders on the links were fitted behind a low pass, and without the rows in which a link is in its \
                         play: a replay has all of both, and leaves more";
fn yielding(model: &Device) -> impl Iterator<Item = DeviceEffect> {
    let yields = |joint: &usize| model.compliance_rad_per_nm(*joint) != 0.0;
    let joints = (0..model.joints.len()).filter(yields);
    joints.map(|joint| DeviceEffect {
        name: JOINT_COMPLIANCE.name.to_owned(),
        joint: Some(joint),
        ..DeviceEffect::default()
    })
}

fn diagnose_all(
    device: &Device,
    recording: &Recording,
    options: &Options<'_>,
) -> Result<Diagnosis> {
    let yielding = options.model.and_then(|model| yielding_as(device, model));
    let mut device = yielding.unwrap_or_else(|| device.clone());
    if let Some(model) = options.model.filter(|_| device.effects.is_empty()) {
        // numbers of the base model then, as lengths and angles are
        device.effects.clone_from(&model.effects);
    }
    let at = options.model.unwrap_or(&device).clone();
    if options.model.is_some() {
        let how = (options.loss, &options.interrupt);
        own_sizes(&mut device, &at, recording, how);
    }
    let recording = attached_at(&mut device, &at, recording)?;
    let second = options.validation;
    let validation = second.map(|second| attached_at(&mut device.clone(), &at, second));
    let validation = validation.transpose()?;
    let device = &device;
    // with every row: accelerations need the log's own rate
    let model = options.model.unwrap_or(device);
    let moving = of_moving_arm(model, &recording, validation.as_deref(), &options.without);
    options.interrupt.check()?;
    // the load between motor and link is that of the bodies that the torques show
    let carried = moving
        .as_ref()
        .filter(|torques| carries_links_alone(&recording, || torques.is_explained()));
    let shown = carried.map(|torques| changed(model, &torques.changes).0);
    let loaded = |recording: &Recording| with_link_torques(shown.as_ref()?, recording);
    let second = validation.as_deref().and_then(loaded);
    let loaded = loaded(&recording);
    let recording = loaded.as_ref().unwrap_or(&recording);
    let options = &Options {
        validation: second.as_ref().or(validation.as_deref()),
        ..options.clone()
    };
    let source = match loaded.is_some() {
        true => LoadSource::Links,
        false => LoadSource::Drives,
    };
    let logs = (recording, options.validation);
    if let Some(links) = of_links(model, logs, source, &options.without) {
        let effects = effects_of(device, options)?;
        return with_links(
            &links,
            (device, model),
            recording,
            (options, &effects, moving),
        );
    }
    let thinned = thinned(recording);
    let recording = thinned.as_ref().unwrap_or(recording);
    let effects = effects_of(device, options)?;
    if torques_alone::applies(device, recording) {
        return torques_alone::diagnose(device, recording, &effects, (options, moving));
    }
    check_recording(device, recording, &channels(device, recording)?)?;
    let elsewhere = options.model.and_then(|_| with_open_base(device));
    check_rig(elsewhere.as_ref().unwrap_or(device), recording)?;
    let base = Base::fit(device, recording, options.loss, &options.interrupt)?;
    let diagnosed = |device: &Device, base: &Base| {
        let case = Case {
            device,
            recording,
            options,
            effects: &effects,
            moving: moving.as_ref(),
        };
        let by_base = |base: &Base| by_base(&case, base);
        match &base.unfinished {
            Some(end) => without_minimum(base, end, &by_base),
            None => by_base(base),
        }
    };
    let Some(corrected) = Corrected::new(device, &base, recording)? else {
        return diagnosed(device, &base);
    };
    // a gap may hide below a noise that is stated too large: judged by what the recording shows of it
    let other = &corrected.device;
    let mut found = match other == device {
        true => diagnosed(device, &base)?,
        false => {
            let base = Base::fit(other, recording, options.loss, &options.interrupt)?;
            diagnosed(other, &base)?
        }
    };
    corrected.report(&mut found, &options.without);
    Ok(found)
}

/// The diagnosis of torques and of encoders on the links of a moving arm.
fn with_links(
    links: &Links,
    (device, model): (&Device, &Device),
    recording: &Recording,
    (options, effects, moving): (&Options<'_>, &[Box<dyn Effect>], Option<ForceAnswer>),
) -> Result<Diagnosis> {
    let both = links.before(model, moving, effects, options.validation.is_some());
    let changes = both.changes.clone();
    let mut found = torques_alone::diagnose(device, recording, &[], (options, Some(both)))?;
    if found.verdict.has_causes() {
        let other = found.corrected.take().unwrap_or_else(|| model.clone());
        let file = links.corrected(&other, &found.causes);
        let devices = (model, Some(&file));
        found.not_in_file = not_in_file(found.verdict, &found.causes, devices, (&changes, true));
        found.not_in_file.push(SLOW_PART.to_owned());
        found.corrected = Some(file);
    }
    for channel in &mut found.gap.channels {
        if channel.channel.starts_with("out") {
            channel.rms_fit = None;
        }
    }
    Ok(found)
}

/// The device with the compliances of a model identified earlier: they are numbers of the base model then, as
/// lengths and angles are. None where the model has none, or the device file says itself what yields.
fn yielding_as(device: &Device, model: &Device) -> Option<Device> {
    if device.has_compliance() || !model.has_compliance() {
        return None;
    }
    let mut yielding = device.clone();
    let of_model = model.surroundings.compliance.iter();
    yielding.surroundings.compliance = of_model
        .map(|joint| JointCompliance {
            fit: joint.fit || joint.rad_per_nm != 0.0,
            ..*joint
        })
        .collect();
    Some(yielding)
}

/// The device with a tracker that stands anywhere: against an earlier model that is a cause, no mistake of the log.
fn with_open_base(device: &Device) -> Option<Device> {
    let mut open = device.clone();
    open.tracker.as_mut()?.base_known = false;
    open.surroundings.tracker_base = None;
    Some(open)
}

/// The diagnosis where the base model's fit has no minimum: from its drives, then from where the search
/// ended. A cause that explains why there is none is an answer; nothing else is.
fn without_minimum(
    base: &Base,
    end: &Unfinished,
    by_base: &dyn Fn(&Base) -> Result<Diagnosis>,
) -> Result<Diagnosis> {
    let there = Base {
        device: end.device.clone(),
        ..base.clone()
    };
    for base in [base, &there] {
        let mut answer = by_base(base)?;
        if answer.verdict.has_causes() {
            answer.warnings.push(format!(
                "the fit without the causes has no minimum ({}): the sizes are rough",
                end.reason
            ));
            return Ok(answer);
        }
    }
    let error = CalibrationError::NotConverged {
        what: "joint identification".to_owned(),
        reason: end.reason.clone(),
    };
    Err(error.into())
}

/// Subject of a diagnosis.
struct Case<'c> {
    device: &'c Device,
    recording: &'c Recording,
    options: &'c Options<'c>,
    effects: &'c [Box<dyn Effect>],
    /// What the torques say, where they are those of a moving arm.
    moving: Option<&'c ForceAnswer>,
}

/// Readings without their outliers, and the postures at which derivatives are taken.
struct Cleaned {
    recording: Recording,
    postures: Recording,
    gone: Vec<(Channel, usize)>,
}

/// The diagnosis against a fitted base model. Where it leaves a gap, or a part of one, without a cause, it is made again with
/// a noise that has a memory, if there may be one: that may be all of the gap, or of what a cause leaves.
fn by_base(case: &Case<'_>, base: &Base) -> Result<Diagnosis> {
    let (found, memory) = by_noise(case, base, None)?;
    // a noise of no stated size is made of what is left: it would account for the rest of any part
    let is_bounded = (base.channels.iter()).all(|channel| is_stated(case.device, *channel));
    let leaves_a_rest = found.closed_unseen_share.is_some();
    let is_open = found.verdict == Verdict::Unknown || (leaves_a_rest && is_bounded);
    for noise in memory.iter().filter(|_| is_open) {
        let (again, _) = by_noise(case, base, Some(noise))?;
        if accounts_for(&again, &found, is_bounded) {
            return Ok(again);
        }
    }
    Ok(found)
}

/// Whether the diagnosis with another noise leaves nothing of the gap that the first one left, and does not contradict it: what
/// the first one found is among what it names. A cause where the first one found none needs a noise of a stated size.
fn accounts_for(again: &Diagnosis, first: &Diagnosis, is_bounded: bool) -> bool {
    match again.verdict {
        Verdict::NoGap => first.verdict == Verdict::Unknown,
        Verdict::Named | Verdict::Ambiguous => {
            // without candidates there is no cause but findings on the data
            let found = (first.causes.first())
                .filter(|_| (first.candidates.iter()).any(|candidate| candidate.refused.is_none()));
            let names = |name: &String| {
                let mut named = again.causes.iter().take(1);
                named.any(|cause| cause.effect == *name || cause.confusable_with.contains(name))
            };
            let agrees = found.map_or(is_bounded, |cause| names(&cause.effect));
            agrees && again.closed_unseen_share.is_none()
        }
        Verdict::Unknown => false,
    }
}

/// Prepare, fit, select, judge, answer; with the noises with a memory that may be what is left.
fn by_noise(
    case: &Case<'_>,
    base: &Base,
    known: Option<&KnownNoise>,
) -> Result<(Diagnosis, Vec<KnownNoise>)> {
    let recording = case.recording;
    let onto = onto_touches(base, recording)?;
    let postures = onto.as_ref().unwrap_or(recording);
    let clean = |gone: Vec<(Channel, usize)>| Cleaned {
        recording: without_readings(recording, &gone),
        postures: without_readings(postures, &gone),
        gone,
    };
    let bases = Bases::default();
    let prepared = Prepared::new(base, recording, postures)?;
    let readings = clean(prepared.outlying());
    let engine = prepared
        .without(&readings.gone, &readings.postures)
        .fit(known)?;
    let (in_base, rest): (Vec<usize>, Vec<usize>) =
        (0..case.effects.len()).partition(|&index| is_in_base(case.effects[index].as_ref(), base));
    let is_tested = |&index: &usize| case.effects[index].untestable(&engine.context).is_none();
    let tested: Vec<usize> = rest.into_iter().filter(is_tested).collect();
    let model = case.options.model;
    let earlier = model
        .map(|model| placed(model, case.device, &readings.recording, &base.channels))
        .transpose()?;
    let judged = |selection: Selection<'_>, readings: &Cleaned| {
        let inputs = Inputs {
            nominal: case.device,
            recording: &readings.recording,
            gone: &readings.gone,
            in_base: &in_base,
            earlier: earlier.as_ref(),
            options: case.options,
            moving: case.moving,
        };
        let memory = selection
            .engine()
            .noises_with_memory(&selection.refit.residual);
        Ok((answer(Findings::new(selection, inputs)?)?, memory))
    };
    let selection = Selector::new(&engine, case.effects, &tested).select(known.is_none())?;
    let again = match known {
        Some(_) => None,
        None => Again::new(&selection, &bases)?,
    };
    let Some(again) = again else {
        return judged(selection, &readings);
    };
    let model = &selection.refit.model;
    let logs = (&readings.recording, &readings.postures);
    let Again { noise, there } = again;
    let (nearer, known) = nearer(&selection, there, logs, &bases)?;
    let cleaned = clean(match noise {
        Some(_) => {
            let streams = &engine.context.streams;
            let context = Context::new(&base.device, postures, streams)?;
            let all = Prepared::of_context(base, recording, postures, context)?;
            all.outlying_beside(case.effects, model)?
        }
        None => readings.gone.clone(),
    });
    let prepared = Prepared::new(nearer, &cleaned.recording, &cleaned.postures)?;
    let alone = &engine.start.model.values;
    let mut engine_there = prepared.fit_from_minimum(alone, noise.as_ref())?;
    engine_there.know(known)?;
    let selection = Selector::new(&engine_there, case.effects, &tested).select(false)?;
    judged(selection, &cleaned)
}

/// Whether the base model has the effect already, or swallows it by its form.
fn is_in_base(effect: &dyn Effect, base: &Base) -> bool {
    let fitted = |joint: usize| {
        base.parameters
            .iter()
            .any(|parameter| matches!(parameter, ParameterId::Transmission { joint: of, .. } if *of == joint))
    };
    let cable = effect.further_cable().map(|cable| (cable + 1) as f64);
    let is_own = |own: &DeviceEffect| {
        own.name == effect.name()
            && own.joint == effect.joint()
            && own.numbers.get("cable").copied() == cable
    };
    if base.device.effects.iter().any(is_own) {
        return true;
    }
    let yields = |joint: usize| base.parameters.contains(&ParameterId::Compliance { joint });
    match effect.spec().absorbed_by {
        Absorbed::ByTransmission | Absorbed::ByInputDrum => effect.joint().is_some_and(fitted),
        Absorbed::ByCompliance => effect.joint().is_some_and(yields),
        Absorbed::ByLengths | Absorbed::ByTorqueScale | Absorbed::Never => false,
    }
}

/// Other names that are understood.
const ALIASES: [(&str, &str); 1] = [("link-compliance", JOINT_COMPLIANCE.name)];

/// The catalogue and the caller's own effects, without those that are to be left out.
fn effects_of(device: &Device, options: &Options<'_>) -> Result<Vec<Box<dyn Effect>>> {
    let mut effects = catalogue(device);
    effects.extend(options.own_effects.into_iter().flat_map(|own| own(device)));
    let mut names = haptical_effects::names();
    names.extend(effects.iter().map(|effect| effect.name()));
    let understood = |name: &String| {
        let alias = ALIASES.iter().find(|(alias, _)| alias == name);
        alias.map_or(name.clone(), |(_, name)| (*name).to_owned())
    };
    let without: Vec<String> = options.without.iter().map(understood).collect();
    for name in &without {
        if !names.contains(&name.as_str()) {
            return Err(DiagnosisError::UnknownEffect {
                name: name.clone(),
                nearest: nearest(name, &names),
            });
        }
    }
    effects.retain(|effect| !without.iter().any(|name| name == effect.name()));
    Ok(effects)
}

/// The name that resembles it most, if any does.
fn nearest(name: &str, names: &[&str]) -> Option<String> {
    let name = name.to_lowercase();
    names
        .iter()
        .map(|other| (strsim::sorensen_dice(&name, other), *other))
        .filter(|(likeness, _)| *likeness > 0.4)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, other)| other.to_owned())
}
