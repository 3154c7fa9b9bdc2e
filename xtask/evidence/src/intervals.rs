//! Coverage of 95 % intervals over simulated devices.

use std::collections::BTreeMap;

use anyhow::{Context, Result, ensure};
use haptical_calibration::{
    CalibrationMethod, Channel, ParameterFit, Weights, channels, fit_device, fit_kinematics,
    force_direction, predict_distances, predict_positions, with_curvature, with_step_one_noise,
};
use haptical_model::{Device, Recording};
use haptical_simulator::true_poses;
use xtask_output::{Output, Progress};
use xtask_paper::{rows, with_transmissions_of};

use super::coverage_tables;
use super::force_truth::true_angle_rad;
use super::held::{Held, intervals};
use super::rigs::{Errors, Rig, estimated, nominal, postures, record, true_device};

/// What the intervals state.
pub(super) const LEVEL: f64 = 0.95;
/// Postures that predictions are tried at.
pub(super) const POSTURES: usize = 5;
/// How a device is calibrated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Way {
    /// Step 2 alone: the transmissions are known exactly.
    AnglesKnown,
    TwoSteps,
    Joint,
}

/// One way of recording and calibrating many devices.
pub(super) struct Trial {
    pub(super) name: &'static str,
    pub(super) way: Way,
    pub(super) rig: Rig,
    pub(super) errors: Errors,
    pub(super) rows: usize,
}

pub(super) const TRIALS: [Trial; 9] = rows! {
    Trial {name way rig errors rows}
    "angles known", Way::AnglesKnown, Rig::Cable, Errors::Gaussian, 200;
    "two steps", Way::TwoSteps, Rig::Cable, Errors::Gaussian, 200;
    "joint", Way::Joint, Rig::Cable, Errors::Gaussian, 200;
    "joint, counts", Way::Joint, Rig::Cable, Errors::Counts, 200;
    "joint, unequal noise", Way::Joint, Rig::Cable, Errors::Unequal, 200;
    "joint, heavy tails", Way::Joint, Rig::Cable, Errors::Tails, 200;
    "joint, tracker", Way::Joint, Rig::Tracker, Errors::Gaussian, 200;
    "joint, tracker, unequal noise", Way::Joint, Rig::Tracker, Errors::Unequal, 200;
    "angles known, 45 poses", Way::AnglesKnown, Rig::Cable, Errors::Gaussian, 45;
};

/// What became of one device: whether each interval held the truth.
struct Outcome {
    held: Vec<(String, bool)>,
    /// Handle coordinates that got no interval, because the rig does not fix them.
    refused: usize,
    /// Parameters that were held at their nominal values and considered.
    considered: usize,
}

/// A quantity of one trial, over its devices.
pub(super) struct Quantity {
    pub(super) trial: usize,
    pub(super) name: String,
    pub(super) held: usize,
    pub(super) devices: usize,
}

impl Quantity {
    /// How often its interval holds the truth.
    pub(super) fn percent(&self) -> f64 {
        100.0 * self.held as f64 / self.devices as f64
    }
}

pub(super) fn section(output: &mut Output, devices: usize) -> Result<()> {
    output.section("Intervals");
    output.words(format!(
        "{devices} simulated devices a trial: the paper's device, every link parameter, capstan term and polynomial \
         coefficient with a normal deviation of its plausible size (docs/assumptions.md), each device recorded and calibrated once with its own noise. Counted is how often the 95 % interval holds the \
         truth: of every parameter that gets one, of the handle's distance (one cable) or coordinates (tracker, 0.05 \
         mm) at {POSTURES} postures that no fit saw, and of the force direction's root mean square angle. What the rig \
         cannot tell apart is held at its nominal value and deviates like everything else: the interval of a parameter \
         that is fixed only in a combination is counted, and that of the combination besides. Probabilities are of the exact \
         two-sided binomial test against 0.95, with Holm's correction over all quantities of all trials."
    ));
    let mut quantities = Vec::new();
    let mut failures: Vec<Vec<String>> = Vec::new();
    let mut notes = Vec::new();
    for (index, trial) in TRIALS.iter().enumerate() {
        let outcomes = trial.run(devices)?;
        let mut counts: BTreeMap<&str, Held> = BTreeMap::new();
        let (mut refused, mut considered, mut failed) = (0, 0, Vec::new());
        for (seed, outcome) in outcomes.iter().enumerate() {
            match outcome {
                Ok(outcome) => {
                    refused += outcome.refused;
                    considered += usize::from(outcome.considered > 0);
                    for (name, held) in &outcome.held {
                        counts.entry(name).or_default().count(*held);
                    }
                }
                Err(error) => failed.push(format!("device {seed}: {error:#}")),
            }
        }
        notes.push((refused, considered));
        failures.push(failed);
        let often = counts.into_iter().filter(|(_, own)| own.is_often(devices));
        quantities.extend(often.map(|(name, own)| Quantity {
            trial: index,
            name: name.to_owned(),
            held: own.held,
            devices: own.all,
        }));
    }
    coverage_tables::report(output, devices, &quantities, &failures, &notes)
}

