//! The noise's spectrum from the residuals', with what the fit moved between the bands put back.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use super::bands::SignalBands;
use super::fitted::{Fitted, LEAST_SHARE};
use super::nnls::nnls;
use super::problem::Signal;
use super::rows::{Rows, as_matrix};
use crate::component::Component;

/// Power of the noise in the bands of all signals.
pub(super) struct Unmixed {
    /// Products of each band with orthonormal unknowns.
    products: Vec<DMatrix<f64>>,
    /// Those of what the fit leaves: readings, then held parameters.
    left: Vec<DMatrix<f64>>,
    /// Power by band.
    power: Vec<f64>,
    /// Level of each band: bands of equal power share one.
    level: Vec<usize>,
    /// Degrees of freedom of each level.
    freedom: Vec<f64>,
    /// Whether the power differs between bands beyond chance.
    pub(super) memory: bool,
    /// The same of each signal.
    of_signal: Vec<bool>,
}

/// Chance that noise without memory counts as having one.
const LEVEL: f64 = 0.10;
/// Least degrees of freedom of a band that the fit leaves next to nothing of, and of a level.
const LEAST_OF_BAND: f64 = 0.1;
const LEAST_OF_LEVEL: f64 = 0.5;
/// Weighted turns of the spectrum.
const TURNS: usize = 3;
/// Share of the largest power below which a step of the spectrum is rounding, and power that weights assume at least.
const NO_STEP: f64 = 1e-9;
const LEAST_POWER: f64 = 1e-3;

impl Unmixed {
    pub(super) fn new(fitted: &Fitted, bands: &[SignalBands], rows: &Rows) -> Self {
        let (mut products, mut lefts) = (Vec::new(), Vec::new());
        let (mut powers, mut modes) = (Vec::new(), Vec::new());
        let held = rows.held();
        let mut ends = Vec::new();
        for (signal, &line) in bands.iter().zip(&fitted.line_of_signal) {
            for (gram, count) in signal.grams.iter().zip(&signal.modes) {
                let [product, left] = fitted.band(gram, line);
                let power = left[(0, 0)].max(0.0);
                let leaked = rows.leaked(&left.view((1, 1), (held, held)).into_owned());
                products.push(product);
                powers.push((power - leaked).max(LEAST_SHARE * power));
                lefts.push(left);
                modes.push(*count);
            }
            ends.push(products.len());
        }
        let room: Vec<f64> = modes
            .iter()
            .zip(&products)
            .map(|(modes, product)| (modes - product.trace()).max(LEAST_OF_BAND))
            .collect();
        let (memory, of_signal) = tested(&powers, &room, &ends);
        let count = products.len();
        let mut mixing = DMatrix::zeros(count, count);
        for a in 0..count {
            for b in a..count {
                let shared = products[a].dot(&products[b]);
                mixing[(a, b)] = shared;
                mixing[(b, a)] = shared;
            }
            mixing[(a, a)] += modes[a] - 2.0 * products[a].trace();
        }
        let power = spectrum(&mixing, &powers, &room, &ends);
        let largest = power.iter().copied().fold(0.0, f64::max);
        let mut level = vec![0; count];
        for band in 1..count {
            let is_next = ends.contains(&band) || power[band - 1] - power[band] > NO_STEP * largest;
            level[band] = level[band - 1] + usize::from(is_next);
        }
        let mut freedom = vec![0.0; level.last().map_or(0, |last| last + 1)];
        for band in 0..count {
            freedom[level[band]] += mixing[(band, band)];
        }
        freedom
            .iter_mut()
            .for_each(|freedom| *freedom = freedom.max(LEAST_OF_LEVEL));
        Self {
            products,
            left: lefts,
            power,
            level,
            freedom,
            memory,
            of_signal,
        }
    }

    /// Covariance of the parameters, level by level.
    pub(super) fn components(&self, fitted: &Fitted, rows: &Rows) -> Vec<Component> {
        let way = fitted.to_parameters(rows);
        let levels = self.freedom.iter().enumerate().map(|(level, &freedom)| {
            let mut inner = DMatrix::zeros(fitted.unknowns(), fitted.unknowns());
            for (band, product) in self.products.iter().enumerate() {
                if self.level[band] == level {
                    inner += product * self.power[band];
                }
            }
            Component {
                covariance: as_matrix(&(&way * inner * way.transpose())),
                degrees_of_freedom: freedom,
            }
        });
        levels.collect()
    }

