//! Axes: their ranges, their ticks and the labels of ticks.

use crate::text::superscript;

/// Most ticks on an axis.
pub(crate) const MOST_TICKS: usize = 7;

/// Numbers below this are drawn as zero: their differences lose digits in a 64-bit float.
const SMALLEST_MAGNITUDE: f64 = 1e-290;

/// A labelled position on an axis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tick {
    pub(crate) value: f64,
    pub(crate) label: String,
}

/// A range of values mapped onto 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Axis {
    low: f64,
    high: f64,
    log: bool,
}

impl Axis {
    /// An axis from `low` to `high`; a logarithmic one needs both above 0.
    pub(crate) fn new(low: f64, high: f64, log: bool) -> Self {
        Self { low, high, log }
    }

    /// An axis that holds all values with a margin at both ends.
    ///
    /// `margin` is a share of the range. `foot` is a value, such as the foot of bars, at which the
    /// axis ends without a margin when no value lies beyond it.
    pub(crate) fn around(
        values: &[f64],
        log: bool,
        margin: f64,
        foot: Option<f64>,
    ) -> Option<Self> {
        let forward = |value: f64| if log { value.log10() } else { value };
        let all = values.iter().copied().chain(foot).map(forward);
        let (mut low, mut high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        });
        if low > high {
            return None;
        }
        let foot = foot.map(forward);
        let (at_low, at_high) = (foot == Some(low), foot == Some(high));
        // A range of rounding errors is drawn as one value, not blown up to fill the plot, and
        // values at the lower end of the number range are drawn as zero.
        let largest = low.abs().max(high.abs());
        let mut room = margin * (high - low);
        if largest < SMALLEST_MAGNITUDE || high - low <= 1e-9 * largest {
            room = if log || largest < SMALLEST_MAGNITUDE {
                0.5
            } else {
                0.05 * largest
            };
        }
        low -= if at_low && !at_high { 0.0 } else { room };
        high += if at_high && !at_low { 0.0 } else { room };
        let back = |value: f64| if log { 10.0_f64.powf(value) } else { value };
        // At the ends of the number range the margin does not fit.
        let lowest = if log { f64::MIN_POSITIVE } else { f64::MIN };
        let bounded = |value: f64| back(value).clamp(lowest, f64::MAX);
        Some(Self {
            low: bounded(low),
            high: bounded(high),
            log,
        })
    }

    pub(crate) fn low(&self) -> f64 {
        self.low
    }

    pub(crate) fn high(&self) -> f64 {
        self.high
    }

    /// Share of the axis, from its lower end, of a value.
    pub(crate) fn share(&self, value: f64) -> f64 {
        // Differences of logarithms and of quarters: quotients and differences of numbers at the ends
        // of the number range are not finite.
        let forward = |v: f64| if self.log { v.log10() } else { 0.25 * v };
        (forward(value) - forward(self.low)) / (forward(self.high) - forward(self.low))
    }

    /// At most `most` labelled ticks.
    pub(crate) fn ticks(&self, most: usize) -> Vec<Tick> {
        if self.log {
            self.log_ticks(most)
        } else {
            self.linear_ticks(most)
        }
    }

    /// Unlabelled positions 2 to 9 of each decade, on a logarithmic axis over a few decades.
    pub(crate) fn minor_ticks(&self) -> Vec<f64> {
        let (first, last) = (
            self.low.log10().floor() as i32,
            self.high.log10().ceil() as i32,
        );
        if !self.log || last - first > 8 {
            return Vec::new();
        }
        let all = (first..last).flat_map(|e| (2..10).map(move |m| f64::from(m) * power_of_ten(e)));
        all.filter(|value| (self.low..=self.high).contains(value))
            .collect()
    }

    fn linear_ticks(&self, most: usize) -> Vec<Tick> {
        let (step, decimals_of_step) = tick_step(self.low, self.high, most);
        // A hair of tolerance keeps a tick that rounding puts just outside the end.
        let first = (self.low / step - 1e-9).ceil() as i64;
        let last = (self.high / step + 1e-9).floor() as i64;
        // More than asked for: only the two ends of them have room.
        let stride = if last - first >= most.max(2) as i64 {
            last - first
        } else {
            1
        };
        let all = (first..=last).step_by(stride.max(1) as usize);
        let values: Vec<f64> = all
            .map(|index| index as f64 * step)
            .filter(|v| v.is_finite())
            .collect();
        let largest = values
            .iter()
            .fold(0.0_f64, |largest, value| largest.max(value.abs()));
        let exponent = if largest > 0.0 {
            largest.log10().floor() as i32
        } else {
            0
        };
        // Whichever is shorter: digits after the point are as many in both forms from 1 upwards.
        let plain = largest == 0.0
            || (largest < 999_999.5 && decimals_of_step <= 4)
            || (exponent >= 0 && decimals_of_step > 0);
        let (shown, decimals) = if plain {
            (0, decimals_of_step)
        } else {
            (exponent, decimals_of_step + exponent)
        };
        let decimals = decimals.clamp(0, 15) as usize;
        let label = |value: f64| {
            if value == 0.0 {
                return "0".to_owned();
            }
            let mantissa = format!("{:.decimals$}", value / power_of_ten(shown));
            if plain {
                mantissa
            } else {
                format!("{mantissa}×10{}", superscript(shown))
            }
        };
        values
            .iter()
            .map(|&value| Tick {
                value,
                label: label(value),
            })
            .collect()
    }

    fn log_ticks(&self, most: usize) -> Vec<Tick> {
        let ends = self.low * (1.0 - 1e-9)..=self.high * (1.0 + 1e-9);
        // at the end of the number range the upper end and the next tick are infinite
        let inside = |value: &f64| value.is_finite() && ends.contains(value);
        let (first, last) = (
            self.low.log10().floor() as i32,
            self.high.log10().ceil() as i32,
        );
        let decades: Vec<i32> = (first..=last)
            .filter(|&e| inside(&power_of_ten(e)))
            .collect();
        if decades.len() < 3 {
            let all = (first..=last).flat_map(|e| [1.0, 2.0, 5.0].map(|m| (m, e)));
            let fine: Vec<(f64, i32)> = all
                .filter(|&(m, e)| inside(&(m * power_of_ten(e))))
                .collect();
            if fine.len() < 3 {
                return self.linear_ticks(most);
            }
            if fine.len() <= most {
                return log_labels(&fine);
            }
        }
        let stride = decades.len().div_ceil(most.max(1)).max(1) as i32;
        let kept = decades
            .into_iter()
            .filter(|exponent| exponent.rem_euclid(stride) == 0);
        let ticks: Vec<(f64, i32)> = kept.map(|exponent| (1.0, exponent)).collect();
        if ticks.is_empty() {
            self.linear_ticks(most)
        } else {
            log_labels(&ticks)
        }
    }
}

