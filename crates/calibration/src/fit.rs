//! One fit of chosen parameters: prune what the data cannot fix, search, and judge again at the
//! solution.

use std::collections::BTreeMap;

use haptical_identification::{
    Convergence, Estimate, Identifiability, IdentifiabilityRules, IdentificationError, NoiseScale,
    Problem, Reduction, Settings, Status, Uncertainty, analyse, estimates, evaluate_jacobian,
    solve, uncertainty,
};
use haptical_model::{Device, ParameterId, Recording};

use crate::form::{Prepared, reduce};
use crate::reduced::{count_readings, scale_to_residuals};
use crate::{
    CalibrationError, Channel, DeviceProblem, HeldOut, ReducedProblem, Weights, parameter_infos,
    preference_order,
};

/// Order of the identification.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CalibrationMethod {
    /// The paper's: transmissions from external encoders, then kinematics.
    TwoStep,
    /// All at once.
    Joint,
}

/// Degree of the polynomial that stands for a parallelogram.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Degree {
    /// As given; the paper takes 10.
    Fixed(usize),
    /// The degree from 2 to this one that the evidence (BIC) favours.
    UpTo(usize),
}

/// Where the sizes of the noise come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weighting {
    /// The device file.
    Stated,
    /// The device file first, then each channel's residuals.
    Estimated,
}

/// Options of a calibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Two steps or all at once.
    pub method: CalibrationMethod,
    /// Polynomial degree.
    pub degree: Degree,
    /// Hold the constant offset of equation (1) at zero, as the paper's tables do: the encoders
    /// were zeroed at home.
    pub zeroed_at_home: bool,
    /// Noise sizes.
    pub weighting: Weighting,
    /// Rows that the fit does not see.
    pub held_out: HeldOut,
    /// Search settings.
    pub search: Settings,
    /// Take a search that ends elsewhere than at a minimum for an answer too; its `convergence` says so.
    pub unfinished: bool,
    /// Identifiability thresholds.
    pub rules: IdentifiabilityRules,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            method: CalibrationMethod::Joint,
            degree: Degree::UpTo(14),
            zeroed_at_home: false,
            weighting: Weighting::Estimated,
            held_out: HeldOut::default(),
            search: Settings::default(),
            unfinished: false,
            rules: IdentifiabilityRules::default(),
        }
    }
}

/// The outcome of one fit.
#[derive(Debug, Clone)]
pub struct ParameterFit {
    /// The device with the fitted values.
    pub device: Device,
    /// All candidates.
    pub parameters: Vec<ParameterId>,
    /// Positions (within the candidates) that were fitted; the others keep their nominal values.
    pub fitted: Vec<usize>,
    /// Value, interval and status of every candidate.
    pub estimates: Vec<Estimate>,
    /// Covariance of the fitted candidates.
    pub uncertainty: Uncertainty,
    /// Judgement at the nominal device.
    pub nominal_identifiability: Identifiability,
    /// Judgement at the solution.
    pub identifiability: Identifiability,
    /// Why the search stopped.
    pub convergence: Convergence,
    /// Accepted steps, all rounds.
    pub iterations: usize,
    /// Sum of squared weighted residuals.
    pub cost: f64,
    /// Weighted residuals.
    pub residuals: Vec<f64>,
    /// Parameters that each channel's readings pay for: its part of the trace of
    /// J (J^T J)^-1 J^T; they add up to the number of fitted parameters.
    pub channel_parameters: BTreeMap<Channel, f64>,
}

/// Rounds of pruning at the solution before the set is accepted as it is.
const MAX_ROUNDS: usize = 6;

