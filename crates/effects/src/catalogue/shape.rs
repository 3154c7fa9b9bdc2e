//! Effects that depend on a joint's angle alone: drums out of round, harmonics, helical cables,
//! couplings between joints, eccentric encoders.

use haptical_model::{Device, TransmissionKind};

use super::{Effect, Family, Hook, Need, ParameterSpec, parameter};
use crate::context::Context;
use crate::signal::Signal;

pub(super) fn at_joint(device: &Device, joint: usize) -> Vec<Box<dyn Effect>> {
    let has_drums = device.joints[joint].transmission != TransmissionKind::Direct;
    let mut effects = of_joint(joint, has_drums);
    for from in (0..device.joints.len()).filter(|&from| from != joint) {
        effects.push(Box::new(CrossCoupling { joint, from }));
    }
    effects
}

/// What a slide can have: a scale or a screw whose pitch is not the file's.
pub(super) fn of_slide(joint: usize) -> Box<dyn Effect> {
    Box::new(Ratio { joint })
}

/// One of each kind, for their names.
pub(super) fn of_every_kind() -> Vec<Box<dyn Effect>> {
    let mut effects = of_joint(0, true);
    effects.push(Box::new(CrossCoupling { joint: 0, from: 1 }));
    effects
}

fn of_joint(joint: usize, has_drums: bool) -> Vec<Box<dyn Effect>> {
    let mut effects: Vec<Box<dyn Effect>> = vec![
        Box::new(Harmonic {
            joint,
            kind: Kind::ExternalEncoder,
        }),
        Box::new(Harmonic {
            joint,
            kind: Kind::DriveEccentricity,
        }),
        Box::new(Ratio { joint }),
    ];
    if has_drums {
        effects.push(Box::new(Harmonic {
            joint,
            kind: Kind::OutOfRound,
        }));
        effects.push(Box::new(Harmonic {
            joint,
            kind: Kind::InputDrum,
        }));
        effects.push(Box::new(Harmonic {
            joint,
            kind: Kind::DeviceEncoder,
        }));
        effects.push(Box::new(CablePitch { joint }));
    }
    effects
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    /// A7: two lobes.
    OutOfRound,
    /// A10: orders of the motor's angle above the first.
    InputDrum,
    /// A11: first order of the motor's angle, which the base model has for its input drum.
    DeviceEncoder,
    /// B1.
    ExternalEncoder,
    /// D4: an eccentric drive of a joint for which the base model has none.
    DriveEccentricity,
}

/// a cos(k theta) + b sin(k theta).
#[derive(Debug)]
struct Harmonic {
    joint: usize,
    kind: Kind,
}

impl Harmonic {
    /// Periods in one turn of the joint.
    fn order(&self, context: &Context<'_>, shape: f64) -> f64 {
        let ratio = context.device.joints[self.joint].transmission_ratio;
        match self.kind {
            Kind::OutOfRound => 2.0,
            Kind::InputDrum => shape * ratio,
            Kind::DeviceEncoder => ratio,
            Kind::ExternalEncoder | Kind::DriveEccentricity => 1.0,
        }
    }
}

impl Effect for Harmonic {
    fn name(&self) -> &'static str {
        match self.kind {
            Kind::OutOfRound => "drum-out-of-round",
            Kind::InputDrum => "input-drum-harmonic",
            Kind::DeviceEncoder => "device-encoder-eccentricity",
            Kind::ExternalEncoder => "external-encoder-eccentricity",
            Kind::DriveEccentricity => "drum-eccentricity",
        }
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn hook(&self) -> Hook {
        match self.kind {
            Kind::ExternalEncoder => Hook::ExternalEncoder,
            _ => Hook::Transmission,
        }
    }

    fn family(&self) -> Family {
        Family::Shape
    }

