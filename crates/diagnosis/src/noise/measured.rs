//! The noise of a recording's streams, from the residuals of a model.

use haptical_calibration::Channel;
use haptical_effects::Context;
use rayon::prelude::*;

use crate::engine::base::BaseProblem;
use crate::noise::repeats::Repeats;
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
    (0..context.streams.len())
        .into_par_iter()
        .map(|stream| {
            let without = noise::without_lines(context, stream, &residual[stream]);
            let mut scaled: Vec<f64> = (0..context.rows())
                .map(|row| {
                    if usable[stream][row] {
                        without[row] / problem.sd[stream][row]
                    } else {
                        f64::NAN
                    }
                })
                .collect();
            let by_speed = speed_of(context, stream)
                .and_then(|speed| noise::speed_scale(&scaled, &speed, &context.runs));
            if let Some((scale, _)) = &by_speed {
                for (value, scale) in scaled.iter_mut().zip(scale) {
                    *value /= scale;
                }
            }
            let stated = is_stated(context.device, context.streams[stream].channel);
            let known = Known {
                runs: &context.runs,
                ordered: context.ordered,
                repeats: &repeats,
                lost,
                stated,
                rounding: rounding_share(&problem.sd[stream], own[stream], &usable[stream]),
            };
            let mut found = noise::estimate(&scaled, &known);
            found.speed_ratio = by_speed.as_ref().map_or(1.0, |(_, ratio)| *ratio);
            (found, by_speed.map(|(scale, _)| scale))
        })
        .unzip()
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
