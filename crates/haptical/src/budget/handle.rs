//! Where the handle is at postures, and how it moves with the numbers of the fit and with the joints' readings.

use haptical_calibration::{Channel, DeviceProblem, ParameterFit, Weights};
use haptical_effects::device::{DeviceEffectError, attached};
use haptical_effects::{Hook, spec};
use haptical_identification::{Problem, evaluate_jacobian};
use haptical_kinematics::nalgebra::Vector3;
use haptical_model::{Device as Model, ParameterId, Recording, SurroundingParameter, Tracker};

use crate::error::Error;

/// Step of a joint reading in a difference \[rad\] or \[m\].
const STEP: f64 = 1e-5;

/// The handle of a fitted device.
pub(super) struct Handle {
    /// The device, whose tracker stands where the result is wanted.
    pub(super) device: Model,
    /// Numbers that are uncertain.
    pub(super) parameters: Vec<ParameterId>,
    /// Their covariance, row by row.
    pub(super) covariance: Vec<f64>,
    /// Whether positions are in the tracker's frame.
    pub(super) is_seen: bool,
}

/// The handle at one posture.
#[derive(Debug, Clone)]
pub(super) struct Place {
    pub(super) position_m: Vector3<f64>,
    /// Derivatives by the parameters.
    pub(super) by_parameter: Vec<Vector3<f64>>,
}

impl Handle {
    /// Of a fit. Where a tracker read positions, the result is where what it sees is, in its frame: that is what the readings fix.
    pub(super) fn new(fit: &ParameterFit, log: &Recording) -> Self {
        let (parameters, covariance) = fit.uncertain();
        let count = parameters.len();
        let entries = (0..count * count).map(|entry| covariance[(entry / count, entry % count)]);
        let mut device = fit.device.clone();
        let is_seen = device.tracker.is_some() && log.position_m.is_some();
        if !is_seen {
            device.tracker = Some(Tracker {
                base_known: true,
                base_per_run: false,
                tool_known: true,
                position_sd_m: Some(1.0),
                rotation_sd_rad: None,
                scale_sd: None,
            });
        }
        Self {
            device,
            covariance: entries.collect(),
            parameters,
            is_seen,
        }
    }

    /// The name of what is measured.
    pub(super) fn measurand(&self) -> &'static str {
        match self.is_seen {
            true => {
                "position that the tracker reads, in its frame, along the direction in which it is known least"
            }
            false => {
                "position of the handle in frame (-1), along the direction in which it is known least"
            }
        }
    }

    /// Postures with readings at the origin, so that model less reading is the position, and with what the device's effects add
    /// there: how the handle moves with their numbers. Rows of a recording are selected afterwards, as what depends on the
    /// motion needs the rows between them.
    ///
    /// # Errors
    /// [`DeviceEffectError`] of an effect that the recording has not what it depends on for.
    pub(super) fn prepared(
        &mut self,
        recording: &Recording,
    ) -> Result<Recording, DeviceEffectError> {
        let mut own = recording.clone();
        own.position_m = Some([0; 3].map(|_| vec![0.0; own.len()]));
        own.orientation_wxyz = None;
        own.added.clear();
        let mut own = attached(&mut self.device, &own)?.into_owned();
        // what a tracker gets wrong moves no handle
        own.added.retain(|added| {
            let effect = self.device.effects.get(added.effect);
            let spec = effect.and_then(|effect| spec(&effect.name));
            spec.is_none_or(|spec| spec.hook != Hook::Tracker)
        });
        Ok(own)
    }

    /// At every posture of a recording, [prepared](Self::prepared) as those of all other questions.
    pub(super) fn at(&self, postures: &Recording) -> Result<Vec<Place>, Error> {
        let (problem, sizes) = self.problem(postures)?;
        let all: Vec<usize> = (0..self.parameters.len()).collect();
        let (jacobian, residuals) =
            evaluate_jacobian(&problem, &problem.start(), &all).map_err(Error::internal)?;
        let places = sizes.iter().enumerate().map(|(row, size)| {
            let axes = |own: &dyn Fn(usize) -> f64| {
                Vector3::new(own(3 * row), own(3 * row + 1), own(3 * row + 2)) * *size
            };
            Place {
                position_m: axes(&|at| residuals[at]),
                by_parameter: all
                    .iter()
                    .map(|&column| match self.parameters[column] {
                        // the handle is where it is, in metres, whatever the tracker makes of them
                        ParameterId::Surrounding(SurroundingParameter::TrackerScale) => {
                            Vector3::zeros()
                        }
                        _ => axes(&|at| jacobian[(at, column)]),
                    })
                    .collect(),
            }
        });
        Ok(places.collect())
    }

    /// Derivatives by each joint's reading, at every posture.
    pub(super) fn by_reading(&self, postures: &Recording) -> Result<Vec<Vec<Vector3<f64>>>, Error> {
        let mut found = vec![Vec::new(); postures.len()];
        for joint in 0..postures.joint.len() {
            let moved = |step: f64| {
                let mut moved = postures.clone();
                let readings = moved.joint[joint].iter_mut();
                readings.for_each(|reading| *reading += step);
                self.positions(&moved)
            };
            for ((found, more), less) in found.iter_mut().zip(moved(STEP)?).zip(moved(-STEP)?) {
                found.push((more - less) / (2.0 * STEP));
            }
        }
        Ok(found)
    }

    /// Positions alone.
    pub(super) fn positions(&self, postures: &Recording) -> Result<Vec<Vector3<f64>>, Error> {
        let (problem, sizes) = self.problem(postures)?;
        of_values(&problem, &problem.start(), &sizes)
    }

    /// Positions of one posture with each of many vectors of the parameters' values.
    pub(super) fn with_values(
        &self,
        posture: &Recording,
        mut look: impl FnMut(&dyn Fn(&[f64]) -> Option<Vector3<f64>>),
    ) -> Result<(), Error> {
        let (problem, sizes) = self.problem(posture)?;
        look(&|values| of_values(&problem, values, &sizes).ok()?.first().copied());
        Ok(())
    }

    /// Model less reading of the positions, and what the residuals of each row are divided by.
    fn problem<'a>(
        &'a self,
        postures: &'a Recording,
    ) -> Result<(DeviceProblem<'a>, Vec<f64>), Error> {
        let (device, channels) = (&self.device, [Channel::Position]);
        let weights = Weights::stated(device, &channels);
        let problem = DeviceProblem::new(device, postures, &channels, &self.parameters, &weights);
        let sizes = weights.residual_sd(device, postures, Channel::Position);
        Ok((
            problem.map_err(Error::internal)?,
            sizes.map_err(Error::internal)?,
        ))
    }
}

/// Positions with these values of the parameters.
fn of_values(
    problem: &DeviceProblem<'_>,
    values: &[f64],
    sizes: &[f64],
) -> Result<Vec<Vector3<f64>>, Error> {
    let mut residuals = vec![0.0; problem.residual_count()];
    problem
        .evaluate(values, &mut residuals, None)
        .map_err(Error::internal)?;
    let axes = residuals.chunks_exact(3).zip(sizes);
    let positions = axes.map(|(axes, size)| Vector3::from_column_slice(axes) * *size);
    Ok(positions.collect())
}
