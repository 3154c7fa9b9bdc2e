//! The row from which on something is displaced, within one run of single postures: a tracker that was touched, a joint that slipped.

use haptical_effects::{Context, Follows, Spec};

use super::{Candidate, Selection};
use crate::Result;
use crate::engine::dot;
use crate::thresholds::steps::{LEAST_ROWS_BESIDE, SPLIT_NATS, SPLIT_SHARE};

/// Row from which on a displacement explains most of what the base model leaves of single postures, beyond chance at any row and place; none
/// without one. The order of the rows is enough: a log needs no times for it.
pub(crate) fn split(selection: &Selection<'_>) -> Result<Option<usize>> {
    let engine = selection.engine();
    let context = &engine.context;
    let rows = context.rows();
    if context.ordered || rows < 2 * LEAST_ROWS_BESIDE {
        return Ok(None);
    }
    let effects = selection.selector.effects.iter().enumerate();
    let effects = effects.filter(|(_, entry)| is_displacement(entry.spec()));
    let effects: Vec<_> = effects.collect();
    let streams = context.streams.clone();
    let mut cut = Context::new(context.device, context.recording, &streams)?;
    let system = &engine.system;
    let whole = dot(&system.residual, &system.residual);
    let mut best: Option<(f64, usize)> = None;
    let inside = LEAST_ROWS_BESIDE..=rows - LEAST_ROWS_BESIDE;
    let tried = (inside.clone().count() * effects.len().max(1)) as f64;
    for row in inside {
        let Some(run) = context.runs.iter().position(|run| run.contains(&row)) else {
            continue;
        };
        if context.runs[run].start == row {
            continue;
        }
        cut.runs.clone_from(&context.runs);
        let ends = std::mem::replace(&mut cut.runs[run].end, row);
        cut.runs.insert(run + 1, row..ends);
        for (index, effect) in &effects {
            if effect.untestable(&cut).is_some() {
                continue;
            }
            let shape = (run + 1) as f64;
            let signals = effect.derivative(&cut, &vec![0.0; effect.spec().amplitudes], shape);
            let score = Candidate::of_signals(system, &signals, *index, shape).score(system);
            let numbers = score.rank as f64 * (system.residual.len() as f64).ln();
            let nats = 0.5 * (score.score - numbers) - tried.ln();
            let is_most = score.score > SPLIT_SHARE * whole;
            if is_most && nats > best.map_or(SPLIT_NATS, |best| best.0) {
                best = Some((nats, row));
            }
        }
    }
    Ok(best.map(|best| best.1))
}

/// Whether an effect is a displacement from a run on.
pub(crate) fn is_displacement(spec: &Spec) -> bool {
    spec.follows == Follows::Run
}
