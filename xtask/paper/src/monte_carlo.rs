//! Many seeds of the same calibration, in parallel, with results in the order of the seeds.

use anyhow::{Result, bail};
use haptical_identification::Reduction;
use haptical_metrics::{median, percentile_interval, rms, spearman};
use haptical_model::Device;
use xtask_output::Progress;

use crate::pose_error::PoseErrors;
use crate::run::{CapstanEstimate, evaluation_readings, run, step_two};
use crate::scenario::Scenario;

/// The figures kept of one run.
#[derive(Debug, Clone)]
pub(crate) struct Sample {
    /// Estimated minus assigned, per row of Table 3, after both steps.
    pub(crate) errors: Vec<f64>,
    /// The same with the transmissions known exactly.
    pub(crate) errors_known_angles: Vec<f64>,
    /// Cramér-Rao standard deviations for known angles.
    pub(crate) bounds: Vec<f64>,
    /// Information matrix of the rows of Table 3, as the factor of its QR.
    pub(crate) information: Reduction,
    pub(crate) capstans: Vec<CapstanEstimate>,
    pub(crate) pose: PoseSummary,
    /// Orientation RMS without the unobservable part where the transmissions are known exactly.
    pub(crate) orientation_observable_known_rad: f64,
    pub(crate) from_home: FarFromHome,
}

/// How the errors before calibration depend on the distance from home, in one run.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FarFromHome {
    /// Rank correlations of the position error with the norm of all joint readings, and of the cable-driven joints'.
    pub(crate) position: [f64; 2],
    /// The same of the orientation error.
    pub(crate) orientation: [f64; 2],
    /// Shares of poses beyond 8 mm and 0.03 rad.
    pub(crate) beyond_8_mm: f64,
    pub(crate) beyond_30_mrad: f64,
    /// Mean rank (0 to 1) of the distance from home of the poses beyond 8 mm, where there are any.
    pub(crate) rank_beyond_8_mm: Option<f64>,
}

impl FarFromHome {
    pub(crate) fn new(errors: &PoseErrors) -> Result<Self> {
        let (all, driven) = (&errors.from_home_rad, &errors.driven_from_home_rad);
        let share = |values: &[f64], limit: f64| {
            values.iter().filter(|value| **value > limit).count() as f64 / values.len() as f64
        };
        let far = errors.position_before_m.iter().zip(driven);
        let far = far.filter(|(error, _)| **error > 8e-3).map(|(_, from)| {
            let nearer = driven.iter().filter(|other| *other < from);
            nearer.count() as f64 / driven.len() as f64
        });
        let far: Vec<f64> = far.collect();
        let correlations = |values: &[f64]| -> Result<[f64; 2]> {
            Ok([spearman(all, values)?, spearman(driven, values)?])
        };
        Ok(Self {
            position: correlations(&errors.position_before_m)?,
            orientation: correlations(&errors.orientation_before_rad)?,
            beyond_8_mm: share(&errors.position_before_m, 8e-3),
            beyond_30_mrad: share(&errors.orientation_before_rad, 0.03),
            rank_beyond_8_mm: (!far.is_empty()).then(|| far.iter().sum::<f64>() / far.len() as f64),
        })
    }
}

/// Root mean squares of one run's check: before, after, and of poses without the unobservable part.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PoseSummary {
    pub(crate) distance_m: [f64; 2],
    pub(crate) position_m: [f64; 3],
    pub(crate) orientation_rad: [f64; 3],
}

/// Places of what is after in a [`PoseSummary`].
pub(crate) const AFTER: usize = 1;
pub(crate) const OBSERVABLE: usize = 2;

impl PoseSummary {
    pub(crate) fn new(errors: &PoseErrors) -> Result<Self> {
        let e = errors;
        let of = |values: [&Vec<f64>; 3]| -> Result<[f64; 3]> {
            Ok([rms(values[0])?, rms(values[1])?, rms(values[2])?])
        };
        let places = [&e.position_before_m, &e.position_after_m];
        let turns = [&e.orientation_before_rad, &e.orientation_after_rad];
        Ok(Self {
            distance_m: [rms(&e.distance_before_m)?, rms(&e.distance_after_m)?],
            position_m: of([places[0], places[1], &e.position_observable_m])?,
            orientation_rad: of([turns[0], turns[1], &e.orientation_observable_rad])?,
        })
    }
}

/// How much less an error is than before \[%\].
pub(crate) fn gain(errors: &[f64], after: usize) -> f64 {
    100.0 * (1.0 - errors[after] / errors[0])
}

#[derive(Debug)]
pub(crate) struct MonteCarlo {
    pub(crate) samples: Vec<Sample>,
    /// Seeds whose search did not end at a minimum, with the reason.
    pub(crate) failures: Vec<(u64, String)>,
}

/// Median and 95 % interval.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spread {
    pub(crate) median: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

/// The largest of some sizes; 0 of none.
pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

/// The largest magnitude of some numbers; 0 of none.
pub(crate) fn largest_size(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| most.max(value.abs()))
}

