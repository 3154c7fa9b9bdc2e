//! The paper's own gap: which size of which effect would turn the 99.9 % of a simulation into the 96.6 % of the
//! authors, what Figure 10 would then show, and whether the diagnosis finds it.

use anyhow::Result;
use haptical_diagnosis::{Diagnosis, diagnose};
use haptical_metrics::rms;
use haptical_model::Recording;
use haptical_simulator::{HandMotion, MotionSettings, record_motion};
use rayon::prelude::*;
use xtask_blind::Random;
use xtask_output::Progress;

use super::gap_kinds::{CABLE_NOISE, Kind};
use super::improvement::distance_errors_m;
use crate::run::on_samples;
use crate::scenario::Scenario;

/// The motion is that of Figure 10 at fewer rows: an effect does not depend on their number.
const RATE_HZ: f64 = 50.0;
/// Calibrations in the search for a size, and how near it must come to the percentage.
const TRIES: usize = 24;
const NEAR_PERCENT: f64 = 0.005;
/// The same where the size comes in whole steps.
const STEP_PERCENT: f64 = 0.1;

/// Errors of the distance over one motion.
#[derive(Debug, Clone)]
pub(crate) struct Errors {
    pub(crate) recording: Recording,
    /// By the nominal and by the calibrated device \[m\].
    pub(crate) before_m: Vec<f64>,
    pub(crate) after_m: Vec<f64>,
}

impl Errors {
    /// RMS after calibration over that before.
    fn ratio(&self) -> Result<f64> {
        Ok(rms(&self.after_m)? / rms(&self.before_m)?)
    }

    /// Improvement by eq. (9) \[%\].
    pub(crate) fn improvement_percent(&self) -> Result<f64> {
        Ok(100.0 * (1.0 - self.ratio()?))
    }
}

/// A kind at the size that the authors' number asks for.
#[derive(Debug)]
pub(crate) struct Explained {
    pub(crate) kind: Kind,
    pub(crate) found: Option<Found>,
    /// Improvement at the largest size that is tried \[%\], or why nothing can be fitted there.
    pub(crate) at_largest_percent: Result<f64, String>,
}

/// What the size does.
#[derive(Debug)]
pub(crate) struct Found {
    pub(crate) size: f64,
    pub(crate) errors: Errors,
    /// Answer to the log, or why there is none.
    pub(crate) answer: Result<Diagnosis, String>,
}

/// Calibrates in two steps on random samples of a motion with effects.
pub(crate) fn errors(scenario: &Scenario, kind: &Kind, size: f64, seed: u64) -> Result<Errors> {
    let settings = MotionSettings {
        motion: HandMotion {
            rate_hz: RATE_HZ,
            ..HandMotion::default()
        },
        ..MotionSettings::default()
    };
    let effects = kind
        .effects(size)?
        .with_assumed_roughness(&scenario.truth)?;
    let mut recording = record_motion(&scenario.truth, &effects, &settings, seed)?;
    kind.disturb(&mut recording, size, seed);
    let fitted = on_samples(scenario, &recording, &mut Random::new(seed, 2))?;
    let device = fitted.kinematics.device;
    Ok(Errors {
        before_m: distance_errors_m(&scenario.nominal, &recording)?,
        after_m: distance_errors_m(&device, &recording)?,
        recording,
    })
}

/// The log without any effect, and every kind at the size that gives `percent`.
pub(crate) fn explain(
    scenario: &Scenario,
    kinds: &[Kind],
    percent: f64,
    seed: u64,
) -> Result<(Found, Vec<Explained>)> {
    let progress = Progress::new("the paper's gap", kinds.len());
    let [nothing, _] = CABLE_NOISE.sizes;
    let clean = outcome(scenario, &CABLE_NOISE, nothing, seed)?;
    let floor = clean.errors.ratio()?;
    let all = kinds
        .par_iter()
        .map(|kind| {
            let explained = explain_one(scenario, kind, (percent, floor), seed);
            progress.step();
            explained
        })
        .collect();
    Ok((clean, all))
}

/// Searches the size on logarithmic scales, where what an effect adds to the square of the error is near a
/// straight line of slope two: the step along it if it stays within the bracket, its middle otherwise. Where
/// nothing can be fitted the size is too large.
fn explain_one(
    scenario: &Scenario,
    kind: &Kind,
    (percent, floor): (f64, f64),
    seed: u64,
) -> Explained {
    let wanted = 1.0 - percent / 100.0;
    let ratio =
        |log_size: f64| errors(scenario, kind, log_size.exp(), seed).and_then(|e| e.ratio());
    let excess = |ratio: f64| {
        0.5 * ((ratio.powi(2) - floor.powi(2)) / (wanted.powi(2) - floor.powi(2))).ln()
    };
    let [mut least, mut most] = kind.sizes.map(f64::ln);
    let largest = ratio(most);
    let at_largest_percent = match &largest {
        Ok(ratio) => Ok(100.0 * (1.0 - ratio)),
        Err(error) => Err(format!("{error:#}")),
    };
    let largest = largest.ok();
    let mut explained = Explained {
        kind: *kind,
        found: None,
        at_largest_percent,
    };
    if largest.is_some_and(|ratio| ratio < wanted) {
        return explained;
    }
    // a stiffness does more where it is smaller
    let direction = (most - least).signum();
    let mut last = largest.map(|ratio| (most, excess(ratio)));
    for _ in 0..TRIES {
        let step = last.map(|(at, excess)| at - direction * excess);
        let inside = |at: &f64| at.is_finite() && (at - least) * (at - most) < 0.0;
        let at = step.filter(inside).unwrap_or(0.5 * (least + most));
        let found = ratio(at).ok();
        if let Some(ratio) = found
            && 100.0 * (ratio - wanted).abs() < NEAR_PERCENT
        {
            explained.found = outcome(scenario, kind, at.exp(), seed).ok();
            break;
        }
        if found.is_none_or(|ratio| ratio > wanted) {
            most = at;
        } else {
            least = at;
        }
        last = found.map(|ratio| (at, excess(ratio)));
    }
    if explained.found.is_none() {
        let stepped = outcome(scenario, kind, least.exp(), seed).ok();
        explained.found = stepped.filter(|found| {
            let ratio = found.errors.ratio();
            ratio.is_ok_and(|ratio| 100.0 * (ratio - wanted).abs() < STEP_PERCENT)
        });
    }
    explained
}

fn outcome(scenario: &Scenario, kind: &Kind, size: f64, seed: u64) -> Result<Found> {
    let errors = errors(scenario, kind, size, seed)?;
    let answer = diagnose(
        &scenario.nominal,
        &errors.recording,
        &haptical_diagnosis::Options::default(),
    )
    .map_err(|error| error.to_string());
    Ok(Found {
        size,
        errors,
        answer,
    })
}
