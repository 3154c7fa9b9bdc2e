//! Mistaken columns of a log that a fit shows: a joint's sign or place, or rows one off, are refused where the correction fits
//! far better.

use haptical_model::{ParameterId, Recording};

use crate::checks::columns::{Change, has_neighbours, of_columns, of_rows};
use crate::fit::implausible::implausible_links;
use crate::fit::put_on;
use crate::fit::request::FitRequest;
use crate::fit::size;
use crate::fit::trial::{LEFT, NEARER, Trial, without_places};
use crate::problem::some_rows::spread_rows;
use crate::{CalibrationError, Channel, ParameterFit};

/// Rows that the changed logs are tried on.
const MOST_ROWS: usize = 80;

/// Residual of a mirror image of the device, in shares of which the device's own is as good.
const AS_GOOD: f64 = 1.5;
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
