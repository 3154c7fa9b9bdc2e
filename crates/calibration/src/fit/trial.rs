//! A device before a changed log: what it leaves, with and without a fit.

use haptical_identification::Problem;
use haptical_model::{Device, Recording};

use crate::fit::implausible::implausible_links;
use crate::fit::request::FitRequest;
use crate::{DeviceProblem, Options, prepare_device};

/// Steps of a search.
const MOST_STEPS: usize = 40;
/// A device before a log.
pub(super) struct Trial<'a> {
    request: &'a FitRequest<'a>,
    prepared: Device,
    part: &'a Recording,
}

impl<'a> Trial<'a> {
    pub(super) fn new(
        request: &'a FitRequest<'a>,
        device: &Device,
        part: &'a Recording,
    ) -> Option<Self> {
        let prepared = prepare_device(device, part).ok()?;
        Some(Self {
            request,
            prepared,
            part,
        })
    }

    /// Residual before any parameter of the chain is fitted, in units of the stated noise.
    pub(super) fn unfitted(&self) -> Option<f64> {
        let request = self.request;
        let (channels, parameters) = (request.channels, request.parameters);
        let problem = DeviceProblem::new(
            &self.prepared,
            self.part,
            channels,
            parameters,
            request.weights,
        );
        let problem = problem.ok()?;
        let mut residuals = vec![0.0; problem.residual_count()];
        problem
            .evaluate(&problem.start(), &mut residuals, None)
            .ok()?;
        let sum: f64 = residuals.iter().map(|value| value * value).sum();
        Some((sum / residuals.len() as f64).sqrt()).filter(|left| left.is_finite())
    }

    /// Residual after a fit from the device's own values, and how many values are implausible then.
    pub(super) fn fitted(&self) -> Option<(f64, usize)> {
        let mut options = Options {
            starts: 0,
            unfinished: true,
            ..self.request.options.clone()
        };
        options.search.max_iterations = options.search.max_iterations.min(MOST_STEPS);
        let trial = FitRequest {
            device: &self.prepared,
            recording: self.part,
            options: &options,
            start: None,
            yielded: None,
            ..*self.request
        };
        let fit = trial.fit().ok()?;
        let freedom = fit.residuals.len().checked_sub(fit.fitted.len())?;
        let left = (fit.cost / freedom as f64).sqrt();
        let odd = implausible_links(self.request.device, &fit).len();
        (freedom > 0 && left.is_finite()).then_some((left, odd))
    }
}

/// The device without what a log's readings placed around it.
pub(super) fn without_places(device: &Device) -> Device {
    let mut bare = device.clone();
    let (base_known, tool_known) = device.tracker.as_ref().map_or((true, true), |tracker| {
        (tracker.base_known, tracker.tool_known)
    });
    let around = &mut bare.surroundings;
    if !base_known {
        around.tracker_base = None;
    }
    if !tool_known {
        around.tracker_tool = None;
    }
    around.run_bases.clear();
    for tool in &mut around.tools {
        tool.placement = None;
    }
    around.contacts.clear();
    around.planes.clear();
    bare
}
