//! The device with the causes that were named.

use haptical_effects::device::{entry, is_law, settle};
use haptical_effects::{Form, Hook, Role, Shape, Spec, law};
use haptical_model::{Device, DeviceEffect, JointCompliance};
use haptical_motion::Change;

use crate::Result;
use crate::answer::{CauseAnswer, Verdict};
use crate::engine::Cause;
use crate::select::Selection;

/// Name of that temperature.
const REFERENCE_DEGC: &str = "reference_degc";

/// A device with causes.
pub(crate) struct Corrected {
    pub(crate) device: Device,
    /// What it leaves, per stream and row.
    pub(crate) residual: Vec<Vec<f64>>,
}

/// The device as it was fitted together with the causes, with those of them that are part of a device; none without such.
///
/// What an event did is part of the recording: the device does not lose counts again. A cause that the answer does not report is
/// taken out, and the others are fitted without it: the base model's numbers beside it are those of another device.
pub(crate) fn corrected(
    selection: &Selection<'_>,
    verdict: Verdict,
    (causes, changes): (&[CauseAnswer], &[Change]),
) -> Result<Option<Corrected>> {
    if !verdict.has_causes() {
        return Ok(None);
    }
    let engine = selection.engine();
    let answer_of = |cause: &Cause| {
        let effect = selection.effect(cause);
        let is_of_run = |answer: &CauseAnswer| {
            let from_run = answer.parameters.get("from_run");
            from_run.is_none_or(|run| run.value == cause.shape + 1.0)
        };
        let mut answers = causes.iter();
        answers.find(|answer| answer.is_of(effect.name(), effect.joint()) && is_of_run(answer))
    };
    let mut reported = selection.refit.model.clone();
    reported.causes.retain(|cause| answer_of(cause).is_some());
    let alone = match reported.causes.len() == selection.causes().len() {
        true => None,
        false => Some(engine.refit(selection.selector.effects, &reported)?),
    };
    let refit = alone.as_ref().unwrap_or(&selection.refit);
    if !selection.selector.is_possible(&refit.model) {
        return Ok(None);
    }
    let mut device = engine.problem.device_with(&refit.model.values);
    let mut has_any = false;
    // effects that the device had before were fitted with it
    settle(&mut device, engine.context.recording, &|_| None)?;
    for answer in causes.iter().filter(|answer| !answer.earlier.is_empty()) {
        // of an effect that the device had, the size is another one
        let is_it = |own: &&mut DeviceEffect| answer.is_of(&own.name, own.joint);
        for own in device.effects.iter_mut().filter(is_it) {
            own.intervals = answer.as_effect().intervals;
            own.fit = true;
            has_any = true;
        }
    }
    for cause in &refit.model.causes {
        let effect = selection.effect(cause);
        let Some(answer) = answer_of(cause) else {
            continue;
        };
        if !is_of_device(effect.spec()) {
            continue;
        }
        has_any = true;
        let found = entry(effect, &engine.context, &cause.amplitudes, cause.shape);
        let found = DeviceEffect {
            intervals: answer.as_effect().intervals,
            confusable_with: answer.confusable_with.clone(),
            fit: true,
            ..found
        };
        match effect.joint() {
            Some(joint) if effect.spec().hook == Hook::Joint => {
                let joints = device.joints.len();
                let compliance = &mut device.surroundings.compliance;
                compliance.resize(joints, JointCompliance::default());
                compliance[joint] = JointCompliance {
                    rad_per_nm: cause.amplitudes[0],
                    fit: true,
                };
            }
            _ => device.effects.push(found),
        }
    }
    let drives = drive_effects(causes, engine.context.reference_degc);
    let (mut device, has_changed) = changed(&device, changes);
    has_any |= has_changed || !drives.is_empty();
    drives.into_iter().for_each(|found| add(&mut device, found));
    Ok(has_any.then_some(Corrected {
        device,
        residual: engine.exact_residual(selection.selector.effects, &refit.model),
    }))
}

