//! Predictions of a fitted device at postures, with intervals, or the reason why the recording fixes none.

use haptical_identification::{Added, HalfWidths, Matrix};
use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::kinematics::{Twist, distance_m};
use haptical_model::{Evaluation, ModelError, ParameterId, Recording};

use crate::error::at_row;
use crate::fit::considered::square_form;
use crate::report::open_direction::{OpenDirection, open_directions};
use crate::{CalibrationError, ParameterFit};

/// A number that a device predicts, and how well the recording fixes it.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Prediction {
    /// Value, in the unit of the quantity.
    pub value: f64,
    /// Standard deviation; none where the recording does not fix the quantity.
    pub standard_deviation: Option<f64>,
    /// 95 % interval.
    pub ci95: Option<[f64; 2]>,
    /// Parameters that the recording does not fix and the quantity depends on.
    pub open_through: Vec<String>,
}

/// Share of the standard deviation that a plausible change along an undetermined direction may move a
/// quantity that still counts as fixed.
pub(crate) const NEGLIGIBLE: f64 = 0.01;
/// Share of the derivatives' own size that is rounding, not an effect.
const ROUNDING: f64 = 1e-9;

/// Positions of the handle \[m\] in frame (-1), axis by axis, at each row of joint readings of `postures`.
///
/// The interval is value +- t sqrt(g^T C g), g the derivatives by the parameters and C the covariance of their
/// errors, those of held weak parameters included ([`crate::Considered`]). One cable cannot tell a turn of the whole
/// device about its exit: then a coordinate has no interval and [`Prediction::open_through`] names the parameters.
/// Source: docs/equations.md, Covariance and intervals.
///
/// # Errors
/// [`CalibrationError::Row`] where the device has no value at a row.
pub fn predict_positions(
    fit: &ParameterFit,
    postures: &Recording,
) -> Result<Vec<[Prediction; 3]>, CalibrationError> {
    let uncertain = Uncertain::new(fit);
    let mut rows = Vec::with_capacity(postures.len());
    at_each_posture(fit, postures, |evaluation| {
        let pose = *evaluation.pose()?;
        let axis = |axis: usize| {
            let along = |twist: &Twist| twist.linear[axis];
            uncertain.predict(evaluation, pose.position_m[axis], along)
        };
        rows.push([axis(0), axis(1), axis(2)]);
        Ok(())
    })?;
    Ok(rows)
}

/// Distances \[m\] of the handle from a point in frame (-1), usually a cable's anchor, at each row of `postures`.
///
/// Intervals as for [`predict_positions`].
///
/// # Errors
/// [`CalibrationError::Row`] where the device has no value at a row or the handle is at the point.
///
/// # Examples
/// ```
/// use haptical_calibration::{Channel, Options, Weights, fit_kinematics, predict_distances};
/// use haptical_model::{Device, Recording};
/// let row = "[[link]]\na_m = 0.3\nalpha_rad = 0.4\nd_m = 0.1\n";
/// let joint = "[[joint]]\ntransmission = \"direct\"\ntransmission_ratio = 1.0\n";
/// let text = format!("{row}{row}{joint}[cable_encoder]\ndistance_sd_m = 1e-5\n");
/// let device = Device::from_toml(&text, "lever.toml")?.device;
/// // distances of a lever whose handle is 1 mm farther from the joint
/// let angles: Vec<f64> = (0..40).map(|k| 0.05 * f64::from(k) - 1.0).collect();
/// let mut truth = device.clone();
/// truth.links[1].a_m += 1e-3;
/// let mut recording = Recording {
///     line: (2..42).collect(),
///     joint: vec![angles],
///     output: vec![None],
///     ..Recording::default()
/// };
/// let ends = haptical_calibration::frame_origins_m(&truth, &recording)?;
/// let distance = |ends: &Vec<[f64; 3]>| ends[2].iter().map(|x| x * x).sum::<f64>().sqrt();
/// recording.cable_m = vec![Some(ends.iter().map(distance).collect())];
/// let channels = [Channel::Cable { index: 0 }];
/// let weights = Weights::stated(&device, &channels);
/// let fit = fit_kinematics(&device, &recording, &channels, &weights, &Options::default())?;
/// let predicted = predict_distances(&fit, &recording, [0.0; 3])?;
/// assert!((predicted[7].value - distance(&ends[7])).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn predict_distances(
    fit: &ParameterFit,
    postures: &Recording,
    from_m: [f64; 3],
) -> Result<Vec<Prediction>, CalibrationError> {
    let uncertain = Uncertain::new(fit);
    let from = Vector3::from(from_m);
    let mut rows = Vec::with_capacity(postures.len());
    at_each_posture(fit, postures, |evaluation| {
        let position_m = evaluation.pose()?.position_m;
        let distance = distance_m(&position_m, &from)?;
        let direction = (position_m - from) / distance;
        let along = |twist: &Twist| direction.dot(&twist.linear);
        rows.push(uncertain.predict(evaluation, distance, along));
        Ok(())
    })?;
    Ok(rows)
}

