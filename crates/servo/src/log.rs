//! The log of one joint: what it was commanded, where it was, and when.

use std::fmt;
use std::ops::Range;

use crate::thresholds::{
    DEGREES_PER_RADIAN, FEWEST_COUNTS, FEWEST_ROWS, GAP_STEPS, LONGEST_STEP_S, MOST_LAG_S,
    OPPOSITE, SAME_MOTION, SHORTEST_S, STILL_COUNTS, STILL_RANGE, STOPPED_COMMAND, STOPPED_COUNTS,
    STOPPED_S, STOPPED_SHARE, WRAP,
};

/// Columns of one joint, row by row; a row without a reading is `NaN`.
#[derive(Debug, Clone, Copy, Default)]
pub struct JointLog<'a> {
    /// Times \[s\], increasing within a run.
    pub time_s: Option<&'a [f64]>,
    /// Run of each row; one run without.
    pub run: Option<&'a [i64]>,
    /// Commanded positions \[rad\] or \[m\].
    pub command: Option<&'a [f64]>,
    /// Measured positions \[rad\] or \[m\].
    pub response: &'a [f64],
    /// Velocities that the drive reports \[rad/s\] or \[m/s\]: where they change earlier than the positions, those are late.
    pub velocity: Option<&'a [f64]>,
    /// Torques that the drive reports, of any scale: a change of the scale is looked for.
    pub torque: Option<&'a [f64]>,
    /// Measured positions of the other joints: what gravity asks of this one depends on them.
    pub others: &'a [&'a [f64]],
    /// Torque that gravity asks of the joint \[N m\], where the device has masses.
    pub load_nm: Option<&'a [f64]>,
}

/// Why the answer of a joint to its command cannot be tested.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Untested {
    /// The log has no times.
    NoTime,
    /// The log has no command of the joint.
    NoCommand,
    /// Too few rows have time, command and position.
    Short {
        /// Rows that have all three.
        rows: usize,
    },
    /// They last too short.
    Brief {
        /// How long \[s\].
        length_s: f64,
    },
    /// The command does not move.
    Still,
    /// The command moves as many times farther than the joint as a radian has degrees, or the other way round.
    Degrees {
        /// Command over position.
        ratio: f64,
    },
    /// The position goes the other way.
    Opposite {
        /// Their correlation.
        correlation: f64,
    },
    /// A second log, none of whose rows the first one predicts.
    Elsewhere {
        /// Its rows.
        rows: usize,
    },
    /// Rows are farther apart than a servo takes to answer.
    Coarse {
        /// Median time between rows \[s\].
        step_s: f64,
    },
    /// The joint stands still while its command goes on.
    Stopped {
        /// Since when \[s\].
        from_s: f64,
    },
    /// The position has nothing to do with the command.
    Unrelated {
        /// Their correlation.
        correlation: f64,
    },
}

impl Untested {
    /// Whether the joint does not do what its command asks at all: log and joint do not belong together, or the joint is off.
    ///
    /// ```
    /// use haptical_servo::Untested;
    /// assert!(Untested::Opposite { correlation: -1.0 }.is_foreign());
    /// assert!(!Untested::Still.is_foreign());
    /// ```
    pub fn is_foreign(&self) -> bool {
        matches!(
            self,
            Self::Opposite { .. } | Self::Unrelated { .. } | Self::Stopped { .. }
        )
    }
}

impl fmt::Display for Untested {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoTime => f.write_str("no column t_s: without times no lag can be told"),
            Self::NoCommand => f.write_str("the log has no command of it"),
            Self::Short { rows } => write!(
                f,
                "{rows} rows have time, command and position; {FEWEST_ROWS} are needed"
            ),
            Self::Brief { length_s } => write!(
                f,
                "{length_s:.1} s of rows have time, command and position; {SHORTEST_S} s are needed"
            ),
            Self::Still => {
                f.write_str("its command does not move: what it rests beside it has many causes")
            }
            Self::Degrees { ratio } if *ratio > 1.0 => write!(
                f,
                "its command moves {ratio:.1} times as far as the joint: degrees in a column of radians? Multiply it by 0.0174533"
            ),
            Self::Degrees { ratio } => write!(
                f,
                "the joint moves {:.1} times as far as its command: degrees in a column of radians? Multiply it by 0.0174533",
                1.0 / ratio
            ),
            Self::Opposite { correlation } => write!(
                f,
                "it moves against its command (correlation {correlation:.2}): is the sign of one of the two turned?"
            ),
            Self::Elsewhere { rows } => write!(
                f,
                "none of its {rows} rows is where the first log determines what the joint does"
            ),
            Self::Coarse { step_s } if *step_s > MOST_LAG_S => write!(
                f,
                "its rows are {step_s:.3} s apart, and a servo answers within {MOST_LAG_S} s: milliseconds in t_s? Multiply it by 0.001"
            ),
            Self::Coarse { step_s } => write!(
                f,
                "its rows are {step_s:.3} s apart; 20 rows a second are needed"
            ),
            Self::Stopped { from_s } => write!(
                f,
                "it stands still from {from_s:.2} s on while its command moves: is it blocked, at an end of its travel, or off?"
            ),
            Self::Unrelated { correlation } => write!(
                f,
                "its position does not follow its command (correlation {correlation:.2}): is it the command of another joint?"
            ),
        }
    }
}

