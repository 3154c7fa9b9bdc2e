//! Calibrations of less: offsets alone, one step alone, both, and the joint fit.

use anyhow::Result;
use haptical_calibration::{
    CalibrationMethod, Channel, FitRequest, Options, Weights, channels, fit_device, fit_parameters,
};
use haptical_model::{Device, Parameter, ParameterId};
use haptical_report::{Cell, Figure, Mark, Series, Table};
use haptical_simulator::simulate;
use xtask_output::Progress;

use super::sweeps::Seeds;
use crate::monte_carlo::{PoseSummary, Spread};
use crate::pose_error::PoseErrors;
use crate::run::{evaluation_readings, step_one, step_two};
use crate::scenario::Scenario;

/// What each kind of calibration buys, offsets alone (the vendors' way) included.
pub(crate) fn ladder(
    scenario: &Scenario,
    seeds: Seeds,
    progress: &Progress,
) -> Result<(Table, Figure)> {
    let mut table = Table::with_heads(
        "What each correction buys, on 200 other poses",
        "calibration | distance [mm rms] | improvement [%] | 95 % of runs [%] | position [mm rms] | \
                  improvement [%] | orientation [mrad rms] | improvement [%]",
    );
    let mut bars = Vec::new();
    let mut categories = Vec::new();
    for kind in Kind::ALL {
        let runs = seeds.map(|seed| {
            let device = kind.calibrate(scenario, seed)?;
            let readings = evaluation_readings(scenario, seed)?;
            let errors = PoseErrors::new(&scenario.truth, &scenario.nominal, &device, &readings)?;
            PoseSummary::new(&errors)
        })?;
        progress.step();
        let spread = |pick: &dyn Fn(&PoseSummary) -> f64| {
            Spread::new(&runs.iter().map(pick).collect::<Vec<f64>>())
        };
        let gain = |before: f64, after: f64| 100.0 * (1.0 - after / before);
        let distance = spread(&|run| gain(run.distance_before_m, run.distance_after_m))?;
        let position = spread(&|run| gain(run.position_before_m, run.position_after_m))?;
        let turn = spread(&|run| gain(run.orientation_before_rad, run.orientation_after_rad))?;
        bars.push((categories.len() as f64, distance.median));
        categories.push(kind.words().to_owned());
        table.push(vec![
            kind.words().into(),
            Cell::number(spread(&|run| run.distance_after_m)?.median * 1e3, 4),
            Cell::number(distance.median, 2),
            Cell::interval(distance.low, distance.high, 2),
            Cell::number(spread(&|run| run.position_after_m)?.median * 1e3, 3),
            Cell::number(position.median, 1),
            Cell::number(spread(&|run| run.orientation_after_rad)?.median * 1e3, 3),
            Cell::number(turn.median, 1),
        ])?;
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

#[derive(Debug, Clone, Copy)]
enum Kind {
    None,
    Offsets,
    Transmissions,
    Kinematics,
    TwoSteps,
    Joint,
}

impl Kind {
    const ALL: [Self; 6] = [
        Self::None,
        Self::Offsets,
        Self::Transmissions,
        Self::Kinematics,
        Self::TwoSteps,
        Self::Joint,
    ];

    fn words(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Offsets => "joint offsets alone",
            Self::Transmissions => "step 1 alone",
            Self::Kinematics => "step 2 alone",
            Self::TwoSteps => "both steps (the paper)",
            Self::Joint => "joint fit of both",
        }
    }

    fn calibrate(self, scenario: &Scenario, seed: u64) -> Result<Device> {
        Ok(match self {
            Self::None => scenario.nominal.clone(),
            Self::Offsets => {
                let recording =
                    simulate(&scenario.truth, &scenario.settings, scenario.poses, seed)?;
                let channel = [Channel::Cable { index: 0 }];
                let weights = Weights::stated(&scenario.nominal, &channel);
                let offsets: Vec<ParameterId> = (1..=7)
                    .map(|row| ParameterId::Link {
                        row,
                        parameter: Parameter::Theta,
                    })
                    .collect();
                fit_parameters(&FitRequest {
                    what: "joint offsets",
                    device: &scenario.nominal,
                    recording: &recording,
                    channels: &channel,
                    parameters: &offsets,
                    unsupported: &[],
                    weights: &weights,
                    options: &scenario.options(),
                    start: None,
                    yielded: None,
                })?
                .device
            }
            Self::Transmissions => step_one(scenario, seed)?.0,
            Self::Kinematics => step_two(scenario, &scenario.nominal, seed)?.device,
            Self::TwoSteps => {
                let (compensated, ..) = step_one(scenario, seed)?;
                step_two(scenario, &compensated, seed)?.device
            }
            Self::Joint => joint_fit(scenario, seed)?,
        })
    }
}

/// The joint fit on the same number of readings: 200 rows with all channels at once.
fn joint_fit(scenario: &Scenario, seed: u64) -> Result<Device> {
    let recording = simulate(&scenario.truth, &scenario.settings, scenario.poses, seed)?;
    channels(&scenario.nominal, &recording)?;
    let options = Options {
        method: CalibrationMethod::Joint,
        ..scenario.options()
    };
    Ok(fit_device(&scenario.nominal, &recording, &options)?.device)
}
