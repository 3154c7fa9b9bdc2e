//! Part of the one recording held back, and predicted by what was fitted to the rest.

use std::collections::BTreeMap;

use haptical_calibration::{HeldOut, split, with_ranges_of, without_own_places};
use haptical_effects::Stream;
use haptical_model::Recording;

use super::Shrink;
use super::reduction::collect;
use crate::Result;
use crate::engine::{Engine, Fit, Predicted};
use crate::select::{Selection, is_displacement};
use crate::thresholds::fit::ROUGH;
use crate::thresholds::recording::HELD_BACK;

/// Fits base model and causes to part of the recording, and predicts the rest.
pub(crate) fn on_held_back(
    selection: &Selection<'_>,
    recording: &Recording,
    earlier: Option<&[Vec<f64>]>,
) -> Result<Shrink> {
    let engine = selection.engine();
    let effects = selection.selector.effects;
    let (held, description) = if of_postures(engine) {
        let description = "every fifth touch of each point or plane".to_owned();
        (every_fifth_touch(recording), description)
    } else {
        let mut whole = without_own_places(&engine.base.device, recording);
        if is_of_runs(selection) {
            // a run that is held back whole says nothing of what is displaced from it on
            whole.to_mut().run = None;
        }
        let split = split(&whole, HeldOut::Share(HELD_BACK))?;
        let mut held = vec![false; recording.len()];
        for &row in &split.held_out {
            held[row] = true;
        }
        (held, split.description)
    };
    if held.iter().filter(|held| **held).count() < 8 {
        return Ok(Shrink::default());
    }
    let seen = |row: usize| !held[row];
    let part = engine.part(&seen)?;
    let plain = engine.refit_on(&part, effects, &engine.start.model, Some(ROUGH))?;
    let with = engine.refit_on(&part, effects, &selection.refit.model, None)?;
    if !(plain.has_converged() && with.has_converged()) {
        let warning = "the fit to the rows that are not held out did not converge: nothing is said of unseen rows";
        return Ok(Shrink {
            warnings: vec![warning.to_owned()],
            ..Shrink::default()
        });
    }
    let before = earlier.unwrap_or(&plain.residual);
    let after = &with.residual;
    let fit = Fit {
        engine,
        part: &part,
        effects,
        causes: with.model.causes.iter().map(|own| (own, own)).collect(),
    };
    let asked = |stream: usize, row: usize| held[row] && engine.usable[stream][row];
    // an earlier model predicts all rows: where the part hardly shows a difference from it, that is for the unseen rows to say
    let (device, fit) = match earlier {
        Some(_) => (engine.base.device.clone(), None),
        None => (
            with_ranges_of(&engine.base.device, recording, &seen),
            Some(&fit),
        ),
    };
    let predicted = Predicted::new(engine, (&device, recording), fit, &asked);
    let rows = |stream: usize, row: usize| predicted.leverage(stream, row);
    Ok(Shrink {
        channels: collect(engine, &rows, before, after),
        predictions: Vec::new(),
        description,
        warnings: predicted.warnings,
    })
}

/// Whether one of the causes is a displacement from a run on.
fn is_of_runs(selection: &Selection<'_>) -> bool {
    let mut causes = selection.refit.model.causes.iter();
    causes.any(|cause| is_displacement(selection.selector.effects[cause.effect].spec()))
}

/// Whether the rows are single postures at which something is touched: what was touched has no place where
/// all its touches are held back, and neighbours say nothing of each other.
fn of_postures(engine: &Engine<'_>) -> bool {
    let context = &engine.context;
    !context.ordered && context.streams.iter().any(Stream::is_touch)
}

/// Of each point and plane the fifth touch, the tenth, ...
fn every_fifth_touch(recording: &Recording) -> Vec<bool> {
    let mut touches: BTreeMap<(&str, &str), usize> = BTreeMap::new();
    (0..recording.len())
        .map(|row| {
            let count = touches
                .entry((id(&recording.contact, row), id(&recording.plane, row)))
                .or_default();
            *count += 1;
            count.is_multiple_of(5)
        })
        .collect()
}

/// What a row touches; nothing where there is no such column.
fn id(ids: &Option<Vec<String>>, row: usize) -> &str {
    let id = ids.as_ref().and_then(|ids| ids.get(row));
    id.map_or("", String::as_str)
}