/// What a moving arm's torques were judged with, where the device with its causes does not hold it.
pub const BESIDE_TORQUES: &str = "friction, armature, offsets and delay of the drives, which the fit of the torques has beside the causes: \
                              `haptical identify --with dynamics` finds them";

/// What an answer rests on, and the device with its causes does not hold; `file` is none where no such device is written, and
/// `before` the device without the causes, to which the changes of its masses, armatures and gravity were applied.
pub(crate) fn not_in_file(
    verdict: Verdict,
    causes: &[CauseAnswer],
    (before, file): (&Device, Option<&Device>),
    (changes, is_moving): (&[Change], bool),
) -> Vec<String> {
    if !verdict.has_causes() {
        return Vec::new();
    }
    let is_changed = |cause: &CauseAnswer| {
        let joint = cause.joint.map(|joint| joint - 1);
        let form = law(&cause.effect).map(|law| law.1);
        let mut numbers = cause.parameters.keys();
        let is_of_angle = numbers.any(|name| name.starts_with("offset"));
        let of_kind = |change: &&Change| match change {
            Change::Inertia { .. } => form == Some(Form::Mass),
            Change::Armature { joint: own, .. } => {
                form == Some(Form::Armature) && joint == Some(*own)
            }
            Change::Offset { joint: of, .. } => {
                form == Some(Form::Offset) && is_of_angle && joint == Some(*of)
            }
            Change::TorqueOffset { joint: of, .. } => {
                form == Some(Form::Offset) && !is_of_angle && joint == Some(*of)
            }
            Change::TorqueDelay { joint: of, .. } => form == Some(Form::Delay) && joint == *of,
            Change::Gravity { .. } => form == Some(Form::Tilt),
        };
        let is_applied = |change: &Change| file.is_some() && change.applied(before).is_some();
        changes.iter().filter(of_kind).any(is_applied)
    };
    let is_held = |cause: &CauseAnswer| {
        let joint = cause.joint.map(|joint| joint - 1);
        let is_it = |own: &DeviceEffect| cause.is_of(&own.name, own.joint);
        let yields = |file: &Device| {
            let is_compliance = law(&cause.effect).is_some_and(|law| law.0 == Hook::Joint);
            is_compliance && joint.is_some_and(|joint| file.compliance_rad_per_nm(joint) != 0.0)
        };
        file.is_some_and(|file| file.effects.iter().any(is_it) || yields(file))
            || !cause.changed.is_empty()
            || is_changed(cause)
    };
    let is_of_base = |spec: &&Spec| spec.hook == Hook::BaseModel;
    let word = |cause: &CauseAnswer| {
        let spec = haptical_effects::spec(&cause.effect);
        if spec.is_some_and(|spec| is_of_base(&spec)) && file.is_some() {
            return None;
        }
        let why = match spec {
            Some(spec) if spec.shape == Shape::Event => {
                "it happened in this log, and is no part of the device"
            }
            Some(spec) => is_law(spec)
                .err()
                .unwrap_or("the torques show it, and a device file has it for positions alone"),
            None => "it is no law of a device file",
        };
        Some(format!("{} at {}: {why}", cause.effect, cause.place()))
    };
    let mut words: Vec<String> = (causes.iter().filter(|cause| !is_held(cause)))
        .filter_map(word)
        .collect();
    let is_beside = is_moving && file.is_some();
    words.extend(is_beside.then(|| BESIDE_TORQUES.to_owned()));
    words
}

/// The device with the causes that its drives' torques show; none without such. `changes`: of its masses, armatures and gravity.
pub(crate) fn of_drives(
    device: &Device,
    verdict: Verdict,
    (causes, changes, reference_degc): (&[CauseAnswer], &[Change], f64),
) -> Option<Device> {
    if !verdict.has_causes() {
        return None;
    }
    let effects = drive_effects(causes, reference_degc);
    let has_any = !effects.is_empty() || !device.effects.is_empty();
    let (mut device, has_changed) = changed(device, changes);
    effects
        .into_iter()
        .for_each(|found| add(&mut device, found));
    (has_any || has_changed).then_some(device)
}

