//! Table 2: the capstans' parameters, assigned, published and ours.

use anyhow::{Context, Result};
use haptical_metrics::parameter_improvement_percent;
use haptical_report::{Cell, Figure, Mark, Series, Table};

use xtask_blind::rows;
use xtask_output::cells;

use super::verdict::Verdict;
use crate::monte_carlo::{MonteCarlo, Spread};
use crate::published::Paper;
use crate::run::{CapstanEstimate, Run};

/// One printed row: which figure, in which printed unit, to which half digit.
struct Row<'p> {
    symbol: &'static str,
    unit: &'static str,
    per_si: f64,
    half_digit: f64,
    published: &'p crate::published::Rows,
}

fn rows(paper: &Paper) -> [Row<'_>; 5] {
    let table = &paper.table2;
    let degrees = 180.0 / std::f64::consts::PI;
    rows! {
        Row {symbol unit per_si half_digit published}
        "R_e", "", 1.0, 5e-7, &table.ratio_deviation;
        "r_o", "mm", 1e3, 5e-7, &table.ro_mm;
        "r_i", "mm", 1e3, 5e-7, &table.ri_mm;
        "beta_o", "deg", degrees, 5e-5, &table.beta_o_deg;
        "beta_i", "deg", degrees, 5e-5, &table.beta_i_deg;
    }
}

/// The table, its picture, and how many of the published figures are possible.
pub(crate) struct Table2 {
    pub(crate) table: Table,
    pub(crate) figure: Figure,
    pub(crate) possible: usize,
    pub(crate) rows: usize,
    /// Chi-square of the five published errors of each capstan.
    pub(crate) chi_squares: Vec<f64>,
}

const HEADS: &str = "parameter | unit | assigned | paper | paper I [%] | recomputed [%] | ours, one seed | I [%] | median \
    I [%] | 95 % of runs [%] | Cramer-Rao sd | paper's z | possible here?";

pub(crate) fn table2(paper: &Paper, run: &Run, runs: &MonteCarlo, title: &str) -> Result<Table2> {
    let mut table = Table::with_heads(title, HEADS);
    let (mut ours, mut theirs, mut categories) = (Vec::new(), Vec::new(), Vec::new());
    let mut possible = 0;
    for (index, row) in rows(paper).iter().enumerate() {
        for joint in 0..3 {
            let assigned = row.published.assigned[joint];
            let published = row.published.identified[joint];
            let one = run
                .capstan(joint)
                .context("the capstan was not fitted in full")?;
            let wrap = |error: f64| match row.unit {
                "deg" => turn(error),
                _ => error,
            };
            let error = |found: &CapstanEstimate| wrap(found.values[index] * row.per_si - assigned);
            let errors = runs.each(|sample| error(&sample.capstans[joint]));
            let improvements = errors
                .iter()
                .map(|error| 100.0 * (1.0 - (error / assigned).abs()));
            let spread = Spread::new(&improvements.collect::<Vec<f64>>())?;
            let found = assigned + error(&one);
            let verdict = Verdict::new(published - assigned, row.half_digit, &errors)?;
            possible += usize::from(verdict.possible);
            let decimals = if row.unit == "deg" { 3 } else { 6 };
            let sd = |found: &CapstanEstimate| found.standard_deviations[index] * row.per_si;
            let sds = runs.each(|sample| sd(&sample.capstans[joint]));
            let name = format!("{} {}", row.symbol, joint + 1);
            let position = categories.len() as f64;
            ours.push((position, spread.low.max(FLOOR), spread.median, spread.high));
            theirs.push((position, row.published.i_percent[joint]));
            categories.push(name.clone());
            table.push(cells! {
                name, row.unit, assigned => decimals, published => decimals,
                row.published.i_percent[joint] => 2,
                parameter_improvement_percent(assigned, published, 0.0)? => 2, found => decimals,
                parameter_improvement_percent(assigned, found, 0.0)? => 2, spread.median => 2,
                [spread.low, spread.high] => 1,
                Cell::scientific(haptical_metrics::median(&sds)?, 2), verdict.z => 2, verdict.words,
            })?;
        }
    }
    let note = "\"possible here?\" judges each published error alone; whether all of them together can be this \
                small is the joint verdict below.";
    let cut = "ours: median and 95 % of runs (cut at the axis)";
    let mut figure = Figure::new(title, "parameter", "improvement I [%]");
    figure.categories = Some(categories);
    figure.y_range = Some((FLOOR, 101.0));
    figure.series = vec![
        Series::intervals(cut, 0, &clipped(&ours)),
        Series::new("paper", Mark::Points, 1, theirs),
    ];
    Ok(Table2 {
        table: table.with_note(note),
        figure,
        possible,
        rows: rows(paper).len() * 3,
        chi_squares: chi_squares(paper, runs)?,
    })
}

/// Foot of the improvement axis: a worse figure is drawn at it.
const FLOOR: f64 = 0.0;

fn clipped(intervals: &[(f64, f64, f64, f64)]) -> Vec<(f64, f64, f64, f64)> {
    intervals
        .iter()
        .map(|&(x, low, mid, high)| (x, low.max(FLOOR), mid.max(FLOOR), high.max(FLOOR)))
        .collect()
}

/// An angle difference in degrees brought to -180..180.
fn turn(degrees: f64) -> f64 {
    (degrees + 180.0).rem_euclid(360.0) - 180.0
}

/// e' C^-1 e of each capstan's five published errors, C the median run's covariance.
fn chi_squares(paper: &Paper, runs: &MonteCarlo) -> Result<Vec<f64>> {
    (0..3)
        .map(|joint| {
            let errors: Vec<f64> = rows(paper)
                .iter()
                .map(|row| {
                    (row.published.identified[joint] - row.published.assigned[joint]) / row.per_si
                })
                .collect();
            let values: Vec<f64> = runs
                .samples
                .iter()
                .filter_map(|sample| {
                    let covariance = sample.capstans[joint].covariance;
                    let matrix = nalgebra::SMatrix::<f64, 5, 5>::from_fn(|i, j| covariance[i][j]);
                    let vector = nalgebra::SVector::<f64, 5>::from_column_slice(&errors);
                    // Scaled to unit diagonal: R_e and r_i differ by six orders of magnitude.
                    let scale =
                        nalgebra::SVector::<f64, 5>::from_fn(|i, _| 1.0 / covariance[i][i].sqrt());
                    let scaled = nalgebra::SMatrix::<f64, 5, 5>::from_fn(|i, j| {
                        matrix[(i, j)] * scale[i] * scale[j]
                    });
                    let whitened = scaled
                        .cholesky()?
                        .l()
                        .solve_lower_triangular(&vector.component_mul(&scale))?;
                    Some(whitened.norm_squared())
                })
                .collect();
            Ok(haptical_metrics::median(&values)?)
        })
        .collect()
}
