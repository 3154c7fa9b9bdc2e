//! Time of a diagnosis: in the batch on one core, and alone on the machine.

use anyhow::{Context, Result};
use xtask_blind::{
    Draw, MotionPlan, NOMINALS, NoisePlan, Random, Scene, Suite, kind, perturbed, torque_scales,
};
use xtask_output::Progress;

use super::batch::Case;
use super::measure::{Bar, Measure, number, quantile};
use super::subject::Given;

/// Rows of the recordings that the bar speaks of.
const ROWS: usize = 6000;
const LONG_ROWS: usize = 100_000;
/// Diagnoses that are timed alone.
const ALONE: u64 = 7;
const GROUP: &str = "time per diagnosis";

/// Times of the batch: recordings of 6000 rows, each diagnosis on one core while others run, with the shrink
/// measured on a second recording of as many rows.
pub(crate) fn in_batch(cases: &[Case]) -> Vec<Measure> {
    let is_validated =
        |case: &Case| Suite::named(case.suite).is_ok_and(|suite| !suite.keeps_second_back());
    let wanted = cases
        .iter()
        .filter(|case| case.rows == ROWS && case.error.is_none() && is_validated(case));
    let times_s: Vec<f64> = wanted.map(|case| case.time_s).collect();
    let at = |what: &str, share: f64| {
        let name = format!("{what}, {ROWS} rows, validated, on one core");
        let value = number(&times_s, 2, "s", |values| quantile(values, share));
        Measure::new(GROUP, name, value, None)
    };
    vec![at("median", 0.5), at("95th percentile", 0.95)]
}

/// Times alone, one diagnosis after the other on all cores: the 7-joint device with 22 columns, 6000 and
/// 100 000 rows, the whole catalogue.
pub(crate) fn alone(seed: u64) -> Result<Vec<Measure>> {
    let progress = Progress::new("timing", ALONE as usize + 1);
    let mut times_s = Vec::new();
    for index in 0..ALONE {
        times_s.push(time_s(ROWS, seed, index)?);
        progress.step();
    }
    let long_s = time_s(LONG_ROWS, seed, ALONE)?;
    progress.step();
    let cores = rayon::current_num_threads();
    let measure = |name: String, times_s: &[f64], limit_s: f64| {
        let value = number(times_s, 2, "s", |values| quantile(values, 0.5));
        Measure::new(GROUP, name, value, Some(Bar::AtMost(limit_s)))
    };
    let usual = format!("median, {ROWS} rows, on {cores} cores");
    let long = format!("{LONG_ROWS} rows, on {cores} cores");
    Ok(vec![
        measure(usual, &times_s, 1.0),
        measure(long, &[long_s], 15.0),
    ])
}

/// Time to diagnose a recording with a soft cable \[s\].
fn time_s(rows: usize, seed: u64, index: u64) -> Result<f64> {
    let mut random = Random::new(seed, (1 << 61) + index);
    let nominal = NOMINALS[0].device()?;
    let device = perturbed(&nominal, &mut random);
    let scales = torque_scales(&nominal, &mut random);
    let soft = kind("capstan-compliance").context("no kind capstan-compliance")?;
    let effect = soft.draw(&mut Draw {
        device: &nominal,
        joint: 1,
        size: 1.0,
        tag: 0,
        random: &mut random,
    });
    let plan = MotionPlan {
        rows,
        ..MotionPlan::default()
    };
    let scene = Scene::draw(&device, &plan, random.seed())?;
    let noise = NoisePlan::white(device.joints.len());
    let recorded = scene.record(&[effect], &noise, &scales)?;
    let answered = Given::alone(nominal, recorded.log).answer();
    let answered = answered.with_context(|| format!("a recording of {rows} rows"))?;
    Ok(answered.time_s)
}
