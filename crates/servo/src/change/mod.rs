//! What changed within a log: the joint's offset, its delay, its gain.

mod delay;
mod scan;
mod still;
mod sums;
mod thin;
mod torque;

use std::convert::Infallible;

use haptical_judge::{Forward, Proposal, Proposals, Ruled, Ruling};

use self::scan::{Likely, Scan};
pub(crate) use self::still::of_a_still_joint;
use self::still::{between_runs, by_means};
use self::sums::Regression;
use self::thin::Thinned;
pub use self::torque::torque_gain;
use crate::answer::{Finding, Instant, Number};
use crate::effect::{gain, latency, offset};
use crate::fit::{Problem, Terms};
use crate::log::{Series, mean, rms};
use crate::thresholds::{
    BEYOND_BAND, CHANGED_GAINS, GAIN_ROUNDS, LEAST_GAIN, LEVEL_LEAVES, LEVEL_NATS, MOST_CHANGES,
    PAST_READINGS, STILL_COUNTS,
};

/// What changed.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// The position reads more by this.
    Offset(f64),
    /// The position is `level` and a factor times what it was.
    Gain { factor: f64, level: f64 },
    /// The positions follow some rows later: their command alone, or their velocities too, which are not late then.
    Delay { rows: f64, behind_velocity: bool },
}

/// A change within a log.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Change {
    kind: Kind,
    /// First index after it.
    at: usize,
    instant: Instant,
    /// Number as it is reported.
    number: Number,
}

impl Change {
    fn new(series: &Series, kind: Kind, rows: [usize; 3], sd: f64) -> Self {
        let (name, value) = match kind {
            Kind::Offset(size) => ("offset_rad", size),
            Kind::Gain { factor, .. } => ("factor", factor),
            Kind::Delay { rows, .. } => ("delay_s", rows * series.step_s),
        };
        Self {
            kind,
            at: rows[1],
            instant: instant(series, rows),
            number: Number {
                name,
                value,
                ci95: [value - 1.96 * sd, value + 1.96 * sd],
            },
        }
    }

    /// The log as it would have been without the change.
    pub(crate) fn undo(&self, series: &mut Series) {
        match self.kind {
            Kind::Offset(size) => {
                let after = &mut series.response[self.at..];
                after.iter_mut().for_each(|value| *value -= size);
            }
            Kind::Gain { factor, level } => {
                let after = &mut series.response[self.at..];
                after
                    .iter_mut()
                    .for_each(|value| *value = (*value - level) / factor);
            }
            Kind::Delay {
                rows,
                behind_velocity,
            } => {
                let pieces: Vec<_> = series.pieces().collect();
                let velocity = series.velocity.as_mut().filter(|_| behind_velocity);
                for column in std::iter::once(&mut series.command).chain(velocity) {
                    later(column, &pieces, self.at, rows);
                }
            }
        }
    }

    /// Another log's commands as they are followed after the change.
    pub(crate) fn delay_all(&self, series: &mut Series) {
        if let Kind::Delay { rows, .. } = self.kind {
            let pieces: Vec<_> = series.pieces().collect();
            later(&mut series.command, &pieces, 0, rows);
        }
    }

    /// Positions as they are read after the change.
    pub(crate) fn read_all(&self, positions: &mut [f64]) {
        match self.kind {
            Kind::Offset(size) => positions.iter_mut().for_each(|value| *value += size),
            Kind::Gain { factor, level } => {
                let read = |value: &mut f64| *value = factor * *value + level;
                positions.iter_mut().for_each(read);
            }
            Kind::Delay { .. } => {}
        }
    }

    /// As a cause.
    pub(crate) fn finding(&self, share: f64) -> Finding {
        let effect = match self.kind {
            Kind::Offset(_) => offset::NAME,
            Kind::Gain { .. } => gain::NAME,
            Kind::Delay { .. } => latency::NAME,
        };
        let confusable_with = match self.kind {
            Kind::Delay {
                behind_velocity: true,
                ..
            } => vec![latency::OF_READINGS],
            _ => Vec::new(),
        };
        Finding {
            effect,
            numbers: vec![self.number],
            confusable_with,
            share,
            since: Some(self.instant),
        }
    }
}

