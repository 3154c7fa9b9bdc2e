//! Levels that a regression on the position's own past does not tell: of a joint at rest, and between two runs.

use super::scan::Likely;
use super::{Change, Kind, LAWS};
use crate::fit::{Problem, Terms};
use crate::log::{Series, mean, rms};
use crate::thresholds::{FEWEST_RUNS, RUN_SCATTERS, SPLIT_SHARE, STILL_SD, STILL_STEP};

/// The first row of a run at which the mean of what delay and lag leave changes most, where that is half of it. A regression on the position's own
/// past explains another level between two runs, whose first rows have no past.
pub(super) fn by_means(series: &Series, lags: usize) -> Option<Likely> {
    let terms = Terms {
        friction: false,
        ..LAWS
    };
    let residual = Problem::new(series).fit(terms, &None, None).residual;
    let (at, share) = best_split(&residual)?;
    let rows = series.len();
    let (first, last) = (at.saturating_sub(lags).max(1), (at + lags).min(rows - 1));
    let start = (first..=last).find(|&row| series.run[row] != series.run[row - 1])?;
    (share > SPLIT_SHARE).then(|| Likely {
        nats: -0.5 * rows as f64 * (1.0 - share).ln(),
        rows: [first, start, last],
        size: 1.0,
    })
}

/// An offset between two runs of many, by the means of what delay and lag leave of each: episodes scatter by where friction left the
/// joint and by what it carried, and their means say by how much.
pub(super) fn between_runs(series: &Series) -> Option<Change> {
    let starts: Vec<usize> = (0..series.len())
        .filter(|&row| row == 0 || series.run[row] != series.run[row - 1])
        .collect();
    let runs = starts.len();
    if runs < 2 * FEWEST_RUNS {
        return None;
    }
    let terms = Terms {
        friction: false,
        ..LAWS
    };
    let residual = Problem::new(series).fit(terms, &None, None).residual;
    let ends = starts[1..].iter().copied().chain([series.len()]);
    let means: Vec<f64> = (starts.iter().copied().zip(ends))
        .map(|(start, end)| mean(&residual[start..end]))
        .collect();
    let split = |at: usize| {
        let (before, after) = means.split_at(at);
        let squares = |own: &[f64]| -> f64 {
            let middle = mean(own);
            own.iter().map(|value| (value - middle).powi(2)).sum()
        };
        let size = mean(after) - mean(before);
        (squares(before) + squares(after), size, at)
    };
    let splits = (FEWEST_RUNS..=runs - FEWEST_RUNS).map(split);
    let (squares, size, at) = splits.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let scatter = (squares / (runs - 2) as f64).sqrt();
    let sd = scatter * (1.0 / at as f64 + 1.0 / (runs - at) as f64).sqrt();
    let least = (RUN_SCATTERS * scatter).max(STILL_SD * sd);
    let is_one = size.abs() > least.max(STILL_STEP).max(10.0 * series.count);
    is_one.then(|| Change::new(series, Kind::Offset(size), [starts[at]; 3], sd))
}

/// The row that splits values into two with the most different means, and the share of their squares about one mean that takes.
fn best_split(values: &[f64]) -> Option<(usize, f64)> {
    let rows = values.len() as f64;
    let total: f64 = values.iter().sum();
    let spread: f64 = values
        .iter()
        .map(|value| (value - total / rows).powi(2))
        .sum();
    let (mut sum, mut best) = (0.0, (0, 0.0));
    for (before, value) in values
        .iter()
        .enumerate()
        .skip(1)
        .map(|(row, _)| (row, values[row - 1]))
    {
        sum += value;
        let (a, b) = (before as f64, rows - before as f64);
        let between = (sum / a - (total - sum) / b).powi(2) * a * b / rows;
        if between > best.1 {
            best = (before, between);
        }
    }
    (spread > 0.0).then(|| (best.0, best.1 / spread))
}

/// An offset of a joint whose command stands.
pub(crate) fn of_a_still_joint(series: &Series) -> Vec<Change> {
    let rows = series.len();
    let errors: Vec<f64> = (series.response.iter().zip(&series.command))
        .map(|(response, command)| response - command)
        .collect();
    let at = best_split(&errors).map_or(0, |(at, _)| at);
    if at < rows / 20 || at > rows - rows / 20 {
        return Vec::new();
    }
    let (before, after) = errors.split_at(at);
    let size = mean(after) - mean(before);
    let scatter = |values: &[f64]| {
        let middle = mean(values);
        rms(&values
            .iter()
            .map(|value| value - middle)
            .collect::<Vec<_>>())
    };
    let sd = scatter(before).max(scatter(after));
    let least = (STILL_SD * sd).max(STILL_STEP).max(10.0 * series.count);
    if size.abs() < least {
        return Vec::new();
    }
    vec![Change::new(series, Kind::Offset(size), [at; 3], sd)]
}
