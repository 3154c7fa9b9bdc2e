//! Logs that were written otherwise, where a fit shows it: a joint's column, rows one off, a tool put on at another line.

use haptical_model::{ParameterId, Recording};

use crate::checks::otherwise::hypotheses::{Hypothesis, has_neighbours, of_joints, of_rows};
use crate::fit::implausible::implausible_links;
use crate::fit::put_on::of_tools;
use crate::fit::request::FitRequest;
use crate::fit::size;
use crate::fit::trial::{Trial, without_places};
use crate::problem::some_rows::spread_rows;
use crate::{CalibrationError, Channel, ParameterFit};

/// Rows that the hypotheses are tried on.
const MOST_ROWS: usize = 80;
/// Share of the residual that a hypothesis must leave at most: an effect that the model lacks stays, whatever column is turned.
const LEFT: f64 = 0.2;
/// Share of the residual before a fit that a hypothesis must leave at most to be fitted.
const NEARER: f64 = 0.7;
/// Residual of a mirror image of the device, in shares of which that of the device is as good.
const MIRROR: f64 = 1.5;
/// The same of another hypothesis: half of what an implausible device leaves of the log as it is.
const HALF: f64 = 0.5;
/// Ratio of residuals up to which two hypotheses are as good.
const AS_GOOD: f64 = 2.0;
/// Most hypotheses that are fitted, the nearest first.
const MOST_FITS: usize = 4;
/// Share of the handle's range that a residual has at least where a column is turned.
const GROSS: f64 = 0.02;

/// Refuses a log with which a fit stays doubtful, if it fits several times better under a hypothesis of how it was written.
/// A fit that begins where another one ended is of the same log as that one.
///
/// # Errors
/// [`CalibrationError::MistakenColumns`].
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
    let unfitted = Trial::new(request, &bare, &part).and_then(|trial| trial.unfitted());
    let Some(unfitted) = unfitted else {
        return Ok(());
    };
    let are_odd = !implausible_links(request.device, fit).is_empty();
    let (mut all, mut shifts) = (of_tools(request, &bare, &rows), Vec::new());
    if are_odd || is_gross(request, unfitted, &part) {
        all.extend(of_joints(request.device));
        shifts = of_rows(request.recording);
    }
    let tried = |hypothesis: Hypothesis<'static>| {
        let (device, part) = hypothesis.apply(&bare, request.recording, &rows);
        let left = Trial::new(request, &device, &part)?.unfitted()?;
        (left < NEARER * unfitted).then_some((left, hypothesis))
    };
    let mut nearer: Vec<(f64, Hypothesis<'_>)> = all.into_iter().filter_map(tried).collect();
    nearer.sort_by(|a, b| a.0.total_cmp(&b.0));
    nearer.truncate(MOST_FITS);
    // how far a row is off shows only once the device is fitted
    let inner = rows.iter().copied();
    let inner: Vec<usize> = inner
        .filter(|&row| has_neighbours(request.recording, row))
        .collect();
    let nearer = nearer
        .into_iter()
        .map(|(_, hypothesis)| (hypothesis, &rows));
    let all: Vec<(Hypothesis<'_>, &Vec<usize>)> = nearer
        .chain(shifts.into_iter().map(|hypothesis| (hypothesis, &inner)))
        .collect();
    if all.is_empty() {
        return Ok(());
    }
    let as_logged = Trial::new(request, &fit.device, &part).and_then(|trial| trial.fitted());
    let Some((before, odd)) = as_logged else {
        return Ok(());
    };
    let fitted = all.iter().filter_map(|(hypothesis, rows)| {
        let (device, part) = hypothesis.apply(&bare, request.recording, rows);
        let (left, odd_values) = Trial::new(request, &device, &part)?.fitted()?;
        let is_far_better = left < LEFT * before && odd_values <= odd;
        // the log as it is may be that of a mirror image of the device
        let enough = if hypothesis.is_of_columns() {
            MIRROR
        } else {
            HALF
        };
        let is_more_plausible = left < enough * before && odd_values == 0 && odd > 0;
        (is_far_better || is_more_plausible).then_some((left, hypothesis))
    });
    let mut found: Vec<(f64, &Hypothesis<'_>)> = fitted.collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let Some(&(after, best)) = found.first() else {
        return Ok(());
    };
    let as_good = found.iter().filter(|(left, _)| *left < AS_GOOD * after);
    let what: Vec<&str> = as_good
        .map(|(_, hypothesis)| hypothesis.what.as_str())
        .collect();
    Err(CalibrationError::MistakenColumns {
        what: what.join(", or "),
        before,
        after,
        mend: best.mend,
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