/// Fits `parameters` of `device` to chosen channels of a recording.
///
/// Parameters that are invisible, dependent or weak are held at the device's values and say so in
/// their status. The set is decided at the nominal device and decided again at the solution, because
/// a geometry that is special by design (parallel, intersecting) is not special once it deviates.
///
/// # Errors
/// [`CalibrationError`] where nothing can be fitted or the search does not end at a minimum.
pub fn fit_parameters(
    what: &str,
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
    parameters: &[ParameterId],
    weights: &Weights,
    options: &Options,
) -> Result<ParameterFit, CalibrationError> {
    if let Some(problem) = DeviceProblem::in_bulk(device, recording, channels, parameters, weights)
    {
        let prepared = Prepared::new(&problem);
        let lanes = prepared.lanes();
        let start = problem.start();
        // refused or in another form: the general way tells why, with a line of the log
        if prepared.is_in_lanes()
            && let Ok(first) = reduce(prepared.searched(lanes.as_ref()), &start)
        {
            return fit_prepared(what, &prepared, (&start, first), options);
        }
    }
    let problem = DeviceProblem::new(device, recording, channels, parameters, weights)?;
    let prepared = Prepared::new(&problem);
    let lanes = prepared.lanes();
    let start = problem.start();
    let first = reduce(prepared.searched(lanes.as_ref()), &start);
    let first = first.map_err(|source| wrap(what, source))?;
    fit_prepared(what, &prepared, (&start, first), options)
}

/// Fits from the device's own values, where the linearised problem is `first`.
fn fit_prepared(
    what: &str,
    prepared: &Prepared<'_>,
    (start, first): (&[f64], Reduction),
    options: &Options,
) -> Result<ParameterFit, CalibrationError> {
    let wrap = |source| wrap(what, source);
    let problem = prepared.problem;
    let lanes = prepared.lanes();
    let searched = prepared.searched(lanes.as_ref());
    let parameters = problem.parameters();
    let infos = parameter_infos(problem.device(), parameters);
    let order = preference_order(parameters);
    let judge = |reduction: &Reduction, first: &[usize]| {
        // What is being fitted is preferred to what is not: of a dependent set the member stays
        // that was chosen at the nominal device, so that the set settles.
        let mut order = order.clone();
        order.sort_by_key(|index| !first.contains(index));
        let mut judged = analyse(reduction, &infos, &order, &options.rules)?;
        if let Some(index) = &mut judged.observability {
            count_readings(index, reduction.rows(), problem.residual_count());
        }
        Ok(judged)
    };
    let nominal_identifiability = judge(&first, &[]).map_err(wrap)?;
    let mut free = worth_fitting(&nominal_identifiability);
    let mut values = start.to_vec();
    let mut iterations = 0;
    let mut round = 0;
    let (fit, identifiability) = loop {
        round += 1;
        enough(what, problem, &free, &nominal_identifiability)?;
        let fit = solve(searched, &values, &free, &options.search).map_err(wrap)?;
        iterations += fit.iterations;
        let reduction = reduce(searched, &fit.parameters).map_err(wrap)?;
        let judged = judge(&reduction, &free).map_err(wrap)?;
        let wanted = worth_fitting(&judged);
        if wanted == free {
            break (fit, judged);
        }
        if round == MAX_ROUNDS {
            // No set is stable: keep the fitted one and let its statuses be those at the solution.
            break (fit, judged);
        }
        values.clone_from(&fit.parameters);
        free = wanted;
        for index in (0..values.len()).filter(|index| !free.contains(index)) {
            values[index] = start[index];
        }
    };
    if !fit.convergence.was_successful() && !options.unfinished {
        return Err(CalibrationError::NotConverged {
            what: what.to_owned(),
            reason: fit.convergence.to_string(),
        });
    }
    let noise = match options.weighting {
        Weighting::Stated => NoiseScale::Stated,
        Weighting::Estimated => NoiseScale::Estimated,
    };
    let columns: Vec<usize> = (0..free.len()).collect();
    let mut spread =
        uncertainty(&fit.reduction, &columns, fit.cost, NoiseScale::Stated).map_err(wrap)?;
    let shares =
        parameter_shares(&prepared.reduced, &fit.parameters, &free, &spread).map_err(wrap)?;
    spread.degrees_of_freedom = problem.residual_count() - free.len();
    if noise == NoiseScale::Estimated {
        scale_to_residuals(&mut spread, fit.cost);
    }
    spread.columns.clone_from(&free);
    let estimates = estimates(&infos, &fit.parameters, &identifiability, &spread, noise);
    let residuals = prepared.residuals(&fit.parameters).map_err(wrap)?;
    Ok(ParameterFit {
        device: problem.device_with(&fit.parameters),
        parameters: parameters.to_vec(),
        fitted: free,
        estimates,
        uncertainty: spread,
        nominal_identifiability,
        identifiability,
        convergence: fit.convergence,
        iterations,
        cost: fit.cost,
        residuals,
        channel_parameters: shares,
    })
}

