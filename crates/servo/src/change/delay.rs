//! A delay that changes: positions follow their inputs some rows later than before.

use std::ops::Range;

use haptical_linalg::NormalEquations;

use super::scan::{Likely, Scan};
use super::sums::{Prefix, fitted, rows};
use crate::thresholds::{
    BROAD_NATS, DELAY_EDGE, DELAY_NATS, DELAY_PARTS, DELAY_REPEATS, DELAY_SHIFTS, NEAR_MOVES,
    NEAR_S, PAST_READINGS, REPEATED_NATS, SHARE_OF_FREE, SPARE_STRETCHES, STRETCHES,
};

/// Sums with the inputs some rows later.
struct Shifted {
    prefix: Prefix,
    whole: NormalEquations,
}

/// Rows on either side of a change, as they are and with the inputs later after it.
struct Sides {
    before: NormalEquations,
    after: NormalEquations,
    later: NormalEquations,
}

impl Scan<'_> {
    /// The likeliest delay: the inputs act some rows later than before, by all of the log, else by what is near.
    /// Of rows that were put together it may lie between two.
    pub(super) fn delay(&self, is_thin: bool) -> Option<Likely> {
        let near = (NEAR_S / self.regression.step_s).round() as usize;
        let near = near.max(10 * self.regression.regressors());
        let all = self.regression.rows;
        let windows = [all, near];
        let found = DELAY_SHIFTS.map(|rows| {
            let shifted = self.shifted(rows as f64);
            let bonus = self.repeats(rows);
            let mut further: Vec<usize> = (0..all).filter(|&row| bonus[row] > 0.0).collect();
            further.sort_unstable_by(|&a, &b| bonus[b].total_cmp(&bonus[a]));
            further.truncate(DELAY_REPEATS);
            windows.map(|window| {
                let nats =
                    |row: usize| self.sides_of(row, &shifted, window).nats(self) + bonus[row];
                let places = (DELAY_EDGE, &further[..], self.apart(window));
                let likely = self.placed(rows as f64, places, &nats)?;
                let row = likely.rows[1];
                if window < all && !self.moves(row.saturating_sub(window)..row, row..row + window) {
                    return None;
                }
                Some(self.judged((likely, &shifted), window))
            })
        });
        // the likeliest must be one, and mostly that: else the law itself is another one
        (0..windows.len()).find_map(|window| {
            let own = found.iter().filter_map(|found| found[window]);
            let (best, is_late) = own.max_by(|a, b| a.0.nats.total_cmp(&b.0.nats))?;
            let between = self.between_rows(best, is_thin);
            let is_late = is_late
                || is_thin && {
                    let shifted = self.shifted(between.size);
                    let rows = best.rows;
                    let own = Likely { rows, ..between };
                    self.judged((own, &shifted), windows[window]).1
                };
            is_late.then_some(between)
        })
    }

    fn shifted(&self, rows: f64) -> Shifted {
        let prefix = self.regression.prefix(rows);
        let whole = self.regression.up_to(&prefix, self.regression.rows);
        Shifted { prefix, whole }
    }

    /// What a delay gains without repeated readings, and whether that is enough.
    fn judged(&self, (likely, shifted): (Likely, &Shifted), window: usize) -> (Likely, bool) {
        let row = likely.rows[1];
        let sides = self.sides_of(row, shifted, window);
        let nats = sides.nats(self);
        let is_late = nats > DELAY_NATS
            && sides.is_mostly_late(self)
            && self.is_broad(&sides, (row, likely.size), window);
        (Likely { nats, ..likely }, is_late)
    }

    /// Whether the joint moves in most rows of two stretches.
    fn moves(&self, before: Range<usize>, after: Range<usize>) -> bool {
        let regression = self.regression;
        let has_moved = |&row: &usize| {
            let past = row.saturating_sub(regression.lags);
            (regression.position(row) - regression.position(past)).abs() > 1.5 * regression.count
        };
        [before, after].into_iter().all(|rows| {
            let rows = rows.start..rows.end.min(regression.rows);
            let moving = rows.clone().filter(has_moved).count();
            moving as f64 > NEAR_MOVES * rows.len() as f64
        })
    }

    /// Whether more than a motion or two on either side says so: what the delay takes of each stretch's squares, without the
    /// stretches that say most.
    fn is_broad(&self, sides: &Sides, (row, shift): (usize, f64), window: usize) -> bool {
        let regression = self.regression;
        let unchanged = fitted(&sides.before.plus(&sides.after, 1.0));
        let unchanged = unchanged.coefficients();
        let late = fitted(&sides.before.plus(&sides.later, 1.0));
        let (squares, late) = (late.rest_square(), late.coefficients());
        let count = rows(&sides.before) + rows(&sides.later);
        let variance = squares / count.max(1.0) + regression.rounding;
        let gained = |at: usize| {
            let shift = if at < row { 0.0 } else { shift };
            let square = |solution: &[f64], shift: f64| {
                let off = regression.position(at) - regression.predicted(solution, at, shift)?;
                Some(off * off)
            };
            Some(square(unchanged, 0.0)? - square(late, shift)?)
        };
        let end = (row + PAST_READINGS)
            .saturating_add(window)
            .min(regression.rows);
        let stretches = [row.saturating_sub(window)..row, row + PAST_READINGS..end];
        stretches.into_iter().all(|rows| {
            let length = (rows.len() / STRETCHES).max(1);
            let starts = rows.clone().step_by(length);
            let mut gains: Vec<f64> = starts
                .map(|start| {
                    let own = start..(start + length).min(rows.end);
                    own.filter_map(gained).sum::<f64>() / (2.0 * variance)
                })
                .collect();
            gains.sort_unstable_by(|a, b| b.total_cmp(a));
            gains.iter().skip(SPARE_STRETCHES).sum::<f64>() > BROAD_NATS
        })
    }

    /// Sums on either side of a row, of at most some rows each.
    fn sides_of(&self, row: usize, shifted: &Shifted, window: usize) -> Sides {
        let rows = self.regression.rows;
        let clear = (row + PAST_READINGS).min(rows);
        let own = |row: usize| self.regression.up_to(&self.own, row);
        let moved = |row: usize| self.regression.up_to(&shifted.prefix, row);
        let mut before = own(row);
        if window < row {
            before = before.plus(&own(row - window), -1.0);
        }
        let (end, end_later) = match clear + window < rows {
            true => (&own(clear + window), &moved(clear + window)),
            false => (&self.all, &shifted.whole),
        };
        Sides {
            before,
            after: end.plus(&own(clear), -1.0),
            later: end_later.plus(&moved(clear), -1.0),
        }
    }

    /// What it says for a delay that grew by some rows at each row that readings repeat those before them: as much as it is
    /// unlikely that the joint stood still.
    fn repeats(&self, rows: isize) -> Vec<f64> {
        let regression = self.regression;
        let mut bonus = vec![0.0; regression.rows];
        let Ok(grown) = usize::try_from(rows) else {
            return bonus;
        };
        let deviation = self.deviation().max(1e-300);
        let solution = fitted(&self.all).coefficients().to_vec();
        let surprise = |row: usize| {
            let predicted = regression.predicted(&solution, row, 0.0)?;
            let off = (regression.position(row) - predicted) / deviation;
            // the density times a count
            let width = regression.count / deviation / std::f64::consts::TAU.sqrt();
            Some(0.5 * off * off - width.max(1e-300).ln())
        };
        for row in grown..regression.rows.saturating_sub(grown) {
            let own = row..row + grown;
            let is_repeat =
                |&at: &usize| regression.position(at) == regression.position(at - grown);
            if own.clone().all(|at| is_repeat(&at)) {
                let said = own.filter_map(surprise).sum::<f64>();
                bonus[row] = said.clamp(0.0, REPEATED_NATS);
            }
        }
        bonus
    }

    /// Its size to an eighth of a row, or a 32nd of rows that were put together, at the row where it is likeliest.
    fn between_rows(&self, likely: Likely, is_thin: bool) -> Likely {
        let row = likely.rows[1];
        let before = self.regression.up_to(&self.own, row);
        let squares = |shift: f64| {
            let later = (self.regression).of_rows(row + PAST_READINGS..self.regression.rows, shift);
            fitted(&before.plus(&later, 1.0)).rest_square()
        };
        let least_step = DELAY_PARTS[usize::from(is_thin)];
        let (mut size, mut least, mut step) = (likely.size, squares(likely.size), 0.5);
        while step > least_step {
            let tried = [size - step, size + step].map(|size| (size, squares(size)));
            let best = tried.into_iter().min_by(|a, b| a.1.total_cmp(&b.1));
            match best {
                Some(found) if found.1 < least => (size, least) = found,
                _ => {}
            }
            step *= 0.5;
        }
        // the rows after it whose past has both sides are free, so it is known no better
        let [first, at, last] = likely.rows;
        let last = (last + PAST_READINGS).min(self.regression.rows - 1);
        Likely {
            size,
            rows: [first.saturating_sub(PAST_READINGS).max(1), at, last],
            ..likely
        }
    }
}

impl Sides {
    /// What the likelihood gains by inputs that are later.
    fn nats(&self, scan: &Scan<'_>) -> f64 {
        let late = self.before.plus(&self.later, 1.0);
        self.nats_of(scan, fitted(&late).rest_square())
    }

    fn nats_of(&self, scan: &Scan<'_>, squares: f64) -> f64 {
        let unchanged = self.before.plus(&self.after, 1.0);
        scan.nats_of(rows(&unchanged), fitted(&unchanged).rest_square(), squares)
    }

    /// Whether that is most of what a regression of its own after the change explains.
    fn is_mostly_late(&self, scan: &Scan<'_>) -> bool {
        let after = fitted(&self.after)
            .rest_square()
            .min(fitted(&self.later).rest_square());
        let free = self.nats_of(scan, after + fitted(&self.before).rest_square());
        self.nats(scan) > SHARE_OF_FREE * free
    }
}
