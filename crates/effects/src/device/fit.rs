//! Numbers of a device's effects as they are fitted, and back.

use haptical_model::{Device, FitNumber, Recording};
use nalgebra::{DMatrix, DVector};

use crate::device::bare::bare;
use crate::device::entry::entry as written;
use crate::device::error::DeviceEffectError;
use crate::device::resolve::{OwnEffect, effects_of, is_place};
use crate::{Context, Effect, Family, Parameter, Role, Unit, streams};

/// Share of the largest plausible size that is a typical one.
const TYPICAL: f64 = 0.1;
/// Plausible change of the logarithm of a shape.
const SHAPE_SIZE: f64 = 1.0;

/// What a calibration fits of an effect: its amplitudes, then how far the logarithm of a continuous shape moves.
pub(super) fn fit_numbers(own: &OwnEffect, context: &Context<'_>) -> Vec<FitNumber> {
    let spec = own.effect.spec();
    let label = own.effect.label();
    let is_drift = spec.family == Family::Drift;
    let (amplitudes, _) = own.amplitudes(context);
    let sizes: Vec<&Parameter> = spec.parameters.iter().filter(|own| own.is_size()).collect();
    let has_phase = spec.parameters.iter().any(|own| own.role == Role::Phase);
    let mut numbers: Vec<FitNumber> = Vec::with_capacity(amplitudes.len() + 1);
    for (index, &value) in amplitudes.iter().enumerate() {
        // an amplitude with a phase has two parts of one unit
        let parameter = sizes.get(index).or(sizes.first());
        let (name, unit, plausible_size) = parameter.map_or_else(
            || (format!("number{}", index + 1), "1", 1.0),
            |parameter| named(parameter, (index, amplitudes.len(), has_phase)),
        );
        numbers.push(FitNumber {
            name: format!("{label}.{name}"),
            unit,
            value,
            plausible_size,
            is_drift,
        });
    }
    if spec.shape.is_continuous() {
        numbers.push(FitNumber {
            name: format!("{label}.log_shape"),
            unit: "1",
            value: 0.0,
            plausible_size: SHAPE_SIZE,
            is_drift,
        });
    }
    numbers
}

/// Name, unit and plausible size of an amplitude.
fn named(
    parameter: &Parameter,
    (index, count, has_phase): (usize, usize, bool),
) -> (String, &'static str, f64) {
    let [low, high] = parameter.plausible;
    let typical = |size: f64| match size.is_finite() && size < 1e9 && size > 0.0 {
        true => TYPICAL * size,
        false => 1.0,
    };
    if parameter.role == Role::Inverse {
        let (name, unit) = match parameter.unit {
            Unit::NewtonMetrePerRadian => ("rad_per_nm", "rad/(N m)"),
            _ => ("compliance", "1"),
        };
        return (name.to_owned(), unit, typical(1.0 / low));
    }
    let (before, unit) = Unit::split(parameter.name);
    let symbol = match unit.symbol() {
        "" => "1",
        symbol => symbol,
    };
    let name = match (has_phase, count) {
        _ if parameter.name == "width_rad" => "half_width_rad".to_owned(),
        (true, _) => {
            let part = ["cos", "sin"][index % 2];
            let suffix = parameter.name.strip_prefix(before).unwrap_or("");
            match index / 2 {
                0 => format!("{part}{suffix}"),
                other => format!("{part}{}{suffix}", other + 1),
            }
        }
        (false, 1) => parameter.name.to_owned(),
        _ => format!("{}[{index}]", parameter.name),
    };
    (name, symbol, typical(high))
}