    fn parameters(&self) -> &'static [ParameterSpec] {
        match self.kind {
            Kind::InputDrum => {
                const {
                    &[
                        parameter("amplitude_rad", 0.0, 0.05),
                        parameter("phase_rad", 0.0, 10.0),
                        parameter("order", 0.0, 100.0),
                    ]
                }
            }
            _ => {
                const {
                    &[
                        parameter("amplitude_rad", 0.0, 0.1),
                        parameter("phase_rad", 0.0, 10.0),
                    ]
                }
            }
        }
    }

    fn needs(&self) -> Vec<Need> {
        match self.kind {
            Kind::ExternalEncoder => vec![Need::Output(self.joint)],
            Kind::DriveEccentricity => vec![Need::Chain],
            _ => vec![],
        }
    }

    fn shapes(&self, _: &Context<'_>) -> Vec<f64> {
        match self.kind {
            Kind::InputDrum => vec![2.0, 3.0, 4.0],
            _ => vec![1.0],
        }
    }

    fn amplitude_count(&self) -> usize {
        2
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        let order = self.order(context, shape);
        let readings = &context.recording.joint[self.joint];
        let place = |error: Vec<f64>| match self.kind {
            Kind::ExternalEncoder => context.encoder(self.joint, &error),
            _ => context.upstream(self.joint, &error),
        };
        let (sines, cosines) = readings.iter().map(|q| (order * q).sin_cos()).unzip();
        vec![place(cosines), place(sines)]
    }

    fn values(&self, _: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        // A cos(k theta - phase)
        let mut values = vec![
            amplitudes[0].hypot(amplitudes[1]),
            amplitudes[1].atan2(amplitudes[0]),
        ];
        if self.kind == Kind::InputDrum {
            values.push(shape);
        }
        values
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        let (sin, cos) = values[1].sin_cos();
        (
            vec![values[0] * cos, values[0] * sin],
            values.get(2).copied().unwrap_or(1.0),
        )
    }
}

/// D4: a ratio error of a joint for which the base model has none.
#[derive(Debug)]
struct Ratio {
    joint: usize,
}

impl Effect for Ratio {
    fn name(&self) -> &'static str {
        "ratio-error"
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn hook(&self) -> Hook {
        Hook::Transmission
    }

    fn family(&self) -> Family {
        Family::Shape
    }

    fn parameters(&self) -> &'static [ParameterSpec] {
        const { &[parameter("ratio_deviation", 0.0, 0.2)] }
    }

    fn needs(&self) -> Vec<Need> {
        vec![Need::Chain]
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        // output = reading / (1 + deviation / ratio), as eq. (1)
        let ratio = context.device.joints[self.joint].transmission_ratio;
        let readings = context.recording.joint[self.joint].iter();
        vec![context.upstream(
            self.joint,
            &readings.map(|q| -q / ratio).collect::<Vec<_>>(),
        )]
    }
}

/// A8: pitch of the helix and cables that walk or cross: to leading order an even term, and a cubic one
/// where the cable does not start in the middle of its drum.
#[derive(Debug)]
struct CablePitch {
    joint: usize,
}

impl Effect for CablePitch {
    fn name(&self) -> &'static str {
        "cable-pitch"
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn hook(&self) -> Hook {
        Hook::Transmission
    }

    fn family(&self) -> Family {
        Family::Shape
    }

    fn parameters(&self) -> &'static [ParameterSpec] {
        const { &[parameter("quadratic_per_rad", 0.0, 0.1)] }
    }

    fn needs(&self) -> Vec<Need> {
        vec![]
    }

    fn amplitude_count(&self) -> usize {
        2
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        let readings = &context.recording.joint[self.joint];
        let power =
            |exponent: i32| -> Vec<f64> { readings.iter().map(|q| q.powi(exponent)).collect() };
        vec![
            context.upstream(self.joint, &power(2)),
            context.upstream(self.joint, &power(3)),
        ]
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![values[0], 0.0], 0.0)
    }
}

/// A13: a joint is turned by another one through the routing of its cable.
#[derive(Debug)]
struct CrossCoupling {
    joint: usize,
    from: usize,
}

impl Effect for CrossCoupling {
    fn name(&self) -> &'static str {
        "cross-coupling"
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn hook(&self) -> Hook {
        Hook::Transmission
    }

    fn family(&self) -> Family {
        Family::Coupling
    }

    fn parameters(&self) -> &'static [ParameterSpec] {
        const {
            &[
                parameter("gain", 0.0, 0.5),
                parameter("from_joint", 0.0, 1000.0),
            ]
        }
    }

    fn needs(&self) -> Vec<Need> {
        vec![]
    }

    fn shapes(&self, _: &Context<'_>) -> Vec<f64> {
        vec![(self.from + 1) as f64]
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], _: f64) -> Vec<Signal> {
        vec![context.upstream(self.joint, &context.recording.joint[self.from])]
    }

    fn values(&self, _: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        vec![amplitudes[0], shape]
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![values[0]], values[1])
    }

    fn log_prior(&self) -> f64 {
        // one of many pairs
        -1.0
    }
}
