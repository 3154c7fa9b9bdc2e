//! How far the force of a calibrated device may still lean from the wanted direction.

use haptical_metrics::{Interval, chi_square_quantile};
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Evaluation, ForceTransmission, ModelError, Recording, handle_force_n};

use crate::{CalibrationError, ParameterFit};

/// Error of the force's direction that a fit leaves, over the postures of a recording.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct ForceDirection {
    /// Root mean square angle between the wanted force, along the handle's z, and the one exerted \[rad\].
    pub rms_rad: f64,
    /// 95 % interval of it, by the parameters' covariance.
    pub ci95_rad: [f64; 2],
    /// Postures that it is taken over.
    pub postures: usize,
    /// Postures left out: the free joints are nearly singular there.
    pub left_out: usize,
    /// Joint (from 1) taken as locked, of a device with seven.
    pub locked_joint: Option<usize>,
}

/// Postures that are taken from a recording.
const POSTURES: usize = 60;
/// Condition number of the Jacobian from which a posture is left out.
const WORST_CONDITION: f64 = 300.0;
/// Share of a parameter's standard deviation by which it is moved: small against the curvature, large
/// against rounding.
const STEP: f64 = 0.1;
/// The redundant joint of a seven-joint arm, locked as in the paper.
const LOCKED: usize = 2;

/// Error of the force's direction by the covariance of a fit; none for devices of fewer than six or more
/// than seven joints, for a fit of transmissions alone, and where every posture is singular.
///
/// To first order the transverse force is S dp for errors dp of the parameters, so its mean square is the trace
/// of C A with C their covariance and A the mean of S^T S over the postures; the sum of squares is taken for a
/// scaled chi-square with the same mean and variance (Satterthwaite 1946), which gives the interval.
/// Source: docs/equations.md, Force through the transposed Jacobian.
///
/// # Errors
/// [`CalibrationError::Row`] where the device has no value at a row.
pub fn force_direction(
    fit: &ParameterFit,
    recording: &Recording,
) -> Result<Option<ForceDirection>, CalibrationError> {
    let joints = fit.device.joints.len();
    if !fit.device.has_links() || !(6..=7).contains(&joints) || fit.fitted.is_empty() {
        return Ok(None);
    }
    let locked = (joints == 7).then_some(LOCKED);
    let mut free = [0; 6];
    let others = (0..joints).filter(|joint| Some(*joint) != locked);
    for (entry, joint) in free.iter_mut().zip(others) {
        *entry = joint;
    }
    let step = recording.len().div_ceil(POSTURES).max(1);
    let rows: Vec<usize> = (0..recording.len()).step_by(step).collect();
    let wrap = |row: usize| {
        move |source| CalibrationError::Row {
            line: recording.line.get(row).copied().unwrap_or(0),
            source,
        }
    };
    let mut sums = vec![0.0; fit.fitted.len() * fit.fitted.len()];
    let mut postures = 0;
    for &row in &rows {
        let mut readings: Vec<f64> = recording.joint.iter().map(|column| column[row]).collect();
        if let Some(locked) = locked {
            readings[locked] = 0.0;
        }
        let mut truth = Evaluation::new(&fit.device);
        truth.move_to(&readings).map_err(wrap(row))?;
        let Ok(known) = ForceTransmission::new(&truth, &truth, free) else {
            continue;
        };
        if known.condition > WORST_CONDITION {
            continue;
        }
        let slopes = slopes(fit, &truth, &readings, free).map_err(wrap(row))?;
        postures += 1;
        for (a, left) in slopes.iter().enumerate() {
            for (b, right) in slopes.iter().enumerate() {
                sums[a * slopes.len() + b] += left[0] * right[0] + left[1] * right[1];
            }
        }
    }
    if postures == 0 {
        return Ok(None);
    }
    let count = fit.fitted.len();
    // entries of C A, row by row
    let product = |a: usize, b: usize| -> f64 {
        let terms = (0..count).map(|k| fit.uncertainty.covariance[(a, k)] * sums[k * count + b]);
        terms.sum::<f64>() / postures as f64
    };
    let matrix: Vec<f64> = (0..count * count)
        .map(|entry| product(entry / count, entry % count))
        .collect();
    let mean: f64 = (0..count).map(|a| matrix[a * count + a]).sum();
    let square: f64 = (0..count)
        .flat_map(|a| (0..count).map(move |b| (a, b)))
        .map(|(a, b)| matrix[a * count + b] * matrix[b * count + a])
        .sum();
    let Some(ci95_rad) = interval(mean, square) else {
        return Ok(None);
    };
    Ok(Some(ForceDirection {
        rms_rad: mean.max(0.0).sqrt(),
        ci95_rad: [ci95_rad.low, ci95_rad.high],
        postures,
        left_out: rows.len() - postures,
        locked_joint: locked.map(|joint| joint + 1),
    }))
}

/// Roots of the ends of a scaled chi-square with this mean and, in the trace of the square, half its variance.
fn interval(mean: f64, square: f64) -> Option<Interval> {
    if !(mean > 0.0 && square > 0.0 && mean.is_finite() && square.is_finite()) {
        return None;
    }
    let freedom = mean * mean / square;
    let end = |probability: f64| {
        let quantile = chi_square_quantile(probability, freedom).ok()?;
        Some((mean / freedom * quantile).max(0.0).sqrt())
    };
    Some(Interval {
        low: end(0.025)?,
        high: end(0.975)?,
    })
}

/// Derivative of the transverse force of a unit force, per fitted parameter, by central differences of the
/// controller's device.
fn slopes(
    fit: &ParameterFit,
    truth: &Evaluation<'_>,
    readings: &[f64],
    free: [usize; 6],
) -> Result<Vec<[f64; 2]>, ModelError> {
    let mut slopes = Vec::with_capacity(fit.fitted.len());
    for (position, &index) in fit.fitted.iter().enumerate() {
        let parameter = fit.parameters[index];
        let value = parameter.value(&fit.device);
        let step = STEP * fit.uncertainty.standard_deviation(position);
        if !(step > 0.0 && step.is_finite()) {
            slopes.push([0.0; 2]);
            continue;
        }
        let transverse = |sign: f64| {
            let mut device = fit.device.clone();
            parameter.set(&mut device, value + sign * step);
            let mut controller = Evaluation::new(&device);
            controller.move_to(readings)?;
            unit_force(truth, &controller, free)
        };
        let (after, before) = (transverse(1.0)?, transverse(-1.0)?);
        slopes.push([0, 1].map(|axis| (after[axis] - before[axis]) / (2.0 * step)));
    }
    Ok(slopes)
}

/// What a unit force along the handle's z, as the controller knows it, is in the true handle's frame.
fn unit_force(
    truth: &Evaluation<'_>,
    controller: &Evaluation<'_>,
    free: [usize; 6],
) -> Result<Vector3<f64>, ModelError> {
    let transmission = ForceTransmission::new(truth, controller, free)?;
    let force = handle_force_n(&transmission, truth, controller, 1.0, 0.0)?;
    force.ok_or(ModelError::Posture {
        condition: transmission.condition,
    })
}
