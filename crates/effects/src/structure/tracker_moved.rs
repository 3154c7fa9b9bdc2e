//! The tracker, or the base that it stands before, was displaced between two runs.

use nalgebra::Vector3;

use crate::context::Context;
use crate::{Effect, Family, Follows, Hook, LawError, Need, Parameter, Shape, Signal, Spec, Unit};

/// The tracker's frame is displaced from a run on.
pub(crate) const SPEC: Spec = Spec {
    name: "tracker-moved",
    meaning: "the tracker or the base does not stand in the same place in all runs",
    inspect: "the tracker's stand and the device's mount: what was touched between the runs",
    adds: "a shift and a tilt of the tracker's frame, from a run on",
    hook: Hook::Tracker,
    family: Family::Place,
    needs: &[Need::Position, Need::Runs],
    parameters: &[
        Parameter::size("shift_m", Unit::Metre, 0.0, 1.0),
        Parameter::size("tilt_rad", Unit::Radian, 0.0, 1.0),
    ],
    amplitudes: 6,
    shape: Shape::Given,
    follows: Follows::Run,
    law_error: LawError::RIGID,
    ..Spec::COMMON
};

#[derive(Debug)]
pub(crate) struct TrackerMoved;

/// Runs after which a displacement is looked for at most.
const RUNS: usize = 8;

impl Effect for TrackerMoved {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }

    /// The first run after it.
    fn shapes(&self, context: &Context<'_>) -> Vec<f64> {
        let later = 1..context.runs.len().min(RUNS + 1);
        later.map(|run| run as f64).collect()
    }

    /// Along and about the tracker's own axes.
    fn derivative(&self, context: &Context<'_>, _: &[f64], shape: f64) -> Vec<Signal> {
        let run = context.runs.get(shape as usize);
        let first = run.map_or(usize::MAX, |run| run.start);
        let still = (Vector3::zeros(), Vector3::zeros());
        let column = |shift: Vector3<f64>, tilt: Vector3<f64>| {
            context.tracker(|row| if row < first { still } else { (shift, tilt) })
        };
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let shifts = axes.iter().map(|axis| column(*axis, Vector3::zeros()));
        let tilts = axes.iter().map(|axis| column(Vector3::zeros(), *axis));
        shifts.chain(tilts).collect()
    }

    fn values(&self, _: &Context<'_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        let size = |parts: &[f64]| parts.iter().map(|part| part * part).sum::<f64>().sqrt();
        vec![size(&amplitudes[..3]), size(&amplitudes[3..])]
    }

    fn amplitudes(&self, _: &Context<'_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![values[0], 0.0, 0.0, values[1], 0.0, 0.0], 1.0)
    }
}

#[cfg(test)]
crate::conforms!(SPEC);
