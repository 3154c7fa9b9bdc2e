//! Local size of the noise: a step function of covariates, where it is uneven.

use super::partition::{Runs, runs};
use super::problem::{OrderedProblem, Signal, Uneven};
use super::rows::{Products, Rows};

/// Standard deviation of every row, with geometric mean 1 over a group.
pub(super) struct Sizes {
    pub(super) of_row: Vec<f64>,
    pub(super) uneven: Vec<Uneven>,
    /// Factor on variances, as the weights were estimated (Meier 1953, Biometrics 9).
    pub(super) inflation: f64,
}

/// Bins of a covariate hold so many rows at least, and there are so many of them.
const ROWS_OF_BIN: usize = 8;
const BINS: [usize; 2] = [4, 64];
/// Degrees of freedom of a run, and its penalty over the logarithm of the rows.
const LEAST_OF_RUN: f64 = 8.0;
const PENALTY: f64 = 3.0;
/// Covariates that the size may depend on at once.
const MOST: usize = 2;
/// Largest size over the smallest, of one covariate. Beyond, a few rows that the fit follows ever closer have taken all weight.
const MOST_RATIO: f64 = 100.0;
/// Weighted fits in turn with sizes.
const TURNS: usize = 5;
/// Largest correlation of successive rows that innovations allow for.
const MOST_CORRELATED: f64 = 0.99;

impl Sizes {
    pub(super) fn find(problem: &OrderedProblem<'_>, rows: &Rows) -> Option<Self> {
        let count = problem.residuals.len();
        let mut found = Self {
            of_row: vec![1.0; count],
            uneven: Vec::new(),
            inflation: 1.0,
        };
        let groups = problem.signals.iter().map(|signal| signal.group + 1).max();
        let mut pieces = rows.scaled_residuals(&found.of_row)?;
        for group in 0..groups.unwrap_or(0) {
            let signals: Vec<&Signal> = problem
                .signals
                .iter()
                .filter(|signal| signal.group == group)
                .collect();
            let Some(own) = signals.first().map(|signal| signal.rows.len()) else {
                continue;
            };
            for _ in 0..MOST {
                let search = Search {
                    problem,
                    rows,
                    signals: &signals,
                    count: own,
                };
                let Some(covariate) = search.best(&pieces, &found.uneven) else {
                    break;
                };
                let Some(step) = search.fit(covariate, &found.of_row) else {
                    break;
                };
                found.uneven.push(Uneven {
                    group,
                    covariate,
                    ratio: step.ratio,
                });
                found.inflation += step.meier;
                found.of_row = step.of_row;
                pieces = rows.scaled_residuals(&found.of_row)?;
            }
        }
        Some(found)
    }
}

struct Search<'a> {
    problem: &'a OrderedProblem<'a>,
    rows: &'a Rows,
    signals: &'a [&'a Signal],
    /// Rows of each signal.
    count: usize,
}

struct Step {
    of_row: Vec<f64>,
    ratio: f64,
    meier: f64,
}