impl std::error::Error for Untested {}

/// Rows of one joint that have everything, in pieces without a gap.
#[derive(Debug, Clone)]
pub(crate) struct Series {
    /// Row of the log.
    pub(crate) row: Vec<usize>,
    pub(crate) run: Vec<i64>,
    pub(crate) time_s: Vec<f64>,
    pub(crate) command: Vec<f64>,
    pub(crate) response: Vec<f64>,
    pub(crate) velocity: Option<Vec<f64>>,
    pub(crate) torque: Option<Vec<f64>>,
    pub(crate) others: Vec<Vec<f64>>,
    pub(crate) load_nm: Option<Vec<f64>>,
    /// First index of each piece.
    pub(crate) starts: Vec<usize>,
    /// Rows that a fit counts: not those at the start of a stretch that was cut out, where nobody knows what the joint is on its way to.
    pub(crate) scored: Vec<Range<usize>>,
    /// Median time between rows.
    pub(crate) step_s: f64,
    /// Smallest change of a reading: a count of its sensor.
    pub(crate) count: f64,
    pub(crate) warnings: Vec<String>,
}

impl Series {
    /// The rows of a joint that can be used.
    pub(crate) fn new(log: &JointLog<'_>) -> Result<Self, Untested> {
        let command = log.command.ok_or(Untested::NoCommand)?;
        let time_s = log.time_s.ok_or(Untested::NoTime)?;
        let is_whole = |&row: &usize| {
            let own = [time_s[row], command[row], log.response[row]];
            own.iter().all(|value| value.is_finite())
        };
        let rows: Vec<usize> = (0..log.response.len()).filter(is_whole).collect();
        if rows.len() < FEWEST_ROWS {
            return Err(Untested::Short { rows: rows.len() });
        }
        let take = |column: &[f64]| -> Vec<f64> { rows.iter().map(|&row| column[row]).collect() };
        let is_filled = |column: &&&[f64]| rows.iter().all(|&row| column[row].is_finite());
        let others = log.others.iter().filter(is_filled);
        let mut series = Self {
            run: rows
                .iter()
                .map(|&row| log.run.map_or(0, |run| run[row]))
                .collect(),
            time_s: take(time_s),
            command: take(command),
            response: take(log.response),
            velocity: log.velocity.filter(|column| is_filled(&column)).map(take),
            torque: log.torque.filter(|column| is_filled(&column)).map(take),
            others: others.map(|column| take(column)).collect(),
            load_nm: log.load_nm.filter(|column| is_filled(&column)).map(take),
            starts: Vec::new(),
            scored: std::iter::once(0..rows.len()).collect(),
            step_s: 0.0,
            count: 0.0,
            warnings: Vec::new(),
            row: rows,
        };
        series.cut();
        if series.step_s > LONGEST_STEP_S {
            let step_s = series.step_s;
            return Err(Untested::Coarse { step_s });
        }
        // rows at the ends of pieces take a step less
        let length_s = (series.row.len() + 1) as f64 * series.step_s;
        if length_s < SHORTEST_S {
            return Err(Untested::Brief { length_s });
        }
        series.unwrap_turns();
        series.count = smallest_step(&series.response);
        Ok(series)
    }

    pub(crate) fn len(&self) -> usize {
        self.row.len()
    }

    /// Cuts at new runs and at gaps in time or rows.
    fn cut(&mut self) {
        let mut steps: Vec<f64> = (1..self.len())
            .filter(|&k| self.run[k] == self.run[k - 1])
            .map(|k| self.time_s[k] - self.time_s[k - 1])
            .collect();
        steps.sort_unstable_by(f64::total_cmp);
        self.step_s = steps.get(steps.len() / 2).copied().unwrap_or(0.0).max(1e-9);
        let (low, high) = (steps.len() / 20, steps.len() * 19 / 20);
        if let (Some(low), Some(high)) = (steps.get(low), steps.get(high))
            && high - low > 0.5 * self.step_s
        {
            self.warnings.push(format!(
                "times between rows vary from {:.1} to {:.1} ms: lags are known no better",
                low * 1e3,
                high * 1e3
            ));
        }
        let is_start = |&k: &usize| {
            k == 0
                || self.run[k] != self.run[k - 1]
                || self.time_s[k] - self.time_s[k - 1] > GAP_STEPS * self.step_s
        };
        self.starts = (0..self.len()).filter(is_start).collect();
    }

