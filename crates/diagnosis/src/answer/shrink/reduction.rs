//! Share of the gap that is closed on unseen rows, channel by channel, with its interval.

use haptical_calibration::Channel;
use haptical_metrics::{Bootstrap, gap_reduction_percent};

use crate::answer::HeldOutAnswer;
use crate::engine::Engine;
use crate::thresholds::recording::BOOTSTRAP_BLOCK_ROWS;

/// Seed of the moving-block bootstrap behind the intervals of a reduction.
pub const BOOTSTRAP_SEED: u64 = 1;

/// Residuals of one channel on unseen rows, without and with the causes.
#[derive(Debug, Clone)]
pub(crate) struct Unseen {
    pub(crate) channel: Channel,
    unit: &'static str,
    before: Vec<f64>,
    after: Vec<f64>,
    floor: f64,
    /// Relative standard deviation of the floor's square.
    floor_uncertainty: f64,
}

/// Residuals on the `wanted` rows (of a stream), channel by channel.
pub(super) fn collect(
    engine: &Engine<'_>,
    wanted: &dyn Fn(usize, usize) -> bool,
    before: &[Vec<f64>],
    after: &[Vec<f64>],
) -> Vec<Unseen> {
    let streams = &engine.context.streams;
    let mut channels: Vec<Unseen> = Vec::new();
    for (index, stream) in streams.iter().enumerate() {
        let rows: Vec<usize> = (0..before[index].len())
            .filter(|&row| wanted(index, row))
            .collect();
        let pick = |residual: &[f64]| rows.iter().map(|&row| residual[row]).collect::<Vec<f64>>();
        let entry = Unseen {
            channel: stream.channel,
            unit: stream.unit,
            before: pick(&before[index]),
            after: pick(&after[index]),
            floor: engine.floor[index],
            floor_uncertainty: engine.noise[index].uncertainty,
        };
        match channels
            .iter_mut()
            .find(|other| other.channel == entry.channel)
        {
            Some(other) => {
                let (have, more) = (other.before.len() as f64, entry.before.len() as f64);
                if have + more > 0.0 {
                    other.floor = ((other.floor.powi(2) * have + entry.floor.powi(2) * more)
                        / (have + more))
                        .sqrt();
                }
                other.before.extend(entry.before);
                other.after.extend(entry.after);
            }
            None => channels.push(entry),
        }
    }
    channels.retain(|channel| channel.before.len() >= 8);
    channels
}

impl Unseen {
    /// Root mean squares, closed share and its 95 % interval: moving blocks of rows and the
    /// uncertainty of the noise floor.
    pub(crate) fn answer(&self) -> HeldOutAnswer {
        let rms_before = rms(&self.before);
        let rms_after = rms(&self.after);
        HeldOutAnswer {
            channel: self.channel.name(),
            rms_before,
            rms_after,
            noise_floor: self.floor,
            unit: self.unit.to_owned(),
            reduction_percent: gap_reduction_percent(rms_before, rms_after, self.floor),
            reduction_ci95: self.interval(rms_before),
        }
    }

    /// Whitened gap before: where a cause shows most.
    pub(crate) fn gap(&self) -> f64 {
        rms(&self.before) / self.floor.max(1e-300)
    }

    /// What the causes take off the whitened residual.
    pub(crate) fn gained(&self) -> f64 {
        let square = rms(&self.before).powi(2) - rms(&self.after).powi(2);
        square / self.floor.max(1e-300).powi(2)
    }

    fn interval(&self, rms_before: f64) -> Option<[f64; 2]> {
        if rms_before <= self.floor {
            return None;
        }
        let bootstrap = Bootstrap {
            replicates: 400,
            seed: BOOTSTRAP_SEED,
            level: 0.95,
            block_length: BOOTSTRAP_BLOCK_ROWS.min(self.before.len() / 4).max(1),
        };
        // q = (after^2 - floor^2) / (before^2 - floor^2), the share of the square that is left
        let left = |rows: &[usize], floor_square: f64| {
            let before = rms_on(&self.before, rows).powi(2) - floor_square;
            let after = rms_on(&self.after, rows).powi(2) - floor_square;
            (before > 0.0).then(|| after / before)
        };
        let floor = self.floor.powi(2);
        let spread = 1.96 * self.floor_uncertainty;
        let ends = |floor_square: f64| {
            bootstrap
                .interval(self.before.len(), |rows| left(rows, floor_square))
                .ok()
        };
        let middle = ends(floor)?;
        let all: Vec<usize> = (0..self.before.len()).collect();
        let here = left(&all, floor)?;
        let by_floor = |sign: f64| left(&all, floor * (1.0 + sign * spread));
        let (low, high) = (
            by_floor(1.0).unwrap_or(here),
            by_floor(-1.0).unwrap_or(here),
        );
        // both spreads in quadrature on either side
        let most = here + (middle.high - here).max(0.0).hypot((high - here).max(0.0));
        let least = here - (here - middle.low).max(0.0).hypot((here - low).max(0.0));
        let percent = |left: f64| 100.0 * (1.0 - left.max(0.0).sqrt());
        Some([percent(most), percent(least)])
    }
}

fn rms(values: &[f64]) -> f64 {
    root_mean(values.iter().map(|value| value * value))
}

fn rms_on(values: &[f64], rows: &[usize]) -> f64 {
    root_mean(rows.iter().map(|&row| values[row] * values[row]))
}

fn root_mean(squares: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = squares.len().max(1) as f64;
    (squares.sum::<f64>() / count).sqrt()
}
