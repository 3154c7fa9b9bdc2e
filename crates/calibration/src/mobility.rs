//! How far the handle moves with the joints at the touches: touches are measured in it where they alone tell of
//! lengths, or known distances between what they touch.

use std::collections::BTreeMap;

use haptical_identification::IdentificationError;
use haptical_model::kinematics::nalgebra::{Matrix3, Vector3};
use haptical_model::kinematics::{Convention, Twist};
use haptical_model::{
    Device, DeviceChain, Evaluation, Parameter, ParameterId, SurroundingParameter, TouchedPlane,
};

use crate::{Channel, DeviceProblem};

/// Touches that stand for all of them: a mean over so many is as good.
const MOST_TOUCHES: usize = 256;
/// Share of the mean square of the three directions that is added to each: a handle that cannot move in one direction
/// has a size too.
const RIDGE: f64 = 1e-3;

/// Mobility of a device over that of another, with its derivatives.
///
/// Noise of the handle of covariance V at a touch was read as joint angles: their density has the factor `|J J^T|^1/2`,
/// J the handle's derivatives by the angles, which a smaller device has smaller. Its geometric mean over the touches,
/// as a length, is the mobility s, and the likelihood of the angles with a noise of unknown size is greatest where the
/// residuals over s are least. Source: docs/equations.md, Touched points.
#[derive(Debug)]
pub(crate) struct Mobility {
    factor: f64,
    /// d ln s by parameter.
    slopes: BTreeMap<ParameterId, f64>,
}

impl Mobility {
    /// Residuals of a touch, over the mobility.
    pub(crate) fn residuals(&self, residuals: [f64; 3]) -> [f64; 3] {
        residuals.map(|residual| residual * self.factor)
    }

    /// Derivatives of what [`Mobility::residuals`] gave, `scaled`, from those of the residuals themselves.
    pub(crate) fn derivatives(
        &self,
        own: [f64; 3],
        scaled: [f64; 3],
        parameter: ParameterId,
    ) -> [f64; 3] {
        let slope = self.slopes.get(&parameter).copied().unwrap_or(0.0);
        let mut own = own;
        for (derivative, residual) in own.iter_mut().zip(scaled) {
            *derivative = self.factor * *derivative - residual * slope;
        }
        own
    }
}

/// Whether a channel's residuals shrink with the device.
pub(crate) fn is_touch(channel: Channel) -> bool {
    matches!(channel, Channel::Contact | Channel::Plane)
}

impl DeviceProblem<'_> {
    /// The mobility at a device over that of the problem's own; `slopes` are those of it too. None where touches are
    /// not measured in it.
    pub(crate) fn mobility(
        &self,
        device: &Device,
        slopes: bool,
    ) -> Result<Option<Mobility>, IdentificationError> {
        let Some(own) = self.own_mobility else {
            return Ok(None);
        };
        let sum = self.log_mobility(device, slopes)?;
        Ok(Some(Mobility {
            factor: (own - sum.mean()).exp(),
            slopes: sum.slopes(self.parameters),
        }))
    }

    /// Logarithm of the problem's own mobility; none where nothing moves.
    pub(crate) fn log_of_own_mobility(&self) -> Result<Option<f64>, IdentificationError> {
        let mean = self.log_mobility(self.device, false)?.mean();
        Ok(mean.is_finite().then_some(mean))
    }

    fn log_mobility(&self, device: &Device, slopes: bool) -> Result<Sum, IdentificationError> {
        let touches: Vec<(usize, Option<usize>)> = self
            .blocks
            .iter()
            .filter(|block| is_touch(block.channel))
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
        let chain = DeviceChain::new(device);
        let driven: Vec<Driven> = driven(&chain);
        let mut evaluation = Evaluation::new(device);
        let mut readings = vec![0.0; device.joints.len()];
        let mut sum = Sum::new(if slopes { self.parameters.len() } else { 0 });
        let step = touches.len().div_ceil(MOST_TOUCHES).max(1);
        for (row, plane) in touches.into_iter().step_by(step) {
            self.move_to_row(&mut evaluation, &mut readings, row, true)?;
            let plane = plane.and_then(|plane| device.surroundings.planes.get(plane));
            let plane = plane.map(TouchedPlane::normal_and_slopes);
            let torques = self.loads.as_ref().map(|loads| loads.at(row));
            let at = AtTouch {
                evaluation: &evaluation,
                driven: &driven,
                convention: device.convention,
                torques,
            };
            let Some(pulls) = at.pulls(plane.as_ref().map(|(normal, _)| *normal), &mut sum) else {
                continue;
            };
            for (slope, parameter) in sum.slopes.iter_mut().zip(self.parameters) {
                *slope += match *parameter {
                    ParameterId::Surrounding(parameter) => {
                        tilt_slope(parameter, row, self, &pulls, plane.as_ref())
                    }
                    parameter => at.slope(parameter, &pulls.of_row),
                };
            }
        }
        Ok(sum)
    }
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

    fn slopes(&self, parameters: &[ParameterId]) -> BTreeMap<ParameterId, f64> {
        let slopes = self.slopes.iter().map(|slope| slope / self.width);
        parameters.iter().copied().zip(slopes).collect()
    }
}

