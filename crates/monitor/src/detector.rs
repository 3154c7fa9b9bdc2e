//! Evidence that means have moved: a mixture of Shiryaev-Roberts sums, whose rate of false alarms has a bound.

use crate::reference::Reference;

/// Shifts that the sums are tuned to, in standard deviations of a block.
pub const RATES: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];
/// Largest exponent of one block: more would overflow, and is an alarm anyway.
const MOST: f64 = 300.0;

/// Sums of one component: a mean that rose, one that fell, a size that grew.
const SIDES: usize = 3;
/// Weights of the sides: means and sizes share evenly.
const SIDE_WEIGHTS: [f64; SIDES] = [0.25, 0.25, 0.5];

/// A mixture of Shiryaev-Roberts sums `M = (1 + M) e` over components, sides and tuned shifts. While nothing changes each `e`
/// has an expectation of at most 1, so the expectation of the mixture grows by at most 1 a block (docs/equations.md, A
/// calibration that is watched).
#[derive(Debug, Clone, PartialEq)]
pub struct Detector {
    sums: Vec<f64>,
    components: usize,
    /// Share of each component.
    share: f64,
}

impl Detector {
    /// Sums at zero.
    pub fn new(reference: &Reference) -> Self {
        let components = reference.features.len();
        let judged = reference.features.iter().flatten().count();
        Self {
            sums: vec![0.0; components * SIDES * RATES.len()],
            components,
            share: 1.0 / judged.max(1) as f64,
        }
    }

    /// Takes a block's standardised features `[mean, size]`, component by component; none of one without enough readings.
    /// `scaled` is the root of the share of its rows that have readings.
    pub fn push(&mut self, reference: &Reference, block: &[Option<[f64; 2]>]) {
        let own = self.sums.chunks_exact_mut(SIDES * RATES.len());
        for ((sums, features), values) in own.zip(&reference.features).zip(block) {
            let (Some([mean, size]), Some([of_mean, of_size])) = (values, features) else {
                continue;
            };
            let sides = [(*mean, of_mean), (-*mean, of_mean), (*size, of_size)];
            for ((value, feature), sums) in
                sides.into_iter().zip(sums.chunks_exact_mut(RATES.len()))
            {
                let beyond = (value - feature.margin) / feature.widened;
                for (sum, rate) in sums.iter_mut().zip(RATES) {
                    let exponent = (rate * beyond - 0.5 * rate * rate).min(MOST);
                    *sum = (1.0 + *sum) * exponent.exp();
                }
            }
        }
    }

    /// The mixture: its expectation is at most the number of blocks since the start while nothing changes.
    pub fn evidence(&self) -> f64 {
        (0..self.components)
            .map(|component| self.of(component))
            .sum()
    }

    /// A component's share of the mixture.
    ///
    /// # Panics
    /// If there is no such component.
    pub fn of(&self, component: usize) -> f64 {
        let width = SIDES * RATES.len();
        let own = &self.sums[component * width..(component + 1) * width];
        let sides = own.chunks_exact(RATES.len()).zip(SIDE_WEIGHTS);
        let sides = sides.map(|(sums, weight)| weight * sums.iter().sum::<f64>());
        self.share * sides.sum::<f64>() / RATES.len() as f64
    }

    /// Blocks until the evidence is `wanted` where the mean of one component is one standard deviation beyond its margin: the
    /// logarithm of the sum that is tuned to it grows by half a block.
    pub fn blocks_until(&self, wanted: f64) -> u64 {
        let weight = self.share * SIDE_WEIGHTS[0] / RATES.len() as f64;
        (2.0 * (wanted / weight).ln()).ceil().max(1.0) as u64
    }

    /// Starts anew.
    pub fn reset(&mut self) {
        self.sums.fill(0.0);
    }
}
