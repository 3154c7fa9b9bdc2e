//! Searches from other places where the first one failed or ended where no good fit ends.

use haptical_identification::{Fit, Problem, Settings, solve};
use haptical_model::{Device, ParameterId};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::error::wrap;
use crate::fit::implausible::{IMPLAUSIBLE, implausible_links};
use crate::fit::request::FitRequest;
use crate::fit::size;
use crate::problem::device_problem::values_of;
use crate::problem::form::Prepared;
use crate::problem::some_rows::spread_rows;
use crate::{CalibrationError, DeviceProblem, ParameterFit, Starts};

/// Residual over stated noise beyond which a search may have ended at a wrong minimum.
const ABOVE_NOISE: f64 = 5.0;
/// Fall of the residuals' sum, in units of the noise's variance, that held weak parameters do not hold back by
/// plausible deviations: one that is half fixed does with a probability of 1e-5.
const MISSED: f64 = 100.0;
/// Sizes of the random deviations, in plausible sizes, in turn.
const REACHES: [f64; 3] = [1.0, 3.0, IMPLAUSIBLE];
/// Rows that the random places are tried on: which valley is deepest shows on few.
const MOST_ROWS: usize = 240;
/// Steps of a search from a random place: those that arrive need ten to thirty.
const MOST_STEPS: usize = 100;
/// Share by which a minimum must be lower than another to be a better one.
const BETTER: f64 = 0.1;
/// Difference of two minima, in units of the noise's variance, that the noise may make.
const AS_GOOD: f64 = 10.0;
/// Any number does; results name it.
const SEED: u64 = 0x6361_6c69_6272;

/// Tries random places where the first fit is doubted, and returns the better fit.
///
/// # Errors
/// [`CalibrationError`] of the problem on fewer rows; a place from which no search works is passed over.
pub(crate) fn improve(
    request: &FitRequest<'_>,
    first: ParameterFit,
) -> Result<ParameterFit, CalibrationError> {
    let Some(doubt) = doubt(request, &first) else {
        return Ok(first);
    };
    // transmissions and joint fits begin where an earlier step ended
    let is_chain = |parameter: &ParameterId| matches!(parameter, ParameterId::Link { .. });
    let begins_afresh = request.parameters.iter().all(is_chain);
    let is_collapsed = collapsed(request, &first.device).is_some();
    let is_failed = !first.convergence.was_successful() || is_collapsed;
    if request.options.starts == 0 || !(begins_afresh || is_failed) {
        let starts = Starts {
            doubt_that_remains: Some(doubt.clone()),
            doubt: Some(doubt),
            ..Starts::default()
        };
        return Ok(ParameterFit { starts, ..first });
    }
    let part = request
        .recording
        .select(&spread_rows(request.recording.len(), MOST_ROWS));
    let (channels, parameters) = (request.channels, request.parameters);
    let problem = DeviceProblem::new(request.device, &part, channels, parameters, request.weights)?;
    if problem.residual_count() <= first.fitted.len() {
        return Ok(first);
    }
    let prepared = Prepared::new(&problem)?;
    let searched = prepared.searched();
    let settings = Settings {
        max_iterations: request.options.search.max_iterations.min(MOST_STEPS),
        ..request.options.search.to_compare()
    };
    let search = |values: &[f64]| solve(searched, values, &first.fitted, &settings);
    let nominal = problem.start();
    let ended = values_of(parameters, &first.device);
    let again = search(&ended).map_err(|source| wrap(request.what, source))?;
    let found: Vec<Fit> = (0..request.options.starts)
        .filter_map(|number| search(&random_place(request, &first.fitted, &nominal, number)).ok())
        .filter(|fit| fit.convergence.was_successful())
        .filter(|fit| collapsed(request, &problem.device_with(&fit.parameters)).is_none())
        .collect();
    let mut starts = Starts {
        doubt_that_remains: Some(doubt.clone()),
        doubt: Some(doubt),
        tried: request.options.starts,
        seed: SEED,
        ..Starts::default()
    };
    let best = found.iter().min_by(|a, b| a.cost.total_cmp(&b.cost));
    let Some(best) = best else {
        return Ok(ParameterFit { starts, ..first });
    };
    let is_better = is_collapsed || best.cost < (1.0 - BETTER) * again.cost;
    let lowest = if is_collapsed {
        best.cost
    } else {
        best.cost.min(again.cost)
    };
    let freedom = (problem.residual_count() - first.fitted.len()) as f64;
    let noise = (lowest / freedom).max(1.0);
    let as_good = |fit: &&Fit| fit.cost - lowest <= AS_GOOD * noise;
    starts.reached_best = found.iter().filter(as_good).count();
    let kept = if is_better {
        &best.parameters
    } else {
        &again.parameters
    };
    starts.rivals = found
        .iter()
        .filter(as_good)
        .filter(|fit| {
            let is_near = |reach, from: &[f64]| is_within(request, reach, &fit.parameters, from);
            is_near(IMPLAUSIBLE, &nominal) && !is_near(1.0, kept)
        })
        .count();
    if !is_better && !is_failed {
        return Ok(ParameterFit { starts, ..first });
    }
    let place = problem.device_with(&best.parameters);
    let again = FitRequest {
        start: Some(&place),
        ..*request
    };
    let Ok(second) = again.fit() else {
        return Ok(ParameterFit { starts, ..first });
    };
    starts.replaced = is_preferred(request, &second, &first);
    if starts.replaced {
        starts.doubt_that_remains = self::doubt(request, &second);
    }
    let fit = if starts.replaced { second } else { first };
    Ok(ParameterFit { starts, ..fit })
}