/// Takes what a calibration fitted back into the names and numbers of a device's effects, with 95 % intervals where the
/// covariance of the fitted numbers is given: `covariance` of an effect (its position within the device) has a row and a
/// column for each of its fitted numbers; none where one of them is not known.
///
/// An end of an interval that the data leave open is none: a compliance that may be 0 is a stiffness of any size.
///
/// # Errors
/// [`DeviceEffectError`].
pub fn settle(
    device: &mut Device,
    recording: &Recording,
    covariance: &dyn Fn(usize) -> Option<DMatrix<f64>>,
) -> Result<(), DeviceEffectError> {
    let own = effects_of(device)?;
    let base = bare(device);
    let channels = haptical_calibration::channels(&base, recording).unwrap_or_default();
    let mut context = Context::new(&base, recording, &streams(&base, &channels))?;
    let mean_degc = context.reference_degc;
    for own in own {
        let entry = &mut device.effects[own.index];
        if entry.fitted.is_empty() {
            continue;
        }
        context.set_reference_degc(own.reference_degc().unwrap_or(mean_degc));
        let effect = own.effect.as_ref();
        let (mut amplitudes, mut shape) = own.amplitudes(&context);
        let fitted: Vec<f64> = entry.fitted.iter().map(|number| number.value).collect();
        for (amplitude, fitted) in amplitudes.iter_mut().zip(&fitted) {
            *amplitude = *fitted;
        }
        if let Some(log) = fitted.get(amplitudes.len()) {
            shape *= log.clamp(-0.7, 0.7).exp();
        }
        let spec = effect.spec();
        entry.intervals.clear();
        if !effect.is_possible(&context, &amplitudes) {
            // nature has no spring of negative stiffness: the data show none of it
            entry.numbers.retain(|name, _| is_place(name));
            continue;
        }
        entry.numbers = written(effect, &context, &amplitudes, shape).numbers;
        let Some(covariance) = covariance(own.index) else {
            continue;
        };
        let found = with_variances(effect, &context, &amplitudes, shape, &covariance);
        let first = (amplitudes[0], covariance[(0, 0)].max(0.0).sqrt());
        for (parameter, (value, variance)) in spec.parameters.iter().zip(found) {
            let relative = match parameter.name == spec.parameters[0].name {
                true => effect.scale_uncertainty(&context),
                false => 0.0,
            };
            if let Some(interval) = interval(parameter, value, variance, (first, relative)) {
                entry.intervals.insert(parameter.name.to_owned(), interval);
            }
        }
    }
    Ok(())
}

/// Two-sided 95 % of a normal distribution.
const HALF_WIDTH: f64 = 1.96;

/// The 95 % interval of a parameter; `relative` is the uncertainty of the scale of what drives the effect, and `first` the
/// first amplitude with its standard deviation. None for numbers that are places, not sizes.
fn interval(
    parameter: &Parameter,
    value: f64,
    variance: f64,
    ((amplitude, sd), relative): ((f64, f64), f64),
) -> Option<[Option<f64>; 2]> {
    match parameter.role {
        Role::Number => None,
        Role::Inverse => {
            let sd = sd.hypot(relative * amplitude);
            let [low, high] = [-1.0, 1.0].map(|side| amplitude + side * HALF_WIDTH * sd);
            let inverse = |compliance: f64| (compliance > 0.0).then(|| 1.0 / compliance);
            Some([inverse(high), inverse(low)])
        }
        _ => {
            let sd = variance.max(0.0).sqrt().hypot(relative * value);
            let ends = [-1.0, 1.0].map(|side| value + side * HALF_WIDTH * sd);
            Some(ends.map(|end| end.is_finite().then_some(end)))
        }
    }
}

/// Values and variances of an effect's numbers, from the covariance of its amplitudes and, last, of the logarithm of a
/// continuous shape: the delta method.
pub fn with_variances(
    effect: &dyn Effect,
    context: &Context<'_>,
    amplitudes: &[f64],
    shape: f64,
    covariance: &DMatrix<f64>,
) -> Vec<(f64, f64)> {
    let here = effect.values(context, amplitudes, shape);
    let mut slopes = DMatrix::zeros(here.len(), covariance.ncols());
    for (number, mut column) in slopes.column_iter_mut().enumerate() {
        let sd = covariance[(number, number)].max(0.0).sqrt();
        let (mut amplitudes, mut shape) = (amplitudes.to_vec(), shape);
        let step = match amplitudes.get_mut(number) {
            Some(amplitude) => {
                let step = (1e-3 * sd).max(1e-9 * amplitude.abs()).max(1e-300);
                *amplitude += step;
                step
            }
            None => {
                shape *= 1e-4_f64.exp();
                1e-4
            }
        };
        let there = effect.values(context, &amplitudes, shape);
        column.copy_from(&((DVector::from_vec(there) - DVector::from_row_slice(&here)) / step));
    }
    let values = here.into_iter().zip(slopes.row_iter());
    values
        .map(|(value, slope)| (value, (slope * covariance * slope.transpose())[0]))
        .collect()
}
