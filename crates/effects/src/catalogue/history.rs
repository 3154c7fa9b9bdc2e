//! Effects that remember the motion: play, presliding hysteresis, wind-up of an encoder's coupling.
//! They are evaluated in time order, run by run.

use super::{Effect, Family, Hook, Need, ParameterSpec, parameter};
use crate::context::Context;
use crate::signal::{Signal, dahl, play, smooth};

pub(super) fn at_joint(joint: usize) -> Vec<Box<dyn Effect>> {
    vec![
        Box::new(Backlash { joint }),
        Box::new(Hysteresis {
            joint,
            place: Place::Transmission,
        }),
        Box::new(Hysteresis {
            joint,
            place: Place::Encoder,
        }),
    ]
}

pub(super) fn of_device() -> Vec<Box<dyn Effect>> {
    vec![Box::new(CableHysteresis)]
}

/// The play is driven by the motor, or by the hand on the link.
const DRIVEN_BY_MOTOR: f64 = 0.0;
const DRIVEN_BY_LINK: f64 = 1.0;

/// A4, A15, D5: a play of total width 2b. Driven by the motor the link follows late; driven by the
/// hand the motor does, so that the link leads.
#[derive(Debug)]
struct Backlash {
    joint: usize,
}

/// Half-width at which the score scan linearises: small against any motion \[rad\].
const SMALL_PLAY: f64 = 5e-5;

impl Backlash {
    fn lost(&self, context: &Context<'_>, half_width: f64, shape: f64) -> Vec<f64> {
        let readings = &context.recording.joint[self.joint];
        let measured = context
            .recording
            .output
            .get(self.joint)
            .and_then(Option::as_ref);
        match measured {
            Some(output) if shape == DRIVEN_BY_LINK => {
                let output = smooth(output, 2, &context.runs);
                let lost = play(&output, half_width, &context.runs);
                lost.into_iter().map(|value| -value).collect()
            }
            _ => play(readings, half_width, &context.runs),
        }
    }
}

impl Effect for Backlash {
    fn name(&self) -> &'static str {
        "backlash"
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn hook(&self) -> Hook {
        Hook::Transmission
    }

    fn family(&self) -> Family {
        Family::Loop
    }

    fn parameters(&self) -> &'static [ParameterSpec] {
        const { &[parameter("width_rad", 0.0, 0.1)] }
    }

    fn needs(&self) -> Vec<Need> {
        vec![Need::Motion]
    }

    fn shapes(&self, context: &Context<'_>) -> Vec<f64> {
        if context.output_stream(self.joint).is_some() {
            vec![DRIVEN_BY_MOTOR, DRIVEN_BY_LINK]
        } else {
            vec![DRIVEN_BY_MOTOR]
        }
    }

    fn has_sides(&self) -> bool {
        true
    }

    fn derivative(&self, context: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<Signal> {
        let half_width = amplitudes.first().map_or(0.0, |b| b.abs()).max(SMALL_PLAY);
        vec![context.upstream(self.joint, &self.lost(context, half_width, shape))]
    }

    fn values(&self, _: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        vec![2.0 * amplitudes[0].abs()]
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![0.5 * values[0]], DRIVEN_BY_MOTOR)
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    Transmission,
    Encoder,
}

/// A5 and B2: a loop that turns over within a travel, after Dahl; in the transmission or in the
/// coupling of an external encoder.
#[derive(Debug)]
struct Hysteresis {
    joint: usize,
    place: Place,
}

impl Effect for Hysteresis {
    fn name(&self) -> &'static str {
        match self.place {
            Place::Transmission => "hysteresis",
            Place::Encoder => "external-encoder-windup",
        }
    }

    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn hook(&self) -> Hook {
        match self.place {
            Place::Transmission => Hook::Transmission,
            Place::Encoder => Hook::ExternalEncoder,
        }
    }

    fn family(&self) -> Family {
        Family::Loop
    }

    fn parameters(&self) -> &'static [ParameterSpec] {
        const {
            &[
                parameter("amplitude_rad", 0.0, 0.1),
                parameter("transition_rad", 0.0, 5.0),
            ]
        }
    }

    fn needs(&self) -> Vec<Need> {
        match self.place {
            Place::Transmission => vec![Need::Motion],
            Place::Encoder => vec![Need::Motion, Need::Output(self.joint)],
        }
    }

    fn shapes(&self, _: &Context<'_>) -> Vec<f64> {
        vec![3e-4, 3e-3, 0.01, 0.03, 0.1, 0.3, 1.0]
    }

    fn shape_is_continuous(&self) -> bool {
        true
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        let state = dahl(&context.recording.joint[self.joint], shape, &context.runs);
        vec![match self.place {
            Place::Transmission => context.upstream(self.joint, &state),
            Place::Encoder => context.encoder(self.joint, &state),
        }]
    }

    fn values(&self, _: &Context<'_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        vec![amplitudes[0].abs(), shape]
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![values[0]], values[1])
    }

    fn log_prior(&self) -> f64 {
        -0.5
    }
}

/// C7: friction and spring of the cable encoder, a loop in the distance.
#[derive(Debug)]
struct CableHysteresis;

impl Effect for CableHysteresis {
    fn name(&self) -> &'static str {
        "cable-hysteresis"
    }

    fn hook(&self) -> Hook {
        Hook::CableSensor
    }

    fn family(&self) -> Family {
        Family::Loop
    }

    fn parameters(&self) -> &'static [ParameterSpec] {
        const { &[parameter("amplitude_m", 0.0, 1e-2)] }
    }

    fn needs(&self) -> Vec<Need> {
        vec![Need::Motion, Need::Cable]
    }

    fn shapes(&self, _: &Context<'_>) -> Vec<f64> {
        vec![2e-4, 2e-3, 0.01, 0.05, 0.2]
    }

    fn shape_is_continuous(&self) -> bool {
        true
    }

    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        let Some(cable) = &context.cable else {
            return vec![];
        };
        // rounding of the readings must not look like reversals
        let length = smooth(&cable.length_m, 2, &context.runs);
        vec![context.cable_error(dahl(&length, shape, &context.runs))]
    }

    fn values(&self, _: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        vec![amplitudes[0].abs()]
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![values[0]], 2e-3)
    }
}
