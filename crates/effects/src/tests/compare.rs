//! Finds effects by name, and compares what they add with what is worked out another way.

use haptical_model::kinematics::nalgebra::Vector3;
use haptical_model::{Device, Evaluation};

use super::rig::{AnyEffect, RUN, SECOND_RUN_S, STEP_S, reading, values};
use crate::catalogue;
use crate::context::Context;
use crate::signal::Signal;

/// The effect of a name at a joint (from 0), the first with this parameter.
pub(super) fn with_effect(
    device: &Device,
    name: &str,
    joint: Option<usize>,
    parameter: &str,
) -> Box<AnyEffect> {
    let mut effects = catalogue(device);
    let found = effects.iter().position(|effect| {
        effect.name() == name
            && effect.joint() == joint
            && effect.spec().parameters[0].name == parameter
    });
    effects.swap_remove(found.unwrap_or_else(|| panic!("{name} {joint:?} {parameter}")))
}

/// What an effect with these values adds.
pub(super) fn added(
    context: &Context<'_>,
    name: &str,
    joint: Option<usize>,
    given: &[(&str, f64)],
) -> Signal {
    let effect = with_effect(context.device, name, joint, given[0].0);
    let mut values = values(effect.as_ref(), context, 1.0);
    for (value, spec) in values.iter_mut().zip(effect.spec().parameters) {
        if let Some((_, given)) = given.iter().find(|(name, _)| *name == spec.name) {
            *value = *given;
        }
    }
    let (amplitudes, shape) = effect.amplitudes(context, &values);
    effect.signal(context, &amplitudes, shape)
}

pub(super) fn on<'s>(signal: &'s Signal, context: &Context<'_>, stream: &str) -> &'s [f64] {
    let index = context
        .streams
        .iter()
        .position(|s| s.name() == stream)
        .unwrap();
    signal.on(index).unwrap()
}

pub(super) fn time_s(row: usize) -> f64 {
    let start_s = if row < RUN { 0.0 } else { SECOND_RUN_S };
    start_s + STEP_S * (row % RUN) as f64
}

/// Asserts agreement within a share of the largest value, away from the ends of the runs, where
/// covariates are smoothed over fewer rows.
pub(super) fn assert_agree(
    label: &str,
    found: &[f64],
    expected: impl Fn(usize) -> f64,
    share: f64,
) {
    const EDGE: usize = 6;
    let inner = |row: &usize| (EDGE..RUN - EDGE).contains(&(row % RUN));
    let rows: Vec<usize> = (0..2 * RUN).filter(inner).collect();
    let size = rows
        .iter()
        .fold(0.0, |size: f64, &row| size.max(expected(row).abs()));
    assert!(size > 0.0, "{label}");
    for row in rows {
        let error = (found[row] - expected(row)).abs();
        assert!(
            error <= share * size,
            "{label} row {row}: {} {}",
            found[row],
            expected(row)
        );
    }
}

/// Distance of the first cable at output angles.
pub(super) fn length_m(device: &Device, outputs: &[f64]) -> f64 {
    let mut evaluation = Evaluation::new(device);
    evaluation.move_outputs(outputs).unwrap();
    let anchor = Vector3::from(device.cables[0].anchor_m);
    (evaluation.pose().unwrap().position_m - anchor).norm()
}

/// The joints' angles at a time; the devices here have no transmission error.
pub(super) fn angles(device: &Device, time_s: f64) -> Vec<f64> {
    (0..device.joints.len())
        .map(|joint| reading(device, joint, time_s))
        .collect()
}
