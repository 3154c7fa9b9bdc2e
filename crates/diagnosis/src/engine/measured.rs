//! The noise of a recording's streams, and the readings that stand alone, from the residuals of a model.

use haptical_calibration::Channel;
use haptical_effects::Context;

use crate::engine::Prepared;
use crate::noise;
use crate::noise::rounding::Counts;
use crate::noise::{Known, KnownNoise, Noise, NoiseSource, Repeats, is_stated, pooled};
use crate::thresholds::chance::OUTLIER_SD;
use crate::thresholds::noise::{HARDLY_MORE, MEDIAN_REACH};

impl Prepared<'_> {
    /// The noise that residuals show. With causes in the model, fast parts of their gap do not pass for noise.
    pub(crate) fn noise_of(&self, residual: &[Vec<f64>]) -> KnownNoise {
        let context = &self.context;
        let lost = self.base.free.len() as f64 / context.streams.len().max(1) as f64;
        let repeats = Repeats::new(context);
        // rounding over the stated deviation of a motion's rows, and as how many independent readings it scatters
        let counted = |stream: usize| {
            let counts = Counts::new(context, &context.streams[stream])?;
            let (sum, count) = self.stated_squares(stream);
            let stated = (sum / f64::max(count, 1.0)).sqrt();
            let rounding = counts.variance().sqrt() / stated;
            (context.ordered && stated > 0.0).then(|| (rounding, counts.independent(&context.runs)))
        };
        let counted: Vec<Option<(f64, f64)>> = (0..context.streams.len()).map(counted).collect();
        let scaled: Vec<Scaled> = haptical_parallel::map(0..context.streams.len(), |stream| {
            let values = self.over_stated(stream, &residual[stream]);
            let is_rounding =
                counted[stream].is_some_and(|(rounding, _)| are_rounding(&values, rounding));
            Scaled::new(context, stream, values, !is_rounding)
        });
        let of_repeats: Vec<Option<Noise>> = (scaled.iter().enumerate())
            .map(|(stream, scaled)| repeats.noise(&scaled.values, self.rounding_share(stream)))
            .collect();
        let measured =
            haptical_parallel::map(scaled.into_iter().enumerate(), |(stream, scaled)| {
                let channel = context.streams[stream].channel;
                let of_channel = context.streams_of(channel);
                let of_channel: Vec<&Noise> = of_channel
                    .filter_map(|stream| of_repeats[stream].as_ref())
                    .collect();
                let of_repeats = pooled(&of_channel).or_else(|| of_repeats[stream].clone());
                let known = Known {
                    runs: &context.runs,
                    ordered: context.ordered,
                    repeats: of_repeats.as_ref(),
                    are_of_one_side: repeats.are_of_one_side,
                    lost,
                    stated: is_stated(context.device, channel),
                    rounding: self.rounding_share(stream),
                };
                let mut found = noise::estimate(&scaled.values, &known);
                if let Some((rounding, readings)) = counted[stream]
                    && found.source == NoiseSource::Motion
                {
                    found = found.with_counts(rounding, readings);
                }
                let by_speed = scaled.by_speed;
                found.speed_ratio = by_speed.as_ref().map_or(1.0, |(_, ratio)| *ratio);
                (found, by_speed.map(|(scale, _)| scale))
            });
        let (noise, scale) = measured.into_iter().unzip();
        KnownNoise { noise, scale }
    }

    /// A stream's residuals without its lines over their stated deviation; NaN where there is none.
    pub(crate) fn over_stated(&self, stream: usize, residual: &[f64]) -> Vec<f64> {
        let without = noise::without_lines(&self.context, stream, residual);
        let rows = without.iter().zip(&self.problem.sd[stream]);
        rows.zip(&self.usable[stream])
            .map(|((residual, sd), usable)| if *usable { residual / sd } else { f64::NAN })
            .collect()
    }

    /// Share of a stream's stated variance that the rounding of the motor encoders has.
    fn rounding_share(&self, stream: usize) -> f64 {
        let (sum, count) = self.stated_squares(stream);
        match sum > 0.0 {
            true => (1.0 - self.own[stream].powi(2) * count / sum).max(0.0),
            false => 0.0,
        }
    }

    /// Sum of the stated variances of a stream's usable readings, and their number.
    fn stated_squares(&self, stream: usize) -> (f64, f64) {
        let rows = self.problem.sd[stream].iter().zip(&self.usable[stream]);
        let usable = rows.filter(|(_, usable)| **usable);
        usable.fold((0.0, 0.0), |(sum, count), (sd, _)| {
            (sum + sd * sd, count + 1.0)
        })
    }

    /// Root mean square of a noise in each stream, in its unit.
    pub(crate) fn floors(&self, noise: &[Noise]) -> Vec<f64> {
        let floor = |(stream, noise): (usize, &Noise)| {
            let (sum, count) = self.stated_squares(stream);
            noise.ratio * (sum / f64::max(count, 1.0)).sqrt()
        };
        noise.iter().enumerate().map(floor).collect()
    }

    /// Rows at which some axis of a channel stands alone in some residuals.
    pub(crate) fn outlying_in(&self, residual: &[Vec<f64>]) -> Vec<(Channel, usize)> {
        let (context, ordered) = (&self.context, self.context.ordered);
        let mut found = Vec::new();
        for (index, stream) in context.streams.iter().enumerate() {
            let sd = &self.problem.sd[index];
            let without = noise::without_lines(context, index, &residual[index]);
            let scaled: Vec<f64> = without.iter().zip(sd).map(|(own, sd)| own / sd).collect();
            let ratio = match ordered {
                true => noise::difference_sd(&scaled, &context.runs),
                false => noise::spread(&scaled),
            };
            let Some(ratio) = ratio.filter(|ratio| *ratio > 0.0) else {
                continue;
            };
            let rounded = match ordered {
                true => {
                    let count = Counts::new(context, stream).map_or(0.0, |counts| counts.count);
                    rounded(sd, self.own[index], count)
                }
                false => vec![0.0; sd.len()],
            };
            let limit = OUTLIER_SD * ratio;
            let reach = ordered.then_some(MEDIAN_REACH);
            let rows = noise::outliers(&scaled, &context.runs, reach, limit, &rounded);
            found.extend(rows.into_iter().map(|row| (stream.channel, row)));
        }
        found.sort_unstable();
        found.dedup();
        found
    }
}

