//! Effects that an identification is asked to fit: `EFFECT`, `EFFECT@JOINT`, or the causes of a gap.json.

use haptical_diagnosis::{BEHIND_A_LOW_PASS, effects_between};
use haptical_effects::device::{DeviceEffectError, PLACES, effects_of, laws};
use haptical_effects::{Follows, Form, Hook, law, spec};
use haptical_model::{Device as Model, DeviceEffect, JointCompliance};
use serde_json::Value;

use crate::error::Error;

/// The parameter that names the other joint.
const FROM: &str = "from_joint";
/// The parameter that names the run from which on a displacement is there.
const FROM_RUN: &str = "from_run";
/// Another name of the joints' compliance.
const ALIAS: &str = "link-compliance";

/// Adds the effects of a word to a model, to be fitted.
///
/// # Errors
/// A name that is no law, a joint that cannot have it.
pub(super) fn add(model: &mut Model, word: &str) -> Result<(), Error> {
    let refuse = |what: String, next: &str| Error::command_line("with", what, next);
    let (name, joint) = match word.split_once('@') {
        None => (word, None),
        Some((name, number)) => {
            let joints = model.joints.len();
            let index = number
                .parse::<usize>()
                .ok()
                .and_then(|joint| joint.checked_sub(1));
            let index = index.filter(|index| *index < joints).ok_or_else(|| {
                let what = format!("--with {word}: `{number}` is no joint");
                refuse(what, &format!("give a joint from 1 to {joints}"))
            })?;
            (name, Some(index))
        }
    };
    if name == ALIAS || law(name).is_some_and(|law| law.0 == Hook::Joint) {
        yielding(model, joint);
        return Ok(());
    }
    let before = model.effects.len();
    let mut last = push(model, one(name, joint)).err();
    // of an effect of joints: every joint that can have it; of one of pairs, from every other joint
    if last.is_some() && laws().any(|spec| spec.name == name) {
        let joints = joint.map_or(0..model.joints.len(), |joint| joint..joint + 1);
        for joint in joints {
            let alone = push(model, one(name, Some(joint)));
            let is_of_pair = laws().any(|spec| spec.name == name && spec.parameter(FROM).is_some());
            last = match alone {
                Err(_) if is_of_pair => from_every_other(model, name, joint),
                alone => alone.err(),
            };
        }
    }
    match last {
        Some(error) if model.effects.len() == before => Err(refused(word, &error)),
        _ => Ok(()),
    }
}

/// Adds an effect of one joint by another, from every other joint.
fn from_every_other(model: &mut Model, name: &str, joint: usize) -> Option<DeviceEffectError> {
    let others = (0..model.joints.len()).filter(|other| *other != joint);
    let mut last = None;
    for other in others.collect::<Vec<usize>>() {
        let mut effect = one(name, Some(joint));
        effect.numbers.insert(FROM.to_owned(), (other + 1) as f64);
        last = push(model, effect).err();
    }
    last
}

