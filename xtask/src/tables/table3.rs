//! Table 3: the kinematic deviations, assigned, published and ours.

use anyhow::{Context, Result};
use haptical_metrics::{chi_square_p_value, parameter_improvement_percent};
use haptical_model::Device;
use haptical_report::{Cell, Column, Figure, Mark, Series, Table};

use super::monte_carlo::{MonteCarlo, Spread, chi_square};
use super::paper::Paper;
use super::run::Run;
use super::verdict::Verdict;

/// Half of the last printed digit: a thousandth of a millimetre or milliradian.
const HALF_DIGIT: f64 = 5e-7;

/// The table, its picture and its summary.
pub(crate) struct Table3 {
    pub(crate) table: Table,
    pub(crate) figure: Figure,
    pub(crate) possible: usize,
    /// Chi-square of the 28 published errors under our covariance: median and 95 % over designs.
    pub(crate) chi_square: Spread,
    pub(crate) p_value: f64,
    /// Median improvement of each parameter at known joint angles, and after both steps.
    pub(crate) medians: Vec<(String, f64, f64)>,
}

pub(crate) fn table3(
    paper: &Paper,
    nominal: &Device,
    run: &Run,
    runs: &MonteCarlo,
) -> Result<Table3> {
    let mut table = Table::new(
        "Table 3: kinematic parameters",
        [
            ("parameter", ""),
            ("unit", ""),
            ("assigned", ""),
            ("paper", ""),
            ("paper I", "%"),
            ("recomputed", "%"),
            ("ours, one seed", ""),
            ("I", "%"),
            ("two steps: median I", "%"),
            ("95 % of runs", "%"),
            ("angles known: median I", "%"),
            ("95 % of runs", "%"),
            ("Cramer-Rao sd", ""),
            ("paper's z", ""),
            ("possible here?", ""),
        ]
        .map(|(name, unit)| Column::new(name, unit))
        .to_vec(),
    );
    let (mut two_steps, mut known, mut theirs) = (Vec::new(), Vec::new(), Vec::new());
    let mut medians = Vec::new();
    let mut possible = 0;
    for (index, row) in paper.table3.iter().enumerate() {
        let (found, _) = run
            .deviation(nominal, &row.name)
            .with_context(|| format!("{} was not identified", row.name))?;
        let improvements = |errors: &dyn Fn(usize) -> f64| -> Vec<f64> {
            (0..runs.samples.len())
                .map(|sample| 100.0 * (1.0 - (errors(sample) / row.assigned).abs()))
                .collect()
        };
        let ours = Spread::new(&improvements(&|sample| runs.samples[sample].errors[index]))?;
        let exact = Spread::new(&improvements(&|sample| {
            runs.samples[sample].errors_known_angles[index]
        }))?;
        let bound = runs.spread(|sample| sample.bounds[index])?.median;
        let errors: Vec<f64> =
            runs.samples.iter().map(|sample| sample.errors_known_angles[index]).collect();
        let verdict = Verdict::new(row.identified - row.assigned, HALF_DIGIT, &errors)?;
        possible += usize::from(verdict.possible);
        let position = index as f64;
        two_steps.push((position + 0.15, ours.low.max(FLOOR), ours.median.max(FLOOR), ours.high));
        known.push((position - 0.15, exact.low.max(FLOOR), exact.median.max(FLOOR), exact.high));
        theirs.push((position, row.improvement_percent));
        medians.push((row.name.clone(), exact.median, ours.median));
        let length = row.name.starts_with('a') && !row.name.starts_with("alpha")
            || row.name.starts_with('d');
        table.push(vec![
            row.name.clone().into(),
            if length { "mm" } else { "mrad" }.into(),
            Cell::number(row.assigned * 1e3, 3),
            Cell::number(row.identified * 1e3, 3),
            Cell::number(row.improvement_percent, 2),
            Cell::number(parameter_improvement_percent(row.assigned, row.identified, 0.0)?, 2),
            Cell::number(found * 1e3, 3),
            Cell::number(parameter_improvement_percent(row.assigned, found, 0.0)?, 2),
            Cell::number(ours.median, 2),
            Cell::interval(ours.low, ours.high, 1),
            Cell::number(exact.median, 2),
            Cell::interval(exact.low, exact.high, 1),
            Cell::number(bound * 1e3, 4),
            Cell::number(verdict.z, 2),
            verdict.words.into(),
        ])?;
    }
    table.notes.push(
        "z: published error over the standard deviation of our runs at known joint angles; \
         \"recomputed\": eq. (8) from the printed values, which for a0, a3, a5, a7, d1 and d6 differs \
         from the printed percentage."
            .to_owned(),
    );
    let mut figure = Figure::new("Table 3: improvement", "parameter", "improvement I [%]");
    figure.categories = Some(paper.table3.iter().map(|row| row.name.clone()).collect());
    figure.y_range = Some((FLOOR, 102.0));
    figure.series = vec![
        Series::intervals("ours, joint angles known: median, 95 % of runs", 2, &known),
        Series::intervals("ours, two steps: median, 95 % of runs (cut at 40)", 0, &two_steps),
        Series::new("paper", Mark::Points, 1, theirs),
    ];
    let errors: Vec<f64> = paper.table3.iter().map(|row| row.identified - row.assigned).collect();
    let values: Vec<f64> = runs
        .samples
        .iter()
        .map(|sample| chi_square(&sample.information, &errors))
        .collect::<Result<_>>()?;
    let chi_square = Spread::new(&values)?;
    Ok(Table3 {
        table,
        figure,
        possible,
        p_value: chi_square_p_value(chi_square.median, errors.len() as f64)?,
        chi_square,
        medians,
    })
}

/// Foot of the improvement axis.
const FLOOR: f64 = 40.0;
