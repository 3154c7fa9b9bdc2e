//! All motor encoders are sampled late: everything else is ahead of them. Encoders that are ahead are as often a sensor that is
//! late: where one kind of sensor is all that they are compared with, the two are one (docs/diagnosis.md, Laws of the catalogue).

use crate::clock::{ENCODER_LATENCY, OtherClock};
use crate::context::Context;
use crate::laws::{Delay, moved, slope};
use crate::{Effect, Hook, LogFault, Need, Signal, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: ENCODER_LATENCY,
    meaning: "all motor encoders are sampled later or earlier than the rest",
    inspect: "the time stamps of the motor encoders, and of the sensors that they are compared with",
    adds: "theta(t + d) - theta(t), all joints",
    hook: Hook::Timing,
    needs: &[Need::Time, Need::Motion],
    log_fault: Some(LogFault::Late),
    ..Delay::SPEC
};

#[derive(Debug)]
pub(crate) struct EncoderLatency;

impl Effect for EncoderLatency {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn derivative(&self, context: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<Signal> {
        let mut sum = Signal::default();
        for (joint, motion) in context.motion.iter().flatten().enumerate() {
            let error = slope(motion, -amplitudes[0]);
            sum.add(&context.upstream(joint, &error), -1.0);
        }
        vec![sum]
    }

    fn signal(&self, context: &Context<'_>, amplitudes: &[f64], _: f64) -> Signal {
        let Some(motion) = &context.motion else {
            return Signal::default();
        };
        let errors = motion.iter().map(|motion| moved(motion, -amplitudes[0]));
        context.upstream_of_all(&errors.collect::<Vec<_>>())
    }

    fn twin(&self, context: &Context<'_>) -> Option<&'static str> {
        let channels = context.streams.iter().map(|stream| stream.channel);
        OtherClock::only(channels).map(OtherClock::latency)
    }
}
