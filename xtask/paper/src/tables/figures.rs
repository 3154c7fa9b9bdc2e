//! Figures 7 and 8 of the paper, and the tables behind Figure 8.

use anyhow::{Context, Result};
use haptical_metrics::rms;
use haptical_report::{Figure, FigureGrid, Mark, Series, Table, histogram};
use xtask_output::cells;

use crate::experiment::power_series;
use crate::monte_carlo::{
    AFTER, FarFromHome, MonteCarlo, OBSERVABLE, PoseSummary, gain, largest_size,
};
use crate::published::Paper;
use crate::run::Run;
use crate::scenario::Scenario;

/// Figure 7: the parallelogram's error, measured, identified and printed.
pub(crate) fn figure7(scenario: &Scenario, paper: &Paper, run: &Run) -> Result<(Figure, Table)> {
    let joint = 3;
    let data = &run.transmission_data[joint];
    let output = data.output[joint]
        .as_ref()
        .context("joint 4 has no output")?;
    let point = |(reading, out): (&f64, &f64)| (reading.to_degrees(), (out - reading) * 1e3);
    let measured = data.joint[joint].iter().zip(output).map(point).collect();
    let fourth = &run.transmissions[joint];
    let fit = fourth.fit.as_ref().context("joint 4 was not fitted")?;
    let [low, high] = fourth.range_rad;
    let grid: Vec<f64> = (0..=180)
        .map(|step| low + (high - low) * f64::from(step) / 180.0)
        .collect();
    let curve = |error: &dyn Fn(f64) -> Result<f64>| -> Result<Vec<(f64, f64)>> {
        grid.iter()
            .map(|&theta| Ok((theta.to_degrees(), error(theta)? * 1e3)))
            .collect()
    };
    let identified = curve(&|theta| Ok(fit.device.joints[joint].error_rad(theta)?))?;
    let truth = curve(&|theta| Ok(scenario.truth.joints[joint].error_rad(theta)?))?;
    let published = curve(&|theta| Ok(power_series(&paper.table2.k0_to_k10, theta)))?;
    let inner = |points: &[(f64, f64)], others: &[(f64, f64)]| -> Result<(f64, f64)> {
        let pairs = points.iter().zip(others);
        let inner = pairs.filter(|(point, _)| point.0.abs() <= 40.0);
        let errors: Vec<f64> = inner.map(|(point, other)| point.1 - other.1).collect();
        Ok((rms(&errors)?, largest_size(&errors)))
    };
    let mut table = Table::with_heads(
        "Figure 7: curves of the parallelogram's error within +-40 deg",
        "curves | rms difference [mrad] | largest [mrad]",
    );
    let (found, paper) = ("ours identified, against", "paper's printed polynomial");
    for (name, points, others) in [
        (format!("{found} the assigned truth"), &identified, &truth),
        (
            format!("{paper}, against the assigned truth"),
            &published,
            &truth,
        ),
        (format!("{found} the {paper}"), &identified, &published),
    ] {
        let (mean, most) = inner(points, others)?;
        table.push(cells! { name, mean => 4, most => 4 })?;
    }
    let mut figure = Figure::new(
        "Figure 7: parallelogram transmission error",
        "joint 4 reading from home [deg]",
        "transmission error [mrad]",
    );
    figure.series = vec![
        Series::new("simulated measurements", Mark::Points, 5, measured),
        Series::new("identified, degree 10", Mark::Line, 1, identified),
        Series::new("assigned truth", Mark::DashedLine, 6, truth),
        Series::new("paper's printed polynomial", Mark::Line, 2, published),
    ];
    Ok((figure, table))
}

/// Figure 8: position and orientation errors at 200 other poses, before and after.
pub(crate) fn figure8(run: &Run) -> FigureGrid {
    let panel = |title: &str, unit: &str, [before, after, rest]: [&[f64]; 3]| {
        let point = |(index, value): (usize, &f64)| (index as f64 + 1.0, (value * 1e3).max(1e-6));
        let points = |values: &[f64]| values.iter().enumerate().map(point).collect();
        let mut figure = Figure::new(title, "pose [-]", format!("error [{unit}]"));
        figure.y_log = true;
        figure.points("before", 1, points(before));
        figure.points("after", 0, points(after));
        figure.points("after, unobservable part off", 2, points(rest));
        figure
    };
    let pose = &run.pose;
    let position = [
        &pose.position_before_m[..],
        &pose.position_after_m,
        &pose.position_observable_m,
    ];
    let orientation = [
        &pose.orientation_before_rad[..],
        &pose.orientation_after_rad,
        &pose.orientation_observable_rad,
    ];
    let panels = vec![
        panel("Position", "mm", position),
        panel("Orientation", "mrad", orientation),
    ];
    FigureGrid::new("Figure 8: pose errors before and after", 1, panels)
}