/// Whether a fit from a random place takes the place of the first.
fn is_preferred(request: &FitRequest<'_>, second: &ParameterFit, first: &ParameterFit) -> bool {
    if !second.convergence.was_successful() {
        return false;
    }
    match [first, second].map(|fit| collapsed(request, &fit.device)) {
        [_, Some(_)] => return false,
        [Some(_), None] => return true,
        [None, None] => {}
    }
    let is_plausible = |fit: &ParameterFit| implausible_links(request.device, fit).is_empty();
    let is_lower = second.cost < (1.0 - BETTER) * first.cost;
    let was_none =
        !first.convergence.was_successful() && second.cost <= (1.0 + BETTER) * first.cost;
    // a mirror image may fit an incomplete model better than the device itself
    (is_lower || was_none) && (is_plausible(second) || !is_plausible(first))
}

/// The share of its size that a device kept, where it was drawn to a point.
fn collapsed(request: &FitRequest<'_>, device: &Device) -> Option<f64> {
    size::collapsed(request.device, device, request.recording, request.channels)
}

/// Why a fit is doubted.
fn doubt(request: &FitRequest<'_>, fit: &ParameterFit) -> Option<String> {
    if !fit.convergence.was_successful() {
        return Some(fit.convergence.to_string());
    }
    if let Some(share) = collapsed(request, &fit.device) {
        return Some(format!(
            "the device shrank to {share:.1e} of its size, where all touches agree"
        ));
    }
    let above = above_noise(request, fit);
    if above > ABOVE_NOISE {
        return Some(format!("its residual is {above:.1} times the stated noise"));
    }
    if let Some(names) = missed(fit) {
        return Some(format!(
            "the recording hardly fixes {names}, so they are held, but no plausible value of theirs explains the \
             residual"
        ));
    }
    let names = implausible_links(request.device, fit);
    (!names.is_empty()).then(|| {
        format!(
            "over {IMPLAUSIBLE} times what devices show: {}",
            names.join(", ")
        )
    })
}

/// Largest ratio of a channel's residual to its stated noise.
fn above_noise(request: &FitRequest<'_>, fit: &ParameterFit) -> f64 {
    let mut first = 0;
    let mut most = 0.0_f64;
    for channel in request.channels {
        let rows = 0..request.recording.len();
        let readings = rows.filter(|&row| channel.has_reading(request.recording, row));
        let end = (first + readings.count() * channel.width()).min(fit.residuals.len());
        let residuals = &fit.residuals[first..end];
        first = end;
        let paid = fit.channel_parameters.get(channel).copied().unwrap_or(0.0);
        let freedom = residuals.len() as f64 - paid;
        if freedom >= 1.0 {
            let square: f64 = residuals.iter().map(|value| value * value).sum();
            let factor = request.weights.factor.get(channel).copied().unwrap_or(1.0);
            most = most.max(factor * (square / freedom).sqrt());
        }
    }
    most
}

/// Names of the held weak parameters, where what they hold back is more than plausible deviations would.
///
/// A weak parameter's standard deviation is at least half its plausible size, so a deviation of that size promises a
/// fall of at most 4.
fn missed(fit: &ParameterFit) -> Option<String> {
    let considered = &fit.considered;
    let freedom = fit.residuals.len() as f64 - fit.fitted.len() as f64;
    let noise = (fit.cost - considered.promised_fall).max(0.0) / freedom;
    let is_missed = considered.promised_fall > MISSED * noise.max(f64::MIN_POSITIVE);
    let names: Vec<String> = considered
        .weak()
        .map(|parameter| parameter.name(&fit.device))
        .collect();
    (freedom >= 1.0 && is_missed && !names.is_empty()).then(|| names.join(", "))
}

/// Whether all values are within so many plausible sizes of others.
fn is_within(request: &FitRequest<'_>, sizes: f64, values: &[f64], from: &[f64]) -> bool {
    let parameters = request.parameters.iter().zip(values).zip(from);
    parameters
        .map(|((parameter, value), from)| (parameter.plausible_size(request.device), value - from))
        .all(|(size, moved)| moved.abs() <= sizes * size)
}

/// The device's values, the free ones moved at random.
fn random_place(
    request: &FitRequest<'_>,
    free: &[usize],
    nominal: &[f64],
    number: usize,
) -> Vec<f64> {
    let mut generator = ChaCha8Rng::seed_from_u64(SEED.wrapping_add(number as u64));
    let reach = REACHES[number % REACHES.len()];
    let mut values = nominal.to_vec();
    for &index in free {
        let size = request.parameters[index].plausible_size(request.device);
        values[index] += reach * size * generator.random_range(-1.0..1.0);
    }
    values
}
