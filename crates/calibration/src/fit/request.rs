//! One fit: prune what the data cannot fix, search, and judge again at the solution.

use std::collections::BTreeMap;

use haptical_identification::{
    Convergence, Identifiability, IdentifiabilityRules, NoiseScale, ParameterInfo, Problem,
    Reduction, Uncertainty, estimates, solve, uncertainty,
};
use haptical_model::{Device, ParameterId, Recording};

use crate::error::wrap;
use crate::fit::considered::Considered;
use crate::fit::free_set::{hold, judge, parameter_shares, supported};
use crate::fit::parameter_fit::{ParameterFit, Profiled, Starts};
use crate::fit::rounds::{Ended, Rounds};
use crate::problem::device_problem::values_of;
use crate::problem::form::{Prepared, reduce};
use crate::problem::loads::Loads;
use crate::problem::some_rows::some_of_long;
use crate::{
    CalibrationError, Channel, DeviceProblem, Options, Weighting, Weights, parameter_infos,
};

/// A fit of chosen parameters to chosen channels of a recording; [`crate::fit_parameters`] answers it.
#[derive(Debug, Clone, Copy)]
pub struct FitRequest<'a> {
    /// Name of the fit in errors.
    pub what: &'a str,
    /// The device: held parameters keep its values.
    pub device: &'a Device,
    /// The recording.
    pub recording: &'a Recording,
    /// Channels whose residuals are minimised.
    pub channels: &'a [Channel],
    /// Candidates for the fit.
    pub parameters: &'a [ParameterId],
    /// Positions within the candidates of those that the samples do not support: they keep the device's values, and
    /// the intervals count what they may be.
    pub unsupported: &'a [usize],
    /// Standard deviations of the residuals.
    pub weights: &'a Weights,
    /// Search, rules of identifiability, further starts.
    pub options: &'a Options,
    /// The device whose values the search begins at; `device` where none.
    pub start: Option<&'a Device>,
    /// The device whose compliances decide at which angles the torques are taken; `device` where none.
    pub yielded: Option<&'a Device>,
}