/// A row that a joint turns, by how much of the joint's angle.
struct Driven {
    row: usize,
    joint: usize,
    multiplier: f64,
}

fn driven(chain: &DeviceChain) -> Vec<Driven> {
    let drives = chain.drives().iter().enumerate();
    drives
        .map(|(index, drive)| Driven {
            row: index + 1,
            joint: drive.joint,
            multiplier: drive.multiplier,
        })
        .collect()
}

/// Derivatives of the logarithm by the handle's velocity with each driven row, and what planes need besides.
struct Pulls {
    /// In the order of the driven rows.
    of_row: Vec<Vector3<f64>>,
    /// J J^T and, of a plane, what the normal's own square is divided by.
    square: Matrix3<f64>,
    over: f64,
}

/// A device moved to a touch.
struct AtTouch<'t> {
    evaluation: &'t Evaluation<'t>,
    driven: &'t [Driven],
    convention: Convention,
    torques: Option<&'t [f64]>,
}

impl AtTouch<'_> {
    fn axis(&self, row: usize) -> Twist {
        let parameter = Parameter::Theta;
        self.evaluation
            .pose_derivative(ParameterId::Link { row, parameter })
    }

    /// Adds the logarithm at this touch, and returns its derivatives; none where the handle does not move.
    fn pulls(&self, normal: Option<Vector3<f64>>, sum: &mut Sum) -> Option<Pulls> {
        let joints = self.evaluation.joint_count();
        let by_joint: Vec<Vector3<f64>> = (0..joints)
            .map(|joint| self.evaluation.joint_twist(joint).linear)
            .collect();
        let mut square = Matrix3::zeros();
        for linear in &by_joint {
            square += linear * linear.transpose();
        }
        let ridge = RIDGE * square.trace() / 3.0;
        let of_joint: Vec<Vector3<f64>>;
        let mut over = 0.0;
        match normal {
            None => {
                let whole = square + Matrix3::identity() * ridge;
                let inverse = whole.try_inverse()?;
                let log = 0.5 * whole.determinant().ln();
                if !log.is_finite() {
                    return None;
                }
                sum.total += log;
                sum.width += 3.0;
                let along = inverse + Matrix3::identity() * (RIDGE * inverse.trace() / 3.0);
                of_joint = by_joint.iter().map(|linear| along * linear).collect();
            }
            Some(normal) => {
                over = normal.dot(&(square * normal)) + ridge;
                let log = 0.5 * over.ln();
                if !log.is_finite() {
                    return None;
                }
                sum.total += log;
                sum.width += 1.0;
                let pull = |linear: &Vector3<f64>| {
                    (normal * normal.dot(linear) + linear * (RIDGE / 3.0)) / over
                };
                of_joint = by_joint.iter().map(pull).collect();
            }
        }
        let of_row = self.driven.iter();
        Some(Pulls {
            of_row: of_row
                .map(|driven| of_joint[driven.joint] * driven.multiplier)
                .collect(),
            square,
            over,
        })
    }

    /// Derivative of the logarithm by a parameter of the chain.
    fn slope(&self, parameter: ParameterId, pulls: &[Vector3<f64>]) -> f64 {
        let of_joint = |joint: usize, factor: f64| -> f64 {
            let own = self.driven.iter().filter(|driven| driven.joint == joint);
            own.map(|driven| {
                let parameter = Parameter::Theta;
                driven.multiplier * self.of_link(driven.row, parameter, pulls)
            })
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
            ParameterId::Surrounding(_) => 0.0,
        }
    }

    /// Derivative by a number of a link. What it moves, twist (v, w) of the handle, turns the velocity that a row
    /// behind it gives the handle, by w x L; a row before it has its axis where it was, and the handle moves: o x v.
    fn of_link(&self, row: usize, parameter: Parameter, pulls: &[Vector3<f64>]) -> f64 {
        let moved = self
            .evaluation
            .pose_derivative(ParameterId::Link { row, parameter });
        let is_before_own_turn = self.convention == Convention::Modified
            && !matches!(parameter, Parameter::Theta | Parameter::D);
        let mut slope = 0.0;
        for (driven, pull) in self.driven.iter().zip(pulls) {
            let axis = self.axis(driven.row);
            let is_before = row < driven.row || (row == driven.row && is_before_own_turn);
            let change = if is_before {
                moved.angular.cross(&axis.linear)
            } else {
                axis.angular.cross(&moved.linear)
            };
            slope += pull.dot(&change);
        }
        slope
    }
}

/// Derivative of the logarithm by a plane's tilt, at a touch of that plane.
fn tilt_slope(
    parameter: SurroundingParameter,
    row: usize,
    problem: &DeviceProblem<'_>,
    pulls: &Pulls,
    plane: Option<&(Vector3<f64>, [Vector3<f64>; 2])>,
) -> f64 {
    let SurroundingParameter::Plane { plane: of, index } = parameter else {
        return 0.0;
    };
    let ids = problem.recording.plane.as_ref();
    let touched = ids.and_then(|ids| ids.get(row));
    let touched = touched.and_then(|id| problem.device.surroundings.plane_index(id));
    match plane {
        Some((normal, slopes)) if touched == Some(of) && index < 2 => {
            normal.dot(&(pulls.square * slopes[index])) / pulls.over
        }
        _ => 0.0,
    }
}