/// Takes a column some rows later from a row on, between rows along straight lines.
fn later(column: &mut [f64], pieces: &[std::ops::Range<usize>], from: usize, rows: f64) {
    let before = column.to_vec();
    for piece in pieces {
        let ends = [piece.start as f64, (piece.end - 1) as f64];
        for row in piece.clone().filter(|&row| row >= from) {
            let at = (row as f64 - rows).clamp(ends[0], ends[1]);
            let (whole, part) = (at.floor() as usize, at - at.floor());
            let next = (whole + 1).min(piece.end - 1);
            column[row] = (1.0 - part) * before[whole] + part * before[next];
        }
    }
}

fn instant(series: &Series, rows: [usize; 3]) -> Instant {
    let [first, at, last] = rows;
    let start = |&row: &usize| row > 0 && series.run[row] != series.run[row - 1];
    // a change that may as well have come between two runs did
    let between = (first..=last).find(start);
    let at = between.unwrap_or(at);
    Instant {
        rows: [first, at, last].map(|row| series.row[row]),
        time_s: [first, at, last].map(|row| series.time_s[row]),
        between_runs: between.map(|row| [series.run[row - 1], series.run[row]]),
        run: series.run[at],
    }
}

/// Changes of a joint that moves, in the order in which they were found.
pub(crate) fn find(series: &Series) -> Vec<Change> {
    let start = Found {
        rest: series.clone(),
        changes: Vec::new(),
    };
    let Ok(found) = haptical_judge::select(&mut Changes, start);
    found.changes
}

/// Changes that were found so far, and the log without them.
struct Found {
    rest: Series,
    changes: Vec<Change>,
}

/// The search of changes.
struct Changes;

impl Forward for Changes {
    type State = Found;
    type Further = Change;
    type Error = Infallible;

    fn proposals(&mut self, found: &Found) -> Proposals<Self> {
        if found.changes.len() >= MOST_CHANGES {
            return Ok(Vec::new());
        }
        let next = next(&found.rest, found.changes.is_empty());
        Ok(Proposal::of_best(next, |_| 0.0))
    }

    fn rule(&mut self, found: &Found, next: Proposal<Change>) -> Ruled<Self> {
        let mut rest = found.rest.clone();
        next.further.undo(&mut rest);
        Ok(Ruling::Taken(Found {
            rest,
            changes: [found.changes.as_slice(), &[next.further]].concat(),
        }))
    }
}

/// The likeliest change; a delay only of a log of one level, since a level that is not quite right looks like one.
fn next(series: &Series, is_level: bool) -> Option<Change> {
    let regression = Regression::new(series, None);
    if series.len() < 8 * regression.regressors() {
        return None;
    }
    let scan = Scan::new(&regression);
    let enough = |likely: &Likely| likely.nats > LEVEL_NATS;
    let offset = scan.offset().filter(enough);
    let offset = offset.or_else(|| by_means(series, regression.lags));
    let gain = scan.gain().filter(enough);
    if offset.is_some() || gain.is_some() {
        let before = left(series, None);
        let offset = offset.and_then(|likely| of_offset(series, &regression, &scan, &likely));
        let gain = gain.and_then(|likely| of_gain(series, &regression, &scan, &likely));
        let is_one = |(_, squares): &(Change, f64)| *squares < LEVEL_LEAVES * before;
        let (offset, gain) = (offset.filter(is_one), gain.filter(is_one));
        let gain = gain.filter(|(change, _)| change.number.value.ln().abs() > LEAST_GAIN.ln());
        match (offset, gain) {
            // a gain has one number more
            (Some(offset), Some(gain)) if gain.1 < 0.5 * offset.1 => return Some(gain.0),
            (Some(offset), _) => return Some(offset.0),
            (None, Some(gain)) => return Some(gain.0),
            (None, None) => {}
        }
    }
    if let Some(change) = between_runs(series) {
        return Some(change);
    }
    if !is_level {
        return None;
    }
    let Some(thin) = Thinned::new(series) else {
        let (likely, behind_velocity) = of_delay(series, &scan, false)?;
        let kind = Kind::Delay {
            rows: likely.size,
            behind_velocity,
        };
        let half_step = 0.5 * series.step_s / 1.96;
        return Some(Change::new(series, kind, likely.rows, half_step));
    };
    let regression = Regression::new(&thin.series, None);
    if thin.series.len() < 8 * regression.regressors() {
        return None;
    }
    let (likely, behind_velocity) = of_delay(&thin.series, &Scan::new(&regression), true)?;
    let kind = Kind::Delay {
        rows: thin.whole(likely.size),
        behind_velocity,
    };
    let half_step = 0.5 * thin.series.step_s / 1.96;
    Some(Change::new(series, kind, thin.rows(likely.rows), half_step))
}

