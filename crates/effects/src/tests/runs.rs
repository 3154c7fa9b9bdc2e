//! Effects that remember the motion, over separate runs.

use haptical_model::Recording;

use super::rig::{AnyEffect, RUN, Rig, amplitudes, context, rigs};
use crate::context::Context;
use crate::signal::Signal;
use crate::{Follows, catalogue};

/// The two runs in the other order.
fn exchanged(recording: &Recording) -> Recording {
    let rows: Vec<usize> = (RUN..2 * RUN).chain(0..RUN).collect();
    recording.select(&rows)
}

fn contribution(
    effect: &AnyEffect,
    context: &Context<'_>,
    amplitudes: &[f64],
    shape: f64,
) -> Signal {
    effect.signal(context, amplitudes, shape)
}

#[test]
fn the_order_of_the_runs_changes_nothing_within_them() {
    // the mean temperature is summed in another order
    const ROUNDING: f64 = 1e-12;
    for Rig {
        device, recording, ..
    } in rigs()
    {
        let swapped = exchanged(&recording);
        let (here, there) = (context(&device, &recording), context(&device, &swapped));
        for effect in catalogue(&device) {
            // this one is about the order
            if effect.spec().follows == Follows::Run || effect.untestable(&here).is_some() {
                continue;
            }
            let (amplitudes, shape) = amplitudes(effect.as_ref(), &here);
            let one = contribution(effect.as_ref(), &here, &amplitudes, shape);
            // the shape of an event is a row, and the rows have moved
            let there_shape = if effect.spec().shape == crate::Shape::Event {
                ((shape as usize + RUN) % (2 * RUN)) as f64
            } else {
                shape
            };
            let other = contribution(effect.as_ref(), &there, &amplitudes, there_shape);
            for (stream, values) in &one.parts {
                let swapped = other.on(*stream).unwrap();
                for row in 0..2 * RUN {
                    let error = (values[row] - swapped[(row + RUN) % (2 * RUN)]).abs();
                    assert!(error <= ROUNDING, "{} row {row}: {error:e}", effect.label());
                }
            }
        }
    }
}

#[test]
fn a_run_does_not_remember_the_one_before_it() {
    // what is evaluated with a time or a temperature is measured from the whole recording
    for Rig {
        device, recording, ..
    } in rigs()
    {
        let second: Vec<usize> = (RUN..2 * RUN).collect();
        let alone = recording.select(&second);
        let (both, alone) = (context(&device, &recording), context(&device, &alone));
        let remembering = [
            "backlash",
            "hysteresis",
            "external-encoder-windup",
            "capstan-creep",
            "viscous-lag",
        ];
        for effect in catalogue(&device) {
            if !remembering.contains(&effect.name()) || effect.untestable(&both).is_some() {
                continue;
            }
            let (amplitudes, shape) = amplitudes(effect.as_ref(), &both);
            let whole = contribution(effect.as_ref(), &both, &amplitudes, shape);
            let part = contribution(effect.as_ref(), &alone, &amplitudes, shape);
            for (stream, values) in &part.parts {
                assert_eq!(
                    values,
                    &whole.on(*stream).unwrap()[RUN..],
                    "{}",
                    effect.label()
                );
            }
        }
    }
}

#[test]
fn a_step_ends_with_its_run() {
    // a new recording starts from an index or from home again
    for Rig {
        device, recording, ..
    } in rigs()
    {
        let context = context(&device, &recording);
        for effect in catalogue(&device)
            .iter()
            .filter(|effect| effect.spec().shape == crate::Shape::Event)
        {
            if effect.untestable(&context).is_some() {
                continue;
            }
            for (row, end) in [(100, RUN), (RUN + 100, 2 * RUN)] {
                assert_eq!(
                    span(effect.as_ref(), &context, row),
                    Some([row, end - 1]),
                    "{}",
                    effect.label()
                );
            }
        }
    }
}

/// First and last row that a step at a row changes in its last stream.
fn span(effect: &AnyEffect, context: &Context<'_>, row: usize) -> Option<[usize; 2]> {
    let signal = effect.signal(context, &[1.0], row as f64);
    let (_, values) = signal.parts.last()?;
    let first = values.iter().position(|value| *value != 0.0)?;
    let last = values.iter().rposition(|value| *value != 0.0)?;
    Some([first, last])
}

#[test]
fn a_step_is_found_again_where_every_run_starts_at_zero() {
    for Rig {
        device,
        mut recording,
        ..
    } in rigs()
    {
        let restarted = (0..2 * RUN).map(|row| 0.01 * (row % RUN) as f64).collect();
        recording.time_s = Some(restarted);
        let context = context(&device, &recording);
        assert_eq!(context.runs, [0..RUN, RUN..2 * RUN]);
        for effect in catalogue(&device)
            .iter()
            .filter(|effect| effect.spec().shape == crate::Shape::Event)
        {
            if effect.untestable(&context).is_some() {
                continue;
            }
            // the same time is in either run, and the row says which one is meant
            for (row, end) in [(100, RUN), (RUN + 100, 2 * RUN)] {
                let label = effect.label();
                assert_eq!(
                    span(effect.as_ref(), &context, row),
                    Some([row, end - 1]),
                    "{label}"
                );
                let values = effect.values(&context, &[1.0], row as f64);
                assert_eq!(values[1], 1.0, "{label}");
            }
        }
    }
}
