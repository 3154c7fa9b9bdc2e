//! The tracker is sampled late: what it reads is where the handle was.

use crate::clock::OtherClock;
use crate::context::Context;
use crate::laws::{Delay, moved, slope};
use crate::{Effect, Hook, LogFault, Need, Signal, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: OtherClock::Tracker.latency(),
    meaning: "the tracker is sampled later or earlier than the joints",
    inspect: "the time stamps of the tracker",
    adds: "pose(t - d) - pose(t)",
    hook: Hook::Tracker,
    needs: &[Need::Time, Need::Motion, Need::Position, Need::FurtherClock],
    log_fault: Some(LogFault::Late),
    ..Delay::SPEC
};

#[derive(Debug)]
pub(crate) struct TrackerLatency;

impl TrackerLatency {
    /// Of a signal that all sensors would show, what the tracker does.
    fn seen(context: &Context<'_>, mut signal: Signal) -> Signal {
        signal.parts.retain(|(stream, _)| {
            let channel = context.streams[*stream].channel;
            OtherClock::of(channel) == Some(OtherClock::Tracker)
        });
        signal
    }
}

impl Effect for TrackerLatency {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    fn derivative(&self, context: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<Signal> {
        let mut sum = Signal::default();
        for (joint, motion) in context.motion.iter().flatten().enumerate() {
            sum.add(
                &context.downstream(joint, &slope(motion, amplitudes[0])),
                1.0,
            );
        }
        vec![Self::seen(context, sum)]
    }

    fn signal(&self, context: &Context<'_>, amplitudes: &[f64], _: f64) -> Signal {
        let Some(motion) = &context.motion else {
            return Signal::default();
        };
        let errors = motion.iter().map(|motion| moved(motion, amplitudes[0]));
        let signal = context.upstream_of_all(&errors.collect::<Vec<_>>());
        Self::seen(context, signal)
    }
}
