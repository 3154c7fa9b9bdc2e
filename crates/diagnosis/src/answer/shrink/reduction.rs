//! Share of the gap that is closed on unseen rows, channel by channel, with its interval.

use haptical_calibration::Channel;
use haptical_metrics::{Bootstrap, gap_reduction_percent};

use crate::answer::{Floor, HeldOutAnswer, Left, NoReduction, SecondChannel};
use crate::engine::Engine;
use crate::thresholds::answer::ALL_PERCENT;
use crate::thresholds::recording::BOOTSTRAP_BLOCK_ROWS;
use crate::thresholds::second::ALLOWED;

/// Seed of the moving-block bootstrap behind the intervals of a reduction.
pub const BOOTSTRAP_SEED: u64 = 1;

/// Residuals of one channel on unseen rows, without and with the causes.
#[derive(Debug, Clone)]
pub(crate) struct Unseen {
    pub(crate) channel: Channel,
    unit: &'static str,
    before: Vec<f64>,
    after: Vec<f64>,
    floor: Floor,
    /// Independent readings in one, the noise's colour allowed for.
    independent: f64,
    /// Mean variance of the predictions by the error of the fit, over that of noise.
    leverage: f64,
}

/// Residuals on the rows (of a stream) that have a leverage, channel by channel.
pub(super) fn collect(
    engine: &Engine<'_>,
    leverage: &dyn Fn(usize, usize) -> Option<f64>,
    before: &[Vec<f64>],
    after: &[Vec<f64>],
) -> Vec<Unseen> {
    let streams = &engine.context.streams;
    let mut channels: Vec<Unseen> = Vec::new();
    for (index, stream) in streams.iter().enumerate() {
        let rows = (0..before[index].len()).filter_map(|row| Some((row, leverage(index, row)?)));
        let (rows, leverages): (Vec<usize>, Vec<f64>) = rows.unzip();
        let pick = |residual: &[f64]| rows.iter().map(|&row| residual[row]).collect::<Vec<f64>>();
        let entry = Unseen {
            channel: stream.channel,
            unit: stream.unit,
            before: pick(&before[index]),
            after: pick(&after[index]),
            floor: Floor::new(
                stream.channel,
                engine.floor[index],
                2.0 / engine.noise[index].uncertainty.powi(2),
                engine.noise[index].source,
            ),
            independent: engine.noise[index].independent(),
            leverage: leverages.iter().sum::<f64>() / leverages.len().max(1) as f64,
        };
        match channels
            .iter_mut()
            .find(|other| other.channel == entry.channel)
        {
            Some(other) => {
                let (have, more) = (other.before.len() as f64, entry.before.len() as f64);
                if have + more > 0.0 {
                    other.floor.rms = ((other.floor.rms.powi(2) * have
                        + entry.floor.rms.powi(2) * more)
                        / (have + more))
                        .sqrt();
                    other.leverage =
                        (other.leverage * have + entry.leverage * more) / (have + more);
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
    /// Root mean square of what the causes leave, and the number of readings.
    pub(crate) fn left(&self) -> (f64, f64) {
        (rms(&self.after), self.after.len() as f64)
    }

    /// What is left of a second recording, and `of_log` of the log; `of_both`: what one fit of both leaves of the channel, in the first and
    /// in the second.
    pub(crate) fn on_second(&self, of_log: f64, of_both: Option<[Left; 2]>) -> SecondChannel {
        let (rms, count) = self.left();
        let left = Left {
            rms,
            noise: self.floor.ci95()[1],
            readings: count * self.independent,
            error_of_fit: self.leverage,
        };
        let joint = match self.channel {
            Channel::Output { joint } => Some(joint + 1),
            _ => None,
        };
        let name = (self.channel.name(), joint, self.unit);
        SecondChannel::new(name, (left, of_log), ALLOWED, of_both)
    }

    /// The noise on these rows.
    pub(crate) fn floor(&self) -> &Floor {
        &self.floor
    }

    /// Takes the floor that all that is left allows, where its own is above it beyond chance.
    pub(crate) fn correct(&mut self, floor: &Floor) {
        let (left, count) = self.left();
        let freedom = count * self.independent;
        if self.floor.is_above(left, freedom) || floor.is_another {
            self.floor = floor.clone();
            self.floor.is_contradicted |= floor.is_above(left, freedom);
        }
    }

    /// Root mean squares, closed share and its 95 % interval: moving blocks of rows and the
    /// uncertainty of the noise floor. No share where less is left than the floor beyond chance, and none that may be
    /// nothing and all: the numbers are there still, for [`HeldOutAnswer::settled`] to take out.
    pub(crate) fn answer(&self) -> HeldOutAnswer {
        let rms_before = rms(&self.before);
        let rms_after = rms(&self.after);
        let reduction = gap_reduction_percent(rms_before, rms_after, self.floor.rms);
        let interval = self.interval(rms_before);
        // a floor that may be as large as all that there was leaves no gap to close
        let most = self.floor.rms.powi(2) * (1.0 + self.spread());
        let says_nothing = most >= rms_before.powi(2)
            || interval.is_some_and(|[low, high]| low <= 0.0 && high >= ALL_PERCENT);
        let no_reduction = match self.floor.why_unknown() {
            None if reduction.is_none() || says_nothing => Some(NoReduction::WithinNoise),
            why_unknown => why_unknown,
        };
        HeldOutAnswer {
            channel: self.channel.name(),
            rms_before,
            rms_after,
            noise_floor: self.floor.rms,
            unit: self.unit.to_owned(),
            reduction_percent: reduction,
            reduction_ci95: interval,
            no_reduction,
        }
    }

    /// Whitened gap before: where a cause shows most.
    pub(crate) fn gap(&self) -> f64 {
        rms(&self.before) / self.floor.rms.max(1e-300)
    }

    /// What the causes take off the whitened residual.
    pub(crate) fn gained(&self) -> f64 {
        let square = rms(&self.before).powi(2) - rms(&self.after).powi(2);
        square / self.floor.rms.max(1e-300).powi(2)
    }

    /// By how much less is left, in standard deviations of what blocks of rows gain.
    pub(crate) fn gain_sd(&self) -> f64 {
        let length = BOOTSTRAP_BLOCK_ROWS.min(self.before.len() / 4).max(1);
        let blocks = self.before.chunks(length).zip(self.after.chunks(length));
        let squares = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>();
        let gains: Vec<f64> = blocks.map(|(a, b)| squares(a) - squares(b)).collect();
        let count = gains.len() as f64;
        let mean = gains.iter().sum::<f64>() / count;
        let variance = gains.iter().map(|gain| (gain - mean).powi(2)).sum::<f64>();
        let sd = (variance / (count - 1.0).max(1.0) / count).sqrt();
        if sd > 0.0 { mean / sd } else { 0.0 }
    }

    /// Half of the 95 % interval of the floor's square, relative.
    fn spread(&self) -> f64 {
        1.96 * (2.0 / self.floor.freedom).sqrt()
    }

    fn interval(&self, rms_before: f64) -> Option<[f64; 2]> {
        if rms_before <= self.floor.rms {
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
        let floor = self.floor.rms.powi(2);
        let spread = self.spread();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::NoiseSource;

    fn unseen(before: f64, after: f64, rms: f64, freedom: f64) -> Unseen {
        let wave = |size: f64| {
            let row = |row: u32| 2.0_f64.sqrt() * size * (1.7 * f64::from(row)).sin();
            (0..400).map(row).collect::<Vec<f64>>()
        };
        Unseen {
            channel: Channel::Position,
            unit: "m",
            before: wave(before),
            after: wave(after),
            floor: Floor::new(Channel::Position, rms, freedom, NoiseSource::Motion),
            independent: 1.0,
            leverage: 0.0,
        }
    }

    /// Three of six second recordings of one device were said to have changed: the log fixed their model no better than that.
    #[test]
    fn the_error_of_the_fit_is_no_gap_of_a_second_recording() {
        let has_gap = |leverage: f64| {
            let seen = Unseen {
                leverage,
                ..unseen(1.3, 1.3, 1.0, 1e6)
            };
            seen.on_second(1.0, None).has_gap
        };
        assert!(has_gap(0.0) && !has_gap(0.4));
    }

    fn corrected(mut unseen: Unseen) -> HeldOutAnswer {
        let (left, count) = unseen.left();
        let mut floor = unseen.floor.clone();
        floor.is_another = floor.is_above(left, count);
        floor.is_contradicted = floor.is_another;
        unseen.correct(&floor);
        unseen.answer().settled()
    }

    /// Real: 38 mm before, 7.7 mm after, a floor of 28.7 mm, and "100 % of the gap closes".
    #[test]
    fn a_rest_below_the_floor_closes_no_share() {
        let answer = corrected(unseen(38.0, 7.7, 28.7, 100.0));
        assert_eq!(answer.reduction_percent, None);
        assert_eq!(answer.no_reduction, Some(NoReduction::FloorContradicted));
    }

    /// Real: "100 % [-41, 100]".
    #[test]
    fn a_share_that_may_be_nothing_and_all_is_none() {
        let answer = corrected(unseen(1.05, 0.98, 1.0, 60.0));
        assert_eq!(answer.reduction_ci95, None);
        assert_eq!(answer.no_reduction, Some(NoReduction::WithinNoise));
    }

    #[test]
    fn a_rest_a_little_below_the_floor_is_noise() {
        let answer = corrected(unseen(5.0, 0.98, 1.0, 400.0));
        assert_eq!(
            (answer.reduction_percent, answer.no_reduction),
            (Some(100.0), None)
        );
    }
}