impl Search<'_> {
    /// The covariate whose steps explain the squares best; none where an even size does as well.
    fn best(&self, pieces: &(Vec<f64>, Vec<f64>), used: &[Uneven]) -> Option<usize> {
        let innovations = self.innovations(&pieces.0);
        let group = self.signals[0].group;
        let is_used = |covariate: usize| {
            let mut used = used.iter();
            used.any(|uneven| uneven.group == group && uneven.covariate == covariate)
        };
        let gains = (0..self.problem.covariates.len())
            .filter(|&covariate| !is_used(covariate))
            .filter_map(|covariate| {
                let bins = self.bins(covariate)?;
                let num = self.squares(&bins, &innovations, &|_| 1.0);
                let den = self.rooms(&bins, &pieces.1);
                Some((covariate, self.runs(&num, &den).gain))
            });
        let best = gains.max_by(|one, other| one.1.total_cmp(&other.1));
        best.filter(|(_, gain)| *gain > (self.count as f64).ln())
            .map(|(covariate, _)| covariate)
    }

    fn runs(&self, num: &[f64], den: &[f64]) -> Runs {
        runs(num, den, PENALTY * (self.count as f64).ln(), LEAST_OF_RUN)
    }

    /// Sizes by runs of one covariate's bins, in turns with weighted fits; none where one run remains.
    fn fit(&self, covariate: usize, base: &[f64]) -> Option<Step> {
        let bins = self.bins(covariate)?;
        let mut factors = vec![1.0; bins.count];
        let mut bounds = Vec::new();
        let mut den = Vec::new();
        let (others, of_bins) = self.products(&bins, base);
        for _ in 0..TURNS {
            let mut all = others.clone();
            for (bin, factor) in of_bins.iter().zip(&factors) {
                all.add(bin, *factor);
            }
            let solved = all.solved()?;
            let sizes = self.times(base, &bins, &factors);
            let innovations = self.innovations(&solved.scaled_residuals(self.rows, &sizes));
            let num = self.squares(&bins, &innovations, &|bin| factors[bin]);
            let rooms = of_bins.iter().zip(&factors);
            den = rooms
                .map(|(bin, factor)| bin.room(&solved, *factor))
                .collect();
            bounds = self.runs(&num, &den).bounds;
            for pair in bounds.windows(2) {
                let own = pair[0]..pair[1];
                let square: f64 = num[own.clone()].iter().sum();
                let freedom: f64 = den[own.clone()].iter().sum();
                let size = (square / freedom).sqrt();
                if !(size > 0.0 && size.is_finite()) {
                    return None;
                }
                factors[own].fill(size);
            }
        }
        let largest = factors.iter().copied().fold(0.0, f64::max);
        let smallest = factors.iter().copied().fold(f64::INFINITY, f64::min);
        if bounds.len() < 3 || largest > MOST_RATIO * smallest {
            return None;
        }
        let mut shares = vec![0.0; bins.count];
        for &bin in &bins.of_place {
            shares[bin] += 1.0 / (factors[bin] * factors[bin]);
        }
        let all: f64 = shares.iter().sum();
        let meier = |pair: &[usize]| {
            let share: f64 = shares[pair[0]..pair[1]].iter().sum::<f64>() / all;
            let freedom: f64 = den[pair[0]..pair[1]].iter().sum();
            4.0 * share * (1.0 - share) / freedom
        };
        let mut of_row = self.times(base, &bins, &factors);
        let own = self.signals.iter().flat_map(|signal| &signal.rows);
        let (logs, rows) = own.fold((0.0, 0), |(sum, rows), &row| {
            (sum + of_row[row].ln(), rows + 1)
        });
        let mean = (logs / f64::from(rows)).exp();
        for signal in self.signals {
            signal.rows.iter().for_each(|&row| of_row[row] /= mean);
        }
        Some(Step {
            of_row,
            ratio: largest / smallest,
            meier: bounds.windows(2).map(meier).sum(),
        })
    }

    fn times(&self, base: &[f64], bins: &Bins, factors: &[f64]) -> Vec<f64> {
        let mut sizes = base.to_vec();
        for signal in self.signals {
            for (&row, &bin) in signal.rows.iter().zip(&bins.of_place) {
                sizes[row] *= factors[bin];
            }
        }
        sizes
    }

    /// Residuals less what the row before predicts. The correlation is by signs, which do not depend on sizes: the arcsine
    /// law of normal numbers.
    fn innovations(&self, residuals: &[f64]) -> Vec<Vec<f64>> {
        let (mut agree, mut pairs) = (0.0, 0.0_f64);
        for signal in self.signals {
            for pair in signal.rows.windows(2) {
                agree += (residuals[pair[0]] * residuals[pair[1]]).signum();
                pairs += 1.0;
            }
        }
        let correlation = (agree / pairs.max(1.0)).clamp(0.0, MOST_CORRELATED);
        let next = (std::f64::consts::FRAC_PI_2 * correlation).sin();
        let scale = (1.0 - next * next).sqrt();
        let of_signal = |signal: &&Signal| {
            let each = (0..signal.rows.len()).map(|place| {
                let own = residuals[signal.rows[place]];
                match place.checked_sub(1) {
                    None => own,
                    Some(before) => (own - next * residuals[signal.rows[before]]) / scale,
                }
            });
            each.collect()
        };
        self.signals.iter().map(of_signal).collect()
    }

    /// Sums of squares by bin.
    fn squares(
        &self,
        bins: &Bins,
        innovations: &[Vec<f64>],
        factor: &dyn Fn(usize) -> f64,
    ) -> Vec<f64> {
        let mut sums = vec![0.0; bins.count];
        for innovations in innovations {
            for (place, &bin) in bins.of_place.iter().enumerate() {
                sums[bin] += (innovations[place] * factor(bin)).powi(2);
            }
        }
        sums
    }

    /// Sums of degrees of freedom by bin.
    fn rooms(&self, bins: &Bins, rooms: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; bins.count];
        for signal in self.signals {
            for (row, &bin) in signal.rows.iter().zip(&bins.of_place) {
                sums[bin] += rooms[*row];
            }
        }
        sums
    }

    /// Normal equations of the rows of other groups, and of each bin, with sizes `base`.
    fn products(&self, bins: &Bins, base: &[f64]) -> (Products, Vec<Products>) {
        let mut of_bins = vec![Vec::new(); bins.count];
        let mut is_own = vec![false; base.len()];
        for signal in self.signals {
            for (&row, &bin) in signal.rows.iter().zip(&bins.of_place) {
                of_bins[bin].push(row);
                is_own[row] = true;
            }
        }
        let others: Vec<usize> = (0..base.len()).filter(|&row| !is_own[row]).collect();
        let of = |rows: &Vec<usize>| self.rows.products(rows, base);
        (of(&others), of_bins.iter().map(of).collect())
    }

    /// Bins of a covariate with equally many rows; none of one that does not move.
    fn bins(&self, covariate: usize) -> Option<Bins> {
        let values = &self.problem.covariates[covariate];
        let own: Option<Vec<f64>> = self.signals[0]
            .at
            .iter()
            .map(|&row| values.get(row).copied())
            .collect();
        let own = own.filter(|own| own.iter().all(|value| value.is_finite()))?;
        let mut order: Vec<usize> = (0..own.len()).collect();
        order.sort_by(|&a, &b| own[a].total_cmp(&own[b]));
        let (first, last) = (own[*order.first()?], own[*order.last()?]);
        if last <= first {
            return None;
        }
        let count = (own.len() / ROWS_OF_BIN).clamp(BINS[0], BINS[1]);
        let mut of_place = vec![0; own.len()];
        for (rank, &place) in order.iter().enumerate() {
            of_place[place] = rank * count / own.len();
        }
        Some(Bins { of_place, count })
    }
}

struct Bins {
    of_place: Vec<usize>,
    count: usize,
}