impl Spread {
    pub(crate) fn new(values: &[f64]) -> Result<Self> {
        let interval = percentile_interval(values, 0.95)?;
        Ok(Self {
            median: median(values)?,
            low: interval.low,
            high: interval.high,
        })
    }
}

impl MonteCarlo {
    /// Runs the seeds `seed`, `seed` + 1, ...
    pub(crate) fn new(
        name: &str,
        scenario: &Scenario,
        assigned: &[(String, f64)],
        seed: u64,
        runs: usize,
    ) -> Result<Self> {
        let of_seed = |index| Sample::new(scenario, assigned, seed.wrapping_add(index));
        let (mut samples, mut failures) = (Vec::new(), Vec::new());
        let outcomes = Progress::new(name, runs).over(runs, of_seed);
        for (index, outcome) in (0..).zip(outcomes) {
            let seed = seed.wrapping_add(index);
            match outcome {
                Ok(sample) => samples.push(sample),
                Err(error) => failures.push((seed, format!("{error:#}"))),
            }
        }
        if samples.len() * 2 < runs {
            bail!(
                "more than half of the runs failed, the first with: {:?}",
                failures.first()
            );
        }
        Ok(Self { samples, failures })
    }

    /// One figure of every run.
    pub(crate) fn each(&self, figure: impl Fn(&Sample) -> f64) -> Vec<f64> {
        self.samples.iter().map(figure).collect()
    }

    /// Its median and interval.
    pub(crate) fn spread(&self, figure: impl Fn(&Sample) -> f64) -> Result<Spread> {
        Spread::new(&self.each(figure))
    }
}

impl Sample {
    fn new(scenario: &Scenario, assigned: &[(String, f64)], seed: u64) -> Result<Self> {
        let outcome = run(scenario, seed)?;
        let known = step_two(scenario, &known_angles(scenario), seed)?;
        let mut errors = Vec::new();
        let mut errors_known_angles = Vec::new();
        let mut bounds = Vec::new();
        for (name, value) in assigned {
            let mut estimates = known.estimates.iter();
            let (Some((found, _)), Some(estimate)) = (
                outcome.deviation(&scenario.nominal, name),
                estimates.find(|estimate| estimate.name == *name),
            ) else {
                bail!("seed {seed}: {name} was not identified");
            };
            let (Some(absolute), Some(sd)) = (estimate.value, estimate.standard_deviation) else {
                bail!("seed {seed}: {name} was not identified at known angles");
            };
            let parameter = scenario.nominal.parameter(name)?;
            errors.push(found - value);
            errors_known_angles.push(absolute - parameter.value(&scenario.nominal) - value);
            bounds.push(sd);
        }
        let readings = evaluation_readings(scenario, seed)?;
        let known_pose = scenario.pose_errors(&known.device, &readings)?;
        let capstans = (0..3).filter_map(|joint| outcome.capstan(joint)).collect();
        Ok(Self {
            errors,
            errors_known_angles,
            bounds,
            information: information(&known, assigned)?,
            capstans,
            pose: PoseSummary::new(&outcome.pose)?,
            orientation_observable_known_rad: rms(&known_pose.orientation_observable_rad)?,
            from_home: FarFromHome::new(&outcome.pose)?,
        })
    }
}

/// The nominal device with the true transmissions: step 1 without any error.
pub fn known_angles(scenario: &Scenario) -> Device {
    with_transmissions_of(&scenario.nominal, &scenario.truth)
}

/// A device with another one's transmissions.
pub fn with_transmissions_of(device: &Device, other: &Device) -> Device {
    let mut mixed = device.clone();
    for (joint, from) in mixed.joints.iter_mut().zip(&other.joints) {
        joint.transmission_error = from.transmission_error.clone();
    }
    mixed
}

/// The inverse covariance of the rows of Table 3 as a small least-squares problem.
fn information(
    fit: &haptical_calibration::ParameterFit,
    assigned: &[(String, f64)],
) -> Result<Reduction> {
    let position = |(name, _): &(String, f64)| {
        let mut estimates = fit.estimates.iter();
        let index = estimates.position(|estimate| estimate.name == *name)?;
        fit.fitted.iter().position(|&fitted| fitted == index)
    };
    let positions: Vec<usize> = assigned.iter().filter_map(position).collect();
    let size = positions.len();
    let covariance = nalgebra::DMatrix::from_fn(size, size, |i, j| {
        fit.uncertainty.covariance[(positions[i], positions[j])]
    });
    let Some(factor) = covariance.cholesky() else {
        bail!("the covariance is not positive")
    };
    let Some(inverse) = factor.l().try_inverse() else {
        bail!("the covariance is singular")
    };
    let matrix = haptical_linalg::Matrix::from_fn(size, size, |i, j| inverse[(i, j)]);
    Ok(Reduction::new(&matrix, &vec![0.0; size])?)
}

/// e' C^-1 e for errors e under a run's covariance C.
pub(crate) fn chi_square(information: &Reduction, errors: &[f64]) -> Result<f64> {
    let columns: Vec<usize> = (0..errors.len()).collect();
    let factor = information.scaled_factor(&columns, information.column_norms())?;
    let whitened = factor.times(errors)?;
    Ok(whitened.iter().map(|value| value * value).sum())
}