    /// Products of what the fit leaves, over the held parameters: their sum, and the sum by the noise's power.
    pub(super) fn of_held(&self, variance: f64) -> [DMatrix<f64>; 2] {
        let count = self.left.first().map_or(0, DMatrix::nrows);
        let mut sums = [DMatrix::zeros(count, count), DMatrix::zeros(count, count)];
        for (left, power) in self.left.iter().zip(&self.power) {
            let power = if self.memory { *power } else { variance };
            sums[1] += left * power;
            sums[0] += left;
        }
        sums
    }

    /// Groups with a signal that shows memory; all of them where only the sum shows it.
    pub(super) fn correlated(&self, signals: &[Signal]) -> Vec<usize> {
        let any = self.of_signal.iter().any(|shows| *shows);
        let own = signals.iter().zip(&self.of_signal);
        let mut groups: Vec<usize> = own
            .filter(|(_, shows)| self.memory && (**shows || !any))
            .map(|(signal, _)| signal.group)
            .collect();
        groups.dedup();
        groups
    }
}

/// Whether the power by degree of freedom is the same in all bands of a signal (Bartlett's test), for all signals together
/// and for each.
fn tested(powers: &[f64], room: &[f64], ends: &[usize]) -> (bool, Vec<bool>) {
    let (mut statistic, mut freedom) = (0.0, 0.0);
    let mut of_signal = Vec::new();
    let mut first = 0;
    for &end in ends {
        let own: Vec<usize> = (first..end).filter(|&band| room[band] > 1.0).collect();
        first = end;
        let power: f64 = own.iter().map(|&band| powers[band]).sum();
        let all: f64 = own.iter().map(|&band| room[band]).sum();
        let mean = power / all;
        let each = own.iter().map(|&band| {
            let ratio = powers[band].max(f64::MIN_POSITIVE) / room[band] / mean;
            -room[band] * ratio.ln()
        });
        let (own_statistic, own_freedom) = (each.sum::<f64>(), own.len() as f64 - 1.0);
        of_signal.push(exceeds(own_statistic, own_freedom));
        if own_freedom > 0.0 {
            statistic += own_statistic;
            freedom += own_freedom;
        }
    }
    (exceeds(statistic, freedom), of_signal)
}

fn exceeds(statistic: f64, freedom: f64) -> bool {
    freedom >= 1.0
        && ChiSquared::new(freedom).is_ok_and(|spread| statistic > spread.inverse_cdf(1.0 - LEVEL))
}

/// Power by band that does not grow with frequency, by the powers that the fit left: E left = mixing power (MINQUE of Rao
/// 1971), in weighted least squares over steps that are not negative.
fn spectrum(mixing: &DMatrix<f64>, left: &[f64], room: &[f64], ends: &[usize]) -> Vec<f64> {
    let count = left.len();
    let first_of = |band: usize| {
        ends.iter()
            .rev()
            .find(|&&end| end <= band)
            .copied()
            .unwrap_or(0)
    };
    // a step at band k raises all bands of its signal up to k
    let steps = DMatrix::from_fn(count, count, |row, step| {
        (first_of(step)..=step)
            .map(|band| mixing[(row, band)])
            .sum::<f64>()
    });
    let mut fit: Vec<f64> = left
        .iter()
        .zip(room)
        .map(|(left, room)| left / room)
        .collect();
    let mut power = fit.clone();
    for _ in 0..TURNS {
        let largest = fit.iter().copied().fold(0.0, f64::max);
        if largest <= 0.0 {
            break;
        }
        let weight: Vec<f64> = fit
            .iter()
            .zip(room)
            .map(|(fit, room)| 1.0 / (room.sqrt() * fit.max(LEAST_POWER * largest)))
            .collect();
        let weighted = DMatrix::from_fn(count, count, |row, step| steps[(row, step)] * weight[row]);
        let rhs = DVector::from_fn(count, |row, _| left[row] * weight[row]);
        let found = nnls(&weighted, &rhs);
        let mut above = 0.0;
        for band in (0..count).rev() {
            if ends.contains(&(band + 1)) {
                above = 0.0;
            }
            above += found[band];
            power[band] = above;
        }
        for band in 0..count {
            let expected: f64 = (0..count).map(|k| mixing[(band, k)] * power[k]).sum();
            fit[band] = expected / room[band];
        }
    }
    power
}