/// A stream's residuals over their stated deviation, and over what the speed makes of it.
struct Scaled {
    values: Vec<f64>,
    /// Factor of the deviation at each row, and how much it grows.
    by_speed: Option<(Vec<f64>, f64)>,
}

/// Whether residuals over the stated deviation are hardly more than rounding, given in the same way: that they are smaller where a joint
/// rests within a count says nothing of speed.
fn are_rounding(scaled: &[f64], rounding: f64) -> bool {
    let known = scaled.iter().filter(|value| value.is_finite());
    let (sum, count) = known.fold((0.0, 0.0), |(sum, count), value| {
        (sum + value * value, count + 1.0)
    });
    (sum / f64::max(count, 1.0)).sqrt() < HARDLY_MORE * rounding
}

impl Scaled {
    fn new(context: &Context<'_>, stream: usize, mut values: Vec<f64>, may_grow: bool) -> Self {
        let by_speed = speed_of(context, stream)
            .filter(|_| may_grow)
            .and_then(|speed| noise::speed_scale(&values, speed, &context.runs));
        if let Some((scale, _)) = &by_speed {
            for (value, scale) in values.iter_mut().zip(scale) {
                *value /= scale;
            }
        }
        Self { values, by_speed }
    }
}

/// Speed of what a stream measures, where rows follow a motion in time.
fn speed_of<'c>(context: &'c Context<'_>, stream: usize) -> Option<&'c [f64]> {
    let motion = context.motion.as_ref().filter(|_| context.ordered)?;
    match context.streams[stream].channel {
        Channel::Output { joint } => Some(&motion[joint].velocity),
        Channel::Cable { index: 0 } => Some(&context.cable.as_ref()?.motion.velocity),
        _ => None,
    }
}

/// What rounding may put between a row and its neighbours, over each row's stated deviation `sd`: a count of the sensor,
/// and one of the motor encoders, whose rounding has the variance sd^2 - own^2 = (df/dtheta q)^2 / 12. At rest nothing
/// changes but counts, so differences of neighbours do not show this.
fn rounded(sd: &[f64], own: f64, count: f64) -> Vec<f64> {
    let rows = sd.iter();
    rows.map(|sd| (count + (12.0 * (sd * sd - own * own)).max(0.0).sqrt()) / sd)
        .collect()
}
