//! Local size of the noise: a step function of covariates, where it is uneven.

use std::ops::Range;

use super::group::Group;
use super::least_squares::{GroupSolved, Normal, Products, Scaled};
use super::partition::{Runs, runs};
use super::problem::{OrderedProblem, Uneven};
use super::rows::Rows;

/// Standard deviation of every row, with geometric mean 1 over a group.
pub(super) struct Sizes {
    /// Group by group.
    pub(super) of_group: Vec<Vec<f64>>,
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
        let even = |group: &Group| vec![1.0; group.rows.len()];
        let mut found = Self {
            of_group: rows.groups.iter().map(even).collect(),
            uneven: Vec::new(),
            inflation: 1.0,
        };
        let mut solved = rows.solved(&found.of_group)?;
        for index in 0..rows.groups.len() {
            let signals = problem.signals.iter().zip(&rows.places);
            let mut of_group = signals
                .filter(|(signal, _)| signal.group == index)
                .peekable();
            let Some(&(first, _)) = of_group.peek() else {
                continue;
            };
            let search = Search {
                problem,
                rows,
                index,
                at: &first.at,
                signals: of_group.map(|(_, places)| places.clone()).collect(),
            };
            for _ in 0..MOST {
                let Some(covariate) = search.best(&solved[index], &found.uneven) else {
                    break;
                };
                let Some(step) = search.fit(covariate, &found.of_group) else {
                    break;
                };
                found.uneven.push(Uneven {
                    group: index,
                    covariate,
                    ratio: step.ratio,
                });
                found.inflation += step.meier;
                found.of_group[index] = step.sizes;
                solved = rows.solved(&found.of_group)?;
            }
        }
        Some(found)
    }

    /// The same by row of the problem.
    pub(super) fn by_row(&self, rows: &Rows) -> Vec<f64> {
        let count = self.of_group.iter().map(Vec::len).sum();
        let mut sizes = vec![1.0; count];
        for (group, of_group) in rows.groups.iter().zip(&self.of_group) {
            for (&row, &size) in group.rows.iter().zip(of_group) {
                sizes[row] = size;
            }
        }
        sizes
    }
}

/// The search for sizes of one group.
struct Search<'a> {
    problem: &'a OrderedProblem<'a>,
    rows: &'a Rows,
    index: usize,
    /// Places of each signal's rows in the group.
    signals: Vec<Range<usize>>,
    /// Row of each of a signal's in the covariates.
    at: &'a [usize],
}

struct Step {
    sizes: Vec<f64>,
    ratio: f64,
    meier: f64,
}