/// Labels of ticks `mantissa 10^exponent`: all as decimals, or all as powers.
fn log_labels(ticks: &[(f64, i32)]) -> Vec<Tick> {
    let plain = ticks
        .iter()
        .all(|(_, exponent)| (-3..=3).contains(exponent));
    let label = |mantissa: f64, exponent: i32| {
        if plain {
            format!(
                "{:.*}",
                (-exponent).max(0) as usize,
                mantissa * power_of_ten(exponent)
            )
        } else if mantissa == 1.0 {
            format!("10{}", superscript(exponent))
        } else {
            format!("{mantissa}×10{}", superscript(exponent))
        }
    };
    let tick = |&(m, e): &(f64, i32)| Tick {
        value: m * power_of_ten(e),
        label: label(m, e),
    };
    ticks.iter().map(tick).collect()
}

/// Distance of ticks and the decimals that they need (negative for tens).
///
/// The smallest step of 1, 2, 2.5 or 5 times a power of ten that gives at most `most` ticks; where
/// that leaves fewer than two, the ends of the next finer ticks.
fn tick_step(low: f64, high: f64, most: usize) -> (f64, i32) {
    let most = most.max(2) as f64;
    let start = (high / most - low / most).log10().floor() as i32;
    let mut finer = None;
    for exponent in start..start.saturating_add(3) {
        for (mantissa, extra) in [(1.0, 0), (2.0, 0), (2.5, 1), (5.0, 0)] {
            let step = mantissa * power_of_ten(exponent);
            let first = (low / step - 1e-9).ceil();
            let count = (high / step + 1e-9).floor() - first + 1.0;
            let decimals = (extra - exponent).max(-300);
            if count > most {
                finer = Some((step, decimals));
            } else if count >= 2.0 {
                return (step, decimals);
            }
        }
    }
    finer.unwrap_or((high / 2.0 - low / 2.0, start.saturating_neg()))
}

/// A power of ten, correctly rounded, as the literal would be.
fn power_of_ten(exponent: i32) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(f64::NAN)
}
