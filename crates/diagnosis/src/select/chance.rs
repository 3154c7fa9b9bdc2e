//! Significance of a pick, the share that it must explain, and the excess of slow residuals over noise.

use haptical_effects::{Effect, Shape};
use haptical_metrics::chi_square_p_value;

use crate::Result;
use crate::engine::SlowEnergy;
use crate::noise::{Noise, NoiseSource};
use crate::select::{Score, Selector};
use crate::thresholds::chance::{FAMILY_WISE_P, SHARE_OF_REST};
use crate::thresholds::selection::TAKEN_UP;
use crate::thresholds::steps::INSTANTS;

/// Probability that chance gives any of some tests a score like this, misfit allowed for as more noise (Bonferroni).
pub(crate) fn family_wise_p(score: &Score, misfit: f64, tests: f64) -> Result<f64> {
    let p = chi_square_p_value(score.score / misfit, score.rank as f64)?;
    Ok((p * tests).min(1.0))
}

impl Selector<'_> {
    /// Probability that chance gives any effect of the catalogue a score like this, misfit allowed for
    /// as more noise (Bonferroni over effects, shapes and instants).
    pub(crate) fn family_wise_p(&self, score: &Score, misfit: f64) -> Result<f64> {
        let effect = self.effects[score.effect].as_ref();
        let tries = if effect.spec().shape == Shape::Event {
            let instants = INSTANTS * self.engine.system.layout.count() as f64
                / self.engine.context.streams.len().max(1) as f64;
            instants.max(1.0).powi(score.times.len().max(1) as i32)
        } else {
            self.shapes_tried(effect)
        };
        family_wise_p(score, misfit, tries.max(1.0) * self.tested.len() as f64)
    }

    /// Shapes among which an effect's was found, at least 1; of a line all frequencies that the rows can show.
    pub(super) fn shapes_tried(&self, effect: &dyn Effect) -> f64 {
        let context = &self.engine.context;
        let tried = match effect.spec().shape {
            Shape::Line => context.rows() / 2,
            _ => effect.shapes(context).len(),
        };
        tried.max(1) as f64
    }

    pub(crate) fn is_more_than_chance(&self, score: &Score, after: &[SlowEnergy]) -> Result<bool> {
        let p = self.family_wise_p(score, misfit(after))?;
        Ok(p < FAMILY_WISE_P)
    }

    /// Whether a pick explains enough of what was left: a wrong effect nibbles at a gap.
    pub(super) fn explains_enough(
        &self,
        score: &Score,
        before: &[SlowEnergy],
        after: &[SlowEnergy],
    ) -> bool {
        let share = SHARE_OF_REST;
        if self.engine.is_noise_unknown() {
            // what is noise and what is gap only the cause itself tells
            let all: f64 = before.iter().map(|stream| stream.energy).sum();
            return score.score >= share * all;
        }
        let (rest, uncertain) = excess(before);
        let (left, _) = excess(after);
        score.score >= share * (rest - 2.0 * uncertain) || rest - left >= share * rest
    }
}

/// Slow residuals over what noise gives, at least 1.
pub(crate) fn misfit(energy: &[SlowEnergy]) -> f64 {
    let (sum, freedom) = energy.iter().fold((0.0, 0.0), |(sum, freedom), stream| {
        (sum + stream.energy, freedom + stream.freedom)
    });
    if freedom > 0.0 {
        (sum / freedom).max(1.0)
    } else {
        1.0
    }
}

/// Largest excess of a stream in standard deviations, the noise's own uncertainty allowed for.
pub(crate) fn worst_excess(energy: &[SlowEnergy], noise: &[Noise]) -> f64 {
    energy
        .iter()
        .zip(noise)
        .map(|(stream, noise)| {
            if stream.freedom <= 1.0 {
                return of_one_reading(*stream);
            }
            if noise.source == NoiseSource::Repeats {
                return over_repeats(*stream, noise);
            }
            let spread = (2.0 * stream.freedom)
                .sqrt()
                .hypot(stream.freedom * noise.uncertainty);
            stream.excess() / spread.max(1.0)
        })
        .fold(f64::NEG_INFINITY, f64::max)
}

/// Excess over a noise that repeats estimated, in standard deviations. The ratio of two mean squares is skew where one has
/// few degrees of freedom; its logarithm, of deviation sqrt(2 / n + 2 / m), is not (Fisher 1924).
fn over_repeats(stream: SlowEnergy, noise: &Noise) -> f64 {
    let ratio = (stream.energy / stream.freedom).max(1e-300);
    ratio.ln() / (2.0 / stream.freedom).sqrt().hypot(noise.uncertainty)
}

/// Excess of a single reading, such as the known distance of two sockets, in standard deviations: its square is
/// far from normal (Wilson & Hilferty 1931).
fn of_one_reading(stream: SlowEnergy) -> f64 {
    if stream.freedom <= TAKEN_UP {
        return f64::NEG_INFINITY;
    }
    let spread = 2.0 / (9.0 * stream.freedom);
    ((stream.energy / stream.freedom).max(0.0).cbrt() - (1.0 - spread)) / spread.sqrt()
}

/// Structured energy over all streams, and its standard deviation under noise.
pub(crate) fn excess(energy: &[SlowEnergy]) -> (f64, f64) {
    let sum = energy.iter().map(|stream| stream.excess()).sum();
    let variance: f64 = energy.iter().map(|stream| 2.0 * stream.freedom).sum();
    (sum, variance.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the F distribution: of 200 against 15 degrees of freedom, a ratio of 3.0 has the probability 0.01 by chance (a
    /// normal deviate of 2.4), one of 7.5 that of 3.5e-5 (4.0); SciPy's `f.sf`.
    #[test]
    fn a_ratio_over_few_repeats_is_no_more_than_the_f_distribution_says() {
        let noise = Noise {
            ratio: 1.0,
            colour: 0.0,
            coloured_share: 0.0,
            uncertainty: (2.0_f64 / 15.0).sqrt(),
            freedom: 15.0,
            source: NoiseSource::Repeats,
            speed_ratio: 1.0,
        };
        let excess = |ratio: f64| {
            let stream = SlowEnergy {
                energy: 200.0 * ratio,
                freedom: 200.0,
            };
            worst_excess(&[stream], std::slice::from_ref(&noise))
        };
        assert!(excess(1.0).abs() < 1e-12);
        assert!((2.0..3.2).contains(&excess(3.0)), "{}", excess(3.0));
        assert!((4.0..5.6).contains(&excess(7.5)), "{}", excess(7.5));
    }
}