impl Trial {
    fn run(&self, devices: usize) -> Result<Vec<Result<Outcome>>> {
        let nominal = nominal(self.rig, self.errors)?;
        let postures = postures(&nominal, POSTURES)?;
        let progress = Progress::new(self.name, devices);
        Ok(progress.over(devices, |seed| self.device(&nominal, &postures, seed)))
    }

    fn device(&self, nominal: &Device, postures: &Recording, seed: u64) -> Result<Outcome> {
        let truth = true_device(nominal, seed);
        let seen = record(&truth, (self.rig, self.errors), self.rows, seed)?;
        let fit = self.fit(nominal, &truth, &seen)?;
        ensure!(
            fit.starts.doubt_that_remains.is_none(),
            "doubted: {}",
            fit.starts.doubt_that_remains.unwrap_or_default()
        );
        let found = intervals(&fit, &truth)?.into_iter();
        let mut held: Vec<(String, bool)> = found
            .map(|own| (own.label(), own.error_over_half_width.abs() <= 1.0))
            .collect();
        let actual = true_poses(&truth, postures)?;
        let mut refused = 0;
        let mut note = |name: String, ci95: Option<[f64; 2]>, actual: f64| match ci95 {
            Some([low, high]) => held.push((name, low <= actual && actual <= high)),
            None => refused += 1,
        };
        for (row, axes) in predict_positions(&fit, postures)?.into_iter().enumerate() {
            for (axis, prediction) in axes.into_iter().enumerate() {
                let name = format!("{} at posture {}", ["x", "y", "z"][axis], row + 1);
                note(name, prediction.ci95, actual[row].position_m[axis]);
            }
        }
        if self.rig == Rig::Cable {
            let distances = predict_distances(&fit, postures, [0.0; 3])?;
            for (row, prediction) in distances.into_iter().enumerate() {
                let name = format!("distance at posture {}", row + 1);
                note(name, prediction.ci95, actual[row].position_m.norm());
            }
        }
        if self.way == Way::Joint
            && let Some(found) = force_direction(&fit, &seen)?
        {
            let angle = true_angle_rad(&truth, &fit.device, &seen)?;
            note("force direction".to_owned(), Some(found.ci95_rad), angle);
        }
        Ok(Outcome {
            held,
            refused,
            considered: fit.considered.parameters.len(),
        })
    }

    fn fit(&self, nominal: &Device, truth: &Device, seen: &Recording) -> Result<ParameterFit> {
        let options = estimated(match self.way {
            Way::AnglesKnown | Way::TwoSteps => CalibrationMethod::TwoStep,
            Way::Joint => CalibrationMethod::Joint,
        });
        if self.way == Way::AnglesKnown {
            let known = with_transmissions_of(nominal, truth);
            let channels = [Channel::Cable { index: 0 }];
            let weights = Weights::stated(&known, &channels);
            let fit = fit_kinematics(&known, seen, &channels, &weights, &options)?;
            return Ok(with_curvature(fit, seen, &channels, &weights)?);
        }
        let fitted = fit_device(nominal, seen, &options)?;
        let whole = fitted.whole.context("no kinematic fit")?;
        let (steps, weights) = (&fitted.transmissions, &fitted.weights);
        if self.way == Way::Joint {
            let all = channels(&fitted.device, seen)?;
            return Ok(with_curvature(whole, seen, &all, weights)?);
        }
        let distant = [Channel::Cable { index: 0 }];
        let fit = with_step_one_noise(whole, steps, seen, &distant, weights)?;
        Ok(with_curvature(fit, seen, &distant, weights)?)
    }
}
