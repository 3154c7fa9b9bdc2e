//! One fit of chosen parameters: prune what the data cannot fix, search, and judge again at the
//! solution.

use std::collections::BTreeMap;

use haptical_identification::{
    Convergence, Estimate, Identifiability, IdentifiabilityRules, IdentificationError, Matrix,
    NoiseScale, Problem, Reduction, Uncertainty, analyse, estimates, solve, uncertainty,
};
use haptical_model::{Device, ParameterId, Recording};

use crate::considered::Considered;
use crate::form::{Prepared, reduce};
use crate::free_set::{enough, hold, parameter_shares, worth_fitting};
use crate::loads::Loads;
use crate::mistakes;
use crate::multi_start::{self, Starts};
use crate::profiled::Profiled;
use crate::reduced::{count_readings, scale_to_residuals};
use crate::settle::settle;
use crate::wider::widen_offsets;
use crate::{
    CalibrationError, Channel, DeviceProblem, Options, Weighting, Weights, parameter_infos,
    preference_order, scale,
};

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
    /// Covariance of the fitted candidates by the noise.
    pub uncertainty: Uncertainty,
    /// Parameters that were held although they are uncertain; the intervals contain them.
    pub considered: Considered,
    /// Where the size of the noise came from.
    pub noise: NoiseScale,
    /// Intervals that are not linearised ones ([`crate::calibrate`] looks for them).
    pub profiled: Profiled,
    /// What searches from other places said, where the first was doubted.
    pub starts: Starts,
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

impl ParameterFit {
    /// The parameters that are uncertain, the fitted ones and then those considered, and the covariance of their
    /// errors.
    pub fn uncertain(&self) -> (Vec<ParameterId>, Matrix) {
        let fitted = self.fitted.iter().map(|&index| self.parameters[index]);
        let considered = self.considered.parameters.iter().copied();
        let covariance = self.considered.whole(&self.uncertainty.covariance);
        (fitted.chain(considered).collect(), covariance)
    }

    /// Names of two fitted parameters whose errors correlate by more than [`HIGH_CORRELATION`] in size, with the
    /// correlation, the strongest first.
    pub fn high_correlations(&self) -> Vec<(String, String, f64)> {
        let spread = &self.uncertainty;
        let name = |position: usize| self.estimates[spread.columns[position]].name.clone();
        let mut found = Vec::new();
        for a in 0..spread.columns.len() {
            for b in a + 1..spread.columns.len() {
                let correlation = spread.correlation(a, b);
                if correlation.abs() > HIGH_CORRELATION {
                    found.push((name(a), name(b), correlation));
                }
            }
        }
        found.sort_by(|one, other| other.2.abs().total_cmp(&one.2.abs()));
        found
    }
}

/// Correlations above this size are listed.
pub const HIGH_CORRELATION: f64 = 0.95;

/// Rounds of pruning at the solution before the set is accepted as it is.
const MAX_ROUNDS: usize = 6;

/// Fits `parameters` of `device` to chosen channels of a recording.
///
/// Parameters that are invisible, dependent or weak are held at the device's values and say so in
/// their status. The set is decided at the nominal device and decided again at the solution, because
/// a geometry that is special by design (parallel, intersecting) is not special once it deviates.
/// A search that fails, or ends where no good fit ends, is tried again from random places
/// ([`Options::starts`]).
///
/// # Errors
/// [`CalibrationError`] where nothing can be fitted or no search ends at a minimum.
pub fn fit_parameters(
    what: &str,
    device: &Device,
    recording: &Recording,
    channels: &[Channel],
    parameters: &[ParameterId],
    weights: &Weights,
    options: &Options,
) -> Result<ParameterFit, CalibrationError> {
    fit_task(&Task {
        what,
        device,
        recording,
        channels,
        parameters,
        weights,
        options,
        from: None,
        loads_of: None,
    })
}

/// [`fit_parameters`] of a task.
pub(crate) fn fit_task(task: &Task<'_>) -> Result<ParameterFit, CalibrationError> {
    let (what, device, options) = (task.what, task.device, task.options);
    let fit = multi_start::improve(task, task.fit_from(None)?)?;
    mistakes::refuse(task, &fit)?;
    let fit = settle(task, fit)?;
    let fit = widen_offsets(task, fit)?;
    if !fit.convergence.was_successful() && !options.unfinished {
        return Err(CalibrationError::NotConverged {
            what: what.to_owned(),
            reason: fit.convergence.to_string(),
        });
    }
    if let Some(share) = scale::collapsed(device, &fit.device, task.recording, task.channels) {
        return Err(CalibrationError::Collapsed {
            what: what.to_owned(),
            share,
        });
    }
    Ok(fit)
}

/// What [`fit_parameters`] was asked.
pub(crate) struct Task<'a> {
    pub(crate) what: &'a str,
    pub(crate) device: &'a Device,
    pub(crate) recording: &'a Recording,
    pub(crate) channels: &'a [Channel],
    pub(crate) parameters: &'a [ParameterId],
    pub(crate) weights: &'a Weights,
    pub(crate) options: &'a Options,
    /// Whose values the search begins at: those of `device` where it is none. What is held stays at `device`'s.
    pub(crate) from: Option<&'a Device>,
    /// Whose compliances say at which angles the torques are taken: those of `device` where it is none.
    pub(crate) loads_of: Option<&'a Device>,
}

