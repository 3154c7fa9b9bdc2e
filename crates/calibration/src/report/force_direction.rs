//! The angle by which the force of a calibrated device may still lean from the wanted direction.

use haptical_metrics::quadratic_form_interval;
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Evaluation, ModelError, ParameterId, Recording, TrueSide};

use crate::error::at_row;
use crate::report::open_direction::open_directions;
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
    /// Parameters that the recording does not fix and that turn the force: no figure above contains them.
    pub open_through: Vec<String>,
    /// The root mean square angle if those err by their plausible sizes as well \[rad\].
    pub rms_with_open_rad: f64,
}

/// Postures that are taken from a recording.
const POSTURES: usize = 60;
/// Condition number of the Jacobian from which a posture is left out.
const WORST_CONDITION: f64 = 300.0;
/// Share of a parameter's standard deviation by which it is moved: small against the curvature, large
/// against rounding.
const STEP: f64 = 0.1;
/// Probability that the interval holds the angle.
const LEVEL: f64 = 0.95;
/// Share of the angle that a plausible error of an open parameter must make to be named.
const NOTABLE: f64 = 0.1;
/// The redundant joint of a seven-joint arm, locked as in the paper.
const LOCKED: usize = 2;

/// Error of the force's direction by the covariance of a fit; none for devices of fewer than six or more
/// than seven joints, for a fit of transmissions alone, and where every posture is singular.
///
/// To first order the transverse force is S dp for errors dp of the parameters, so its mean square is dp^T A dp with
/// A the mean of S^T S over the postures: a quadratic form in normal numbers of covariance C, held weak parameters
/// included. Its mean is the trace of C A, its interval that of [`haptical_metrics::quadratic_form_interval`].
/// Source: docs/equations.md, Force through the transposed Jacobian.
///
/// # Errors
/// [`CalibrationError::Row`] where the device has no value at a row.
pub fn force_direction(
    fit: &ParameterFit,
    recording: &Recording,
) -> Result<Option<ForceDirection>, CalibrationError> {
    let joints = fit.device.joints.len();
    // a wrench of one hand says nothing of another's joints
    let is_one_arm = fit.device.has_links() && !fit.device.has_hands();
    if !is_one_arm || !(6..=7).contains(&joints) || fit.fitted.is_empty() {
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
    let (uncertain, covariance) = fit.uncertain();
    let count = uncertain.len();
    let deviation = |entry: usize| covariance[(entry, entry)].sqrt();
    let single = uncertain.iter().enumerate();
    let moves: Vec<Move> = single
        .map(|(entry, &parameter)| (vec![(parameter, 1.0)], STEP * deviation(entry)))
        .collect();
    let open = open_directions(fit);
    let open_moves = open
        .iter()
        .map(|open| (open.terms.clone(), STEP * open.size));
    let open_moves: Vec<Move> = open_moves.collect();
    let mut postures = Vec::with_capacity(rows.len());
    for &row in &rows {
        let mut readings: Vec<f64> = recording.joint.iter().map(|column| column[row]).collect();
        if let Some(locked) = locked {
            readings[locked] = 0.0;
        }
        let mut truth = Evaluation::new(&fit.device);
        truth.move_to(&readings).map_err(at_row(recording, row))?;
        let Ok(truth) = TrueSide::new(&truth, free) else {
            continue;
        };
        if truth.condition <= WORST_CONDITION {
            postures.push(Posture {
                row,
                readings,
                truth,
            });
        }
    }
    let turned = |a_move: &Move| slopes(fit, a_move, &postures);
    let at_row = |(row, source)| at_row(recording, row)(source);
    let turns: Vec<Vec<[f64; 2]>> = moves
        .iter()
        .map(turned)
        .collect::<Result<_, _>>()
        .map_err(at_row)?;
    let ways: Vec<Vec<[f64; 2]>> = open_moves
        .iter()
        .map(turned)
        .collect::<Result<_, _>>()
        .map_err(at_row)?;
    let along = |a: &[[f64; 2]], b: &[[f64; 2]]| -> f64 {
        let pairs = a.iter().zip(b);
        pairs.map(|(a, b)| a[0] * b[0] + a[1] * b[1]).sum()
    };
    let open_squares = ways.iter().zip(&open);
    let open_squares: Vec<f64> = open_squares
        .map(|(way, open)| open.size.powi(2) * along(way, way))
        .collect();
    let pairs = turns
        .iter()
        .flat_map(|a| turns.iter().map(move |b| along(a, b)));
    let sums: Vec<f64> = pairs.collect();
    let left_out = rows.len() - postures.len();
    let postures = postures.len() as u32;
    if postures == 0 {
        return Ok(None);
    }
    let average: Vec<f64> = sums.iter().map(|sum| sum / f64::from(postures)).collect();
    let by_row = (0..count * count).map(|entry| covariance[(entry / count, entry % count)]);
    let spread: Vec<f64> = by_row.collect();
    // the trace of C A
    let mean: f64 = spread.iter().zip(&average).map(|(c, a)| c * a).sum();
    let Ok(squares) = quadratic_form_interval(&spread, &average, count, LEVEL) else {
        return Ok(None);
    };
    let means = open_squares.iter().map(|sum| sum / f64::from(postures));
    let means: Vec<f64> = means.collect();
    let turning = open.iter().zip(&means);
    let turning = turning.filter(|(_, turn)| **turn > NOTABLE * NOTABLE * mean);
    Ok(Some(ForceDirection {
        open_through: turning.map(|(open, _)| open.name.clone()).collect(),
        rms_with_open_rad: (mean.max(0.0) + means.iter().sum::<f64>()).sqrt(),
        rms_rad: mean.max(0.0).sqrt(),
        ci95_rad: [squares.low.max(0.0).sqrt(), squares.high.max(0.0).sqrt()],
        postures: postures as usize,
        left_out,
        locked_joint: locked.map(|joint| joint + 1),
    }))
}

/// Parameters that move together, each by its change, and the step of the difference.
type Move = (Vec<(ParameterId, f64)>, f64);

/// A posture of a recording that is not singular.
struct Posture {
    row: usize,
    readings: Vec<f64>,
    truth: TrueSide,
}

/// Derivative of the transverse force of a unit force by a move, at each posture, by central differences of the controller's
/// device. In an error the row of the posture.
fn slopes(
    fit: &ParameterFit,
    (terms, step): &Move,
    postures: &[Posture],
) -> Result<Vec<[f64; 2]>, (usize, ModelError)> {
    if !(*step > 0.0 && step.is_finite()) {
        return Ok(vec![[0.0; 2]; postures.len()]);
    }
    let moved = |sign: f64| {
        let mut device = fit.device.clone();
        for (parameter, change) in terms {
            let value = parameter.value(&fit.device);
            parameter.set(&mut device, value + sign * step * change);
        }
        device
    };
    let [after, before] = [moved(1.0), moved(-1.0)];
    let mut controllers = [&after, &before].map(Evaluation::new);
    let mut slope = |posture: &Posture| {
        let mut forces = [Vector3::zeros(); 2];
        for (force, controller) in forces.iter_mut().zip(&mut controllers) {
            controller.move_to(&posture.readings)?;
            *force = posture.truth.unit_force(controller)?;
        }
        let [after, before] = forces;
        Ok([0, 1].map(|axis| (after[axis] - before[axis]) / (2.0 * step)))
    };
    let slopes = postures.iter();
    slopes
        .map(|posture| slope(posture).map_err(|source| (posture.row, source)))
        .collect()
}