/// Adds the causes of a gap.json.
///
/// # Errors
/// It is none, or has no cause that is a law.
pub(super) fn add_causes(model: &mut Model, text: &str, file: &str) -> Result<(), Error> {
    let refuse = |what: &str| {
        let next = "give a gap.json that `haptical diagnose` wrote, with causes";
        Error::bad_input("with", what, file, next)
    };
    let gap: Value = serde_json::from_str(text).map_err(|_| refuse("it is no JSON"))?;
    let causes = gap.get("causes").and_then(Value::as_array);
    let causes = causes.ok_or_else(|| refuse("it has no `causes`"))?;
    let held_out = gap.get("held_out").and_then(Value::as_str);
    let is_of_motion = held_out.is_some_and(|own| own.contains(BEHIND_A_LOW_PASS));
    let mut count = 0;
    for cause in causes {
        let name = cause.get("effect").and_then(Value::as_str);
        let name = name.ok_or_else(|| refuse("a cause has no `effect`"))?;
        let number = cause.get("joint").and_then(Value::as_u64);
        let joint = number.and_then(|joint| usize::try_from(joint).ok()?.checked_sub(1));
        let law = law(name);
        if law == Some((Hook::Joint, Form::Spring)) {
            yielding(model, joint);
            count += 1;
            continue;
        }
        // what a motion shows between motor and link behind a low pass: a fit of all readings beside transmission terms has more
        // noise, and terms that follow the angle as the torque of a weight does; it does not ask for these numbers once more
        let is_between = matches!(
            law,
            Some(
                (Hook::Transmission, Form::Play | Form::Spring)
                    | (Hook::ExternalEncoder, Form::Delay)
            )
        );
        if is_of_motion && is_between {
            let number = |key: &str| {
                let own = cause.get("parameters")?.get(key)?;
                let ends = own.get("ci95").and_then(Value::as_array);
                let ends = ends.and_then(|all| Some([all.first()?.as_f64(), all.get(1)?.as_f64()]));
                Some((own.get("value")?.as_f64()?, ends.unwrap_or_default()))
            };
            for effect in effects_between(name, joint, &number) {
                hold(model, effect).map_err(|error| refused(name, &error))?;
                count += 1;
            }
            continue;
        }
        let mut effect = one(name, joint);
        // where it is, not how large: that is fitted
        for key in PLACES {
            let parameter = cause.get("parameters").and_then(|all| all.get(key));
            let value = parameter
                .and_then(|own| own.get("value"))
                .and_then(Value::as_f64);
            effect
                .numbers
                .extend(value.map(|value| (key.to_owned(), value)));
        }
        match push(model, effect) {
            Ok(()) => count += 1,
            // what is said of the readings, or of the base model, is nothing to add
            Err(DeviceEffectError::NoLaw { .. }) => {}
            Err(error) => return Err(refused(name, &error)),
        }
    }
    match count {
        0 => Err(refuse("none of its causes is a law that a device can have")),
        _ => Ok(()),
    }
}

/// Puts an effect into a model in the place of its own one there, with numbers that stay.
fn hold(model: &mut Model, effect: DeviceEffect) -> Result<(), DeviceEffectError> {
    let is_there = |own: &DeviceEffect| own.name == effect.name && own.joint == effect.joint;
    model.effects.retain(|own| !is_there(own));
    model.effects.push(effect);
    effects_of(model).map(|_| ())
}

/// Lets a joint, or every joint, yield to its torque.
fn yielding(model: &mut Model, joint: Option<usize>) {
    match joint {
        None => model.fit_compliance(),
        Some(joint) => {
            let joints = model.joints.len();
            let compliance = &mut model.surroundings.compliance;
            compliance.resize(joints, JointCompliance::default());
            if let Some(own) = compliance.get_mut(joint) {
                own.fit = true;
            }
        }
    }
}

/// An effect to be fitted; a displacement that no run is stated of is from the second one on.
fn one(name: &str, joint: Option<usize>) -> DeviceEffect {
    let is_of_runs = spec(name).is_some_and(|spec| spec.follows == Follows::Run);
    let from_run = is_of_runs.then(|| (FROM_RUN.to_owned(), 2.0));
    DeviceEffect {
        name: name.to_owned(),
        joint,
        numbers: from_run.into_iter().collect(),
        fit: true,
        ..DeviceEffect::default()
    }
}

/// Adds an effect, or lets one that the model has be fitted.
fn push(model: &mut Model, effect: DeviceEffect) -> Result<(), DeviceEffectError> {
    let is_of_runs = spec(&effect.name).is_some_and(|spec| spec.follows == Follows::Run);
    // a displacement of a file that states no run is from the second one on, as one of these is
    let number = |own: &DeviceEffect, key: &String| match own.numbers.get(key) {
        None if is_of_runs && key == FROM_RUN => Some(2.0),
        stated => stated.copied(),
    };
    let is_same = |own: &&mut DeviceEffect| {
        own.name == effect.name
            && own.joint == effect.joint
            && effect
                .numbers
                .iter()
                .all(|(key, value)| number(own, key) == Some(*value))
    };
    if let Some(own) = model.effects.iter_mut().find(is_same) {
        own.fit = true;
        return Ok(());
    }
    let name = effect.name.clone();
    model.effects.push(effect);
    let found = effects_of(model);
    let is_payload = found.is_ok() && law(&name).is_some_and(|law| law.1 == Form::Mass);
    if found.is_err() || is_payload {
        model.effects.pop();
    }
    if is_payload {
        let why = "it is of some runs alone, and identify fits none; `haptical diagnose` finds it";
        return Err(DeviceEffectError::NoLaw { name, why });
    }
    found.map(|_| ())
}

