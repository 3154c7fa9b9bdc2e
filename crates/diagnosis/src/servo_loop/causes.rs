//! Findings of a joint as causes.

use std::collections::BTreeMap;

use haptical_effects::{Form, Hook, law};
use haptical_model::{Device, JointType};
use haptical_servo::{Finding, Instant, Number};

use crate::answer::{CauseAnswer, HeldOutAnswer, ParameterAnswer};
use crate::thresholds::servo::SURE_CLASS;

/// Whether an effect is the scale of a torque.
pub(super) fn is_of_torque(effect: &str) -> bool {
    law(effect) == Some((Hook::Torque, Form::Scale))
}

/// A change of the scale of a joint's torques: no part of what its positions leave.
pub(super) fn of_torque(joint: usize, finding: &Finding) -> CauseAnswer {
    let mut parameters: BTreeMap<String, ParameterAnswer> = (finding.numbers.iter())
        .map(|number| (number.name.to_owned(), value(number)))
        .collect();
    parameters.extend(finding.since.map(since));
    CauseAnswer {
        class_probability: SURE_CLASS,
        parameters,
        ..CauseAnswer::named(finding.effect, Some(joint), SURE_CLASS)
    }
}

/// A finding at a joint; `weight` is the joint's share of the gap.
pub(super) fn cause(
    device: &Device,
    joint: usize,
    finding: &Finding,
    weight: f64,
    held_out: HeldOutAnswer,
) -> CauseAnswer {
    let slides = device.joints[joint].joint_type == JointType::Prismatic;
    let mut parameters: BTreeMap<String, ParameterAnswer> = finding
        .numbers
        .iter()
        .map(|number| (named(number, slides), value(number)))
        .collect();
    parameters.extend(finding.since.map(since));
    CauseAnswer {
        class_probability: SURE_CLASS,
        confusable_with: (finding.confusable_with.iter())
            .map(|name| (*name).to_owned())
            .collect(),
        parameters,
        share: finding.share * weight,
        held_out: Some(held_out),
        ..CauseAnswer::named(
            finding.effect,
            Some(joint),
            SURE_CLASS * finding.probability(),
        )
    }
}

fn named(number: &Number, slides: bool) -> String {
    match slides {
        true => number.name.replace("_rad", "_m"),
        false => number.name.to_owned(),
    }
}

fn value(number: &Number) -> ParameterAnswer {
    ParameterAnswer {
        value: number.value,
        ci95: number.ci95,
    }
}

/// When it came about: the time in its run, or the first run after it.
fn since(instant: Instant) -> (String, ParameterAnswer) {
    let [first, at, last] = instant.time_s;
    match instant.between_runs {
        Some([_, after]) => {
            let value = after as f64;
            let ci95 = [value, value];
            ("from_run".to_owned(), ParameterAnswer { value, ci95 })
        }
        None => {
            let ci95 = [first, last];
            ("time_s".to_owned(), ParameterAnswer { value: at, ci95 })
        }
    }
}

/// A change in words, for the place and the warnings.
pub(super) fn changed(joint: usize, finding: &Finding) -> Option<String> {
    let since = finding.since?;
    let size = finding.numbers.first()?.value;
    let what = match law(finding.effect)?.1 {
        Form::Offset => format!("its offset changed by {:.1} degrees", size.to_degrees()),
        Form::Delay => format!("its delay changed by {:.0} ms", size * 1e3),
        _ if is_of_torque(finding.effect) => {
            format!("the scale of its torque changed by a factor {size:.2}")
        }
        _ => format!("its gain changed by a factor {size:.2}"),
    };
    Some(format!("joint {}: {since} {what}", joint + 1))
}
