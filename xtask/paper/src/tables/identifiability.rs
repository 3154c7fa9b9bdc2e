//! Parameters that distances can show: the paper's list, found from all 32, and special cases.

use anyhow::Result;
use haptical_calibration::{Channel, Weights, candidate_parameters, identifiability_at};
use haptical_identification::{Identifiability, IdentifiabilityRules, Status};
use haptical_model::{Device, Parameter, ParameterId, Recording, TransmissionError};
use haptical_report::{Cell, Figure, Mark, Series, Table};
use haptical_simulator::simulate;
use xtask_output::cells;

use crate::scenario::Scenario;

/// The judgements that the report shows.
pub(crate) struct Judgements {
    pub(crate) nominal: Identifiability,
    pub(crate) cases: Table,
    pub(crate) list: Table,
    pub(crate) schroer: Table,
    pub(crate) figure: Figure,
}

pub(crate) fn judge(scenario: &Scenario, solution: &Device, seed: u64) -> Result<Judgements> {
    let recording = simulate(&scenario.truth, &scenario.settings, scenario.poses, seed)?;
    let nominal = identifiability_on(&scenario.nominal, &recording)?;
    let at_solution = identifiability_on(solution, &recording)?;
    let mut hooked_on_axis = scenario.nominal.clone();
    hooked_on_axis.links[7].a_m = 0.0;
    let without_offset = identifiability_on(&hooked_on_axis, &recording)?;
    let mut locked = recording.clone();
    locked.joint[2].fill(0.0);
    let six_joints = identifiability_on(&scenario.nominal, &locked)?;
    let mut cases = Table::with_heads(
        "What distances can show",
        "case | rank | of | not identifiable, with the reason",
    );
    for (name, judged) in [
        ("nominal device", &nominal),
        ("at the solution", &at_solution),
        ("cable hooked on the last axis (a7 = 0)", &without_offset),
        ("joint 3 locked at home (6-DOF mode)", &six_joints),
    ] {
        cases.push(cells! {
            name, judged.rank => 0, judged.names.len() => 0, reasons(judged).join("; "),
        })?;
    }
    Ok(Judgements {
        list: list(&nominal)?,
        schroer: schroer(scenario)?,
        figure: singular_values(&nominal, &six_joints),
        cases,
        nominal,
    })
}

fn identifiability_on(device: &Device, recording: &Recording) -> Result<Identifiability> {
    let channels = [Channel::Cable { index: 0 }];
    let weights = Weights::stated(device, &channels);
    let beta = Parameter::Beta;
    let is_beta =
        |id: &ParameterId| matches!(id, ParameterId::Link { parameter, .. } if *parameter == beta);
    let mut free = candidate_parameters(device);
    free.retain(|id| !is_beta(id));
    let rules = IdentifiabilityRules::default();
    let judged = identifiability_at(device, recording, &channels, &free, &weights, &rules);
    Ok(judged?)
}

pub(crate) fn reasons(judged: &Identifiability) -> Vec<String> {
    (0..judged.names.len())
        .filter_map(|index| judged.reason(index))
        .collect()
}

/// All 32 parameters with status and standard deviation.
fn list(judged: &Identifiability) -> Result<Table> {
    let mut table = Table::with_heads(
        "All 32 Denavit-Hartenberg parameters at the nominal device",
        "parameter | status | sd of 200 poses [mm or mrad] | reason",
    );
    for (index, name) in judged.names.iter().enumerate() {
        let status = &judged.statuses[index];
        table.push(cells! {
            name.clone(), status.name(), status.standard_deviation().map(|sd| sd * 1e3) => 4,
            judged.reason(index).unwrap_or_default(),
        })?;
    }
    Ok(table)
}

fn singular_values(nominal: &Identifiability, six_joints: &Identifiability) -> Figure {
    let points = |judged: &Identifiability| {
        let values = judged.singular_values.iter().enumerate();
        // below rounding there is nothing to see, and zero has no logarithm
        let point = |(index, value): (usize, &f64)| (index as f64 + 1.0, value.max(1e-17));
        values.map(point).collect()
    };
    let mut figure = Figure::new(
        "Singular values of the visible columns, scaled to unit norm",
        "index [-]",
        "singular value [-]",
    );
    figure.y_log = true;
    figure.series = vec![
        Series::new("nominal device", Mark::Points, 0, points(nominal)),
        Series::new("joint 3 locked", Mark::Points, 1, points(six_joints)),
        Series::reference("tolerance", 6, haptical_linalg::RANK_TOLERANCE),
    ];
    figure
}

/// Schroer's claim: of a planar parallelogram's five parameters (four lengths and an angle) only one
/// length is identifiable.
fn schroer(scenario: &Scenario) -> Result<Table> {
    let mut table = Table::with_heads(
        "The parallelogram's parameters, seen by an external encoder",
        "free parameters | readings within [deg] | rank | of | condition number | weak (sd above half of \
                  a plausible size) | dependent",
    );
    let mut device = scenario.nominal.clone();
    device.joints[3].transmission_error = TransmissionError::Parallelogram {
        capstan: haptical_model::transmission::CapstanError::default(),
        length_deviations_m: [0.0; 4],
    };
    let rules = IdentifiabilityRules::default();
    for (name, indices) in [
        ("four lengths and the angle", vec![0, 6, 7, 8, 9]),
        ("those and the capstan's ratio", vec![0, 1, 6, 7, 8, 9]),
        ("all ten (with both drums)", (0..10).collect()),
    ] {
        for half_range_deg in [15.0_f64, 30.0, 45.0] {
            let recording = sweep(&device, half_range_deg.to_radians(), scenario.samples);
            let channels = [Channel::Output { joint: 3 }];
            let weights = Weights::stated(&device, &channels);
            let free = indices.iter();
            let free = free.map(|&index| ParameterId::Transmission { joint: 3, index });
            let free: Vec<ParameterId> = free.collect();
            let judged =
                identifiability_at(&device, &recording, &channels, &free, &weights, &rules)?;
            let named = |wanted: fn(&Status) -> bool| -> String {
                let all = judged.statuses.iter().zip(&judged.names);
                let names = all.filter(|(status, _)| wanted(status));
                let names: Vec<&str> = names.map(|(_, name)| name.as_str()).collect();
                names.join(", ")
            };
            table.push(cells! {
                name, half_range_deg => 0, judged.rank => 0, judged.names.len() => 0,
                Cell::scientific(judged.condition_unit_norm, 2),
                named(|status| matches!(status, Status::Weak { .. })),
                named(|status| matches!(status, Status::Dependent { .. } | Status::Invisible)),
            })?;
        }
    }
    Ok(table)
}

/// Readings of joint 4 spread evenly over a range; the output column only marks that it is read.
fn sweep(device: &Device, half_range_rad: f64, rows: usize) -> Recording {
    let mut joint = vec![vec![0.0; rows]; device.joints.len()];
    joint[3] = (0..rows)
        .map(|row| half_range_rad * (2.0 * row as f64 / (rows as f64 - 1.0) - 1.0))
        .collect();
    let mut output = vec![None; device.joints.len()];
    output[3] = Some(joint[3].clone());
    Recording {
        line: (0..rows as u64).collect(),
        joint,
        output,
        ..Recording::default()
    }
}
