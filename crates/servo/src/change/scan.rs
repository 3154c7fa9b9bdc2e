//! The likelihood of each change at each row: generalised likelihood ratios of a regression (Basseville & Nikiforov, Detection of
//! Abrupt Changes, 1993, 2.4 and 7.2).

use std::collections::BTreeMap;

use haptical_linalg::NormalEquations;

use super::sums::{Prefix, Regression, fitted, rows, with_step};
use crate::thresholds::{
    FINER, GAIN_FACTORS, LEVEL_EDGE, LEVEL_REPEATS, LONG_REST_S, PAST_READINGS, PLACE_NATS,
    PLACE_SHARE, SAME_NATS, SAME_SHARE, SCAN_POINTS,
};

/// A change where it is likeliest.
#[derive(Debug, Clone, Copy)]
pub(super) struct Likely {
    /// What the likelihood gains \[nats\].
    pub(super) nats: f64,
    /// First row after it: the first, the likeliest and the last that may be.
    pub(super) rows: [usize; 3],
    /// Factor of a gain, rows of a delay; 1 for an offset.
    pub(super) size: f64,
}

/// A scan of a log.
#[derive(Debug)]
pub(super) struct Scan<'r> {
    pub(super) regression: &'r Regression,
    pub(super) own: Prefix,
    pub(super) all: NormalEquations,
    /// Squares that one regression for the whole log leaves.
    squares: f64,
    /// Rows that one regression predicts worst: a jump lies between the points of a grid.
    wild: Vec<usize>,
}

impl<'r> Scan<'r> {
    pub(super) fn new(regression: &'r Regression) -> Self {
        let own = regression.prefix(0.0);
        let all = regression.up_to(&own, regression.rows);
        let whole = fitted(&all);
        let solution = whole.coefficients();
        let surprise = |&row: &usize| {
            let predicted = regression.predicted(solution, row, 0.0)?;
            Some(((regression.position(row) - predicted).abs(), row))
        };
        let mut wild: Vec<(f64, usize)> = (0..regression.rows)
            .collect::<Vec<_>>()
            .iter()
            .filter_map(surprise)
            .collect();
        wild.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
        wild.truncate(LEVEL_REPEATS);
        Self {
            squares: whole.rest_square(),
            wild: wild.into_iter().map(|(_, row)| row).collect(),
            regression,
            own,
            all,
        }
    }

    fn count(&self) -> f64 {
        rows(&self.all)
    }

    /// What the likelihood gains where less is left than by one regression.
    fn nats(&self, squares: f64) -> f64 {
        self.nats_of(self.count(), self.squares, squares)
    }

    /// What the likelihood of some rows gains where less of their squares is left.
    pub(super) fn nats_of(&self, rows: f64, before: f64, after: f64) -> f64 {
        let rounding = rows * self.regression.rounding;
        0.5 * rows * ((before + rounding) / (after + rounding)).ln()
    }

    /// Deviation of what one regression does not predict.
    pub(super) fn deviation(&self) -> f64 {
        (self.squares / self.count().max(1.0) + self.regression.rounding).sqrt()
    }

    /// Rows at which a change is looked for: a part of the log and its regression's memory off either end.
    fn grid(&self, part: usize, further: &[usize], apart: usize) -> Vec<usize> {
        let rows = self.regression.rows;
        let edge = (rows / part).max(3 * self.regression.regressors());
        let inner = edge..rows.saturating_sub(edge);
        let further = further.iter().copied().filter(|row| inner.contains(row));
        let mut grid: Vec<usize> = inner.clone().step_by(apart).chain(further).collect();
        grid.sort_unstable();
        grid.dedup();
        grid
    }

    /// Rows between those at which a change is looked for first: of one that shows within a window on either side, a quarter of that.
    pub(super) fn apart(&self, window: usize) -> usize {
        let step = self.regression.step;
        let most = self.regression.rows / SCAN_POINTS;
        step * (most.min(window / 4) / step).max(1)
    }