/// The likeliest delay, and whether positions are late by what their velocities say.
fn of_delay(series: &Series, scan: &Scan<'_>, is_thin: bool) -> Option<(Likely, bool)> {
    let beside_velocity = series.velocity.as_deref().and_then(|velocity| {
        let regression = Regression::new(series, Some(velocity));
        Scan::new(&regression).delay(is_thin)
    });
    let behind_velocity = beside_velocity.is_some();
    let likely = beside_velocity.or_else(|| scan.delay(is_thin))?;
    Some((likely, behind_velocity))
}

/// Laws that explain what they can of a log with or without a change.
const LAWS: Terms = Terms {
    offset: true,
    delay: true,
    lag: true,
    friction: true,
    ..Terms::NONE
};

/// Squares that the laws leave of a log, in its own unit, a change undone.
fn left(series: &Series, change: Option<&Change>) -> f64 {
    let mut undone = series.clone();
    if let Some(change) = change {
        change.undo(&mut undone);
    }
    let fit = Problem::new(&undone).fit(LAWS, &None, None);
    squares_in_unit(&fit.residual, change)
}

fn squares_in_unit(residual: &[f64], change: Option<&Change>) -> f64 {
    let (at, factor) = match change.map(|change| (change.at, change.kind)) {
        Some((at, Kind::Gain { factor, .. })) => (at, factor),
        _ => (0, 1.0),
    };
    let rows = residual.iter().enumerate();
    rows.map(|(row, value)| match row >= at {
        true => (value * factor).powi(2),
        false => value * value,
    })
    .sum()
}

/// An offset at its likeliest row, with what the laws leave beside it; none where friction could have done it.
fn of_offset(
    series: &Series,
    regression: &Regression,
    scan: &Scan<'_>,
    likely: &Likely,
) -> Option<(Change, f64)> {
    let at = likely.rows[1];
    let solution = scan.solution(at, 1.0);
    let own = 1.0 - solution[..PAST_READINGS].iter().sum::<f64>();
    let settled = solution.last()? / own;
    let jumped = regression
        .predicted(&solution, at, 0.0)
        .map(|before| regression.position(at) - before);
    let sizes = [Some(settled), jumped].into_iter().flatten();
    let sizes = sizes.filter(|size| size.is_finite());
    let tried = sizes.map(|size| {
        let change = Change::new(series, Kind::Offset(size), likely.rows, 0.0);
        let (squares, fit, after) = adjusted(series, &change);
        (squares, size + after, fit)
    });
    let (squares, size, half_width) = tried.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let rest = (squares / series.len() as f64).sqrt();
    let band = 2.0 * half_width;
    if size.abs() < BEYOND_BAND * band + 3.0 * rest + STILL_COUNTS * series.count {
        return None;
    }
    // half a second of what is left is one number
    let pieces = (series.len() as f64 * series.step_s / 0.5).max(2.0);
    let sd = rest * (4.0 / pieces).sqrt();
    let change = Change::new(series, Kind::Offset(size), likely.rows, sd);
    let squares = left(series, Some(&change)).min(squares);
    Some((change, squares))
}

/// What the laws leave beside a change, half the width of their band, and by how much the level after it is still off.
fn adjusted(series: &Series, change: &Change) -> (f64, f64, f64) {
    let mut undone = series.clone();
    change.undo(&mut undone);
    let fit = Problem::new(&undone).fit(LAWS, &None, None);
    let (before, after) = fit.residual.split_at(change.at);
    let off = mean(after) - mean(before);
    let squares = squares_in_unit(&fit.residual, Some(change));
    (squares, fit.shape.half_width, off)
}

