//! Table 3: the kinematic deviations, assigned, published and ours.

use anyhow::{Context, Result};
use haptical_metrics::{chi_square_p_value, parameter_improvement_percent};
use haptical_model::Device;
use haptical_report::{Cell, Figure, Mark, Series, Table};
use xtask_output::cells;

use super::verdict::Verdict;
use crate::monte_carlo::{MonteCarlo, Spread, chi_square};
use crate::published::{Paper, Published};
use crate::run::Run;

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

/// Our figures for one published row.
struct Ours {
    /// Fitted deviation of one seed.
    found: f64,
    /// Improvement after both steps.
    two_steps: Spread,
    /// Improvement with the joint angles known exactly.
    known: Spread,
    /// Cramér-Rao standard deviation.
    bound: f64,
    verdict: Verdict,
}

impl Ours {
    fn new(
        row: &Published,
        index: usize,
        nominal: &Device,
        run: &Run,
        runs: &MonteCarlo,
    ) -> Result<Self> {
        let (found, _) = run
            .deviation(nominal, &row.name)
            .with_context(|| format!("{} was not identified", row.name))?;
        let gain = |error: f64| 100.0 * (1.0 - (error / row.assigned).abs());
        let errors = runs.each(|sample| sample.errors_known_angles[index]);
        Ok(Self {
            found,
            two_steps: runs.spread(|sample| gain(sample.errors[index]))?,
            known: runs.spread(|sample| gain(sample.errors_known_angles[index]))?,
            bound: runs.spread(|sample| sample.bounds[index])?.median,
            verdict: Verdict::new(row.identified - row.assigned, HALF_DIGIT, &errors)?,
        })
    }

    fn cells(&self, row: &Published) -> Result<Vec<Cell>> {
        let length = matches!(row.name.as_bytes(), [b'a' | b'd', b'0'..=b'9', ..]);
        let recomputed = |value: f64| -> Result<Cell> {
            let percent = parameter_improvement_percent(row.assigned, value, 0.0)?;
            Ok(Cell::number(percent, 2))
        };
        Ok(cells! {
            row.name.clone(), if length { "mm" } else { "mrad" }, row.assigned * 1e3 => 3,
            row.identified * 1e3 => 3, row.improvement_percent => 2, recomputed(row.identified)?,
            self.found * 1e3 => 3, recomputed(self.found)?, self.two_steps.median => 2,
            [self.two_steps.low, self.two_steps.high] => 1, self.known.median => 2,
            [self.known.low, self.known.high] => 1, self.bound * 1e3 => 4, self.verdict.z => 2,
            self.verdict.words,
        })
    }
}

const HEADS: &str = "parameter | unit | assigned | paper | paper I [%] | recomputed [%] | ours, one seed | I [%] | two \
    steps: median I [%] | 95 % of runs [%] | angles known: median I [%] | 95 % of runs [%] | Cramer-Rao \
    sd | paper's z | possible here?";

pub(crate) fn table3(
    paper: &Paper,
    nominal: &Device,
    run: &Run,
    runs: &MonteCarlo,
) -> Result<Table3> {
    let rows = paper.table3.iter().enumerate();
    let rows = rows.map(|(index, row)| Ours::new(row, index, nominal, run, runs));
    let rows: Vec<Ours> = rows.collect::<Result<_>>()?;
    let mut table = Table::with_heads("Table 3: kinematic parameters", HEADS);
    for (row, ours) in paper.table3.iter().zip(&rows) {
        table.push(ours.cells(row)?)?;
    }
    let note = "z: published error over the standard deviation of our runs at known joint angles; \
                \"recomputed\": eq. (8) from the printed values, which for a0, a3, a5, a7, d1 and d6 differs \
                from the printed percentage.";
    let errors = paper.table3.iter().map(|row| row.identified - row.assigned);
    let errors: Vec<f64> = errors.collect();
    let values = runs.samples.iter();
    let values = values.map(|sample| chi_square(&sample.information, &errors));
    let chi_square = Spread::new(&values.collect::<Result<Vec<f64>>>()?)?;
    Ok(Table3 {
        table: table.with_note(note),
        figure: figure(paper, &rows),
        possible: rows.iter().filter(|ours| ours.verdict.possible).count(),
        p_value: chi_square_p_value(chi_square.median, errors.len() as f64)?,
        chi_square,
        medians: paper
            .table3
            .iter()
            .zip(&rows)
            .map(|(row, ours)| (row.name.clone(), ours.known.median, ours.two_steps.median))
            .collect(),
    })
}

fn figure(paper: &Paper, rows: &[Ours]) -> Figure {
    let intervals = |shift: f64, pick: fn(&Ours) -> Spread| -> Vec<(f64, f64, f64, f64)> {
        rows.iter()
            .enumerate()
            .map(|(index, ours)| {
                let Spread { median, low, high } = pick(ours);
                let [low, median, high] = [low, median, high].map(|end| end.max(FLOOR));
                (index as f64 + shift, low, median, high)
            })
            .collect()
    };
    let published = (0..).zip(&paper.table3);
    let published = published.map(|(index, row)| (f64::from(index), row.improvement_percent));
    let known = intervals(-0.15, |ours| ours.known);
    let two_steps = intervals(0.15, |ours| ours.two_steps);
    let cut = "ours, two steps: median, 95 % of runs (cut at 40)";
    let mut figure = Figure::new("Table 3: improvement", "parameter", "improvement I [%]");
    figure.categories = Some(paper.table3.iter().map(|row| row.name.clone()).collect());
    figure.y_range = Some((FLOOR, 102.0));
    figure.series = vec![
        Series::intervals("ours, joint angles known: median, 95 % of runs", 2, &known),
        Series::intervals(cut, 0, &two_steps),
        Series::new("paper", Mark::Points, 1, published.collect()),
    ];
    figure
}

/// Foot of the improvement axis.
const FLOOR: f64 = 40.0;