/// Error before calibration against the distance from home.
pub(crate) fn far_from_home(run: &Run) -> Figure {
    let pose = &run.pose;
    let points = |values: &[f64]| {
        let pairs = pose.from_home_rad.iter().zip(values);
        pairs.map(|(from, error)| (*from, error * 1e3)).collect()
    };
    let mut figure = Figure::new(
        "Position error against the distance from home",
        "norm of the joint readings [rad]",
        "position error [mm]",
    );
    figure.series = vec![
        Series::new("before", Mark::Points, 1, points(&pose.position_before_m)),
        Series::new("after", Mark::Points, 0, points(&pose.position_after_m)),
        Series::reference("8 mm", 6, 8.0),
    ];
    figure
}

/// Root mean squares of Figure 8 for one seed and over all runs.
pub(crate) fn pose_table(run: &Run, runs: &MonteCarlo) -> Result<Table> {
    let one = PoseSummary::new(&run.pose)?;
    let mut table = Table::with_heads(
        "Figure 8 in figures: RMS at 200 other poses",
        "error | unit | before | after | improvement [%] | runs: before | runs: after | runs: \
                  improvement [%] | 95 % of runs [%]",
    );
    type Pick = fn(&PoseSummary) -> &[f64];
    let (apart, turned_apart) = (
        "position, unobservable rotation taken off",
        "orientation, unobservable rotation and alpha7 taken off",
    );
    let rows: [(&str, &str, Pick, usize); 5] = [
        ("distance", "mm", |p| &p.distance_m, AFTER),
        ("position", "mm", |p| &p.position_m, AFTER),
        (apart, "mm", |p| &p.position_m, OBSERVABLE),
        ("orientation", "mrad", |p| &p.orientation_rad, AFTER),
        (turned_apart, "mrad", |p| &p.orientation_rad, OBSERVABLE),
    ];
    for (name, unit, of, after) in rows {
        let spread = runs.spread(|sample| gain(of(&sample.pose), after))?;
        let middle = |at: usize| runs.spread(|sample| of(&sample.pose)[at]);
        table.push(cells! {
            name, unit, of(&one)[0] * 1e3 => 4, of(&one)[after] * 1e3 => 4,
            gain(of(&one), after) => 2, middle(0)?.median * 1e3 => 4,
            middle(after)?.median * 1e3 => 4, spread.median => 2, [spread.low, spread.high] => 2,
        })?;
    }
    Ok(table.with_note(
        "No distance shows alpha0, alpha7 or theta0: the part of the pose error that a rotation about \
         frame (-1)'s origin and a constant alpha7 explain stays, whatever the calibration; the \
         paper's Figure 8 includes it.",
    ))
}

/// Whether errors before calibration grow with the distance from home: rank correlations over the
/// runs, whether both intervals are above zero, the share of poses beyond 8 mm in percent, and how
/// far out those are (percent of poses that are nearer to home).
pub(crate) fn far_from_home_table(runs: &MonteCarlo) -> Result<(Table, bool, f64, f64)> {
    let mut table = Table::with_heads(
        "Errors before calibration grow with the distance from home",
        "error | distance from home | rank correlation | 95 % of runs | paper's limit | poses beyond it \
                  [%]",
    );
    type Of<T> = fn(&FarFromHome) -> T;
    type Row = (&'static str, Of<[f64; 2]>, &'static str, Of<f64>);
    let rows: [Row; 2] = [
        ("position", |f| f.position, "8 mm", |f| f.beyond_8_mm),
        (
            "orientation",
            |f| f.orientation,
            "30 mrad",
            |f| f.beyond_30_mrad,
        ),
    ];
    let mut positive = true;
    for (error, correlations, limit, beyond) in rows {
        for (of, joints) in ["all joints", "joints 1 to 4"].into_iter().enumerate() {
            let spread = runs.spread(|sample| correlations(&sample.from_home)[of])?;
            positive &= spread.low > 0.0;
            let beyond = runs.spread(|sample| beyond(&sample.from_home))?;
            table.push(cells! {
                error, joints, spread.median => 2, [spread.low, spread.high] => 2, limit,
                100.0 * beyond.median => 1,
            })?;
        }
    }
    let table = table.with_note(
        "Distance from home: norm of the joint readings. The paper's text speaks of errors over 8 mm \
         and 0.03 rad at the farthest poses; no pose of ours reaches 0.03 rad with these lengths.",
    );
    let ranks = runs.samples.iter();
    let ranks = ranks.filter_map(|sample| sample.from_home.rank_beyond_8_mm);
    let rank = haptical_metrics::median(&ranks.collect::<Vec<f64>>()).unwrap_or(0.5);
    let share = runs.spread(|sample| sample.from_home.beyond_8_mm)?.median;
    Ok((table, positive, 100.0 * share, 100.0 * rank))
}

/// Distribution of the RMS improvement of distances over the runs.
pub(crate) fn improvement_histogram(runs: &MonteCarlo) -> Figure {
    let values = runs.each(|sample| gain(&sample.pose.distance_m, AFTER));
    let mut figure = Figure::new(
        "Improvement of the distance over all runs",
        "improvement of the RMS [%]",
        "runs [-]",
    );
    figure.legend = false;
    figure.series = vec![Series::new("runs", Mark::Bars, 0, histogram(&values, 24))];
    figure
}
