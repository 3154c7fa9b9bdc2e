//! The candidates of a calibration, one after the other: values, intervals, and why some have none.

use haptical_calibration::{Calibration, ParameterFit};
use haptical_identification::{Status, Term};
use haptical_model::{Device as Model, ParameterId, TransmissionError};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use serde_json::json;

use crate::serialised::python;

/// One candidate parameter.
#[derive(Debug)]
pub(crate) struct Candidate<'c> {
    name: &'c str,
    pub(crate) key: String,
    unit: &'c str,
    /// Value in the given device; none where its transmission error has another form.
    nominal: Option<f64>,
    value: Option<f64>,
    standard_deviation: Option<f64>,
    ci95: Option<[f64; 2]>,
    status: &'static str,
    /// Changes of others that act like a unit change of a dependent one.
    combination: Option<&'c [Term]>,
    reason: Option<String>,
}

/// The candidates of all fits. In two steps the whole fit has the kinematics alone; the transmissions come from
/// step 1.
pub(crate) fn candidates<'c>(
    calibration: &'c Calibration,
    fits: &[&'c ParameterFit],
    steps: &[&'c ParameterFit],
) -> Vec<Candidate<'c>> {
    let mut found: Vec<Candidate<'c>> = Vec::new();
    // with the starts of the rig's unknown frames and places, which the log gave
    let (nominal, device) = (&calibration.nominal, &calibration.device);
    for fit in fits.iter().chain(steps) {
        for (index, (&parameter, estimate)) in fit.parameters.iter().zip(&fit.estimates).enumerate()
        {
            // not by key: the three turns of a frame share one
            if found.iter().any(|other| other.name == estimate.name) {
                continue;
            }
            found.push(Candidate {
                name: &estimate.name,
                key: parameter.key(device),
                unit: &estimate.unit,
                nominal: nominal_value(parameter, nominal, device),
                value: estimate.value,
                standard_deviation: estimate.standard_deviation,
                ci95: estimate.ci95,
                status: estimate.status.name(),
                combination: match &estimate.status {
                    Status::Dependent { combination } => Some(combination),
                    _ => None,
                },
                reason: reason(fit, index),
            });
        }
    }
    found
}

/// The candidates column by column; NaN where there is no number.
pub(crate) fn columns<'py>(
    py: Python<'py>,
    candidates: &[&Candidate<'_>],
) -> PyResult<Bound<'py, PyDict>> {
    let text = |of: &dyn Fn(&Candidate<'_>) -> String| {
        PyList::new(py, candidates.iter().map(|candidate| of(candidate)))
    };
    let number = |of: &dyn Fn(&Candidate<'_>) -> Option<f64>| {
        let numbers = candidates.iter().map(|one| of(one).unwrap_or(f64::NAN));
        PyArray1::from_vec(py, numbers.collect())
    };
    let deviation = |one: &Candidate<'_>| {
        let both = one.value.zip(one.nominal);
        both.map(|(value, was)| value - was)
    };
    let combinations = candidates.iter().map(|one| one.combination);
    let reasons = candidates.iter().map(|one| one.reason.as_deref());
    let columns = PyDict::new(py);
    columns.set_item("name", text(&|one| one.name.to_owned())?)?;
    columns.set_item("key", text(&|one| one.key.clone())?)?;
    columns.set_item("unit", text(&|one| one.unit.to_owned())?)?;
    columns.set_item("nominal", number(&|one| one.nominal))?;
    columns.set_item("value", number(&|one| one.value))?;
    columns.set_item("deviation", number(&deviation))?;
    columns.set_item("standard_deviation", number(&|one| one.standard_deviation))?;
    columns.set_item("ci95", intervals(py, candidates)?)?;
    columns.set_item("status", text(&|one| one.status.to_owned())?)?;
    let combinations = json!(combinations.collect::<Vec<_>>());
    columns.set_item("combination", python(py, &combinations, &[])?)?;
    columns.set_item("reason", reasons.collect::<Vec<_>>())?;
    Ok(columns)
}

/// The candidates that kept their nominal values, with the reasons.
pub(crate) fn not_identified<'py>(
    py: Python<'py>,
    candidates: &[Candidate<'_>],
) -> PyResult<Bound<'py, PyAny>> {
    let lacks = |one: &&Candidate<'_>| one.status != "identifiable" || one.value.is_none();
    let refusals: Vec<_> = candidates
        .iter()
        .filter(lacks)
        .filter(|one| one.reason.is_some())
        .map(|one| json!({"name": one.name, "status": one.status, "reason": one.reason}))
        .collect();
    python(py, &refusals.into(), &[])
}

/// Why a parameter has no value.
fn reason(fit: &ParameterFit, index: usize) -> Option<String> {
    let estimate = &fit.estimates[index];
    fit.identifiability.reason(index).or_else(|| {
        let held = || {
            format!(
                "{} was held: it could not be fitted at the nominal device",
                estimate.name
            )
        };
        estimate.value.is_none().then(held)
    })
}

/// The 95 % intervals as rows, of shape [0, 2] where there are none.
fn intervals<'py>(
    py: Python<'py>,
    candidates: &[&Candidate<'_>],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    if candidates.is_empty() {
        return Ok(PyArray2::zeros(py, [0, 2], false));
    }
    let row = |one: &&Candidate<'_>| one.ci95.unwrap_or([f64::NAN; 2]).to_vec();
    let rows: Vec<_> = candidates.iter().map(row).collect();
    Ok(PyArray2::from_vec2(py, &rows)?)
}

/// Value in the given device. A transmission error of zero is zero in every form; one of another form has no
/// such parameter.
fn nominal_value(parameter: ParameterId, nominal: &Model, device: &Model) -> Option<f64> {
    let ParameterId::Transmission { joint, .. } = parameter else {
        return Some(parameter.value(nominal));
    };
    let was = &nominal.joints[joint].transmission_error;
    let now = &device.joints[joint].transmission_error;
    let is_same_form = match (was, now) {
        (
            TransmissionError::Chebyshev {
                range_rad,
                coefficients,
            },
            TransmissionError::Chebyshev {
                range_rad: range,
                coefficients: found,
            },
        ) => range_rad == range && coefficients.len() == found.len(),
        _ => std::mem::discriminant(was) == std::mem::discriminant(now),
    };
    if is_same_form {
        Some(parameter.value(nominal))
    } else {
        (*was == TransmissionError::default()).then_some(0.0)
    }
}