fn of_gain(
    series: &Series,
    regression: &Regression,
    scan: &Scan<'_>,
    likely: &Likely,
) -> Option<(Change, f64)> {
    let (at, factor) = (
        likely.rows[1],
        likely.size.clamp(CHANGED_GAINS.start, CHANGED_GAINS.end),
    );
    let solution = scan.solution(at, factor);
    let own = 1.0 - solution[..PAST_READINGS].iter().sum::<f64>();
    let constant = solution.get(regression.regressors() - 1)? / own;
    let step = solution.last()? / own;
    let middle = mean(&series.response);
    // about the mean: y = after + factor (x - before) where it was x; then by the laws, again and again
    let mut kind = (
        factor,
        middle + constant + step - factor * (middle + constant),
    );
    let mut best: Option<(f64, Change)> = None;
    for _ in 0..GAIN_ROUNDS {
        let (factor, level) = kind;
        let change = Change::new(series, Kind::Gain { factor, level }, likely.rows, 0.0);
        let (squares, follows) = scaled(series, &change);
        if best
            .as_ref()
            .is_some_and(|(least, _)| squares >= 0.999 * least)
        {
            break;
        }
        best = Some((squares, change));
        let Some(next) = follows.filter(|(factor, _)| CHANGED_GAINS.contains(factor)) else {
            break;
        };
        kind = next;
    }
    let (squares, mut change) = best?;
    let factor = change.number.value;
    let rest = (squares / series.len() as f64).sqrt();
    let moved = rms(&series.response[at..]
        .iter()
        .map(|value| value - mean(&series.response[at..]))
        .collect::<Vec<_>>());
    let pieces = (series.len() as f64 * series.step_s / 0.5).max(2.0);
    let sd = factor * rest / moved.max(1e-300) * (4.0 / pieces).sqrt();
    change.number.ci95 = [factor - 1.96 * sd, factor + 1.96 * sd];
    Some((change, squares))
}

/// What the laws leave where a gain is undone, and the factor and level that the readings after it have on what they predict.
fn scaled(series: &Series, change: &Change) -> (f64, Option<(f64, f64)>) {
    let mut undone = series.clone();
    change.undo(&mut undone);
    let fit = Problem::new(&undone).fit(LAWS, &None, None);
    let squares = squares_in_unit(&fit.residual, Some(change));
    let after = change.at..series.len();
    let predicted: Vec<f64> = (after.clone())
        .map(|row| undone.response[row] - fit.residual[row])
        .collect();
    let read = &series.response[after];
    let (x, y) = (mean(&predicted), mean(read));
    let pairs = || predicted.iter().zip(read);
    let along: f64 = pairs().map(|(p, r)| (p - x) * (r - y)).sum();
    let spread: f64 = pairs().map(|(p, _)| (p - x).powi(2)).sum();
    let factor = along / spread.max(1e-300);
    (
        squares,
        factor.is_finite().then_some((factor, y - factor * x)),
    )
}

#[cfg(test)]
mod tests {
    use super::{Change, Kind};
    use crate::log::{JointLog, Series};

    #[test]
    fn what_a_change_does_to_readings_is_undone() {
        let time_s: Vec<f64> = (0..600).map(|row| 0.02 * f64::from(row)).collect();
        let course: Vec<f64> = time_s.iter().map(|time| time.sin()).collect();
        let log = JointLog {
            time_s: Some(&time_s),
            command: Some(&course),
            response: &course,
            ..JointLog::default()
        };
        let sound = Series::new(&log).unwrap();
        let (factor, level) = (1.5, 0.3);
        for kind in [Kind::Gain { factor, level }, Kind::Offset(0.2)] {
            let mut series = sound.clone();
            let change = Change::new(&series, kind, [300; 3], 0.0);
            change.read_all(&mut series.response[300..]);
            assert!((series.response[400] - sound.response[400]).abs() > 0.1);
            change.undo(&mut series);
            for (own, wanted) in series.response.iter().zip(&sound.response) {
                assert!((own - wanted).abs() < 1e-12, "{kind:?}");
            }
        }
    }
}