/// Judges every candidate at one device, without fitting.
///
/// # Errors
/// [`CalibrationError`] where the device has no value at a row.
pub fn identifiability_at(
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
    parameters: &[ParameterId],
    weights: &Weights,
    rules: &IdentifiabilityRules,
) -> Result<Identifiability, CalibrationError> {
    let wrap = |source| wrap("identifiability", source);
    let problem = DeviceProblem::new(device, recording, channels, parameters, weights)?;
    let prepared = Prepared::new(&problem);
    let lanes = prepared.lanes();
    let searched = prepared.searched(lanes.as_ref());
    let reduction = reduce(searched, &problem.start()).map_err(wrap)?;
    let infos = parameter_infos(device, parameters);
    let mut judged =
        analyse(&reduction, &infos, &preference_order(parameters), rules).map_err(wrap)?;
    if let Some(index) = &mut judged.observability {
        count_readings(index, reduction.rows(), problem.residual_count());
    }
    Ok(judged)
}

/// Each channel's part of the trace of J (J^T J)^-1 J^T, with `spread` for unit noise: the sum of
/// f^T C f over the rows f of its triangle. A single channel pays for all of them.
fn parameter_shares(
    reduced: &ReducedProblem<'_>,
    values: &[f64],
    free: &[usize],
    spread: &Uncertainty,
) -> Result<BTreeMap<Channel, f64>, IdentificationError> {
    if let [(channel, _)] = reduced.layout() {
        return Ok([(*channel, free.len() as f64)].into());
    }
    let (triangles, _) = evaluate_jacobian(reduced, values, free)?;
    let mut first = 0;
    let mut shares = BTreeMap::new();
    for &(channel, rows) in reduced.layout() {
        let mut share = 0.0;
        for row in first..first + rows {
            for a in 0..free.len() {
                for b in 0..free.len() {
                    share += triangles[(row, a)] * spread.covariance[(a, b)] * triangles[(row, b)];
                }
            }
        }
        shares.insert(channel, share);
        first += rows;
    }
    Ok(shares)
}

/// The identifiable parameters, ascending; weak ones would take the noise for their value.
fn worth_fitting(judged: &Identifiability) -> Vec<usize> {
    (0..judged.statuses.len())
        .filter(|&index| matches!(judged.statuses[index], Status::Identifiable { .. }))
        .collect()
}

fn enough(
    what: &str,
    problem: &DeviceProblem<'_>,
    free: &[usize],
    judged: &Identifiability,
) -> Result<(), CalibrationError> {
    let rows = problem.residual_count();
    // A rank equal to the number of rows says that the rows ran out, not the geometry.
    let parameters = free
        .len()
        .max(if judged.rank >= rows { rows + 1 } else { 0 });
    if rows <= parameters {
        return Err(CalibrationError::TooFewRows {
            what: what.to_owned(),
            rows,
            parameters: parameters.max(judged.names.len().min(judged.rank + 1)),
            advised: 5 * judged.names.len(),
        });
    }
    if free.is_empty() {
        let reasons: Vec<String> = (0..judged.names.len())
            .filter_map(|index| judged.reason(index))
            .take(3)
            .collect();
        return Err(CalibrationError::NothingIdentifiable {
            what: what.to_owned(),
            reason: reasons.join("; "),
        });
    }
    Ok(())
}

pub(crate) fn wrap(what: &str, source: IdentificationError) -> CalibrationError {
    CalibrationError::Identification {
        what: what.to_owned(),
        source,
    }
}
