//! Effects of time: lag of a drive, and channels that are sampled late.
//!
//! x(t - delay) - x(t) is taken to second order, -delay v + delay^2 a / 2: the first order alone
//! leaves, at 4 ms and the accelerations of a hand, more than the noise of a cable encoder.

use super::{Effect, Family, Hook, Need, ParameterSpec, parameter};
use crate::context::Context;
use crate::signal::{LocalMotion, Signal};

pub(super) fn at_joint(joint: usize) -> Vec<Box<dyn Effect>> {
    vec![
        Box::new(Late {
            what: Channel::Drive(joint),
        }),
        Box::new(Late {
            what: Channel::External(joint),
        }),
    ]
}

pub(super) fn of_device() -> Vec<Box<dyn Effect>> {
    vec![
        Box::new(Late {
            what: Channel::Cable,
        }),
        Box::new(Late {
            what: Channel::Motors,
        }),
    ]
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Channel {
    /// A6: the output follows the motor late.
    Drive(usize),
    /// B5.
    External(usize),
    /// C13.
    Cable,
    /// All motor encoders.
    Motors,
}

/// A channel that shows what was true a delay ago.
#[derive(Debug)]
struct Late {
    what: Channel,
}

/// x(t - delay) - x(t), and its derivative with respect to the delay.
fn shift(motion: &LocalMotion, delay_s: f64) -> (Vec<f64>, Vec<f64>) {
    let pairs = motion.velocity.iter().zip(&motion.acceleration);
    let values = pairs
        .clone()
        .map(|(v, a)| delay_s * (0.5 * delay_s * a - v));
    let slopes = pairs.map(|(v, a)| delay_s * a - v);
    (values.collect(), slopes.collect())
}

impl Late {
    fn signal(&self, context: &Context<'_>, delay_s: f64, slope: bool) -> Signal {
        let pick = |pair: (Vec<f64>, Vec<f64>)| if slope { pair.1 } else { pair.0 };
        let of_joint = |joint: usize, delay_s: f64| {
            let motion = context.motion.as_ref().map(|motion| &motion[joint]);
            motion.map(|motion| pick(shift(motion, delay_s)))
        };
        match self.what {
            Channel::Drive(joint) => of_joint(joint, delay_s)
                .map(|error| context.upstream(joint, &error))
                .unwrap_or_default(),
            Channel::External(joint) => of_joint(joint, delay_s)
                .map(|error| context.encoder(joint, &error))
                .unwrap_or_default(),
            Channel::Cable => match &context.cable {
                Some(cable) if !cable.motion.velocity.is_empty() => {
                    context.cable_error(pick(shift(&cable.motion, delay_s)))
                }
                _ => Signal::default(),
            },
            Channel::Motors => {
                // late motor encoders: everything else is ahead of them
                let joints = 0..context.device.joints.len();
                let errors: Option<Vec<Vec<f64>>> = joints
                    .clone()
                    .map(|joint| of_joint(joint, -delay_s))
                    .collect();
                let Some(errors) = errors else {
                    return Signal::default();
                };
                if !slope {
                    return context.upstream_of_all(&errors);
                }
                let mut sum = Signal::default();
                for (joint, error) in errors.iter().enumerate() {
                    sum.add(&context.upstream(joint, error), -1.0);
                }
                sum
            }
        }
    }
}

impl Effect for Late {
    fn name(&self) -> &'static str {
        match self.what {
            Channel::Drive(_) => "viscous-lag",
            Channel::External(_) => "external-encoder-latency",
            Channel::Cable => "cable-latency",
            Channel::Motors => "encoder-latency",
        }
    }

    fn joint(&self) -> Option<usize> {
        match self.what {
            Channel::Drive(joint) | Channel::External(joint) => Some(joint),
            _ => None,
        }
    }

    fn hook(&self) -> Hook {
        match self.what {
            Channel::Drive(_) => Hook::Transmission,
            Channel::External(_) => Hook::ExternalEncoder,
            Channel::Cable => Hook::CableSensor,
            Channel::Motors => Hook::Timing,
        }
    }

    fn family(&self) -> Family {
        Family::Lag
    }

    fn parameters(&self) -> &'static [ParameterSpec] {
        const { &[parameter("delay_s", 0.0, 0.05)] }
    }

    fn needs(&self) -> Vec<Need> {
        match self.what {
            Channel::Drive(_) | Channel::Motors => vec![Need::Time, Need::Motion],
            Channel::External(joint) => vec![Need::Time, Need::Motion, Need::Output(joint)],
            Channel::Cable => vec![Need::Time, Need::Motion, Need::Cable],
        }
    }

    fn derivative(&self, context: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<Signal> {
        let delay_s = amplitudes.first().copied().unwrap_or(0.0);
        vec![self.signal(context, delay_s, true)]
    }

    fn contribution(&self, context: &Context<'_>, amplitudes: &[f64], _: f64) -> Signal {
        self.signal(context, amplitudes[0], false)
    }

    fn is_possible(&self, amplitudes: &[f64]) -> bool {
        // a drive cannot run ahead; a channel can, if another one is late
        !matches!(self.what, Channel::Drive(_)) || amplitudes[0] > 0.0
    }
}
