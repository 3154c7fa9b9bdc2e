//! Anchors that keep the base model of touches near the device: touches of unknown places fix many of its numbers badly.

use haptical_calibration::{Channel, DeviceProblem, GaugedProblem, ParameterFit, Weights};
use haptical_identification::{IdentificationError, Matrix, Problem, Settings, solve};
use haptical_model::{Device, ParameterId, Recording};

use crate::Result;
use crate::thresholds::fit::ANCHOR_REACH;

/// Prior knowledge of a base model's numbers: where each is known to be without the recording.
///
/// A fit of touches holds the numbers that it cannot fix. Together with the effects of a diagnosis they cannot be held: an
/// encoder that is mounted five degrees off leaves residuals that an effect would explain. Nor can they be free: nothing
/// stops them, and the device with them, on the way to another shape. So they are free with a reading of their own
/// value, as it was before (a ridge, or the prior of Bayes; docs/diagnosis.md, Touches).
#[derive(Debug, Clone)]
pub(crate) struct Anchor {
    /// By free parameter: value, and one over its standard deviation; zero for what nobody knows beforehand.
    at: Vec<f64>,
    stiffness: Vec<f64>,
}

impl Anchor {
    /// The anchor of the free ones of `parameters` at a device.
    fn new(device: &Device, parameters: &[ParameterId], free: &[usize]) -> Self {
        let free = || free.iter().map(|&index| parameters[index]);
        let stiffness = |parameter: ParameterId| match parameter {
            ParameterId::Surrounding(_) => 0.0,
            _ => 1.0 / (ANCHOR_REACH * parameter.plausible_size(device)),
        };
        Self {
            at: free().map(|parameter| parameter.value(device)).collect(),
            stiffness: free().map(stiffness).collect(),
        }
    }

    /// One over the standard deviations.
    pub(crate) fn stiffness(&self) -> &[f64] {
        &self.stiffness
    }

    /// From values to the anchor, in standard deviations.
    pub(crate) fn pull(&self, values: &[f64], free: &[usize]) -> Vec<f64> {
        let anchors = self.at.iter().zip(&self.stiffness);
        free.iter()
            .zip(anchors)
            .map(|(&index, (at, stiffness))| stiffness * (at - values[index]))
            .collect()
    }
}

/// Whether a base model needs an anchor.
pub(crate) fn is_needed(channels: &[Channel]) -> bool {
    let is_touch = |channel: &Channel| matches!(channel, Channel::Contact | Channel::Plane);
    channels.iter().any(is_touch)
}

/// A base model with an anchor: its device, what it adjusts, and where that is known to be.
pub(crate) struct Anchored {
    pub(crate) device: Device,
    pub(crate) free: Vec<usize>,
    pub(crate) anchor: Anchor,
}

/// Fits what a fit of touches held because it is weak too, all numbers being anchored where `from` has them; none
/// where the search ends at no minimum.
pub(crate) fn anchored(
    fit: &ParameterFit,
    from: &Device,
    recording: &Recording,
    channels: &[Channel],
    weights: &Weights,
    settings: &Settings,
) -> Result<Option<Anchored>> {
    let weak = |index: &usize| {
        let is_fitted = fit.fitted.contains(index);
        is_fitted
            || fit
                .considered
                .weak()
                .any(|weak| weak == fit.parameters[*index])
    };
    let free: Vec<usize> = (0..fit.parameters.len()).filter(weak).collect();
    let anchor = Anchor::new(from, &fit.parameters, &free);
    let problem = DeviceProblem::new(from, recording, channels, &fit.parameters, weights)?;
    let gauged = GaugedProblem::new(&problem)?;
    let held = Held {
        problem: &gauged,
        free: &free,
        anchor: &anchor,
    };
    let found = solve(&held, &problem.start(), &free, settings).ok();
    let found = found.filter(|found| found.convergence.was_successful());
    let device = found.map(|found| problem.device_with(&found.parameters));
    Ok(device.map(|device| Anchored {
        device,
        free,
        anchor,
    }))
}

/// A recording's residuals, and those of the anchored numbers.
struct Held<'p> {
    problem: &'p GaugedProblem<'p>,
    free: &'p [usize],
    anchor: &'p Anchor,
}

impl Problem for Held<'_> {
    fn parameter_count(&self) -> usize {
        self.problem.parameter_count()
    }

    fn residual_count(&self) -> usize {
        self.problem.residual_count() + self.free.len()
    }

    fn evaluate(
        &self,
        values: &[f64],
        residuals: &mut [f64],
        jacobian: Option<(&[usize], &mut Matrix)>,
    ) -> Result<(), IdentificationError> {
        let count = self.problem.residual_count();
        let (own, anchored) = residuals.split_at_mut(count);
        for (residual, pull) in anchored.iter_mut().zip(self.anchor.pull(values, self.free)) {
            *residual = -pull;
        }
        let Some((asked, matrix)) = jacobian else {
            return self.problem.evaluate(values, own, None);
        };
        let mut derivatives = Matrix::zeros(count, asked.len());
        self.problem
            .evaluate(values, own, Some((asked, &mut derivatives)))?;
        for (column, parameter) in asked.iter().enumerate() {
            let (touches, anchors) = matrix.column_mut(column).split_at_mut(count);
            touches.copy_from_slice(derivatives.column(column));
            let pairs = self.free.iter().zip(self.anchor.stiffness());
            for (entry, (free, stiffness)) in anchors.iter_mut().zip(pairs) {
                *entry = if free == parameter { *stiffness } else { 0.0 };
            }
        }
        Ok(())
    }
}