/// The device with changes of its masses, armatures and gravity, and whether there is one.
pub(crate) fn changed(device: &Device, changes: &[Change]) -> (Device, bool) {
    changes.iter().fold(
        (device.clone(), false),
        |(device, has_any), own| match own.applied(&device) {
            Some(device) => (device, true),
            None => (device, has_any),
        },
    )
}

/// Adds an effect on torques to a device: one that it has already was taken off the readings, and what was found is its change.
fn add(device: &mut Device, found: DeviceEffect) {
    let is_same = |own: &&mut DeviceEffect| {
        let order = |effect: &DeviceEffect| effect.numbers.get("order").copied();
        own.name == found.name && own.joint == found.joint && order(own) == order(&found)
    };
    let Some(own) = device.effects.iter_mut().find(is_same) else {
        device.effects.push(found);
        return;
    };
    let number = |effect: &DeviceEffect, name: &str| effect.numbers.get(name).copied();
    let is_whole = |spec: &&Spec| {
        let mut parameters = spec.parameters.iter();
        spec.name == found.name && parameters.all(|own| found.numbers.contains_key(own.name))
    };
    let parameters = haptical_effects::specs().find(is_whole);
    let parameters = parameters.map_or([].as_slice(), |spec| spec.parameters);
    let phase = parameters.iter().find(|own| own.role == Role::Phase);
    for size in parameters.iter().filter(|own| own.role == Role::Size) {
        let (Some(before), Some(change)) = (number(own, size.name), number(&found, size.name))
        else {
            continue;
        };
        let now = match phase.map(|phase| phase.name) {
            // A cos(x - a) + B cos(x - b)
            Some(name) => {
                let [a, b] =
                    [number(own, name), number(&found, name)].map(|own| own.unwrap_or(0.0));
                let cosine = before * a.cos() + change * b.cos();
                let sine = before * a.sin() + change * b.sin();
                own.numbers.insert(name.to_owned(), sine.atan2(cosine));
                own.intervals.remove(name);
                sine.hypot(cosine)
            }
            None => before + change,
        };
        if let Some(interval) = found.intervals.get(size.name) {
            let moved = interval.map(|end| end.map(|end| end - change + now));
            own.intervals.insert(size.name.to_owned(), moved);
        }
        own.numbers.insert(size.name.to_owned(), now);
    }
}

/// Effects on torques, whose reported parameters are all that their laws have, but for the temperature at which nothing has
/// grown.
fn drive_effects(causes: &[CauseAnswer], reference_degc: f64) -> Vec<DeviceEffect> {
    let of_cause = |cause: &CauseAnswer| {
        let is_whole = |spec: &&Spec| {
            let mut parameters = spec.parameters.iter();
            spec.name == cause.effect
                && spec.hook.is_on_drives()
                && is_law(spec).is_ok()
                && spec.further.iter().all(|own| own.name == REFERENCE_DEGC)
                && spec.parameters.len() == cause.parameters.len()
                && parameters.all(|own| cause.parameters.contains_key(own.name))
        };
        let spec = haptical_effects::specs().find(is_whole)?;
        let reference = spec.further.iter();
        let reference = reference.map(|own| (own.name.to_owned(), reference_degc));
        let mut effect = cause.as_effect();
        effect.numbers.extend(reference);
        Some(effect)
    };
    causes.iter().filter_map(of_cause).collect()
}

/// Whether an effect is part of a device, so that it is there in the next recording too.
fn is_of_device(spec: &Spec) -> bool {
    is_law(spec).is_ok() && spec.shape != Shape::Event
}