    /// Takes out whole turns that a reading loses from one row to the next while its command does not.
    fn unwrap_turns(&mut self) {
        let turn = std::f64::consts::TAU;
        let mut found = [0_usize; 2];
        for (index, column) in [&mut self.response, &mut self.command]
            .into_iter()
            .enumerate()
        {
            let mut turns = 0.0;
            for k in 1..column.len() {
                if self.starts.binary_search(&k).is_ok() {
                    turns = 0.0;
                }
                let step = column[k] + turns - column[k - 1];
                if (step.abs() - turn).abs() < WRAP {
                    turns -= turn * step.signum();
                    found[index] += 1;
                }
                column[k] += turns;
            }
        }
        if found.iter().any(|times| *times > 0) {
            self.bring_together();
        }
        for (times, name) in found.iter().zip(["position", "command"]) {
            if *times > 0 {
                self.warnings.push(format!(
                    "its {name} jumps by a whole turn {times} times: taken as an angle that wraps"
                ));
            }
        }
    }

    /// Takes off whole turns that lie between a position and its command at the start of a piece.
    fn bring_together(&mut self) {
        let turn = std::f64::consts::TAU;
        for piece in self.pieces().collect::<Vec<_>>() {
            let apart = mean(&self.response[piece.clone()]) - mean(&self.command[piece.clone()]);
            let turns = (apart / turn).round() * turn;
            let own = &mut self.response[piece];
            own.iter_mut().for_each(|value| *value -= turns);
        }
    }

