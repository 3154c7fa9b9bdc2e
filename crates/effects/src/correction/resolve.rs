//! A curve from its table in a device file.

use haptical_model::transmission::spline::LEAST_COEFFICIENTS;
use haptical_model::{Device, DeviceEffect};

use super::{Curve, MOST_COEFFICIENTS, NAME, Over, coefficients_key};
use crate::Effect;
use crate::device::DeviceEffectError;

/// The curve as an effect, and the ends of its range.
///
/// # Errors
/// As [`curve_of`].
pub(crate) fn resolved(
    device: &Device,
    index: usize,
    entry: &DeviceEffect,
) -> Result<(Box<dyn Effect>, Vec<f64>), DeviceEffectError> {
    let (curve, joint) = curve_of(device, index, entry)?;
    let range = curve.range.to_vec();
    Ok((curve.at(device, joint), range))
}

/// The curve of a table `[[effect]]` with the name [`NAME`], the `index`-th of the device, and its joint, from 0.
///
/// # Errors
/// [`DeviceEffectError`]: which key is missing, is too many or has no meaning.
pub fn curve_of(
    device: &Device,
    index: usize,
    entry: &DeviceEffect,
) -> Result<(Curve, usize), DeviceEffectError> {
    let label = entry.label();
    let refuse = |why: String| DeviceEffectError::Place {
        label: label.clone(),
        why,
    };
    let Some(joint) = entry.joint.filter(|joint| *joint < device.joints.len()) else {
        return Err(refuse("it is of a joint: give `joint`, from 1".to_owned()));
    };
    if entry.fit {
        let why = "no calibration fits it: leave `fit` out; `haptical diagnose` fits it anew";
        return Err(refuse(why.to_owned()));
    }
    let ends = |over: &Over| {
        let parameters = over.spec(device, joint).parameters;
        [parameters[0].name, parameters[1].name]
    };
    let has_end = |over: &Over| {
        ends(over)
            .iter()
            .any(|key| entry.numbers.contains_key(*key))
    };
    let key = coefficients_key(device, joint);
    let known = || {
        let all = Over::ALL.iter().map(|over| ends(over).join(" and "));
        format!("{key}, with {}", all.collect::<Vec<_>>().join(", or "))
    };
    let missing = |key: &'static str| DeviceEffectError::Missing {
        label: label.clone(),
        key,
        known: known(),
    };
    let over = Over::ALL.into_iter().find(|over| has_end(over));
    let over = over.ok_or_else(|| missing(ends(&Over::Angle)[0]))?;
    let [from_key, to_key] = ends(&over);
    let number = |key: &'static str| {
        let number = entry.numbers.get(key).copied();
        number.ok_or_else(|| missing(key))
    };
    let range = [number(from_key)?, number(to_key)?];
    let lists = entry.lists.keys().filter(|own| *own != key);
    let numbers = entry
        .numbers
        .keys()
        .filter(|own| *own != from_key && *own != to_key);
    if let Some(other) = lists.chain(numbers).next() {
        return Err(DeviceEffectError::Parameter {
            label,
            key: other.clone(),
            nearest: None,
            known: known(),
        });
    }
    if range[1] <= range[0] {
        return Err(DeviceEffectError::Number {
            label,
            key: to_key.to_owned(),
            value: range[1],
            allowed: "it must be above the other end",
        });
    }
    let coefficients = entry.lists.get(key).cloned().ok_or_else(|| missing(key))?;
    let count = coefficients.len();
    if !(LEAST_COEFFICIENTS..=MOST_COEFFICIENTS).contains(&count) {
        return Err(refuse(format!(
            "`{key}` has {count} numbers; a curve of cubic splines has {LEAST_COEFFICIENTS} to {MOST_COEFFICIENTS}"
        )));
    }
    let is_again = |other: &&DeviceEffect| {
        other.name == NAME && other.joint == entry.joint && other.numbers.contains_key(from_key)
    };
    if device.effects[..index].iter().any(|other| is_again(&other)) {
        return Err(DeviceEffectError::Twice { label });
    }
    let curve = Curve {
        over,
        range,
        coefficients,
    };
    Ok((curve, joint))
}