impl Search<'_> {
    /// The covariate whose steps explain the squares best; none where an even size does as well.
    fn best(&self, solved: &Scaled, used: &[Uneven]) -> Option<usize> {
        let innovations = self.innovations(&solved.residuals);
        let is_used = |covariate: usize| {
            let mut used = used.iter();
            used.any(|uneven| uneven.group == self.index && uneven.covariate == covariate)
        };
        let gains = (0..self.problem.covariates.len())
            .filter(|&covariate| !is_used(covariate))
            .filter_map(|covariate| {
                let bins = self.bins(covariate)?;
                let num = self.squares(&bins, &innovations, &|_| 1.0);
                let den = self.rooms(&bins, &solved.rooms);
                Some((covariate, self.runs(&num, &den).gain))
            });
        let best = gains.max_by(|one, other| one.1.total_cmp(&other.1));
        best.filter(|(_, gain)| *gain > (self.at.len() as f64).ln())
            .map(|(covariate, _)| covariate)
    }

    fn runs(&self, num: &[f64], den: &[f64]) -> Runs {
        let rows = self.at.len() as f64;
        runs(num, den, PENALTY * rows.ln(), LEAST_OF_RUN)
    }

    /// Sizes by runs of one covariate's bins, in turns with weighted fits; none where one run remains.
    fn fit(&self, covariate: usize, base: &[Vec<f64>]) -> Option<Step> {
        let bins = self.bins(covariate)?;
        let mut factors = vec![1.0; bins.count];
        let mut bounds = Vec::new();
        let mut den = Vec::new();
        let group = &self.rows.groups[self.index];
        let others = self.others(base);
        let base = &base[self.index];
        let of_bins = self.products(&bins, base);
        for _ in 0..TURNS {
            let solved = Self::solved(group, &others, (&of_bins, &factors))?;
            let sizes = self.times(base, &bins, &factors);
            let innovations = self.innovations(&solved.scaled_residuals(group, &sizes));
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
        let mut sizes = self.times(base, &bins, &factors);
        let mean = (sizes.iter().map(|size| size.ln()).sum::<f64>() / sizes.len() as f64).exp();
        sizes.iter_mut().for_each(|size| *size /= mean);
        Some(Step {
            sizes,
            ratio: largest / smallest,
            meier: bounds.windows(2).map(meier).sum(),
        })
    }

    /// The fit with bins of the group that are so many times louder.
    fn solved(
        group: &Group,
        others: &Normal,
        (bins, factors): (&[Products], &[f64]),
    ) -> Option<GroupSolved> {
        let mut louder = bins.first()?.none();
        for (bin, factor) in bins.iter().zip(factors) {
            louder.add(bin, *factor);
        }
        let mut all = others.clone();
        all.add(group, &louder);
        Some(all.solved()?.of_group(group))
    }

    fn times(&self, base: &[f64], bins: &Bins, factors: &[f64]) -> Vec<f64> {
        let mut sizes = base.to_vec();
        for places in &self.signals {
            for (size, &bin) in sizes[places.clone()].iter_mut().zip(&bins.of_place) {
                *size *= factors[bin];
            }
        }
        sizes
    }

    /// Residuals less what the row before predicts. The correlation is by signs, which do not depend on sizes: the arcsine
    /// law of normal numbers.
    fn innovations(&self, residuals: &[f64]) -> Vec<Vec<f64>> {
        let (mut agree, mut pairs) = (0.0, 0.0_f64);
        for places in &self.signals {
            for pair in residuals[places.clone()].windows(2) {
                agree += (pair[0] * pair[1]).signum();
                pairs += 1.0;
            }
        }
        let correlation = (agree / pairs.max(1.0)).clamp(0.0, MOST_CORRELATED);
        let next = (std::f64::consts::FRAC_PI_2 * correlation).sin();
        let scale = (1.0 - next * next).sqrt();
        let of_signal = |places: &Range<usize>| {
            let of_signal = &residuals[places.clone()];
            let first = of_signal.first().copied();
            let others = of_signal
                .windows(2)
                .map(|pair| (pair[1] - next * pair[0]) / scale);
            first.into_iter().chain(others).collect()
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
        for places in &self.signals {
            for (room, &bin) in rooms[places.clone()].iter().zip(&bins.of_place) {
                sums[bin] += room;
            }
        }
        sums
    }

    /// Normal equations of the other groups' rows.
    fn others(&self, sizes: &[Vec<f64>]) -> Normal {
        let mut others = Normal::new(self.rows.parameters());
        for (index, (group, sizes)) in self.rows.groups.iter().zip(sizes).enumerate() {
            if index != self.index {
                others.add(group, &group.products(0..sizes.len(), sizes));
            }
        }
        others
    }

    /// Products of each bin.
    fn products(&self, bins: &Bins, sizes: &[f64]) -> Vec<Products> {
        let mut of_bins = vec![Vec::new(); bins.count];
        for places in &self.signals {
            for (place, &bin) in places.clone().zip(&bins.of_place) {
                of_bins[bin].push(place);
            }
        }
        let group = &self.rows.groups[self.index];
        let products = of_bins.into_iter();
        products
            .map(|places| group.products(places.into_iter(), sizes))
            .collect()
    }

    /// Bins of a covariate with equally many rows; none of one that does not move.
    fn bins(&self, covariate: usize) -> Option<Bins> {
        let values = &self.problem.covariates[covariate];
        let values: Option<Vec<f64>> = (self.at.iter())
            .map(|&row| values.get(row).copied())
            .collect();
        let values = values.filter(|values| values.iter().all(|value| value.is_finite()))?;
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        let (first, last) = (values[*order.first()?], values[*order.last()?]);
        if last <= first {
            return None;
        }
        let count = (values.len() / ROWS_OF_BIN).clamp(BINS[0], BINS[1]);
        let mut of_place = vec![0; values.len()];
        for (rank, &place) in order.iter().enumerate() {
            of_place[place] = rank * count / values.len();
        }
        Some(Bins { of_place, count })
    }
}

struct Bins {
    of_place: Vec<usize>,
    count: usize,
}
