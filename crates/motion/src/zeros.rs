//! The size of a joint's zero that is off, about where the links stand: what bodies are off by turns with them.

use std::rc::Rc;

use haptical_model::Recording;

use crate::arm::Arm;
use crate::effect::{self, Context};
use crate::fit::base::Base;
use crate::fit::problem::{Problem, Reading};
use crate::select::{Frame, Pick, numbers};
use crate::thresholds::select::{UNMOVED_SDS, ZERO_ROUNDS};

/// Fits the zeros that were found once more with the readings moved by them, until they stay: then the base model's columns are those of the
/// links where they stand. Where another effect was found too, or a link has an encoder of its own, the numbers stay as they are.
pub(crate) fn refit(
    arm: &Arm,
    (recording, reading): (&Recording, Reading),
    picks: &mut [Pick],
    misfit: f64,
) {
    let mut zeros = Vec::new();
    for pick in picks.iter() {
        let (Some(joint), Some((_, offset, _))) = (pick.zero(), pick.numbers.first()) else {
            return;
        };
        if recording.output.get(joint).is_some_and(Option::is_some) {
            return;
        }
        zeros.push((joint, *offset, f64::INFINITY));
    }
    for _ in 0..ZERO_ROUNDS {
        let Some(steps) = steps(arm, (recording, reading.clone()), &zeros, misfit) else {
            return;
        };
        let mut is_unmoved = true;
        for ((_, offset, sd), (step, of_step)) in zeros.iter_mut().zip(steps) {
            is_unmoved &= step.abs() < UNMOVED_SDS * of_step;
            *offset += step;
            *sd = of_step;
        }
        if is_unmoved {
            break;
        }
    }
    for (pick, (_, offset, sd)) in picks.iter_mut().zip(zeros) {
        if let Some(number) = pick.numbers.first_mut().filter(|_| sd.is_finite()) {
            (number.1, number.2) = (offset, sd);
        }
    }
}

/// By how much each zero is further off than it was taken to be, with its standard deviation.
fn steps(
    arm: &Arm,
    (recording, reading): (&Recording, Reading),
    zeros: &[(usize, f64, f64)],
    misfit: f64,
) -> Option<Vec<(f64, f64)>> {
    let mut moved = recording.clone();
    for (joint, offset, _) in zeros {
        moved
            .joint
            .get_mut(*joint)?
            .iter_mut()
            .for_each(|at| *at += offset);
    }
    let mut problem = Problem::new(arm.clone(), &moved, reading).ok()?;
    let base = Base::weighted(&mut problem);
    let frame = Frame::new(&problem, &base);
    let times = frame.times();
    let frame = frame.counting_known(times);
    let bare = frame.fitted(&[], None);
    let torque = base.torque(&problem, &bare.solved.solution);
    let context = Context {
        problem: &problem,
        base: &base,
        torque: &torque,
    };
    let all = effect::zeros(context);
    let at = |joint: usize| all.iter().find(|entry| entry.joint == Some(joint));
    let candidates = zeros.iter().map(|(joint, ..)| at(*joint));
    let candidates: Vec<_> = candidates.collect::<Option<_>>()?;
    let columns = candidates
        .iter()
        .flat_map(|entry| entry.columns.iter().map(Rc::clone));
    let columns: Vec<_> = columns.collect();
    let fitted = frame.fitted(&columns, None);
    let of_each = candidates.iter().enumerate().map(|(at, candidate)| {
        let found = numbers(&fitted, at..at + 1, candidate, ((misfit, times), 0.0));
        found.first().map(|(_, step, sd)| (*step, *sd))
    });
    of_each.collect()
}
