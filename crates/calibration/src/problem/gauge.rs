//! The scale gauge of touches: residuals in units of how far the handle moves with the joints.

use haptical_identification::{IdentificationError, Matrix, Problem};
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::kinematics::{Convention, Twist};
use haptical_model::{
    Device, Drive, Evaluation, JointType, Parameter, ParameterId, SurroundingParameter,
    TouchedPlane,
};

use crate::error::wrap;
use crate::problem::measurement::touching::Touching;
use crate::{CalibrationError, Channel, DeviceProblem};

/// Touches that stand for all of them: a mean over so many is as good.
const MOST_TOUCHES: usize = 256;
/// Share of the mean square of the three directions that is added to each: a handle that cannot move in one direction
/// has a size too.
const RIDGE: f64 = 1e-3;

/// A [`DeviceProblem`] as a fit searches it: touches are divided by the mobility of the device where they, and known
/// distances between touched points, are all that fixes lengths. Elsewhere it is the problem itself.
///
/// Noise of the handle of covariance V at a touch was read as joint angles: their density has the factor `|J J^T|^1/2`,
/// J the derivatives by the angles of what touches, which a smaller device has smaller. Its geometric mean over the touches,
/// as a length, is the mobility s, and the likelihood of the angles with a noise of unknown size is greatest where the
/// residuals over s are least. The unit is the mobility at the start. Source: docs/equations.md, Touched points.
///
/// Without the gauge a search of such a problem shrinks the device, which lowers every residual of a touch.
#[derive(Debug)]
pub struct GaugedProblem<'p> {
    problem: &'p DeviceProblem<'p>,
    /// None where touches stay in metres.
    gauge: Option<Gauge>,
}

/// The unit of touches that are divided by the mobility.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gauge {
    /// Logarithm of the mobility at the start.
    start: f64,
}

/// The gauge at one device: what residuals of touches are multiplied by, and the slopes of its logarithm, which falls where the mobility
/// grows.
pub(crate) struct Scale {
    factor: f64,
    /// Slope of the logarithm of the mobility by each parameter; empty where they were not asked for.
    slopes: Vec<f64>,
}

impl Gauge {
    /// At some values of the problem's parameters.
    pub(crate) fn at(
        self,
        problem: &DeviceProblem<'_>,
        parameters: &[f64],
        with_slopes: bool,
    ) -> Result<Scale, IdentificationError> {
        let mut sum = log_mobility(problem, &problem.device_with(parameters), with_slopes)?;
        let width = sum.width;
        sum.slopes.iter_mut().for_each(|slope| *slope /= width);
        Ok(Scale {
            factor: (self.start - sum.mean()).exp(),
            slopes: sum.slopes,
        })
    }
}

impl Scale {
    /// Brings residuals of touches to scale.
    pub(crate) fn scale(&self, residuals: &mut [f64]) {
        residuals
            .iter_mut()
            .for_each(|residual| *residual *= self.factor);
    }

    /// The same of their derivatives by a parameter; the residuals are to scale.
    pub(crate) fn scale_column(
        &self,
        derivatives: &mut [f64],
        residuals: &[f64],
        parameter: usize,
    ) {
        let slope = self.slopes[parameter];
        for (derivative, residual) in derivatives.iter_mut().zip(residuals) {
            *derivative = self.factor * *derivative - residual * slope;
        }
    }
}

impl<'p> GaugedProblem<'p> {
    /// The problem with its gauge, if it needs one.
    ///
    /// # Errors
    /// [`CalibrationError::Identification`] where the device has no value at a touch.
    pub fn new(problem: &'p DeviceProblem<'p>) -> Result<Self, CalibrationError> {
        let channels: Vec<Channel> = problem.channels().collect();
        let mut gauge = None;
        if is_fixed_by_pairs(problem.device(), &channels) {
            let sum = log_mobility(problem, problem.device(), false);
            let start = sum.map_err(|source| wrap("touches", source))?.mean();
            gauge = start.is_finite().then_some(Gauge { start });
        }
        Ok(Self { problem, gauge })
    }

    /// The unit of touches that are divided by the mobility.
    pub(crate) fn gauge(&self) -> Option<Gauge> {
        self.gauge
    }
}

impl Problem for GaugedProblem<'_> {
    fn parameter_count(&self) -> usize {
        self.problem.parameter_count()
    }

    fn residual_count(&self) -> usize {
        self.problem.residual_count()
    }

    fn evaluate(
        &self,
        parameters: &[f64],
        residuals: &mut [f64],
        mut jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        let Some(gauge) = self.gauge else {
            return self.problem.evaluate(parameters, residuals, jacobian);
        };
        let scale = gauge.at(self.problem, parameters, jacobian.is_some())?;
        let inner = jacobian
            .as_mut()
            .map(|(free, matrix)| (*free, &mut **matrix));
        self.problem.evaluate(parameters, residuals, inner)?;
        let touches = self.problem.blocks.iter();
        for block in touches.filter(|block| block.channel.is_touch()) {
            let own = block.first..block.end();
            scale.scale(&mut residuals[own.clone()]);
            let Some((free, matrix)) = &mut jacobian else {
                continue;
            };
            for (column, &parameter) in free.iter().enumerate() {
                let entries = &mut matrix.column_mut(column)[own.clone()];
                scale.scale_column(entries, &residuals[own.clone()], parameter);
            }
        }
        Ok(())
    }
}

