//! Events: encoders that lose counts and cables that slip, a constant step from an instant on.

use std::f64::consts::TAU;

use super::{Effect, Family, Hook, Need, ParameterSpec, parameter};
use crate::context::Context;
use crate::signal::Signal;

pub(super) fn at_joint(joint: usize, has_drums: bool) -> Vec<Box<dyn Effect>> {
    let mut effects: Vec<Box<dyn Effect>> = vec![
        Box::new(Step {
            what: What::MotorCounts(joint),
        }),
        Box::new(Step {
            what: What::ExternalCounts(joint),
        }),
    ];
    if has_drums {
        effects.push(Box::new(Step {
            what: What::Slip(joint),
        }));
    }
    effects
}

pub(super) fn of_device() -> Vec<Box<dyn Effect>> {
    vec![Box::new(Step {
        what: What::CableCounts,
    })]
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum What {
    /// A9.
    MotorCounts(usize),
    /// A3.
    Slip(usize),
    /// B3.
    ExternalCounts(usize),
    /// C12.
    CableCounts,
}

/// A step; the shape is the first row after it.
#[derive(Debug)]
struct Step {
    what: What,
}

/// Share of the torques that a slip's torque must exceed: a cable slips under load.
const SLIPS_ABOVE: f64 = 0.9;

impl Step {
    /// Size of one count in the stream's unit; three standard deviations (the paper's rule) where the
    /// device file has no counts.
    fn quantum(&self, context: &Context<'_>) -> Option<f64> {
        let device = context.device;
        match self.what {
            What::MotorCounts(joint) => device.joints[joint].reading_quantum_rad(),
            What::ExternalCounts(joint) => {
                let joint = &device.joints[joint];
                let counts = joint.external_encoder_counts_per_rev;
                let by_counts = counts.map(|counts| TAU / counts);
                by_counts.or_else(|| joint.output_sd_rad().map(|sd| 3.0 * sd))
            }
            What::CableCounts => {
                let by_counts = device
                    .cables
                    .first()
                    .and_then(|cable| Some(TAU * cable.drum_radius_m? / cable.counts_per_rev?));
                by_counts.or_else(|| device.cable_sd_m(0).map(|sd| 3.0 * sd))
            }
            What::Slip(_) => Some(1.0),
        }
    }

    /// Counts are those by which the reading is too high afterwards; an error of the motor-side reading
    /// enters the streams, which are compared with it, the other way round.
    fn sign(&self) -> f64 {
        match self.what {
            What::MotorCounts(_) => -1.0,
            _ => 1.0,
        }
    }
}

impl Effect for Step {
    fn name(&self) -> &'static str {
        match self.what {
            What::MotorCounts(_) => "encoder-count-loss",
            What::Slip(_) => "capstan-slip",
            What::ExternalCounts(_) => "external-encoder-count-loss",
            What::CableCounts => "cable-count-loss",
        }
    }

    fn joint(&self) -> Option<usize> {
        match self.what {
            What::MotorCounts(joint) | What::Slip(joint) | What::ExternalCounts(joint) => {
                Some(joint)
            }
            What::CableCounts => None,
        }
    }

    fn hook(&self) -> Hook {
        match self.what {
            What::MotorCounts(_) | What::Slip(_) => Hook::Transmission,
            What::ExternalCounts(_) => Hook::ExternalEncoder,
            What::CableCounts => Hook::CableSensor,
        }
    }

    fn family(&self) -> Family {
        Family::Step
    }

    fn parameters(&self) -> &'static [ParameterSpec] {
        match self.what {
            What::Slip(_) => {
                const {
                    &[
                        parameter("slip_rad", 0.0, 0.1),
                        parameter("time_s", 0.0, f64::MAX),
                    ]
                }
            }
            _ => {
                const {
                    &[
                        parameter("counts", 0.4, 1e4),
                        parameter("time_s", 0.0, f64::MAX),
                    ]
                }
            }
        }
    }

    fn needs(&self) -> Vec<Need> {
        match self.what {
            What::MotorCounts(joint) => vec![Need::Time, Need::Motion, Need::Counts(joint)],
            What::Slip(joint) => vec![Need::Time, Need::Motion, Need::Torque(joint)],
            What::ExternalCounts(joint) => vec![Need::Time, Need::Motion, Need::Output(joint)],
            What::CableCounts => vec![Need::Time, Need::Motion, Need::Cable],
        }
    }

    fn is_event(&self) -> bool {
        true
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        let mut error = vec![0.0; context.rows()];
        let first = shape.max(0.0) as usize;
        if let Some(run) = context.runs.iter().find(|run| run.contains(&first)) {
            error[first..run.end].fill(1.0);
        }
        vec![match self.what {
            What::MotorCounts(joint) | What::Slip(joint) => context.upstream(joint, &error),
            What::ExternalCounts(joint) => context.encoder(joint, &error),
            What::CableCounts => context.cable_error(error),
        }]
    }

    fn values(&self, context: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        let time_s = context.recording.time_s.as_ref();
        let time = time_s.and_then(|time_s| time_s.get(shape as usize));
        vec![
            self.sign() * amplitudes[0] / self.quantum(context).unwrap_or(1.0),
            time.copied().unwrap_or(shape),
        ]
    }

    fn amplitudes(&self, context: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        let time_s = context.recording.time_s.as_ref();
        let row = time_s.map_or(values[1], |time_s| {
            time_s.partition_point(|&time| time < values[1]) as f64
        });
        let amplitude = self.sign() * values[0] * self.quantum(context).unwrap_or(1.0);
        (vec![amplitude], row)
    }

    fn log_prior(&self) -> f64 {
        match self.what {
            What::Slip(_) => -3.0,
            _ => 0.0,
        }
    }
}

/// Whether a slip at a row would have happened under a load that few rows exceed.
pub fn under_load(context: &Context<'_>, joint: usize, row: f64) -> bool {
    let (Some(torque), Some(times)) = (
        context.torque_nm.get(joint).and_then(Option::as_ref),
        &context.recording.time_s,
    ) else {
        return false;
    };
    let Some(&time_s) = times.get(row as usize) else {
        return false;
    };
    let near = times
        .iter()
        .zip(torque)
        .filter(|(time, _)| (**time - time_s).abs() < 0.2)
        .map(|(_, torque)| torque.abs())
        .fold(0.0, f64::max);
    let below = torque.iter().filter(|torque| torque.abs() < near).count();
    below as f64 >= SLIPS_ABOVE * torque.len() as f64
}
