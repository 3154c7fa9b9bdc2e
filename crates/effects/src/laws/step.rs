//! A constant step from an instant on; the shape is the first row after it.

use crate::context::Context;
use crate::laws::{Input, Law};
use crate::{Family, Form, Parameter, Shape, Spec};

/// 1 from a row to the end of its run.
pub(crate) fn step(context: &Context<'_>, shape: f64) -> Vec<f64> {
    let mut error = vec![0.0; context.rows()];
    let first = shape.max(0.0) as usize;
    if let Some(run) = context.runs.iter().find(|run| run.contains(&first)) {
        error[first..run.end].fill(1.0);
    }
    error
}

/// Time of a row \[s\].
pub(crate) fn instant(context: &Context<'_>, shape: f64) -> f64 {
    let time_s = context.recording.time_s.as_ref();
    let time = time_s.and_then(|time_s| time_s.get(shape as usize));
    time.copied().unwrap_or(shape)
}

/// First row from a time on.
pub(crate) fn row_at(context: &Context<'_>, instant_s: f64) -> f64 {
    let time_s = context.recording.time_s.as_ref();
    time_s.map_or(instant_s, |time_s| {
        time_s.partition_point(|&time| time < instant_s) as f64
    })
}

/// A step, reported as a number of units and an instant.
#[derive(Debug)]
pub(crate) struct Step {
    /// Size of one unit.
    pub(crate) unit: fn(Input<'_, '_>) -> f64,
    /// Whether it is one of the motor's reading: the output steps by the drive's slope times it.
    pub(crate) is_of_reading: bool,
}

impl Step {
    /// What the effects of this law have in common.
    pub(crate) const SPEC: Spec = Spec {
        form: Form::Step,
        parameters: &[Parameter::size("counts", 0.4, 1e4), Parameter::instant()],
        shape: Shape::Event,
        ..Spec::of(Family::Step)
    };
}

impl Law for Step {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], shape: f64) -> Option<Vec<Vec<f64>>> {
        let mut column = step(input.context, shape);
        if let Some(joint) = input.joint.filter(|_| self.is_of_reading) {
            for (entry, slope) in column.iter_mut().zip(&input.context.slope[joint]) {
                *entry *= slope;
            }
        }
        Some(vec![column])
    }

    fn values(&self, input: Input<'_, '_>, amplitudes: &[f64], shape: f64) -> Vec<f64> {
        vec![
            amplitudes[0] / (self.unit)(input),
            instant(input.context, shape),
        ]
    }

    fn amplitudes(&self, input: Input<'_, '_>, values: &[f64]) -> (Vec<f64>, f64) {
        (
            vec![values[0] * (self.unit)(input)],
            row_at(input.context, values[1]),
        )
    }
}

/// Share of the torques that the torque at a slip must exceed: a cable slips under load.
const SLIPS_ABOVE: f64 = 0.9;

/// Whether an event of a joint at a row would have happened under a load that few rows exceed.
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