    /// The piece that starts at or before an index.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        let ends = self.starts.iter().skip(1).copied();
        let ends = ends.chain(std::iter::once(self.len()));
        self.starts.iter().copied().zip(ends).map(|(a, b)| a..b)
    }

    /// Of a series that is longer than so many rows about as many, and which of its rows a fit counts: of each of so many equal parts the
    /// stretch in which its command moves most. The first `MOST_LAG_S` of a stretch lead into it.
    pub(crate) fn stretches(&self, rows: usize, parts: usize) -> Option<(Self, Vec<Range<usize>>)> {
        let (all, length) = (self.len(), rows / parts);
        let lead = (MOST_LAG_S / self.step_s).round() as usize;
        if all <= rows || length <= 2 * lead {
            return None;
        }
        let is_next = |row: usize| row > 0 && self.starts.binary_search(&row).is_err();
        let mut way = vec![0.0; all + 1];
        for row in 0..all {
            let step = match is_next(row) {
                true => (self.command[row] - self.command[row - 1]).abs(),
                false => 0.0,
            };
            way[row + 1] = way[row] + step;
        }
        let of_part = |part: usize| {
            let own = part * all / parts..(part + 1) * all / parts;
            let moved = |first: &usize| way[first + length] - way[*first];
            let firsts = (own.start..=own.end - length).step_by((length / 4).max(1));
            let most = firsts.max_by(|a, b| moved(a).total_cmp(&moved(b)));
            most.map(|first| first..first + length)
        };
        let kept: Vec<Range<usize>> = (0..parts).filter_map(of_part).collect();
        let rows: Vec<usize> = kept.iter().cloned().flatten().collect();
        let take = |column: &[f64]| -> Vec<f64> { rows.iter().map(|&row| column[row]).collect() };
        let is_start = |&at: &usize| at == 0 || rows[at] != rows[at - 1] + 1 || !is_next(rows[at]);
        let ends = (0..kept.len()).map(|stretch| stretch * length + lead..(stretch + 1) * length);
        let some = Self {
            row: rows.iter().map(|&row| self.row[row]).collect(),
            run: rows.iter().map(|&row| self.run[row]).collect(),
            time_s: take(&self.time_s),
            command: take(&self.command),
            response: take(&self.response),
            velocity: self.velocity.as_deref().map(take),
            torque: self.torque.as_deref().map(take),
            others: self.others.iter().map(|own| take(own)).collect(),
            load_nm: self.load_nm.as_deref().map(take),
            starts: (0..rows.len()).filter(is_start).collect(),
            scored: ends.collect(),
            step_s: self.step_s,
            count: self.count,
            warnings: Vec::new(),
        };
        let counted = kept.into_iter().map(|own| own.start + lead..own.end);
        Some((some, counted.collect()))
    }

    /// Rows that a fit counts.
    pub(crate) fn scored_rows(&self) -> usize {
        self.scored.iter().map(ExactSizeIterator::len).sum()
    }

    /// So many rows, or those of so many seconds where they are more.
    pub(crate) fn rows_of(&self, rows: usize, time_s: f64) -> usize {
        rows.max((time_s / self.step_s) as usize)
    }

    /// Whether the command moves by more than a few counts.
    pub(crate) fn moves(&self) -> bool {
        let range = self
            .pieces()
            .map(|piece| range(&self.command[piece]))
            .fold(0.0, f64::max);
        range > (STILL_COUNTS * self.count).max(STILL_RANGE)
    }

    /// Refuses what is no command of this joint.
    pub(crate) fn check_related(&self) -> Result<(), Untested> {
        // the lag takes correlation away: the best of the shifts that a servo may have
        let most = ((0.5 / self.step_s).round() as usize).min(self.len() / 4);
        let shifts = (0..=most).step_by((most / 8).max(1));
        let found: Vec<(f64, f64)> = shifts.map(|shift| self.regressed(shift)).collect();
        let by_first = |a: &(usize, &(f64, f64)), b: &(usize, &(f64, f64))| a.1.0.total_cmp(&b.1.0);
        let best = found.iter().enumerate().max_by(by_first);
        let (at, &(correlation, slope)) = best.unwrap_or((0, &(0.0, 1.0)));
        let least = found.iter().enumerate().min_by(by_first);
        let (turned_at, &(turned, _)) = least.unwrap_or((0, &(0.0, 1.0)));
        // a wave is its own opposite half a period later, and itself a period later: the sign is that of the smaller lag
        let first = |is_one: &dyn Fn(f64) -> bool| found.iter().position(|own| is_one(own.0));
        let is_later = first(&|own| own > 0.8 * correlation).unwrap_or(at)
            > first(&|own| own < 0.8 * turned).unwrap_or(turned_at);
        if turned < -OPPOSITE && turned < -0.9 * correlation && is_later {
            return Err(Untested::Opposite {
                correlation: turned,
            });
        }
        if let Some(from_s) = self.stopped_s() {
            return Err(Untested::Stopped { from_s });
        }
        if correlation < SAME_MOTION {
            return Err(Untested::Unrelated { correlation });
        }
        let is_near = |ratio: f64| (0.7..1.4).contains(&(ratio / DEGREES_PER_RADIAN));
        if correlation > 0.8 && (is_near(slope) || is_near(1.0 / slope)) {
            return Err(Untested::Degrees { ratio: 1.0 / slope });
        }
        Ok(())
    }

    /// Since when the joint stands still while its command goes on, to the log's end.
    fn stopped_s(&self) -> Option<f64> {
        let end = *self.response.last()?;
        // a change of gain that was undone has smaller steps than a count
        let near = STOPPED_COUNTS * self.count.min(smallest_step(&self.response));
        let moves = |value: &f64| (value - end).abs() > near;
        let from = self.response.iter().rposition(moves)? + 1;
        let command = self.command.get(from..)?;
        let is_long = command.len() as f64 > STOPPED_SHARE * self.len() as f64
            && command.len() as f64 * self.step_s > STOPPED_S;
        let goes_on = range(command) > STOPPED_COMMAND * range(&self.command);
        (is_long && goes_on).then(|| self.time_s[from])
    }

    /// Correlation of the response with the command some rows before, and its slope.
    fn regressed(&self, shift: usize) -> (f64, f64) {
        let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
        for piece in self.pieces().filter(|piece| piece.len() > shift + 1) {
            let x = &self.command[piece.start..piece.end - shift];
            let y = &self.response[piece.start + shift..piece.end];
            let (mx, my) = (mean(x), mean(y));
            for (x, y) in x.iter().zip(y) {
                xy += (x - mx) * (y - my);
                xx += (x - mx).powi(2);
                yy += (y - my).powi(2);
            }
        }
        (xy / (xx * yy).sqrt().max(1e-300), xy / xx.max(1e-300))
    }
}

pub(crate) fn range(values: &[f64]) -> f64 {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (high - low).max(0.0)
}

pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

pub(crate) fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// Lower twentieth of the changes that are none: one count, where readings are counts.
fn smallest_step(values: &[f64]) -> f64 {
    let pairs = values.windows(2);
    let mut steps: Vec<f64> = pairs
        .map(|pair| (pair[1] - pair[0]).abs())
        .filter(|step| *step > 1e-9)
        .collect();
    if steps.len() < FEWEST_COUNTS {
        return 0.0;
    }
    steps.sort_unstable_by(f64::total_cmp);
    steps[steps.len() / 20]
}