    /// The likeliest row by a function of it, and how far on either side it is nearly as likely.
    pub(super) fn placed(
        &self,
        size: f64,
        (part, further, apart): (usize, &[usize], usize),
        nats: &dyn Fn(usize) -> f64,
    ) -> Option<Likely> {
        let inner = PAST_READINGS + 1..self.regression.rows - PAST_READINGS - 1;
        let mut tried: BTreeMap<usize, f64> = self
            .grid(part, further, apart)
            .into_iter()
            .map(|row| (row, nats(row)))
            .collect();
        let likeliest = |tried: &BTreeMap<usize, f64>| {
            let best = tried.iter().max_by(|a, b| a.1.total_cmp(b.1));
            best.map(|(row, nats)| (*row, *nats))
        };
        // ever finer about the likeliest
        let mut reach = apart;
        while reach > 1 {
            let (near, _) = likeliest(&tried)?;
            let finer = (reach / FINER).max(1);
            let from = near.saturating_sub(reach).max(inner.start);
            for row in (from..=(near + reach).min(inner.end - 1)).step_by(finer) {
                tried.entry(row).or_insert_with(|| nats(row));
            }
            reach = finer;
        }
        let (at, best) = likeliest(&tried)?;
        // from the best row outwards as long as it is nearly as likely, between rows that are far from each other by halves
        let step = self.regression.step;
        let walk = |towards: &mut dyn Iterator<Item = (&usize, &f64)>, less: f64| {
            let (mut within, mut beyond) = (at, None);
            for (row, own) in towards {
                if *own < best - less {
                    beyond = Some(*row);
                    break;
                }
                within = *row;
            }
            while let Some(end) = beyond.filter(|end| end.abs_diff(within) > step) {
                let middle = usize::midpoint(within, end);
                match nats(middle) >= best - less {
                    true => within = middle,
                    false => beyond = Some(middle),
                }
            }
            within
        };
        let backward = tried.range(..=at).rev();
        let forward = tried.range(at..);
        // errors that are not quite white make all of it larger than it is
        let less = PLACE_NATS.max(PLACE_SHARE * best);
        let first = walk(&mut backward.clone(), less);
        let last = walk(&mut forward.clone(), less);
        // rows that are as likely: the middle of a few, but of a long rest the end, where the change first shows
        let same = SAME_NATS.max(SAME_SHARE * best);
        let [from, rested] = [
            walk(&mut backward.clone(), same),
            walk(&mut forward.clone(), same),
        ];
        let at = if (rested - from) as f64 * self.regression.step_s > LONG_REST_S {
            let shown = (rested..=rested + step).take_while(|&row| nats(row) >= best - same);
            shown.last().unwrap_or(rested)
        } else {
            usize::midpoint(from, rested)
        };
        Some(Likely {
            nats: best,
            rows: [first.min(at), at, last.max(at)],
            size,
        })
    }

    /// Sums before a row, and of the rows that have nothing of what was before it in their past.
    fn sides(&self, row: usize) -> [NormalEquations; 2] {
        let before = self.regression.up_to(&self.own, row);
        let clear = (row + PAST_READINGS).min(self.regression.rows);
        let up_to = self.regression.up_to(&self.own, clear);
        [before, self.all.plus(&up_to, -1.0)]
    }

    /// The position is read with another offset from a row on, and with another gain.
    fn of_level(&self, row: usize, factor: f64) -> NormalEquations {
        let [before, after] = self.sides(row);
        let commands = PAST_READINGS..self.regression.regressors() - 1;
        let after = after.scaled(commands, factor);
        with_step(&before.plus(&after, 1.0), &after)
    }

    /// Where a change of a level is looked for.
    fn of_all(&self) -> (usize, &[usize], usize) {
        (LEVEL_EDGE, &self.wild, self.apart(self.regression.rows))
    }

    /// The likeliest offset.
    pub(super) fn offset(&self) -> Option<Likely> {
        self.placed(1.0, self.of_all(), &|row| {
            self.nats(fitted(&self.of_level(row, 1.0)).rest_square())
        })
    }

    /// Regression with a level that changes at a row: coefficients, the step's last.
    pub(super) fn solution(&self, row: usize, factor: f64) -> Vec<f64> {
        fitted(&self.of_level(row, factor)).coefficients().to_vec()
    }

    /// The likeliest gain.
    pub(super) fn gain(&self) -> Option<Likely> {
        let found = GAIN_FACTORS.iter().filter_map(|&factor| {
            self.placed(factor, self.of_all(), &|row| {
                self.nats(fitted(&self.of_level(row, factor)).rest_square())
            })
        });
        let best = found.max_by(|a, b| a.nats.total_cmp(&b.nats))?;
        // between the factors by halving its logarithm's step
        let (mut size, mut nats, mut step) = (best.size.ln(), best.nats, 0.35);
        for _ in 0..12 {
            let mut has_moved = false;
            for next in [size + step, size - step] {
                let squares = fitted(&self.of_level(best.rows[1], next.exp())).rest_square();
                if self.nats(squares) > nats {
                    (size, nats, has_moved) = (next, self.nats(squares), true);
                    break;
                }
            }
            if !has_moved {
                step *= 0.5;
            }
        }
        Some(Likely {
            nats,
            size: size.exp(),
            ..best
        })
    }
}