/// Sum of the logarithms of the mobility at the touches, for a device.
fn log_mobility(
    problem: &DeviceProblem<'_>,
    device: &Device,
    slopes: bool,
) -> Result<Sum, IdentificationError> {
    let touches: Vec<(usize, Option<usize>)> = problem
        .blocks
        .iter()
        .filter(|block| block.channel.is_touch())
        .flat_map(|block| {
            let is_plane = block.channel == Channel::Plane;
            let plane = move |subject: &usize| is_plane.then_some(*subject);
            block
                .rows
                .iter()
                .copied()
                .zip(block.subjects.iter().map(plane))
        })
        .collect();
    let drives: Vec<Drive> = (1..device.links.len())
        .filter_map(|row| device.drive(row))
        .collect();
    let mut evaluation = Evaluation::new(device);
    let mut readings = vec![0.0; device.joints.len()];
    let mut sum = Sum::new(if slopes { problem.parameters.len() } else { 0 });
    let mut axes = Vec::with_capacity(drives.len());
    let step = touches.len().div_ceil(MOST_TOUCHES).max(1);
    for (row, plane) in touches.into_iter().step_by(step) {
        problem.move_to_row(&mut evaluation, &mut readings, row, true)?;
        let touched = plane.and_then(|plane| device.surroundings.planes.get(plane));
        let touched = touched.map(TouchedPlane::normal_and_slopes);
        let torques = problem.loads.as_ref().map(|loads| loads.of_row(row));
        let Ok(handle) = evaluation.pose() else {
            continue;
        };
        let parameter = Parameter::Theta;
        let axis = |row| evaluation.pose_derivative(ParameterId::Link { row, parameter });
        axes.clear();
        axes.extend((1..=drives.len()).map(axis));
        let at = AtTouch {
            evaluation: &evaluation,
            touching: Touching::of_handle(device, handle, problem.mount(row)),
            drives: &drives,
            axes: &axes,
            convention: device.convention,
            torques,
        };
        let Some(pulls) = at.pulls(touched.map(|(normal, _)| normal), &mut sum) else {
            continue;
        };
        for (slope, parameter) in sum.slopes.iter_mut().zip(problem.parameters) {
            *slope += match *parameter {
                ParameterId::Surrounding(SurroundingParameter::Plane { plane: own, index }) => {
                    match touched {
                        Some((normal, tilts)) if plane == Some(own) && index < 2 => {
                            normal.dot(&(pulls.square * tilts[index])) / pulls.over
                        }
                        _ => 0.0,
                    }
                }
                parameter => at.slope(parameter, &pulls),
            };
        }
    }
    Ok(sum)
}

/// Logarithms added up.
struct Sum {
    total: f64,
    width: f64,
    slopes: Vec<f64>,
}

impl Sum {
    fn new(parameters: usize) -> Self {
        Self {
            total: 0.0,
            width: 0.0,
            slopes: vec![0.0; parameters],
        }
    }

    fn mean(&self) -> f64 {
        self.total / self.width
    }
}

/// Derivatives of the logarithm by the handle's velocity with each driven row, and what planes need besides.
struct Pulls {
    /// Sums of `velocity x pull` over a driven row and those behind it, and of `pull x axis` over those before it, in the
    /// order of the driven rows and one more.
    behind: Vec<Vector3<f64>>,
    before: Vec<Vector3<f64>>,
    /// J J^T and, of a plane, what the normal's own square is divided by.
    square: Matrix3<f64>,
    over: f64,
}

/// A device moved to a touch.
struct AtTouch<'t> {
    evaluation: &'t Evaluation<'t>,
    touching: Touching,
    /// Of the rows from 1 on.
    drives: &'t [Drive],
    /// Twists of the handle by a turn about the axis of each of them.
    axes: &'t [Twist],
    convention: Convention,
    torques: Option<&'t [f64]>,
}