impl Task<'_> {
    /// Fits from where the task says, or from other values; a search that ends elsewhere than at a minimum is no
    /// error here.
    pub(crate) fn fit_from(
        &self,
        values: Option<&[f64]>,
    ) -> Result<ParameterFit, CalibrationError> {
        let (device, recording, channels) = (self.device, self.recording, self.channels);
        let (parameters, weights) = (self.parameters, self.weights);
        let begun: Option<Vec<f64>> = self.from.map(|device| {
            let values = parameters.iter().map(|parameter| parameter.value(device));
            values.collect()
        });
        let values = values.or(begun.as_deref());
        if let Some(problem) =
            DeviceProblem::in_bulk(device, recording, channels, parameters, weights)
        {
            let prepared = Prepared::new(&problem);
            let lanes = prepared.lanes();
            // refused or in another form: the general way tells why, with a line of the log
            if prepared.is_in_lanes()
                && let Ok(first) = reduce(prepared.searched(lanes.as_ref()), &problem.start())
            {
                return self.fit_prepared(&prepared, &first, values);
            }
        }
        let mut problem = DeviceProblem::new(device, recording, channels, parameters, weights)?;
        if let Some(yielded) = self.loads_of {
            problem.loads = Loads::new(yielded, recording)?;
        }
        let prepared = Prepared::new(&problem);
        let lanes = prepared.lanes();
        let first = reduce(prepared.searched(lanes.as_ref()), &problem.start());
        let first = first.map_err(|source| wrap(self.what, source))?;
        self.fit_prepared(&prepared, &first, values)
    }

    /// Fits from `values`, or the device's own, where the linearised problem is `first`.
    fn fit_prepared(
        &self,
        prepared: &Prepared<'_>,
        first: &Reduction,
        values: Option<&[f64]>,
    ) -> Result<ParameterFit, CalibrationError> {
        let (what, options) = (self.what, self.options);
        let wrap = |source| wrap(what, source);
        let problem = prepared.problem;
        let start = problem.start();
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
        let nominal_identifiability = judge(first, &[]).map_err(wrap)?;
        let mut free = worth_fitting(&nominal_identifiability);
        let mut values = values.map_or_else(|| start.clone(), <[f64]>::to_vec);
        hold(&mut values, &free, &start);
        let mut iterations = 0;
        let mut round = 0;
        let (fit, identifiability, reduction) = loop {
            round += 1;
            enough(what, problem, &free, &nominal_identifiability)?;
            let fit = solve(searched, &values, &free, &options.search).map_err(wrap)?;
            iterations += fit.iterations;
            let reduction = reduce(searched, &fit.parameters).map_err(wrap)?;
            let judged = judge(&reduction, &free).map_err(wrap)?;
            let wanted = worth_fitting(&judged);
            if wanted == free {
                break (fit, judged, reduction);
            }
            if round == MAX_ROUNDS {
                // No set is stable: keep the fitted one and let its statuses be those at the solution.
                break (fit, judged, reduction);
            }
            values.clone_from(&fit.parameters);
            free = wanted;
            hold(&mut values, &free, &start);
        };
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
        let device = problem.device_with(&fit.parameters);
        let considered = Considered::weak(&device, parameters, &identifiability, &reduction, &free);
        let considered = considered.map_err(wrap)?;
        let mut estimates = estimates(&infos, &fit.parameters, &identifiability, &spread, noise);
        considered.widen(&mut estimates, &free, &spread, noise);
        self.add_torque_scale(&mut estimates, &spread, noise);
        let residuals = prepared.residuals(&fit.parameters).map_err(wrap)?;
        Ok(ParameterFit {
            device,
            parameters: parameters.to_vec(),
            fitted: free,
            estimates,
            uncertainty: spread,
            considered,
            noise,
            profiled: Profiled::default(),
            starts: Starts::default(),
            nominal_identifiability,
            identifiability,
            convergence: fit.convergence,
            iterations,
            cost: fit.cost,
            residuals,
            channel_parameters: shares,
        })
    }

    /// A compliance is in proportion to the torque that it was told from: the scale error of a logged torque,
    /// which no reading shows, is its own.
    fn add_torque_scale(
        &self,
        estimates: &mut [Estimate],
        spread: &Uncertainty,
        noise: NoiseScale,
    ) {
        let half_width = spread.half_width_95(noise);
        for (parameter, estimate) in self.parameters.iter().zip(estimates) {
            let ParameterId::Compliance { joint } = *parameter else {
                continue;
            };
            let is_logged = self
                .recording
                .torque_nm
                .get(joint)
                .is_some_and(Option::is_some);
            let described = self.device.joints.get(joint).filter(|_| is_logged);
            if let (Some(described), Some(value), Some(sd)) =
                (described, estimate.value, &mut estimate.standard_deviation)
            {
                *sd = sd.hypot(described.torque_scale_sd * value);
                estimate.ci95 = Some([value - half_width * *sd, value + half_width * *sd]);
            }
        }
    }
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

pub(crate) fn wrap(what: &str, source: IdentificationError) -> CalibrationError {
    CalibrationError::Identification {
        what: what.to_owned(),
        source,
    }
}
