//! The rows at which events happened, and what they did to the readings: what a repaired log takes back.

use haptical_effects::Effect;

use crate::answer::StepAnswer;
use crate::engine::model::Cause;
use crate::select::Selection;
use crate::thresholds::answer::REACH_BLOCKS;

/// Every step of every cause that is an event.
pub(crate) fn steps(selection: &Selection<'_>) -> Vec<StepAnswer> {
    let mut steps = Vec::new();
    for cause in selection.causes() {
        let effect = selection.effect(cause);
        for (time, size) in cause.times.iter().zip(&cause.amplitudes) {
            let row = first_row(selection, effect, cause, (*time, *size));
            steps.push(StepAnswer {
                effect: effect.name().to_owned(),
                joint: effect.joint().map(|joint| joint + 1),
                first_row: [row, row],
                size: *size,
            });
        }
    }
    steps
}

/// The first row after a step by which the squares of what is left are least. Blocks of rows, by which events are found, leave
/// it open by a few.
fn first_row(
    selection: &Selection<'_>,
    effect: &dyn Effect,
    cause: &Cause,
    (time, size): (f64, f64),
) -> usize {
    let engine = selection.engine();
    let context = &engine.context;
    let found = time as usize;
    let Some(run) = context.runs.iter().find(|run| run.contains(&found)) else {
        return found;
    };
    let reach = REACH_BLOCKS * engine.system.layout.size;
    let first = found.saturating_sub(reach).max(run.start);
    let end = (found + reach).min(run.end);
    let whole = effect.signal(context, &[size], run.start as f64);
    let others: Vec<f64> = cause.times.iter().copied().filter(|t| *t != time).collect();
    // what a row has less of squares before the step than after it
    let mut gains = vec![0.0; end - first];
    for (stream, step) in &whole.parts {
        let floor = engine.floor[*stream].max(1e-300);
        for row in first..end {
            let left = selection.refit.residual[*stream][row];
            if !left.is_finite() || !engine.usable[*stream][row] {
                continue;
            }
            let taken = if row >= found { step[row] } else { 0.0 };
            let without = left + taken;
            let after = without - step[row];
            gains[row - first] += (after.powi(2) - without.powi(2)) / floor.powi(2);
        }
    }
    // the cost of a step at `row`: the sum of the gains from there on
    let mut best = (f64::INFINITY, found);
    let mut cost = 0.0;
    for row in (first..end).rev() {
        cost += gains[row - first];
        if cost < best.0 && !others.contains(&(row as f64)) {
            best = (cost, row);
        }
    }
    best.1
}
