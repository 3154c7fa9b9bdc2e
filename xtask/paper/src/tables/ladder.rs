//! Calibrations of less: offsets alone, one step alone, both, and the joint fit.

use anyhow::Result;
use haptical_calibration::{
    CalibrationMethod, Channel, FitRequest, Options, Weights, channels, fit_device, fit_parameters,
};
use haptical_model::{Device, Parameter, ParameterId};
use haptical_report::{Figure, Mark, Series, Table};
use xtask_output::{Progress, cells};

use super::sweeps::Seeds;
use crate::monte_carlo::{AFTER, PoseSummary, Spread, gain};
use crate::run::{evaluation_readings, step_one, step_two};
use crate::scenario::Scenario;

/// What each kind of calibration buys, offsets alone (the vendors' way) included.
pub(crate) fn ladder(scenario: &Scenario, seeds: Seeds) -> Result<(Table, Figure)> {
    let progress = Progress::new("what each correction buys", KINDS.len());
    let mut table = Table::with_heads(
        "What each correction buys, on 200 other poses",
        "calibration | distance [mm rms] | improvement [%] | 95 % of runs [%] | position [mm rms] | \
                  improvement [%] | orientation [mrad rms] | improvement [%]",
    );
    let mut bars = Vec::new();
    let mut categories = Vec::new();
    for (words, calibrate) in KINDS {
        let runs = seeds.map(|seed| {
            let device = calibrate(scenario, seed)?;
            let readings = evaluation_readings(scenario, seed)?;
            PoseSummary::new(&scenario.pose_errors(&device, &readings)?)
        })?;
        progress.step();
        let spread = |pick: &dyn Fn(&PoseSummary) -> f64| {
            Spread::new(&runs.iter().map(pick).collect::<Vec<f64>>())
        };
        let distance = spread(&|run| gain(&run.distance_m, AFTER))?;
        let position = spread(&|run| gain(&run.position_m, AFTER))?;
        let turn = spread(&|run| gain(&run.orientation_rad, AFTER))?;
        bars.push((categories.len() as f64, distance.median));
        categories.push(words.to_owned());
        table.push(cells! {
            words, spread(&|run| run.distance_m[AFTER])?.median * 1e3 => 4, distance.median => 2,
            [distance.low, distance.high] => 2,
            spread(&|run| run.position_m[AFTER])?.median * 1e3 => 3, position.median => 1,
            spread(&|run| run.orientation_rad[AFTER])?.median * 1e3 => 3, turn.median => 1,
        })?;
    }
    let mut figure = Figure::new(
        "Improvement of the distance",
        "calibration",
        "improvement of the RMS [%]",
    );
    figure.categories = Some(categories);
    figure.legend = false;
    figure.series = vec![Series::new("distance", Mark::Bars, 0, bars)];
    Ok((table, figure))
}

/// Makes a device from what a seed records.
type Calibrate = fn(&Scenario, u64) -> Result<Device>;

/// Kinds of calibration, by what they correct.
const KINDS: [(&str, Calibrate); 6] = [
    ("none", |scenario, _| Ok(scenario.nominal.clone())),
    ("joint offsets alone", offsets),
    ("step 1 alone", |scenario, seed| {
        Ok(step_one(scenario, seed)?.0)
    }),
    ("step 2 alone", |scenario, seed| {
        Ok(step_two(scenario, &scenario.nominal, seed)?.device)
    }),
    ("both steps (the paper)", |scenario, seed| {
        let (compensated, ..) = step_one(scenario, seed)?;
        Ok(step_two(scenario, &compensated, seed)?.device)
    }),
    ("joint fit of both", joint_fit),
];

/// Joint offsets alone, as vendors' software calibrates them.
fn offsets(scenario: &Scenario, seed: u64) -> Result<Device> {
    let channel = [Channel::Cable { index: 0 }];
    let theta = |row| ParameterId::Link {
        row,
        parameter: Parameter::Theta,
    };
    let fit = fit_parameters(&FitRequest {
        what: "joint offsets",
        device: &scenario.nominal,
        recording: &scenario.simulate(scenario.poses, seed)?,
        channels: &channel,
        parameters: &(1..=7).map(theta).collect::<Vec<_>>(),
        unsupported: &[],
        weights: &Weights::stated(&scenario.nominal, &channel),
        options: &scenario.options(),
        start: None,
        yielded: None,
    })?;
    Ok(fit.device)
}

/// The joint fit on the same number of readings: 200 rows with all channels at once.
fn joint_fit(scenario: &Scenario, seed: u64) -> Result<Device> {
    let recording = scenario.simulate(scenario.poses, seed)?;
    channels(&scenario.nominal, &recording)?;
    let options = Options {
        method: CalibrationMethod::Joint,
        ..scenario.options()
    };
    Ok(fit_device(&scenario.nominal, &recording, &options)?.device)
}