impl AtTouch<'_> {
    /// Adds the logarithm at this touch, and returns its derivatives; none where the handle does not move.
    fn pulls(&self, normal: Option<Vector3<f64>>, sum: &mut Sum) -> Option<Pulls> {
        let joints = self.evaluation.joint_count();
        let by_joint: Vec<Vector3<f64>> = (0..joints)
            .map(|joint| self.touching.carried(&self.evaluation.joint_twist(joint)))
            .collect();
        let mut square = Matrix3::zeros();
        for linear in &by_joint {
            square += linear * linear.transpose();
        }
        let ridge = RIDGE * square.trace() / 3.0;
        let (of_joint, measure, width, over): (Vec<Vector3<f64>>, f64, f64, f64);
        if let Some(normal) = normal {
            over = normal.dot(&(square * normal)) + ridge;
            (measure, width) = (over, 1.0);
            let pull = |linear: &Vector3<f64>| {
                (normal * normal.dot(linear) + linear * (RIDGE / 3.0)) / over
            };
            of_joint = by_joint.iter().map(pull).collect();
        } else {
            let whole = square + Matrix3::identity() * ridge;
            let inverse = whole.try_inverse()?;
            (measure, width, over) = (whole.determinant(), 3.0, 0.0);
            let along = inverse + Matrix3::identity() * (RIDGE * inverse.trace() / 3.0);
            of_joint = by_joint.iter().map(|linear| along * linear).collect();
        }
        let log = 0.5 * measure.ln();
        if !log.is_finite() {
            return None;
        }
        sum.total += log;
        sum.width += width;
        let count = self.drives.len();
        let mut behind = vec![Vector3::zeros(); count + 1];
        let mut before = behind.clone();
        let pull = |driven: usize| {
            let drive = &self.drives[driven];
            of_joint[drive.joint] * drive.multiplier
        };
        for driven in 0..count {
            before[driven + 1] = before[driven] + pull(driven).cross(&self.axes[driven].angular);
        }
        for driven in (0..count).rev() {
            let velocity = self.touching.carried(&self.axes[driven]);
            behind[driven] = behind[driven + 1] + velocity.cross(&pull(driven));
        }
        Some(Pulls {
            behind,
            before,
            square,
            over,
        })
    }

    /// Derivative of the logarithm by a parameter of the chain.
    fn slope(&self, parameter: ParameterId, pulls: &Pulls) -> f64 {
        let of_joint = |joint: usize, factor: f64| -> f64 {
            let rows = self.drives.iter().zip(1..);
            let own = rows.filter(|(drive, _)| drive.joint == joint);
            own.map(|(drive, row)| drive.multiplier * self.of_link(row, Parameter::Theta, pulls))
                .sum::<f64>()
                * factor
        };
        match parameter {
            ParameterId::Link { row, parameter } => self.of_link(row, parameter, pulls),
            ParameterId::Transmission { joint, .. } => {
                of_joint(joint, self.evaluation.output_derivative(joint, parameter))
            }
            ParameterId::Compliance { joint } => {
                let torque = self.torques.and_then(|torques| torques.get(joint));
                of_joint(joint, -torque.copied().unwrap_or(0.0))
            }
            ParameterId::Surrounding(_) => {
                let own = self.touching.own(parameter);
                own.map_or(0.0, |linear| self.of_tool(&linear, pulls))
            }
            // what it adds to readings is no part of the device's size
            ParameterId::Effect { .. } => 0.0,
        }
    }

    /// Derivative by a number of the tool: it moves the touching point behind every row.
    fn of_tool(&self, moved: &Vector3<f64>, pulls: &Pulls) -> f64 {
        pulls.before[self.drives.len()].dot(moved)
    }

    /// Derivative by a number of a link. What it moves, twist (v, w) of the handle, turns the velocity that a row
    /// behind it gives the handle, by w x L; a row before it has its axis where it was, and the handle moves: o x v.
    fn of_link(&self, row: usize, parameter: Parameter, pulls: &Pulls) -> f64 {
        let moved = self
            .evaluation
            .pose_derivative(ParameterId::Link { row, parameter });
        let is_before_own_turn = self.convention == Convention::Modified
            && !matches!(parameter, Parameter::Theta | Parameter::D);
        // the driven rows are those from row 1 on
        let first_behind = match is_before_own_turn {
            true => row.saturating_sub(1),
            false => row,
        };
        let place = first_behind.min(self.drives.len());
        let carried = self.touching.carried(&moved);
        moved.angular.dot(&pulls.behind[place]) + carried.dot(&pulls.before[place])
    }
}

/// Whether touches, and known distances between what is touched, are all that fixes lengths.
fn is_fixed_by_pairs(device: &Device, channels: &[Channel]) -> bool {
    are_touches_without_length(device, channels) && channels.iter().any(is_pair)
}

/// Whether a channel is a known distance between touched points.
pub(crate) fn is_pair(channel: &Channel) -> bool {
    matches!(channel, Channel::ContactPair { .. })
}

/// Whether something was touched, and nothing but pairs of what was touched has a length of its own.
pub(crate) fn are_touches_without_length(device: &Device, channels: &[Channel]) -> bool {
    let is_metric = |channel: &Channel| match channel {
        Channel::Cable { index } => device
            .cables
            .get(*index)
            .is_none_or(|cable| !cable.fit.scale),
        Channel::Position => true,
        _ => false,
    };
    let slides = device
        .joints
        .iter()
        .any(|joint| joint.joint_type == JointType::Prismatic);
    let is_touched = channels.iter().any(|channel| channel.is_touch());
    !slides && !channels.iter().any(is_metric) && is_touched
}
