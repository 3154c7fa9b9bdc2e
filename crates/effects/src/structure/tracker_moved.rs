//! The tracker, or the robot's base, was displaced between two runs.

use nalgebra::Vector3;

use crate::laws::{FROM_RUN, Input, Law, first_row, run_of};
use crate::structure::norm;
use crate::{Family, Follows, Further, Hook, Need, Parameter, Shape, Signal, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "tracker-moved",
    meaning: "the tracker or the base does not stand in the same place in all runs",
    inspect: "the tracker's stand and the device's mount: what was touched between the runs",
    adds: "a shift and a tilt of the tracker's frame, from a run on",
    hook: Hook::Tracker,
    needs: &[Need::Position, Need::Runs, Need::OneBase],
    parameters: &[
        Parameter::size("shift_m", 0.0, 1.0),
        Parameter::size("tilt_rad", 0.0, 1.0),
    ],
    further: &[
        Further::needed("x_m"),
        Further::needed("y_m"),
        Further::needed("z_m"),
        Further::needed("tilt_x_rad"),
        Further::needed("tilt_y_rad"),
        Further::needed("tilt_z_rad"),
        FROM_RUN,
    ],
    amplitudes: 6,
    shape: Shape::Given,
    follows: Follows::Run,
    ..Spec::of(Family::Place)
};

pub(crate) const LAW: TrackerMoved = TrackerMoved;

#[derive(Debug)]
pub(crate) struct TrackerMoved;

impl Law for TrackerMoved {
    /// Along and about the tracker's own axes.
    fn signals(&self, input: Input<'_, '_>, shape: f64) -> Option<Vec<Signal>> {
        let (context, first) = (input.context, first_row(input, shape));
        let still = (Vector3::zeros(), Vector3::zeros());
        let column = |shift: Vector3<f64>, tilt: Vector3<f64>| {
            context.tracker(|row| if row < first { still } else { (shift, tilt) })
        };
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let shifts = axes.iter().map(|axis| column(*axis, Vector3::zeros()));
        let tilts = axes.iter().map(|axis| column(Vector3::zeros(), *axis));
        Some(shifts.chain(tilts).collect())
    }

    fn values(&self, _: Input<'_, '_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        vec![norm(&amplitudes[..3]), norm(&amplitudes[3..])]
    }

    fn amplitudes(&self, _: Input<'_, '_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![values[0], 0.0, 0.0, values[1]], 1.0)
    }

    fn further(&self, _: Input<'_, '_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        [amplitudes, &[shape + 1.0]].concat()
    }

    fn whole(&self, input: Input<'_, '_>, _: &[f64], further: &[f64]) -> (Vec<f64>, f64) {
        (further[..6].to_vec(), run_of(input, further[6]))
    }
}
