//! Calibrations: the two steps of the paper for one device, and all at once from a log of 60 s.

use std::hint::black_box;

use anyhow::{Context, Result};
use haptical_calibration::{Degree, Options, Weighting, fit_device};
use haptical_simulator::{simulate, simulate_transmission};
use xtask_blind::rows;
use xtask_paper::{Paper, Scenario, nominal_device, step_one_on, step_two_on};

use super::recordings::{LOG_ROWS, log};
use super::{Job, Workload};

const SEED: u64 = 1;

pub(crate) const WORKLOADS: [Workload; 2] = rows! {
    Workload {name what unit units is_long prepare}
    "two-step-device", "both steps for one device: 200 samples for each of 4 transmissions, 200 poses, rank and intervals", "device", 1, false, two_steps;
    "joint-fit", "transmissions and links at once from a log of 60 s at 100 Hz, polynomial of degree 10, stated noise", "row", LOG_ROWS as u64, true, joint_fit;
};

fn two_steps() -> Result<Job> {
    let scenario = Scenario::paper(nominal_device(None)?, &Paper::load()?, false)?;
    let (truth, settings) = (&scenario.truth, &scenario.settings);
    let samples = (0..4)
        .map(|joint| simulate_transmission(truth, settings, joint, scenario.samples, SEED))
        .collect::<Result<Vec<_>, _>>()?;
    let poses = simulate(truth, settings, scenario.poses, SEED)?;
    let mut options = scenario.options();
    // as for many devices: nobody reads each one's condition
    options.rules.singular_values = false;
    Ok(Box::new(move || {
        let recorded = |joint: usize| samples.get(joint).cloned().context("no such recording");
        let (device, fits, _) = step_one_on(&scenario.nominal, &options, recorded)?;
        black_box(fits);
        black_box(step_two_on(&device, &poses, &options)?);
        Ok(())
    }))
}

fn joint_fit() -> Result<Job> {
    let (device, recording) = log(LOG_ROWS, &[])?;
    // one fit: the search for a degree, and rounds of weights, would repeat it
    let options = Options {
        degree: Degree::Fixed(10),
        weighting: Weighting::Stated,
        ..Options::default()
    };
    Ok(Box::new(move || {
        black_box(fit_device(&device, &recording, &options)?);
        Ok(())
    }))
}
