//! A mass that the arm carries in some runs and not in others: at the flange, or on a link before it.

use haptical_model::kinematics::nalgebra::Vector3;

use crate::laws::{Input, Law};
use crate::signal::{local_motion, smooth};
use crate::{Context, Family, Follows, Form, Hook, Need, Parameter, Shape, Signal, Spec};

/// At the flange, where the device's last row ends.
pub const SPEC: Spec = Spec {
    name: "payload",
    meaning: "the arm does not carry the same in all runs, or not what the device file says",
    inspect: "what hangs at the flange or on a link, and since when",
    confirm: "to confirm: weigh what was put on or taken off between the runs, or hang a known weight at the flange and repeat \
              the trajectory once more",
    adds: "m J^T (a - g) at the flange, from a run on",
    hook: Hook::Torque,
    form: Form::Mass,
    needs: &[Need::Time, Need::Torque, Need::Gravity, Need::Runs],
    parameters: &[
        Parameter::size("mass_kg", 0.0, f64::MAX),
        Parameter::number("from_run", f64::MAX),
    ],
    shape: Shape::Given,
    follows: Follows::Run,
    ..Spec::of(Family::Tool)
};
/// On a link before the last, at a place that only its first moment says something of.
pub const ON_LINK: Spec = Spec {
    adds: "another mass, centre and inertia of a link, from a run on",
    parameters: &[
        Parameter::size("mass_kg", 0.0, f64::MAX),
        Parameter::size("moment_kg_m", 0.0, f64::MAX),
        Parameter::number("on_link", f64::MAX),
        Parameter::number("from_run", f64::MAX),
    ],
    ..SPEC
};

pub(crate) const LAW: Payload = Payload;

#[derive(Debug)]
pub(crate) struct Payload;

impl Law for Payload {
    /// The first run with it: every one but the first.
    fn shapes(&self, input: Input<'_, '_>) -> Option<Vec<f64>> {
        let later = 1..input.context.runs.len().max(2);
        Some(later.map(|run| run as f64).collect())
    }

    /// A drive holds what its joint carries against its weight, and speeds it up: J^T (a - g) for one kilogram (Luh,
    /// Walker & Paul 1980).
    fn signals(&self, input: Input<'_, '_>, shape: f64) -> Option<Vec<Signal>> {
        let context = input.context;
        let gravity = Vector3::from(context.device.gravity_mps2?);
        let acceleration = handle_acceleration(context)?;
        let first = context.runs.get(shape as usize)?.start;
        let pull = |row: usize| context.rotation[row].tr_mul(&(acceleration[row] - gravity));
        let on = |joint: usize| {
            let at = |row: usize| match row < first {
                true => 0.0,
                false => context.arm(joint, row).dot(&pull(row)),
            };
            (0..context.rows()).map(at).collect()
        };
        let joints = 0..context.twist.len();
        let parts = joints.filter_map(|joint| Some((context.torque_stream(joint)?, on(joint))));
        Some(vec![Signal {
            parts: parts.collect(),
        }])
    }

    fn values(&self, _: Input<'_, '_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        vec![amplitudes[0], shape + 1.0]
    }

    fn amplitudes(&self, _: Input<'_, '_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![values[0]], values[1] - 1.0)
    }
}

/// Acceleration of the handle in frame (-1) \[m/s^2\], averaged as the joints' rates are; none without times or links.
fn handle_acceleration(context: &Context<'_>) -> Option<Vec<Vector3<f64>>> {
    let time_s = context.recording.time_s.as_deref()?;
    if context.position.len() != context.rows() {
        return None;
    }
    let reach = context.drive_reach();
    let along = |axis: usize| {
        let values: Vec<f64> = context.position.iter().map(|place| place[axis]).collect();
        let motion = local_motion(&values, time_s, &context.runs);
        smooth(&motion.acceleration, reach, &context.runs)
    };
    let [x, y, z] = [0, 1, 2].map(along);
    let rows = x.into_iter().zip(y).zip(z);
    Some(rows.map(|((x, y), z)| Vector3::new(x, y, z)).collect())
}
