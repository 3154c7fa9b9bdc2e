//! Mistaken columns of a log that a fit shows: a joint's sign or place, or rows one off, are refused where the correction fits
//! far better.

use haptical_identification::Problem;
use haptical_model::{Device, ParameterId, Recording};

use crate::checks::columns::{Change, has_neighbours, of_columns, of_rows};
use crate::fit::implausible::implausible_links;
use crate::fit::put_on;
use crate::fit::request::FitRequest;
use crate::fit::rows::spread_rows;
use crate::fit::size;
use crate::{CalibrationError, Channel, DeviceProblem, Options, ParameterFit, prepare_device};

/// Rows that the changed logs are tried on.
const MOST_ROWS: usize = 80;
/// Steps of a search.
const MOST_STEPS: usize = 40;
/// Share of the residual that a changed log must leave at most: an effect that the model lacks stays, whatever
/// column is turned.
pub(super) const LEFT: f64 = 0.2;

/// Residual of a mirror image of the device, in shares of which the device's own is as good.
const AS_GOOD: f64 = 1.5;
/// Share of the residual before a fit that a changed log must leave at most to be fitted.
pub(super) const NEARER: f64 = 0.7;
/// Most changed logs that are fitted, the nearest first.
const MOST_FITS: usize = 4;

/// Share of the handle's range that a residual has at least where a column is turned.
const GROSS: f64 = 0.02;

/// Refuses a log with which a fit stays doubtful, if it fits several times better after one change of its columns or rows.
/// A fit that begins where another one ended is of the same log as that one.
///
/// # Errors
/// [`CalibrationError::MistakenColumns`]; [`CalibrationError::Rig`] for a tool that was put on at another line.
pub(crate) fn refuse(request: &FitRequest<'_>, fit: &ParameterFit) -> Result<(), CalibrationError> {
    // transmissions are fitted to external encoders, which show a turned column themselves
    let is_transmission =
        |parameter: &ParameterId| matches!(parameter, ParameterId::Transmission { .. });
    let is_looked_at = request.start.is_some() || fit.starts.doubt_that_remains.is_none();
    if is_looked_at || request.parameters.iter().any(is_transmission) {
        return Ok(());
    }
    let rows = spread_rows(request.recording.len(), MOST_ROWS);
    let part = request.recording.select(&rows);
    let bare = without_places(request.device);
    let Some(unfitted) = Trial::new(request, &bare, &part).and_then(|trial| trial.unfitted())
    else {
        return Ok(());
    };
    put_on::refuse(request, fit, (&bare, unfitted), &rows)?;
    if implausible_links(request.device, fit).is_empty() && !is_gross(request, unfitted, &part) {
        return Ok(());
    }
    let mut nearer: Vec<(f64, Change, Recording)> = of_columns(request.device)
        .into_iter()
        .filter_map(|change| {
            let part = change.of_rows(request.recording, &rows);
            let left = Trial::new(request, &bare, &part)?.unfitted()?;
            (left < NEARER * unfitted).then_some((left, change, part))
        })
        .collect();
    nearer.sort_by(|a, b| a.0.total_cmp(&b.0));
    nearer.truncate(MOST_FITS);
    // how far a row is off shows only once the device is fitted
    let inner: Vec<usize> = (rows.iter().copied())
        .filter(|&row| has_neighbours(request.recording, row))
        .collect();
    nearer.extend(of_rows(request.recording).into_iter().map(|change| {
        let part = change.of_rows(request.recording, &inner);
        (unfitted, change, part)
    }));
    if nearer.is_empty() {
        return Ok(());
    }
    let Some((as_logged, odd)) =
        Trial::new(request, &fit.device, &part).and_then(|trial| trial.fitted())
    else {
        return Ok(());
    };
    let mut found: Vec<(f64, Change)> = nearer
        .iter()
        .filter_map(|(_, change, part)| {
            let (left, odd_values) = Trial::new(request, &bare, part)?.fitted()?;
            let is_far_better = left < LEFT * as_logged && odd_values <= odd;
            // the log as it is may be that of a mirror image of the device
            let is_more_plausible =
                !change.is_of_rows() && left < AS_GOOD * as_logged && odd_values == 0 && odd > 0;
            (is_far_better || is_more_plausible).then_some((left, *change))
        })
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Some(&(best, _)) = found.first() else {
        return Ok(());
    };
    let as_good = found.iter().filter(|(left, _)| *left < 2.0 * best);
    let words: Vec<String> = as_good
        .map(|(_, change)| change.words(request.device))
        .collect();
    Err(CalibrationError::MistakenColumns {
        what: words.join(", or "),
        before: as_logged,
        after: best,
    })
}

/// Whether a residual, in units of the stated noise, is as large as what a turned column makes.
fn is_gross(request: &FitRequest<'_>, residual: f64, part: &Recording) -> bool {
    let is_length = |channel: &&Channel| channel.unit(request.device) == "m";
    let Some(channel) = request.channels.iter().find(is_length) else {
        return true;
    };
    let deviations = request.weights.residual_sd(request.device, part, *channel);
    let sd_m = deviations.ok().and_then(|rows| rows.first().copied());
    sd_m.is_none_or(|sd_m| residual * sd_m > GROSS * size::spread_m(request.device, part))
}

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
            ..*self.request.options
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
fn without_places(device: &Device) -> Device {
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
