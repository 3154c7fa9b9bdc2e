//! The transmissions with an external encoder: form, evidence, parameters, powers of the angle.

use haptical_calibration::{Calibration, TransmissionFit};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;

use crate::candidates::{Candidate, columns};
use crate::judgement::rank_of_one;
use crate::serialised::dictionary;

/// One dictionary for each; the parameters are those of the last fit.
pub(crate) fn transmissions<'py>(
    py: Python<'py>,
    calibration: &Calibration,
    candidates: &[Candidate<'_>],
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let fitted = calibration.fitted.transmissions.iter();
    let entry = |step| transmission(py, calibration, candidates, step);
    fitted.map(entry).collect()
}

fn transmission<'py>(
    py: Python<'py>,
    calibration: &Calibration,
    candidates: &[Candidate<'_>],
    step: &TransmissionFit,
) -> PyResult<Bound<'py, PyDict>> {
    let number = step.joint + 1;
    let told = json!({
        "joint": number,
        "terms": step.terms,
        "range_rad": step.range_rad,
        "evidence": step.evidence,
        "convergence": step.fit.as_ref().map(|fit| fit.convergence),
    });
    let prefix = format!("joint[{number}].");
    let own = candidates.iter();
    let own: Vec<_> = own.filter(|one| one.key.starts_with(&prefix)).collect();
    let powers = calibration.device.joints[step.joint]
        .transmission_error
        .monomials();
    let entry = dictionary(py, Ok(told), &["range_rad"])?;
    entry.set_item("parameters", columns(py, &own)?)?;
    let powers = powers.map(|powers| PyArray1::from_vec(py, powers));
    entry.set_item("polynomial_monomials", powers)?;
    entry.set_item("identifiability", rank_of_one(py, step.fit.as_ref())?)?;
    Ok(entry)
}
