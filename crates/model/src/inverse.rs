//! Readings at which a device's handle is where it is wanted.

use haptical_kinematics::nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

use crate::rigid::rotation_vector;
use crate::{Device, Evaluation, ModelError, TransmissionError};

/// What is wanted of a handle, in frame (-1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wanted {
    /// Its position \[m\].
    pub position_m: Vector3<f64>,
    /// Its orientation; none where any will do.
    pub rotation: Option<Matrix3<f64>>,
}

/// Readings, and what is left to what was wanted.
#[derive(Debug, Clone, PartialEq)]
pub struct Reached {
    /// One for each joint \[rad\], \[m\], within the device's limits.
    pub readings: Vec<f64>,
    /// Distance that is left \[m\].
    pub rest_m: f64,
    /// Turn that is left \[rad\]; 0 where any orientation would do.
    pub rest_rad: f64,
}

/// Where way and turn cannot both be had, a turn weighs as the way of the end of a lever so long \[m\]
/// (assumption A214).
const LEVER_M: f64 = 0.1;
/// Damping at the start of a search and the most of it, \[m^2/rad^2\].
const LEAST_DAMPING: f64 = 1e-12;
const MOST_DAMPING: f64 = 1e6;
/// Steps of a search.
const MOST_STEPS: usize = 200;
/// Steps to the least change.
const MOST_REFINEMENTS: usize = 50;
/// A joint that moves by less has settled \[rad\], \[m\].
const SETTLED: f64 = 1e-13;
/// Way, and turn at the lever, below which a pose is reached \[m\].
const REACHED_M: f64 = 1e-10;

/// Searches readings of a device by its pose: Levenberg and Marquardt's steps within the limits (Nakamura & Hanafusa
/// 1986), then, where more joints are free than the pose fixes, to the readings with that pose that are least far, as a sum
/// of squares, from given ones (Liegeois 1977): `dq = d + J^T (J J^T)^-1 (e - J d)`, d the way back to them, e what is left.
///
/// ```
/// use haptical_model::kinematics::nalgebra::Vector3;
/// use haptical_model::{Device, InversePose, Wanted};
/// let row = "[[link]]\na_m = 0.3\nalpha_rad = 0.0\nd_m = 0.0\n";
/// let text = format!("{row}{row}{row}[[joint]]\n[[joint]]\n");
/// let device = Device::from_toml(&text, "arm.toml")?.device;
/// let wanted = Wanted { position_m: Vector3::new(0.6, 0.3, 0.0), rotation: None };
/// let near = [-0.1, 1.2];
/// let found = InversePose::new(&device).solve(&wanted, &near, &near)?;
/// // the first row reaches out 0.3 m, the second along x, the third across
/// assert!(found.rest_m < 1e-10 && found.readings[0].abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct InversePose<'d> {
    evaluation: Evaluation<'d>,
    limits: Vec<[f64; 2]>,
}

/// A posture on the way.
#[derive(Debug, Clone)]
struct Stand {
    readings: Vec<f64>,
    /// What is left, turns times the lever.
    left: Vector6<f64>,
    /// Its derivatives by each reading, the sign turned round.
    columns: Vec<Vector6<f64>>,
}

impl<'d> InversePose<'d> {
    /// Prepares searches for a device with links. Readings stay within the joints' limits and within what a polynomial was
    /// fitted on.
    pub fn new(device: &'d Device) -> Self {
        let limits = device.joints.iter().map(|joint| {
            let known = match &joint.transmission_error {
                TransmissionError::Chebyshev { range_rad, .. } => *range_rad,
                _ => [f64::NEG_INFINITY, f64::INFINITY],
            };
            [joint.lower_rad.max(known[0]), joint.upper_rad.min(known[1])]
        });
        Self {
            limits: limits.collect(),
            evaluation: Evaluation::new(device),
        }
    }