/// Moves the fitted device to every row.
fn at_each_posture(
    fit: &ParameterFit,
    postures: &Recording,
    mut look: impl FnMut(&Evaluation<'_>) -> Result<(), ModelError>,
) -> Result<(), CalibrationError> {
    let mut evaluation = Evaluation::new(&fit.device);
    let mut readings = vec![0.0; postures.joint.len()];
    for row in 0..postures.len() {
        postures.read_joints(row, &mut readings);
        evaluation.choose_hand(fit.device.hand_at(postures, row));
        let moved = evaluation.move_to(&readings);
        moved
            .and_then(|()| look(&evaluation))
            .map_err(at_row(postures, row))?;
    }
    Ok(())
}

/// What a fit leaves uncertain: errors with a covariance, and directions without any.
struct Uncertain<'f> {
    fit: &'f ParameterFit,
    parameters: Vec<ParameterId>,
    covariance: Matrix,
    half_widths: HalfWidths<'f>,
    directions: Vec<OpenDirection>,
}

impl<'f> Uncertain<'f> {
    fn new(fit: &'f ParameterFit) -> Self {
        let (parameters, covariance) = fit.uncertain();
        Self {
            directions: open_directions(fit),
            half_widths: fit.uncertainty.half_widths(fit.noise),
            fit,
            parameters,
            covariance,
        }
    }

    /// Scatter of the variance of a function with these slopes, as far as an earlier step's parameters are in it.
    fn scatter(&self, slopes: &[f64]) -> f64 {
        let considered = &self.fit.considered;
        if considered.known_parts.is_empty() {
            return 0.0;
        }
        let own = slopes.iter().take(self.fit.fitted.len()).enumerate();
        let along = |k: usize| {
            let through = own.clone();
            let through = through.map(|(row, slope)| slope * considered.sensitivity[(row, k)]);
            let place = self
                .parameters
                .iter()
                .position(|own| *own == considered.parameters[k]);
            through.sum::<f64>() + place.map_or(0.0, |place| slopes[place])
        };
        let along: Vec<f64> = (0..considered.parameters.len()).map(along).collect();
        considered.scatter(&along)
    }

    /// A quantity whose derivative is `along` of a parameter's twist.
    fn predict(
        &self,
        evaluation: &Evaluation<'_>,
        value: f64,
        along: impl Fn(&Twist) -> f64,
    ) -> Prediction {
        let derivative = |parameter: ParameterId| along(&evaluation.pose_derivative(parameter));
        let slopes: Vec<f64> = self.parameters.iter().map(|&p| derivative(p)).collect();
        let variance = square_form(&slopes, &self.covariance).max(0.0);
        let deviation = variance.sqrt();
        let is_open = |direction: &&OpenDirection| {
            let (mut sum, mut size) = (0.0, 0.0);
            for &(parameter, change) in &direction.terms {
                let effect = change * derivative(parameter);
                sum += effect;
                size += effect.abs();
            }
            let moved = f64::abs(sum) * direction.size;
            f64::abs(sum) > ROUNDING * size && moved > NEGLIGIBLE * deviation
        };
        let open = self.directions.iter().filter(is_open);
        let open_through: Vec<String> = open.map(|direction| direction.name.clone()).collect();
        let is_fixed = open_through.is_empty() && !self.fit.fitted.is_empty();
        let fitted = &slopes[..self.fit.fitted.len()];
        let part = |covariance: &Matrix| square_form(fitted, covariance);
        let added = Added {
            variance: variance - part(&self.fit.uncertainty.covariance),
            scatter: self.scatter(&slopes),
        };
        let half = self.half_widths.of_function(&part, added) * deviation;
        Prediction {
            value,
            standard_deviation: is_fixed.then_some(deviation),
            ci95: is_fixed.then_some([value - half, value + half]),
            open_through,
        }
    }
}
