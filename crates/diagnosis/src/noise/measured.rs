//! The noise of a recording's streams, from the residuals of a model.

use haptical_calibration::Channel;
use haptical_effects::Context;

use crate::engine::base::problem::BaseProblem;
use crate::noise::repeats::{Repeats, pooled};
use crate::noise::stated::is_stated;
use crate::noise::{self, Known, Noise};

/// Noise that is known from an earlier look.
#[derive(Debug, Clone)]
pub(crate) struct KnownNoise {
    pub(crate) noise: Vec<Noise>,
    pub(crate) scale: Vec<Option<Vec<f64>>>,
}

pub(crate) fn estimate_noise(
    context: &Context<'_>,
    problem: &BaseProblem<'_>,
    residual: &[Vec<f64>],
    usable: &[Vec<bool>],
    own: &[f64],
    parameters: usize,
) -> (Vec<Noise>, Vec<Option<Vec<f64>>>) {
    let lost = parameters as f64 / context.streams.len().max(1) as f64;
    let repeats = Repeats::new(context);
    let scaled: Vec<Scaled> = haptical_parallel::map(0..context.streams.len(), |stream| {
        Scaled::new(
            context,
            stream,
            &residual[stream],
            &problem.sd[stream],
            &usable[stream],
        )
    });
    let rounding =
        |stream: usize| rounding_share(&problem.sd[stream], own[stream], &usable[stream]);
    let of_repeats: Vec<Option<Noise>> = scaled
        .iter()
        .enumerate()
        .map(|(stream, scaled)| repeats.noise(&scaled.values, rounding(stream)))
        .collect();
    let measured = haptical_parallel::map(scaled.into_iter().enumerate(), |(stream, scaled)| {
        let channel = context.streams[stream].channel;
        let streams = context.streams.iter().zip(&of_repeats);
        let of_channel: Vec<&Noise> = streams
            .filter(|(other, _)| other.channel == channel)
            .filter_map(|(_, noise)| noise.as_ref())
            .collect();
        let of_repeats = pooled(&of_channel).or_else(|| of_repeats[stream].clone());
        let known = Known {
            runs: &context.runs,
            ordered: context.ordered,
            repeats: of_repeats.as_ref(),
            are_of_one_side: repeats.are_of_one_side,
            lost,
            stated: is_stated(context.device, channel),
            rounding: rounding(stream),
        };
        let mut found = noise::estimate(&scaled.values, &known);
        let by_speed = scaled.by_speed;
        found.speed_ratio = by_speed.as_ref().map_or(1.0, |(_, ratio)| *ratio);
        (found, by_speed.map(|(scale, _)| scale))
    });
    measured.into_iter().unzip()
}

/// A stream's residuals over their stated deviation, and over what the speed makes of it.
struct Scaled {
    values: Vec<f64>,
    /// Factor of the deviation at each row, and how much it grows.
    by_speed: Option<(Vec<f64>, f64)>,
}

impl Scaled {
    fn new(
        context: &Context<'_>,
        stream: usize,
        residual: &[f64],
        sd: &[f64],
        usable: &[bool],
    ) -> Self {
        let mut values = over_stated(context, stream, residual, sd, usable);
        let by_speed = speed_of(context, stream)
            .and_then(|speed| noise::speed_scale(&values, &speed, &context.runs));
        if let Some((scale, _)) = &by_speed {
            for (value, scale) in values.iter_mut().zip(scale) {
                *value /= scale;
            }
        }
        Self { values, by_speed }
    }
}

/// A stream's residuals without its lines over their stated deviation; NaN where there is none.
pub(crate) fn over_stated(
    context: &Context<'_>,
    stream: usize,
    residual: &[f64],
    sd: &[f64],
    usable: &[bool],
) -> Vec<f64> {
    let without = noise::without_lines(context, stream, residual);
    let rows = without.iter().zip(sd).zip(usable);
    rows.map(|((residual, sd), usable)| if *usable { residual / sd } else { f64::NAN })
        .collect()
}

/// Speed of what a stream measures, where rows follow a motion in time.
pub(crate) fn speed_of(context: &Context<'_>, stream: usize) -> Option<Vec<f64>> {
    let motion = context.motion.as_ref().filter(|_| context.ordered)?;
    match context.streams[stream].channel {
        Channel::Output { joint } => Some(motion[joint].velocity.clone()),
        Channel::Cable { index: 0 } => Some(context.cable.as_ref()?.motion.velocity.clone()),
        _ => None,
    }
}

/// Share of a stream's stated variance that the rounding of the motor encoders has.
pub(crate) fn rounding_share(sd: &[f64], own: f64, usable: &[bool]) -> f64 {
    let squares = sd.iter().zip(usable).filter(|(_, usable)| **usable);
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), (sd, _)| {
        (sum + sd * sd, count + 1.0)
    });
    if sum > 0.0 {
        (1.0 - own * own * count / sum).max(0.0)
    } else {
        0.0
    }
}

pub(crate) fn floors(problem: &BaseProblem<'_>, noise: &[Noise], usable: &[Vec<bool>]) -> Vec<f64> {
    (0..noise.len())
        .map(|stream| {
            let rows: Vec<f64> = problem.sd[stream]
                .iter()
                .zip(&usable[stream])
                .filter(|(_, usable)| **usable)
                .map(|(sd, _)| sd * sd)
                .collect();
            let mean = rows.iter().sum::<f64>() / rows.len().max(1) as f64;
            noise[stream].ratio * mean.sqrt()
        })
        .collect()
}