    /// The evaluation that searches use: to choose a hand, and to set the torques that joints yield to.
    pub fn evaluation(&mut self) -> &mut Evaluation<'d> {
        &mut self.evaluation
    }

    /// Lowest and highest reading of each joint.
    pub fn limits(&self) -> &[[f64; 2]] {
        &self.limits
    }

    /// The readings nearest to `near` with the wanted pose, searched from `from` (one for each joint); where none has it
    /// within the limits, those that come next to it from there, as squares of way and turn.
    ///
    /// # Errors
    /// [`ModelError`] where the device has no value at `from`.
    pub fn solve(
        &mut self,
        wanted: &Wanted,
        near: &[f64],
        from: &[f64],
    ) -> Result<Reached, ModelError> {
        let mut stand = self.stand(wanted, self.within(from))?;
        self.search(wanted, &mut stand);
        if stand.left.norm() <= REACHED_M {
            self.refine(wanted, near, &mut stand);
        }
        let [way, turn] = [0, 3].map(|first| stand.left.fixed_rows::<3>(first).norm());
        Ok(Reached {
            readings: stand.readings,
            rest_m: way,
            rest_rad: turn / LEVER_M,
        })
    }

    /// Steps until what is left gets no less.
    fn search(&mut self, wanted: &Wanted, stand: &mut Stand) {
        let mut damping = LEAST_DAMPING;
        let still = vec![0.0; stand.readings.len()];
        for _ in 0..MOST_STEPS {
            let next = self.stepped(stand, &still, damping);
            let moved = moved(&next, &stand.readings);
            if moved <= SETTLED || damping > MOST_DAMPING {
                return;
            }
            match self.stand(wanted, next) {
                Ok(next) if next.left.norm() < stand.left.norm() => {
                    *stand = next;
                    damping = (damping / 100.0).max(LEAST_DAMPING);
                }
                _ => damping = (10.0 * damping).max(1e-9),
            }
        }
    }

    /// From a posture with the wanted pose to the one that is nearest to `near`; the posture stays where that fails.
    fn refine(&mut self, wanted: &Wanted, near: &[f64], stand: &mut Stand) {
        let mut best = stand.clone();
        for _ in 0..MOST_REFINEMENTS {
            let back: Vec<f64> = near
                .iter()
                .zip(&best.readings)
                .map(|(a, b)| a - b)
                .collect();
            let next = self.stepped(&best, &back, LEAST_DAMPING);
            let moved = moved(&next, &best.readings);
            let Ok(next) = self.stand(wanted, next) else {
                return;
            };
            best = next;
            if moved <= 1e-10 {
                break;
            }
        }
        self.search(wanted, &mut best);
        let way = |own: &Stand| -> f64 {
            let parts = near.iter().zip(&own.readings);
            parts.map(|(a, b)| (a - b) * (a - b)).sum()
        };
        if best.left.norm() <= REACHED_M && way(&best) <= way(stand) {
            *stand = best;
        }
    }

    /// The readings after a step that takes away what is left and, where that leaves a choice, goes back by `back`. Joints at
    /// a limit which the step would pass stay there.
    fn stepped(&self, stand: &Stand, back: &[f64], damping: f64) -> Vec<f64> {
        let count = stand.readings.len();
        let mut is_free = vec![true; count];
        loop {
            let mut gram = Matrix6::identity() * damping;
            let mut left = stand.left;
            for (joint, column) in stand.columns.iter().enumerate() {
                if is_free[joint] {
                    gram += column * column.transpose();
                    left -= column * back[joint];
                }
            }
            // positive definite by the damping
            let along = gram
                .cholesky()
                .map_or(Vector6::zeros(), |own| own.solve(&left));
            let step = |joint: usize| match is_free[joint] {
                true => back[joint] + stand.columns[joint].dot(&along),
                false => 0.0,
            };
            let steps: Vec<f64> = (0..count).map(step).collect();
            let is_stopped = |joint: &usize| {
                let ([lower, upper], reading) = (self.limits[*joint], stand.readings[*joint]);
                is_free[*joint]
                    && (reading <= lower && steps[*joint] < 0.0
                        || reading >= upper && steps[*joint] > 0.0)
            };
            let stopped: Vec<usize> = (0..count).filter(is_stopped).collect();
            if stopped.is_empty() {
                let readings = stand.readings.iter().zip(&steps);
                let readings: Vec<f64> = readings.map(|(reading, step)| reading + step).collect();
                return self.within(&readings);
            }
            for joint in stopped {
                is_free[joint] = false;
            }
        }
    }

    fn within(&self, readings: &[f64]) -> Vec<f64> {
        let pairs = readings.iter().zip(&self.limits);
        pairs
            .map(|(reading, [lower, upper])| reading.min(*upper).max(*lower))
            .collect()
    }

    fn stand(&mut self, wanted: &Wanted, readings: Vec<f64>) -> Result<Stand, ModelError> {
        self.evaluation.move_to(&readings)?;
        let pose = *self.evaluation.pose()?;
        let mut left = Vector6::zeros();
        left.fixed_rows_mut::<3>(0)
            .copy_from(&(wanted.position_m - pose.position_m));
        if let Some(rotation) = wanted.rotation {
            let turn = rotation_vector(&(rotation * pose.rotation.transpose()));
            left.fixed_rows_mut::<3>(3).copy_from(&(LEVER_M * turn));
        }
        let columns = (0..readings.len()).map(|joint| {
            let twist = self.evaluation.reading_twist(joint);
            let mut column = Vector6::zeros();
            column.fixed_rows_mut::<3>(0).copy_from(&twist.linear);
            if wanted.rotation.is_some() {
                let turn = LEVER_M * twist.angular;
                column.fixed_rows_mut::<3>(3).copy_from(&turn);
            }
            column
        });
        Ok(Stand {
            columns: columns.collect(),
            readings,
            left,
        })
    }
}

/// The largest change of a joint.
fn moved(one: &[f64], other: &[f64]) -> f64 {
    let parts = one.iter().zip(other).map(|(a, b)| (a - b).abs());
    parts.fold(0.0, f64::max)
}