impl FitRequest<'_> {
    /// Fits from the start of the request; a search that ends elsewhere than at a minimum is no error here.
    pub(crate) fn fit(&self) -> Result<ParameterFit, CalibrationError> {
        let (device, recording, channels) = (self.device, self.recording, self.channels);
        let (parameters, weights) = (self.parameters, self.weights);
        let some = some_of_long(recording);
        if let Some(problem) =
            DeviceProblem::in_bulk(device, recording, channels, parameters, weights)
        {
            let prepared = Prepared::new(&problem)?;
            // refused or in another form: the general way reports why, with a line of the log
            if prepared.is_in_lanes()
                && let Ok(first) = reduce(prepared.searched(), &problem.start())
            {
                let few = some
                    .as_ref()
                    .and_then(|some| self.few(some, &problem).ok()?);
                let few = few.as_ref().and_then(|few| Prepared::new(few).ok());
                return self.fit_prepared(&prepared, &first, few.as_ref());
            }
        }
        let mut problem = DeviceProblem::new(device, recording, channels, parameters, weights)?;
        if let Some(yielded) = self.yielded {
            problem.loads = Loads::new(yielded, recording)?;
        }
        let prepared = Prepared::new(&problem)?;
        let few = match &some {
            Some(some) => self.few(some, &problem)?,
            None => None,
        };
        let few = few.as_ref().map(Prepared::new).transpose()?;
        let first = few.as_ref().unwrap_or(&prepared).searched();
        let first = reduce(first, &problem.start());
        let first = first.map_err(|source| wrap(self.what, source))?;
        self.fit_prepared(&prepared, &first, few.as_ref())
    }

    /// The problem of some rows, which stand for all of them; none where a channel has no reading in them.
    fn few<'s>(
        &'s self,
        some: &'s Recording,
        all: &DeviceProblem<'_>,
    ) -> Result<Option<DeviceProblem<'s>>, CalibrationError> {
        let (device, channels) = (self.device, self.channels);
        let mut few = DeviceProblem::new(device, some, channels, self.parameters, self.weights)?;
        if let Some(yielded) = self.yielded {
            few.loads = Loads::new(yielded, some)?;
        }
        Ok(few.weigh_as(all).then_some(few))
    }

    /// Fits a problem that is linearised to `first` at the device's values; `few` is that of some rows of a long
    /// recording.
    fn fit_prepared(
        &self,
        prepared: &Prepared<'_>,
        first: &Reduction,
        few: Option<&Prepared<'_>>,
    ) -> Result<ParameterFit, CalibrationError> {
        let (what, options) = (self.what, self.options);
        let wrap = |source| wrap(what, source);
        let problem = prepared.problem;
        let start = problem.start();
        let parameters = problem.parameters();
        let infos = parameter_infos(problem.device(), parameters);
        let judge = |reduction: &Reduction, first: &[usize]| {
            judge(problem, &infos, reduction, first, &options.rules)
        };
        // of a dependent set the member stays that the samples support
        let preferred: Vec<usize> = match self.unsupported {
            [] => Vec::new(),
            unsupported => (0..parameters.len())
                .filter(|index| !unsupported.contains(index))
                .collect(),
        };
        let nominal_identifiability = judge(first, &preferred).map_err(wrap)?;
        if self.unsupported.len() == parameters.len() {
            let judged = (nominal_identifiability, infos.as_slice());
            return self.nothing_fitted(prepared, first, judged);
        }
        let free = supported(&nominal_identifiability, self.unsupported);
        let mut values = values_of(parameters, self.start.unwrap_or(self.device));
        hold(&mut values, &free, &start);
        if let Some(begun) = few.and_then(|few| self.begun(few, &values, &free)) {
            values = begun;
        }
        let rounds = Rounds {
            what,
            options,
            unsupported: self.unsupported,
            prepared,
            infos: &infos,
            nominal: &nominal_identifiability,
        };
        let Ended {
            fit,
            free,
            identifiability,
            reduction,
            iterations,
        } = rounds.run(values, free)?;
        let noise = noise_scale(options);
        let columns: Vec<usize> = (0..free.len()).collect();
        let mut spread =
            uncertainty(&fit.reduction, &columns, fit.cost, NoiseScale::Stated).map_err(wrap)?;
        let shares = parameter_shares(prepared, &fit.parameters, &free, &spread).map_err(wrap)?;
        spread.degrees_of_freedom = problem.residual_count() - free.len();
        if noise == NoiseScale::Estimated {
            scale_to_residuals(&mut spread, fit.cost);
        }
        spread.columns.clone_from(&free);
        let device = problem.device_with(&fit.parameters);
        let considered = Considered::of_fit(
            (&device, parameters),
            &identifiability,
            &reduction,
            (&free, self.unsupported),
            spread.noise_factor,
        );
        let mut considered = considered.map_err(wrap)?;
        considered.by_torque_scale = self.by_torque_scale(&free, &device);
        let mut estimates = estimates(&infos, &fit.parameters, &identifiability, &spread, noise);
        considered.widen(&mut estimates, &free, &spread, noise);
        let residuals = prepared.residuals(&fit.parameters).map_err(wrap)?;
        Ok(ParameterFit {
            device,
            parameters: parameters.to_vec(),
            fitted: free,
            estimates,
            uncertainty: spread,
            considered,
            noise,
            noise_is_checked: false,
            channel_noise: Vec::new(),
            is_widened: false,
            profiled: Profiled::default(),
            starts: Starts::default(),
            nominal_identifiability,
            identifiability,
            convergence: fit.convergence,
            is_coarse: fit.is_coarse,
            iterations,
            cost: fit.cost,
            residuals,
            channel_parameters: shares,
        })
    }

    /// Where a search on some rows of a long recording ends: all of its rows then take a step or two. None where that
    /// search finds no minimum.
    fn begun(&self, few: &Prepared<'_>, values: &[f64], free: &[usize]) -> Option<Vec<f64>> {
        if free.is_empty() {
            return None;
        }
        let settings = self.options.search.to_compare();
        let fit = solve(few.searched(), values, free, &settings).ok()?;
        fit.convergence.was_successful().then_some(fit.parameters)
    }

    /// The device as it is, where the samples support none of the candidates.
    fn nothing_fitted(
        &self,
        prepared: &Prepared<'_>,
        first: &Reduction,
        (identifiability, infos): (Identifiability, &[ParameterInfo]),
    ) -> Result<ParameterFit, CalibrationError> {
        let wrap = |source| wrap(self.what, source);
        let problem = prepared.problem;
        let start = problem.start();
        let residuals = prepared.residuals(&start).map_err(wrap)?;
        let cost: f64 = residuals.iter().map(|residual| residual * residual).sum();
        let noise = noise_scale(self.options);
        let mut spread = Uncertainty::none(residuals.len());
        if noise == NoiseScale::Estimated {
            scale_to_residuals(&mut spread, cost);
        }
        let device = problem.device_with(&start);
        let all = (&[][..], self.unsupported);
        let considered = Considered::of_fit(
            (&device, self.parameters),
            &identifiability,
            first,
            all,
            spread.noise_factor,
        );
        Ok(ParameterFit {
            device,
            parameters: self.parameters.to_vec(),
            fitted: Vec::new(),
            estimates: estimates(infos, &start, &identifiability, &spread, noise),
            considered: considered.map_err(wrap)?,
            noise,
            noise_is_checked: false,
            channel_noise: Vec::new(),
            is_widened: false,
            uncertainty: spread,
            profiled: Profiled::default(),
            starts: Starts::default(),
            nominal_identifiability: identifiability.clone(),
            identifiability,
            convergence: Convergence::SmallStep,
            is_coarse: false,
            iterations: 0,
            cost,
            residuals,
            channel_parameters: BTreeMap::new(),
        })
    }

    /// A compliance is in proportion to the torque that it was fitted to: the scale error of a logged torque,
    /// which no reading shows, is its own.
    fn by_torque_scale(&self, fitted: &[usize], device: &Device) -> Vec<f64> {
        let of_parameter = |&index: &usize| {
            let ParameterId::Compliance { joint } = self.parameters[index] else {
                return 0.0;
            };
            let torques = self.recording.torque_nm.get(joint);
            let described = device.joints.get(joint);
            let described = described.filter(|_| torques.is_some_and(Option::is_some));
            let value = self.parameters[index].value(device);
            described.map_or(0.0, |joint| (joint.torque_scale_sd * value).powi(2))
        };
        fitted.iter().map(of_parameter).collect()
    }
}

fn noise_scale(options: &Options) -> NoiseScale {
    match options.weighting {
        Weighting::Stated => NoiseScale::Stated,
        Weighting::Estimated => NoiseScale::Estimated,
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
    let prepared = Prepared::new(&problem)?;
    let searched = prepared.searched();
    let reduction = reduce(searched, &problem.start()).map_err(wrap)?;
    let infos = parameter_infos(device, parameters);
    judge(&problem, &infos, &reduction, &[], rules).map_err(wrap)
}

/// Turns a covariance for the stated noise into that for noise of the residuals' own size: times
/// cost / degrees of freedom.
fn scale_to_residuals(spread: &mut Uncertainty, cost: f64) {
    spread.noise_factor = (cost / spread.degrees_of_freedom as f64).sqrt();
    let square = spread.noise_factor * spread.noise_factor;
    for column in 0..spread.columns.len() {
        let entries = spread.covariance.column_mut(column).iter_mut();
        entries.for_each(|entry| *entry *= square);
    }
}
