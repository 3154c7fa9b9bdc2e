//! Figures 9 and 10 and Tables 4 and 5 of one recorded motion.

use anyhow::{Context, Result};
use haptical_report::{Cell, Figure, FigureGrid, Table};
use xtask_output::cells;

use super::recorded::{Instant, Recorded};
use super::truth::power_series;
use crate::published::Paper;
use crate::scenario::Scenario;

/// Every k-th millisecond is drawn.
const DRAWN: usize = 100;

/// Figure 9: the four transmissions, identified model over measurement.
pub(crate) fn figure9(recorded: &Recorded) -> Result<FigureGrid> {
    let mut panels = Vec::new();
    for (joint, name) in ["capstan 1", "capstan 2", "capstan 3", "parallelogram"]
        .iter()
        .enumerate()
    {
        let data = &recorded.recording;
        let output = data.output[joint].as_ref().context("no external encoder")?;
        let measured: Vec<(f64, f64)> = (0..data.len())
            .step_by(DRAWN)
            .map(|row| {
                let reading = data.joint[joint][row];
                (reading.to_degrees(), 1e3 * (output[row] - reading))
            })
            .collect();
        let [low, high] = recorded.run.transmissions[joint].range_rad;
        let fitted = &recorded.compensated.joints[joint];
        let model = (0..=120)
            .map(|step| {
                let angle = low + (high - low) * f64::from(step) / 120.0;
                Ok((angle.to_degrees(), 1e3 * fitted.error_rad(angle)?))
            })
            .collect::<Result<Vec<_>>>()?;
        let mut figure = Figure::new(*name, "joint angle [deg]", "error [mrad]");
        figure.points("measured", 1, measured);
        figure.line("identified", 0, model);
        panels.push(figure);
    }
    let title = "Transmission errors, 100 s of motion";
    Ok(FigureGrid::new(title, 2, panels))
}

/// Figure 10: distance over time, and its errors before and after.
pub(crate) fn figure10(recorded: &Recorded, scenario: &Scenario) -> Result<FigureGrid> {
    let rows = recorded.distances(&scenario.nominal, DRAWN)?;
    let series = |pick: &dyn Fn(&Instant) -> f64| -> Vec<(f64, f64)> {
        rows.iter()
            .map(|row| (row.time_s, 1e3 * pick(row)))
            .collect()
    };
    let mut distance = Figure::new("(a) distance", "time [s]", "distance [mm]");
    distance.line("nominal", 1, series(&|row| row.measured_m + row.before_m));
    distance.line("corrected", 0, series(&|row| row.measured_m + row.after_m));
    distance.line("measured", 2, series(&|row| row.measured_m));
    let mut error = Figure::new("(b) error of the distance", "time [s]", "error [mm]");
    error.line("before calibration", 1, series(&|row| row.before_m));
    error.line("after full calibration", 0, series(&|row| row.after_m));
    let panels = vec![distance, error];
    Ok(FigureGrid::new("Distance over 100 s", 1, panels))
}

/// Table 4: the capstans, identified again, with intervals.
pub(crate) fn table4(recorded: &Recorded, paper: &Paper) -> Result<Table> {
    let mut table = Table::with_heads(
        "Table 4: capstans, identified from the motion of the device that the authors identified",
        "capstan | R_e | 95 % | paper | r_o [mm] | 95 % [mm] | paper [mm] | r_i [mm] | paper [mm] | \
                  correlation of R_e and r_o",
    );
    for joint in 0..3 {
        let Some(found) = recorded.run.capstan(joint) else {
            continue;
        };
        let [sd_ratio, sd_radius, ..] = found.standard_deviations;
        let correlation = found.covariance[0][1] / (sd_ratio * sd_radius);
        let range = |value: f64, sd: f64, digits: usize| -> Cell {
            let (low, high) = (value - 1.96 * sd, value + 1.96 * sd);
            format!("{low:.digits$} to {high:.digits$}").into()
        };
        table.push(cells! {
            format!("{}", joint + 1), found.values[0] => 5, range(found.values[0], sd_ratio, 5),
            paper.table4.ratio_deviation[joint] => 5, 1e3 * found.values[1] => 4,
            range(1e3 * found.values[1], 1e3 * sd_radius, 4), paper.table4.ro_mm[joint] => 4,
            1e3 * found.values[2] => 4, paper.table4.ri_mm[joint] => 4, correlation => 4,
        })?;
    }
    Ok(table)
}

/// Largest difference of the identified fourth transmission from the mended polynomial within the fitted
/// range \[rad\].
pub(crate) fn polynomial_difference_rad(recorded: &Recorded, paper: &Paper) -> Result<f64> {
    let [low, high] = recorded.run.transmissions[3].range_rad;
    let mut most: f64 = 0.0;
    for step in 0..=80 {
        let angle = low + (high - low) * f64::from(step) / 80.0;
        let found = recorded.compensated.joints[3].error_rad(angle)?;
        most = most.max((found - power_series(&paper.table4.k0_to_k10, angle)).abs());
    }
    Ok(most)
}

/// Table 5: the kinematic deviations with intervals, next to those of the truth.
pub(crate) fn table5(recorded: &Recorded, scenario: &Scenario, paper: &Paper) -> Result<Table> {
    let mut table = Table::with_heads(
        "Table 5: kinematic deviations, identified from the motion",
        "parameter | unit | paper (the truth here) | identified | 95 % interval | holds the truth",
    );
    for (name, truth) in &paper.table5 {
        let angle = name.starts_with("alpha") || name.starts_with("theta");
        let mut row: Vec<Cell> = cells! {
            name.as_str(), if angle { "mrad" } else { "mm" }, 1e3 * truth => 3,
        };
        match recorded.run.deviation(&scenario.nominal, name) {
            Some((value, sd)) => {
                let (low, high) = (1e3 * (value - 1.96 * sd), 1e3 * (value + 1.96 * sd));
                row.push(Cell::number(1e3 * value, 3));
                row.push(format!("{low:.3} to {high:.3}").into());
                let holds = (low..=high).contains(&(1e3 * truth));
                row.push(if holds { "yes" } else { "no" }.into());
            }
            None => row.extend(["not identified", "", ""].map(Cell::from)),
        }
        table.push(row)?;
    }
    Ok(table)
}