fn refused(word: &str, error: &DeviceEffectError) -> Error {
    let text = error.to_string();
    let what = text.strip_prefix("[[effect]] ").unwrap_or(&text);
    let (what, next) = what.split_once("; ").unwrap_or((
        what,
        "`haptical diagnose --list` has the effects with their places",
    ));
    Error::command_line("with", format!("--with {word}: {what}"), next)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Joints that turn and that slide have springs and plays of the same laws, whose numbers a file has under one name; of a spring
    /// that hardens it has the secant.
    #[test]
    fn what_a_motion_shows_between_motor_and_link_is_read_again_at_every_kind_of_joint() {
        let joint =
            |kind: &str| format!("[[joint]]\ntype = \"{kind}\"\ntransmission = \"direct\"\n");
        let text = joint("revolute") + &joint("prismatic");
        let mut model = Model::from_toml(&text, "two.toml").unwrap().device;
        let gap = format!(
            r#"{{"held_out": "a fifth of the log in turn, {BEHIND_A_LOW_PASS}", "causes": [
                {{"effect": "capstan-compliance", "joint": 1, "parameters": {{
                    "stiffness_nm_per_rad": {{"value": 900.0, "ci95": [800.0, 1000.0]}},
                    "secant_stiffness_nm_per_rad": {{"value": 1100.0, "ci95": [1000.0, 1200.0]}}}}}},
                {{"effect": "backlash", "joint": 2, "parameters": {{
                    "width_m": {{"value": 2e-4, "ci95": [1e-4, 3e-4]}},
                    "secant_stiffness_n_per_m": {{"value": 7e5, "ci95": [6e5, 8e5]}},
                    "stiffness_n_per_m": {{"value": 5e5, "ci95": [4e5, 6e5]}}}}}}]}}"#
        );
        add_causes(&mut model, &gap, "gap.json").unwrap();
        let again = model.to_toml(&text, "two.toml").unwrap();
        let again = Model::from_toml(&again, "again.toml").unwrap().device;
        let found = effects_of(&again).unwrap();
        let found: Vec<(&str, Option<f64>)> = found
            .iter()
            .map(|own| {
                (
                    own.effect.name(),
                    own.values.as_ref().map(|values| values[0]),
                )
            })
            .collect();
        let wanted = [
            ("capstan-compliance", 1100.0),
            ("backlash", 2e-4),
            ("capstan-compliance", 7e5),
        ];
        assert_eq!(found, wanted.map(|(name, value)| (name, Some(value))));
    }

    #[test]
    fn each_displacement_is_fitted_from_its_run_on() {
        let row = "[[link]]\na_m = 0.1\nalpha_rad = 0.0\nd_m = 0.0\n";
        let text = format!("[[joint]]\n{row}{row}[tracker]\nbase = \"unknown\"\n");
        let mut model = Model::from_toml(&text, "one.toml").unwrap().device;
        let cause = |run: u32| {
            format!(
                r#"{{"effect": "tracker-moved", "parameters": {{"from_run": {{"value": {run}.0}}}}}}"#
            )
        };
        let gap = format!(r#"{{"causes": [{}, {}]}}"#, cause(3), cause(2));
        add_causes(&mut model, &gap, "gap.json").unwrap();
        let runs: Vec<f64> = model
            .effects
            .iter()
            .map(|effect| effect.numbers["from_run"])
            .collect();
        assert_eq!(runs, [3.0, 2.0]);
        assert!(model.has_numbers_of_runs());
        let recording = haptical_model::Recording {
            joint: vec![vec![0.0; 6]],
            run: Some(vec![0, 0, 1, 1, 2, 2]),
            ..haptical_model::Recording::default()
        };
        let context = haptical_effects::Context::new(&model, &recording, &[]).unwrap();
        let shapes = effects_of(&model).unwrap().into_iter();
        let shapes: Vec<f64> = shapes.map(|effect| effect.amplitudes(&context).1).collect();
        assert_eq!(shapes, [2.0, 1.0]);
    }
}
