//! What is known of the fits' quality: rank, intervals, other minima, correlations, noise, the force's direction.

use haptical_calibration::{Calibration, ForceDirection, ParameterFit, Weights, force_direction};
use haptical_identification::Identifiability;
use haptical_model::{Device as Model, Recording, TransmissionKind};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::{Map, Value, json};

use crate::failure::Failure;
use crate::serialised::python;

/// Keys under which numbers stand in a row.
const ARRAYS: [&str; 3] = ["singular_values", "gap", "ci95_rad"];

/// Names and correlation of two parameters.
pub(crate) type Correlation = (String, String, f64);

/// How the intervals of a fit were made.
pub(crate) fn intervals<'py>(
    py: Python<'py>,
    fit: Option<&&ParameterFit>,
) -> PyResult<Bound<'py, PyAny>> {
    python(py, &json!(fit.map(|fit| fit.intervals())), &[])
}

/// Searches from other places, where the first one was doubted; none without a fit of the whole device.
pub(crate) fn search<'py>(
    py: Python<'py>,
    calibration: &Calibration,
) -> PyResult<Bound<'py, PyAny>> {
    let whole = calibration.fitted.whole.as_ref();
    python(py, &json!(whole.map(|whole| &whole.starts)), &[])
}

/// Rank and conditioning of the fits at the solution and at the given device.
pub(crate) fn identifiability<'py>(
    py: Python<'py>,
    fits: &[&ParameterFit],
) -> PyResult<Bound<'py, PyAny>> {
    let solution: Vec<_> = fits.iter().map(|fit| &fit.identifiability).collect();
    let nominal: Vec<_> = fits
        .iter()
        .map(|fit| &fit.nominal_identifiability)
        .collect();
    let mut entry = ranks(&solution);
    entry.insert("at_nominal".to_owned(), ranks(&nominal).into());
    python(py, &entry.into(), &ARRAYS)
}

/// Rank and conditioning of one transmission's own fit.
pub(crate) fn rank_of_one<'py>(
    py: Python<'py>,
    fit: Option<&ParameterFit>,
) -> PyResult<Bound<'py, PyAny>> {
    let entry = fit.map(|fit| ranks(&[&fit.identifiability]));
    python(py, &entry.map_or(Value::Null, Value::from), &ARRAYS)
}

/// The figures of one judgement; of several the sums, and none that belong to a single matrix.
fn ranks(judged: &[&Identifiability]) -> Map<String, Value> {
    let sum = |of: fn(&Identifiability) -> usize| judged.iter().map(|one| of(one)).sum::<usize>();
    let only = match judged {
        [only] => Some(only),
        _ => None,
    };
    let singular_values = only.map(|only| only.singular_values.as_slice());
    let entries = [
        ("rank", json!(sum(|one| one.rank))),
        ("candidates", json!(sum(|one| one.names.len()))),
        ("singular_rank", json!(sum(|one| one.singular_rank))),
        (
            "condition_unit_norm",
            json!(only.map(|only| only.condition_unit_norm)),
        ),
        (
            "singular_values",
            json!(singular_values.unwrap_or_default()),
        ),
        ("gap", json!(only.map(|only| only.gap))),
        ("observability", json!(only.map(|only| only.observability))),
    ];
    let named = entries.map(|(name, entry)| (name.to_owned(), entry));
    named.into_iter().collect()
}

/// Pairs of parameters whose errors go together, the highest correlation first.
pub(crate) fn correlations(fits: &[&ParameterFit]) -> Vec<Correlation> {
    fits.iter()
        .flat_map(|fit| fit.high_correlations())
        .collect()
}

/// How far the force of the calibrated device may lean; none for an arm without drives of this kind, which
/// renders no force at its handle.
pub(crate) fn force_leans(
    device: &Model,
    calibration: &Calibration,
    recording: &Recording,
) -> Result<Option<ForceDirection>, Failure> {
    let mut drives = device.joints.iter().map(|joint| joint.transmission);
    let renders = drives.any(|drive| drive != TransmissionKind::Direct);
    match &calibration.fitted.whole {
        Some(whole) if renders => Ok(force_direction(whole, recording)?),
        _ => Ok(None),
    }
}

/// The same as a dictionary.
pub(crate) fn force<'py>(
    py: Python<'py>,
    force: Option<&ForceDirection>,
) -> PyResult<Bound<'py, PyAny>> {
    python(py, &json!(force), &ARRAYS)
}

/// Stated noise of each channel, and the factor on it that the fit used.
pub(crate) fn noise<'py>(py: Python<'py>, weights: &Weights) -> PyResult<Bound<'py, PyDict>> {
    let channels = PyDict::new(py);
    for (channel, stated) in &weights.channel_sd {
        let factor = weights.factor.get(channel).copied().unwrap_or(1.0);
        let entry = PyDict::new(py);
        entry.set_item("stated", stated)?;
        entry.set_item("factor", factor)?;
        channels.set_item(channel.name(), entry)?;
    }
    Ok(channels)
}
