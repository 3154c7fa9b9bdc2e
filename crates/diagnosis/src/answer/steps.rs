//! The rows at which events happened, and what they did to the readings: what a repaired log takes back.

use crate::answer::StepAnswer;
use crate::select::Selection;

/// Every step of every cause that is an event.
pub(crate) fn steps(selection: &Selection<'_>) -> Vec<StepAnswer> {
    let mut steps = Vec::new();
    for cause in selection.causes() {
        let effect = selection.effect(cause);
        for (time, size) in cause.times.iter().zip(&cause.amplitudes) {
            steps.push(StepAnswer {
                effect: effect.name().to_owned(),
                joint: effect.joint().map(|joint| joint + 1),
                first_row: [*time as usize; 2],
                size: *size,
            });
        }
    }
    steps
}
